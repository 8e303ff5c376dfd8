//! Validation: what logs cannot show.

use glam::DVec2;

use super::scope::Scope;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::summary::median;
use mindgap_learning::evaluation::observations::{Observation, Observations, is_untracked};
use mindgap_logs::inspection::{Inspection, Part};
use mindgap_logs::{Logs, Run};
use mindgap_models::simulator::baseline::{Baseline, MotionModel};

/// Largest position noise of a standing robot; a camera's marker scatters by one or two centimetres.
const STANDING_CM: f64 = 4.0;
/// Largest heading noise of a standing robot, 15 degrees; a compass scatters by a few degrees.
const STANDING_RAD: f64 = 0.26;
/// A robot moved if at least this fraction of a run's poses lies beyond that noise; jumps of the tracker are fewer.
const MOVED: f64 = 0.1;

const UNTRACKED: &str = "The robot was not tracked: of its motion only what it measures itself is compared.";

/// What a diagnosis can compare.
pub struct Validated {
    /// What limits it, one sentence each.
    pub notes: Vec<String>,
    /// The channels that it compares.
    pub scope: Scope,
    /// Whether the robot moved without commands. That is a gap even if everything else agrees.
    pub moved_uncommanded: bool,
}

/// Removes from a baseline what the logs do not contain or what an inspection excludes, and notes the limits of a diagnosis.
///
/// # Errors
/// If nothing is left to compare.
pub fn validate(baseline: &mut Baseline, observations: &Observations, inspected: &Inspection) -> Result<Validated> {
    let knows_motion = baseline.motion.is_some();
    let logs = &inspected.logs;
    let mut notes = Vec::new();
    let mut reasons = Vec::new();
    if let Some(why) = inspected.withheld(Part::Motion) {
        reasons.push((Part::Motion, why.to_owned()));
        baseline.motion = None;
    } else if is_untracked(logs) && is_commanded(observations) && is_witnessed(baseline, observations) {
        notes.push(UNTRACKED.into());
        reasons.push((Part::Motion, UNTRACKED.into()));
    } else if let Some(why) = without_motion(baseline, observations) {
        notes.push(why.to_owned());
        reasons.push((Part::Motion, why.to_owned()));
        baseline.motion = None;
    }
    if observations.rows.iter().any(|row| !row.following_steps.is_empty()) {
        notes.push("No step has a pose at both ends: whole segments between poses are compared.".into());
    }
    if let Some(why) = inspected.withheld(Part::Sonar) {
        reasons.push((Part::Sonar, why.to_owned()));
        baseline.sonar = None;
    } else if let Some(why) = without_sonar(baseline, observations, logs) {
        notes.push(why.to_owned());
        reasons.push((Part::Sonar, why.to_owned()));
        baseline.sonar = None;
    }
    if baseline.motion.is_none() && baseline.sonar.is_none() {
        let mut reasons: Vec<String> = reasons.into_iter().map(|(_, why)| why).collect();
        reasons.dedup();
        return Err(Error::new(format!("nothing can be compared. {}", reasons.join(" "))));
    }
    if logs.runs.len() == 1 {
        notes.push(
            "One run only: its parts are used as runs, and whether the result holds for other runs remains open."
                .into(),
        );
    }
    if logs.runs.len() > 1 && logs.runs.windows(2).all(|pair| same_commands(&pair[0], &pair[1])) {
        notes.push(
            "All runs have the same commands: effects that show only under other commands are not excited.".into(),
        );
    }
    let moved_uncommanded = knows_motion && !is_commanded(observations) && moves(observations);
    let is_compared = baseline.motion.is_some();
    let knows = |channel| knows_witness(baseline, channel);
    let scope = Scope::without(&reasons).with_witnesses(&witnesses(observations), is_compared, knows);
    Ok(Validated { notes, scope, moved_uncommanded })
}

/// Returns whether a witness was logged that the baseline knows.
fn is_witnessed(baseline: &Baseline, observations: &Observations) -> bool {
    witnesses(observations).into_iter().any(|channel| knows_witness(baseline, channel))
}

fn knows_witness(baseline: &Baseline, channel: Channel) -> bool {
    let knows = |motion: &MotionModel| channel == Channel::Gyro || motion.knows_wheels();
    baseline.motion.as_ref().is_some_and(knows)
}

/// Returns the witnesses that were logged.
fn witnesses(observations: &Observations) -> Vec<Channel> {
    let has_counters = observations.rows.iter().any(|row| row.wheels_cm.is_some());
    let has_gyro = observations.rows.iter().any(|row| row.gyro_rad.is_some());
    let is_logged = |channel: &Channel| if *channel == Channel::Gyro { has_gyro } else { has_counters };
    Channel::WITNESSES.into_iter().filter(is_logged).collect()
}

/// Returns why motion cannot be compared, if it cannot.
fn without_motion(baseline: &Baseline, observations: &Observations) -> Option<&'static str> {
    if baseline.motion.is_none() {
        Some("The simulator has no model of motion, since its training logs had too few poses: motion is not compared.")
    } else if observations.rows.iter().all(|row| row.motion.is_none()) {
        Some("No run has two poses: motion cannot be compared.")
    } else if is_commanded(observations) {
        None
    } else if moves(observations) {
        Some("No command drives the motors, but the robot moves: motion is not excited, and its cause is not logged.")
    } else {
        Some("The motors stand still: motion is not excited.")
    }
}

/// Returns whether any command drives a motor.
fn is_commanded(observations: &Observations) -> bool {
    let mut steps = observations.rows.iter().flat_map(|row| std::iter::once(&row.context).chain(&row.following_steps));
    steps.any(|step| step.commands[0].iter().any(|c| c.abs() >= 1.0))
}

/// Returns whether the robot leaves its median pose for a part of some run.
fn moves(observations: &Observations) -> bool {
    observations.rows.chunk_by(|a, b| a.run == b.run).any(|rows| {
        let first = rows[0].context.pose;
        let turned = |row: &Observation| wrap_rad(row.context.pose.heading_rad - first.heading_rad);
        let median_of = |number: &dyn Fn(&Observation) -> f64| median(rows.iter().map(number));
        let x_cm = median_of(&|row| row.context.pose.position_cm.x);
        let y_cm = median_of(&|row| row.context.pose.position_cm.y);
        let turn_rad = median_of(&turned);
        let is_away = |row: &&Observation| {
            row.context.pose.position_cm.distance(DVec2::new(x_cm, y_cm)) > STANDING_CM
                || wrap_rad(turned(row) - turn_rad).abs() > STANDING_RAD
        };
        rows.iter().filter(is_away).count() as f64 >= MOVED * rows.len() as f64
    })
}

/// Returns why the sensor cannot be compared, if it cannot.
fn without_sonar(baseline: &Baseline, observations: &Observations, logs: &Logs) -> Option<&'static str> {
    if is_untracked(logs) {
        Some("The robot was not tracked, so that nobody knows what its sensor faced: the sonar is not compared.")
    // The textbook's sensor is fitted to the readings themselves.
    } else if observations.rows.iter().all(|row| row.echo_cm.is_none()) {
        Some("There are no readings: the sonar is not compared.")
    } else if baseline.sonar.is_none() {
        Some(
            "The simulator has no model of the sonar, since its training logs had too few readings: the sonar is not compared.",
        )
    } else {
        None
    }
}

fn same_commands(a: &Run, b: &Run) -> bool {
    a.rows.iter().zip(&b.rows).all(|(a, b)| a.command() == b.command())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{alternating, baseline, baseline_with_sonar, driven};
    use mindgap_foundations::channel::Channel;
    use mindgap_foundations::geometry::Pose;

    /// Returns commands that differ from run to run.
    fn mixed(run: usize, at: usize) -> [f64; 2] {
        [10.0 * run as f64 + 5.0, 20.0 + at as f64]
    }

    fn notes_of(logs: &Logs) -> (Vec<String>, Baseline<'static>) {
        let mut baseline = baseline_with_sonar();
        let inspected = Inspection::new(logs.clone());
        let rows = Observations::of(&inspected.logs, None, None);
        let validated = validate(&mut baseline, &rows, &inspected).expect("something to compare");
        (validated.notes, baseline)
    }

    /// Returns whether there is exactly one note, with this beginning.
    fn only(notes: &[String], begin: &str) -> bool {
        matches!(notes, [note] if note.starts_with(begin))
    }

    #[test]
    fn complete_logs_have_no_note() {
        let (notes, baseline) = notes_of(&driven(8, 4, mixed));
        assert!(notes.is_empty(), "{notes:?}");
        assert!(baseline.motion.is_some() && baseline.sonar.is_some());
    }

    #[test]
    fn what_logs_do_not_contain_is_removed_from_the_baseline() {
        let mut silent = driven(8, 4, mixed);
        silent.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| row.echo_cm = None));
        let (notes, baseline) = notes_of(&silent);
        assert!(only(&notes, "There are no readings") && baseline.sonar.is_none(), "{notes:?}");

        let mut unseen = driven(8, 4, mixed);
        unseen
            .runs
            .iter_mut()
            .for_each(|run| (1..run.rows.len()).for_each(|k| run.rows.edit(k, |row| row.pose = None)));
        let (notes, baseline) = notes_of(&unseen);
        assert!(only(&notes, "No run has two poses") && baseline.motion.is_none(), "{notes:?}");

        let (notes, baseline) = notes_of(&driven(8, 4, |_, _| [0.0; 2]));
        assert!(notes[0].starts_with("The motors stand still") && baseline.motion.is_none(), "{notes:?}");
    }

    #[test]
    fn of_an_untracked_robot_its_own_measurements_are_compared() {
        let untracked = |counts: bool| {
            let mut logs = driven(8, 4, mixed);
            for row in logs.runs.iter_mut().map(|run| &mut run.rows) {
                row.edit_each(|row| {
                    row.pose = None;
                    let counted = counts.then_some(row.t_ms);
                    (row.rot_left_deg, row.rot_right_deg) = (counted, counted);
                });
            }
            let inspected = Inspection { logs, findings: Vec::new() };
            let mut baseline = baseline_with_sonar();
            let rows = Observations::of(&inspected.logs, baseline.motion.as_ref(), baseline.sonar.as_ref());
            validate(&mut baseline, &rows, &inspected)
        };
        let Validated { notes, scope, .. } = untracked(true).expect("counters");
        assert!(notes[0].starts_with("The robot was not tracked: of its motion only"), "{notes:?}");
        assert_eq!(scope.compared, [Channel::RotLeft, Channel::RotRight]);
        assert_eq!(scope.not_compared.len(), 5);
        assert!(untracked(false).is_err());
    }

    /// Returns whether a robot with zero commands moved, for runs of twenty rows with changed poses.
    fn moved_uncommanded(change: impl Fn(usize, &mut Pose)) -> bool {
        let mut logs = driven(8, 20, |_, _| [0.0; 2]);
        for run in &mut logs.runs {
            (0..run.rows.len()).for_each(|at| run.rows.edit_pose(at, |pose| change(at, pose)));
        }
        let rows = Observations::of(&logs, None, None);
        let inspected = Inspection { logs, findings: Vec::new() };
        let validated = validate(&mut baseline_with_sonar(), &rows, &inspected).expect("a sensor");
        let reason = &validated.scope.not_compared[0].reason;
        assert_eq!(reason.contains("the robot moves"), validated.moved_uncommanded, "{reason}");
        validated.moved_uncommanded
    }

    #[test]
    fn motion_without_commands_differs_from_tracker_noise_and_jumps() {
        assert!(!moved_uncommanded(|_, _| ()));
        assert!(!moved_uncommanded(|at, pose| pose.position_cm.x += 1.5 * alternating(at)));
        assert!(!moved_uncommanded(|at, pose| pose.position_cm.x += if at == 7 { 60.0 } else { 0.0 }));
        assert!(moved_uncommanded(|at, pose| pose.position_cm.y += at as f64));
        assert!(moved_uncommanded(|at, pose| pose.heading_rad = wrap_rad(pose.heading_rad + 0.1 * at as f64)));
    }

    #[test]
    fn missing_models_are_noted() {
        let logs = driven(8, 4, mixed);
        let rows = Observations::of(&logs, None, None);
        let inspected = Inspection::new(logs);
        let Validated { notes, scope, .. } = validate(&mut baseline(), &rows, &inspected).expect("motion");
        assert!(only(&notes, "The simulator has no model of the sonar"), "{notes:?}");
        assert_eq!(scope.compared, [Channel::Forward, Channel::Lateral, Channel::Turn]);
        let mut without_motion = Baseline { motion: None, ..baseline_with_sonar() };
        let Validated { notes, scope, .. } = validate(&mut without_motion, &rows, &inspected).expect("a sensor");
        assert!(only(&notes, "The simulator has no model of motion"), "{notes:?}");
        assert_eq!(scope.compared, [Channel::EchoRate, Channel::EchoValue]);
        assert!(scope.not_compared.iter().all(|channel| channel.reason == notes[0]));
        assert!(validate(&mut Baseline { motion: None, ..baseline() }, &rows, &inspected).is_err());
    }

    #[test]
    fn single_run_and_equal_runs_are_noted() {
        assert!(only(&notes_of(&driven(1, 16, mixed)).0, "One run only"));
        let mut equal = driven(8, 4, |_, at| mixed(0, at));
        // Runs that agree in every number would count as copies.
        for (number, run) in equal.runs.iter_mut().enumerate() {
            run.rows.edit_poses(|pose| pose.position_cm.y += number as f64);
        }
        assert!(only(&notes_of(&equal).0, "All runs have the same commands"));
    }

    #[test]
    fn what_an_inspection_excludes_is_not_compared() {
        let mut exchanged = driven(8, 31, |run, at| {
            [((run * 7 + at * 13) % 9) as f64 * 20.0 - 80.0, ((run * 5 + at * 11) % 7) as f64 * 25.0 - 75.0]
        });
        exchanged.runs.iter_mut().for_each(|run| {
            run.rows.edit_each(|row| (row.left, row.right) = (row.right, row.left));
        });
        let inspected = Inspection::new(exchanged);
        let rows = Observations::of(&inspected.logs, None, None);
        let mut baseline = baseline_with_sonar();
        let scope = validate(&mut baseline, &rows, &inspected).expect("a sensor").scope;
        assert!(baseline.motion.is_none() && baseline.sonar.is_some());
        assert_eq!(scope.not_compared.len(), 3);
        assert!(scope.not_compared.iter().all(|channel| channel.reason.contains("left and right seem exchanged")));
    }

    #[test]
    fn whole_segments_are_compared_if_no_step_has_both_poses() {
        let mut logs = driven(8, 5, mixed);
        for run in &mut logs.runs {
            (1..run.rows.len()).step_by(2).for_each(|k| run.rows.edit(k, |row| row.pose = None));
        }
        let (notes, baseline) = notes_of(&logs);
        assert!(only(&notes, "No step has a pose at both ends") && baseline.motion.is_some(), "{notes:?}");
    }
}
