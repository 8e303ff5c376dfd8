//! Replay of a run's commands in the simulator, with or without effects, next to the logged path and readings.

use crate::evaluation::predictions;
use mindgap_foundations::geometry::Pose;
use mindgap_logs::{Logs, Run};
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::context::{RunHistory, Surroundings};
use mindgap_models::simulator::baseline::Baseline;

/// Pose and reading of a robot at one row of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Moment {
    /// The pose, if it is known.
    pub pose: Option<Pose>,
    /// The logged or expected reading, cm, if there is one.
    pub echo_cm: Option<f64>,
}

/// Replays runs against a baseline.
pub struct Player<'a> {
    baseline: &'a Baseline<'a>,
    surroundings: Surroundings,
    step_ms: f64,
}

/// Steps after which the simulated robot is reset to the logged pose. Errors accumulate without bound, and a simulated path
/// through a wall shows nothing.
pub const PUT_BACK_STEPS: usize = 60;

impl<'a> Player<'a> {
    /// Prepares a replay in the scene of the logs.
    pub fn new(baseline: &'a Baseline<'a>, logs: &Logs) -> Self {
        let surroundings = Surroundings::new(&logs.robot, &logs.scene);
        Player { baseline, surroundings, step_ms: logs.robot.step_ms }
    }

    /// Returns the run as it was logged.
    pub fn logged(run: &Run) -> Vec<Moment> {
        run.rows.iter().map(|row| Moment { pose: row.pose, echo_cm: row.echo_cm }).collect()
    }

    /// Simulates the run's commands with these effects, one moment per row. The simulated robot starts at the first tracked
    /// pose and is reset to the logged one every [`PUT_BACK_STEPS`]; without a model of motion it follows the logged poses.
    pub fn simulated(&self, effects: &EffectChain, run: &Run) -> Vec<Moment> {
        let begin_ms = run.rows.at(0).t_ms;
        let (mut history, mut at, mut since) = (RunHistory::default(), None, 0);
        let mut moments = Vec::with_capacity(run.rows.len());
        for (k, row) in run.rows.iter().enumerate() {
            if row.pose.is_some() && (at.is_none() || since >= PUT_BACK_STEPS || self.baseline.motion.is_none()) {
                (at, since) = (row.pose, 0);
            }
            history.command_of(&run.rows, k);
            let step = at.map(|pose| self.surroundings.context(&history, row.t_ms - begin_ms, pose));
            let echo_cm = step.as_ref().and_then(|step| {
                let sonar = self.baseline.sonar.as_ref()?;
                let sensor = effects.sensor(step);
                let outcomes = sensor.outcomes(sonar, &self.surroundings);
                outcomes.mean_hit_cm().filter(|_| outcomes.none < 0.5)
            });
            moments.push(Moment { pose: at, echo_cm });
            if let (Some(step), Some(drive), Some(next)) = (&step, &self.baseline.motion, run.rows.get(k + 1)) {
                let duration_ratio = (next.t_ms - row.t_ms) / self.step_ms;
                let motion = predictions::step(effects, drive, step);
                at = Some(motion.scaled(duration_ratio).end(&step.pose));
                since += 1;
            }
            history.leave(step.as_ref(), echo_cm);
        }
        moments
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use mindgap_built_in_robot::default_robot;
    use mindgap_logs::{Row, Scene};
    use mindgap_models::simulator::kinematic;

    const WALL_CM: f64 = 400.0;

    fn logs(rows: usize) -> Logs {
        let row = |k: usize| {
            let pose = (k != 1).then(|| Pose::new(30.0 + 4.0 * k as f64, 50.0, 0.0));
            Row { t_ms: 400.0 * k as f64, left: 50.0, right: 50.0, pose, echo_cm: Some(90.0), ..Row::default() }
        };
        let run = Run { name: "run-000".into(), rows: (0..rows).map(row).collect() };
        let scene = Scene { arena_cm: Some(DVec2::new(WALL_CM, 100.0)), ..Scene::default() };
        Logs { robot: default_robot(), scene, runs: vec![run] }
    }

    /// At command 50 the textbook's robot drives 8.2 cm per step, the logged one 4 cm.
    #[test]
    fn simulated_robot_follows_commands_and_is_reset() {
        let logs = logs(PUT_BACK_STEPS + 5);
        let baseline = kinematic::baseline(&logs);
        let player = Player::new(&baseline, &logs);
        let moments = player.simulated(&EffectChain::default(), &logs.runs[0]);
        let x_cm: Vec<f64> = moments.iter().map(|m| m.pose.expect("a pose").position_cm.x).collect();
        let step_cm = logs.robot.full_speed_cm_s * 0.5 * 0.4;
        for (k, x) in x_cm.iter().enumerate().take(PUT_BACK_STEPS) {
            assert!((x - (30.0 + step_cm * k as f64)).abs() < 1e-9, "{k}: {x}");
        }
        assert!((x_cm[PUT_BACK_STEPS] - (30.0 + 4.0 * PUT_BACK_STEPS as f64)).abs() < 1e-9);
        let wall_cm = WALL_CM - x_cm[30] - logs.robot.ultrasonic.expect("a sensor").x_cm;
        let echo_cm = moments[30].echo_cm.expect("an echo from the wall ahead");
        assert!((echo_cm - wall_cm).abs() < 5.0, "{echo_cm} for {wall_cm}");
    }

    #[test]
    fn logged_moments_equal_the_rows() {
        let logged = Player::logged(&logs(3).runs[0]);
        assert_eq!(logged.iter().map(|m| m.pose.is_some()).collect::<Vec<_>>(), [true, false, true]);
        assert_eq!(logged[1].echo_cm, Some(90.0));
    }
}
