//! Learns how readings repeat at poses that the training logs revisit, as scans from one place do.

use rayon::prelude::*;

use crate::learn::place_bound::{self, Seen};
use mindgap_foundations::statistics::maximise::{Bounds, climb};
use mindgap_logs::Scene;
use mindgap_models::sonar::echo_law::Surfaces;
use mindgap_models::sonar::familiar::{FamiliarPoses, Familiarity, PastReading, RepeatLaw, outcomes};
use mindgap_models::sonar::model::CONSTANT_SCATTER_CM;
use mindgap_models::sonar::pose_grid::PoseGrid;
use mindgap_models::sonar::{Outcomes, Perturbation, SensorLaw, View};

/// Minimum share of readings at poses where another run has a reading too. For a robot that drives around it is a tenth, and
/// single neighbours are not worth keeping.
const LEAST_REVISITED: f64 = 0.5;
/// Bounds of the two shares and of the scale, cm: repeated readings scatter at least as much as constant ones, and readings
/// that scatter more than the upper bound are not repeats.
const BOUNDS: [Bounds; 3] = [Bounds::new(0.0, 0.99), Bounds::new(0.0, 0.99), Bounds::new(CONSTANT_SCATTER_CM, 6.0)];
const START: [f64; 3] = [0.3, 0.3, 1.5];
/// The search ends after this many iterations, or when one gains less than half a nat, a sixth of strong evidence.
const ROUNDS: usize = 30;
const ENOUGH: f64 = 0.5;

/// Learns the pose memory of training logs from one room; `None` if they revisit too few poses. The repeat law maximises the
/// likelihood of each run's readings given the other runs.
pub fn learn(law: &SensorLaw, seen: &[Seen], scene: &Scene) -> Option<FamiliarPoses> {
    let walls = scene.sides();
    let reading = |row: &Seen| PastReading {
        sensor: [row.sensor.position_cm.x, row.sensor.position_cm.y, row.sensor.heading_rad],
        p_echo: 1.0 - row.none,
        echo_cm: row.echo_cm,
    };
    let readings: Vec<PastReading> = seen.iter().map(reading).collect();
    let others = in_other_runs(seen);
    let revisited = others.iter().filter(|others| !others.is_empty()).count();
    if seen.is_empty() || (revisited as f64) < LEAST_REVISITED * seen.len() as f64 {
        return None;
    }
    let surfaces = Surfaces::new(walls.clone());
    let views: Vec<View> = seen.iter().map(|row| law.view(&surfaces, &row.sensor, 1.0)).collect();
    let judged = |repeats: &RepeatLaw, i: usize| {
        let known = Familiarity::from_readings(others[i].iter().map(|other| &readings[*other]), repeats);
        outcomes(known.as_ref(), law, &views[i], &Perturbation::NONE)
    };
    let terms = |at: &[f64]| {
        let repeats = law_from(at);
        let term = |i: usize| judged(&repeats, i).log_likelihood(seen[i].echo_cm);
        (0..seen.len()).into_par_iter().map(term).collect()
    };
    let repeats = law_from(&climb(&BOUNDS, &START, ROUNDS, ENOUGH, terms).at);
    let residual = |i: usize| residual(&seen[i], i, &judged(&repeats, i));
    let left_share = place_bound::learn(&(0..seen.len()).map(residual).collect::<Vec<Seen>>());
    Some(FamiliarPoses { walls_cm: FamiliarPoses::walls_cm(&walls), law: repeats, left_share, readings })
}

fn law_from(at: &[f64]) -> RepeatLaw {
    RepeatLaw { rate_share: at[0], value_share: at[1], scale_cm: at[2] }
}

/// Returns for each row the rows of other runs near its pose.
fn in_other_runs(seen: &[Seen]) -> Vec<Vec<usize>> {
    let poses = PoseGrid::new(seen.iter().enumerate().map(|(i, row)| (row.sensor, i)));
    let others = |row: &Seen| poses.near(&row.sensor).filter(|i| seen[**i].run != row.run).copied().collect();
    seen.iter().map(others).collect()
}

/// Returns the residual of a row given the readings near its pose. Each counts as a run of its own, so that the correlation
/// within runs remains.
fn residual(row: &Seen, i: usize, known: &Outcomes) -> Seen {
    Seen { run: i, none: known.none, off_cm: known.off_cm(row.echo_cm), ..*row }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_built_in_robot::training_room;
    use mindgap_foundations::geometry::Pose;
    use mindgap_models::sonar::SonarModel;

    fn law() -> SensorLaw {
        SensorLaw::Beam(SonarModel {
            strength: [1.0, 2.0, -2.0, 1.0, -1.0, -0.5, -1.0, -0.5, -1.0, -0.5],
            mirror_loss: Some(1.0),
            bias: [-0.3, 0.01, -0.3],
            log_scatter: [-2.5, 0.1, 0.1],
            constant: [0.1, 21.0],
            p_constant_given_none: 0.15,
            p_short: 0.08,
            p_dropout: 0.1,
            fan_width: 0.9,
            range_cm: [4.0, 240.0],
        })
    }

    /// Returns four scans of 60 poses each, with errors `off_cm` by scan and pose.
    fn scans(off_cm: impl Fn(usize, usize) -> f64) -> Vec<Seen> {
        let (law, surfaces) = (law(), Surfaces::new(training_room().sides()));
        let seen = |i: usize| {
            let sensor = Pose::new(100.0, 80.0, 0.1 * (i % 60) as f64);
            let outcomes = law.outcomes_at(&surfaces, &sensor);
            let off_cm = i.is_multiple_of(2).then(|| off_cm(i / 60, i % 60));
            let echo_cm = off_cm.map(|off_cm| outcomes.mean_hit_cm().expect("walls all around") + off_cm);
            Seen { sensor, run: i / 60, none: outcomes.none, echo_cm, off_cm }
        };
        (0..240).map(seen).collect()
    }

    fn learned(off_cm: impl Fn(usize, usize) -> f64) -> FamiliarPoses {
        learn(&law(), &scans(off_cm), &training_room()).expect("revisited poses")
    }

    /// Returns a pseudorandom error between -15 and 15 cm.
    fn off_cm(number: usize) -> f64 {
        ((number * 2_654_435_761) >> 7) as f64 % 601.0 / 20.0 - 15.0
    }

    #[test]
    fn share_is_the_part_that_the_pose_determines() {
        let familiar = learned(|_, pose| off_cm(pose));
        assert!(familiar.law.rate_share > 0.8 && familiar.law.value_share > 0.8, "{:?}", familiar.law);
        assert!(familiar.law.scale_cm < 0.9, "readings repeat exactly: {:?}", familiar.law);
        let redrawn = learned(|scan, pose| off_cm(1000 * scan + pose));
        assert!(redrawn.law.scale_cm > 3.0 * familiar.law.scale_cm, "readings repeat only roughly: {:?}", redrawn.law);
        assert_eq!(familiar.readings.len(), 240);
    }

    #[test]
    fn poses_that_are_not_revisited_are_not_kept() {
        let mut seen = scans(|_, pose| off_cm(pose));
        seen.iter_mut().for_each(|row| row.sensor.position_cm.x += 10.0 * row.run as f64);
        let learned = |seen: &[Seen]| learn(&law(), seen, &training_room());
        assert!(learned(&seen).is_none() && learned(&[]).is_none());
    }
}
