//! Checks the log of a script before it is used: it must be a complete run of this robot under these commands.

use std::path::Path;

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::inspection::Inspection;
use mindgap_logs::{Logs, Run};

/// The expectations that a log is checked against.
pub struct ScriptCheck<'a> {
    /// The first logs, of the same robot and scene.
    pub first: &'a Logs,
    /// The script that was to be driven.
    pub script: &'a Run,
}

/// Commands that differ by no more were rounded.
const ROUNDING: f64 = 1.0;
/// Least share of the moving rows with a command of the script. Rows at a change of commands may have their mean or, since rows
/// jitter, the other command; a log of another drive agrees in few rows.
const LEAST_AGREEMENT: f64 = 0.5;

impl ScriptCheck<'_> {
    /// Reads and checks a log.
    ///
    /// # Errors
    /// If the log has a defect that forbids learning from it.
    pub fn read(&self, path: &Path) -> Result<Run> {
        let run = self.first.read_further(path)?;
        if !files::read_text(path)?.ends_with('\n') {
            return Err(Error::in_file(path, "is incomplete: its last line has no line end"));
        }
        self.check_commands(&run).map_err(|error| error.or_in_file(path))?;
        let logs = Logs { robot: self.first.robot, scene: self.first.scene.clone(), runs: vec![run.clone()] };
        logs.check_step(path)?;
        if logs.runs[0].rows.iter().filter(|row| row.pose.is_some()).count() < 2 {
            return Err(Error::in_file(path, "has no poses"));
        }
        match Inspection::new(logs).refusal() {
            Some(why) => Err(Error::in_file(path, why.to_owned())),
            None => Ok(run),
        }
    }

    /// Checks that the robot drove the script, up to where it was stopped.
    fn check_commands(&self, run: &Run) -> Result<()> {
        let is_moving = |command: [f64; 2]| command != [0.0; 2];
        let moving: Vec<(f64, [f64; 2])> =
            run.rows.iter().map(|row| (row.t_ms, row.command())).filter(|(_, command)| is_moving(*command)).collect();
        let should_move = self.script.rows.iter().any(|row| is_moving(row.command()));
        if moving.is_empty() && should_move {
            return Err(Error::new("has no command other than 0: the script was not driven"));
        }
        let first_ms = run.rows.first().map_or(0.0, |row| row.t_ms);
        let agreeing = moving.iter().filter(|(t_ms, command)| self.commands_at(t_ms - first_ms, *command)).count();
        if (agreeing as f64) < LEAST_AGREEMENT * moving.len() as f64 {
            let count = moving.len();
            return Err(Error::new(format!("is of another drive: {agreeing} of {count} commands are the script's")));
        }
        Ok(())
    }

    /// Returns whether the script has a command at a time, give or take half a step.
    fn commands_at(&self, t_ms: f64, [left, right]: [f64; 2]) -> bool {
        let half_ms = 0.5 * self.first.robot.step_ms;
        let rows = &self.script.rows;
        let first_ms = rows.first().map_or(0.0, |row| row.t_ms);
        let [from, to] = [-half_ms, half_ms].map(|off| rows.first_later_than(first_ms + t_ms + off).saturating_sub(1));
        (from..=to).filter_map(|at| rows.get(at)).any(|row| {
            let [l, r] = row.command();
            (l - left).abs() <= ROUNDING && (r - right).abs() <= ROUNDING
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_built_in_robot::{default_robot, training_room};
    use mindgap_logs::Row;

    fn run(commands: &[[f64; 2]], jitter_ms: f64) -> Run {
        let row = |(k, [left, right]): (usize, &[f64; 2])| {
            let jitter_ms = if k % 2 == 0 { jitter_ms } else { -jitter_ms };
            Row { t_ms: 1000.0 + 400.0 * k as f64 + jitter_ms, left: *left, right: *right, ..Row::default() }
        };
        Run { name: "run-000".into(), rows: commands.iter().enumerate().map(row).collect() }
    }

    fn checked(script: &[[f64; 2]], driven: &[[f64; 2]], jitter_ms: f64) -> String {
        let first = Logs { robot: default_robot(), scene: training_room(), runs: Vec::new() };
        let check = ScriptCheck { first: &first, script: &run(script, 0.0) };
        check.check_commands(&run(driven, jitter_ms)).map_or_else(|e| e.to_string(), |()| "right".into())
    }

    #[test]
    fn a_log_must_have_the_commands_of_its_script() {
        let script = [[40.0, -40.0], [40.0, -40.0], [-25.0, -25.0], [60.0, 20.0], [0.0, 0.0]];
        assert_eq!(checked(&script, &script, 90.0), "right", "rows jitter");
        let stopped = [[40.0, -40.0], [40.4, -40.0], [0.0, 0.0]];
        assert_eq!(checked(&script, &stopped, 0.0), "right", "the robot was stopped in time");
        let other = [[10.0, 10.0]; 4];
        assert_eq!(checked(&script, &other, 0.0), "is of another drive: 0 of 4 commands are the script's");
        assert!(checked(&script, &[[0.0; 2]; 4], 0.0).starts_with("has no command other than 0"));
        assert_eq!(checked(&[[0.0; 2]; 4], &[[0.0; 2]; 4], 0.0), "right", "standing still is a script too");
    }
}
