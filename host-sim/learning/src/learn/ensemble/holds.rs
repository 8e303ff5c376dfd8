//! Consecutive steps under one command. Their mean says more about the command's bias than single steps do: the process
//! noise averages out, and of the tracker's errors only those at both ends count.

use mindgap_foundations::motion::{Axis, Motion};
use mindgap_logs::samples::RowId;
use mindgap_models::simulator::ensemble::noise::MotionNoise;
use mindgap_models::simulator::ensemble::{Evidence, Held};
use mindgap_models::simulator::nominal::MotionBias;

/// The residual of a step after the networks and their correction. As in an ensemble, turns are in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepResidual {
    /// The row at which the step begins.
    row: RowId,
    command: [f64; 2],
    /// Whether the command equals that of the step before.
    steady: bool,
    residual: Motion<f64>,
    /// Correction of the networks under the held command.
    known: Motion<f64>,
}

/// Consecutive steps under one command. The first step after another command is separate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hold {
    /// Left and right command.
    pub command: [f64; 2],
    /// Whether it is the first step after another command.
    pub first: bool,
    /// Number of steps.
    pub steps: usize,
    /// Mean residual per step.
    pub residual: Motion<f64>,
    /// Correction of the networks under the held command.
    pub known: Motion<f64>,
}

impl StepResidual {
    /// Makes the residual of the step that begins at `row` from `residual`, logged minus predicted (cm, cm, rad), and from
    /// left, right, previous left and previous right command.
    pub fn new(row: RowId, speeds: [f64; 4], residual: Motion<f64>, correction: &MotionBias) -> Self {
        let [left, right, left_before, right_before] = speeds;
        StepResidual {
            row,
            command: [left, right],
            steady: [left, right] == [left_before, right_before],
            residual: residual.turn_in_degrees(),
            known: correction.correction(&[left, right, left, right]).turn_in_degrees(),
        }
    }

    /// Returns the index of the run.
    pub fn run(&self) -> usize {
        self.row.run
    }

    /// Returns the left and right command.
    pub fn command(&self) -> [f64; 2] {
        self.command
    }

    /// Returns whether the command equals that of the step before.
    pub fn is_steady(&self) -> bool {
        self.steady
    }

    /// Returns whether the step begins where another one of the same run ends.
    pub fn follows(&self, before: &StepResidual) -> bool {
        before.row.run == self.row.run && before.row.row + 1 == self.row.row
    }

    /// Returns logged minus predicted motion.
    pub fn residual(&self) -> Motion<f64> {
        self.residual
    }

    /// Returns the correction of the networks under the held command.
    pub fn known(&self) -> Motion<f64> {
        self.known
    }
}

/// Splits steps into stretches under one command; they must be in the order of runs and rows.
fn stretches(steps: &[StepResidual]) -> Vec<&[StepResidual]> {
    let together = |a: &StepResidual, b: &StepResidual| b.follows(a) && a.steady && b.steady && a.command == b.command;
    steps.chunk_by(together).collect()
}

/// Summarises the stretches of steps.
pub fn holds(steps: &[StepResidual]) -> Vec<Hold> {
    let hold = |steps: &[StepResidual]| {
        let mean = |axis: Axis| steps.iter().map(|s| s.residual[axis]).sum::<f64>() / steps.len() as f64;
        let StepResidual { command, steady, known, .. } = steps[0];
        Hold { command, first: !steady, steps: steps.len(), residual: Motion::from_fn(mean), known }
    };
    stretches(steps).into_iter().map(hold).collect()
}

impl Hold {
    /// Returns the evidence about the command's bias, given the noise; `said` returns the predictions of the networks.
    pub fn evidence(&self, noise: &MotionNoise, said: Held) -> Evidence {
        let motion = said.motion(self.command);
        let variance = |axis: Axis| {
            let first = if self.first { noise.first_step[axis] * noise.first_step[axis] } else { 0.0 };
            (noise.mean_variance(motion, axis, self.steps) + first) as f32
        };
        Evidence {
            command: self.command.map(|c| c as f32),
            bias: (self.residual + self.known).map(|bias| bias as f32),
            variance: Motion::from_fn(variance),
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
            weights: Motion::default(),
            scatter: Motion::splat(1.0),
            precision: None,
        };
        let speeds = [command[0], command[1], before[0], before[1]];
        StepResidual::new(RowId { run, row }, speeds, Motion { forward: 1.0, lateral: 2.0, turn: turn_rad }, &none)
    }

    #[test]
    fn held_command_is_one_stretch_after_its_first_step() {
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
        assert!((holds(&steps)[1].residual.turn - 2.0).abs() < 1e-12);
    }
}
