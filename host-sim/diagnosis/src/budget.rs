//! The budget of the gap: how it divides among the named effects, scatter beyond what the simulator assumes, and what
//! follows circumstances that no named effect does.

use serde::Serialize;

use super::channel::Channel;
use super::ledger::Ledger;
use mindgap_foundations::statistics::{bootstrap, rounding};

/// A part of the gap.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// The id of an effect, [`SCATTER`] or [`UNEXPLAINED`].
    pub id: String,
    /// Its share of the gap; the shares of a budget add up to one.
    #[serde(serialize_with = "rounding::number")]
    pub share: f64,
    /// 95 % interval of that, by bootstrap over blocks of runs.
    #[serde(serialize_with = "rounding::interval")]
    pub ci95: [f64; 2],
}

/// The id of scatter beyond what the simulator assumes.
pub const SCATTER: &str = "scatter";
/// The id of what follows circumstances that no named effect does.
pub const UNEXPLAINED: &str = "unexplained";

/// The parts of a gap: the named effects in the order of the ledger, scatter, and what is unexplained, to which effects
/// belong that are not named. Empty where there is nothing to divide.
pub fn budget(named: &[&'static str], ledger: &Ledger, seed: u64) -> Vec<Part> {
    let (mut parts, mut unexplained) = (Vec::new(), ledger.unexplained.of(&Channel::ALL));
    for (id, entry) in &ledger.effects {
        let gained = entry.of(&Channel::ALL);
        if named.contains(id) {
            parts.push((*id, gained));
        } else {
            unexplained.iter_mut().zip(gained).for_each(|(u, g)| *u += g);
        }
    }
    parts.push((SCATTER, ledger.scatter.of(&Channel::ALL)));
    parts.push((UNEXPLAINED, unexplained));
    let parts: Vec<(&str, Vec<f64>)> = parts.into_iter().map(|(id, gained)| (id, at_least_nothing(gained))).collect();
    let mut whole = vec![0.0; parts[0].1.len()];
    for (_, part) in &parts {
        whole.iter_mut().zip(part).for_each(|(w, p)| *w += p);
    }
    let total: f64 = whole.iter().sum();
    if total <= 0.0 {
        return Vec::new();
    }
    let part = |(id, by_block): (&str, Vec<f64>)| {
        let others: Vec<f64> = whole.iter().zip(&by_block).map(|(w, p)| w - p).collect();
        let share = |own: f64, others: f64| (own + others > 0.0).then(|| (own / (own + others)).clamp(0.0, 1.0));
        let ci95 = bootstrap::interval(&by_block, &others, seed, share);
        Part { id: id.into(), share: by_block.iter().sum::<f64>() / total, ci95 }
    };
    parts.into_iter().map(part).collect()
}

/// A part that loses on the whole is none: effects that overlap, or a model that does not hold on other runs.
fn at_least_nothing(by_block: Vec<f64>) -> Vec<f64> {
    if by_block.iter().sum::<f64>() > 0.0 { by_block } else { vec![0.0; by_block.len()] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::Entry;

    fn ledger(effects: &[(&'static str, [f64; 4])], scatter: [f64; 4], unexplained: [f64; 4]) -> Ledger {
        let entry = |by_block: &[f64; 4]| Entry::of_channel(Channel::Forward, by_block.to_vec());
        let effects = effects.iter().map(|(id, by_block)| (*id, entry(by_block))).collect();
        Ledger::made_up(effects, entry(&scatter), entry(&unexplained))
    }

    fn shares(parts: &[Part]) -> Vec<(&str, f64)> {
        parts.iter().map(|part| (part.id.as_str(), part.share)).collect()
    }

    #[test]
    fn the_shares_are_those_of_the_nats() {
        let ledger = ledger(&[("slope", [3.0; 4]), ("latency", [4.0; 4])], [1.0; 4], [2.0; 4]);
        let both = budget(&["latency", "slope"], &ledger, 1);
        assert_eq!(shares(&both), [("slope", 0.3), ("latency", 0.4), (SCATTER, 0.1), (UNEXPLAINED, 0.2)]);
        // Every block has the same shares: so has every draw of blocks.
        assert!(both.iter().all(|part| part.ci95.iter().all(|end| (end - part.share).abs() < 1e-12)));
        assert_eq!(shares(&budget(&["slope"], &ledger, 1)), [("slope", 0.3), (SCATTER, 0.1), (UNEXPLAINED, 0.6)]);
        assert_eq!(shares(&budget(&[], &ledger, 1)), [(SCATTER, 0.1), (UNEXPLAINED, 0.9)]);
    }

    #[test]
    fn what_loses_takes_no_share() {
        let ledger = ledger(&[("slope", [3.0; 4])], [1.0; 4], [-2.0; 4]);
        assert_eq!(shares(&budget(&["slope"], &ledger, 1)), [("slope", 0.75), (SCATTER, 0.25), (UNEXPLAINED, 0.0)]);
    }

    #[test]
    fn nothing_is_divided_into_nothing() {
        assert_eq!(budget(&[], &ledger(&[], [0.0; 4], [-1.0; 4]), 1), []);
    }

    /// Half of the blocks show an effect alone and half scatter alone: drawn blocks say so between none and all.
    #[test]
    fn the_interval_is_that_of_drawn_blocks() {
        let ledger = ledger(&[("slope", [2.0, 0.0, 2.0, 0.0])], [0.0, 2.0, 0.0, 2.0], [0.0; 4]);
        let [low, high] = budget(&["slope"], &ledger, 1)[0].ci95;
        assert_eq!([low, high], [0.0, 1.0]);
    }
}
