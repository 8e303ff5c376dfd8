//! What the robot measures of its own motion, as further observations of a hypothesis: rotation counters see its drive up to the
//! rims, and a gyro sees its body but not its tracker.

use super::noise_model::{fitted_noise, log_density};
use super::sample::Sample;
use mindgap_foundations::motion::Motion;
use mindgap_learning::evaluation::observations::Observation;
use mindgap_models::effects::Candidate;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::witness::{OnCounters, on_counters, on_gyro};
use mindgap_models::simulator::baseline::MotionModel;

/// Where the effects of a hypothesis show, and the noise of the witnesses: what a fit leaves to be decided about them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Witnesses {
    /// Whether each candidate shows on rotation counters.
    on_counters: Vec<bool>,
    /// Whether each candidate shows on the gyro.
    on_gyro: Vec<bool>,
    /// Standard deviations of left and right counter (cm per step) and gyro (rad per step).
    noise: [f64; 3],
}

/// The effects of a hypothesis as far as the witnesses see them.
pub struct Seen {
    /// Up to the rims, by the rotation counters.
    pub rims: EffectChain,
    /// Up to the body, by the gyro.
    pub body: EffectChain,
}

/// The axes of motion whose outliers each witness has.
const AXES: [usize; 3] = [0, 0, 2];
/// Least noise of a witness, as a share of the largest step that it shows. The forms of effects and laws are right to a percent or
/// two of a step, and thresholds are calibrated for tracked steps, which scatter by about as much. Counters are six times as
/// exact: believed to a thousandth, they name side effects, such as the tyres' change of load with the track.
const LEAST_SHARE: f64 = 0.02;

/// Noise of a counter that is wider by this factor is no chance: something happens at the wheels that nothing predicts.
const MUCH: f64 = 2.0;

impl Witnesses {
    /// Returns where these candidates show, for those that may show on counters or not: that they do. The noise is not known yet.
    pub fn expected(candidates: &[Candidate]) -> Self {
        let shows = |candidate| on_counters(candidate) != OnCounters::Hidden;
        Witnesses {
            on_counters: candidates.iter().map(shows).collect(),
            on_gyro: candidates.iter().map(on_gyro).collect(),
            noise: [0.0; 3],
        }
    }

    /// Returns the candidates for which the rows can decide whether they show on counters.
    pub fn undecided(candidates: &[Candidate], sample: &Sample) -> Vec<usize> {
        let is_open = |candidate: &usize| on_counters(&candidates[*candidate]) == OnCounters::Either;
        if is_witnessed(sample) { (0..candidates.len()).filter(is_open).collect() } else { Vec::new() }
    }

    /// Returns the same with a candidate hidden from the counters.
    pub fn hidden(&self, candidate: usize) -> Self {
        let mut hidden = self.clone();
        hidden.on_counters[candidate] = false;
        hidden
    }

    /// Returns whether each candidate shows on rotation counters.
    pub fn on_counters(&self) -> &[bool] {
        &self.on_counters
    }

    /// Returns whether each candidate shows on the gyro.
    pub fn on_gyro(&self) -> &[bool] {
        &self.on_gyro
    }

    /// Returns the same with another answer for one of the candidates.
    pub fn reversed(&self, candidate: usize) -> Self {
        let mut reversed = self.clone();
        [&mut reversed.on_counters, &mut reversed.on_gyro].into_iter().for_each(|seen| seen[candidate] ^= true);
        reversed
    }

    /// Picks candidates of several hypotheses, each with its index there; the noise is that of this one.
    pub fn picked<'a>(&self, from: impl Iterator<Item = (&'a Self, usize)>) -> Self {
        let (on_counters, on_gyro) = from.map(|(of, index)| (of.on_counters[index], of.on_gyro[index])).unzip();
        Witnesses { on_counters, on_gyro, noise: self.noise }
    }

    /// Returns those of some of the candidates.
    pub fn of(&self, kept: &[usize]) -> Self {
        let kept = |seen: &[bool]| kept.iter().map(|candidate| seen[*candidate]).collect();
        Witnesses { on_counters: kept(&self.on_counters), on_gyro: kept(&self.on_gyro), noise: self.noise }
    }

    /// Returns the same with the noise of others.
    pub fn within(&self, others: &Self) -> Self {
        Witnesses { noise: others.noise, ..self.clone() }
    }

    /// Returns whether a counter shows much that the effects and the simulator do not.
    pub fn leave_much(&self, sample: &Sample) -> bool {
        let least = least_noise(sample);
        [0, 1].iter().any(|counter| self.noise[*counter] > MUCH * least[*counter])
    }

    /// Returns the same with noise fitted to these rows, and the score of each of them: left and right counter, gyro.
    pub fn fitted(self, seen: &Seen, sample: &Sample) -> (Self, Vec<[f64; 3]>) {
        let residuals = seen.residuals(&sample.rows, sample);
        let witnesses = Witnesses { noise: noise(&residuals, sample), ..self };
        let scores = densities(&sample.rows, &residuals, witnesses.noise);
        (witnesses, scores)
    }

    /// Returns the score of some rows: left and right counter, gyro.
    pub fn scores(&self, seen: &Seen, rows: &[Observation], sample: &Sample) -> Vec<[f64; 3]> {
        densities(rows, &seen.residuals(rows, sample), self.noise)
    }
}

impl Seen {
    /// Returns what the witnesses show beyond it: left and right counter (cm), gyro (rad per step).
    fn residuals(&self, rows: &[Observation], sample: &Sample) -> Vec<[Option<f64>; 3]> {
        let of_row = |row: &Observation| {
            let motion = sample.baseline.motion.as_ref();
            let [left, right] =
                motion.and_then(|motion| self.rolled(motion, row)).map_or([None; 2], |off| off.map(Some));
            [left, right, motion.and_then(|motion| self.turned(motion, row))]
        };
        rows.iter().map(of_row).collect()
    }

    /// The rims move as those of an ideal robot that rolls as its counters turn, so every effect can act on its motion.
    fn rolled(&self, motion: &MotionModel, row: &Observation) -> Option<[f64; 2]> {
        let counted_cm = row.wheels_cm.filter(|_| motion.knows_wheels())?;
        let track_cm = row.context.robot.track_cm;
        let rolled = self.rims.wrap(&row.context, |now, before| {
            let wheels_cm = motion.wheels_cm(now, before).unwrap_or_default();
            Motion::ZERO.arc().with_wheels(wheels_cm, track_cm).motion()
        });
        let rolled_cm = rolled.arc().wheels_cm(track_cm);
        Some([0, 1].map(|wheel| counted_cm[wheel] - rolled_cm[wheel]))
    }

    /// At a row the robot still turns as fast as at the end of the step before.
    fn turned(&self, motion: &MotionModel, row: &Observation) -> Option<f64> {
        let shown_rad = row.gyro_rad?;
        Some(shown_rad - self.body.begin(&row.context, |speeds| motion.step(speeds, speeds)).turn)
    }
}

/// Returns whether any witness was logged.
pub fn is_witnessed(sample: &Sample) -> bool {
    sample.rows.iter().any(|row| row.wheels_cm.is_some() || row.gyro_rad.is_some())
}

/// Returns the noise of the witnesses where nothing is different.
fn least_noise(sample: &Sample) -> [f64; 3] {
    let known_cm = sample.baseline.motion.as_ref().and_then(MotionModel::counter_scatter_cm).unwrap_or_default();
    let shown = |row: &Observation| [row.wheels_cm.map(|cm| cm[0]), row.wheels_cm.map(|cm| cm[1]), row.gyro_rad];
    let largest = |witness: usize| {
        sample.rows.iter().filter_map(|row| shown(row)[witness]).fold(0.0, |largest: f64, one| largest.max(one.abs()))
    };
    let known = [known_cm[0], known_cm[1], 0.0];
    [0, 1, 2].map(|witness| known[witness].max(LEAST_SHARE * largest(witness)).max(f64::MIN_POSITIVE))
}

fn noise(residuals: &[[Option<f64>; 3]], sample: &Sample) -> [f64; 3] {
    let least = least_noise(sample);
    [0, 1, 2].map(|witness| {
        let rows = sample.rows.iter().zip(residuals);
        let logged = rows.filter_map(|(row, r)| Some([r[witness]?, row.motion_weight[AXES[witness]]]));
        fitted_noise(AXES[witness], &logged.collect::<Vec<[f64; 2]>>(), least[witness])
    })
}

fn densities(rows: &[Observation], residuals: &[[Option<f64>; 3]], noise: [f64; 3]) -> Vec<[f64; 3]> {
    let of_row = |(row, residual): (&Observation, &[Option<f64>; 3])| {
        [0, 1, 2].map(|i| residual[i].map_or(0.0, |r| row.motion_weight[AXES[i]] * log_density(AXES[i], r, noise[i])))
    };
    rows.iter().zip(residuals).map(of_row).collect()
}

#[cfg(test)]
mod tests {
    use crate::diagnose::diagnose;
    use crate::diagnosis::Diagnosis;
    use crate::test_support::{alternating, baseline, driven};
    use crate::verdict::Verdict;
    use mindgap_foundations::channel::Channel;

    /// The diagnosis of an untracked robot whose left wheel turns by a share of what is commanded in a step.
    fn counted(share: impl Fn(usize) -> f64) -> Diagnosis {
        let mut logs = driven(12, 31, |run, at| {
            [((run * 7 + at * 13) % 9) as f64 * 20.0 - 80.0, ((run * 5 + at * 11) % 7) as f64 * 25.0 - 75.0]
        });
        let robot = logs.robot;
        let deg_per_command =
            robot.full_speed_cm_s * robot.step_ms / 1000.0 * 3.6 / (std::f64::consts::PI * robot.wheel_diameter_cm);
        for run in &mut logs.runs {
            let mut turned_deg = [0.0; 2];
            for at in 0..run.rows.len() {
                let [left, right] = run.rows.at(at).command();
                run.rows.edit(at, |row| {
                    (row.pose, row.echo_cm) = (None, None);
                    (row.rot_left_deg, row.rot_right_deg) = (Some(turned_deg[0]), Some(turned_deg[1]));
                });
                turned_deg[0] += share(at) * left * deg_per_command;
                turned_deg[1] += right * deg_per_command;
            }
        }
        diagnose(baseline(), &logs).expect("counters")
    }

    #[test]
    fn counters_of_an_untracked_robot_show_a_weak_motor() {
        let found = counted(|_| 0.8);
        let [weak] = found.effects.as_slice() else { panic!("{:?}", found.effects) };
        assert_eq!((weak.id, weak.witness.first()), ("motor_asymmetry", Some(&"rot_left_deg")));
        assert_eq!(found.scope.compared, [Channel::RotLeft, Channel::RotRight]);
        let closed = found.reduction.expect("a gap").whole.reducible_closed.expect("an effect");
        assert!(closed > 0.95, "{closed}");
    }

    #[test]
    fn counters_that_nothing_explains_are_a_gap() {
        assert_eq!(counted(|_| 1.0).verdict, Verdict::NoGap);
        assert_eq!(counted(|at| 1.0 + 0.3 * alternating(at / 2)).verdict, Verdict::Unknown);
    }
}
