//! What a fit leaves over in a channel: what follows circumstances, and scatter beyond the simulator's.

use rayon::prelude::*;

use super::channel::Channel;
use super::fit::{FitContext, Fitted, Gain};
use super::omnibus::ResidualFit;
use crate::evaluation::observations::Observations;

/// What the omnibus residual model explains in a channel beyond a fit.
pub struct Remainder {
    /// The model.
    pub model: ResidualFit,
    /// Its gain on each block, zero where it does not count.
    pub by_block: Vec<f64>,
    follows: bool,
    scatters: bool,
}

/// The remainder of each channel beyond a fit.
pub fn remainders(fit: &Fitted, context: &FitContext) -> Vec<Remainder> {
    Channel::ALL.par_iter().map(|channel| Remainder::of(*channel, fit, context)).collect()
}

/// The most that the model gains in a channel beyond a fit, or wider scatter on top of it, before any gate.
pub fn most(fit: &Fitted, context: &FitContext) -> Gain {
    let of_channel = |channel: &Channel| {
        let model = ResidualFit::of(*channel, fit, context);
        let wider = context.observations.by_block(&wider_scatter(&model, context, context.observations));
        [model.gains_over(fit, context), wider].map(|gains| Gain::of(&gains))
    };
    let gains: Vec<[Gain; 2]> = Channel::ALL.par_iter().map(of_channel).collect();
    gains.into_iter().flatten().max_by(|a, b| a.nats.total_cmp(&b.nats)).unwrap_or(Gain::NONE)
}

impl Remainder {
    fn of(channel: Channel, fit: &Fitted, context: &FitContext) -> Self {
        let gate = &context.calibration.remainder;
        let model = ResidualFit::of(channel, fit, context);
        let gains = model.gains_over(fit, context);
        let wider = context.observations.by_block(&wider_scatter(&model, context, context.observations));
        let (follows, scatters) = (Gain::of(&gains).passes(gate), Gain::of(&wider).nats >= gate.nats);
        let mut by_block = vec![0.0; gains.len()];
        for (counts, gains) in [(follows, gains), (scatters, wider)] {
            if counts {
                by_block.iter_mut().zip(gains).for_each(|(sum, gain)| *sum += gain);
            }
        }
        Remainder { model, by_block, follows, scatters }
    }

    /// The channel.
    pub fn channel(&self) -> Channel {
        self.model.channel
    }

    /// Whether the model explains anything.
    pub fn counts(&self) -> bool {
        self.by_block.iter().any(|g| *g != 0.0)
    }

    /// By how much each row is likelier with the scatter of the logs than with the simulator's; zeros where
    /// that does not count.
    pub fn wider_scatter(&self, context: &FitContext, rows: &Observations) -> Vec<f64> {
        if self.scatters { wider_scatter(&self.model, context, rows) } else { vec![0.0; rows.rows.len()] }
    }

    /// This if it gains something over the fit `beneath` on runs held out, and nothing otherwise.
    pub fn confirmed(self, beneath: &Fitted, context: &FitContext, hold_out: &Observations) -> Self {
        let followed = || -> f64 {
            let without = beneath.judged_on(hold_out, context).channel(self.channel());
            self.model.judged_on(hold_out, context).iter().zip(without).map(|(a, b)| a - b).sum()
        };
        let followed = if self.follows { followed() } else { 0.0 };
        let scattered: f64 = self.wider_scatter(context, hold_out).iter().sum();
        if followed + scattered >= context.calibration.judgement.strong_nats {
            return self;
        }
        Remainder { by_block: vec![0.0; self.by_block.len()], follows: false, scatters: false, ..self }
    }
}

/// What a wider scatter gains, where it is wider than chance makes it.
fn wider_scatter(model: &ResidualFit, context: &FitContext, rows: &Observations) -> Vec<f64> {
    if model.scatter_ratio(context) < context.calibration.judgement.scatter_ratio {
        return vec![0.0; rows.rows.len()];
    }
    model.wider_scatter(context, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::hypothesis::log_density;
    use crate::gap::test_support::*;

    /// Eight blocks of twelve rows with forward residuals.
    fn rows(off_cm: fn(usize) -> f64) -> Observations {
        observations(8, 12, move |_, at| {
            let command = if at % 2 == 0 { [40.0, 60.0] } else { [60.0, 40.0] };
            Made { commands: [command; 2], off: [off_cm(at), 0.0, 0.0], ..Made::default() }
        })
    }

    /// The remainders beyond no effect, as two runs held out confirm them.
    fn confirmed(off_cm: fn(usize) -> f64, held_out_cm: fn(usize) -> f64) -> Vec<Remainder> {
        let (baseline, rows) = (baseline(), rows(off_cm));
        let context = FitContext::new(&baseline, &rows, METHOD);
        let none = Fitted::none(&context);
        let hold_out = self::rows(held_out_cm);
        remainders(&none, &context).into_iter().map(|r| r.confirmed(&none, &context, &hold_out)).collect()
    }

    fn counting(remainders: &[Remainder]) -> Vec<Channel> {
        remainders.iter().filter(|r| r.counts()).map(Remainder::channel).collect()
    }

    const AS_EXPECTED: fn(usize) -> f64 = |at| 0.9 * alternating(at / 2);
    const LONGER_TO_ONE_SIDE: fn(usize) -> f64 = |at| 0.9 * alternating(at / 2) + alternating(at);
    const SCATTERED: fn(usize) -> f64 = |at| 2.0 * alternating(at / 2);

    #[test]
    fn what_is_as_expected_leaves_nothing_over() {
        assert!(counting(&confirmed(AS_EXPECTED, AS_EXPECTED)).is_empty());
    }

    #[test]
    fn what_follows_the_commands_is_left_over_where_runs_held_out_show_it_too() {
        assert_eq!(counting(&confirmed(LONGER_TO_ONE_SIDE, LONGER_TO_ONE_SIDE)), [Channel::Forward]);
        assert!(counting(&confirmed(LONGER_TO_ONE_SIDE, AS_EXPECTED)).is_empty());
    }

    /// Residuals of two standard deviations that follow nothing: each row gains what twice the scatter makes it likelier.
    #[test]
    fn wider_scatter_is_left_over() {
        let found = confirmed(SCATTERED, SCATTERED);
        assert_eq!(counting(&found), [Channel::Forward]);
        let expected = 12.0 * (log_density(2.0, 2.0) - log_density(2.0, 1.0));
        for nats in &found[0].by_block {
            assert!((nats - expected).abs() < 0.02 * expected, "{nats} {expected}");
        }
        assert!(counting(&confirmed(SCATTERED, AS_EXPECTED)).is_empty());
    }

    /// The most that is gained is that of the channel that has most to gain.
    #[test]
    fn the_most_is_that_of_one_channel() {
        let (baseline, rows) = (baseline(), rows(SCATTERED));
        let context = FitContext::new(&baseline, &rows, METHOD);
        let expected = 96.0 * (log_density(2.0, 2.0) - log_density(2.0, 1.0));
        let most = most(&Fitted::none(&context), &context).nats;
        assert!((most - expected).abs() < 0.02 * expected, "{most} {expected}");
    }
}
