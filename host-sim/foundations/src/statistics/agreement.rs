//! Measures of agreement between predictions and observations.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::summary::mean;

/// A straight line fitted to (expected, predicted), as in the paper's figure 2.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrendLine {
    /// Predicted change per expected change.
    pub slope: f64,
    /// Prediction at an expected value of zero.
    pub intercept: f64,
}

/// One row of a reliability table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ReliabilityBin {
    /// Mean predicted probability.
    pub predicted: f64,
    /// Observed frequency.
    pub observed: f64,
    /// Number of samples.
    pub n: usize,
}

/// Probabilities are clamped to at least this distance from 0 and 1 in [`log_loss`]: a single surprise after certainty would
/// cost infinitely much.
const NEAREST_TO_CERTAIN: f64 = 0.001;

/// Returns the mean squared error.
pub fn mse(expected: &[f64], predicted: &[f64]) -> f64 {
    mean(expected.iter().zip(predicted).map(|(e, p)| (e - p) * (e - p)))
}

/// Returns the mean absolute error.
pub fn mae(expected: &[f64], predicted: &[f64]) -> f64 {
    mean(expected.iter().zip(predicted).map(|(e, p)| (e - p).abs()))
}

/// Returns the coefficient of determination R², the fraction of the variance of `expected` that is explained, or `None` if
/// the variance is zero.
pub fn r2(expected: &[f64], predicted: &[f64]) -> Option<f64> {
    let expected_mean = mean(expected.iter().copied());
    let variance = mean(expected.iter().map(|e| (e - expected_mean) * (e - expected_mean)));
    (variance > 0.0).then(|| 1.0 - mse(expected, predicted) / variance)
}

/// Returns the least-squares line of predicted over expected, or `None` if all expected values are equal.
pub fn trend_line(expected: &[f64], predicted: &[f64]) -> Option<TrendLine> {
    let (x, y) = (mean(expected.iter().copied()), mean(predicted.iter().copied()));
    let sxx = mean(expected.iter().map(|e| (e - x) * (e - x)));
    let sxy = mean(expected.iter().zip(predicted).map(|(e, p)| (e - x) * (p - y)));
    (sxx > 0.0).then(|| TrendLine { slope: sxy / sxx, intercept: y - sxy / sxx * x })
}

/// Returns the mean negative log-likelihood of 0/1 outcomes, in nats.
pub fn log_loss(outcomes: &[f64], probabilities: &[f64]) -> f64 {
    mean(outcomes.iter().zip(probabilities).map(|(o, p)| {
        let p = p.clamp(NEAREST_TO_CERTAIN, 1.0 - NEAREST_TO_CERTAIN);
        -libm::log(if *o > 0.5 { p } else { 1.0 - p })
    }))
}

/// Returns the area under the ROC curve: the probability that a random positive ranks above a random negative, with ties
/// counting half. `None` unless both occur.
pub fn auc(outcomes: &[f64], probabilities: &[f64]) -> Option<f64> {
    let mut order: Vec<usize> = (0..outcomes.len()).collect();
    order.sort_by(|a, b| probabilities[*a].total_cmp(&probabilities[*b]));
    let positives = outcomes.iter().filter(|o| **o > 0.5).count() as f64;
    let negatives = outcomes.len() as f64 - positives;
    if positives == 0.0 || negatives == 0.0 {
        return None;
    }
    let mut rank_sum = 0.0;
    let mut first = 0;
    for ties in order.chunk_by(|a, b| probabilities[*a] == probabilities[*b]) {
        let mean_rank = first as f64 + (ties.len() as f64 + 1.0) / 2.0;
        rank_sum += mean_rank * ties.iter().filter(|i| outcomes[**i] > 0.5).count() as f64;
        first += ties.len();
    }
    Some((rank_sum - positives * (positives + 1.0) / 2.0) / (positives * negatives))
}

/// Returns a reliability table in ten equal bins of the predicted probability, without empty bins.
pub fn reliability(outcomes: &[f64], probabilities: &[f64]) -> Vec<ReliabilityBin> {
    const BINS: usize = 10;
    let mut sums = [(0.0, 0.0, 0); BINS];
    for (o, p) in outcomes.iter().zip(probabilities) {
        let bin = &mut sums[((p * BINS as f64) as usize).min(BINS - 1)];
        *bin = (bin.0 + p, bin.1 + o, bin.2 + 1);
    }
    let filled = sums.into_iter().filter(|bin| bin.2 > 0);
    filled.map(|(p, o, n)| ReliabilityBin { predicted: p / n as f64, observed: o / n as f64, n }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn r2_is_one_for_a_perfect_prediction_and_zero_for_the_mean() {
        let y = [1.0, 2.0, 4.0];
        assert_eq!(r2(&y, &y), Some(1.0));
        assert!(r2(&y, &[7.0 / 3.0; 3]).unwrap().abs() < 1e-12);
        assert_eq!(r2(&[3.0, 3.0], &[1.0, 2.0]), None);
        assert_eq!(trend_line(&y, &[3.0, 5.0, 9.0]), Some(TrendLine { slope: 2.0, intercept: 1.0 }));
    }

    #[test]
    fn log_loss_of_a_certain_mistake_is_bounded() {
        assert!((log_loss(&[1.0], &[0.0]) + libm::log(0.001)).abs() < 1e-12);
    }

    #[test]
    fn reliability_table_skips_empty_bins() {
        let bins = reliability(&[0.0, 1.0, 1.0], &[0.55, 0.55, 1.0]);
        assert_eq!((bins[0].observed, bins[0].n), (0.5, 2));
        assert_eq!((bins[1].observed, bins[1].n), (1.0, 1));
    }

    proptest! {
        #[test]
        fn auc_is_the_fraction_of_ordered_pairs(pairs in prop::collection::vec((any::<bool>(), 0u8..5), 2..40)) {
            let outcomes: Vec<f64> = pairs.iter().map(|p| f64::from(u8::from(p.0))).collect();
            let scores: Vec<f64> = pairs.iter().map(|p| f64::from(p.1)).collect();
            let (mut won, mut total) = (0.0f64, 0.0f64);
            for i in 0..pairs.len() {
                for j in 0..pairs.len() {
                    if pairs[i].0 && !pairs[j].0 {
                        total += 1.0;
                        won += if scores[i] > scores[j] { 1.0 } else if scores[i] == scores[j] { 0.5 } else { 0.0 };
                    }
                }
            }
            let area = auc(&outcomes, &scores);
            prop_assert_eq!(area.is_some(), total > 0.0);
            prop_assert!(area.is_none_or(|a: f64| (a - won / total).abs() < 1e-12));
        }
    }
}
