//! Both sides of a comparison as layers of a ROS 2 bag, to be looked at in Foxglove, PlotJuggler or Rerun.

use std::iter;

use super::pairs::{Pair, alongside, recorded};
use mindgap_diagnosis::diagnose::Findings;
use mindgap_foundations::geometry::Pose;
use mindgap_import::ros2_bag::{Bag, Content};
use mindgap_learning::evaluation::replay::{Moment, Player};
use mindgap_logs::{Logs, Run};
use mindgap_models::simulator::baseline::Baseline;

/// Topic of the robot as it was logged.
const ROBOT: &str = "robot";
/// Topic of the learned simulator with the robot's commands.
const SIMULATOR: &str = "simulator";
/// Topic of the same with the causes that were found.
const WITH_CAUSES: &str = "simulator_with_causes";
/// Topic of the simulator's own recording of the same commands, moved to the robot's start.
const RECORDED: &str = "recorded_simulator";
/// Pause between two runs, ms.
const PAUSE_MS: f64 = 2000.0;

/// A layer's topic and its moments, one per row of the run.
type Layer = (&'static str, Vec<Moment>);

/// Returns a bag of all the robot's runs, one after the other. Each layer has its poses, the path of the whole run and its
/// readings; for every simulator, `residual/` has the robot's pose as seen from the simulated one. Simulated robots are put back
/// to the robot every [`PUT_BACK_STEPS`](mindgap_learning::evaluation::replay::PUT_BACK_STEPS) steps.
pub fn bag(findings: &Findings, baseline: &Baseline, robot: &Logs, simulator: &Logs, pairs: &[Pair]) -> Vec<u8> {
    let player = Player::new(baseline, robot);
    let causes = findings.with_formula();
    let (before, after) = (baseline.chain(), baseline.chain_with(&causes));
    let (mut bag, mut start_ms) = (Bag::default(), 0.0);
    for run in &robot.runs {
        let recorded = recorded(pairs, simulator, run);
        let simulators = [
            Some((SIMULATOR, player.simulated(&before, run))),
            (!causes.is_empty()).then(|| (WITH_CAUSES, player.simulated(&after, run))),
            recorded.map(|recorded| (RECORDED, alongside(run, recorded, robot.robot.step_ms))),
        ];
        let simulators: Vec<Layer> = simulators.into_iter().flatten().collect();
        let times_ms = run_times_ms(run, start_ms);
        bag.write("/run", start_ms, &Content::Text(&run.name));
        write_run(&mut bag, &times_ms, &(ROBOT, Player::logged(run)), &simulators);
        start_ms = times_ms.last().copied().unwrap_or(start_ms) + PAUSE_MS;
    }
    bag.finish()
}

fn run_times_ms(run: &Run, start_ms: f64) -> Vec<f64> {
    run.rows.iter().map(|row| start_ms + row.t_ms - run.rows.at(0).t_ms).collect()
}

fn write_run(bag: &mut Bag, times_ms: &[f64], robot: &Layer, simulators: &[Layer]) {
    let layers = || iter::once(robot).chain(simulators);
    for (name, moments) in layers() {
        let path: Vec<(f64, Pose)> =
            times_ms.iter().zip(moments).filter_map(|(t_ms, moment)| Some((*t_ms, moment.pose?))).collect();
        let start_ms = times_ms.first().copied().unwrap_or_default();
        bag.write(&format!("/{name}/path"), start_ms, &Content::Path(&path));
    }
    for (k, t_ms) in times_ms.iter().enumerate() {
        for (name, moments) in layers() {
            let Moment { pose, echo_cm } = moments.get(k).copied().unwrap_or_default();
            if let Some(pose) = pose {
                bag.write(&format!("/{name}/pose"), *t_ms, &Content::Pose(pose));
            }
            if let Some(cm) = echo_cm {
                bag.write(&format!("/{name}/reading_m"), *t_ms, &Content::Distance(cm));
            }
        }
        for (name, moments) in simulators {
            let simulated = moments.get(k).and_then(|moment| moment.pose);
            if let (Some(simulated), Some(seen)) = (simulated, robot.1[k].pose) {
                bag.write(&format!("/residual/{name}"), *t_ms, &Content::Difference(simulated.relative(&seen)));
            }
        }
    }
}
