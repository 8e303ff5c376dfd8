//! Where in a room a script can be driven.

use glam::DVec2;

use super::scripts::Script;
use crate::fit::FitContext;
use mindgap_foundations::geometry::{Pose, Rectangle, bounding_box};
use mindgap_learning::evaluation::predictions;
use mindgap_models::effects::StepContext;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::context::RunHistory;

/// A room with the robot in it.
pub struct Room<'a> {
    context: &'a FitContext<'a>,
    effects: EffectChain,
    /// Possible starts, those with the largest clearance first.
    starts: Vec<Pose>,
}

/// Clearance between the robot and everything else: the error of the predicted path at the end of a script.
const CLEAR_CM: f64 = 3.0;
/// Number of places along each axis of the scene, and of headings, at which a script may begin.
const PLACES: usize = 7;
const HEADINGS: usize = 4;

impl<'a> Room<'a> {
    /// The room of the logs, in which the robot drives with these effects.
    pub fn new(context: &'a FitContext<'a>, effects: EffectChain) -> Self {
        let mut room = Room { context, effects, starts: Vec::new() };
        room.starts = room.possible_starts();
        room
    }

    /// Returns the expected steps of a script from the first start where the robot touches nothing.
    pub fn steps(&self, script: &Script) -> Option<Vec<StepContext>> {
        self.starts.iter().find_map(|start| self.drive(script, *start))
    }

    fn possible_starts(&self) -> Vec<Pose> {
        let Some(Rectangle { low_cm: low, high_cm: high }) =
            bounding_box(self.context.rows.surroundings.surfaces.walls())
        else {
            // On open ground every place is as good.
            let is_open = self.context.rows.surroundings.surfaces.walls().is_empty();
            return is_open.then(|| Pose::new(0.0, 0.0, 0.0)).into_iter().collect();
        };
        let share = |i: usize| (i as f64 + 0.5) / PLACES as f64;
        let places =
            (0..PLACES * PLACES).map(|i| low + (high - low) * DVec2::new(share(i % PLACES), share(i / PLACES)));
        let mut places: Vec<(f64, DVec2)> = places.map(|at| (self.clearance_cm(at), at)).collect();
        places.sort_by(|a, b| b.0.total_cmp(&a.0));
        places.retain(|(clearance_cm, _)| *clearance_cm >= self.least_clearance_cm());
        let heading = |i: usize| std::f64::consts::TAU * i as f64 / HEADINGS as f64;
        places.iter().flat_map(|(_, at)| (0..HEADINGS).map(move |h| Pose::new(at.x, at.y, heading(h)))).collect()
    }

    fn clearance_cm(&self, at_cm: DVec2) -> f64 {
        let walls = self.context.rows.surroundings.surfaces.walls();
        walls.iter().map(|wall| wall.nearest(at_cm).distance(at_cm)).fold(f64::INFINITY, f64::min)
    }

    fn least_clearance_cm(&self) -> f64 {
        self.context.rows.surroundings.robot.body_radius_cm + CLEAR_CM
    }

    /// Returns the steps of a script from a pose, or `None` if the robot would touch something.
    fn drive(&self, script: &Script, start: Pose) -> Option<Vec<StepContext>> {
        let surroundings = &self.context.rows.surroundings;
        let least_cm = self.least_clearance_cm();
        let mut steps = Vec::with_capacity(script.commands.len());
        let (mut history, mut pose) = (RunHistory::default(), start);
        for (at, command) in script.commands.iter().enumerate() {
            if self.clearance_cm(pose.position_cm) < least_cm {
                return None;
            }
            history.command(*command);
            let step = surroundings.context(&history, at as f64 * surroundings.robot.step_ms, pose);
            let expected_cm = step.faced.map(|[distance_cm, _]| distance_cm);
            history.leave(Some(&step), expected_cm);
            if let Some(drive) = &self.context.baseline().motion {
                pose = predictions::step(&self.effects, drive, &step).end(&pose);
            }
            steps.push(step);
        }
        (self.clearance_cm(pose.position_cm) >= least_cm).then_some(steps)
    }
}
