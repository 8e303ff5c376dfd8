//! Validation: whether logs are of the simulator's robot, and what they cannot say.

use super::condition::FEWEST_RUNS;
use crate::error::{Error, Result};
use crate::evaluation::observations::Observations;
use crate::logs::{Logs, Robot, Run};
use crate::simulator::baseline::Baseline;

/// Two people who measure one robot agree to this share.
const SAME: f64 = 0.02;
/// A step longer than this multiple of the distance at full speed is a jump of the tracker: a fresh battery adds a third.
const JUMP: f64 = 2.0;

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
    let pairs = measures(simulator).into_iter().zip(measures(logs));
    match pairs.into_iter().find(|((_, a), (_, b))| (a - b).abs() > SAME * a.abs().max(1.0)) {
        Some(((name, a), (_, b))) => Err(Error::new(format!(
            "these are logs of another robot than the simulator's: {name} is {b} in the logs' robot.toml and {a} in the simulator"
        ))),
        None => Ok(()),
    }
}

/// Takes out of a baseline what the logs say nothing about, and tells it, with what else limits a diagnosis.
///
/// # Errors
/// When the logs say nothing that the baseline could be compared with.
pub fn validate(baseline: &mut Baseline, observations: &Observations, logs: &Logs) -> Result<Vec<String>> {
    let mut notes = Vec::new();
    let steps = observations.rows.iter().filter(|row| row.motion.is_some()).count();
    let mut steps_of = observations.rows.iter().flat_map(|row| std::iter::once(&row.context).chain(&row.then));
    let driven = steps_of.any(|step| step.commands[0].iter().any(|c| c.abs() >= 1.0));
    if baseline.motion.is_none() {
        notes.push(
            "From too few logs, or none with poses, the simulator does not know motion: it is not compared.".into(),
        );
    } else if steps == 0 {
        notes.push("No run has two poses: motion cannot be compared.".into());
        baseline.motion = None;
    } else if !driven {
        notes.push("The motors stand still: motion is not excited.".into());
        baseline.motion = None;
    }
    if observations.rows.iter().any(|row| !row.then.is_empty()) {
        notes.push("No step has a pose at both ends: whole ways between poses are compared.".into());
    }
    let echoes = observations.rows.iter().filter(|row| row.echo_cm.is_some()).count();
    if baseline.sonar.is_none() {
        notes.push("From too few readings, or none, the simulator does not know the sonar: it is not compared.".into());
    } else if echoes == 0 {
        notes.push("There is no reading at all: the sonar is not compared.".into());
        baseline.sonar = None;
    }
    if baseline.motion.is_none() && baseline.sonar.is_none() {
        return Err(Error::new(format!("nothing can be compared. {}", notes.join(" "))));
    }
    if logs.runs.len() == 1 {
        notes.push("One run only: its parts stand for runs, and what holds for other runs cannot be told.".into());
    }
    if (2..FEWEST_RUNS).contains(&logs.runs.len()) {
        notes.push(format!(
            "With fewer than {FEWEST_RUNS} runs none is kept back: the gap shrinks on runs that were fitted."
        ));
    }
    if logs.runs.len() > 1 && logs.runs.windows(2).all(|pair| same_commands(&pair[0], &pair[1])) {
        notes.push("All runs have the same commands: what other commands would show is not excited.".into());
    }
    let reach_cm = JUMP * logs.robot.full_speed_cm_s * logs.robot.step_ms / 1000.0;
    let jumps = observations
        .rows
        .iter()
        .filter_map(|row| Some((row.motion?, (1 + row.then.len()) as f64)))
        .filter(|(m, steps)| libm::hypot(m.forward_cm, m.lateral_cm) > steps * reach_cm);
    match jumps.count() {
        0 => {}
        count => notes.push(format!("The tracker jumps {count} time(s), farther than the robot can drive.")),
    }
    Ok(notes)
}

fn same_commands(a: &Run, b: &Run) -> bool {
    a.rows.iter().zip(&b.rows).all(|(a, b)| a.command() == b.command())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::test_support::{baseline, baseline_with_sonar, driven, robot};

    /// Commands that differ from run to run.
    fn mixed(run: usize, at: usize) -> [f64; 2] {
        [10.0 * run as f64 + 5.0, 20.0 + at as f64]
    }

    fn notes_of(logs: &Logs) -> (Vec<String>, Baseline<'static>) {
        let mut baseline = baseline_with_sonar();
        let notes = validate(&mut baseline, &Observations::of(logs, 1.0), logs).expect("something to compare");
        (notes, baseline)
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
        silent.runs.iter_mut().flat_map(|run| &mut run.rows).for_each(|row| row.echo_cm = None);
        let (notes, baseline) = notes_of(&silent);
        assert!(only(&notes, "There is no reading at all") && baseline.sonar.is_none(), "{notes:?}");

        let mut unseen = driven(8, 4, mixed);
        unseen.runs.iter_mut().flat_map(|run| &mut run.rows[1..]).for_each(|row| row.pose = None);
        let (notes, baseline) = notes_of(&unseen);
        assert!(only(&notes, "No run has two poses") && baseline.motion.is_none(), "{notes:?}");

        let (notes, baseline) = notes_of(&driven(8, 4, |run, _| if run == 0 { [0.4; 2] } else { [0.0; 2] }));
        assert!(only(&notes, "The motors stand still") && baseline.motion.is_none(), "{notes:?}");
    }

    #[test]
    fn what_the_baseline_does_not_know_is_said() {
        let logs = driven(8, 4, mixed);
        let rows = Observations::of(&logs, 1.0);
        let notes = validate(&mut baseline(), &rows, &logs).expect("motion");
        assert!(only(&notes, "From too few readings"), "{notes:?}");
        let mut without_motion = Baseline { motion: None, ..baseline_with_sonar() };
        let notes = validate(&mut without_motion, &rows, &logs).expect("a sensor");
        assert!(only(&notes, "From too few logs"), "{notes:?}");
        assert!(validate(&mut Baseline { motion: None, ..baseline() }, &rows, &logs).is_err());
    }

    #[test]
    fn few_runs_and_equal_runs_are_said() {
        assert!(only(&notes_of(&driven(1, 16, mixed)).0, "One run only"));
        assert!(only(&notes_of(&driven(7, 4, mixed)).0, "With fewer than 8 runs"));
        assert!(only(&notes_of(&driven(8, 4, |_, at| mixed(0, at))).0, "All runs have the same commands"));
    }

    /// At full speed a step is 10 cm, so that 20 cm are a jump; the row after it is one back.
    #[test]
    fn jumps_of_the_tracker_are_counted() {
        let mut logs = driven(8, 4, mixed);
        let pose = logs.runs[2].rows[1].pose.as_mut().expect("a pose");
        pose.position_cm.y += 30.0;
        let (notes, _) = notes_of(&logs);
        assert!(only(&notes, "The tracker jumps 2 time(s)"), "{notes:?}");
    }

    #[test]
    fn where_no_step_has_both_ends_whole_ways_are_compared() {
        let mut logs = driven(8, 5, mixed);
        logs.runs.iter_mut().flat_map(|run| run.rows.iter_mut().skip(1).step_by(2)).for_each(|row| row.pose = None);
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
