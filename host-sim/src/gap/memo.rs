//! What a fit has worked out at its last few points: it changes one parameter at a time, and most leave the motion, the sensor,
//! or the place of the sensor as it was.

use std::cell::RefCell;

use super::hypothesis::{Hypothesis, LogLikelihood};
use crate::effects::{SensorState, Variant};
use crate::evaluation::observations::Observations;
use crate::evaluation::predictions::{Faced, facing_in};
use crate::geometry::Pose;
use crate::simulator::baseline::Baseline;
use crate::sonar::Outcomes;

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
