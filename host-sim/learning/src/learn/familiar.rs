//! Learns how readings come again at single poses, where training logs came back to them: scans from one place, say.

use rayon::prelude::*;

use crate::learn::place_bound::{self, Seen};
use mindgap_foundations::statistics::maximise::{Bounds, climb};
use mindgap_logs::Scene;
use mindgap_models::sonar::echo_law::Surfaces;
use mindgap_models::sonar::familiar::{FamiliarPoses, Familiarity, PastReading, RepeatLaw, outcomes};
use mindgap_models::sonar::model::CONSTANT_SCATTER_CM;
use mindgap_models::sonar::pose_grid::PoseGrid;
use mindgap_models::sonar::{Outcomes, Perturbation, SensorLaw, View};

/// Poses are familiar if this share of the readings came from where another run had taken one: of a robot that drives about
/// it is a tenth, and what single neighbours tell is not worth keeping.
const MOSTLY: f64 = 0.5;
/// Bounds of the two shares and of the scale, cm: what comes again scatters no less than constant readings do, and what
/// scatters more than this does not come again.
const BOUNDS: [Bounds; 3] = [Bounds::new(0.0, 0.99), Bounds::new(0.0, 0.99), Bounds::new(CONSTANT_SCATTER_CM, 6.0)];
const START: [f64; 3] = [0.3, 0.3, 1.5];
/// The search ends after this many iterations, or when one gains less than half a nat, a sixth of what is strong evidence.
const ROUNDS: usize = 30;
const ENOUGH: f64 = 0.5;

/// The familiar poses of training logs from one room; none where they did not come back to any. The law is that by which the
/// other runs make each run's readings most probable.
pub fn learn(law: &SensorLaw, seen: &[Seen], scene: &Scene) -> Option<FamiliarPoses> {
    let walls = scene.sides();
    let reading = |row: &Seen| PastReading {
        sensor: [row.sensor.position_cm.x, row.sensor.position_cm.y, row.sensor.heading_rad],
        p_echo: 1.0 - row.none,
        echo_cm: row.echo_cm,
    };
    let readings: Vec<PastReading> = seen.iter().map(reading).collect();
    let others = in_other_runs(seen);
    let came_back = others.iter().filter(|others| !others.is_empty()).count();
    if seen.is_empty() || (came_back as f64) < MOSTLY * seen.len() as f64 {
        return None;
    }
    let surfaces = Surfaces::new(walls.clone());
    let views: Vec<View> = seen.iter().map(|row| law.view(&surfaces, &row.sensor, 1.0)).collect();
    let judged = |repeats: &RepeatLaw, i: usize| {
        let known = Familiarity::of(others[i].iter().map(|other| &readings[*other]), repeats);
        outcomes(known.as_ref(), law, &views[i], &Perturbation::NONE)
    };
    let terms = |at: &[f64]| {
        let repeats = law_from(at);
        let term = |i: usize| judged(&repeats, i).log_likelihood(seen[i].echo_cm);
        (0..seen.len()).into_par_iter().map(term).collect()
    };
    let repeats = law_from(&climb(&BOUNDS, &START, ROUNDS, ENOUGH, terms).at);
    let left_over = |i: usize| left_over(&seen[i], i, &judged(&repeats, i));
    let left_share = place_bound::learn(&(0..seen.len()).map(left_over).collect::<Vec<Seen>>());
    Some(FamiliarPoses { walls_cm: FamiliarPoses::walls_cm(&walls), law: repeats, left_share, readings })
}

fn law_from(at: &[f64]) -> RepeatLaw {
    RepeatLaw { rate_share: at[0], value_share: at[1], scale_cm: at[2] }
}

/// For each row the rows of other runs near its pose.
fn in_other_runs(seen: &[Seen]) -> Vec<Vec<usize>> {
    let poses = PoseGrid::new(seen.iter().enumerate().map(|(i, row)| (row.sensor, i)));
    let of = |row: &Seen| poses.near(&row.sensor).filter(|i| seen[**i].run != row.run).copied().collect();
    seen.iter().map(of).collect()
}

/// What is left of a row once its pose is known. Each counts as a run of its own: what a run has in common is left too.
fn left_over(row: &Seen, i: usize, known: &Outcomes) -> Seen {
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

    /// Four scans of 60 poses each, off by what `off_cm` says of scan and pose.
    fn scans(off_cm: impl Fn(usize, usize) -> f64) -> Vec<Seen> {
        let (law, surfaces) = (law(), Surfaces::new(training_room().sides()));
        let seen = |i: usize| {
            let sensor = Pose::new(100.0, 80.0, 0.1 * (i % 60) as f64);
            let outcomes = law.outcomes_at(&surfaces, &sensor);
            let off_cm = i.is_multiple_of(2).then(|| off_cm(i / 60, i % 60));
            let echo_cm = off_cm.map(|off_cm| outcomes.mean_hit_cm().expect("walls all round") + off_cm);
            Seen { sensor, run: i / 60, none: outcomes.none, echo_cm, off_cm }
        };
        (0..240).map(seen).collect()
    }

    fn learned(off_cm: impl Fn(usize, usize) -> f64) -> FamiliarPoses {
        learn(&law(), &scans(off_cm), &training_room()).expect("poses that came back")
    }

    /// Between minus and plus fifteen, as if at random.
    fn off_cm(number: usize) -> f64 {
        ((number * 2_654_435_761) >> 7) as f64 % 601.0 / 20.0 - 15.0
    }

    #[test]
    fn what_a_pose_decides_is_its_share() {
        let familiar = learned(|_, pose| off_cm(pose));
        assert!(familiar.law.rate_share > 0.8 && familiar.law.value_share > 0.8, "{:?}", familiar.law);
        assert!(familiar.law.scale_cm < 0.9, "it reads just the same: {:?}", familiar.law);
        let anew = learned(|scan, pose| off_cm(1000 * scan + pose));
        assert!(anew.law.scale_cm > 3.0 * familiar.law.scale_cm, "it comes again but roughly: {:?}", anew.law);
        assert_eq!(familiar.readings.len(), 240);
    }

    #[test]
    fn nothing_is_kept_of_poses_that_nobody_came_back_to() {
        let mut seen = scans(|_, pose| off_cm(pose));
        seen.iter_mut().for_each(|row| row.sensor.position_cm.x += 10.0 * row.run as f64);
        let learned = |seen: &[Seen]| learn(&law(), seen, &training_room());
        assert!(learned(&seen).is_none() && learned(&[]).is_none());
    }
}
