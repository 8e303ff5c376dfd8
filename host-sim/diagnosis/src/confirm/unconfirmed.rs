//! Effects that fitted rows show and held-out rows do not.

use schemars::JsonSchema;
use serde::Serialize;

use crate::excitation::expected_nats;
use crate::explanation::Explanation;
use crate::fit::{FitContext, Fitted};
use crate::gain::Gain;
use crate::sample::{HoldOut, Sample};
use crate::scope::of_sensor;
use mindgap_foundations::statistics::rounding;

/// An effect that was found on fitted rows and not confirmed on held-out ones.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Unconfirmed {
    /// Id of the effect.
    pub id: &'static str,
    /// What it gains by cross-validation on the rows where it was found, nats.
    #[serde(serialize_with = "rounding::number")]
    pub found_nats: f64,
    /// What it gains on held-out rows, nats.
    #[serde(serialize_with = "rounding::number")]
    pub confirmed_nats: f64,
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

impl Unconfirmed {
    /// Describes it in a sentence.
    pub fn sentence(&self) -> String {
        let Unconfirmed { id, found_nats, confirmed_nats, sensor } = self;
        let id = of_sensor(id, sensor.as_deref());
        format!(
            "Found but not confirmed: {id} gains {found_nats:.0} nats where it was found, and {confirmed_nats:.0} on \
             held-out runs."
        )
    }
}

/// The evidence for effects over the same without some of them, on both sides of the split.
pub struct Evidence<'a> {
    /// The effects.
    pub with: &'a Fitted,
    /// The same without those that are weighed.
    pub without: &'a Fitted,
    /// The held-out rows.
    pub hold_out: &'a HoldOut<'a>,
}

impl Evidence<'_> {
    /// Returns whether all rows together, found and held out, pass the gate of an effect.
    pub fn stands_over_all(&self, context: &FitContext) -> bool {
        let found = self.with.gains_over(self.without);
        let held_out = self.with.held_out_gains_over(self.without, self.hold_out);
        let penalty = self.with.complexity_penalty() - self.without.complexity_penalty();
        Gain::of(&[found, held_out].concat()).less(penalty).passes(context.calibration.effect_nats)
    }

    /// Returns whether held-out rows could confirm: whether the gain that the fitted rows promise there is strong evidence. Where
    /// it is not, cross-validation decides.
    pub fn can_confirm(&self, context: &FitContext) -> bool {
        let found: f64 = self.with.gains_over(self.without).iter().sum();
        let [held_out, fitted] = [self.excitation(self.hold_out), self.excitation(context.rows)];
        found * held_out >= context.calibration.judgement.strong_nats * fitted
    }

    /// Returns the nats that the effects could change on some rows.
    fn excitation(&self, rows: &Sample) -> f64 {
        let [with, without] = [self.with, self.without].map(|fit| fit.scores_within(self.with.noise, rows));
        expected_nats(&(&with - &without), rows)
    }
}
