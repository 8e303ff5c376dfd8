//! What makes a definition an effect: that every part of it is possible, and that it changes nothing at its nominal
//! parameters.

use rand::RngExt;

use super::definition::{Definition, ParameterDefinition};
use super::expression::{Expression, is_constant};
use super::variables::VARIABLES;
use crate::effects::context::{RunHistory, Surroundings};
use crate::effects::{CATALOGUE, Hook, Parameter, SensorState, StepContext, Variant};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::motion::Motion;
use mindgap_foundations::random::generator;
use mindgap_logs::{Robot, Scene, Ultrasonic};

/// More parameters than this fit anything: the largest form of the catalogue has five.
const MOST_PARAMETERS: usize = 6;
/// More starts than this make a fit slow: each costs as much as a step of the fit.
const MOST_STARTS: usize = 64;
/// Differences from nothing that rounding makes, against what is changed.
const ROUNDING: f64 = 1e-9;
/// Steps at which it is tried out, besides a robot at rest: enough that every quarter of headings, directions of travel and
/// sides of the room comes up.
const SAMPLES: u64 = 60;

/// Whether the names and numbers of a definition are possible.
///
/// # Errors
/// What is not, in one line.
pub fn numbers(definition: &Definition) -> Result<(), String> {
    let Definition { id, parameters, change, .. } = definition;
    if !is_name(id) {
        return Err(format!("id {id:?} is not a name of small letters, digits and _"));
    }
    if CATALOGUE.iter().any(|effect| effect.id == id) {
        return Err(format!("{id} is the id of a built-in effect: take another"));
    }
    if change.entries().next().is_none() {
        return Err("change has no expression".into());
    }
    if parameters.is_empty() || parameters.len() > MOST_PARAMETERS {
        return Err(format!("has {} parameters: 1 to {MOST_PARAMETERS} are possible", parameters.len()));
    }
    for (place, parameter) in parameters.iter().enumerate() {
        let name = &parameter.name;
        number(parameter).map_err(|what| format!("parameter {name}: {what}"))?;
        if parameters[..place].iter().any(|other| other.name == *name) {
            return Err(format!("parameter {name} is there twice"));
        }
        if !change.entries().any(|(_, text)| Expression::mentions(text, name)) {
            return Err(format!("parameter {name} is in no expression"));
        }
    }
    let starts: usize = parameters.iter().map(|parameter| parameter.guesses.len().max(2)).product();
    if starts > MOST_STARTS {
        return Err(format!("its guesses make {starts} combinations: {MOST_STARTS} are possible"));
    }
    Ok(())
}

fn number(parameter: &ParameterDefinition) -> Result<(), String> {
    let ParameterDefinition { name, nominal, bounds: [low, high], prior_sd, guesses, .. } = parameter;
    if !is_name(name) {
        return Err("is not a name of small letters, digits and _".into());
    }
    if is_constant(name) || VARIABLES.iter().any(|variable| variable.name == name) {
        return Err("has the name of a variable or constant: take another".into());
    }
    if !low.is_finite() || !high.is_finite() || low >= high {
        return Err(format!("bounds [{low}, {high}] are not a smaller and a larger number"));
    }
    let within = |value: &f64| (low..=high).contains(&value);
    if !within(nominal) {
        return Err(format!("nominal {nominal} lies outside the bounds {low} to {high}"));
    }
    if prior_sd.is_some_and(|sd| !(sd.is_finite() && sd > 0.0)) {
        return Err("prior_sd is not a positive number".into());
    }
    match guesses.iter().find(|guess| !within(guess) || *guess == nominal) {
        Some(guess) => Err(format!("guess {guess} is nominal or outside the bounds: no fit can start there")),
        None => Ok(()),
    }
}

fn is_name(text: &str) -> bool {
    let possible = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    text.starts_with(|c: char| c.is_ascii_lowercase()) && text.chars().all(possible)
}

/// Whether each expression has a value at the nominal parameters, wherever a robot may be; `value` evaluates one of them.
///
/// # Errors
/// Where it has none.
pub fn has_values(key: &str, value: impl Fn(&StepContext, Motion<f64>) -> Option<f64>) -> Result<(), String> {
    for (step, increment) in samples() {
        if value(&step, increment).is_none() {
            let [[left, right], ..] = step.commands;
            let Motion { forward: forward_cm, turn: turn_rad, .. } = increment;
            return Err(format!(
                "change.{key} is not a number at the nominal parameters where left = {left:.0}, right = {right:.0}, \
                 forward_cm = {forward_cm:.1}, turn_rad = {turn_rad:.2}"
            ));
        }
    }
    Ok(())
}

/// Whether a reading becomes a factor times itself plus a length, whatever the parameters; `value` evaluates it.
///
/// # Errors
/// If it does not.
pub fn is_affine(
    parameters: &[Parameter],
    value: impl Fn(&[f64], &StepContext, f64) -> Option<f64>,
) -> Result<(), String> {
    let nominal: Vec<f64> = parameters.iter().map(|p| p.nominal).collect();
    let at_bound = |place: usize, bound: usize| {
        let mut values = nominal.clone();
        values[place] = parameters[place].bounds[bound];
        values
    };
    for values in (0..parameters.len()).flat_map(|place| [at_bound(place, 0), at_bound(place, 1)]) {
        for (step, _) in samples() {
            let at = |echo_cm: f64| value(&values, &step, echo_cm);
            if let (Some(near), Some(middle), Some(far)) = (at(0.0), at(100.0), at(200.0))
                && (near + far - 2.0 * middle).abs() > ROUNDING * (1.0 + near.abs() + far.abs())
            {
                return Err("change.echo_cm has to be a factor times echo_cm plus a length".into());
            }
        }
    }
    Ok(())
}

/// Whether a variant changes nothing at its nominal parameters.
///
/// # Errors
/// What it changes.
pub fn changes_nothing(variant: &Variant) -> Result<(), String> {
    let nominal = variant.nominal();
    let differ = |a: f64, b: f64| (a - b).abs() > ROUNDING * (1.0 + b.abs());
    for (step, increment) in samples() {
        let (mut commands, mut moved, mut sensor) = (step.commands, increment, SensorState::nominal(step.pose));
        for hook in variant.hooks {
            match hook {
                Hook::Commands(change) | Hook::CommandsHere(change) => change(&nominal, &step, &mut commands),
                // No expression makes one.
                Hook::DeadTime(_) | Hook::Filter(_) | Hook::Delay(_) | Hook::HeadingLag(_) => {}
                Hook::Motion(change) | Hook::MotionHere(change) => change(&nominal, &step, &mut moved),
                Hook::Sensor(change) | Hook::SensorHere(change) | Hook::Ray(change) => {
                    change(&nominal, &step, &mut sensor)
                }
            }
        }
        let usual = SensorState::nominal(step.pose).perturbation;
        let [[left, right], ..] = step.commands;
        let pairs = [
            ("left", commands[0][0], left),
            ("right", commands[0][1], right),
            ("forward_cm", moved.forward, increment.forward),
            ("lateral_cm", moved.lateral, increment.lateral),
            ("turn_rad", moved.turn, increment.turn),
            ("echo_cm", sensor.perturbation.gain, usual.gain),
            ("echo_cm", sensor.perturbation.offset_cm, usual.offset_cm),
            ("echo_loss", sensor.perturbation.attenuation, usual.attenuation),
        ];
        if let Some((key, ..)) = pairs.into_iter().find(|(_, after, before)| differ(*after, *before)) {
            return Err(format!(
                "change.{key} changes something at the nominal parameters, where it must change nothing"
            ));
        }
    }
    Ok(())
}

/// Steps of a robot in a room, the first at rest, with what is predicted of each.
fn samples() -> Vec<(StepContext, Motion<f64>)> {
    let ultrasonic = Ultrasonic { x_cm: 5.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 4.0, max_cm: 250.0 };
    let robot = Robot {
        wheel_diameter_cm: 5.6,
        track_cm: 12.0,
        body_radius_cm: 10.0,
        step_ms: 400.0,
        full_speed_cm_s: 40.0,
        ultrasonic: Some(ultrasonic),
    };
    let scene = Scene { arena_cm: Some(glam::DVec2::new(300.0, 200.0)), ..Scene::default() };
    let surroundings = Surroundings::new(&robot, &scene);
    let sample = |place: u64| {
        let mut rng = generator(place, &[]);
        let mut draw = |low: f64, high: f64| if place == 0 { 0.0 } else { rng.random_range(low..high) };
        let pose = Pose::new(150.0 + draw(-140.0, 140.0), 100.0 + draw(-90.0, 90.0), draw(-3.1, 3.1));
        let context = surroundings.context(&RunHistory::default(), draw(0.0, 120_000.0), pose);
        let commands = context.commands.map(|pair| pair.map(|_| draw(-100.0, 100.0)));
        let step = StepContext { commands, echo_before: Some(place.is_multiple_of(2)), ..context };
        let increment = Motion { forward: draw(-16.0, 16.0), lateral: draw(-2.0, 2.0), turn: draw(-2.0, 2.0) };
        (step, increment)
    };
    (0..=SAMPLES).map(sample).collect()
}
