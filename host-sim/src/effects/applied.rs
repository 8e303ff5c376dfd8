//! Effects that were added to a simulator: what a diagnosis confirmed and its networks do not know.

use serde::{Deserialize, Serialize};

use super::effect::Variant;
use crate::effects;

/// One effect with its parameters, as a simulator file holds it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AppliedEffect {
    /// Its name in the table of effects.
    pub effect: String,
    /// Which of its forms.
    pub form: String,
    /// The form's parameters.
    pub values: Vec<f64>,
}

impl AppliedEffect {
    /// A form with its parameters.
    pub fn new(form: &Variant, values: &[f64]) -> Self {
        AppliedEffect { effect: form.id.into(), form: form.name.into(), values: values.to_vec() }
    }

    /// The form, if this program knows it and its parameters are possible.
    pub fn variant(&self) -> Option<&'static Variant> {
        let form = effects::all().into_iter().find(|f| f.id == self.effect && f.name == self.form)?;
        let possible = form.parameters.len() == self.values.len()
            && form.parameters.iter().zip(&self.values).all(|(p, v)| (p.bounds.low..=p.bounds.high).contains(v));
        possible.then_some(form)
    }

    /// Whether a file could have held this.
    pub fn is_sound(&self) -> bool {
        self.variant().is_some()
    }
}
