//! Checks a log before it is used: it must be a complete run of this controller on this robot from this start, seen by a
//! tracker at rest.

use std::fs;
use std::path::Path;

use mindgap_core::controller::Controller;

use super::robot::MAX_LOG_BYTES;
use super::state::{DrivenRun, place_cm};
use super::tuple_trace::TupleTrace;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::{Pose, wrap_rad};
use mindgap_learning::evaluation::observations::Observations;
use mindgap_learning::evaluation::predictions;
use mindgap_logs::inspection::Inspection;
use mindgap_logs::{Logs, Row, Run, Scene, Termination};
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::simulator::rollout::REACHED_CM;

/// Tolerance of a start pose set by hand.
const START_CM: f64 = 8.0;
const START_DEG: f64 = 15.0;
/// Clearance below which a tracked body counts as touching a wall.
const TOUCHING_CM: f64 = 1.5;
/// Maximum share of rows without a pose, and maximum number of them at the end.
const LOST_SHARE: f64 = 0.3;
const LOST_AT_THE_END: usize = 1;
/// Residual of one step beyond which the frame of the poses must have moved.
const JUMP_CM: f64 = 12.0;
const JUMP_DEG: f64 = 60.0;

/// The expectations that a log is checked against.
pub struct LogCheck<'a> {
    /// Simulator of the robot.
    pub simulator: &'a Simulator,
    /// Scene in which it drove.
    pub scene: &'a Scene,
    /// Requested start pose.
    pub start: Pose,
    /// Controller that was to be driven.
    pub controller: &'a Controller,
}

/// Moves the log that a robot wrote to its place. Only a regular file counts, which is complete since its robot has ended.
///
/// # Errors
/// If there is none, or it is too large for a log.
pub fn receive(out: &Path, log: &Path) -> Result<()> {
    let failed = |what: String| Err(Error::in_file(log, what));
    match fs::symlink_metadata(out) {
        Err(_) => failed("was not written by the robot".into()),
        Ok(about) if !about.is_file() => {
            failed("is not a regular file: the robot wrote a folder, a link, a pipe or a device".into())
        }
        Ok(about) if about.len() > MAX_LOG_BYTES => failed(format!("is larger than {} MB", MAX_LOG_BYTES >> 20)),
        Ok(_) => fs::rename(out, log).or_else(|e| failed(format!("cannot be written: {e}"))),
    }
}

impl LogCheck<'_> {
    /// Reads and checks a log, and summarises the run.
    ///
    /// # Errors
    /// If the log has a defect that forbids learning from it.
    pub fn read(&self, path: &Path) -> Result<(Run, DrivenRun)> {
        let run = Run::read_by(path, &self.simulator.sensors())?;
        if !files::read_text(path)?.ends_with('\n') {
            return Err(Error::in_file(path, "is incomplete: its last line has no line end"));
        }
        self.checked(run).map_err(|e| e.or_in_file(path))
    }

    fn checked(&self, run: Run) -> Result<(Run, DrivenRun)> {
        let driven = TupleTrace::of(self.controller, &run)?;
        self.check_start(&run)?;
        check_tracker(&run)?;
        let logs = Logs { robot: self.simulator.robot, scene: self.scene.clone(), runs: vec![run] };
        logs.check_step(Path::new("")).map_err(|_| Error::new("has another step length than the robot"))?;
        self.check_frame(&logs)?;
        let inspected = Inspection::new(logs);
        if let Some(why) = inspected.refusal() {
            return Err(Error::new(why));
        }
        let mut runs = inspected.logs.runs;
        let mut run = runs.pop().ok_or_else(|| Error::new("has no valid run"))?;
        let end = run.rows.iter().rev().find_map(|row| row.pose).ok_or_else(|| Error::new("has no valid pose"))?;
        let ending = self.ending(&driven, &end)?;
        let path_cm = run.rows.iter().filter_map(|row| row.pose).map(|pose| place_cm(pose.position_cm)).collect();
        if ending == Termination::Crashed {
            // Steps at a wall do not reflect the commands; the first step is kept even if it crashed.
            (self.free_rows(&run).max(2)..run.rows.len()).for_each(|row| run.rows.edit(row, |row| row.pose = None));
        }
        let target_cm = self.scene.target_cm.ok_or_else(|| Error::new("the scene has no target"))?;
        let distance_cm = end.position_cm.distance(target_cm);
        let reached = ending != Termination::Crashed && distance_cm <= REACHED_CM;
        let [end_x_cm, end_y_cm] = end.position_cm.to_array();
        Ok((run, DrivenRun { ending, steps: driven.steps, end_x_cm, end_y_cm, distance_cm, reached, path_cm }))
    }

    fn ending(&self, driven: &TupleTrace, end: &Pose) -> Result<Termination> {
        let steps = driven.steps;
        if self.touches(end) {
            Ok(Termination::Crashed)
        } else if steps >= usize::from(self.controller.max_steps) {
            // This includes a controller whose sixth tuple is still active.
            Ok(Termination::TimedOut)
        } else if driven.may_have_finished() {
            Ok(Termination::Finished)
        } else {
            Err(Error::new(format!(
                "ends after {steps} steps, before the controller did and without a wall nearby: incomplete log"
            )))
        }
    }

    fn touches(&self, pose: &Pose) -> bool {
        !self.scene.has_room_for(pose.position_cm, self.simulator.robot.body_radius_cm + TOUCHING_CM)
    }

    /// Returns the number of rows before the last one, without those at the end that touch a wall.
    fn free_rows(&self, run: &Run) -> usize {
        let last = run.rows.len().saturating_sub(1);
        let at_the_wall = |row: &Row| row.pose.is_none_or(|pose| self.touches(&pose));
        last - run.rows.iter().take(last).rev().take_while(|row| at_the_wall(row)).count()
    }

    fn check_start(&self, run: &Run) -> Result<()> {
        let Some(first) = run.rows.at(0).pose else {
            return Err(Error::new("line 2: the tracker has no pose at the start"));
        };
        let off_cm = first.position_cm.distance(self.start.position_cm);
        let off_deg = wrap_rad(first.heading_rad - self.start.heading_rad).abs().to_degrees();
        if off_cm > START_CM || off_deg > START_DEG {
            let what =
                format!("line 2: the run starts {off_cm:.0} cm and {off_deg:.0} degrees away from the start pose");
            return Err(Error::new(what));
        }
        Ok(())
    }

    /// Checks for steps that are physically impossible.
    fn check_frame(&self, logs: &Logs) -> Result<()> {
        let Some(motion) = Baseline::learned(self.simulator)?.motion else { return Ok(()) };
        let observations = Observations::of(logs, Some(&motion), None);
        let effects = self.simulator.chain();
        let free = logs.runs.first().map_or(0, |run| self.free_rows(run));
        for row in observations.rows.iter().filter(|row| row.at + 1 < free) {
            let Some([forward, lateral, turn_rad]) = predictions::residual(&effects, &motion, row) else { continue };
            if (forward * forward + lateral * lateral).sqrt() > JUMP_CM || turn_rad.abs().to_degrees() > JUMP_DEG {
                let what = format!("line {}: impossible jump of the pose", row.at + 2);
                return Err(Error::new(format!("{what}: the camera moved, or the tracker followed something else")));
            }
        }
        Ok(())
    }
}

fn check_tracker(run: &Run) -> Result<()> {
    let lost = run.rows.iter().filter(|row| row.pose.is_none()).count();
    let at_the_end = run.rows.iter().rev().take_while(|row| row.pose.is_none()).count();
    if lost as f64 > LOST_SHARE * run.rows.len() as f64 || at_the_end > LOST_AT_THE_END {
        let of = run.rows.len();
        return Err(Error::new(format!(
            "the tracker lost the robot in {lost} of {of} rows, {at_the_end} of them at the end"
        )));
    }
    Ok(())
}
