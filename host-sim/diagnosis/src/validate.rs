//! Validation: whether logs are of the simulator's robot, and what they cannot say.

use glam::DVec2;

use super::scope::Scope;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::wrap_rad;
use mindgap_foundations::statistics::summary::median;
use mindgap_learning::evaluation::observations::{Observation, Observations};
use mindgap_logs::inspection::{Inspection, Part};
use mindgap_logs::{Robot, Run};
use mindgap_models::simulator::baseline::Baseline;

/// Two people who measure one robot agree to this share.
const SAME: f64 = 0.02;
/// The track of a robot that stands scatters by less: a camera's marker by a centimetre or two,
const STANDING_CM: f64 = 4.0;
/// and a compass by a few degrees (here 15).
const STANDING_RAD: f64 = 0.26;
/// A robot moved where at least this share of a run's poses lies beyond: a few jumps of the tracker are fewer.
const MOVED: f64 = 0.1;

/// Checks that logs are of the robot that the simulator was learned from.
///
/// # Errors
/// Names the first measurement that differs.
pub fn same_robot(simulator: &Robot, logs: &Robot) -> Result<()> {
    let measures = |r: &Robot| {
        [
            ("step_ms", r.step_ms),
            ("wheel_diameter_cm", r.wheel_diameter_cm),
            ("track_cm", r.track_cm),
            ("full_speed_cm_s", r.full_speed_cm_s),
            ("ultrasonic.x_cm", r.ultrasonic.x_cm),
            ("ultrasonic.y_cm", r.ultrasonic.y_cm),
            ("ultrasonic.yaw_deg", r.ultrasonic.yaw_deg),
        ]
    };
    // Where a sensor lies matters where both have one: the last three.
    let compared = if simulator.ultrasonic.is_none() || logs.ultrasonic.is_none() { 4 } else { 7 };
    let pairs = measures(simulator).into_iter().zip(measures(logs)).take(compared);
    match pairs.into_iter().find(|((_, a), (_, b))| (a - b).abs() > SAME * a.abs().max(1.0)) {
        Some(((name, a), (_, b))) => Err(Error::new(format!(
            "these are logs of another robot than the simulator's: {name} is {b} in the logs' robot.toml and {a} in the simulator; \
             mend robot.toml, or train a simulator of this robot"
        ))),
        None => Ok(()),
    }
}

/// What a diagnosis can speak of.
pub struct Validated {
    /// What limits it.
    pub notes: Vec<String>,
    /// What it compares.
    pub scope: Scope,
    /// Whether the robot moved though no command asked for it: a gap, whatever else agrees.
    pub moved_uncommanded: bool,
}

/// Takes out of a baseline what the logs say nothing about or must not be asked for, and tells it, with what else limits a
/// diagnosis.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn validate(baseline: &mut Baseline, observations: &Observations, inspected: &Inspection) -> Result<Validated> {
    let knows_motion = baseline.motion.is_some();
    let logs = &inspected.logs;
    let mut notes = Vec::new();
    let mut reasons = Vec::new();
    if let Some(why) = inspected.withheld(Part::Motion) {
        reasons.push((Part::Motion, why.to_owned()));
        baseline.motion = None;
    } else if let Some(why) = without_motion(baseline, observations) {
        notes.push(why.to_owned());
        reasons.push((Part::Motion, why.to_owned()));
        baseline.motion = None;
    }
    if observations.rows.iter().any(|row| !row.then.is_empty()) {
        notes.push("No step has a pose at both ends: whole ways between poses are compared.".into());
    }
    if let Some(why) = inspected.withheld(Part::Sonar) {
        reasons.push((Part::Sonar, why.to_owned()));
        baseline.sonar = None;
    } else if let Some(why) = without_sonar(baseline, observations) {
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
        notes.push("One run only: its parts stand for runs, and what holds for other runs cannot be told.".into());
    }
    if logs.runs.len() > 1 && logs.runs.windows(2).all(|pair| same_commands(&pair[0], &pair[1])) {
        notes.push("All runs have the same commands: what other commands would show is not excited.".into());
    }
    let moved_uncommanded = knows_motion && !is_commanded(observations) && moves(observations);
    Ok(Validated { notes, scope: Scope::without(&reasons), moved_uncommanded })
}

/// Why motion cannot be compared.
fn without_motion(baseline: &Baseline, observations: &Observations) -> Option<&'static str> {
    if baseline.motion.is_none() {
        Some("From too few logs, or none with poses, the simulator does not know motion: it is not compared.")
    } else if observations.rows.iter().all(|row| row.motion.is_none()) {
        Some("No run has two poses: motion cannot be compared.")
    } else if is_commanded(observations) {
        None
    } else if moves(observations) {
        Some(
            "No command drives the motors, but the robot moves: motion is not excited, and what causes it is not logged.",
        )
    } else {
        Some("The motors stand still: motion is not excited.")
    }
}

/// Whether any command drives a motor.
fn is_commanded(observations: &Observations) -> bool {
    let mut steps = observations.rows.iter().flat_map(|row| std::iter::once(&row.context).chain(&row.then));
    steps.any(|step| step.commands[0].iter().any(|c| c.abs() >= 1.0))
}

/// Whether the robot is elsewhere, in a part of some run, than where it mostly is.
fn moves(observations: &Observations) -> bool {
    observations.rows.chunk_by(|a, b| a.run == b.run).any(|rows| {
        let first = rows[0].context.pose;
        let turned = |row: &Observation| wrap_rad(row.context.pose.heading_rad - first.heading_rad);
        let of = |number: &dyn Fn(&Observation) -> f64| median(rows.iter().map(number));
        let x_cm = of(&|row| row.context.pose.position_cm.x);
        let y_cm = of(&|row| row.context.pose.position_cm.y);
        let turn_rad = of(&turned);
        let is_away = |row: &&Observation| {
            row.context.pose.position_cm.distance(DVec2::new(x_cm, y_cm)) > STANDING_CM
                || wrap_rad(turned(row) - turn_rad).abs() > STANDING_RAD
        };
        rows.iter().filter(is_away).count() as f64 >= MOVED * rows.len() as f64
    })
}

/// Why the sensor cannot be compared.
fn without_sonar(baseline: &Baseline, observations: &Observations) -> Option<&'static str> {
    // The textbook's sensor is made from the readings themselves.
    if observations.rows.iter().all(|row| row.echo_cm.is_none()) {
        Some("There is no reading at all: the sonar is not compared.")
    } else if baseline.sonar.is_none() {
        Some("From too few readings, or none, the simulator does not know the sonar: it is not compared.")
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
    use crate::channel::Channel;
    use crate::test_support::{alternating, baseline, baseline_with_sonar, driven, robot};
    use mindgap_foundations::geometry::Pose;
    use mindgap_logs::Logs;

    /// Commands that differ from run to run.
    fn mixed(run: usize, at: usize) -> [f64; 2] {
        [10.0 * run as f64 + 5.0, 20.0 + at as f64]
    }

    fn notes_of(logs: &Logs) -> (Vec<String>, Baseline<'static>) {
        let mut baseline = baseline_with_sonar();
        let inspected = Inspection::of(logs.clone());
        let rows = Observations::of(&inspected.logs, None);
        let validated = validate(&mut baseline, &rows, &inspected).expect("something to compare");
        (validated.notes, baseline)
    }

    /// Whether there is one note, which begins so.
    fn only(notes: &[String], begin: &str) -> bool {
        matches!(notes, [note] if note.starts_with(begin))
    }

    #[test]
    fn logs_that_say_everything_need_no_note() {
        let (notes, baseline) = notes_of(&driven(8, 4, mixed));
        assert!(notes.is_empty(), "{notes:?}");
        assert!(baseline.motion.is_some() && baseline.sonar.is_some());
    }

    #[test]
    fn what_the_logs_do_not_say_is_taken_out_of_the_baseline() {
        let mut silent = driven(8, 4, mixed);
        silent.runs.iter_mut().for_each(|run| run.rows.edit_each(|row| row.echo_cm = None));
        let (notes, baseline) = notes_of(&silent);
        assert!(only(&notes, "There is no reading at all") && baseline.sonar.is_none(), "{notes:?}");

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

    /// Runs of twenty rows whose commands are zero and whose poses are changed.
    fn uncommanded(change: impl Fn(usize, &mut Pose)) -> bool {
        let mut logs = driven(8, 20, |_, _| [0.0; 2]);
        for run in &mut logs.runs {
            (0..run.rows.len()).for_each(|at| run.rows.edit_pose(at, |pose| change(at, pose)));
        }
        let rows = Observations::of(&logs, None);
        let inspected = Inspection { logs, findings: Vec::new() };
        let validated = validate(&mut baseline_with_sonar(), &rows, &inspected).expect("a sensor");
        let reason = &validated.scope.not_compared[0].reason;
        assert_eq!(reason.contains("the robot moves"), validated.moved_uncommanded, "{reason}");
        validated.moved_uncommanded
    }

    #[test]
    fn motion_without_commands_is_told_from_the_noise_and_jumps_of_a_tracker() {
        assert!(!uncommanded(|_, _| ()));
        assert!(!uncommanded(|at, pose| pose.position_cm.x += 1.5 * alternating(at)));
        assert!(!uncommanded(|at, pose| pose.position_cm.x += if at == 7 { 60.0 } else { 0.0 }));
        assert!(uncommanded(|at, pose| pose.position_cm.y += at as f64));
        assert!(uncommanded(|at, pose| pose.heading_rad = wrap_rad(pose.heading_rad + 0.1 * at as f64)));
    }

    #[test]
    fn what_the_baseline_does_not_know_is_said() {
        let logs = driven(8, 4, mixed);
        let rows = Observations::of(&logs, None);
        let inspected = Inspection::of(logs);
        let Validated { notes, scope, .. } = validate(&mut baseline(), &rows, &inspected).expect("motion");
        assert!(only(&notes, "From too few readings"), "{notes:?}");
        assert_eq!(scope.compared, [Channel::Forward, Channel::Lateral, Channel::Turn]);
        let mut without_motion = Baseline { motion: None, ..baseline_with_sonar() };
        let Validated { notes, scope, .. } = validate(&mut without_motion, &rows, &inspected).expect("a sensor");
        assert!(only(&notes, "From too few logs"), "{notes:?}");
        assert_eq!(scope.compared, [Channel::EchoRate, Channel::EchoValue]);
        assert!(scope.not_compared.iter().all(|channel| channel.reason == notes[0]));
        assert!(validate(&mut Baseline { motion: None, ..baseline() }, &rows, &inspected).is_err());
    }

    #[test]
    fn one_run_and_equal_runs_are_said() {
        assert!(only(&notes_of(&driven(1, 16, mixed)).0, "One run only"));
        let mut equal = driven(8, 4, |_, at| mixed(0, at));
        // Runs that agree in every number are copies.
        for (number, run) in equal.runs.iter_mut().enumerate() {
            run.rows.edit_poses(|pose| pose.position_cm.y += number as f64);
        }
        assert!(only(&notes_of(&equal).0, "All runs have the same commands"));
    }

    #[test]
    fn what_an_inspection_withholds_is_not_compared() {
        let mut exchanged = driven(8, 31, |run, at| {
            [((run * 7 + at * 13) % 9) as f64 * 20.0 - 80.0, ((run * 5 + at * 11) % 7) as f64 * 25.0 - 75.0]
        });
        exchanged.runs.iter_mut().for_each(|run| {
            run.rows.edit_each(|row| (row.left, row.right) = (row.right, row.left));
        });
        let inspected = Inspection::of(exchanged);
        let rows = Observations::of(&inspected.logs, None);
        let mut baseline = baseline_with_sonar();
        let scope = validate(&mut baseline, &rows, &inspected).expect("a sensor").scope;
        assert!(baseline.motion.is_none() && baseline.sonar.is_some());
        assert_eq!(scope.not_compared.len(), 3);
        assert!(scope.not_compared.iter().all(|channel| channel.reason.contains("left and right seem exchanged")));
    }

    #[test]
    fn where_no_step_has_both_ends_whole_ways_are_compared() {
        let mut logs = driven(8, 5, mixed);
        for run in &mut logs.runs {
            (1..run.rows.len()).step_by(2).for_each(|k| run.rows.edit(k, |row| row.pose = None));
        }
        let (notes, baseline) = notes_of(&logs);
        assert!(only(&notes, "No step has a pose at both ends") && baseline.motion.is_some(), "{notes:?}");
    }

    #[test]
    fn a_robot_is_the_same_within_two_per_cent() {
        let logged = |track_cm: f64| same_robot(&robot(), &Robot { track_cm, ..robot() });
        assert!(logged(10.19).is_ok());
        let refusal = logged(10.3).expect_err("another robot").to_string();
        assert!(refusal.contains("track_cm is 10.3 in the logs' robot.toml and 10 in the simulator"), "{refusal}");
    }
}
