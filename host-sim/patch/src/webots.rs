//! Worlds and PROTO files of Webots.

mod syntax;

use std::path::Path;

use self::syntax::{File, Value};
use super::cause::Query;
use super::edit::{Answer, Change, Edit, Numbers, number};
use super::estimate::Estimate;
use super::orientation::{axis_and_angle, quaternion_about, turned_quaternion};
use super::refusal;
use super::wheels::{Axle, Sides, by_side};
use mindgap_foundations::error::{Error, Result};
use mindgap_models::effects::parameter::ActsOn;

/// Shapes with a radius.
const ROUND: [&str; 3] = ["Cylinder", "Sphere", "Capsule"];

/// A file of Webots.
pub struct Webots<'a> {
    text: &'a str,
    file: File,
}

/// A driven wheel: its joint, its motor and its solid, by index.
#[derive(Clone, Copy)]
struct Wheel {
    joint: usize,
    motor: usize,
    solid: usize,
}

impl<'a> Webots<'a> {
    /// Parses a file.
    ///
    /// # Errors
    /// With the line, if its braces do not match, or if it is a template.
    pub fn parse(path: &Path, text: &'a str) -> Result<Self> {
        let line = |at: usize| 1 + text.as_bytes()[..at.min(text.len())].iter().filter(|b| **b == b'\n').count() as u64;
        let file = File::parse(text).map_err(|(at, what)| Error::at_line(path, line(at), what))?;
        let robots = file.all("Robot").collect::<Vec<usize>>();
        if let Some(second) = robots.get(1) {
            let what = "is a second robot: several robots in a file cannot be distinguished";
            return Err(Error::at_line(path, line(file.nodes[*second].open), what));
        }
        Ok(Webots { text, file })
    }

    /// Returns the distance between the wheels, m, if it can be read.
    pub fn track_m(&self) -> Option<f64> {
        Some(self.axle(&self.wheels().ok()?).ok()?.distance())
    }

    /// Returns the changes that write a cause.
    ///
    /// # Errors
    /// In words, if there is no field for it.
    pub fn changes(&self, query: &Query) -> Answer {
        match query.cause.effect.as_str() {
            "motor_asymmetry" => {
                let wheels = self.wheels()?;
                let (side, factor) = (query.side()?, query.number("factor")?);
                let others = self.shapes(&wheels[1 - side])?;
                let own = self.shapes(&wheels[side])?;
                if own.iter().any(|shape| others.contains(shape)) {
                    return Err(
                        "both wheels share one shape: give each its own, or scale the speed in the controller".into()
                    );
                }
                self.scaled(&own, factor, "radius of the wheel * factor: Webots has no gain per motor")
            }
            "drive_scale" => {
                let both: Vec<Wheel> = self.wheels()?.into_iter().flatten().collect();
                self.scaled(&self.shapes(&both)?, query.number("factor")?, "radius * factor")
            }
            "track_width" => self.track_width(query.number("factor")?),
            "saturation" if query.cause.acts_on.is_none_or(|acts_on| acts_on == ActsOn::Wheel) => {
                let limit = query.wheel_rad_s(query.number("command")?);
                self.motors("maxVelocity", limit, "rad/s", "speed of the wheel at the command")
            }
            "rate_limit" if query.cause.acts_on == Some(ActsOn::Wheel) => {
                let radius_cm = query.robot.wheel_diameter_cm / 2.0;
                let limit = query.number("cm_s2")?.map(|cm_s2| cm_s2 / radius_cm);
                self.motors("acceleration", limit, "rad/s^2", "limit on the acceleration at the rim / radius")
            }
            "saturation" | "rate_limit" => {
                Err("motors limit each wheel by itself: limit both together in the controller".into())
            }
            "payload" => self.payload(query),
            "sonar_yaw" => self.sonar_yaw(query.number("deg")?),
            "sonar_beam" => {
                let factor = query.number("factor")?;
                Ok(vec![self.set(
                    self.sensor()?,
                    "aperture",
                    &[std::f64::consts::FRAC_PI_2],
                    &[(0, factor)],
                    |old, f| old * f,
                    "rad",
                    "aperture * factor",
                )?])
            }
            "sonar_scale" => self.table(1, query.number("factor")?, |row, f| row[1] * f, "second column * factor"),
            "sonar_offset" => {
                let per_m = self.value_per_m()?;
                self.table(1, query.metres("cm")?, |row, m| row[1] + m * per_m, "second column + cm / 100")
            }
            "sonar_noise" => {
                let per_m = self.value_per_m()?;
                let noise = |row: [f64; 3], m: f64| {
                    if row[1] == 0.0 { row[2] } else { libm::hypot(row[2], m * per_m / row[1]) }
                };
                self.table(2, query.metres("cm")?, noise, "third column, a share of the value, in quadrature")
            }
            "slip" => {
                Err(refusal::slip("coulombFriction and forceDependentSlip of ContactProperties in the world", None))
            }
            "deadband" => Err(
                "staticFriction of the joint is a torque, and Webots has no gain to convert it by: measure the torque \
                               that just turns a wheel, or subtract the dead band in the controller"
                    .into(),
            ),
            "latency" => Err("Webots has no field for it: hold commands back in the controller".into()),
            "inertia" => Err("acceleration of a motor is a ramp, not a lag: filter commands in the controller".into()),
            "sonar_lag" => {
                Err("the sampling period of a sensor is set by the controller, in wb_distance_sensor_enable".into())
            }
            _ => Err(refusal::no_tag("Webots")),
        }
    }

    /// Returns the numbers of a field, where they are defined.
    fn numbers(&self, node: usize, name: &str) -> std::result::Result<Option<Numbers>, String> {
        let path = format!("{}.{name}", self.file.nodes[node].path);
        match self.file.field(node, name) {
            None => Ok(None),
            Some(Value::Numbers(at)) => Numbers::parse(self.text, at.clone(), path).map(Some),
            Some(Value::Is(field)) => match self.file.interface.iter().find(|(own, _)| own == field) {
                Some((_, Value::Numbers(at))) => {
                    Numbers::parse(self.text, at.clone(), format!("fields.{field}")).map(Some)
                }
                _ => Err(format!("{path} is field {field} of the PROTO, which is not a number")),
            },
            Some(_) => Err(format!("{path} is not a number")),
        }
    }

    /// Changes numbers of a field, or adds it if it has its default.
    #[expect(clippy::too_many_arguments, reason = "a field, its default, and its change")]
    fn set(
        &self,
        node: usize,
        name: &str,
        default: &[f64],
        new: &[(usize, Estimate)],
        change: impl Fn(f64, f64) -> f64,
        unit: &'static str,
        reason: &str,
    ) -> std::result::Result<Change, String> {
        if let Some(numbers) = self.numbers(node, name)? {
            let changed = new.iter().map(|(index, estimate)| {
                let old = numbers.value(*index)?;
                Ok((*index, estimate.map(|x| change(old, x))))
            });
            return Ok(numbers.set(&changed.collect::<std::result::Result<Vec<_>, String>>()?, unit, reason.into()));
        }
        let mut values = default.to_vec();
        let mut ci95 = None;
        for (index, estimate) in new.iter().rev() {
            let changed = estimate.map(|x| change(default[*index], x));
            (values[*index], ci95) = (changed.value, changed.ci95);
        }
        let text = values.iter().map(|x| number(*x)).collect::<Vec<String>>().join(" ");
        Ok(self.added(node, name, text, ci95, unit, reason))
    }

    fn added(
        &self,
        node: usize,
        name: &str,
        new: String,
        ci95: Option<[f64; 2]>,
        unit: &'static str,
        reason: &str,
    ) -> Change {
        let node = &self.file.nodes[node];
        let blank = if self.text[node.open..].starts_with(char::is_whitespace) { "" } else { " " };
        Change {
            tag: format!("{}.{name}", node.path),
            old: String::new(),
            edits: vec![Edit { at: node.open..node.open, text: format!(" {name} {new}{blank}") }],
            new,
            unit,
            ci95,
            reason: format!("{reason}; there was none"),
        }
    }

    /// Returns the driven wheels: hinges with a motor.
    fn wheels(&self) -> std::result::Result<Sides<Wheel>, String> {
        let file = &self.file;
        let wheel = |joint: usize| {
            let motor =
                file.nodes_of(joint, "device").into_iter().find(|d| file.nodes[*d].kind == "RotationalMotor")?;
            let solid = *file.nodes_of(joint, "endPoint").first()?;
            Some(Wheel { joint, motor, solid })
        };
        let all: Vec<Wheel> = file.all("HingeJoint").filter_map(wheel).collect();
        let name = |wheel: &Wheel| {
            let of = |node: usize| match file.field(node, "name") {
                Some(Value::Text(name)) => name.clone(),
                _ => String::new(),
            };
            format!("{} {}", of(wheel.motor), of(wheel.solid)).to_lowercase()
        };
        let chosen: Vec<Wheel> =
            if all.len() == 2 { all } else { all.into_iter().filter(|w| name(w).contains("wheel")).collect() };
        if chosen.is_empty() {
            return Err("no HingeJoint with a RotationalMotor is known to turn a wheel".into());
        }
        let with_side = |wheel: Wheel| Ok((wheel, name(&wheel), self.place(wheel)?[1]));
        by_side(chosen.into_iter().map(with_side).collect::<std::result::Result<Vec<_>, String>>()?)
    }

    /// Returns where a wheel is.
    fn place(&self, wheel: Wheel) -> std::result::Result<[f64; 3], String> {
        let of_solid = self.numbers(wheel.solid, "translation")?;
        let numbers = of_solid.ok_or_else(|| format!("{} has no translation", self.file.nodes[wheel.solid].path))?;
        Ok([numbers.value(0)?, numbers.value(1)?, numbers.value(2)?])
    }

    fn axle(&self, wheels: &Sides<Wheel>) -> std::result::Result<Axle, String> {
        let places = |side: usize| {
            wheels[side].iter().map(|wheel| self.place(*wheel)).collect::<std::result::Result<Vec<_>, _>>()
        };
        Axle::of(&[places(0)?, places(1)?])
    }

    fn track_width(&self, factor: Estimate) -> Answer {
        let wheels = self.wheels()?;
        let axle = self.axle(&wheels)?;
        let mut changes: Vec<Change> = Vec::new();
        for wheel in wheels.iter().flatten() {
            let parameters = self.file.nodes_of(wheel.joint, "jointParameters");
            let anchor = parameters.first().map(|node| (*node, "anchor"));
            for (node, name) in anchor.into_iter().chain([(wheel.solid, "translation")]) {
                let Some(numbers) = self.numbers(node, name)? else { continue };
                let own = numbers.value(axle.axis)?;
                let change = numbers.set(
                    &[(axle.axis, axle.moved(own, own, factor))],
                    "m",
                    "distance from the middle / factor".into(),
                );
                if !changes.contains(&change) {
                    changes.push(change);
                }
            }
        }
        Ok(changes)
    }

    /// Returns the shapes with which wheels touch the floor.
    fn shapes(&self, wheels: &[Wheel]) -> std::result::Result<Vec<usize>, String> {
        let mut shapes = Vec::new();
        for wheel in wheels {
            let mut open = self.file.nodes_of(wheel.solid, "boundingObject");
            let mut found = false;
            while let Some(node) = open.pop() {
                if ROUND.contains(&self.file.nodes[node].kind.as_str()) {
                    found = true;
                    if !shapes.contains(&node) {
                        shapes.push(node);
                    }
                }
                open.extend(
                    ["children", "geometry"]
                        .iter()
                        .flat_map(|name| self.file.nodes_of(node, name))
                        .filter(|n| *n > node),
                );
            }
            if !found {
                return Err(format!("boundingObject of {} has no radius", self.file.nodes[wheel.solid].path));
            }
        }
        Ok(shapes)
    }

    fn scaled(&self, shapes: &[usize], factor: Estimate, reason: &str) -> Answer {
        let mut changes: Vec<Change> = Vec::new();
        for shape in shapes {
            let numbers = self.numbers(*shape, "radius")?.ok_or("the wheel's shape states no radius")?;
            let old = numbers.value(0)?;
            let change = numbers.set(&[(0, factor.map(|f| old * f))], "m", reason.into());
            if !changes.contains(&change) {
                changes.push(change);
            }
        }
        Ok(changes)
    }

    fn motors(&self, name: &str, limit: Estimate, unit: &'static str, reason: &str) -> Answer {
        let wheels = self.wheels()?;
        wheels
            .iter()
            .flatten()
            .map(|wheel| self.set(wheel.motor, name, &[0.0], &[(0, limit)], |_, new| new, unit, reason))
            .collect()
    }

    fn sensor(&self) -> std::result::Result<usize, String> {
        let sensors: Vec<usize> = self.file.all("DistanceSensor").collect();
        match sensors.as_slice() {
            [one] => Ok(*one),
            [] => Err("the file has no DistanceSensor".into()),
            several => {
                Err(format!("the file has {} distance sensors, and the diagnosis does not say which", several.len()))
            }
        }
    }

    fn sonar_yaw(&self, deg: Estimate) -> Answer {
        let sensor = self.sensor()?;
        let old = self.numbers(sensor, "rotation")?.map(|numbers| numbers.values()).unwrap_or(vec![0.0, 0.0, 1.0, 0.0]);
        let [x, y, z, angle] = old[..] else { return Err("rotation of the sensor is not four numbers".into()) };
        let turned = |deg: f64| axis_and_angle(turned_quaternion(quaternion_about([x, y, z], angle), deg.to_radians()));
        let (axis, _) = turned(deg.value);
        let fixed = |value: f64| Estimate { value, ci95: None };
        // About the vertical, the axis may point either way.
        let sign = if axis[2] < 0.0 && axis[0].abs() + axis[1].abs() < 1e-9 { -1.0 } else { 1.0 };
        let new_angle = Estimate { value: sign * turned(deg.value).1, ci95: None };
        let ends = deg.map(|d| new_angle.value + (d - deg.value).to_radians()).ci95;
        let new = [
            (3, Estimate { ci95: ends, ..new_angle }),
            (0, fixed(sign * axis[0])),
            (1, fixed(sign * axis[1])),
            (2, fixed(sign * axis[2])),
        ];
        Ok(vec![self.set(
            sensor,
            "rotation",
            &[0.0, 0.0, 1.0, 0.0],
            &new,
            |_, x| x,
            "rad",
            "turned by deg about the vertical",
        )?])
    }

    /// Changes a column of the sensor's table of distance, value and noise.
    fn table(&self, column: usize, by: Estimate, change: impl Fn([f64; 3], f64) -> f64, reason: &str) -> Answer {
        let numbers = self.lookup_table()?;
        let values = numbers.values();
        let new = values.chunks_exact(3).enumerate().map(|(row, own)| {
            let own = [own[0], own[1], own[2]];
            (3 * row + column, by.map(|x| change(own, x)))
        });
        let new: Vec<(usize, Estimate)> = new.collect();
        Ok(vec![numbers.set(&new, "", reason.into())])
    }

    fn lookup_table(&self) -> std::result::Result<Numbers, String> {
        self.numbers(self.sensor()?, "lookupTable")?
            .ok_or_else(|| "the sensor has no lookupTable: write one first".into())
    }

    /// Returns by how much the value of a reading grows per metre, if that is the same everywhere.
    fn value_per_m(&self) -> std::result::Result<f64, String> {
        let values = self.lookup_table()?.values();
        let rows: Vec<&[f64]> = values.chunks_exact(3).collect();
        let slopes: Vec<f64> = rows.windows(2).map(|w| (w[1][1] - w[0][1]) / (w[1][0] - w[0][0])).collect();
        match slopes.first() {
            Some(first) if first.is_finite() && slopes.iter().all(|s| (s - first).abs() <= 1e-6 * first.abs()) => {
                Ok(*first)
            }
            _ => Err("lookupTable is not a straight line, so a length is not one number in it".into()),
        }
    }

    fn payload(&self, query: &Query) -> Answer {
        let Ok(share) = query.number("mass_share") else { return Err(refusal::LOAD_WITHOUT_MASS.into()) };
        let mut masses = Vec::new();
        for node in self.file.all("Physics") {
            if let Some(numbers) = self.numbers(node, "mass")? {
                masses.push((numbers.value(0)?, node));
            }
        }
        let total_kg: f64 = masses.iter().map(|(kg, _)| kg).sum();
        let heaviest = masses.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (_, node) = heaviest.ok_or("no solid of the file states its mass")?;
        let reason = "mass + mass_share * mass of all solids";
        Ok(vec![self.set(*node, "mass", &[0.0], &[(0, share)], |kg, share| kg + share * total_kg, "kg", reason)?])
    }
}
