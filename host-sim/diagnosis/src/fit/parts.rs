//! Motion and sensor apart: where no effect changes both, their likelihoods multiply, and each is fitted by itself.

use super::{FitContext, Fitted};
use crate::scores::Scores;
use mindgap_foundations::channel::Channel;
use mindgap_models::effects::Candidate;

/// What an effect changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// The motion alone.
    Motion,
    /// The sensor alone.
    Sensor,
    /// Both, as all do that change where the robot is seen.
    Both,
}

impl Part {
    /// All of them.
    pub const ALL: [Part; 3] = [Part::Motion, Part::Sensor, Part::Both];

    /// Returns what an effect changes.
    pub fn of(candidate: &Candidate) -> Self {
        match (candidate.variant.moves(), candidate.variant.senses()) {
            (true, true) => Part::Both,
            (true, false) => Part::Motion,
            (false, _) => Part::Sensor,
        }
    }
}

impl Fitted {
    /// Changes the effects of one part, next to those of the other. An effect that changes both is fitted with all others.
    pub(super) fn changed(&self, part: Part, context: &FitContext, change: impl FnOnce(&Fitted) -> Fitted) -> Fitted {
        match self.split(part, &Fitted::null(context)) {
            Some([own, other]) => self.joined(part, &change(&own), &other),
            None => change(self),
        }
    }

    /// Splits effects into those of this part and the others; `None` where they cannot be fitted apart. `null` is the simulator
    /// as it is.
    pub fn split(&self, part: Part, null: &Fitted) -> Option<[Fitted; 2]> {
        let other = match part {
            Part::Motion => Part::Sensor,
            Part::Sensor => Part::Motion,
            Part::Both => return None,
        };
        let is_apart = self.hypothesis.candidates.iter().all(|c| Part::of(c) != Part::Both);
        is_apart.then(|| [self.only(part, null), self.only(other, null)])
    }

    /// Joins what became of one part with the other one. Effects that stay keep their order; new ones come last.
    pub fn joined(&self, part: Part, own: &Fitted, other: &Fitted) -> Fitted {
        let is_kept = |c: &&Candidate| own.position(c).or(other.position(c)).is_some();
        let kept = self.hypothesis.candidates.iter().filter(is_kept);
        let added = own.hypothesis.candidates.iter().filter(|c| self.position(c).is_none());
        let candidates = kept.chain(added).copied().collect();
        if part == Part::Sensor { assembled(candidates, other, own) } else { assembled(candidates, own, other) }
    }

    fn only(&self, part: Part, null: &Fitted) -> Fitted {
        let candidates = self.hypothesis.candidates.iter().copied().filter(|c| Part::of(c) == part).collect();
        if part == Part::Sensor { assembled(candidates, null, self) } else { assembled(candidates, self, null) }
    }

    fn position(&self, candidate: &Candidate) -> Option<usize> {
        self.hypothesis.candidates.iter().position(|c| c == candidate)
    }
}

/// Takes the effects of the motion from one fit and those of the sensor from another.
fn assembled(candidates: Vec<Candidate>, motion: &Fitted, sensor: &Fitted) -> Fitted {
    let fit_of = |candidate: &Candidate| if Part::of(candidate) == Part::Sensor { sensor } else { motion };
    let witnesses_of = |candidate: &Candidate| {
        let fit = fit_of(candidate);
        Some((&fit.witnesses, fit.position(candidate)?))
    };
    let witnesses = motion.witnesses.picked(candidates.iter().filter_map(witnesses_of));
    let numbers = |of: fn(&Fitted) -> &[f64]| -> Vec<f64> {
        let of_candidate = |candidate: &Candidate| {
            let fit = fit_of(candidate);
            let effect = fit.position(candidate);
            effect.map_or_else(Vec::new, |effect| of(fit)[fit.parameters_of(effect)].to_vec())
        };
        candidates.iter().flat_map(of_candidate).collect()
    };
    Fitted {
        values: numbers(|fit| &fit.values),
        errors: numbers(|fit| &fit.errors),
        hypothesis: motion.hypothesis.of(candidates),
        noise: motion.noise,
        witnesses,
        scores: with_sensor_of(&motion.scores, &sensor.scores),
        cross_validated: with_sensor_of(&motion.cross_validated, &sensor.cross_validated),
        complexity_penalties: [motion.complexity_penalties[0], sensor.complexity_penalties[1]],
    }
}

fn with_sensor_of(motion: &Scores, sensor: &Scores) -> Scores {
    Channel::SONAR.into_iter().fold(motion.clone(), |scores, channel| scores.with(channel, &sensor.of(channel)))
}
