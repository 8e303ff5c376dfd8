//! The budget of the gap: the shares of the named effects, of noise beyond the simulator's, and of structure that no named effect
//! explains.

use schemars::JsonSchema;
use serde::Serialize;

use super::gap_parts::GapParts;
use mindgap_foundations::statistics::{bootstrap, rounding};

/// A part of the gap.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Part {
    /// The id of an effect, `scatter` or `unexplained`.
    pub id: String,
    /// Its share of the gap. The shares of a budget add up to one.
    #[serde(serialize_with = "rounding::number")]
    pub share: f64,
    /// 95 % interval of the share, by bootstrap over blocks.
    #[serde(serialize_with = "rounding::interval")]
    pub ci95: [f64; 2],
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// The parts of a gap and its size.
#[derive(Clone, Debug, Default)]
pub struct Budget {
    /// The parts; none if there is nothing to divide.
    pub parts: Vec<Part>,
    /// Their sum, nats.
    pub nats: f64,
}

/// The id of noise beyond the simulator's.
pub const SCATTER: &str = "scatter";
/// The id of structure that no named effect explains.
pub const UNEXPLAINED: &str = "unexplained";

/// Divides a gap into the named effects in the order of its parts, noise, and the unexplained part, which includes effects that
/// are not named. Returns nothing if there is nothing to divide.
pub fn budget(named: &[&'static str], gap: &GapParts, seed: u64) -> Budget {
    let (mut parts, mut unexplained) = (Vec::new(), gap.unexplained.by_block());
    for (id, scores) in &gap.effects {
        let gained = scores.by_block();
        if named.contains(id) {
            parts.push((*id, gained));
        } else {
            unexplained.iter_mut().zip(gained).for_each(|(u, g)| *u += g);
        }
    }
    parts.push((SCATTER, gap.noise.by_block()));
    parts.push((UNEXPLAINED, unexplained));
    let parts: Vec<(&str, Vec<f64>)> = parts.into_iter().map(|(id, gained)| (id, zero_if_negative(gained))).collect();
    let mut whole = vec![0.0; parts[0].1.len()];
    for (_, part) in &parts {
        whole.iter_mut().zip(part).for_each(|(w, p)| *w += p);
    }
    let total: f64 = whole.iter().sum();
    if total <= 0.0 {
        return Budget::default();
    }
    let part = |(id, by_block): (&str, Vec<f64>)| {
        let others: Vec<f64> = whole.iter().zip(&by_block).map(|(w, p)| w - p).collect();
        let share = |own: f64, others: f64| (own + others > 0.0).then(|| (own / (own + others)).clamp(0.0, 1.0));
        let ci95 = bootstrap::interval(&by_block, &others, seed, share);
        Part { id: id.into(), share: by_block.iter().sum::<f64>() / total, ci95, sensor: None }
    };
    Budget { parts: parts.into_iter().map(part).collect(), nats: total }
}

/// Sets a part to zero that loses on the whole, as overlapping effects and models can that do not hold on other runs.
fn zero_if_negative(by_block: Vec<f64>) -> Vec<f64> {
    if by_block.iter().sum::<f64>() > 0.0 { by_block } else { vec![0.0; by_block.len()] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::block_scores;
    use mindgap_foundations::channel::Channel;

    fn gap(effects: &[(&'static str, [f64; 4])], noise: [f64; 4], unexplained: [f64; 4]) -> GapParts {
        let scores = |by_block: &[f64; 4]| block_scores(Channel::Forward, by_block);
        let effects = effects.iter().map(|(id, by_block)| (*id, scores(by_block))).collect();
        GapParts::made_up(effects, scores(&noise), scores(&unexplained))
    }

    fn shares(parts: &[Part]) -> Vec<(&str, f64)> {
        parts.iter().map(|part| (part.id.as_str(), part.share)).collect()
    }

    #[test]
    fn shares_are_proportional_to_nats() {
        let gap = gap(&[("slope", [3.0; 4]), ("latency", [4.0; 4])], [1.0; 4], [2.0; 4]);
        let both = budget(&["latency", "slope"], &gap, 1).parts;
        assert_eq!(shares(&both), [("slope", 0.3), ("latency", 0.4), (SCATTER, 0.1), (UNEXPLAINED, 0.2)]);
        // Every block has the same shares, and so has every resample of blocks.
        assert!(both.iter().all(|part| part.ci95.iter().all(|end| (end - part.share).abs() < 1e-12)));
        assert_eq!(shares(&budget(&["slope"], &gap, 1).parts), [("slope", 0.3), (SCATTER, 0.1), (UNEXPLAINED, 0.6)]);
        assert_eq!(shares(&budget(&[], &gap, 1).parts), [(SCATTER, 0.1), (UNEXPLAINED, 0.9)]);
    }

    #[test]
    fn part_that_loses_has_no_share() {
        let gap = gap(&[("slope", [3.0; 4])], [1.0; 4], [-2.0; 4]);
        assert_eq!(shares(&budget(&["slope"], &gap, 1).parts), [("slope", 0.75), (SCATTER, 0.25), (UNEXPLAINED, 0.0)]);
    }

    #[test]
    fn empty_gap_has_no_parts() {
        assert_eq!(budget(&[], &gap(&[], [0.0; 4], [-1.0; 4]), 1).parts, []);
    }

    /// Half of the blocks show only an effect and half only noise: resamples range from none to all.
    #[test]
    fn interval_is_that_of_resampled_blocks() {
        let gap = gap(&[("slope", [2.0, 0.0, 2.0, 0.0])], [0.0, 2.0, 0.0, 2.0], [0.0; 4]);
        let [low, high] = budget(&["slope"], &gap, 1).parts[0].ci95;
        assert_eq!([low, high], [0.0, 1.0]);
    }
}
