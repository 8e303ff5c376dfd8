//! What all explanations of logs have in common.
//!
//! The simulator itself, effects, a formula, a regression on covariates, wider noise and the simulator's epistemic error are all
//! judged in the same way. Each scores the rows that it was fitted to by cross-validation, so that freedom alone gains nothing,
//! predicts the held-out rows, and pays a penalty for its complexity. Everything else in a diagnosis is a difference of scores.

use super::gain::Gain;
use super::sample::HoldOut;
use super::scores::Scores;

/// An explanation of logs that was fitted to identification rows.
pub trait Explanation {
    /// Returns the log-likelihoods of the rows that it was fitted to, each block scored without a fit to that block.
    fn cross_validated(&self) -> &Scores;

    /// Returns the log-likelihoods of held-out rows.
    fn predict(&self, rows: &HoldOut) -> Scores;

    /// Returns the nats that the marginal likelihood lies below the cross-validated score (Occam factor).
    fn complexity_penalty(&self) -> f64;

    /// Returns the logarithm of the marginal likelihood. Blocks are its unit: it uses the likelihood of each block at the
    /// parameters of the others in place of the likelihood at its maximum.
    fn log_evidence(&self) -> f64 {
        self.cross_validated().total() - self.complexity_penalty()
    }

    /// Returns the cross-validated gain over `other` per block, without penalties.
    fn gains_over(&self, other: &dyn Explanation) -> Vec<f64> {
        let (own, other) = (self.cross_validated().by_block(), other.cross_validated().by_block());
        own.iter().zip(other).map(|(a, b)| a - b).collect()
    }

    /// Returns the gain over `other` by the evidence.
    fn gain_over(&self, other: &dyn Explanation) -> Gain {
        Gain::of(&self.gains_over(other)).less(self.complexity_penalty() - other.complexity_penalty())
    }

    /// Returns the gain over `other` on held-out rows, per block.
    fn held_out_gains_over(&self, other: &dyn Explanation, rows: &HoldOut) -> Vec<f64> {
        (&self.predict(rows) - &other.predict(rows)).by_block()
    }

    /// Returns the gain over `other` on all held-out rows.
    fn held_out_gain_over(&self, other: &dyn Explanation, rows: &HoldOut) -> f64 {
        self.held_out_gains_over(other, rows).iter().sum()
    }
}
