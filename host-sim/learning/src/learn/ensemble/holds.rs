//! Stretches of steps under one command. Their mean tells more of the command's bias than single steps do: the robot's
//! chance averages out, and of the tracker's errors only those at both ends count.

use mindgap_models::simulator::ensemble::noise::MotionNoise;
use mindgap_models::simulator::ensemble::{Evidence, Held};
use mindgap_models::simulator::nominal::MotionBias;

/// What the networks and their correction leave of a step. Channels are forward (cm), lateral (cm) and turn (degrees).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepResidual {
    /// The run and the row at which it begins.
    place: [usize; 2],
    command: [f64; 2],
    /// Whether the command is that of the step before.
    steady: bool,
    residual: [f64; 3],
    /// What the correction adds where the command is held.
    known: [f64; 3],
}

/// Consecutive steps under one command, the first one apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// Left and right command.
    pub command: [f64; 2],
    /// Whether it is the first step after another command.
    pub first: bool,
    /// Number of steps.
    pub steps: usize,
    /// Mean residual of a step.
    pub residual: [f64; 3],
    /// What the correction adds to the networks where the command is held.
    pub known: [f64; 3],
}

impl StepResidual {
    /// Logged minus predicted of a step in `place`, its run and row: forward (cm), lateral (cm) and turn (rad), for left,
    /// right, previous left and previous right command.
    pub fn new(place: [usize; 2], speeds: [f64; 4], off: [f64; 3], correction: &MotionBias) -> Self {
        let [left, right, left_before, right_before] = speeds;
        let in_degrees = |[forward_cm, lateral_cm, turn_rad]: [f64; 3]| [forward_cm, lateral_cm, turn_rad.to_degrees()];
        StepResidual {
            place,
            command: [left, right],
            steady: [left, right] == [left_before, right_before],
            residual: in_degrees(off),
            known: in_degrees(correction.correction(&[left, right, left, right])),
        }
    }

    /// Index of the run.
    pub fn run(&self) -> usize {
        self.place[0]
    }

    /// Left and right command.
    pub fn command(&self) -> [f64; 2] {
        self.command
    }

    /// Whether the command is that of the step before.
    pub fn is_steady(&self) -> bool {
        self.steady
    }

    /// Whether it begins where another one of the same run ends.
    pub fn follows(&self, before: &StepResidual) -> bool {
        before.place[0] == self.place[0] && before.place[1] + 1 == self.place[1]
    }

    /// Logged minus predicted.
    pub fn residual(&self) -> [f64; 3] {
        self.residual
    }

    /// What the correction adds where the command is held.
    pub fn known(&self) -> [f64; 3] {
        self.known
    }
}

/// The stretches of steps, which are in the order of runs and rows.
fn stretches(steps: &[StepResidual]) -> Vec<&[StepResidual]> {
    let together = |a: &StepResidual, b: &StepResidual| b.follows(a) && a.steady && b.steady && a.command == b.command;
    steps.chunk_by(together).collect()
}

/// The same, summed up.
pub fn holds(steps: &[StepResidual]) -> Vec<Hold> {
    let hold = |steps: &[StepResidual]| {
        let mean = |channel: usize| steps.iter().map(|s| s.residual[channel]).sum::<f64>() / steps.len() as f64;
        let StepResidual { command, steady, known, .. } = steps[0];
        Hold { command, first: !steady, steps: steps.len(), residual: [0, 1, 2].map(mean), known }
    };
    stretches(steps).into_iter().map(hold).collect()
}

impl Hold {
    /// What it says of the command's bias, if noise is this; `said` is what networks say.
    pub fn evidence(&self, noise: &MotionNoise, said: Held) -> Evidence {
        let motion = said.motion(self.command);
        let variance = |channel: usize| {
            let first = if self.first { noise.first_step[channel] * noise.first_step[channel] } else { 0.0 };
            (noise.mean_variance(motion, channel, self.steps) + first) as f32
        };
        Evidence {
            command: self.command.map(|c| c as f32),
            bias: [0, 1, 2].map(|channel| (self.residual[channel] + self.known[channel]) as f32),
            variance: [0, 1, 2].map(variance),
            after_training: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_models::simulator::ensemble::CommandScale;

    fn step(run: usize, row: usize, command: [f64; 2], before: [f64; 2], turn_rad: f64) -> StepResidual {
        let none = MotionBias {
            scale: CommandScale::PERCENT,
            weights: [const { Vec::new() }; 3],
            scatter: [1.0; 3],
            precision: None,
        };
        let speeds = [command[0], command[1], before[0], before[1]];
        StepResidual::new([run, row], speeds, [1.0, 2.0, turn_rad], &none)
    }

    #[test]
    fn a_command_that_is_held_is_one_stretch_after_its_first_step() {
        let (a, b) = ([50.0, 40.0], [10.0, 20.0]);
        let turn = 1f64.to_radians();
        let steps = [
            step(0, 0, a, [0.0; 2], turn),
            step(0, 1, a, a, turn),
            step(0, 2, a, a, 3.0 * turn),
            step(0, 3, b, a, turn),
            // The tracker lost the robot at row 4.
            step(0, 5, b, b, turn),
            step(1, 6, b, b, turn),
        ];
        let found: Vec<(bool, usize)> = holds(&steps).iter().map(|hold| (hold.first, hold.steps)).collect();
        assert_eq!(found, [(true, 1), (false, 2), (true, 1), (false, 1), (false, 1)]);
        assert!((holds(&steps)[1].residual[2] - 2.0).abs() < 1e-12);
    }
}
