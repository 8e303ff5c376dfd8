//! Scatter of steps beyond what the simulator assumes. It follows nothing, so that no effect could close it, and it is told
//! as what it is.

use super::fit::FitContext;
use super::gain::Gain;
use super::remainder::Remainder;
use super::residual_law::{fitted_scatter, log_density};
use mindgap_learning::evaluation::observations::{Observation, Observations};

/// A motion channel whose steps scatter more than assumed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WiderScatter {
    /// The place among forward, lateral and turn.
    pub axis: usize,
    /// Standard deviation of the logs, cm or rad.
    pub own: f64,
    /// Standard deviation that the simulator assumes, cm or rad.
    pub assumed: f64,
    /// Whether slow steps scatter more as well, and each step anew: what grows with speed or comes back has a cause.
    pub is_even: bool,
}

/// Share of the steps that count as slow.
const SLOW: f64 = 1.0 / 3.0;
/// Scatter is even where at least this share of the further variance is there in slow steps too: half of what is the same at
/// all speeds, and more than what is proportional to speed leaves to the slowest third, a ninth.
const EVEN: f64 = 0.5;
/// What is drawn anew has no correlation from step to step, and a tracker's error a negative one; more than this is beyond
/// four standard errors of a thousand steps.
const MOST_CORRELATION: f64 = 0.12;
/// A residual that is farther off counts as so many deviations: a jump says nothing about steps.
const FARTHEST: f64 = 3.0;

/// The channels that scatter more beyond effects and what the residual model explains besides, `beyond` them; with runs held
/// out, only where these show it too.
pub fn wider(beyond: &[Remainder], context: &FitContext, hold_out: Option<&Observations>) -> Vec<WiderScatter> {
    let of = |remainder: &Remainder| {
        let rest = remainder.rest(context.observations, context)?;
        let wider = WiderScatter::of(remainder, &rest, context)?;
        let gains = wider.gains(&rest, context.observations);
        let counts = Gain::of(&context.observations.by_block(&gains)).passes(context.calibration.remainder_nats);
        let confirmed = hold_out.is_none_or(|rows| {
            let gained: f64 = remainder.rest(rows, context).iter().flat_map(|rest| wider.gains(rest, rows)).sum();
            gained >= context.calibration.judgement.strong_nats
        });
        (counts && confirmed).then_some(wider)
    };
    beyond.iter().filter_map(of).collect()
}

impl WiderScatter {
    /// None where the scatter is within what chance makes of the simulator's.
    fn of(remainder: &Remainder, rest: &[Option<f64>], context: &FitContext) -> Option<Self> {
        let axis = remainder.channel().motion_axis()?;
        let assumed = context.baseline.motion.as_ref()?.scatter()[axis];
        let rows = &context.observations.rows;
        let own = scatter(axis, rest, rows, assumed, |_| true);
        let slow_speed = slow_speed(rows);
        let slow = scatter(axis, rest, rows, 0.0, |row| speed(row) <= slow_speed);
        let further = |scatter: f64| scatter * scatter - assumed * assumed;
        let comes_back = correlation(rest, rows, FARTHEST * own) > MOST_CORRELATION;
        let is_even = further(slow) >= EVEN * further(own) && !comes_back;
        (own >= context.calibration.judgement.scatter_ratio * assumed).then_some(WiderScatter {
            axis,
            own,
            assumed,
            is_even,
        })
    }

    /// By how much each row is likelier with the scatter of the logs than with the simulator's.
    pub fn gains(&self, rest: &[Option<f64>], rows: &Observations) -> Vec<f64> {
        let gain = |r: f64| log_density(self.axis, r, self.own) - log_density(self.axis, r, self.assumed);
        let rows = rest.iter().zip(&rows.rows);
        rows.map(|(r, row)| row.motion_weight[self.axis] * r.map_or(0.0, gain)).collect()
    }
}

fn scatter(
    axis: usize,
    rest: &[Option<f64>],
    rows: &[Observation],
    least: f64,
    is_among: impl Fn(&Observation) -> bool,
) -> f64 {
    let of_rows = rest.iter().zip(rows).filter(|(_, row)| is_among(row));
    let of_rows = of_rows.filter_map(|(r, row)| Some([(*r)?, row.motion_weight[axis]]));
    fitted_scatter(axis, &of_rows.collect::<Vec<[f64; 2]>>(), least)
}

/// The correlation of neighbouring steps, each within `most`.
fn correlation(rest: &[Option<f64>], rows: &[Observation], most: f64) -> f64 {
    let within = |r: f64| r.clamp(-most, most);
    let neighbours = rest.windows(2).zip(rows.windows(2)).filter(|(_, rows)| rows[0].block == rows[1].block);
    let pairs = neighbours.filter_map(|(rest, _)| Some((within(rest[0]?), within(rest[1]?))));
    let (products, squares) =
        pairs.fold((0.0, 0.0), |(products, squares), (a, b)| (products + a * b, squares + 0.5 * (a * a + b * b)));
    if squares > 0.0 { products / squares } else { 0.0 }
}

fn slow_speed(rows: &[Observation]) -> f64 {
    let mut speeds: Vec<f64> = rows.iter().map(speed).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.get((SLOW * speeds.len() as f64) as usize).copied().unwrap_or(0.0)
}

/// What a step and the one before command.
fn speed(row: &Observation) -> f64 {
    row.context.commands[..2].as_flattened().iter().map(|c| c.abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Fitted;
    use crate::remainder::remainders;
    use crate::test_support::*;

    /// Eight blocks of rows whose forward residuals are so wide at rest and at full speed.
    fn found(at_rest_cm: f64, at_speed_cm: f64) -> Vec<WiderScatter> {
        let rows = observations(8, 16, move |_, at| {
            let (command, width_cm) = if at % 4 < 2 { (5.0, at_rest_cm) } else { (80.0, at_speed_cm) };
            Made { commands: [[command; 2]; 2], off: [width_cm * alternating(at), 0.0, 0.0], ..Made::default() }
        });
        let baseline = baseline();
        let context = FitContext::new(&baseline, &rows, METHOD);
        wider(&remainders(&Fitted::none(&context), &context), &context, None)
    }

    #[test]
    fn what_scatters_as_assumed_is_not_told() {
        assert_eq!(found(0.7, 0.7), []);
    }

    #[test]
    fn what_scatters_more_is_told_with_its_width() {
        let [forward] = found(3.0, 3.0).try_into().expect("one channel");
        assert_eq!((forward.axis, forward.assumed, forward.is_even), (0, SCATTER[0], true));
        assert!((2.0..4.5).contains(&forward.own), "{}", forward.own);
    }

    /// Steps that are off to one side and to the other for eight steps each.
    #[test]
    fn what_comes_back_is_no_scatter() {
        let rows = observations(8, 32, |_, at| Made { off: [3.0 * alternating(at / 8), 0.0, 0.0], ..Made::default() });
        let baseline = baseline();
        let context = FitContext::new(&baseline, &rows, METHOD);
        let found = wider(&remainders(&Fitted::none(&context), &context), &context, None);
        assert!(!found[0].is_even, "{found:?}");
    }

    #[test]
    fn what_scatters_more_at_speed_alone_is_not_even() {
        let [forward] = found(0.7, 6.0).try_into().expect("one channel");
        assert!(!forward.is_even);
    }
}
