//! Cache of a fit's latest evaluations. A fit changes one parameter at a time, and most parameters leave the motion, the sensor,
//! or the pose of the sensor unchanged.

use std::cell::RefCell;

use super::hypothesis::Hypothesis;
use super::sample::Sample;
use super::scores::Scores;
use mindgap_foundations::geometry::Pose;
use mindgap_learning::evaluation::predictions::{Faced, facing_in};
use mindgap_models::effects::{SensorState, Variant};
use mindgap_models::sonar::Outcomes;

/// Cached evaluations of one hypothesis on a sample.
pub struct SensorCache<'c, 's> {
    sample: &'s Sample<'s>,
    /// What the sensor faced in an earlier fit to the same rows.
    earlier: Option<&'c FacedRows<'s>>,
    motion: RefCell<Recent<Vec<f64>, Moved>>,
    sonar: RefCell<Recent<Vec<f64>, Vec<[f64; 2]>>>,
    faced: Vec<RefCell<FacedRow<'s>>>,
}

/// What the sensor faced at each row.
pub struct FacedRows<'s>(Vec<FacedRow<'s>>);

/// Scores of the motion and of its witnesses.
type Moved = [Vec<[f64; 3]>; 2];

type FacedRow<'s> = Recent<SensorPose, Option<Faced<'s>>>;

/// All that decides what the sensor faces: the robot's pose, the sensor's yaw on it, and the width of its beam.
type SensorPose = (Pose, f64, f64);

/// The latest evaluations with their arguments.
#[derive(Clone)]
struct Recent<K, V> {
    entries: Vec<Entry<K, V>>,
    /// Counts uses.
    now: u64,
}

#[derive(Clone)]
struct Entry<K, V> {
    key: K,
    value: V,
    used: u64,
}

/// A point of a fit, and one shifted point for each of five parameters that move the sensor.
const CAPACITY: usize = 6;

impl<'c, 's> SensorCache<'c, 's> {
    /// Creates a cache, empty except for what the sensor faced in an earlier fit.
    pub fn new(sample: &'s Sample<'s>, earlier: Option<&'c FacedRows<'s>>) -> Self {
        let faced = sample.rows.iter().map(|_| RefCell::default()).collect();
        SensorCache { sample, earlier, motion: RefCell::default(), sonar: RefCell::default(), faced }
    }

    /// Returns what the sensor faced at each row.
    pub fn into_faced(self) -> FacedRows<'s> {
        FacedRows(self.faced.into_iter().map(RefCell::into_inner).collect())
    }

    /// Returns [`Hypothesis::scores_over`]. The hypothesis has to be the same at every call.
    pub fn scores(&self, hypothesis: &Hypothesis, values: &[f64], untouched: &Scores) -> Scores {
        let values_of = |is_touched: fn(&Variant) -> bool| hypothesis.values_of(values, is_touched);
        let mut scores = untouched.clone();
        if hypothesis.moves() {
            let evaluate = || [hypothesis.motion(self.sample, values), hypothesis.witnesses(self.sample, values).1];
            let mut recent = self.motion.borrow_mut();
            let [motion, witnesses] = recent.get(values_of(Variant::moves), evaluate);
            scores = scores.with_motion(motion).with_witnesses(witnesses);
        }
        if hypothesis.senses() {
            let rows = 0..self.sample.rows.len();
            let evaluate = || hypothesis.sonar(self.sample, rows, values, |row, state| self.outcomes(row, state));
            scores = scores.with_sonar(self.sonar.borrow_mut().get(values_of(Variant::senses), evaluate));
        }
        scores
    }

    /// Returns the distribution of the reading at a row in a state.
    fn outcomes(&self, row: usize, state: &SensorState) -> Option<Outcomes> {
        let pose = (state.robot, state.yaw_rad, state.perturbation.width);
        let perturbed = |faced: &Option<Faced>| Some(faced.as_ref()?.perturbed(&state.perturbation));
        if let Some(faced) = self.earlier.and_then(|earlier| earlier.0[row].known(&pose)) {
            return perturbed(faced);
        }
        let face = || facing_in(self.sample, &self.sample.rows[row], state);
        perturbed(self.faced[row].borrow_mut().get(pose, face))
    }
}

impl<K, V> Default for Recent<K, V> {
    fn default() -> Self {
        Recent { entries: Vec::new(), now: 0 }
    }
}

impl<K: PartialEq, V> Recent<K, V> {
    fn known(&self, key: &K) -> Option<&V> {
        self.entries.iter().find(|entry| entry.key == *key).map(|entry| &entry.value)
    }

    /// Returns the value of a key, which is evaluated unless it is cached. Entries are large, so they stay where they are.
    fn get(&mut self, key: K, evaluate: impl FnOnce() -> V) -> &V {
        self.now += 1;
        let used = self.now;
        let known = self.entries.iter().position(|entry| entry.key == key);
        let index = known.unwrap_or_else(|| {
            let entry = Entry { key, value: evaluate(), used };
            let oldest = (0..self.entries.len()).min_by_key(|i| self.entries[*i].used);
            match oldest.filter(|_| self.entries.len() == CAPACITY) {
                Some(oldest) => {
                    self.entries[oldest] = entry;
                    oldest
                }
                None => {
                    self.entries.push(entry);
                    self.entries.len() - 1
                }
            }
        });
        self.entries[index].used = used;
        &self.entries[index].value
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::*;
    use mindgap_models::effects::Candidate;
    use mindgap_models::simulator::baseline::Baseline;

    fn hypothesis(baseline: &Baseline, variants: &[(&str, &str)]) -> Hypothesis {
        let candidates =
            variants.iter().map(|(effect, variant)| Candidate::named(effect, variant).expect("in the catalogue"));
        Hypothesis::null(baseline).of(candidates.collect())
    }

    /// The points of a fit: shifted by each parameter, moved on, moved back, and changed in the sensor alone.
    #[test]
    fn cached_scores_equal_evaluated_ones() {
        let baseline = baseline_with_sonar();
        let rows = identification(
            &baseline,
            observations(3, 8, |_, at| Made {
                off: [0.3, 0.1 * alternating(at), 0.0],
                echo_off_cm: (at > 0).then_some(0.5),
                ..Made::default()
            }),
        );
        let untouched = Hypothesis::null(&baseline).scores(&rows, &[]);
        let all =
            hypothesis(&baseline, &[("marker_offset", "rigid"), ("drive_scale", "distance"), ("sonar_yaw", "axis")]);
        let marker = hypothesis(&baseline, &[("marker_offset", "rigid")]);
        let earlier = SensorCache::new(&rows, None);
        earlier.scores(&marker, &[1.0, -2.0], &untouched);
        let earlier = earlier.into_faced();
        for earlier in [None, Some(&earlier)] {
            let cache = SensorCache::new(&rows, earlier);
            let points = [
                [1.0, -2.0, 1.0, 0.0],
                [1.1, -2.0, 1.0, 0.0],
                [1.0, -2.1, 1.0, 0.0],
                [1.0, -2.0, 1.1, 0.0],
                [1.0, -2.0, 1.0, 0.1],
                [2.0, -3.0, 1.2, 0.2],
                [1.0, -2.0, 1.0, 0.0],
            ];
            for values in points {
                assert_eq!(cache.scores(&all, &values, &untouched), all.scores(&rows, &values), "{values:?}");
            }
        }
        let cached = SensorCache::new(&rows, None).scores(&hypothesis(&baseline, &[]), &[], &untouched);
        assert_eq!(cached, untouched, "untouched channels are copied");
    }

    #[test]
    fn least_recently_used_key_is_forgotten() {
        let mut recent = Recent::default();
        let mut evaluated = Vec::new();
        let mut get = |key: usize| {
            let mut is_new = false;
            let value = *recent.get(key, || {
                is_new = true;
                10 * key
            });
            evaluated.push(is_new);
            value
        };
        let keys = [0, 1, 0, 2, 3, 4, 5, 0, 6, 1];
        assert_eq!(keys.map(&mut get), keys.map(|key| 10 * key));
        // Of seven keys the second was used longest ago.
        assert_eq!(evaluated, [true, true, false, true, true, true, true, false, true, true]);
    }
}
