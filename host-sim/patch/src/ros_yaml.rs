//! Parameters of ROS 2 controllers as YAML: `diff_drive_controller`.

use std::path::Path;

use saphyr_parser::{Event, Parser};

use super::cause::Query;
use super::edit::{Answer, Change, Edit, Numbers, number};
use super::estimate::Estimate;
use super::refusal;
use mindgap_foundations::error::{Error, Result};
use mindgap_models::effects::parameter::ActsOn;

/// A scalar with its dotted path.
struct Entry {
    path: String,
    /// First byte of its key.
    key_start: usize,
    at: std::ops::Range<usize>,
    value: String,
}

/// Parameters of controllers.
pub struct RosYaml<'a> {
    text: &'a str,
    entries: Vec<Entry>,
}

impl<'a> RosYaml<'a> {
    /// Parses a file.
    ///
    /// # Errors
    /// With the line, if it is not YAML or has no controller of a differential drive, or several.
    pub fn parse(path: &Path, text: &'a str) -> Result<Self> {
        let entries = entries(text).map_err(|(line, what)| Error::at_line(path, line, what))?;
        let yaml = RosYaml { text, entries };
        match yaml.ending("wheel_separation").count() {
            1 => Ok(yaml),
            0 => Err(Error::in_file(path, "has no wheel_separation: it is not of a diff_drive_controller")),
            n => Err(Error::in_file(
                path,
                format!("has {n} controllers with a wheel_separation, and they cannot be distinguished"),
            )),
        }
    }

    /// Returns the distance between the wheels, m, if it can be read.
    pub fn track_m(&self) -> Option<f64> {
        self.ending("wheel_separation").next()?.value.parse().ok()
    }

    /// Returns the changes that write a cause.
    ///
    /// # Errors
    /// In words, if there is no parameter for it.
    pub fn changes(&self, query: &Query) -> Answer {
        match query.cause.effect.as_str() {
            "track_width" => {
                let factor = query.number("factor")?;
                Ok(vec![self.multiplied(
                    "wheel_separation_multiplier",
                    "wheel_separation",
                    factor,
                    |f| f,
                    "multiplier * factor",
                )?])
            }
            "drive_scale" => {
                let factor = query.number("factor")?;
                SIDES
                    .iter()
                    .map(|name| self.multiplied(name, "wheel_radius", factor, |f| 1.0 / f, "multiplier / factor"))
                    .collect()
            }
            "motor_asymmetry" => {
                let name = SIDES[query.side()?];
                let factor = query.number("factor")?;
                Ok(vec![self.multiplied(
                    name,
                    "wheel_radius",
                    factor,
                    |f| 1.0 / f,
                    "multiplier of this wheel / factor",
                )?])
            }
            "rate_limit" if query.cause.acts_on == Some(ActsOn::Twist) => {
                let linear = query.metres("cm_s2")?;
                let angular = query.number("deg_s2")?.map(f64::to_radians);
                self.limits("acceleration", linear, angular, ["m/s^2", "rad/s^2"])
            }
            "saturation" if query.cause.acts_on == Some(ActsOn::Twist) => {
                let linear = query.number("command")?.map(|c| c / 100.0 * query.robot.full_speed_cm_s / 100.0);
                let angular = query.number("turn_deg_s")?.map(f64::to_radians);
                self.limits("velocity", linear, angular, ["m/s", "rad/s"])
            }
            "rate_limit" | "saturation" => {
                Err("the controller limits the twist, not a wheel: limit wheels in the hardware's driver".into())
            }
            "latency" => Err("the controller has no parameter for it: hold commands back in a relay node".into()),
            _ => Err(refusal::no_tag("the controller")),
        }
    }

    fn ending<'t>(&'t self, name: &'t str) -> impl Iterator<Item = &'t Entry> {
        self.entries.iter().filter(move |entry| entry.path == name || entry.path.ends_with(&format!(".{name}")))
    }

    fn numbers(&self, entry: &Entry) -> std::result::Result<Numbers, String> {
        Numbers::parse(self.text, entry.at.clone(), entry.path.clone())
    }

    /// Multiplies a multiplier, which is 1 where it is missing, and is then added before the number that it multiplies.
    fn multiplied(
        &self,
        name: &str,
        before: &str,
        factor: Estimate,
        scale: impl Fn(f64) -> f64,
        reason: &str,
    ) -> std::result::Result<Change, String> {
        if let Some(entry) = self.ending(name).next() {
            let numbers = self.numbers(entry)?;
            let old = numbers.value(0)?;
            return Ok(numbers.set(&[(0, factor.map(|f| old * scale(f)))], "", reason.into()));
        }
        let base = self.ending(before).next().ok_or_else(|| format!("the controller has no {before}"))?;
        let new = factor.map(scale);
        let prefix = base.path.strip_suffix(before).unwrap_or_default();
        let line_start = self.text[..base.key_start].rfind('\n').map_or(0, |at| at + 1);
        let indent = &self.text[line_start..base.key_start];
        let is_block = indent.chars().all(char::is_whitespace);
        let ending =
            if self.text[line_start..].lines().next().is_some_and(|line| line.ends_with('\r')) { "\r\n" } else { "\n" };
        let separator = if is_block { format!("{ending}{indent}") } else { ", ".into() };
        Ok(Change {
            tag: format!("{prefix}{name}"),
            old: String::new(),
            new: real(new.value),
            unit: "",
            ci95: new.ci95,
            edits: vec![Edit {
                at: base.key_start..base.key_start,
                text: format!("{name}: {}{separator}", real(new.value)),
            }],
            reason: format!("{reason}; it was 1, the default"),
        })
    }

    /// Sets limits of the twist that are there.
    fn limits(&self, what: &str, linear: Estimate, angular: Estimate, units: [&'static str; 2]) -> Answer {
        let mut changes = Vec::new();
        for ((axis, limit), unit) in [("linear.x", linear), ("angular.z", angular)].into_iter().zip(units) {
            let switch = format!("{axis}.has_{what}_limits");
            if self.ending(&switch).any(|entry| entry.value == "false") {
                return Err(format!("{switch} is false: switch it on first"));
            }
            let name = format!("{axis}.max_{what}");
            let entry =
                self.ending(&name).next().ok_or_else(|| format!("the controller has no {name}: add it first"))?;
            changes.push(self.numbers(entry)?.set(&[(0, limit)], unit, "limit of the twist".into()));
        }
        Ok(changes)
    }
}

/// Multipliers of the wheels' radii: left, right.
const SIDES: [&str; 2] = ["left_wheel_radius_multiplier", "right_wheel_radius_multiplier"];

/// Returns a number that ROS reads as a real one: `1` would be an integer.
fn real(value: f64) -> String {
    let text = number(value);
    if text.contains('.') { text } else { text + ".0" }
}

/// Where the parser is in mappings and sequences.
struct Level {
    /// The path so far, and whether it is a mapping.
    path: String,
    is_mapping: bool,
    key: Option<(String, usize)>,
    items: usize,
}

fn entries(text: &str) -> std::result::Result<Vec<Entry>, (u64, String)> {
    // Positions are counted in characters.
    let bytes: Vec<usize> = text.char_indices().map(|(at, _)| at).chain([text.len()]).collect();
    let byte = |index: usize| bytes[index.min(bytes.len() - 1)];
    let (mut levels, mut entries): (Vec<Level>, Vec<Entry>) = (Vec::new(), Vec::new());
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|e| (e.marker().line() as u64, e.info().to_owned()))?;
        let at = byte(span.start.index())..byte(span.end.index());
        match event {
            Event::MappingStart(..) | Event::SequenceStart(..) => {
                let (path, _) = place(&mut levels);
                let is_mapping = matches!(event, Event::MappingStart(..));
                levels.push(Level { path, is_mapping, key: None, items: 0 });
            }
            Event::MappingEnd | Event::SequenceEnd => {
                levels.pop();
            }
            Event::Scalar(value, ..) => match levels.last_mut() {
                Some(level) if level.is_mapping && level.key.is_none() => {
                    level.key = Some((value.into_owned(), at.start))
                }
                _ => {
                    let (path, key_start) = place(&mut levels);
                    entries.push(Entry { path, key_start, at, value: value.into_owned() });
                }
            },
            Event::Alias(_) => {
                place(&mut levels);
            }
            _ => {}
        }
    }
    Ok(entries)
}

/// Returns the path of a value and the first byte of its key, and moves on to the next.
fn place(levels: &mut [Level]) -> (String, usize) {
    let Some(level) = levels.last_mut() else { return (String::new(), 0) };
    let dot = if level.path.is_empty() { "" } else { "." };
    if level.is_mapping {
        let (key, start) = level.key.take().unwrap_or_default();
        (format!("{}{dot}{key}", level.path), start)
    } else {
        level.items += 1;
        (format!("{}[{}]", level.path, level.items - 1), 0)
    }
}
