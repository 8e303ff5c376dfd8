//! Effects at work together, and how likely they make the logs.

use std::f64::consts::PI;
use std::ops::Range;

use super::baseline::{Baseline, Drive};
use super::channel::Channel;
use super::effect::{Act, Form, Moment, Motion, Sensor, Window};
use super::evidence::{Evidence, Row};
use crate::ascent::Bounds;
use crate::geometry::wrap_rad;
use crate::simulator::added::Added;
use crate::simulator::reference::sonar::{Change, Fan};

/// Effects that are supposed to be there, in the order in which they are applied; none is the simulator as it is.
#[derive(Clone)]
pub struct Hypothesis {
    /// What the simulator has already, with its parameters.
    given: Vec<(&'static Form, Vec<f64>)>,
    /// One form of each further effect.
    pub forms: Vec<&'static Form>,
}

/// Log-likelihoods by row and channel.
#[derive(Clone, Debug)]
pub struct Terms {
    /// Forward, lateral, turn.
    pub motion: Vec<[f64; 3]>,
    /// Echo rate, echo value.
    pub sonar: Vec<[f64; 2]>,
}

impl Terms {
    /// All channels of each row together.
    pub fn total(&self) -> Vec<f64> {
        let both = |(m, s): (&[f64; 3], &[f64; 2])| m.iter().sum::<f64>() + s.iter().sum::<f64>();
        self.motion.iter().zip(&self.sonar).map(both).collect()
    }

    /// One channel of each row.
    pub fn channel(&self, channel: Channel) -> Vec<f64> {
        match channel {
            Channel::Forward => self.motion.iter().map(|m| m[0]).collect(),
            Channel::Lateral => self.motion.iter().map(|m| m[1]).collect(),
            Channel::Turn => self.motion.iter().map(|m| m[2]).collect(),
            Channel::EchoRate => self.sonar.iter().map(|s| s[0]).collect(),
            Channel::EchoValue => self.sonar.iter().map(|s| s[1]).collect(),
        }
    }
}

/// A step that is so much wider than usual counts as a jump of the tracker.
const JUMP: f64 = 8.0;
/// How often the tracker jumps, at most.
const JUMPS: f64 = 0.01;

impl Hypothesis {
    /// The simulator as it is.
    pub fn none(baseline: &Baseline) -> Self {
        Self::given(&baseline.added)
    }

    /// What was added to a simulator; whatever cannot be is left out.
    pub fn given(added: &[Added]) -> Self {
        let given = added.iter().filter_map(|a| Some((a.form()?, a.values.clone()))).collect();
        Hypothesis { given, forms: Vec::new() }
    }

    /// The same simulator with these effects.
    pub fn of(&self, forms: Vec<&'static Form>) -> Self {
        Hypothesis { given: self.given.clone(), forms }
    }

    /// Whether what the simulator has already changes the sensor.
    pub fn given_senses(&self) -> bool {
        self.given.iter().any(|(form, _)| form.senses())
    }

    /// This and one more.
    pub fn with(&self, form: &'static Form) -> Self {
        self.of(self.forms.iter().copied().chain([form]).collect())
    }

    /// Bounds of all parameters.
    pub fn bounds(&self) -> Vec<Bounds> {
        self.forms.iter().flat_map(|f| f.parameters.iter().map(|p| p.bounds)).collect()
    }

    /// The log-likelihood of every row at `values`; what the hypothesis does not touch is taken from `untouched`.
    pub fn terms(&self, baseline: &Baseline, evidence: &Evidence, values: &[f64], untouched: Option<&Terms>) -> Terms {
        let kept = |touched: bool| untouched.filter(|_| !touched);
        let motion = || {
            let scatter = self.scatter(baseline, evidence, values);
            self.motion_terms(baseline, &evidence.rows, values, scatter)
        };
        let sonar = || self.sonar_terms(baseline, evidence, 0..evidence.rows.len(), values);
        Terms {
            motion: kept(self.moves()).map_or_else(motion, |t| t.motion.clone()),
            sonar: kept(self.senses()).map_or_else(sonar, |t| t.sonar.clone()),
        }
    }

    /// The same of rows that the hypothesis was not fitted on, with the scatter of those that it was fitted on.
    pub fn terms_of_others(&self, baseline: &Baseline, others: &Evidence, values: &[f64], scatter: [f64; 3]) -> Terms {
        Terms {
            motion: self.motion_terms(baseline, &others.rows, values, scatter),
            sonar: self.sonar_terms(baseline, others, 0..others.rows.len(), values),
        }
    }

    /// The log-likelihood of one block, with the scatter of all.
    pub fn of_block(
        &self,
        baseline: &Baseline,
        evidence: &Evidence,
        block: usize,
        values: &[f64],
        scatter: [f64; 3],
        untouched: &Terms,
    ) -> f64 {
        let range = evidence.of_block(block);
        let motion: f64 = if self.moves() {
            self.motion_terms(baseline, &evidence.rows[range.clone()], values, scatter).as_flattened().iter().sum()
        } else {
            untouched.motion[range.clone()].as_flattened().iter().sum()
        };
        let sonar: f64 = if self.senses() {
            self.sonar_terms(baseline, evidence, range, values).as_flattened().iter().sum()
        } else {
            untouched.sonar[range].as_flattened().iter().sum()
        };
        motion + sonar
    }

    /// A nuisance of every hypothesis: the scatter may be larger than the simulator's, never smaller.
    pub fn scatter(&self, baseline: &Baseline, evidence: &Evidence, values: &[f64]) -> [f64; 3] {
        baseline
            .motion
            .as_ref()
            .map_or([1.0; 3], |drive| refitted(&self.residuals(drive, &evidence.rows, values), drive.scatter()))
    }

    fn moves(&self) -> bool {
        self.forms.iter().any(|f| f.moves())
    }

    fn senses(&self) -> bool {
        self.forms.iter().any(|f| f.senses())
    }

    /// What a step does.
    pub fn motion(&self, drive: &Drive, moment: &Moment, values: &[f64]) -> Motion {
        self.wrap(moment, values, |now, before| drive.step(now, before))
    }

    /// What becomes of a step that follows the commands now and before.
    pub fn wrap(&self, moment: &Moment, values: &[f64], step: impl FnOnce([f64; 2], [f64; 2]) -> Motion) -> Motion {
        let mut commands: Window = moment.commands;
        self.each(values, |act, v| {
            if let Act::Commands(change) = act {
                change(v, moment, &mut commands);
            }
        });
        let mut motion = step(commands[0], commands[1]);
        self.each(values, |act, v| {
            if let Act::Motion(change) = act {
                change(v, moment, &mut motion);
            }
        });
        motion
    }

    /// What the sensor is like at a row.
    pub fn sensor(&self, moment: &Moment, values: &[f64]) -> Sensor {
        let mut sensor = Sensor { robot: moment.pose, yaw_rad: 0.0, width: 1.0, change: Change::NONE };
        self.each(values, |act, v| {
            if let Act::Sensor(change) = act {
                change(v, moment, &mut sensor);
            }
        });
        sensor
    }

    /// What the sensor faces at a row, and how its readings are changed.
    pub fn facing(&self, evidence: &Evidence, row: &Row, values: &[f64]) -> (Fan, Change) {
        let Sensor { robot, yaw_rad, width, change } = self.sensor(&row.moment, values);
        let moved = robot != row.moment.pose || yaw_rad != 0.0 || width != 1.0;
        (if moved { evidence.fan(&robot, yaw_rad, width) } else { row.fan }, change)
    }

    /// What a row's step does, or those that are judged as one.
    pub fn predicted(&self, drive: &Drive, row: &Row, values: &[f64]) -> Motion {
        let usual = [row.moment.commands[0], row.moment.commands[1]];
        let first = self.wrap(&row.moment, values, |now, before| match row.expected {
            Some(expected) if usual == [now, before] => expected,
            _ => drive.step(now, before),
        });
        if row.then.is_empty() {
            return first;
        }
        let start = &row.moment.pose;
        let end = row.then.iter().fold(first.from(start), |pose, moment| {
            self.motion(drive, &Moment { pose, ..*moment }, values).from(&pose)
        });
        Motion::between(start, &end)
    }

    /// Logged minus predicted, a step: forward (cm), lateral (cm), turn (rad).
    pub fn residuals(&self, drive: &Drive, rows: &[Row], values: &[f64]) -> Vec<Option<[f64; 3]>> {
        let residual = |row: &Row| {
            let logged = row.motion?;
            let predicted = self.predicted(drive, row, values);
            let off = [
                logged.forward_cm - predicted.forward_cm,
                logged.lateral_cm - predicted.lateral_cm,
                wrap_rad(logged.turn_rad - predicted.turn_rad),
            ];
            // What scatters adds up over steps that are judged as one.
            let steps = (1 + row.then.len()) as f64;
            Some(off.map(|off| off / steps.sqrt()))
        };
        rows.iter().map(residual).collect()
    }

    /// The log-likelihoods of the motion channels with a given scatter.
    pub fn motion_terms(&self, baseline: &Baseline, rows: &[Row], values: &[f64], scatter: [f64; 3]) -> Vec<[f64; 3]> {
        let Some(drive) = &baseline.motion else { return vec![[0.0; 3]; rows.len()] };
        let residuals = self.residuals(drive, rows, values);
        let densities = |r: [f64; 3]| [0, 1, 2].map(|c| log_density(r[c], scatter[c]));
        residuals.into_iter().map(|r| r.map_or([0.0; 3], densities)).collect()
    }

    fn sonar_terms(
        &self,
        baseline: &Baseline,
        evidence: &Evidence,
        rows: Range<usize>,
        values: &[f64],
    ) -> Vec<[f64; 2]> {
        let Some(sonar) = &baseline.sonar else { return vec![[0.0; 2]; rows.len()] };
        let term = |row: &Row| {
            let (fan, change) = self.facing(evidence, row, values);
            let [all, rate] = sonar.log_likelihood(&fan, &change, row.echo_cm, row.previous_echo_cm);
            [rate, all - rate]
        };
        evidence.rows[rows].iter().map(term).collect()
    }

    fn each(&self, values: &[f64], mut visit: impl FnMut(&Act, &[f64])) {
        for (form, own) in &self.given {
            form.acts.iter().for_each(|act| visit(act, own));
        }
        let mut rest = values;
        for form in &self.forms {
            let (own, others) = rest.split_at(form.parameters.len());
            form.acts.iter().for_each(|act| visit(act, own));
            rest = others;
        }
    }
}

fn refitted(residuals: &[Option<[f64; 3]>], least: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|c| {
        let bound = 4.0 * least[c];
        let squares = residuals.iter().flatten().map(|r| r[c].clamp(-bound, bound)).map(|r| r * r);
        let (sum, n) = squares.fold((0.0, 0.0), |(sum, n), s| (sum + s, n + 1.0));
        if n > 0.0 { f64::max(least[c], f64::sqrt(sum / n)) } else { least[c] }
    })
}

fn log_density(residual: f64, scatter: f64) -> f64 {
    let t = residual / scatter;
    let normal = |t: f64| libm::exp(-0.5 * t * t) / (2.0 * PI).sqrt();
    libm::log((1.0 - JUMPS) * normal(t) + JUMPS * normal(t / JUMP) / JUMP) - libm::log(scatter)
}
