//! Rows that lie farther off than the noise model expects: a tail that is heavier than the simulator's, or a clump of such rows
//! in one run or at one place. Effects fitted to all rows cannot explain them, and an average over rows does not show them.

use std::collections::BTreeMap;
use std::iter;

use schemars::JsonSchema;
use serde::Serialize;

use super::fit::{FitContext, Fitted};
use super::noise_model::{REACH, log_density};
use super::sample::{HoldOut, Sample};
use super::scope::of_sensor;
use super::scores::Scores;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::rounding;
use mindgap_learning::evaluation::observations::Observation;

/// Rows of a channel that the noise model does not expect.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Outliers {
    /// The channel.
    pub channel: Channel,
    /// Number of the run in which they lie, from zero in the order of the file names; null if they lie in several.
    pub run: Option<usize>,
    /// Place near which they lie, x and y in cm; null if they do not lie near one place.
    pub place_cm: Option<[i32; 2]>,
    /// Their share of these rows.
    #[serde(serialize_with = "rounding::number")]
    pub share: f64,
    /// How much more likely these rows are if outliers have this share, nats.
    #[serde(serialize_with = "rounding::number")]
    pub nats: f64,
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

impl Outliers {
    /// Describes them in a sentence.
    pub fn sentence(&self) -> String {
        let among = match (self.run, self.place_cm) {
            (Some(run), _) => format!("the rows of run {} in the order of the files' names", run + 1),
            (_, Some([x_cm, y_cm])) => format!("the rows near x {x_cm} cm, y {y_cm} cm"),
            _ => "all rows".into(),
        };
        let channel = of_sensor(self.channel.name(), self.sensor.as_deref());
        format!("Off by more than noise explains ({channel}): {:.0} % of {among}.", 100.0 * self.share)
    }
}

/// What rows have in common: nothing, their run, or their place in cm.
type Group = (Option<usize>, Option<[i32; 2]>);

/// Logged minus predicted motion of every row.
type Residuals = Vec<Option<[f64; 3]>>;

/// A row with how much more likely it is as an outlier, by each law of outliers.
struct Likely<'r> {
    row: &'r Observation,
    weight: f64,
    ratios: [f64; LAWS],
}

/// Outliers are spread over a room, or a few times as wide as the noise.
const LAWS: usize = 2;
const WIDER: f64 = 4.0;
/// Shares of outliers that are compared; the noise model itself contains one in a hundred.
const SHARES: [f64; 6] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.4];
/// Side of a place, in radii of the robot's body.
const PLACE_RADII: f64 = 4.0;
/// With fewer rows a run or a place shows no share.
const LEAST_ROWS: usize = 8;

/// Returns for each compared channel the rows with the clearest outliers around a fit, on fitted and held-out rows alike.
pub fn outliers(fit: &Fitted, context: &FitContext, hold_out: Option<&HoldOut>) -> Vec<Outliers> {
    let (fitted, effects): (&Sample, _) = (context.rows, fit.effects());
    let samples = iter::once(fitted).chain(hold_out.map(|rows| &**rows));
    let samples: Vec<(&Sample, Residuals)> = samples.map(|sample| (sample, sample.residuals(&effects))).collect();
    let of_channel = |channel: Channel| {
        let rows = samples.iter().flat_map(|(sample, residuals)| likely(fit, channel, sample, residuals));
        clearest(channel, &rows.collect::<Vec<_>>(), context)
    };
    Channel::SIMULATED.into_iter().filter(|channel| *channel != Channel::EchoRate).filter_map(of_channel).collect()
}

/// Returns the group of rows with the largest gain, if that passes the gate for all groups that were tried.
fn clearest(channel: Channel, rows: &[Likely], context: &FitContext) -> Option<Outliers> {
    let side_cm = PLACE_RADII * context.baseline().robot.body_radius_cm;
    let mut groups: BTreeMap<Group, Vec<&Likely>> = BTreeMap::new();
    for likely in rows {
        let position_cm = likely.row.context.pose.position_cm;
        let middle = |at_cm: f64| ((libm::floor(at_cm / side_cm) + 0.5) * side_cm) as i32;
        let place_cm = [middle(position_cm.x), middle(position_cm.y)];
        for group in [(None, None), (Some(likely.row.run), None), (None, Some(place_cm))] {
            groups.entry(group).or_default().push(likely);
        }
    }
    groups.retain(|_, rows| rows.len() >= LEAST_ROWS);
    let tried = libm::log((LAWS * groups.len().max(1)) as f64);
    let best_of = |((run, place_cm), rows): (Group, Vec<&Likely>)| {
        let with = |law: usize, share: f64| {
            let nats: f64 = rows.iter().map(|row| row.weight * libm::log(1.0 - share + share * row.ratios[law])).sum();
            Outliers { channel, run, place_cm, share, nats: nats - tried, sensor: None }
        };
        let all = (0..LAWS).flat_map(|law| SHARES.map(|share| with(law, share)));
        all.max_by(|a, b| a.nats.total_cmp(&b.nats))
    };
    let best = groups.into_iter().filter_map(best_of).max_by(|a, b| a.nats.total_cmp(&b.nats))?;
    log::info!("outliers of {}: {best:?}", channel.name());
    (best.nats >= context.calibration.remainder_nats).then_some(best)
}

/// Compares every row of a channel with the laws of outliers.
fn likely<'r>(fit: &Fitted, channel: Channel, sample: &'r Sample, residuals: &Residuals) -> Vec<Likely<'r>> {
    match channel.motion_axis() {
        Some(axis) => steps(fit, axis, sample, residuals),
        None => readings(&fit.scores_within(fit.noise, sample), sample),
    }
}

fn steps<'r>(fit: &Fitted, axis: usize, sample: &'r Sample, residuals: &Residuals) -> Vec<Likely<'r>> {
    let noise = fit.noise[axis];
    let of_row = |(row, residual): (&'r Observation, &Option<_>)| {
        let residual: [f64; 3] = (*residual)?;
        let log_density = |width: f64| log_density(axis, residual[axis], width);
        let spread = -libm::log(2.0 * REACH[axis]);
        let ratios = [spread, log_density(WIDER * noise)].map(|law| libm::exp(law - log_density(noise)));
        Some(Likely { row, weight: row.motion_weight[axis], ratios })
    };
    sample.rows.iter().zip(residuals).filter_map(of_row).collect()
}

fn readings<'r>(scores: &Scores, sample: &'r Sample) -> Vec<Likely<'r>> {
    let Some(sensor) = sample.baseline.robot.ultrasonic else { return Vec::new() };
    let spread = -libm::log(sensor.max_cm - sensor.min_cm);
    let of_row = |(row, nats): (&'r Observation, f64)| {
        let weight = row.echo_weight[1];
        let is_compared = row.echo_cm.is_some() && weight > 0.0 && nats != 0.0;
        is_compared.then(|| Likely { row, weight, ratios: [libm::exp(spread - nats / weight); LAWS] })
    };
    sample.rows.iter().zip(scores.of(Channel::EchoValue)).filter_map(of_row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::*;
    use mindgap_foundations::geometry::Pose;
    use mindgap_learning::evaluation::observations::Observations;

    fn found(rows: Observations) -> Vec<Outliers> {
        let baseline = baseline();
        let rows = identification(&baseline, rows);
        let context = FitContext::new(&rows, METHOD);
        outliers(&Fitted::null(&context), &context, None)
    }

    /// Thirty blocks of 32 rows; where `is_off`, a row turns one radian too far.
    fn turned(is_off: impl Fn(usize, usize) -> bool) -> Observations {
        observations(30, 32, move |block, at| {
            let off_rad = if is_off(block, at) { 1.0 } else { 0.08 * alternating(at) };
            let pose = Pose::new(20.0 + 8.0 * at as f64, 100.0, 0.0);
            Made { off: [0.9 * alternating(at), 0.0, off_rad], pose, ..Made::default() }
        })
    }

    #[test]
    fn noise_as_expected_has_no_outliers() {
        assert_eq!(found(turned(|_, _| false)), []);
        assert_eq!(found(turned(|block, at| block == 7 && at == 3)), [], "one lost pose is a tracker's failure");
    }

    #[test]
    fn a_share_of_all_rows_is_found() {
        let [found] = found(turned(|block, at| (block + at) % 16 == 0)).try_into().expect("one channel");
        assert_eq!((found.channel, found.run, found.place_cm, found.share), (Channel::Turn, None, None, 0.05));
    }

    #[test]
    fn a_clump_in_one_run_or_at_one_place_is_found_there() {
        let [in_run] = found(turned(|block, at| block == 7 && at % 4 == 0)).try_into().expect("one channel");
        assert_eq!((in_run.run, in_run.place_cm), (Some(7), None));
        // The place of 32 cm around x = 112 cm.
        let [at_place] = found(turned(|_, at| (10..13).contains(&at))).try_into().expect("one channel");
        assert_eq!((at_place.run, at_place.place_cm), (None, Some([112, 112])));
    }
}
