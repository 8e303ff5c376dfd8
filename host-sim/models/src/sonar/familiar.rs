//! Readings from where others were taken before: what a pose in a room does to a sensor beyond its law comes again there.
//!
//! Whether there is an echo is decided for a pose by a share ρ of its chance, and the rest is drawn anew for every reading:
//! after h echoes of n, where each was expected with probability p, the next one comes with probability (κ p + h) / (κ + n)
//! with κ = (1 − ρ) / ρ, the mean of a beta-binomial law whose intraclass correlation is ρ. What an echo reads is one of the
//! readings before or drawn from the sensor's law, with weights 1 each and κ (Blackwell and MacQueen 1973, Annals of
//! Statistics 1: the urn scheme of a Dirichlet process).

use serde::{Deserialize, Serialize};

use super::outcomes::{Component, Distribution, Outcomes, Source};
use super::perturbation::Perturbation;
use super::pose_grid::PoseGrid;
use super::{SensorLaw, View};
use mindgap_foundations::geometry::{Pose, Wall};
use mindgap_foundations::statistics::summary::log_odds;

/// The readings of training logs that came from the same poses again and again.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FamiliarPoses {
    /// The walls of the room, both ends of each, cm: in another one nothing is familiar.
    pub walls_cm: Vec<[f64; 4]>,
    /// How readings come again.
    pub law: RepeatLaw,
    /// Share of what earlier readings leave open, of the echo rate and of the readings, that readings at a place have in
    /// common all the same: a robot is never put back just where it was.
    pub left_share: [f64; 2],
    /// The readings.
    pub readings: Vec<PastReading>,
}

/// How readings come again at a pose.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct RepeatLaw {
    /// Share of the chance of an echo that belongs to the pose.
    pub rate_share: f64,
    /// The same of what is read.
    pub value_share: f64,
    /// Scale at which a reading comes again, cm.
    pub scale_cm: f64,
}

/// A reading of the training logs, or none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PastReading {
    /// Where the sensor was: x and y in cm, heading in rad.
    pub sensor: [f64; 3],
    /// Probability of an echo by the sensor's law.
    pub p_echo: f64,
    /// What was read, cm.
    pub echo_cm: Option<f64>,
}

/// Familiar poses of a room that one is in.
pub struct Recollection {
    law: RepeatLaw,
    /// See [`FamiliarPoses::left_share`].
    pub left_share: [f64; 2],
    readings: PoseGrid<PastReading>,
}

/// What is known of a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Familiarity {
    /// Added to the log-odds of every ray.
    log_odds: f64,
    /// What was read, cm.
    readings_cm: Vec<f64>,
    /// Probability that an echo reads as one of them did.
    p_again: f64,
    /// Scale at which it does, cm.
    scale_cm: f64,
}

/// An echo that is as good as certain, or as good as impossible, says no more than a thousand to one.
const MOST_CERTAIN: f64 = 0.999;

impl FamiliarPoses {
    /// Walls as they stand in files.
    pub fn walls_cm(walls: &[Wall]) -> Vec<[f64; 4]> {
        walls.iter().map(|wall| [wall.from_cm.x, wall.from_cm.y, wall.to_cm.x, wall.to_cm.y]).collect()
    }
}

impl PastReading {
    /// Where the sensor was.
    pub fn pose(&self) -> Pose {
        let [x_cm, y_cm, heading_rad] = self.sensor;
        Pose::new(x_cm, y_cm, heading_rad)
    }
}

impl Recollection {
    /// None in another room than that of the familiar poses.
    pub fn of(familiar: &FamiliarPoses, walls: &[Wall]) -> Option<Self> {
        let FamiliarPoses { law, left_share, .. } = *familiar;
        let readings = || PoseGrid::new(familiar.readings.iter().map(|reading| (reading.pose(), *reading)));
        let is_here = familiar.walls_cm == FamiliarPoses::walls_cm(walls);
        is_here.then(|| Recollection { law, left_share, readings: readings() })
    }

    /// What is known of a pose; none where nothing was read nearby.
    pub fn at(&self, sensor: &Pose) -> Option<Familiarity> {
        Familiarity::of(self.readings.near(sensor), &self.law)
    }
}

/// The outcomes of a reading of `view`, by what is `known` of the pose, if anything is.
pub fn outcomes(known: Option<&Familiarity>, law: &SensorLaw, view: &View, change: &Perturbation) -> Outcomes {
    known.map_or_else(|| law.outcomes(view, change), |known| known.outcomes(law, view, change))
}

impl Familiarity {
    /// What readings near a pose tell of it; none where there are none.
    pub fn of<'r>(readings: impl Iterator<Item = &'r PastReading>, law: &RepeatLaw) -> Option<Self> {
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

    /// The outcomes of a reading of `view`. The readings that may come again stand last among the components.
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
        let here = Recollection::of(&familiar(share, readings), &training_room().sides()).expect("the same room");
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
    fn what_belongs_to_the_pose_alone_comes_again() {
        let familiarity = recalled(1.0, &[READING, PastReading { echo_cm: Some(94.0), ..READING }]);
        // Two of two, where 0.8 were expected: as good as certain, ln(999) against ln(4).
        assert!((familiarity.log_odds - libm::log(999.0) + libm::log(4.0)).abs() < 1e-9);
        assert!((outcomes(&familiarity, &Perturbation::NONE).mean_hit_cm().expect("echoes") - 92.0).abs() < 1e-9);
        let change = Perturbation { gain: 1.1, offset_cm: 2.0, ..Perturbation::NONE };
        assert!((outcomes(&familiarity, &change).mean_hit_cm().expect("echoes") - 1.1 * 92.0 - 2.0).abs() < 1e-9);
    }

    #[test]
    fn what_is_drawn_anew_tells_nothing() {
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
    fn one_reading_counts_as_much_as_the_law_where_the_shares_are_equal() {
        assert!((recalled(0.5, &[READING]).p_again - 0.5).abs() < 1e-12);
        assert_eq!(recalled(0.5, &[PastReading { echo_cm: None, ..READING }]).p_again, 0.0);
    }

    #[test]
    fn nothing_is_familiar_elsewhere() {
        let familiar = familiar(0.5, &[READING]);
        let mut other = training_room();
        other.arena_cm = other.arena_cm.map(|arena| 1.1 * arena);
        assert!(Recollection::of(&familiar, &other.sides()).is_none());
        let here = Recollection::of(&familiar, &training_room().sides()).expect("the same room");
        assert!(here.at(&Pose::new(56.0, 60.0, 0.5)).is_none() && here.at(&Pose::new(50.0, 60.0, 0.6)).is_none());
    }
}
