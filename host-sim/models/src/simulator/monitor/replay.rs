//! Replays logs through the monitor, with the numbers that a board has.

use fixed::types::I16F16;
use mindgap_core::monitor::{Law, Monitor, Outcome, Step};

use super::MonitorLaw;
use crate::simulator::Simulator;
use crate::simulator::fixed_point::Quantised;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::motion::Motion;
use mindgap_logs::Run;

/// A monitor on the host: its constants and the networks beside it.
pub struct Replay {
    /// The constants.
    pub law: MonitorLaw,
    forward: Quantised<4>,
    turn: Quantised<4>,
}

impl Replay {
    /// Returns the monitor of a simulator.
    ///
    /// # Errors
    /// As [`MonitorLaw::of`], or when a network has no form in fixed point.
    pub fn of(simulator: &Simulator) -> Result<Self> {
        let quantise = |learned: &Option<crate::simulator::Learned<4>>, name: &str| {
            Quantised::new(&simulator.need(learned, name)?.network)
                .map_err(|e| Error::new(format!("the {name} network cannot be represented in fixed point: {e}")))
        };
        Ok(Replay {
            law: MonitorLaw::of(simulator)?,
            forward: quantise(&simulator.forward, "forward")?,
            turn: quantise(&simulator.turn, "turn")?,
        })
    }

    /// Returns the step of a run that begins at a row, which is not its last.
    pub fn step(&self, run: &Run, row: usize) -> Step {
        let (begin, end) = (run.rows.at(row), run.rows.at(row + 1));
        let number = |x: f64| I16F16::saturating_from_num(x);
        let ([left, right], [left_before, right_before]) = (begin.command(), run.previous_command(row));
        let commands = [left, right, left_before, right_before].map(number);
        let predicted = [self.forward.network.evaluate(commands), self.turn.network.evaluate(commands)];
        let motion = begin.pose.zip(end.pose).map(|(from, to)| Motion::between(&from, &to).turn_in_degrees());
        Step {
            commands,
            predicted: predicted.map(|output| output.value),
            measured: motion.map(|motion| [number(motion.forward), number(motion.turn)]),
            duration_ms: (end.t_ms - begin.t_ms).clamp(0.0, 65535.0) as u16,
        }
    }

    /// Replays a run, and calls `watch` with the row of each step and what the monitor made of it.
    pub fn run(&self, law: &Law, monitor: &mut Monitor, run: &Run, mut watch: impl FnMut(usize, Outcome, &Monitor)) {
        monitor.start_run();
        for row in 0..run.rows.len().saturating_sub(1) {
            let outcome = monitor.step(law, &self.step(run, row));
            watch(row, outcome, monitor);
        }
    }
}
