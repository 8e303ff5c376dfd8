//! How far the gap shrinks with the named effects, on runs that they were not fitted on.

use rand::RngExt;

use super::explanation::Explanation;
use super::search::Fitted;
use crate::chance::generator;

/// A gap in nats a step: how much likelier the logs could be.
#[derive(Clone, Debug)]
pub struct Shrink {
    /// With the simulator as it is.
    pub before: f64,
    /// With the effects added.
    pub after: f64,
    /// The share of the reducible gap that is closed.
    pub closed: f64,
    /// 95 % interval of that share, by bootstrap over runs.
    pub ci95: [f64; 2],
    /// The next best explanation and the share that it closes.
    pub runner_up: Option<(Vec<&'static str>, f64)>,
}

/// Resamples of a bootstrap.
const RESAMPLES: usize = 2000;

/// None where there is no reducible gap.
pub fn shrink(explanation: &Explanation, steps: usize) -> Option<Shrink> {
    let gains = explanation.chosen.gains_over(&explanation.none);
    let left: Vec<f64> =
        (0..gains.len()).map(|block| explanation.beyond_chosen.iter().map(|l| l.by_block[block]).sum()).collect();
    let reducible: f64 = gains.iter().chain(&left).sum();
    if reducible <= 0.0 {
        return None;
    }
    let closed_by = |fit: &Fitted| fit.gain_over(&explanation.none).nats / reducible;
    Some(Shrink {
        before: reducible / steps as f64,
        after: left.iter().sum::<f64>() / steps as f64,
        closed: closed_by(&explanation.chosen),
        ci95: interval(&gains, &left),
        runner_up: explanation.runner_up().map(|r| (r.ids(), closed_by(r))),
    })
}

fn interval(gains: &[f64], left: &[f64]) -> [f64; 2] {
    let mut rng = generator(1, &[]);
    let mut shares: Vec<f64> = (0..RESAMPLES)
        .map(|_| {
            let drawn = (0..gains.len()).map(|_| rng.random_range(0..gains.len()));
            let (gain, all) = drawn.fold((0.0, 0.0), |(g, a), i| (g + gains[i], a + gains[i] + left[i]));
            gain / all
        })
        .filter(|share| share.is_finite())
        .collect();
    shares.sort_by(f64::total_cmp);
    let at = |share: f64| shares.get((share * shares.len() as f64) as usize).copied().unwrap_or(f64::NAN);
    [at(0.025), at(0.975)]
}
