//! Effects common to all robots of a fleet, which are errors of the simulator rather than of the robots.

use schemars::JsonSchema;
use serde::Serialize;

use super::frequency::{Frequency, frequencies};
use super::spread::Spread;
use super::tally::Tally;
use mindgap_foundations::statistics::rounding::three_digits;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::{Candidate, Parameter};

/// Minimum prevalence of a common effect.
const NEARLY_ALL: f64 = 0.9;
/// Minimum lower end of the 95 % interval of the prevalence.
const AT_LEAST: f64 = 0.5;
/// Maximum ratio of the scatter of a strength between robots to its median: then the central 95 % have one sign.
const SCATTERS: f64 = 0.5;
/// Maximum ratio of the scatter to the scale of the parameter; for a direction, the ratio to its own value means nothing.
const OF_LARGE: f64 = 0.1;

/// An effect that nearly all robots share with the same strength.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Common {
    /// The effect with the median parameters over the robots, as added to a simulator.
    pub effect: AppliedEffect,
    /// Explanation of the test that it passed.
    pub because: String,
}

/// Returns the effects common to nearly all robots.
pub fn common(tally: &Tally) -> Vec<Common> {
    let frequent = frequencies(tally).into_iter().filter(|f| f.frequency >= NEARLY_ALL && f.ci95[0] >= AT_LEAST);
    frequent.filter_map(|frequency| of(&frequency, tally)).collect()
}

fn of(frequency: &Frequency, tally: &Tally) -> Option<Common> {
    let part = tally.catalogue.iter().position(|effect| effect.id == frequency.id)?;
    let (form, robots) = tally.sightings[part].main_form()?;
    let variant = tally.catalogue[part].variants.iter().find(|variant| variant.id == form)?;
    let spread = |place: usize| Spread::of(robots.iter().map(|(_, values)| values[place]).collect());
    let spreads = (0..variant.parameters.len()).map(spread).collect::<Option<Vec<Spread>>>()?;
    let parameters = || variant.parameters.iter().zip(&spreads);
    if !parameters().all(|(parameter, spread)| is_the_same(parameter, spread)) {
        return None;
    }
    let (strength, ends) = parameters().find_map(|(parameter, spread)| {
        let ends = spread.median_ci95.filter(|[low, high]| parameter.nominal < *low || parameter.nominal > *high)?;
        Some((parameter, ends.map(three_digits)))
    })?;
    let medians: Vec<f64> = spreads.iter().map(|spread| three_digits(spread.median)).collect();
    Some(Common {
        effect: AppliedEffect::new(&Candidate { effect: frequency.id, variant }, &medians, tally.measures.as_ref()?),
        because: format!(
            "{} of the {} robots with sufficient excitation have it, {} of them as {form}; the 95 % interval of the median {} \
             is {} to {}, which excludes the neutral value {}, and it scatters little between robots",
            frequency.named,
            frequency.testable,
            robots.len(),
            strength.name,
            ends[0],
            ends[1],
            strength.nominal
        ),
    })
}

fn is_the_same(parameter: &Parameter, spread: &Spread) -> bool {
    let strength = (spread.median - parameter.nominal).abs();
    spread.deviation <= (SCATTERS * strength).max(OF_LARGE * parameter.scale)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fleet::robot::{Cause, Robot};
    use mindgap_built_in_robot::default_robot;
    use mindgap_diagnosis::verdict::Verdict;
    use mindgap_models::effects::CATALOGUE;
    use mindgap_models::effects::parameter::Setting;

    /// Returns robots with weak motors of these strengths, and `healthy` robots without.
    fn fleet(losses: &[f64], healthy: usize) -> Tally {
        let mut tally = Tally::new(CATALOGUE);
        let robot = |effects| Robot {
            measures: default_robot(),
            verdict: Verdict::Known,
            runs: 1,
            rows: 1,
            gap_nats: Some(1.0),
            closed: None,
            budget: vec![],
            effects,
            untestable: vec![],
        };
        for loss in losses {
            let weak = Candidate::named("motor_asymmetry", "command").expect("an effect").variant;
            let strength = Some((weak.id.into(), weak.settings(&[*loss], &default_robot())));
            let cause = Cause { id: "motor_asymmetry".into(), probability: 0.95, strength };
            tally.add("weak".into(), &robot(vec![cause]));
        }
        (0..healthy).for_each(|_| tally.add("healthy".into(), &robot(vec![])));
        tally
    }

    #[test]
    fn effect_shared_by_nearly_all_robots_is_common() {
        let alike = common(&fleet(&[0.1, 0.11, 0.12, 0.1, 0.09, 0.11, 0.1], 0));
        let [Common { effect, .. }] = alike.as_slice() else { panic!("{alike:?}") };
        assert_eq!((effect.effect.as_str(), effect.parameters["factor"]), ("motor_asymmetry", Setting::Number(0.9)));
        assert!(effect.resolve(&default_robot()).is_ok(), "a simulator takes it");
    }

    #[test]
    fn effect_that_varies_or_is_rare_is_not_common() {
        for (what, losses, healthy) in [
            ("one side or the other", [0.1, -0.1, 0.12, -0.11, 0.1, -0.09, -0.1].as_slice(), 0),
            ("five robots tell no interval", &[0.1, 0.11, 0.1, 0.12, 0.09], 0),
            ("a third has none", &[0.1, 0.11, 0.12, 0.1, 0.09, 0.11, 0.1, 0.1], 4),
        ] {
            assert_eq!(common(&fleet(losses, healthy)), [], "{what}");
        }
    }
}
