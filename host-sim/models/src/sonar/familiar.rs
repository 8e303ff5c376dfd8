//! Readings at poses where others were taken before: what a pose in a room does to a sensor beyond its law repeats there.
//!
//! A share ρ of the variance of an echo's occurrence belongs to the pose, and the rest is drawn independently for every
//! reading: after h echoes of n, each expected with probability p, the probability of the next one is (κ p + h) / (κ + n)
//! with κ = (1 − ρ) / ρ, the mean of a beta-binomial law whose intraclass correlation is ρ. The value of an echo is that of
//! one of the readings before or drawn from the sensor's law, with weights 1 each and κ (Blackwell and MacQueen 1973, Annals
//! of Statistics 1: the urn scheme of a Dirichlet process).

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::outcomes::{Component, Distribution, Outcomes, Source};
use super::perturbation::Perturbation;
use super::pose_grid::PoseGrid;
use super::{SensorLaw, View};
use mindgap_foundations::geometry::{Pose, Wall};
use mindgap_foundations::statistics::summary::log_odds;

/// The readings of training logs that revisit the same poses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FamiliarPoses {
    /// The walls of the room, both ends of each, cm. In other rooms no pose is familiar.
    pub walls_cm: Vec<[f64; 4]>,
    /// How readings repeat.
    pub law: RepeatLaw,
    /// Share of the residual variance given earlier readings, of the echo rate and of the readings, that readings at a place
    /// still have in common: a robot is never put back exactly where it was.
    pub left_share: [f64; 2],
    /// The readings.
    pub readings: Vec<PastReading>,
}

/// How readings repeat at a pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RepeatLaw {
    /// Share of the variance of an echo's occurrence that belongs to the pose, 0..=1.
    pub rate_share: f64,
    /// Share of the variance of the reading that belongs to the pose, 0..=1.
    pub value_share: f64,
    /// Scale of the scatter of a repeated reading, cm.
    pub scale_cm: f64,
}

/// A row of the training logs: a reading, or none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PastReading {
    /// Pose of the sensor: x and y in cm, heading in rad.
    pub sensor: [f64; 3],
    /// Probability of an echo by the sensor's law.
    pub p_echo: f64,
    /// The reading, cm; null if there was none.
    pub echo_cm: Option<f64>,
}

/// The readings at familiar poses of the current room.
pub struct PoseMemory {
    law: RepeatLaw,
    /// See [`FamiliarPoses::left_share`].
    pub left_share: [f64; 2],
    readings: PoseGrid<PastReading>,
}

/// Knowledge of a pose from earlier readings.
#[derive(Clone, Debug, PartialEq)]
pub struct Familiarity {
    /// Added to the log-odds of every ray.
    log_odds: f64,
    /// Earlier readings, cm.
    readings_cm: Vec<f64>,
    /// Probability that an echo repeats one of them.
    p_again: f64,
    /// Scale of the scatter of a repeated reading, cm.
    scale_cm: f64,
}

/// Bound of the probability of an echo: certainty counts as odds of a thousand to one.
const MOST_CERTAIN: f64 = 0.999;

impl FamiliarPoses {
    /// Returns walls in the format of files, cm.
    pub fn walls_cm(walls: &[Wall]) -> Vec<[f64; 4]> {
        walls.iter().map(|wall| [wall.from_cm.x, wall.from_cm.y, wall.to_cm.x, wall.to_cm.y]).collect()
    }
}

impl PastReading {
    /// Returns the pose of the sensor.
    pub fn pose(&self) -> Pose {
        let [x_cm, y_cm, heading_rad] = self.sensor;
        Pose::new(x_cm, y_cm, heading_rad)
    }
}

impl PoseMemory {
    /// Loads the familiar poses; `None` if these are not the walls of their room.
    pub fn for_room(familiar: &FamiliarPoses, walls: &[Wall]) -> Option<Self> {
        let FamiliarPoses { law, left_share, .. } = *familiar;
        let readings = || PoseGrid::new(familiar.readings.iter().map(|reading| (reading.pose(), *reading)));
        let is_here = familiar.walls_cm == FamiliarPoses::walls_cm(walls);
        is_here.then(|| PoseMemory { law, left_share, readings: readings() })
    }

    /// Returns the knowledge of a pose; `None` if there are no readings near it.
    pub fn at(&self, sensor: &Pose) -> Option<Familiarity> {
        Familiarity::from_readings(self.readings.near(sensor), &self.law)
    }
}

/// Returns the outcomes of a reading of `view`, given the knowledge of the pose, if any.
pub fn outcomes(known: Option<&Familiarity>, law: &SensorLaw, view: &View, change: &Perturbation) -> Outcomes {
    known.map_or_else(|| law.outcomes(view, change), |known| known.outcomes(law, view, change))
}

impl Familiarity {
    /// Infers the knowledge of a pose from readings near it; `None` if there are none.
    pub fn from_readings<'r>(readings: impl Iterator<Item = &'r PastReading>, law: &RepeatLaw) -> Option<Self> {
        let (mut rows, mut expected, mut readings_cm) = (0.0, 0.0, Vec::new());
        for past in readings {
            rows += 1.0;
            expected += past.p_echo;
            readings_cm.extend(past.echo_cm);
        }
        let RepeatLaw { rate_share, value_share, scale_cm } = *law;
        let log_odds = |p: f64| log_odds(p.clamp(1.0 - MOST_CERTAIN, MOST_CERTAIN));
        (rows > 0.0).then(|| {
            let (p_echo, echoes) = (expected / rows, readings_cm.len() as f64);
            let p_known = ((1.0 - rate_share) * p_echo + rate_share * echoes) / (1.0 - rate_share + rate_share * rows);
            let p_again =
                if echoes > 0.0 { value_share * echoes / (1.0 - value_share + value_share * echoes) } else { 0.0 };
            Familiarity { log_odds: log_odds(p_known) - log_odds(p_echo), readings_cm, p_again, scale_cm }
        })
    }

    /// Returns the outcomes of a reading of `view`. Repeated readings are the last components.
    fn outcomes(&self, law: &SensorLaw, view: &View, change: &Perturbation) -> Outcomes {
        let change = Perturbation { attenuation: change.attenuation - self.log_odds, ..*change };
        let mut outcomes = law.outcomes(view, &change);
        let mut hit = 0.0;
        for component in outcomes.components.iter_mut().filter(|component| component.source == Source::Hit) {
            hit += component.probability;
            component.probability *= 1.0 - self.p_again;
        }
        let probability = hit * self.p_again / self.readings_cm.len().max(1) as f64;
        let scale_cm = libm::hypot(self.scale_cm, change.scatter_cm);
        let again = self.readings_cm.iter().map(|echo_cm| {
            let middle_cm = change.reading_cm(*echo_cm);
            Component { source: Source::Hit, probability, distribution: Distribution::Student { middle_cm, scale_cm } }
        });
        outcomes.components.extend(again);
        outcomes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sonar::echo_law::Surfaces;
    use crate::sonar::partition::{PERTURBED, SENSORS};
    use mindgap_built_in_robot::training_room;

    const READING: PastReading = PastReading { sensor: [50.0, 60.0, 0.5], p_echo: 0.8, echo_cm: Some(90.0) };

    fn familiar(share: f64, readings: &[PastReading]) -> FamiliarPoses {
        FamiliarPoses {
            walls_cm: FamiliarPoses::walls_cm(&training_room().sides()),
            law: RepeatLaw { rate_share: share, value_share: share, scale_cm: 1.0 },
            left_share: [0.0; 2],
            readings: readings.to_vec(),
        }
    }

    fn recalled(share: f64, readings: &[PastReading]) -> Familiarity {
        let here = PoseMemory::for_room(&familiar(share, readings), &training_room().sides()).expect("the same room");
        here.at(&READING.pose()).expect("a familiar pose")
    }

    fn view(law: &SensorLaw) -> View {
        law.view(&Surfaces::new(training_room().sides()), &READING.pose(), 1.0)
    }

    fn outcomes(familiarity: &Familiarity, change: &Perturbation) -> Outcomes {
        let law = SensorLaw::Beam(SENSORS[0].clone());
        familiarity.outcomes(&law, &view(&law), change)
    }

    #[test]
    fn readings_repeat_if_all_variance_belongs_to_the_pose() {
        let familiarity = recalled(1.0, &[READING, PastReading { echo_cm: Some(94.0), ..READING }]);
        // Two of two, where 0.8 were expected: almost certain, ln(999) against ln(4).
        assert!((familiarity.log_odds - libm::log(999.0) + libm::log(4.0)).abs() < 1e-9);
        assert!((outcomes(&familiarity, &Perturbation::NONE).mean_hit_cm().expect("echoes") - 92.0).abs() < 1e-9);
        let change = Perturbation { gain: 1.1, offset_cm: 2.0, ..Perturbation::NONE };
        assert!((outcomes(&familiarity, &change).mean_hit_cm().expect("echoes") - 1.1 * 92.0 - 2.0).abs() < 1e-9);
    }

    #[test]
    fn independent_readings_change_nothing() {
        let law = SensorLaw::Beam(SENSORS[0].clone());
        let (known, unknown) =
            (outcomes(&recalled(0.0, &[READING]), &PERTURBED), law.outcomes(&view(&law), &PERTURBED));
        assert_eq!((known.none, known.mean_hit_cm()), (unknown.none, unknown.mean_hit_cm()));
    }

    #[test]
    fn probabilities_add_up_to_one() {
        for share in [0.0, 0.4, 1.0] {
            for readings in [[READING; 2], [READING, PastReading { echo_cm: None, ..READING }]] {
                let outcomes = outcomes(&recalled(share, &readings), &PERTURBED);
                let sum: f64 = outcomes.components.iter().map(|c| c.probability).sum();
                assert!((sum + outcomes.none - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn one_reading_weighs_as_much_as_the_law_at_a_share_of_one_half() {
        assert!((recalled(0.5, &[READING]).p_again - 0.5).abs() < 1e-12);
        assert_eq!(recalled(0.5, &[PastReading { echo_cm: None, ..READING }]).p_again, 0.0);
    }

    #[test]
    fn other_rooms_and_poses_are_unfamiliar() {
        let familiar = familiar(0.5, &[READING]);
        let mut other = training_room();
        other.arena_cm = other.arena_cm.map(|arena| 1.1 * arena);
        assert!(PoseMemory::for_room(&familiar, &other.sides()).is_none());
        let here = PoseMemory::for_room(&familiar, &training_room().sides()).expect("the same room");
        assert!(here.at(&Pose::new(56.0, 60.0, 0.5)).is_none() && here.at(&Pose::new(50.0, 60.0, 0.6)).is_none());
    }
}
