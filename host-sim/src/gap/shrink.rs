//! How far the gap shrinks with the named effects, channel by channel, on runs that nothing was sought on.

use super::channel::Channel;
use super::explanation::Explanation;
use super::hypothesis::Terms;
use super::search::{Fitted, Given};
use crate::evaluation::observations::Observations;
use crate::statistics::bootstrap;

/// A gap in nats a step: how much likelier the logs could be.
#[derive(Clone, Debug)]
pub struct Shrink {
    /// All channels together.
    pub whole: Part,
    /// Each channel in which there is something to close.
    pub channels: Vec<(Channel, Part)>,
    /// The next best explanation and the share that it closes.
    pub runner_up: Option<(Vec<&'static str>, f64)>,
}

/// The gap of one channel, or of all.
#[derive(Clone, Debug)]
pub struct Part {
    /// With the simulator as it is.
    pub before: f64,
    /// With the effects added.
    pub after: f64,
    /// The share of the reducible gap that is closed.
    pub closed: f64,
    /// 95 % interval of that share, by bootstrap over runs.
    pub ci95: [f64; 2],
}

/// Nats by block: what the effects gained, and what remains that a learner of anything can gain beyond them.
struct Tally {
    gained: Vec<f64>,
    remaining: Vec<f64>,
}

/// A channel in which less than this can be gained is not told, nats.
const LEAST_NATS: f64 = 5.0;

/// None where the runs kept back show no reducible gap.
pub fn shrink(explanation: &Explanation, found: &Given, kept_back: &Observations) -> Option<Shrink> {
    let judged = |fit: &Fitted| fit.judged_on(kept_back, found);
    let none = judged(&explanation.none);
    let chosen = judged(&explanation.chosen);
    let remaining: Vec<Vec<f64>> = explanation
        .beyond_chosen
        .iter()
        .map(|left| {
            let learner = difference(&judged(&left.fitted), &chosen, kept_back, &Channel::ALL);
            let wider = left.wider_scatter(found, kept_back);
            learner.iter().zip(wider).map(|(l, w)| l + w).collect()
        })
        .collect();
    let tally = |channels: &[Channel]| {
        let of = explanation.beyond_chosen.iter().zip(&remaining).filter(|(l, _)| channels.contains(&l.channel));
        let mut sum = vec![0.0; kept_back.blocks];
        of.for_each(|(_, r)| sum.iter_mut().zip(r).for_each(|(s, r)| *s += r));
        Tally { gained: difference(&chosen, &none, kept_back, channels), remaining: sum }
    };
    let steps = kept_back.rows.len() as f64;
    let all = tally(&Channel::ALL);
    let whole = all.part(steps)?;
    let channels = Channel::ALL.into_iter().filter_map(|c| Some((c, tally(&[c]).told(steps)?))).collect();
    let runner_up = explanation.runner_up().map(|fit| {
        let gained: f64 = difference(&judged(fit), &none, kept_back, &Channel::ALL).iter().sum();
        (fit.ids(), gained / all.reducible())
    });
    Some(Shrink { whole, channels, runner_up })
}

impl Tally {
    fn reducible(&self) -> f64 {
        self.gained.iter().sum::<f64>() + self.remaining.iter().sum::<f64>().max(0.0)
    }

    fn told(&self, steps: f64) -> Option<Part> {
        self.part(steps).filter(|_| self.reducible() >= LEAST_NATS)
    }

    fn part(&self, steps: f64) -> Option<Part> {
        let (gained, reducible) = (self.gained.iter().sum::<f64>(), self.reducible());
        (reducible > 0.0).then(|| Part {
            before: reducible / steps,
            after: (reducible - gained) / steps,
            closed: gained / reducible,
            ci95: self.interval(),
        })
    }

    fn interval(&self) -> [f64; 2] {
        bootstrap::interval(&self.gained, &self.remaining, |gained, remaining| {
            let reducible = gained + remaining.max(0.0);
            (reducible > 0.0).then(|| gained / reducible)
        })
    }
}

/// By how much channels are likelier under `a` than under `b`, by block.
fn difference(a: &Terms, b: &Terms, evidence: &Observations, channels: &[Channel]) -> Vec<f64> {
    let mut sums = vec![0.0; evidence.blocks];
    for channel in channels {
        let gains: Vec<f64> = a.channel(*channel).iter().zip(b.channel(*channel)).map(|(a, b)| a - b).collect();
        sums.iter_mut().zip(evidence.by_block(&gains)).for_each(|(s, g)| *s += g);
    }
    sums
}
