//! What is common to all robots of a fleet, and therefore the simulator's fault rather than theirs.

use serde::Serialize;

use super::frequency::{Frequency, frequencies};
use super::spread::Spread;
use super::tally::Tally;
use crate::effects::applied::AppliedEffect;
use crate::effects::{Candidate, Parameter};
use crate::statistics::rounding::three_digits;

/// So large a share of the robots is nearly all of them,
const NEARLY_ALL: f64 = 0.9;
/// and more than half is certain to 95 %.
const AT_LEAST: f64 = 0.5;
/// A strength is the same in all robots where it scatters over them by so much of itself at most: then the ends of its 95 %
/// are of one sign.
const SCATTERS: f64 = 0.5;
/// Or by so much of what would be a large change of the parameter: of a direction, what it itself is means nothing.
const OF_LARGE: f64 = 0.1;

/// An effect that nearly all robots have in the same strength.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Common {
    /// It, as a simulator takes it: with the medians over the robots.
    pub effect: AppliedEffect,
    /// By which test.
    pub because: String,
}

/// What is the simulator's fault.
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
        effect: AppliedEffect::new(&Candidate { effect: frequency.id, variant }, &medians),
        because: format!(
            "{} of {} robots whose logs could show it have it, as {form} {} of them; 95 % interval of the median {}: {} \
             to {}, which leaves out {}, where nothing would change; and it scatters little between robots",
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
    use std::collections::BTreeMap;

    use super::*;
    use crate::effects::CATALOGUE;
    use crate::fleet::robot::{Cause, Robot};
    use crate::gap::verdict::Verdict;

    /// Robots with a weak motor of these strengths, and so many without.
    fn fleet(losses: &[f64], healthy: usize) -> Tally {
        let mut tally = Tally::new(CATALOGUE);
        let robot = |effects| Robot {
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
            let strength = Some(("command".into(), BTreeMap::from([("loss".into(), *loss)])));
            let cause = Cause { id: "motor_asymmetry".into(), probability: 0.95, strength };
            tally.add("weak".into(), &robot(vec![cause]));
        }
        (0..healthy).for_each(|_| tally.add("healthy".into(), &robot(vec![])));
        tally
    }

    #[test]
    fn what_nearly_all_robots_have_alike_is_the_simulators_fault() {
        let alike = common(&fleet(&[0.1, 0.11, 0.12, 0.1, 0.09, 0.11, 0.1], 0));
        let [Common { effect, .. }] = alike.as_slice() else { panic!("{alike:?}") };
        assert_eq!((effect.effect.as_str(), effect.parameters["loss"]), ("motor_asymmetry", 0.1));
        assert!(effect.resolve().is_ok(), "a simulator takes it");
    }

    #[test]
    fn what_differs_between_robots_or_is_seen_in_few_is_not() {
        for (what, losses, healthy) in [
            ("one side or the other", [0.1, -0.1, 0.12, -0.11, 0.1, -0.09, -0.1].as_slice(), 0),
            ("five robots tell no interval", &[0.1, 0.11, 0.1, 0.12, 0.09], 0),
            ("a third has none", &[0.1, 0.11, 0.12, 0.1, 0.09, 0.11, 0.1, 0.1], 4),
        ] {
            assert_eq!(common(&fleet(losses, healthy)), [], "{what}");
        }
    }
}
