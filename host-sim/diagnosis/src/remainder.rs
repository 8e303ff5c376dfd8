//! What a fit leaves over in a channel that follows circumstances.

use rayon::prelude::*;

use super::calibration::Calibration;
use super::channel::Channel;
use super::fit::{FitContext, Fitted};
use super::gain::Gain;
use super::omnibus::{Foretold, ResidualFit};
use mindgap_learning::evaluation::observations::Observations;

/// What the omnibus residual model explains in a channel beyond a fit.
pub struct Remainder {
    /// The model.
    pub model: ResidualFit,
    /// Its gain on each block, zero where it does not count.
    pub by_block: Vec<f64>,
}

/// The remainder of each channel beyond a fit.
pub fn remainders(fit: &Fitted, context: &FitContext) -> Vec<Remainder> {
    Channel::ALL.par_iter().map(|channel| Remainder::of(*channel, fit, context)).collect()
}

/// The most that the model gains in a channel beyond a fit, before any gate.
pub fn most(fit: &Fitted, context: &FitContext) -> Gain {
    let of_channel = |channel: &Channel| ResidualFit::of(*channel, fit, context).gain(context);
    let gains: Vec<Gain> = Channel::ALL.par_iter().map(of_channel).collect();
    gains.into_iter().max_by(|a, b| a.broad_nats.total_cmp(&b.broad_nats)).unwrap_or(Gain::NONE)
}

impl Remainder {
    fn of(channel: Channel, fit: &Fitted, context: &FitContext) -> Self {
        let model = ResidualFit::of(channel, fit, context);
        let gain = model.gain(context);
        log::info!(
            "beyond {}, {} follows circumstances by {:.1} nats ({:.1} without the runs that gain most)",
            if fit.ids().is_empty() { "the simulator".into() } else { fit.ids().join("+") },
            channel.name(),
            gain.nats,
            gain.broad_nats
        );
        let counts = gain.less(context.feigned_already(channel)).passes(context.calibration.remainder_nats);
        let gains = model.gains(context);
        let by_block = if counts { gains } else { vec![0.0; gains.len()] };
        Remainder { model, by_block }
    }

    /// The channel.
    pub fn channel(&self) -> Channel {
        self.model.channel
    }

    /// What it explains in all.
    pub fn nats(&self) -> f64 {
        self.by_block.iter().sum()
    }

    /// Whether the model explains anything.
    pub fn counts(&self) -> bool {
        self.by_block.iter().any(|g| *g != 0.0)
    }

    /// What the simulator does not know of its own motion here, in words; none where that foretells too little.
    pub fn own_error(&self, calibration: &Calibration) -> Option<String> {
        let Foretold { root_mean_square, .. } =
            self.model.own_error.as_ref().filter(|own_error| own_error.nats >= calibration.remainder_nats)?;
        let (named, off) = match self.channel() {
            Channel::Forward => ("The way forward", format!("{root_mean_square:.2} cm")),
            Channel::Lateral => ("The way to the left", format!("{root_mean_square:.2} cm")),
            _ => ("The turn", format!("{:.2} degrees", root_mean_square.to_degrees())),
        };
        Some(format!(
            "{named} is off by {off} a step under commands that the training logs leave open: no gap, but not known. Train on \
             logs that drive them."
        ))
    }

    /// What is left of each row of a motion channel once all is explained that counts; none of a sonar channel.
    pub fn rest(&self, rows: &Observations, context: &FitContext) -> Option<Vec<Option<f64>>> {
        self.model.rest(self.counts(), rows, context)
    }

    /// This if it gains something over the fit `beneath` on runs held out, and nothing otherwise.
    pub fn confirmed(self, beneath: &Fitted, context: &FitContext, hold_out: &Observations) -> Self {
        let gained = || -> f64 {
            let without = beneath.judged_on(hold_out, context).channel(self.channel());
            self.model.judged_on(hold_out, context).iter().zip(without).map(|(a, b)| a - b).sum()
        };
        if self.counts() && gained() >= context.calibration.judgement.strong_nats {
            return self;
        }
        Remainder { by_block: vec![0.0; self.by_block.len()], ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::*;
    use mindgap_foundations::geometry::Pose;
    use mindgap_models::simulator::baseline::Baseline;
    use mindgap_models::simulator::textbook;

    /// Eight blocks of twelve rows with forward residuals.
    fn rows(off_cm: fn(usize) -> f64) -> Observations {
        observations(8, 12, move |_, at| {
            let command = if at.is_multiple_of(2) { [40.0, 60.0] } else { [60.0, 40.0] };
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

    #[test]
    fn what_is_as_expected_leaves_nothing_over() {
        assert!(counting(&confirmed(AS_EXPECTED, AS_EXPECTED)).is_empty());
    }

    #[test]
    fn what_follows_the_commands_is_left_over_where_runs_held_out_show_it_too() {
        assert_eq!(counting(&confirmed(LONGER_TO_ONE_SIDE, LONGER_TO_ONE_SIDE)), [Channel::Forward]);
        assert!(counting(&confirmed(LONGER_TO_ONE_SIDE, AS_EXPECTED)).is_empty());
    }

    /// What scatters more follows nothing.
    #[test]
    fn wider_scatter_is_no_remainder() {
        let scattered = |at| 2.0 * alternating(at / 2);
        assert!(counting(&confirmed(scattered, scattered)).is_empty());
    }

    /// Half of the steps are spins that turn too far by the scatter.
    #[test]
    fn what_the_training_logs_leave_open_is_no_remainder() {
        let left_over = |spins: usize| {
            let mut simulator = textbook::simulator(&baseline(), SCATTER).expect("a simulator");
            let motion = simulator.reference.as_mut().and_then(|reference| reference.motion.as_mut());
            motion.expect("a motion").precision = Some(precision(2000, spins));
            let baseline = Baseline::learned(&simulator).expect("a baseline");
            let rows = observations(8, 24, |_, at| {
                let (command, off) = if at < 12 { (STRAIGHT, 0.0) } else { (SPIN, SCATTER[2]) };
                let off = [0.0, 0.0, off + 0.9 * SCATTER[2] * alternating(at)];
                Made { commands: [command; 2], off, ..Made::default() }
            });
            let context = FitContext::new(&baseline, &rows, METHOD);
            let beyond = remainders(&Fitted::none(&context), &context);
            let told: Vec<String> = beyond.iter().filter_map(|r| r.own_error(&context.calibration)).collect();
            (counting(&beyond), told)
        };
        let (remainders, told) = left_over(0);
        assert!(remainders.is_empty() && told.len() == 1 && told[0].starts_with("The turn is off by"), "{told:?}");
        assert_eq!(left_over(2000), (vec![Channel::Turn], Vec::new()));
    }

    /// Half of the steps begin in a corner, where they scatter three times as much and on average go as far as elsewhere.
    #[test]
    fn what_scatters_at_one_spot_of_the_floor_follows_the_place() {
        let made = |_, at: usize| {
            let (x_cm, share) = if at.is_multiple_of(2) { (50.0, 3.0) } else { (250.0, 1.0) };
            let off = [share * 0.9 * alternating(at / 2), 0.0, 0.0];
            Made { pose: Pose::new(x_cm, 50.0, 0.0), off, ..Made::default() }
        };
        let (baseline, rows) = (baseline(), observations(8, 60, made));
        let context = FitContext::new(&baseline, &rows, METHOD);
        assert_eq!(counting(&remainders(&Fitted::none(&context), &context)), [Channel::Forward]);
    }
}
