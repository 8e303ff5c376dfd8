//! From fits to an explanation: which effects together, what else could be in place of each, and what is left over.

use rayon::prelude::*;

use super::calibration::{Calibration, Gate};
use super::channel::Channel;
use super::generic;
use super::search::{Fitted, Gain, Given, best_of_each, extend};
use super::verdict::weight;
use crate::effects::applied::AppliedEffect;
use crate::evaluation::observations::Observations;

/// The effects that explain a gap best, if any does.
pub struct Explanation {
    /// The simulator as it is.
    pub none: Fitted,
    /// The effects together.
    pub chosen: Fitted,
    /// For each of the chosen effects the fits with another in its place, best first.
    pub rivals: Vec<Vec<Fitted>>,
    /// What anything could explain beyond no effect, by channel.
    pub beyond_none: Vec<Leftover>,
    /// What anything could explain beyond the chosen effects, by channel.
    pub beyond_chosen: Vec<Leftover>,
    /// What counts.
    pub calibration: Calibration,
}

/// The first signs of a gap, before any threshold.
pub struct Signs {
    /// What the best effect gains.
    pub effect: Gain,
    /// The most that the generic learner gains in a channel, or a wider scatter on top of it.
    pub learner: Gain,
    /// The rows that gain it.
    pub rows: usize,
}

/// What the generic learner explains in a channel.
pub struct Leftover {
    /// The channel.
    pub channel: Channel,
    /// The learner on top of the effects.
    pub fitted: Fitted,
    /// Its gain on each block, zero where it is not significant.
    pub by_block: Vec<f64>,
    /// Whether it follows circumstances in this channel.
    follows: bool,
    /// Whether the logs scatter more than the simulator in this channel.
    scatters: bool,
}

impl Leftover {
    /// The learner on top of a fit, with what it gains by block: nothing of it counts yet.
    fn before_any_gate(channel: Channel, fit: &Fitted, logs: &Given) -> (Self, Vec<f64>) {
        let fitted = fit.with(generic::form(channel), logs);
        let gains = fitted.gains_over(fit);
        let by_block = vec![0.0; gains.len()];
        (Leftover { channel, fitted, by_block, follows: true, scatters: true }, gains)
    }

    /// Whether the learner explains anything.
    pub fn counts(&self) -> bool {
        self.by_block.iter().any(|g| *g != 0.0)
    }

    /// By how much rows of a motion channel are likelier with the scatter of the logs than with the simulator's, by
    /// block.
    pub fn wider_scatter(&self, logs: &Given, rows: &Observations) -> Vec<f64> {
        let nothing = vec![0.0; rows.blocks];
        let (Some(axis), Some(drive)) = (self.channel.motion_axis(), &logs.baseline.motion) else { return nothing };
        let Fitted { hypothesis, values, .. } = &self.fitted;
        let own = hypothesis.scatter(logs.baseline, logs.evidence, values);
        if !self.scatters || own[axis] < LEAST_SCATTER_RATIO * drive.scatter()[axis] {
            return nothing;
        }
        let mut narrow = own;
        narrow[axis] = drive.scatter()[axis];
        let likelihood = |scatter: [f64; 3]| {
            let motion = hypothesis.motion_terms(logs.baseline, &rows.rows, values, scatter);
            rows.by_block(&motion.iter().map(|m| m[axis]).collect::<Vec<f64>>())
        };
        likelihood(own).iter().zip(likelihood(narrow)).map(|(a, b)| a - b).collect()
    }

    /// This if it gains something over the fit `beneath` on runs that it was not fitted on, and nothing otherwise.
    fn confirmed(self, beneath: &Fitted, found: &Given, kept_back: &Observations) -> Self {
        let followed =
            if self.follows { judged(&self.fitted, found, kept_back) - judged(beneath, found, kept_back) } else { 0.0 };
        let scattered: f64 = self.wider_scatter(found, kept_back).iter().sum();
        if followed + scattered >= LEAST_CONFIRMED_NATS {
            return self;
        }
        Leftover { by_block: vec![0.0; self.by_block.len()], follows: false, scatters: false, ..self }
    }
}

/// Where many others could stand for an effect it has to gain so many times what it has to otherwise.
const IF_VAGUE: f64 = 2.0;
/// Another effect could stand for one when its weight is this: it lags by two standard errors.
const IN_REACH: f64 = 0.12;
/// On the runs kept back the effects have to gain this many nats, and so has the learner.
const LEAST_CONFIRMED_NATS: f64 = 3.0;
/// A further effect on the same stage has to gain this share of what is explained already: less is within the reach of
/// a form that is not quite right.
const LEAST_SHARE: f64 = 0.08;
/// and so many standard errors.
const LEAST_Z_BESIDE: f64 = 3.5;
/// A further effect that more than so many others could stand for is no more than a form that is not quite right.
const MOST_RIVALS: usize = 3;
/// A fit is better than another from here on, nats.
const OF_NO_MATTER: f64 = 1.0;
/// The most effects that are named together.
const MOST_EFFECTS: usize = 3;
/// The effect that no reading follows.
const SCATTER: &str = "sonar_noise";
/// Scatter beyond the simulator's counts from this ratio on.
const LEAST_SCATTER_RATIO: f64 = 1.12;

impl Explanation {
    /// Searches forward, and backward after each step.
    pub fn find(logs: &Given) -> Self {
        let none = Fitted::none(logs);
        let alone = extend(&none, None, logs);
        let singles = best_of_each(alone.clone());
        let first =
            singles.first().filter(|f| gain_for_its_rivals(f, &singles, &none).passes(&logs.calibration.effect));
        let first = first.cloned();
        let mut chosen = first.unwrap_or_else(|| none.clone());
        let mut rivals = vec![singles];
        while !chosen.ids().is_empty() && chosen.ids().len() < MOST_EFFECTS {
            let further = best_of_each(extend(&chosen, Some(&alone), logs));
            let Some(next) = further.into_iter().find(|f| is_worth_adding(f, &chosen, &none, &logs.calibration.effect))
            else {
                break;
            };
            let settled = settled(next, &alone, logs);
            if settled.1.iter().any(|r| rivals_in_reach(&settled.0, r) > MOST_RIVALS) {
                break;
            }
            (chosen, rivals) = settled;
        }
        if let Some(others) = without_feigned_scatter(&chosen, logs) {
            rivals = in_place_of_each(&others, &alone, logs);
            chosen = others;
        }
        let beyond_none = leftovers(&none, logs);
        let beyond_chosen = leftovers(&chosen, logs);
        Explanation { none, chosen, rivals, beyond_none, beyond_chosen, calibration: logs.calibration }
    }
}

impl Explanation {
    /// Given effects, as they are.
    pub fn by(added: &[AppliedEffect], logs: &Given) -> Self {
        let none = Fitted::none(logs);
        let chosen = none.as_given(added, logs);
        let beyond_chosen = leftovers(&chosen, logs);
        let calibration = logs.calibration;
        Explanation { none, chosen, rivals: Vec::new(), beyond_none: Vec::new(), beyond_chosen, calibration }
    }

    /// What holds on runs that nothing was sought on: effects that gain nothing there explain nothing, and neither does
    /// the learner.
    pub fn confirmed(mut self, found: &Given, kept_back: &Observations) -> Self {
        let gained = judged(&self.chosen, found, kept_back) - judged(&self.none, found, kept_back);
        if !self.chosen.ids().is_empty() && gained < LEAST_CONFIRMED_NATS {
            self.chosen = self.none.clone();
            self.rivals = Vec::new();
            self.beyond_chosen = leftovers(&self.none, found);
        }
        let hold = |leftovers: Vec<Leftover>, beneath: &Fitted| {
            leftovers.into_iter().map(|l| l.confirmed(beneath, found, kept_back)).collect()
        };
        self.beyond_none = hold(self.beyond_none, &self.none);
        self.beyond_chosen = hold(self.beyond_chosen, &self.chosen);
        self
    }
}

impl Signs {
    /// The signs in logs.
    pub fn of(logs: &Given) -> Self {
        let none = Fitted::none(logs);
        let singles = best_of_each(extend(&none, None, logs));
        let effect = singles.first().map_or(Gain::NONE, |best| gain_for_its_rivals(best, &singles, &none));
        let of_channel = |channel: &Channel| {
            let (learner, gains) = Leftover::before_any_gate(*channel, &none, logs);
            [Gain::of(&gains), Gain::of(&learner.wider_scatter(logs, logs.evidence))]
        };
        let gains: Vec<[Gain; 2]> = Channel::ALL.par_iter().map(of_channel).collect();
        let most = gains.into_iter().flatten().max_by(|a, b| a.nats.total_cmp(&b.nats));
        Signs { effect, learner: most.unwrap_or(Gain::NONE), rows: logs.evidence.rows.len() }
    }
}

/// The log-likelihood of runs that a fit was not made on.
fn judged(fit: &Fitted, found: &Given, kept_back: &Observations) -> f64 {
    fit.judged_on(kept_back, found).total().iter().sum()
}

/// What a fit gains, less where many others could stand for it: a misfit of the simulator is a bit like many.
fn gain_for_its_rivals(fit: &Fitted, singles: &[Fitted], none: &Fitted) -> Gain {
    let Gain { nats, error } = fit.gain_over(none);
    let divisor = if rivals_in_reach(fit, singles) <= MOST_RIVALS { 1.0 } else { IF_VAGUE };
    Gain { nats: nats / divisor, error: error / divisor }
}

fn is_worth_adding(fit: &Fitted, so_far: &Fitted, none: &Fitted, gate: &Gate) -> bool {
    let gain = fit.gain_over(so_far);
    let least = LEAST_SHARE * so_far.gain_over(none).nats;
    let beside = Gate { nats: gate.nats.max(least), z: gate.z.max(LEAST_Z_BESIDE) };
    gain.passes(if fit.shares_a_stage() { &beside } else { gate })
}

/// How many effects do nearly as well in the place of one of the chosen.
fn rivals_in_reach(chosen: &Fitted, rivals: &[Fitted]) -> usize {
    rivals.iter().filter(|r| r.ids() != chosen.ids() && weight(chosen, r) >= IN_REACH).count()
}

/// One effect gives way to what does better in its place, if there is such. Returns what stands then, and for each of
/// its effects the fits with others in its place.
fn settled(chosen: Fitted, alone: &[Fitted], logs: &Given) -> (Fitted, Vec<Vec<Fitted>>) {
    let rivals = in_place_of_each(&chosen, alone, logs);
    let better = rivals.iter().flatten().max_by(|a, b| a.score().total_cmp(&b.score()));
    match better.filter(|f| f.score() > chosen.score() + OF_NO_MATTER && f.ids() != chosen.ids()) {
        Some(better) => (better.clone(), in_place_of_each(better, alone, logs)),
        None => (chosen, rivals),
    }
}

/// The other effects, where readings scatter more for no other reason than that something moves them.
fn without_feigned_scatter(chosen: &Fitted, logs: &Given) -> Option<Fitted> {
    let others = chosen.without(chosen.ids().iter().position(|id| *id == SCATTER)?, logs);
    let moved = others.with(&generic::MOVED_READINGS, logs);
    (moved.score() > chosen.score()).then_some(others)
}

/// For each effect the fits with it or another in its place, best first.
fn in_place_of_each(chosen: &Fitted, alone: &[Fitted], logs: &Given) -> Vec<Vec<Fitted>> {
    let places = 0..chosen.ids().len();
    places.map(|place| best_of_each(extend(&chosen.without(place, logs), Some(alone), logs))).collect()
}

/// What follows circumstances in each channel on top of a fit, or scatters more than the simulator.
fn leftovers(fit: &Fitted, logs: &Given) -> Vec<Leftover> {
    let gate = &logs.calibration.leftover;
    let of_channel = |channel: &Channel| {
        let (mut leftover, gains) = Leftover::before_any_gate(*channel, fit, logs);
        let wider = leftover.wider_scatter(logs, logs.evidence);
        leftover.follows = Gain::of(&gains).passes(gate);
        leftover.scatters = Gain::of(&wider).nats >= gate.nats;
        for (counts, gains) in [(leftover.follows, gains), (leftover.scatters, wider)] {
            if counts {
                leftover.by_block.iter_mut().zip(gains).for_each(|(sum, gain)| *sum += gain);
            }
        }
        leftover
    };
    Channel::ALL.par_iter().map(of_channel).collect()
}
