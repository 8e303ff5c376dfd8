//! The built-in robot as the robot of a loop.

use crate::closed_loop::robot::{Call, TrialRobot};
use mindgap_built_in_robot::{self as built_in_robot, ActiveEffect, BuiltInRobot};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::random::generator;
use mindgap_logs::Scene;
use mindgap_logs::controller_file::ControllerFile;

/// The built-in robot with these faults, which its simulator need not model.
pub struct TrialledRobot(pub Vec<ActiveEffect>);

impl TrialRobot for TrialledRobot {
    fn drive(&mut self, call: &Call) -> Result<()> {
        let controller = ControllerFile::read(call.controller)?.controller;
        let scene = Scene::read(call.scene)?;
        let robot = BuiltInRobot::new(&built_in_robot::default_robot(), &scene, &self.0);
        let start = call.start.checked_sub(1).and_then(|place| scene.starts.get(place));
        let start = *start.ok_or_else(|| Error::in_file(call.scene, format!("has no start {}", call.start)))?;
        let driven = built_in_robot::run_controller(&robot, &controller, start, &mut generator(call.seed, &[]));
        driven.to_run("run").write(call.out)
    }
}
