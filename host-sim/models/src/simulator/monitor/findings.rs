//! What a monitor makes of logs.

use mindgap_core::monitor::{Alternative, LARGER, Monitor, NAT_BITS, Outcome};
use schemars::JsonSchema;
use serde::Serialize;

use super::directions::NAMED;
use super::replay::Replay;
use super::{FALSE_ALARMS, LIFETIME_STEPS};
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::Logs;

/// Results of `mindgap monitor`.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Findings {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// Evidence at which the monitor raises an alarm, nats.
    pub threshold_nats: f64,
    /// Bound on the probability that an unchanged robot raises an alarm in `lifetime_steps` steps.
    pub false_alarm_bound: f64,
    /// Steps for which that bound is stated.
    pub lifetime_steps: u32,
    /// Number of steps.
    pub steps: usize,
    /// Number of steps that added no evidence: the robot was not tracked, or absurdly.
    pub paused: usize,
    /// The first alarm; null if there was none.
    pub alarm: Option<AlarmFound>,
    /// Evidence of each alternative after the last step, the strongest first.
    pub evidence: Vec<Evidence>,
}

/// The first alarm.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AlarmFound {
    /// What changed: a direction, or a channel whose residuals are wider.
    pub what: String,
    /// Effects that it stands for.
    pub effects: &'static [&'static str],
    /// Size of the strongest alternative, in `unit`; null for wider residuals.
    pub size: Option<f64>,
    /// Unit of the size: share, share after 32 steps, or steps; null for wider residuals.
    pub unit: Option<&'static str>,
    /// The step at which the change began.
    pub began: Place,
    /// The step at which the alarm was raised.
    pub raised: Place,
}

/// A step of logs.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Place {
    /// Name of the run.
    pub run: String,
    /// Time at which the step begins, ms.
    pub t_ms: f64,
}

/// Evidence of one alternative.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Evidence {
    /// The direction, or the channel whose residuals are wider.
    pub what: String,
    /// Its size, in the unit of the direction; null for wider residuals.
    pub size: Option<f64>,
    /// Evidence against an unchanged robot since it was last restarted, nats.
    pub nats: f64,
}

impl Findings {
    /// Replays logs, run after run.
    pub fn of(replay: &Replay, logs: &Logs) -> Self {
        let law = replay.law.law();
        let mut monitor = Monitor::new(&law);
        let (mut paused, mut steps) = (0, 0);
        let mut measured: Vec<Place> = Vec::new();
        let mut alarm = None;
        for run in &logs.runs {
            replay.run(&law, &mut monitor, run, |row, outcome, _| {
                steps += 1;
                let place = || Place { run: run.name.clone(), t_ms: run.rows.at(row).t_ms };
                match outcome {
                    Outcome::Paused => paused += 1,
                    _ => measured.push(place()),
                }
                if let (None, Outcome::Changed(found)) = (&alarm, outcome) {
                    let began = measured.len().saturating_sub(usize::from(found.after_steps));
                    alarm =
                        Some(replay.named(found.alternative, measured[began.min(measured.len() - 1)].clone(), place()));
                }
            });
        }
        let mut evidence: Vec<Evidence> = Alternative::all()
            .map(|alternative| {
                let (what, size) = replay.what(alternative);
                Evidence { what, size, nats: nats(monitor.evidence(alternative)) }
            })
            .collect();
        evidence.sort_by(|a, b| b.nats.total_cmp(&a.nats));
        Findings {
            schema: SchemaNumber,
            threshold_nats: nats(law.threshold),
            false_alarm_bound: FALSE_ALARMS,
            lifetime_steps: LIFETIME_STEPS as u32,
            steps,
            paused,
            alarm,
            evidence,
        }
    }
}

impl Replay {
    /// Returns what an alternative is called, and its size.
    fn what(&self, alternative: Alternative) -> (String, Option<f64>) {
        match alternative {
            Alternative::Direction(direction, size) => {
                let direction = usize::from(direction);
                let times = if size == 0 { 1 } else { LARGER };
                let size = f64::from(times) * self.law.directions.sizes[direction];
                (NAMED[direction].name.to_owned(), Some(size))
            }
            Alternative::Wider(0) => ("forward scatters more".into(), None),
            Alternative::Wider(_) => ("turn scatters more".into(), None),
        }
    }

    fn named(&self, alternative: Alternative, began: Place, raised: Place) -> AlarmFound {
        let (what, size) = self.what(alternative);
        let named = match alternative {
            Alternative::Direction(direction, _) => NAMED.get(usize::from(direction)),
            Alternative::Wider(_) => None,
        };
        let effects: &[&str] = named.map_or(&[], |named| named.effects);
        AlarmFound { what, effects, size, unit: named.map(|named| named.unit), began, raised }
    }
}

fn nats(bits: u16) -> f64 {
    libm::ldexp(f64::from(bits), -(NAT_BITS as i32))
}
