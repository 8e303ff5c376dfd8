//! What a fit has worked out at its last few points: it changes one parameter at a time, and most leave the motion, the sensor,
//! or the place of the sensor as it was.

use std::cell::RefCell;

use super::hypothesis::{Hypothesis, LogLikelihood};
use mindgap_foundations::geometry::Pose;
use mindgap_learning::evaluation::observations::Observations;
use mindgap_learning::evaluation::predictions::{Faced, facing_in};
use mindgap_models::effects::{SensorState, Variant};
use mindgap_models::simulator::baseline::Baseline;
use mindgap_models::sonar::Outcomes;

/// What is known of a hypothesis on some rows.
pub struct Memo<'m, 'o> {
    observations: &'o Observations,
    /// What was known of the rows before.
    before: Option<&'m Sights<'o>>,
    motion: RefCell<Recent<Vec<f64>, Vec<[f64; 3]>>>,
    sonar: RefCell<Recent<Vec<f64>, Vec<[f64; 2]>>>,
    faced: Vec<RefCell<Sight<'o>>>,
}

/// What the sensor faced at each row.
pub struct Sights<'o>(Vec<Sight<'o>>);

type Sight<'o> = Recent<Look, Option<Faced<'o>>>;

/// On what it depends what the sensor faces: where the robot is, how the sensor is turned on it, and how wide its beam is.
type Look = (Pose, f64, f64);

/// The last few things that were asked for, by what they depend on, the latest first.
#[derive(Clone)]
struct Recent<K, V>(Vec<(K, V)>);

/// Where a climb is, and beside it for each of five parameters that move the sensor.
const MOST: usize = 6;

impl<'m, 'o> Memo<'m, 'o> {
    /// Nothing is known yet but what is faced with other hypotheses, if that.
    pub fn new(observations: &'o Observations, before: Option<&'m Sights<'o>>) -> Self {
        let faced = observations.rows.iter().map(|_| RefCell::default()).collect();
        Memo { observations, before, motion: RefCell::default(), sonar: RefCell::default(), faced }
    }

    /// What the sensor faced last at each row.
    pub fn into_sights(self) -> Sights<'o> {
        Sights(self.faced.into_iter().map(RefCell::into_inner).collect())
    }

    /// [`Hypothesis::log_likelihood`] of the rows; the hypothesis is the same at every call.
    pub fn log_likelihood(
        &self,
        hypothesis: &Hypothesis,
        baseline: &Baseline,
        values: &[f64],
        untouched: &LogLikelihood,
    ) -> LogLikelihood {
        let those = |is_touched: fn(&Variant) -> bool| hypothesis.values_of(values, is_touched);
        let motion = || {
            let work_out = || hypothesis.motion(baseline, &self.observations.rows, values);
            self.motion.borrow_mut().recall(those(Variant::moves), work_out).clone()
        };
        let sonar = || {
            let work_out = || {
                let rows = 0..self.observations.rows.len();
                hypothesis.sonar(baseline, self.observations, rows, values, |row, state| self.outcomes(row, state))
            };
            self.sonar.borrow_mut().recall(those(Variant::senses), work_out).clone()
        };
        LogLikelihood {
            motion: if hypothesis.moves() { motion() } else { untouched.motion.clone() },
            sonar: if hypothesis.senses() { sonar() } else { untouched.sonar.clone() },
        }
    }

    /// What the sensor may report at a row in a state.
    fn outcomes(&self, row: usize, state: &SensorState) -> Option<Outcomes> {
        let look = (state.robot, state.yaw_rad, state.perturbation.width);
        let perturbed = |faced: &Option<Faced>| Some(faced.as_ref()?.perturbed(&state.perturbation));
        if let Some(faced) = self.before.and_then(|before| before.0[row].known(&look)) {
            return perturbed(faced);
        }
        let face = || facing_in(self.observations, &self.observations.rows[row], state);
        perturbed(self.faced[row].borrow_mut().recall(look, face))
    }
}

impl<K, V> Default for Recent<K, V> {
    fn default() -> Self {
        Recent(Vec::new())
    }
}

impl<K: PartialEq, V> Recent<K, V> {
    fn known(&self, key: &K) -> Option<&V> {
        self.0.iter().find(|(known, _)| known == key).map(|(_, value)| value)
    }

    /// What belongs to a key, worked out if it is not known.
    fn recall(&mut self, key: K, work_out: impl FnOnce() -> V) -> &V {
        match self.0.iter().position(|(known, _)| *known == key) {
            Some(place) => self.0[..=place].rotate_right(1),
            None => {
                self.0.truncate(MOST - 1);
                self.0.insert(0, (key, work_out()));
            }
        }
        &self.0[0].1
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::*;
    use mindgap_models::effects::Candidate;

    fn hypothesis(baseline: &Baseline, variants: &[(&str, &str)]) -> Hypothesis {
        let candidates =
            variants.iter().map(|(effect, variant)| Candidate::named(effect, variant).expect("in the catalogue"));
        Hypothesis::none(baseline).of(candidates.collect())
    }

    /// A climb's way: beside a point by each parameter, on, back, and to what changes the sensor alone.
    #[test]
    fn what_is_recalled_is_what_would_be_worked_out() {
        let (baseline, rows) = (
            baseline_with_sonar(),
            observations(3, 8, |_, at| Made {
                off: [0.3, 0.1 * alternating(at), 0.0],
                echo_off_cm: (at > 0).then_some(0.5),
                ..Made::default()
            }),
        );
        let untouched = Hypothesis::none(&baseline).log_likelihood(&baseline, &rows, &[], None);
        let all =
            hypothesis(&baseline, &[("marker_offset", "rigid"), ("drive_scale", "distance"), ("sonar_yaw", "axis")]);
        let marker = hypothesis(&baseline, &[("marker_offset", "rigid")]);
        let before = Memo::new(&rows, None);
        before.log_likelihood(&marker, &baseline, &[1.0, -2.0], &untouched);
        let before = before.into_sights();
        for before in [None, Some(&before)] {
            let memo = Memo::new(&rows, before);
            let way = [
                [1.0, -2.0, 1.0, 0.0],
                [1.1, -2.0, 1.0, 0.0],
                [1.0, -2.1, 1.0, 0.0],
                [1.0, -2.0, 1.1, 0.0],
                [1.0, -2.0, 1.0, 0.1],
                [2.0, -3.0, 1.2, 0.2],
                [1.0, -2.0, 1.0, 0.0],
            ];
            for values in way {
                let recalled = memo.log_likelihood(&all, &baseline, &values, &untouched);
                let worked_out = all.log_likelihood(&baseline, &rows, &values, None);
                assert_eq!(recalled.motion, worked_out.motion, "{values:?}");
                assert_eq!(recalled.sonar, worked_out.sonar, "{values:?}");
            }
        }
        let recalled = Memo::new(&rows, None).log_likelihood(&hypothesis(&baseline, &[]), &baseline, &[], &untouched);
        assert_eq!(recalled.total(), untouched.total(), "what is not touched is taken over");
    }

    #[test]
    fn the_last_few_are_known() {
        let mut recent = Recent::default();
        let mut asked = Vec::new();
        let mut recall = |key: usize| {
            let mut is_new = false;
            let value = *recent.recall(key, || {
                is_new = true;
                10 * key
            });
            asked.push(is_new);
            value
        };
        let keys = [0, 1, 0, 2, 3, 4, 5, 0, 6, 1];
        assert_eq!(keys.map(&mut recall), keys.map(|key| 10 * key));
        // Of seven keys the one that was asked for longest ago is forgotten.
        assert_eq!(asked, [true, true, false, true, true, true, true, false, true, true]);
    }
}
