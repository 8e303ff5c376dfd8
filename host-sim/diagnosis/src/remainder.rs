//! The remainder: the part of a fit's residual that covariates predict and no effect of the fit explains.

use rayon::prelude::*;

use super::calibration::Calibration;
use super::fit::{FitContext, Fitted};
use super::gain::Gain;
use super::omnibus::Regression;
use super::sample::{HoldOut, RowSet};
use mindgap_foundations::channel::Channel;

/// The structured residual of a fit in one channel.
pub struct Remainder {
    /// Its regression on covariates.
    pub regression: Regression,
    /// Gain of the regression per block, zero if it does not count.
    pub by_block: Vec<f64>,
}

/// Returns the structured residual of a fit in each channel.
pub fn remainders(fit: &Fitted, context: &FitContext) -> Vec<Remainder> {
    Channel::SIMULATED.par_iter().map(|channel| Remainder::of(*channel, fit, context)).collect()
}

/// Returns the largest gain of a regression in any channel, before any gate.
pub fn largest_gain(fit: &Fitted, context: &FitContext) -> Gain {
    let of_channel = |channel: &Channel| Regression::of(*channel, fit, context).gain(context);
    let gains: Vec<Gain> = Channel::SIMULATED.par_iter().map(of_channel).collect();
    gains.into_iter().max_by(|a, b| a.winsorized_nats.total_cmp(&b.winsorized_nats)).unwrap_or(Gain::NONE)
}

impl Remainder {
    fn of(channel: Channel, fit: &Fitted, context: &FitContext) -> Self {
        let regression = Regression::of(channel, fit, context);
        let gain = regression.gain(context);
        log::info!(
            "{} leaves a structured residual worth {:.1} nats in {} ({:.1} without the best runs)",
            fit.name(),
            gain.nats,
            channel.name(),
            gain.winsorized_nats
        );
        let counts = gain.less(context.form_error_nats(channel)).passes(context.calibration.remainder_nats);
        let gains = regression.gains();
        let by_block = if counts { gains } else { vec![0.0; gains.len()] };
        Remainder { regression, by_block }
    }

    /// Returns its channel.
    pub fn channel(&self) -> Channel {
        self.regression.channel
    }

    /// Returns what it explains in all, in nats.
    pub fn nats(&self) -> f64 {
        self.by_block.iter().sum()
    }

    /// Returns whether it explains anything that counts.
    pub fn counts(&self) -> bool {
        self.by_block.iter().any(|g| *g != 0.0)
    }

    /// Sets it to nothing unless it gains on held-out rows.
    pub fn confirm(&mut self, context: &FitContext, rows: &HoldOut) {
        let is_confirmed =
            self.counts() && self.regression.held_out_gain(rows) >= context.calibration.judgement.strong_nats;
        if !is_confirmed {
            self.by_block.fill(0.0);
        }
    }

    /// Returns a note about the simulator's epistemic error in this channel, if that is large enough.
    pub fn epistemic_note(&self, calibration: &Calibration) -> Option<String> {
        let error = self.regression.epistemic_error.as_ref();
        let error = error.filter(|error| error.nats >= calibration.remainder_nats)?.root_mean_square();
        let (name, size) = match self.channel() {
            Channel::Forward => ("Forward motion", format!("{error:.2} cm")),
            Channel::Lateral => ("Lateral motion", format!("{error:.2} cm")),
            _ => ("The turn", format!("{:.2} degrees", error.to_degrees())),
        };
        Some(format!(
            "{name} differs by {size} per step under commands that the training logs hardly cover. This is the simulator's own \
             uncertainty, not a gap: train on logs with these commands."
        ))
    }

    /// Returns the residuals of a motion channel beyond everything that counts, or `None` for a sonar channel.
    pub fn residuals(&self, rows: RowSet) -> Option<Vec<Option<f64>>> {
        self.regression.residuals(self.counts(), rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::*;
    use mindgap_foundations::geometry::Pose;
    use mindgap_learning::evaluation::observations::Observations;
    use mindgap_models::simulator::baseline::Baseline;
    use mindgap_models::simulator::textbook;

    /// Eight blocks of twelve rows with these forward residuals.
    fn rows(off_cm: fn(usize) -> f64) -> Observations {
        observations(8, 12, move |_, at| {
            let command = if at.is_multiple_of(2) { [40.0, 60.0] } else { [60.0, 40.0] };
            Made { commands: [command; 2], off: [off_cm(at), 0.0, 0.0], ..Made::default() }
        })
    }

    /// Returns the channels in which covariates predict a residual without any effect.
    fn channels_left(observations: Observations) -> Vec<Channel> {
        let baseline = baseline();
        let rows = identification(&baseline, observations);
        let context = FitContext::new(&rows, METHOD);
        counting(&remainders(&Fitted::null(&context), &context))
    }

    /// Returns the same once held-out rows confirm them.
    fn confirmed(off_cm: fn(usize) -> f64, held_out_cm: fn(usize) -> f64) -> Vec<Channel> {
        let baseline = baseline();
        let (found, held_out) = (identification(&baseline, rows(off_cm)), HoldOut::new(&baseline, rows(held_out_cm)));
        let context = FitContext::new(&found, METHOD);
        let mut remainders = remainders(&Fitted::null(&context), &context);
        remainders.iter_mut().for_each(|remainder| remainder.confirm(&context, &held_out));
        counting(&remainders)
    }

    fn counting(remainders: &[Remainder]) -> Vec<Channel> {
        remainders.iter().filter(|r| r.counts()).map(Remainder::channel).collect()
    }

    const AS_EXPECTED: fn(usize) -> f64 = |at| 0.9 * alternating(at / 2);
    const LONGER_TO_ONE_SIDE: fn(usize) -> f64 = |at| 0.9 * alternating(at / 2) + alternating(at);

    #[test]
    fn expected_steps_leave_no_remainder() {
        assert!(confirmed(AS_EXPECTED, AS_EXPECTED).is_empty());
    }

    #[test]
    fn remainder_by_command_counts_if_held_out_runs_confirm_it() {
        assert_eq!(confirmed(LONGER_TO_ONE_SIDE, LONGER_TO_ONE_SIDE), [Channel::Forward]);
        assert!(confirmed(LONGER_TO_ONE_SIDE, AS_EXPECTED).is_empty());
    }

    #[test]
    fn wider_noise_is_no_remainder() {
        let scattered = |at| 2.0 * alternating(at / 2);
        assert!(confirmed(scattered, scattered).is_empty());
    }

    /// Half of the steps are spins that turn too far by the noise.
    #[test]
    fn epistemic_error_is_no_remainder_but_a_note() {
        let left_over = |spins: usize| {
            let mut simulator = textbook::simulator(&baseline(), NOISE.into()).expect("a simulator");
            let motion = simulator.reference.as_mut().and_then(|reference| reference.motion.as_mut());
            motion.expect("a motion").precision = Some(precision(2000, spins));
            let baseline = Baseline::learned(&simulator).expect("a baseline");
            let rows = observations(8, 24, |_, at| {
                let (command, off) = if at < 12 { (STRAIGHT, 0.0) } else { (SPIN, NOISE[2]) };
                let off = [0.0, 0.0, off + 0.9 * NOISE[2] * alternating(at)];
                Made { commands: [command; 2], off, ..Made::default() }
            });
            let rows = identification(&baseline, rows);
            let context = FitContext::new(&rows, METHOD);
            let remainders = remainders(&Fitted::null(&context), &context);
            let notes: Vec<String> = remainders.iter().filter_map(|r| r.epistemic_note(&context.calibration)).collect();
            (counting(&remainders), notes)
        };
        let (channels, notes) = left_over(0);
        assert!(channels.is_empty() && notes.len() == 1 && notes[0].starts_with("The turn differs by"), "{notes:?}");
        assert_eq!(left_over(2000), (vec![Channel::Turn], Vec::new()));
    }

    /// Half of the steps begin in a corner, where they have three times the noise and the same mean as elsewhere.
    #[test]
    fn noise_that_depends_on_the_place_is_a_remainder() {
        let rows = observations(8, 60, |_, at: usize| {
            let (x_cm, factor) = if at.is_multiple_of(2) { (50.0, 3.0) } else { (250.0, 1.0) };
            let off = [factor * 0.9 * alternating(at / 2), 0.0, 0.0];
            Made { pose: Pose::new(x_cm, 50.0, 0.0), off, ..Made::default() }
        });
        assert_eq!(channels_left(rows), [Channel::Forward]);
    }
}
