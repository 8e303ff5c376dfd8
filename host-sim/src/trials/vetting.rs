//! What a log must be before anything is learned from it: a whole run of this controller on this robot from this start, as
//! a tracker at rest saw it.

use std::path::Path;

use mindgap_core::controller::Controller;

use super::driven::Driven;
use super::state::{Ending, Real, place_cm};
use crate::effects::chain::EffectChain;
use crate::error::{Error, Result};
use crate::evaluation::observations::Observations;
use crate::evaluation::predictions;
use crate::files;
use crate::geometry::{Pose, wrap_rad};
use crate::inspection::Inspection;
use crate::logs::{Logs, Row, Run, Scene};
use crate::simulator::Simulator;
use crate::simulator::baseline::Baseline;
use crate::simulator::rollout::REACHED_CM;

/// A robot that is put on its start by hand stands within this of it.
const START_CM: f64 = 8.0;
const START_DEG: f64 = 15.0;
/// A body this near to a wall touched it, as far as a tracker can tell.
const TOUCHING_CM: f64 = 1.5;
/// Most rows without a pose, and most of them at the end.
const LOST_SHARE: f64 = 0.3;
const LOST_AT_THE_END: usize = 1;
/// No robot that the simulator stands for is off by this in a step: the frame of the poses moved.
const JUMP_CM: f64 = 12.0;
const JUMP_DEG: f64 = 60.0;

/// What a log is held against.
pub struct Vetting<'a> {
    /// The robot, as far as it is known.
    pub simulator: &'a Simulator,
    /// Where it drove.
    pub scene: &'a Scene,
    /// Where it was to start.
    pub start: Pose,
    /// What it was to do.
    pub controller: &'a Controller,
}

impl Vetting<'_> {
    /// Reads a log, and how the run went.
    ///
    /// # Errors
    /// What is wrong with it, when nothing must be learned from it.
    pub fn read(&self, path: &Path) -> Result<(Run, Real)> {
        if !path.exists() {
            return Err(Error::in_file(path, "was not written by the robot"));
        }
        let run = Run::read(path, |_| {})?;
        if !files::read_text(path)?.ends_with('\n') {
            return Err(Error::in_file(path, "is half a log: its last line has no end"));
        }
        self.vetted(run).map_err(|e| e.or_in_file(path))
    }

    fn vetted(&self, run: Run) -> Result<(Run, Real)> {
        let driven = Driven::of(self.controller, &run)?;
        self.check_start(&run)?;
        check_tracker(&run)?;
        let logs = Logs { robot: self.simulator.robot, scene: self.scene.clone(), runs: vec![run] };
        logs.check_step(Path::new("")).map_err(|_| Error::new("has steps of another length than the robot's"))?;
        self.check_frame(&logs)?;
        let inspected = Inspection::of(logs);
        if let Some(why) = inspected.refusal() {
            return Err(Error::new(why));
        }
        let mut runs = inspected.logs.runs;
        let mut run = runs.pop().ok_or_else(|| Error::new("holds no run that counts"))?;
        let end =
            run.rows.iter().rev().find_map(|row| row.pose).ok_or_else(|| Error::new("has no pose that counts"))?;
        let ending = self.ending(&driven, &end)?;
        let path_cm = run.rows.iter().filter_map(|row| row.pose).map(|pose| place_cm(pose.position_cm)).collect();
        if ending == Ending::Crashed {
            // What a wall did to the robot says nothing of its commands; a run that crashes in its first step has no other.
            (self.free_rows(&run).max(2)..run.rows.len()).for_each(|row| run.rows.edit(row, |row| row.pose = None));
        }
        let target_cm = self.scene.target_cm.ok_or_else(|| Error::new("the scene has no target"))?;
        let distance_cm = end.position_cm.distance(target_cm);
        let reached = ending != Ending::Crashed && distance_cm <= REACHED_CM;
        let [end_x_cm, end_y_cm] = end.position_cm.to_array();
        Ok((run, Real { ending, steps: driven.steps, end_x_cm, end_y_cm, distance_cm, reached, path_cm }))
    }

    fn ending(&self, driven: &Driven, end: &Pose) -> Result<Ending> {
        let steps = driven.steps;
        if self.touches(end) {
            Ok(Ending::Crashed)
        } else if steps >= usize::from(self.controller.max_steps) {
            // One that holds its sixth tuple then has not finished either.
            Ok(Ending::TimedOut)
        } else if driven.may_have_finished() {
            Ok(Ending::Finished)
        } else {
            Err(Error::new(format!(
                "breaks off after {steps} steps, where the controller had not ended and no wall is near: half a log"
            )))
        }
    }

    fn touches(&self, pose: &Pose) -> bool {
        !self.scene.has_room_for(pose.position_cm, self.simulator.robot.body_radius_cm + TOUCHING_CM)
    }

    /// Rows before the last one and before those at the end that are at a wall.
    fn free_rows(&self, run: &Run) -> usize {
        let last = run.rows.len().saturating_sub(1);
        let at_the_wall = |row: &Row| row.pose.is_none_or(|pose| self.touches(&pose));
        last - run.rows.iter().take(last).rev().take_while(|row| at_the_wall(row)).count()
    }

    fn check_start(&self, run: &Run) -> Result<()> {
        let Some(first) = run.rows.at(0).pose else {
            return Err(Error::new("line 2: the tracker did not see the robot at the start"));
        };
        let off_cm = first.position_cm.distance(self.start.position_cm);
        let off_deg = wrap_rad(first.heading_rad - self.start.heading_rad).abs().to_degrees();
        if off_cm > START_CM || off_deg > START_DEG {
            let what = format!("line 2: the run starts {off_cm:.0} cm and {off_deg:.0} degrees off the start");
            return Err(Error::new(what));
        }
        Ok(())
    }

    /// Steps that no robot could have made.
    fn check_frame(&self, logs: &Logs) -> Result<()> {
        let Some(motion) = Baseline::learned(self.simulator)?.motion else { return Ok(()) };
        let observations = Observations::of(logs, Some(&motion), None);
        let effects = EffectChain::of(&self.simulator.added);
        let free = logs.runs.first().map_or(0, |run| self.free_rows(run));
        for row in observations.rows.iter().filter(|row| row.at + 1 < free) {
            let Some([forward, lateral, turn_rad]) = predictions::residual(&effects, &motion, row) else { continue };
            if (forward * forward + lateral * lateral).sqrt() > JUMP_CM || turn_rad.abs().to_degrees() > JUMP_DEG {
                let what = format!("line {}: the poses jump as no robot does", row.at + 2);
                return Err(Error::new(format!(
                    "{what}: the camera moved, or the tracker took something else for the robot"
                )));
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
            "the tracker lost the robot at {lost} of {of} rows, {at_the_end} of them at the end"
        )));
    }
    Ok(())
}
