//! Causes of a gap: the effects that a diagnosis names, with numbers that are not rounded.

use std::collections::BTreeMap;

use serde_json::Value;

use super::engine::{Engine, Tag};
use super::estimate::Estimate;
use mindgap_diagnosis::Findings;
use mindgap_diagnosis::verdict::NamedEffect;
use mindgap_logs::Robot;
use mindgap_models::effects::applied::AppliedEffect;
use mindgap_models::effects::parameter::{ActsOn, Setting, Side};

/// A cause of the gap.
#[derive(Clone, Debug, PartialEq)]
pub struct Cause {
    /// Id of the effect.
    pub effect: String,
    /// Its share of the gap, if there is a budget.
    pub share: Option<f64>,
    /// Its numbers, by the names in docs/reference/effects.md.
    pub numbers: BTreeMap<String, Estimate>,
    /// The side of the robot that is concerned.
    pub side: Option<Side>,
    /// The further range sensor that it sits in.
    pub sensor: Option<String>,
    /// What a limit acts on.
    pub acts_on: Option<ActsOn>,
}

impl Cause {
    /// Returns the causes that a diagnosis names, most probable first. One that stands alone as scatter is not a cause.
    pub fn all(findings: &Findings) -> Vec<Self> {
        let effects = findings.diagnosis.effects.iter();
        effects.filter_map(|effect| Cause::of(effect, findings)).collect()
    }

    fn of(named: &NamedEffect, findings: &Findings) -> Option<Self> {
        let id = named.id;
        // An effect that was applied without a name sits in the first sensor.
        let is_meant = |applied: &&AppliedEffect| {
            applied.effect == id && (applied.sensor.is_none() || applied.sensor == named.sensor)
        };
        let of_same = findings.applied.iter().filter(is_meant);
        let applied = of_same.max_by_key(|applied| applied.sensor.is_some())?;
        let mut cause = Cause {
            effect: id.into(),
            share: named.share,
            numbers: BTreeMap::new(),
            side: None,
            sensor: applied.sensor.clone(),
            acts_on: None,
        };
        for (name, setting) in &applied.parameters {
            match setting {
                Setting::Number(value) => {
                    let ci95 = named.intervals.get(name).and_then(interval);
                    cause.numbers.insert(name.clone(), Estimate { value: *value, ci95 });
                }
                Setting::Side(side) => cause.side = Some(*side),
                Setting::ActsOn(acts_on) => cause.acts_on = Some(*acts_on),
            }
        }
        Some(cause)
    }

    /// Returns one of its numbers.
    ///
    /// # Errors
    /// In words, if the diagnosis does not report it.
    pub fn number(&self, name: &str) -> Result<Estimate, String> {
        self.numbers.get(name).copied().ok_or_else(|| format!("the diagnosis reports no {name}"))
    }
}

/// Returns an interval; `None` where the number lies at a physical bound.
fn interval(ends: &Value) -> Option<[f64; 2]> {
    match ends.as_array()?.as_slice() {
        [low, high] => Some([low.as_f64()?, high.as_f64()?]),
        _ => None,
    }
}

/// What a format is asked: to write one cause.
#[derive(Clone, Copy)]
pub struct Query<'a> {
    /// The cause.
    pub cause: &'a Cause,
    /// The robot as its builder measured it.
    pub robot: &'a Robot,
    /// The engine that reads the file, if known.
    pub engine: Option<Engine>,
}

impl Query<'_> {
    /// Returns one of the cause's numbers.
    ///
    /// # Errors
    /// As [`Cause::number`].
    pub fn number(&self, name: &str) -> Result<Estimate, String> {
        self.cause.number(name)
    }

    /// Returns a time of the cause, s. A negative one is not possible in a model: the robot would answer before its simulator
    /// does without any delay.
    ///
    /// # Errors
    /// In words, if it is negative or missing.
    pub fn seconds(&self) -> Result<Estimate, String> {
        let seconds = self.number("ms")?.map(|ms| ms / 1000.0);
        if seconds.value < 0.0 {
            return Err(
                "the robot answers sooner than its simulator: look for a delay or a lag in the simulator's driver"
                    .into(),
            );
        }
        Ok(seconds)
    }

    /// Returns the index of the side that is concerned: 0 for left, 1 for right.
    ///
    /// # Errors
    /// In words, if none is.
    pub fn side(&self) -> Result<usize, String> {
        let side = self.cause.side.ok_or("the diagnosis reports no side")?;
        Ok(usize::from(side == Side::Right))
    }

    /// Returns the angular speed of a wheel at a command, rad/s.
    pub fn wheel_rad_s(&self, command: Estimate) -> Estimate {
        let full_rad_s = self.robot.full_speed_cm_s / (self.robot.wheel_diameter_cm / 2.0);
        command.map(|command| full_rad_s * command / 100.0)
    }

    /// Returns an error if the engine accepts this tag and ignores it.
    ///
    /// # Errors
    /// In words, with what would work.
    pub fn obeyed(&self, tag: Tag, written: &str) -> Result<(), String> {
        let ignored = self.engine.and_then(|engine| Some((engine, engine.ignores(tag)?)));
        ignored.map_or(Ok(()), |(engine, why)| Err(format!("{written} has no effect in {}: {why}", engine.name())))
    }

    /// Returns a length of the cause, m.
    ///
    /// # Errors
    /// As [`Cause::number`].
    pub fn metres(&self, name: &str) -> Result<Estimate, String> {
        Ok(self.number(name)?.map(|cm| cm / 100.0))
    }
}
