//! Own effects: hypotheses that a user states as parameters and expressions, and that compete and are applied like those
//! of the catalogue.
//!
//! Effects are static data. One that is read while the program runs is therefore kept until it ends: once, however often
//! it is asked for, so that what is kept grows with the number of definitions and with nothing else.

mod check;
pub mod definition;
pub mod expression;
pub mod variables;

use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use serde::Deserialize;
use toml::Spanned;

use super::context::{CommandHistory, StepContext};
use super::parameter::{Guesses, Parameter};
use super::{CATALOGUE, Effect, Hook, SensorState, Variant};
use definition::{Change, Definition, ParameterDefinition};
use expression::Expression;
use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::motion::Motion;
use variables::{Circumstances, Stage};

/// Id of the one variant of an own effect.
const VARIANT: &str = "own";
/// How one checks an own effect.
const CHECK: &str = "Measure on the robot what the definition of this effect of your own describes.";
/// Default start of a fit, as a fraction of the range from nominal to a bound: near enough that the likelihood still
/// resembles the nominal one, and far enough that the gradient has a direction.
const FIRST_GUESS: f64 = 0.1;
/// The readings between which a change of readings is a straight line, cm.
const SPAN_CM: f64 = 100.0;

/// Every own effect that was read, with what it was made of.
static KEPT: LazyLock<Mutex<Vec<(Definition, &'static Effect)>>> = LazyLock::new(Mutex::default);

/// Reads a file of own effects.
///
/// # Errors
/// When it cannot be read, is no such file, or one of its effects is not possible: file, line, effect and key.
pub fn read(path: &Path) -> Result<Vec<&'static Effect>> {
    let text = files::read_text(path)?;
    let File { effects } = files::from_toml(path, &text)?;
    let at = |entry: &Spanned<Definition>, what: String| {
        let what = format!("effect {}: {what}", entry.get_ref().id);
        Error::at_line(path, files::line_at(&text, entry.span().start), what)
    };
    let ids: Vec<&str> = effects.iter().map(|entry| entry.get_ref().id.as_str()).collect();
    if let Some(place) = (0..ids.len()).find(|place| ids[..*place].contains(&ids[*place])) {
        return Err(at(&effects[place], "is there twice".into()));
    }
    effects.iter().map(|entry| effect(entry.get_ref()).map_err(|what| at(entry, what))).collect()
}

/// The built-in effects and those of files, whose ids have to differ.
///
/// # Errors
/// As [`read`], or when an id is there twice.
pub fn beside_built_in(files: &[PathBuf]) -> Result<&'static [&'static Effect]> {
    let mut catalogue = CATALOGUE.to_vec();
    for path in files {
        for effect in read(path)? {
            if catalogue.iter().any(|other| other.id == effect.id) {
                return Err(Error::in_file(path, format!("effect {} is in another file too", effect.id)));
            }
            catalogue.push(effect);
        }
    }
    Ok(catalogue.leak())
}

/// The text of a file of own effects.
pub fn to_text(definition: &Definition) -> String {
    toml::to_string(&Written { effects: [definition] }).unwrap_or_default()
}

/// The effect of a definition.
///
/// # Errors
/// What is not possible, in one line.
pub fn effect(definition: &Definition) -> std::result::Result<&'static Effect, String> {
    // Held until it is made: two threads that ask for one definition get one effect.
    let mut kept = kept();
    if let Some((_, effect)) = kept.iter().find(|(kept, _)| kept == definition) {
        return Ok(effect);
    }
    let made = make(definition)?;
    kept.push((definition.clone(), made));
    Ok(made)
}

/// The definition of a variant, if it is that of an own effect.
pub fn definition_of(variant: &'static Variant) -> Option<Definition> {
    let made = |effect: &Effect| effect.variants.iter().any(|own| std::ptr::eq(own, variant));
    kept().iter().find(|(_, effect)| made(effect)).map(|(definition, _)| definition.clone())
}

fn kept() -> MutexGuard<'static, Vec<(Definition, &'static Effect)>> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner)
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(rename = "effect")]
    effects: Vec<Spanned<Definition>>,
}

#[derive(serde::Serialize)]
struct Written<'a> {
    #[serde(rename = "effect")]
    effects: [&'a Definition; 1],
}

fn make(definition: &Definition) -> std::result::Result<&'static Effect, String> {
    check::numbers(definition)?;
    let parameters: &'static [Parameter] = definition.parameters.iter().map(parameter).collect::<Vec<_>>().leak();
    let compiled = Compiled::of(&definition.change, parameters)?;
    let hooks = compiled.hooks().leak();
    let variants = vec![Variant { id: VARIANT, parameters, hooks }].leak();
    check::changes_nothing(&variants[0])?;
    let id = leaked(&definition.id);
    Ok(Box::leak(Box::new(Effect {
        id,
        name: id,
        what: leaked(&definition.description),
        in_logs: "",
        imitated_by: &[],
        check: CHECK,
        place: None,
        needs_known_robot: false,
        variants,
    })))
}

fn leaked(text: &str) -> &'static str {
    String::from(text).leak()
}

fn parameter(of: &ParameterDefinition) -> Parameter {
    let ParameterDefinition { name, unit, nominal, bounds, prior_sd, guesses } = of;
    let own = Parameter { name: leaked(name), ..Parameter::new(leaked(unit), *nominal, *bounds) };
    let own = prior_sd.map_or(own, |sd| own.prior_sd(sd));
    let toward = bounds.map(|bound| nominal + FIRST_GUESS * (bound - nominal));
    let usual = toward.into_iter().filter(|guess| guess != nominal).collect();
    let guesses = if guesses.is_empty() { usual } else { guesses.clone() };
    own.from(Guesses::At(guesses.leak()))
}

/// The expressions of a definition.
struct Compiled {
    commands: [Option<Expression>; 2],
    motion: Motion<Option<Expression>>,
    reading: Option<Expression>,
    loss: Option<Expression>,
}

impl Compiled {
    fn of(change: &Change, parameters: &[Parameter]) -> std::result::Result<Self, String> {
        let names: Vec<&'static str> = parameters.iter().map(|p| p.name).collect();
        let nominal: Vec<f64> = parameters.iter().map(|p| p.nominal).collect();
        let compile = |key: &str, text: &Option<String>, stage: Stage| {
            let Some(text) = text else { return Ok(None) };
            let compiled = Expression::compile(text, &names, stage).map_err(|what| format!("change.{key}: {what}"))?;
            check::has_values(key, |step, increment| {
                let at = Circumstances { echo_cm: SPAN_CM, ..Circumstances::of_step(step, increment) };
                compiled.value(&nominal, &at)
            })?;
            Ok::<_, String>(Some(compiled))
        };
        let compiled = Compiled {
            commands: [
                compile("left", &change.left, Stage::Command)?,
                compile("right", &change.right, Stage::Command)?,
            ],
            motion: Motion {
                forward: compile("forward_cm", &change.forward_cm, Stage::Motion)?,
                lateral: compile("lateral_cm", &change.lateral_cm, Stage::Motion)?,
                turn: compile("turn_rad", &change.turn_rad, Stage::Motion)?,
            },
            reading: compile("echo_cm", &change.echo_cm, Stage::Reading)?,
            loss: compile("echo_loss", &change.echo_loss, Stage::Echo)?,
        };
        if let Some(reading) = &compiled.reading {
            check::is_affine(parameters, |values, step, echo_cm| {
                reading.value(values, &Circumstances::of_row(step, echo_cm))
            })?;
        }
        Ok(compiled)
    }

    fn hooks(self) -> Vec<Hook> {
        let Compiled { commands, motion, reading, loss } = self;
        let mut hooks = Vec::new();
        if commands.iter().any(Option::is_some) {
            hooks.push(Hook::CommandsHere(Box::leak(Box::new(
                move |values: &[f64], step: &StepContext, sent: &mut CommandHistory| {
                    command(&commands, values, step, sent);
                },
            ))));
        }
        if motion.iter().any(Option::is_some) {
            hooks.push(Hook::MotionHere(Box::leak(Box::new(
                move |values: &[f64], step: &StepContext, increment: &mut Motion<f64>| {
                    moved(&motion, values, step, increment);
                },
            ))));
        }
        if reading.is_some() || loss.is_some() {
            hooks.push(Hook::SensorHere(Box::leak(Box::new(
                move |values: &[f64], step: &StepContext, sensor: &mut SensorState| {
                    sensed(reading.as_ref(), loss.as_ref(), values, step, sensor);
                },
            ))));
        }
        hooks
    }
}

/// Where an expression has no value, nothing is changed: there the effect is not possible.
fn command(change: &[Option<Expression>; 2], values: &[f64], step: &StepContext, sent: &mut CommandHistory) {
    let before = *sent;
    for (place, pair) in sent.iter_mut().enumerate() {
        // What was sent before the oldest command is not known: taken to be the same.
        let commands = [before[place], *before.get(place + 1).unwrap_or(&before[place])];
        let at = Circumstances { commands, ..Circumstances::of_step(step, Motion::ZERO) };
        for (command, change) in pair.iter_mut().zip(change) {
            *command = change.as_ref().and_then(|change| change.value(values, &at)).unwrap_or(*command);
        }
    }
}

fn moved(change: &Motion<Option<Expression>>, values: &[f64], step: &StepContext, increment: &mut Motion<f64>) {
    let at = Circumstances::of_step(step, *increment);
    *increment = change.each_ref().zip_with(*increment, |change, predicted| {
        change.as_ref().and_then(|change| change.value(values, &at)).unwrap_or(predicted)
    });
}

fn sensed(
    reading: Option<&Expression>,
    loss: Option<&Expression>,
    values: &[f64],
    step: &StepContext,
    sensor: &mut SensorState,
) {
    let changed = |echo_cm: f64| reading?.value(values, &Circumstances::of_row(step, echo_cm));
    if let (Some(offset_cm), Some(far_cm)) = (changed(0.0), changed(SPAN_CM)) {
        let gain = (far_cm - offset_cm) / SPAN_CM;
        // A factor of nothing or less would turn near into far.
        if gain > 0.0 {
            sensor.perturbation.gain *= gain;
            sensor.perturbation.offset_cm = gain * sensor.perturbation.offset_cm + offset_cm;
        }
    }
    let lost = loss.and_then(|loss| loss.value(values, &Circumstances::of_row(step, 0.0)));
    sensor.perturbation.attenuation += lost.unwrap_or(0.0);
}

#[cfg(test)]
mod tests;
