//! Noise of steps beyond the simulator's. It is unstructured, so no effect can reduce it; it is reported as excess noise.

use super::explanation::Explanation;
use super::fit::FitContext;
use super::noise_model::{fitted_noise, log_density};
use super::remainder::Remainder;
use super::sample::{HoldOut, RowSet, Sample};
use super::scores::Scores;
use mindgap_foundations::channel::Channel;
use mindgap_learning::evaluation::observations::Observation;

/// A motion channel whose noise exceeds the simulator's.
#[derive(Clone, Debug, PartialEq)]
pub struct WiderNoise {
    /// Index among forward, lateral and turn.
    pub axis: usize,
    /// Standard deviation in these logs, cm or rad.
    pub fitted: f64,
    /// Standard deviation of the simulator, cm or rad.
    pub assumed: f64,
    /// Whether it is the same at low speed and independent from step to step. Noise that grows with speed or is autocorrelated
    /// has a cause.
    pub is_uniform: bool,
    /// Gain of each identification row over the simulator's noise.
    pub gains: Scores,
}

/// What a remainder leaves of one motion channel, as noise of a given width.
struct Noise<'a> {
    remainder: &'a Remainder,
    axis: usize,
    width: f64,
    cross_validated: Scores,
}

/// Fraction of the steps that count as slow.
const SLOW: f64 = 1.0 / 3.0;
/// Noise is uniform if slow steps have at least this fraction of the excess variance: half of what they have if it is the same at
/// all speeds, and more than a ninth, which is what variance proportional to squared speed leaves to the slowest third.
const UNIFORM: f64 = 0.5;
/// Independent noise has no correlation from step to step, and tracker noise a negative one; more than this is beyond four
/// standard errors of a thousand steps.
const MOST_CORRELATION: f64 = 0.12;
/// Residuals are clipped at this many standard deviations for the correlation.
const FARTHEST: f64 = 3.0;

impl Explanation for Noise<'_> {
    fn cross_validated(&self) -> &Scores {
        &self.cross_validated
    }

    fn predict(&self, rows: &HoldOut) -> Scores {
        Noise::scores(self.remainder, self.axis, self.width, RowSet::HeldOut(rows))
    }

    /// One width for thousands of rows costs almost nothing.
    fn complexity_penalty(&self) -> f64 {
        0.0
    }
}

impl<'a> Noise<'a> {
    fn new(remainder: &'a Remainder, axis: usize, width: f64, context: &'a FitContext) -> Self {
        let cross_validated = Noise::scores(remainder, axis, width, RowSet::Fitted(context.rows));
        Noise { remainder, axis, width, cross_validated }
    }

    fn scores(remainder: &Remainder, axis: usize, width: f64, rows: RowSet) -> Scores {
        let (sample, residuals) = (rows.sample(), remainder.residuals(rows).unwrap_or_default());
        let term = |(row, residual): (&Observation, &Option<f64>)| {
            residual.map_or(0.0, |r| row.motion_weight[axis] * log_density(axis, r, width))
        };
        let column: Vec<f64> = sample.rows.iter().zip(&residuals).map(term).collect();
        sample.scores_of(Channel::MOTION[axis], &column)
    }
}

/// Returns the channels whose noise exceeds the simulator's beyond effects and structured residuals; with held-out rows, only
/// where these confirm it.
pub fn wider_noise(beyond: &[Remainder], context: &FitContext, hold_out: Option<&HoldOut>) -> Vec<WiderNoise> {
    beyond.iter().filter_map(|remainder| WiderNoise::of(remainder, context, hold_out)).collect()
}

impl WiderNoise {
    fn of(remainder: &Remainder, context: &FitContext, hold_out: Option<&HoldOut>) -> Option<Self> {
        let axis = remainder.channel().motion_axis()?;
        let assumed = context.baseline().motion.as_ref()?.scatter().into_array()[axis];
        let residuals = remainder.residuals(RowSet::Fitted(context.rows))?;
        let fitted = noise_of(axis, &residuals, context.rows, assumed, |_| true);
        if fitted < context.calibration.judgement.scatter_ratio * assumed {
            return None;
        }
        let [wide, narrow] = [fitted, assumed].map(|width| Noise::new(remainder, axis, width, context));
        let is_confirmed = hold_out
            .is_none_or(|rows| wide.held_out_gain_over(&narrow, rows) >= context.calibration.judgement.strong_nats);
        if !wide.gain_over(&narrow).passes(context.calibration.remainder_nats) || !is_confirmed {
            return None;
        }
        let gains = wide.cross_validated() - narrow.cross_validated();
        let slow_speed = slow_speed(&context.rows.rows);
        let slow = noise_of(axis, &residuals, context.rows, 0.0, |row| speed(row) <= slow_speed);
        let excess = |noise: f64| noise * noise - assumed * assumed;
        let is_autocorrelated = correlation(&residuals, &context.rows.rows, FARTHEST * fitted) > MOST_CORRELATION;
        let is_uniform = excess(slow) >= UNIFORM * excess(fitted) && !is_autocorrelated;
        Some(WiderNoise { axis, fitted, assumed, is_uniform, gains })
    }
}

/// Fits the standard deviation, `least` or more, of some rows.
fn noise_of(
    axis: usize,
    residuals: &[Option<f64>],
    sample: &Sample,
    least: f64,
    is_used: impl Fn(&Observation) -> bool,
) -> f64 {
    let rows = residuals.iter().zip(&sample.rows).filter(|(_, row)| is_used(row));
    let rows = rows.filter_map(|(r, row)| Some([(*r)?, row.motion_weight[axis]]));
    fitted_noise(axis, &rows.collect::<Vec<[f64; 2]>>(), least)
}

/// Returns the correlation of consecutive steps, with residuals clipped at `most`.
fn correlation(residuals: &[Option<f64>], rows: &[Observation], most: f64) -> f64 {
    let clipped = |r: f64| r.clamp(-most, most);
    let consecutive = residuals.windows(2).zip(rows.windows(2)).filter(|(_, rows)| rows[0].block == rows[1].block);
    let pairs = consecutive.filter_map(|(pair, _)| Some((clipped(pair[0]?), clipped(pair[1]?))));
    let (products, squares) =
        pairs.fold((0.0, 0.0), |(products, squares), (a, b)| (products + a * b, squares + 0.5 * (a * a + b * b)));
    if squares > 0.0 { products / squares } else { 0.0 }
}

fn slow_speed(rows: &[Observation]) -> f64 {
    let mut speeds: Vec<f64> = rows.iter().map(speed).collect();
    speeds.sort_by(f64::total_cmp);
    speeds.get((SLOW * speeds.len() as f64) as usize).copied().unwrap_or(0.0)
}

/// Returns the sum of the commands of a step and the one before.
fn speed(row: &Observation) -> f64 {
    row.commands().as_flattened().iter().map(|c| c.abs()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::Fitted;
    use crate::remainder::remainders;
    use crate::test_support::*;
    use mindgap_learning::evaluation::observations::Observations;

    fn found(observations: Observations) -> Vec<WiderNoise> {
        let baseline = baseline();
        let rows = identification(&baseline, observations);
        let context = FitContext::new(&rows, METHOD);
        wider_noise(&remainders(&Fitted::null(&context), &context), &context, None)
    }

    /// Eight blocks of rows with forward residuals of these widths at rest and at full speed.
    fn scattered(at_rest_cm: f64, at_speed_cm: f64) -> Observations {
        observations(8, 16, move |_, at| {
            let (command, width_cm) = if at % 4 < 2 { (5.0, at_rest_cm) } else { (80.0, at_speed_cm) };
            Made { commands: [[command; 2]; 2], off: [width_cm * alternating(at), 0.0, 0.0], ..Made::default() }
        })
    }

    #[test]
    fn assumed_noise_is_not_reported() {
        assert_eq!(found(scattered(0.7, 0.7)), []);
    }

    #[test]
    fn wider_noise_is_reported_with_its_width() {
        let [forward] = found(scattered(3.0, 3.0)).try_into().expect("one channel");
        assert_eq!((forward.axis, forward.assumed, forward.is_uniform), (0, NOISE[0], true));
        assert!((2.0..4.5).contains(&forward.fitted), "{}", forward.fitted);
    }

    /// Eight steps to one side are followed by eight to the other.
    #[test]
    fn autocorrelated_residuals_are_not_noise() {
        let rows = observations(8, 32, |_, at| Made { off: [3.0 * alternating(at / 8), 0.0, 0.0], ..Made::default() });
        let found = found(rows);
        assert!(!found[0].is_uniform, "{found:?}");
    }

    #[test]
    fn noise_at_speed_alone_is_not_uniform() {
        let [forward] = found(scattered(0.7, 6.0)).try_into().expect("one channel");
        assert!(!forward.is_uniform);
    }
}
