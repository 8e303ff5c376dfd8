//! The parameters of effects: named, with a unit, physical bounds and a prior.
//!
//! An effect computes with values, which suit a fit: a signed loss, a wheel speed, log-odds. Files and answers hold
//! [settings](Setting) instead, by the names of the table in docs/reference/effects.md: a side and a factor, a command, a
//! factor.

use std::collections::BTreeMap;
use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use super::scales::{self, reference_cm_s};
use mindgap_foundations::statistics::maximise::Bounds;
use mindgap_logs::Robot;

/// A number that is fitted.
#[derive(Clone, Copy, Debug)]
pub struct Parameter {
    /// Its name in files and programs.
    pub name: &'static str,
    /// Unit of its number in files and answers; empty for a share, a factor or a probability.
    pub unit: &'static str,
    /// At this value the parameter changes nothing, or is irrelevant once the others change nothing.
    pub nominal: f64,
    /// Physically possible range, in the parameter's unit.
    pub bounds: [f64; 2],
    /// Standard deviation of the normal prior about the nominal value; infinite for a uniform prior.
    pub prior_sd: f64,
    /// A large change.
    pub scale: f64,
    /// Where fits start.
    pub guesses: Guesses,
    /// How it is reported.
    pub report: Report,
}

/// Where fits of a parameter start.
#[derive(Clone, Copy, Debug)]
pub enum Guesses {
    /// At these values.
    At(&'static [f64]),
    /// At these fractions of the largest wheel speed that the logs command, itself a share of the reference speed.
    OfTopSpeed(&'static [f64]),
    /// On a grid of this spacing between the bounds: for a parameter whose likelihood has many maxima.
    Every(f64),
}

/// How a parameter is reported, and written to files (docs/reference/effects.md).
#[derive(Clone, Copy, Debug)]
pub enum Report {
    /// Not reported, since it describes the form and not the effect; written as it is, by its own name.
    Hidden,
    /// As it is, by its own name.
    Value,
    /// An angle within (-180, 180], by its own name.
    Direction,
    /// The `side` that its sign means (positive: left), and its magnitude as `loss`.
    SideAndLoss,
    /// The `side` that its sign means (positive: left), and one minus its magnitude as `factor`.
    SideAndFactor,
    /// A share of the [reference speed](scales::reference_cm_s), as the `command` that asks for it.
    Command,
    /// The same of a limit, with what it `acts_on`.
    SpeedLimit(ActsOn),
    /// Such a share of the speed of both wheels in opposite directions, as the turn rate `turn_deg_s`.
    TurnLimit,
    /// Steps in which speeds change by the reference speed, as the limit `cm_s2` on how fast they change, with what it
    /// `acts_on`.
    RateLimit(ActsOn),
    /// The same of the turn alone, as `deg_s2`.
    TurnRateLimit,
    /// A change of wheel speed, as such a share; as `onset` in commands.
    Onset,
    /// A share of the track, as a length in cm by this name.
    OfTrack(&'static str),
    /// A time, as `steps`.
    Steps,
    /// A number of steps, as a time by its own name.
    Duration,
    /// A loss of log-odds, as the `factor` on the odds.
    OddsFactor,
}

/// What a file or an answer says of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
pub enum Setting {
    /// A number.
    Number(f64),
    /// A side of the robot.
    Side(Side),
    /// What a limit acts on.
    ActsOn(ActsOn),
}

impl Setting {
    /// Returns the number, if it is one.
    pub fn number(self) -> Option<f64> {
        if let Setting::Number(number) = self { Some(number) } else { None }
    }
}

/// A side of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

/// What a limit acts on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ActsOn {
    /// Each wheel by itself.
    Wheel,
    /// Both wheels by one factor, so that the robot keeps to its curve.
    Pair,
    /// Forward speed and turn rate, each by itself.
    Twist,
}

/// Settings by their names.
pub type Settings = BTreeMap<String, Setting>;

/// A value that comes back from a file this close to a bound or to nominal, relative to it, is that.
const ROUNDING: f64 = 1e-12;

impl Parameter {
    /// A parameter without a prior that is fitted from its nominal value and reported as it is.
    pub const fn new(unit: &'static str, nominal: f64, bounds: [f64; 2]) -> Self {
        Parameter {
            name: "",
            unit,
            nominal,
            bounds,
            prior_sd: f64::INFINITY,
            scale: bounds[1] - bounds[0],
            guesses: Guesses::At(&[]),
            report: Report::Value,
        }
    }

    /// Returns the parameter with a normal prior about the nominal value. Plausible values lie within five standard
    /// deviations.
    pub const fn prior_sd(self, prior_sd: f64) -> Self {
        Parameter { prior_sd, ..self.scale(5.0 * prior_sd) }
    }

    /// Returns the parameter with another large change, at most the distance between the bounds.
    pub const fn scale(self, scale: f64) -> Self {
        Parameter { scale: if scale < self.scale { scale } else { self.scale }, ..self }
    }

    /// Returns the parameter with starting points for its fit.
    pub const fn from(self, guesses: Guesses) -> Self {
        Parameter { guesses, ..self }
    }

    /// Returns the parameter with another way to report it.
    pub const fn report(self, report: Report) -> Self {
        Parameter { report, ..self }
    }

    /// Bounds for a fit.
    pub fn fit_bounds(&self) -> Bounds {
        let [low, high] = self.bounds;
        Bounds { low, high, scale: self.scale }
    }

    /// Whether a value is possible.
    pub fn allows(&self, value: f64) -> bool {
        (self.bounds[0]..=self.bounds[1]).contains(&value)
    }

    /// Returns whether the parameter is reported and `value` lies at a bound other than nominal.
    pub fn is_at_a_bound(&self, value: f64) -> bool {
        let reported = !matches!(self.report, Report::Hidden | Report::Direction);
        reported && value != self.nominal && self.bounds.contains(&value)
    }

    /// Logarithm of the prior's density relative to its maximum.
    pub fn log_prior(&self, value: f64) -> f64 {
        let z = (value - self.nominal) / self.prior_sd;
        -0.5 * z * z
    }

    /// Logarithm of the prior's density where it is largest, per unit of the parameter: of the normal law within the bounds,
    /// or of the uniform law between them.
    pub fn log_prior_peak(&self) -> f64 {
        let [low, high] = self.bounds;
        if self.prior_sd.is_infinite() {
            return -libm::log(high - low);
        }
        let below = |bound: f64| libm::erf((bound - self.nominal) / (self.prior_sd * std::f64::consts::SQRT_2));
        let within = 0.5 * (below(high) - below(low));
        -libm::log(self.prior_sd * std::f64::consts::TAU.sqrt() * within)
    }

    pub(super) fn guesses(&self, top_speed: f64) -> Vec<f64> {
        let [low, high] = self.bounds;
        let guesses: Vec<f64> = match self.guesses {
            Guesses::At(values) => values.to_vec(),
            Guesses::OfTopSpeed(shares) => shares.iter().map(|share| share * top_speed).collect(),
            Guesses::Every(step) => (0..=((high - low) / step) as usize).map(|i| low + i as f64 * step).collect(),
        };
        if guesses.is_empty() { vec![self.nominal] } else { guesses.iter().map(|g| g.clamp(low, high)).collect() }
    }

    /// Returns the name of its number in files and answers, and whether it comes with a side.
    pub fn setting(&self) -> (&'static str, bool) {
        match self.report {
            Report::Hidden | Report::Value | Report::Direction | Report::Duration => (self.name, false),
            Report::SideAndLoss => ("loss", true),
            Report::SideAndFactor => ("factor", true),
            Report::Command | Report::SpeedLimit(_) => ("command", false),
            Report::TurnLimit => ("turn_deg_s", false),
            Report::RateLimit(_) => ("cm_s2", false),
            Report::TurnRateLimit => ("deg_s2", false),
            Report::Onset => ("onset", false),
            Report::OfTrack(name) => (name, false),
            Report::Steps => ("steps", false),
            Report::OddsFactor => ("factor", false),
        }
    }

    /// Returns the unit of that number; empty if it has none.
    pub fn reported_unit(&self) -> &'static str {
        if let Report::Steps = self.report { "" } else { self.unit }
    }

    /// Returns what a limit acts on.
    fn acts_on(&self) -> Option<ActsOn> {
        match self.report {
            Report::SpeedLimit(acts_on) | Report::RateLimit(acts_on) => Some(acts_on),
            _ => None,
        }
    }

    /// Returns its settings at a value.
    pub(super) fn settings(&self, value: f64, robot: &Robot) -> Vec<(&'static str, Setting)> {
        let number = match self.report {
            Report::Hidden | Report::Value => value,
            Report::Direction => value - 360.0 * ((value - 180.0) / 360.0).ceil(),
            Report::SideAndLoss => value.abs(),
            Report::SideAndFactor => 1.0 - value.abs(),
            Report::Command | Report::SpeedLimit(_) | Report::Onset => scales::command_for(value, robot),
            Report::TurnLimit => value * fastest_turn_deg_s(robot),
            Report::RateLimit(_) => reference_cm_s(robot) * per_second(value, robot),
            Report::TurnRateLimit => fastest_turn_deg_s(robot) * per_second(value, robot),
            Report::OfTrack(_) => value * robot.track_cm,
            Report::Steps => value / robot.step_ms,
            Report::Duration => value * robot.step_ms,
            Report::OddsFactor => libm::exp(-value),
        };
        let (name, has_side) = self.setting();
        let side = Setting::Side(if value > 0.0 { Side::Left } else { Side::Right });
        let side = has_side.then_some((SIDE, side));
        let acts_on = self.acts_on().map(|acts_on| (ACTS_ON, Setting::ActsOn(acts_on)));
        side.into_iter().chain(acts_on).chain([(name, Setting::Number(number))]).collect()
    }

    /// Returns the value of settings; none where they lack it, or where it is not possible.
    pub(super) fn value(&self, settings: &Settings, robot: &Robot) -> Option<f64> {
        let (name, has_side) = self.setting();
        let Setting::Number(number) = *settings.get(name)? else { return None };
        let sign = match (has_side, settings.get(SIDE)) {
            (false, _) | (true, Some(Setting::Side(Side::Left))) => 1.0,
            (true, Some(Setting::Side(Side::Right))) => -1.0,
            (true, _) => return None,
        };
        let value = match self.report {
            Report::Hidden | Report::Value | Report::Direction => number,
            Report::SideAndLoss => sign * number,
            Report::SideAndFactor => sign * (1.0 - number),
            Report::Command | Report::SpeedLimit(_) | Report::Onset => scales::share_of(number, robot),
            Report::TurnLimit => number / fastest_turn_deg_s(robot),
            Report::RateLimit(_) => reference_cm_s(robot) * per_second(number, robot),
            Report::TurnRateLimit => fastest_turn_deg_s(robot) * per_second(number, robot),
            Report::OfTrack(_) => number / robot.track_cm,
            Report::Steps => number * robot.step_ms,
            Report::Duration => number / robot.step_ms,
            Report::OddsFactor => -libm::log(number),
        };
        let is_near = |marked: &f64| (value - marked).abs() <= ROUNDING * marked.abs().max(1.0);
        let marked = self.bounds.into_iter().chain([self.nominal]).find(is_near);
        Some(marked.unwrap_or(value)).filter(|value| self.allows(*value))
    }

    /// Returns the number that is reported at a value; `None` for a parameter that describes the form, or a direction.
    pub fn number(&self, value: f64, robot: &Robot) -> Option<f64> {
        let measures = !matches!(self.report, Report::Hidden | Report::Direction);
        let settings = self.settings(value, robot).into_iter().filter(|_| measures);
        settings.filter_map(|(_, setting)| setting.number()).next()
    }

    /// Returns how far a reported number lies from neutral. A speed limit departs from full speed; a ramp and an onset of slip depart
    /// by their own value, since none at all would be infinitely steep or late; and a direction departs by one radian.
    pub fn departure(&self, number: f64, robot: &Robot) -> f64 {
        let neutral = self.number(self.nominal, robot);
        match self.report {
            Report::RateLimit(_) | Report::TurnRateLimit | Report::Onset => number.abs(),
            Report::SpeedLimit(_) | Report::Command => {
                neutral.map_or(number, |neutral| number - neutral.min(FULL_COMMAND)).abs()
            }
            _ => neutral.map_or(1f64.to_degrees(), |neutral| (number - neutral).abs()),
        }
    }

    /// Returns its settings at a value; none of a parameter that describes the form.
    pub(super) fn reported(&self, value: f64, robot: &Robot) -> Vec<(String, Value)> {
        let is_reported = !matches!(self.report, Report::Hidden);
        let settings = self.settings(value, robot).into_iter().filter(|_| is_reported);
        settings.map(|(name, setting)| (name.into(), json!(setting))).collect()
    }

    /// Returns the name of the reported number, its value, and its interval for this interval of the value; `None` for a
    /// parameter that describes the form.
    pub fn reported_between(
        &self,
        value: f64,
        [low, high]: [f64; 2],
        robot: &Robot,
    ) -> Option<(&'static str, f64, [f64; 2])> {
        let name = self.setting().0;
        if let Report::Direction = self.report {
            // Beyond half a turn where the direction is near it: 179 (176 to 182).
            let number = self.settings(value, robot).into_iter().find_map(|(_, setting)| setting.number())?;
            return Some((name, number, [low, high].map(|end| number + end - value)));
        }
        let number = self.number(value, robot)?;
        // A magnitude is least where nothing is changed.
        let nominal = (low < self.nominal && self.nominal < high).then_some(self.nominal);
        let reached = || [low, high].into_iter().chain(nominal).filter_map(|value| self.number(value, robot));
        let ends = [reached().fold(f64::INFINITY, f64::min), reached().fold(f64::NEG_INFINITY, f64::max)];
        Some((name, number, ends))
    }
}

/// The command of full speed.
const FULL_COMMAND: f64 = 100.0;
/// Fewer steps than this are none.
const NO_STEPS: f64 = 1e-13;
/// Name of the setting that says which side of the robot is meant.
const SIDE: &str = "side";
/// Name of the setting that says what a limit acts on. The variant says it too, so files need not.
pub(super) const ACTS_ON: &str = "acts_on";

/// Returns how fast wheels turn the robot that run at the reference speed in opposite directions.
fn fastest_turn_deg_s(robot: &Robot) -> f64 {
    (2.0 * reference_cm_s(robot) / robot.track_cm).to_degrees()
}

/// Returns how often a change of this number of steps fits into a second, or the number of steps from how often it does. A ramp
/// of no steps is a very fast one, since a file has no infinity.
fn per_second(steps: f64, robot: &Robot) -> f64 {
    1000.0 / (steps.max(NO_STEPS) * robot.step_ms)
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Setting::Number(number) => number.fmt(f),
            Setting::ActsOn(ActsOn::Wheel) => f.write_str("wheel"),
            Setting::ActsOn(ActsOn::Pair) => f.write_str("pair"),
            Setting::ActsOn(ActsOn::Twist) => f.write_str("twist"),
            Setting::Side(Side::Left) => f.write_str("left"),
            Setting::Side(Side::Right) => f.write_str("right"),
        }
    }
}

/// Declares the parameters of a variant once: as a struct whose fields a hook reads by name, and as data.
///
/// ```text
/// parameters! {
///     Fading {
///         /// Share of speed lost per minute. Bound: …
///         loss_per_min: Parameter::new("1/min", 0.0, [0.0, 0.9]),
///     }
/// }
/// ```
/// makes `Fading::PARAMETERS` and `Fading::read(values)`.
macro_rules! parameters {
    ($(#[$about:meta])* $name:ident { $($(#[$meaning:meta])* $field:ident: $parameter:expr,)* }) => {
        $(#[$about])*
        struct $name {
            $($(#[$meaning])* $field: f64,)*
        }

        impl $name {
            const PARAMETERS: &'static [$crate::effects::Parameter] =
                &[$($crate::effects::Parameter { name: stringify!($field), ..$parameter },)*];

            fn read(values: &[f64]) -> Self {
                let [$($field),*] = values else { unreachable!("one value for each parameter") };
                $name { $($field: *$field),* }
            }
        }
    };
}
pub(super) use parameters;

#[cfg(test)]
mod tests {
    use super::*;

    const LENGTH: Parameter = Parameter { name: "cm", ..Parameter::new("cm", 1.0, [-5.0, 5.0]) };

    #[test]
    fn the_prior_is_normal_about_the_nominal_value() {
        assert_eq!(LENGTH.log_prior(4.0), 0.0, "without a prior every value is as likely");
        assert_eq!(LENGTH.prior_sd(1.5).log_prior(4.0), -2.0);
        // A large change is five deviations, but never more than from bound to bound.
        assert_eq!([0.5, 1.5, 3.0].map(|sd| LENGTH.prior_sd(sd).scale), [2.5, 7.5, 10.0]);
        let Bounds { low, high, scale } = LENGTH.prior_sd(0.5).fit_bounds();
        assert_eq!([low, high, scale], [-5.0, 5.0, 2.5]);
    }

    #[test]
    fn the_prior_integrates_to_one_between_the_bounds() {
        for parameter in [LENGTH, LENGTH.prior_sd(1.5), LENGTH.prior_sd(8.0)] {
            let density = |cm: f64| libm::exp(parameter.log_prior_peak() + parameter.log_prior(cm));
            let sum: f64 = (0..10_000).map(|i| density(-5.0 + (f64::from(i) + 0.5) * 1e-3)).sum();
            assert!((1e-3 * sum - 1.0).abs() < 1e-6, "{:?}: {}", parameter.prior_sd, 1e-3 * sum);
        }
    }

    #[test]
    fn fits_start_at_the_guesses_within_the_bounds() {
        let starts = |guesses| LENGTH.from(guesses).guesses(8.0);
        assert_eq!(LENGTH.guesses(8.0), [1.0], "from the nominal value where nothing is guessed");
        assert_eq!(starts(Guesses::At(&[2.0, -9.0])), [2.0, -5.0]);
        assert_eq!(starts(Guesses::OfTopSpeed(&[0.25, 0.5, 1.0])), [2.0, 4.0, 5.0]);
        assert_eq!(starts(Guesses::Every(4.0)), [-5.0, -1.0, 3.0]);
    }

    #[test]
    fn values_are_reported_by_the_names_of_the_table() {
        // 0.4 s per step, and 82 cm/s at a command of 100, twice the reference speed.
        let robot = Robot { step_ms: 400.0, full_speed_cm_s: 82.0, ..mindgap_built_in_robot::default_robot() };
        let reported = |report, value| -> Vec<(String, Value)> { LENGTH.report(report).reported(value, &robot) };
        let one = |name: &str, value: f64| vec![(String::from(name), json!(value))];
        let side = |side: &str, name: &str, value: f64| vec![("side".into(), json!(side)), (name.into(), json!(value))];
        assert_eq!(reported(Report::Hidden, 3.0), []);
        assert_eq!(reported(Report::Value, 2.7459), one("cm", 2.7459));
        assert_eq!(reported(Report::Direction, 270.0), one("cm", -90.0));
        assert_eq!(reported(Report::SideAndLoss, 0.25), side("left", "loss", 0.25));
        assert_eq!(reported(Report::SideAndLoss, -0.25), side("right", "loss", 0.25));
        assert_eq!(reported(Report::SideAndFactor, -0.25), side("right", "factor", 0.75));
        assert_eq!(reported(Report::Command, 0.2), one("command", 10.0));
        assert_eq!(reported(Report::Onset, 0.2), one("onset", 10.0));
        assert_eq!(reported(Report::OfTrack("ahead_cm"), 0.5), one("ahead_cm", 5.75));
        assert_eq!(reported(Report::Steps, 600.0), one("steps", 1.5));
        assert_eq!(reported(Report::Duration, 1.5), one("cm", 600.0));
        assert_eq!(reported(Report::OddsFactor, libm::log(2.0)), one("factor", 0.5));
    }

    #[test]
    fn intervals_contain_their_value() {
        let robot = Robot { step_ms: 400.0, full_speed_cm_s: 50.0, ..mindgap_built_in_robot::default_robot() };
        let between = |report, value, ends| {
            let parameter = Parameter { nominal: 0.0, ..LENGTH.report(report) };
            parameter.reported_between(value, ends, &robot).map(|(name, _, ends)| (name, ends))
        };
        let one = |name: &'static str, ends: [f64; 2]| Some((name, ends));
        assert_eq!(between(Report::Hidden, 3.0, [2.0, 4.0]), None);
        assert_eq!(between(Report::Value, 3.0, [2.0, 4.0]), one("cm", [2.0, 4.0]));
        let odds = [libm::exp(-1.0), libm::exp(1.0)];
        assert_eq!(between(Report::OddsFactor, 0.0, [-1.0, 1.0]), one("factor", odds));
        assert_eq!(between(Report::SideAndLoss, 0.25, [0.125, 0.375]), one("loss", [0.125, 0.375]));
        assert_eq!(between(Report::SideAndLoss, -0.002, [-0.008, 0.004]), one("loss", [0.0, 0.008]), "either side");
        assert_eq!(between(Report::SideAndFactor, -0.25, [-0.5, 0.125]), one("factor", [0.5, 1.0]));
        assert_eq!(between(Report::Direction, 20.0, [-5.0, 45.0]), one("cm", [-5.0, 45.0]));
        assert_eq!(between(Report::Direction, 179.0, [176.0, 182.0]), one("cm", [176.0, 182.0]));
        assert_eq!(between(Report::Direction, -270.0, [-275.0, -265.0]), one("cm", [85.0, 95.0]));
    }
}
