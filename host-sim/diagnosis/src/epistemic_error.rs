//! Epistemic error of the motion model.
//!
//! Training logs leave the weights of a simulator's correction uncertain, most of all under commands that they seldom drive. A
//! robot that behaves there as that uncertainty allows shows no gap. Before anything else is sought, the error that identification
//! rows reveal is subtracted from their residuals. It is a regression on the features of the correction with the posterior of
//! the training logs as the prior (Bishop 2006, Pattern Recognition and Machine Learning, section 3.3). Only directions are fitted
//! in which the training logs carry less information than these rows; everything that was learned better stays a yardstick.

use super::explanation::Explanation;
use super::fit::{FitContext, Fitted};
use super::residuals::{log_likelihoods, subtract, usual_noise};
use super::sample::HoldOut;
use super::scores::Scores;
use mindgap_foundations::channel::Channel;
use mindgap_foundations::statistics::summary::root_mean_square;

/// The epistemic error in one motion channel, as rows of other folds predict it.
pub struct EpistemicError {
    /// Predicted error of each identification row, cm or rad.
    pub predictions: Vec<f64>,
    /// Gain over the fit underneath.
    pub nats: f64,
    underneath: Fitted,
    cross_validated: Scores,
}

impl EpistemicError {
    /// Predicts the error from `residuals` of a fit. Returns `None` if nothing is uncertain or the rows are no more likely with
    /// the prediction.
    pub fn of(
        channel: Channel,
        axis: usize,
        underneath: &Fitted,
        residuals: &[Option<f64>],
        context: &FitContext,
    ) -> Option<Self> {
        let rows = context.rows;
        let predictions = context.motion_uncertainty.as_ref()?.predict(axis, &rows.rows, residuals)?;
        let beyond = subtract(residuals, &predictions);
        let ratios = vec![1.0; predictions.len()];
        let least = rows.baseline.motion.as_ref()?.scatter().into_array()[axis];
        let noise = usual_noise(axis, rows, &beyond, &ratios, least);
        let column = log_likelihoods(axis, noise, rows, &beyond, &ratios);
        let nats = column.iter().sum::<f64>() - underneath.scores.total_of(channel);
        let cross_validated = underneath.scores.clone().with(channel, &column);
        (nats > 0.0).then(|| EpistemicError { predictions, nats, underneath: underneath.clone(), cross_validated })
    }

    /// Returns the size of the error, cm or rad per step.
    pub fn root_mean_square(&self) -> f64 {
        root_mean_square(self.predictions.iter().copied())
    }
}

impl Explanation for EpistemicError {
    fn cross_validated(&self) -> &Scores {
        &self.cross_validated
    }

    /// Held-out rows are not corrected: what they confirm has to exceed the uncertainty on its own.
    fn predict(&self, rows: &HoldOut) -> Scores {
        self.underneath.predict(rows)
    }

    /// Its prior is a posterior of the training logs, and rows are predicted by other folds.
    fn complexity_penalty(&self) -> f64 {
        0.0
    }
}
