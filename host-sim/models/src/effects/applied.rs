//! Effects that were applied to a simulator: what a diagnosis confirmed and its networks do not know.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::catalogue::{CATALOGUE, Candidate};
use super::own::definition::Definition;
use super::{Parameter, Variant, own};
use mindgap_files::did_you_mean;

/// One effect as files hold it: by the ids of the effect and its variant, and the names of its parameters.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AppliedEffect {
    /// Its id in the table of docs/formats.md.
    pub effect: String,
    /// Id of the variant.
    pub variant: String,
    /// Its parameters, each in its own unit.
    pub parameters: BTreeMap<String, f64>,
    /// What it is, if it is an own effect of a user.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub definition: Option<Definition>,
}

impl AppliedEffect {
    /// A variant with values in the order of its parameters.
    pub fn new(candidate: &Candidate, values: &[f64]) -> Self {
        let parameters = candidate.variant.parameters.iter().zip(values);
        AppliedEffect {
            effect: candidate.effect.into(),
            variant: candidate.variant.id.into(),
            parameters: parameters.map(|(p, value)| (p.name.into(), *value)).collect(),
            definition: own::definition_of(candidate.variant),
        }
    }

    /// The variant and its values.
    ///
    /// # Errors
    /// In one line, when this program does not know it, or one of its parameters is missing or not possible.
    pub fn resolve(&self) -> Result<(Candidate, Vec<f64>), String> {
        let own;
        let known = match &self.definition {
            None => CATALOGUE,
            Some(definition) => {
                own = [own::effect(definition)?];
                &own
            }
        };
        let ids = known.iter().map(|effect| effect.id);
        if ids.clone().all(|id| id != self.effect) {
            return Err(format!("it is not known to this program{}", did_you_mean(&self.effect, ids)));
        }
        let named = Candidate::named_in(known, &self.effect, &self.variant);
        let resolved = named.and_then(|candidate| Some((candidate, self.values(candidate.variant)?)));
        resolved.ok_or_else(|| "this program knows no such variant with these parameters and values".into())
    }

    /// Its values in the order of the variant's parameters, if it has these and no others, and each is possible.
    fn values(&self, variant: &Variant) -> Option<Vec<f64>> {
        let value = |p: &Parameter| self.parameters.get(p.name).copied().filter(|value| p.allows(*value));
        let values = variant.parameters.iter().map(value).collect::<Option<Vec<f64>>>()?;
        (values.len() == self.parameters.len()).then_some(values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_variant_comes_back_from_a_file() {
        for candidate in Candidate::all(CATALOGUE) {
            let values = candidate.variant.nominal();
            let text = serde_json::to_string(&AppliedEffect::new(&candidate, &values)).unwrap();
            let read: AppliedEffect = serde_json::from_str(&text).unwrap();
            assert!(read.resolve().is_ok_and(|(c, v)| c == candidate && v == values), "{text}");
        }
    }

    #[test]
    fn what_cannot_be_is_not_resolved() {
        let latency = |parameters: &[(&str, f64)]| AppliedEffect {
            effect: "latency".into(),
            variant: "delay".into(),
            parameters: parameters.iter().map(|(name, value)| (String::from(*name), *value)).collect(),
            definition: None,
        };
        assert!(latency(&[("ms", 100.0)]).resolve().is_ok());
        assert!(latency(&[("ms", -1.0)]).resolve().is_err());
        assert!(latency(&[("ms", f64::NAN)]).resolve().is_err());
        assert!(latency(&[]).resolve().is_err());
        assert!(latency(&[("ms", 100.0), ("s", 0.1)]).resolve().is_err());
    }
}
