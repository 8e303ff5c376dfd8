//! Proof of a patch: the user's simulator drives the robot's own commands with the patched model file.

use std::fs;
use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use super::sides;
use mindgap_diagnosis::split;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::statistics::summary::median;
use mindgap_import::bag;
use mindgap_learning::evaluation::paths::PathError;
use mindgap_logs::range_sensor::Sensors;
use mindgap_logs::{Logs, Robot, Run};
use mindgap_workers::program::Program;

/// How far path ends are from the robot's, before and after a patch.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Verification {
    /// Length of the paths, steps.
    pub steps: usize,
    /// Median distance of path ends before the patch, by the simulator learned from its recordings, cm.
    pub before_cm: f64,
    /// Median distance of path ends with the patched file, driven by the command, cm.
    pub after_cm: f64,
    /// Whether the patch was withdrawn because it did not bring path ends nearer.
    pub withdrawn: bool,
}

/// A simulator that is run by a command.
pub struct Verifier<'a> {
    /// The command, with its timeout.
    pub command: Program,
    /// Folder in which commands and recordings stay, if they should.
    pub folder: Option<&'a Path>,
    /// The robot's logs.
    pub real: &'a Logs,
}

/// Lengths of paths, steps.
const STEPS: [usize; 2] = [10, 25];

impl Verifier<'_> {
    /// Drives held-out runs with a patched model and compares path ends with those `before` the patch. Only if the patch `moves`
    /// the robot is it withdrawn where ends get no nearer.
    ///
    /// # Errors
    /// If the command fails twice, or its recording cannot be read.
    pub fn verify(&self, before: &[PathError], model: &Path, moves: bool) -> Result<Vec<Verification>> {
        let temporary = tempfile::tempdir().map_err(|e| Error::new(format!("no temporary folder can be made: {e}")))?;
        let folder = self.folder.unwrap_or(temporary.path());
        let mut ends_cm = STEPS.map(|_| Vec::new());
        for run in self.held_out() {
            let path = self.drive(folder, model, run)?;
            for (steps, ends_cm) in STEPS.into_iter().zip(&mut ends_cm) {
                ends_cm.extend(distances(run, &path, steps));
            }
        }
        let length = |(steps, ends_cm): (usize, Vec<f64>)| {
            let before_cm = before.iter().find(|error| error.steps == steps)?.before_cm;
            (!ends_cm.is_empty()).then(|| (steps, before_cm, median(ends_cm.into_iter())))
        };
        let lengths: Vec<(usize, f64, f64)> = STEPS.into_iter().zip(ends_cm).filter_map(length).collect();
        let farther = lengths.iter().map(|(_, before_cm, after_cm)| libm::log(after_cm / before_cm)).sum::<f64>();
        let withdrawn = moves && !lengths.is_empty() && farther >= 0.0;
        let verification = |(steps, before_cm, after_cm)| Verification { steps, before_cm, after_cm, withdrawn };
        Ok(lengths.into_iter().map(verification).collect())
    }

    /// Returns the runs on which the diagnosis confirmed its causes; all of them, if they are few.
    fn held_out(&self) -> Vec<&Run> {
        let runs = &self.real.runs;
        let confirms = |run: usize| runs.len() < split::FEWEST_RUNS || split::is_held_out(run);
        runs.iter().zip(0..).filter(|(_, i)| confirms(*i)).map(|(run, _)| run).collect()
    }

    /// Drives the commands of a run with a model file, and returns the path. A failure is repeated once.
    fn drive(&self, folder: &Path, model: &Path, run: &Run) -> Result<Vec<(f64, Pose)>> {
        let commands = files::absolute(&folder.join(format!("{}-commands.csv", run.name)))?;
        let out = files::absolute(&folder.join(format!("{}.csv", run.name)))?;
        let model = files::absolute(model)?;
        files::write(&commands, run.script_text())?;
        let once = || {
            // What a call before it left is no answer of this one.
            let _ = fs::remove_file(&out);
            self.command.run(&[model.as_ref(), commands.as_ref(), out.as_ref()])?;
            if !out.exists() {
                return Err(Error::in_file(&out, "was not written by the simulator's command"));
            }
            self.path_of(&commands, &out)
        };
        once().or_else(|_| once())
    }

    /// Returns the robot and its range sensors.
    fn robot(&self) -> (Robot, Sensors) {
        (self.real.robot, self.real.sensors())
    }

    /// Reads what a simulator recorded: a run log, a bag, or poses as CSV.
    fn path_of(&self, commands: &Path, out: &Path) -> Result<Vec<(f64, Pose)>> {
        let of_run = |run: &Run| {
            let first_ms = run.rows.first().map_or(0.0, |row| row.t_ms);
            run.rows.iter().filter_map(|row| Some((row.t_ms - first_ms, row.pose?))).collect::<Vec<_>>()
        };
        if out.is_dir() || bag::is_bag(out) {
            let logs = sides::read(&[out.into()], Some(self.robot()), &self.real.scene, |_| ())?;
            return logs.runs.first().map(of_run).ok_or_else(|| Error::in_file(out, "holds no run"));
        }
        let required = ["t_ms", "left", "right", "x_cm", "y_cm", "heading_deg"];
        if let Ok(run) = Run::read_with(out, &required, |_| ()) {
            return Ok(of_run(&run));
        }
        let both = [commands.to_owned(), out.to_owned()];
        let alone = sides::read(&both[1..], Some(self.robot()), &self.real.scene, |_| ());
        let logs = alone.or_else(|_| sides::read(&both, Some(self.robot()), &self.real.scene, |_| ()))?;
        logs.runs.first().map(of_run).ok_or_else(|| Error::in_file(out, "holds no run"))
    }
}

/// Returns how far the ends of paths of some steps are from one another, relative to the poses at which they begin.
fn distances(run: &Run, path: &[(f64, Pose)], steps: usize) -> Vec<f64> {
    let first_ms = run.rows.first().map_or(0.0, |row| row.t_ms);
    let last = run.rows.len().saturating_sub(steps);
    let between = |from: usize| {
        let [start, end] = [run.rows.at(from), run.rows.at(from + steps)];
        let real = start.pose?.relative(&end.pose?);
        let simulated = at(path, start.t_ms - first_ms)?.relative(&at(path, end.t_ms - first_ms)?);
        Some(real.position_cm.distance(simulated.position_cm))
    };
    (0..last).step_by(steps.div_ceil(2)).filter_map(between).collect()
}

/// Returns the pose at a time, interpolated between the two around it.
fn at(path: &[(f64, Pose)], t_ms: f64) -> Option<Pose> {
    let after = path.partition_point(|(ms, _)| *ms < t_ms);
    let (later_ms, later) = path.get(after)?;
    let Some((earlier_ms, earlier)) = after.checked_sub(1).map(|i| path[i]) else {
        return (*later_ms == t_ms).then_some(*later);
    };
    let share = (t_ms - earlier_ms) / (later_ms - earlier_ms);
    let motion = earlier.relative(later);
    Some(earlier.compose(&Pose { position_cm: motion.position_cm * share, heading_rad: motion.heading_rad * share }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_logs::{Row, Rows};

    fn run(cm_per_row: f64) -> Run {
        let mut rows = Rows::default();
        for k in 0..31 {
            let pose = Some(Pose::new(5.0 + cm_per_row * f64::from(k), 0.0, 0.0));
            rows.push(Row { t_ms: 400.0 * f64::from(k), left: 50.0, right: 50.0, pose, ..Row::default() });
        }
        Run { name: "run-003".into(), rows }
    }

    #[test]
    fn ends_are_compared_from_where_paths_begin() {
        let path: Vec<(f64, Pose)> = (0..31)
            .map(|k| (400.0 * f64::from(k), Pose::new(0.0, 0.9 * 10.0 * f64::from(k), std::f64::consts::FRAC_PI_2)))
            .collect();
        let apart = distances(&run(10.0), &path, 10);
        assert_eq!(apart.len(), 5);
        assert!(apart.iter().all(|cm| (cm - 10.0).abs() < 1e-9), "{apart:?}");
        assert_eq!(distances(&run(10.0), &path, 25).len(), 1);
        assert!(distances(&run(10.0), &path[..9], 10).is_empty());
    }
}
