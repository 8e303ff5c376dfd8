//! Gazebo's plug-in of a differential drive and its ray sensor, which URDF and SDF share.

use std::path::Path;

use roxmltree::Node;

use super::cause::Query;
use super::edit::{Answer, Change, number};
use super::estimate::Estimate;
use super::refusal;
use super::wheels::Sides;
use super::xml::{Xml, child, child_text, xpath};
use mindgap_foundations::error::{self, Error};
use mindgap_models::effects::parameter::ActsOn;

/// Elements of a plug-in that name joints, per side: in all spellings since the first versions.
const JOINTS: [&[&str]; 2] = [
    &["left_joint", "leftJoint", "leftFrontJoint", "leftRearJoint", "left_front_joint", "left_rear_joint"],
    &["right_joint", "rightJoint", "rightFrontJoint", "rightRearJoint", "right_front_joint", "right_rear_joint"],
];
/// Elements of a plug-in with the distance between the wheels, m.
pub const SEPARATION: &[&str] = &["wheel_separation", "wheelSeparation"];
/// Elements of a plug-in with the wheels' diameter or radius, m.
pub const SIZE: &[&str] = &["wheel_diameter", "wheelDiameter", "wheel_radius"];
/// Types of sensors that cast rays.
const RAYS: [&str; 5] = ["ray", "gpu_ray", "lidar", "gpu_lidar", "range"];
/// Elements that describe the rays.
const RAY_ELEMENTS: [&str; 2] = ["ray", "lidar"];

/// Types of joints that wheels turn on.
pub const TURNING: [&str; 2] = ["continuous", "revolute"];
/// Shapes with a radius.
const ROUND: [&str; 3] = ["cylinder", "sphere", "capsule"];

/// Checks that a file describes one robot, and that its plug-in names joints that exist.
///
/// # Errors
/// If it does not; the error names the line.
pub fn check(path: &Path, xml: &Xml, has_joint: impl Fn(&str) -> bool) -> error::Result<()> {
    let drives = drives(xml);
    if let Some(second) = drives.get(1) {
        let what = "has a second plug-in that drives wheels: several robots in a file cannot be distinguished";
        return Err(Error::at_line(path, xml.line(*second), what));
    }
    for named in drives.first().map(|plugin| joints(*plugin)).into_iter().flatten().flatten() {
        let name = named.text().unwrap_or_default().trim();
        if !has_joint(name) {
            let what = format!("{} names joint {name}, which is not in the file", named.tag_name().name());
            return Err(Error::at_line(path, xml.line(named), what));
        }
    }
    Ok(())
}

/// Returns the plug-in that drives wheels.
///
/// # Errors
/// In words, if there is none.
pub fn drive<'t, 'a>(xml: &'t Xml<'a>) -> Result<Node<'t, 'a>, String> {
    drives(xml).first().copied().ok_or_else(|| "the file has no plug-in of the drive".into())
}

/// Returns the joints that the plug-in drives; `None` without a plug-in. `joint` finds a joint by its name.
pub fn driven<'t, 'a>(xml: &'t Xml<'a>, joint: impl Fn(&str) -> Option<Node<'t, 'a>>) -> Option<Sides<Node<'t, 'a>>> {
    let named = joints(drive(xml).ok()?);
    Some(named.map(|side| side.iter().filter_map(|node| joint(node.text().unwrap_or_default().trim())).collect()))
}

/// Returns the shapes with a radius with which a link touches others.
pub fn round_shapes<'t, 'a>(link: Node<'t, 'a>) -> impl Iterator<Item = Node<'t, 'a>> {
    let shapes = link.children().filter(|node| node.has_tag_name("collision"));
    let shapes = shapes.filter_map(|node| child(node, "geometry")?.children().find(Node::is_element));
    shapes.filter(|shape| ROUND.contains(&shape.tag_name().name()))
}

/// Returns a note on the links that state no inertia, to which the engine `then` gives one; `None` if all do.
pub fn without_inertia<'t, 'a: 't>(links: impl Iterator<Item = Node<'t, 'a>>, then: &str) -> Option<String> {
    let links = links.filter(|link| child(*link, "inertial").is_none());
    let names: Vec<&str> = links.filter_map(|link| link.attribute("name")).collect();
    (!names.is_empty()).then(|| {
        format!("links without inertial: {}; {then}, so the simulator's lag of turns may be its own", names.join(", "))
    })
}

/// Returns the plug-ins that drive wheels.
pub fn drives<'t, 'a>(xml: &'t Xml<'a>) -> Vec<Node<'t, 'a>> {
    xml.all("plugin").filter(|plugin| joints(*plugin).iter().all(|side| !side.is_empty())).collect()
}

/// Returns the names of the joints that a plug-in drives.
fn joints<'t>(plugin: Node<'t, '_>) -> Sides<Node<'t, 't>> {
    JOINTS.map(|names| plugin.children().filter(|node| names.contains(&node.tag_name().name())).collect())
}

/// Returns the change that multiplies a number of a plug-in by `f` of the factor.
///
/// # Errors
/// In words, if there is no such element.
pub fn scaled(
    xml: &Xml,
    plugin: Node,
    names: &[&str],
    factor: Estimate,
    scale: impl Fn(f64) -> f64,
    reason: &str,
) -> Result<Change, String> {
    let node = names.iter().find_map(|name| child(plugin, name));
    let node = node.ok_or_else(|| format!("the plug-in has no {}", names[0]))?;
    let numbers = xml.content(node)?;
    let old = numbers.value(0)?;
    Ok(numbers.set(&[(0, factor.map(|f| old * scale(f)))], "m", reason.into()))
}

/// Writes a limit on acceleration: per wheel for the classic plug-in, of the twist for that of gz-sim.
///
/// # Errors
/// In words, if the plug-in has none of this kind.
pub fn acceleration(xml: &Xml, plugin: Node, query: &Query) -> Answer {
    let is_classic = child(plugin, "max_linear_acceleration").is_none()
        && plugin.attribute("filename").is_some_and(|file| file.contains("gazebo_ros"));
    let linear = query.metres("cm_s2")?;
    match (query.cause.acts_on, is_classic) {
        (Some(ActsOn::Twist), false) => {
            let angular = query.number("deg_s2")?.map(f64::to_radians);
            Ok(vec![
                set_or_add(
                    xml,
                    plugin,
                    &["max_linear_acceleration"],
                    linear,
                    "m/s^2",
                    "limit on the forward acceleration",
                )?,
                set_or_add(
                    xml,
                    plugin,
                    &["max_angular_acceleration"],
                    angular,
                    "rad/s^2",
                    "limit on the acceleration of turns",
                )?,
            ])
        }
        (Some(ActsOn::Wheel), true) => {
            let names = ["max_wheel_acceleration", "wheelAcceleration"];
            Ok(vec![set_or_add(xml, plugin, &names, linear, "m/s^2", "limit on the acceleration at the rim")?])
        }
        (_, true) => {
            Err("the plug-in limits the acceleration of each wheel, not that of the twist: limit it in the driver"
                .into())
        }
        (_, false) => {
            Err("the plug-in limits the acceleration of the twist, not that of each wheel: limit it in the driver"
                .into())
        }
    }
}

/// Writes a limit on the speed of the twist.
///
/// # Errors
/// In words, if the plug-in has none of this kind.
pub fn speed(xml: &Xml, plugin: Node, query: &Query) -> Answer {
    if query.cause.acts_on != Some(ActsOn::Twist) {
        return Err(
            "max_linear_velocity of the plug-in limits the twist, not a wheel: limit wheels in the driver".into()
        );
    }
    let linear = query.number("command")?.map(|command| command / 100.0 * query.robot.full_speed_cm_s / 100.0);
    let angular = query.number("turn_deg_s")?.map(f64::to_radians);
    let mut changes = Vec::new();
    for (name, limit, unit) in [("linear", linear, "m/s"), ("angular", angular, "rad/s")] {
        let [least, most] = [format!("min_{name}_velocity"), format!("max_{name}_velocity")];
        changes.push(set_or_add(
            xml,
            plugin,
            &[&least],
            limit.map(|x| -x),
            unit,
            "limit on the speed of the twist, backwards",
        )?);
        changes.push(set_or_add(xml, plugin, &[&most], limit, unit, "limit on the speed of the twist")?);
    }
    Ok(changes)
}

/// Sets the number that an element contains, or adds it under the first of these names.
fn set_or_add(
    xml: &Xml,
    parent: Node,
    names: &[&str],
    value: Estimate,
    unit: &'static str,
    reason: &str,
) -> Result<Change, String> {
    match names.iter().find_map(|name| child(parent, name)) {
        Some(node) => Ok(xml.content(node)?.set(&[(0, value)], unit, reason.into())),
        None => Ok(Change {
            tag: format!("{}/{}", xpath(parent), names[0]),
            old: String::new(),
            new: number(value.value),
            unit,
            ci95: value.ci95,
            edits: vec![xml.add_elements(parent, &format!("<{0}>{1}</{0}>", names[0], number(value.value)))],
            reason: format!("{reason}; there was none"),
        }),
    }
}

/// Returns the sensor that casts rays.
///
/// # Errors
/// In words, if there is none, or several.
pub fn sensor<'t, 'a>(xml: &'t Xml<'a>) -> Result<Node<'t, 'a>, String> {
    let is_ray = |node: &Node| node.attribute("type").is_some_and(|kind| RAYS.contains(&kind));
    let sensors: Vec<Node> = xml.all("sensor").filter(is_ray).collect();
    match sensors.as_slice() {
        [one] => Ok(*one),
        [] => Err("the file has no ray sensor".into()),
        several => Err(format!("the file has {} ray sensors, and the diagnosis does not say which", several.len())),
    }
}

/// Writes a cause that sits in the readings of the ray sensor; `None` for other causes.
pub fn readings(xml: &Xml, query: &Query) -> Option<Answer> {
    let known = ["sonar_offset", "sonar_noise", "sonar_beam", "sonar_lag", "sonar_scale"];
    known.contains(&query.cause.effect.as_str()).then(|| {
        let sensor = sensor(xml)?;
        match query.cause.effect.as_str() {
            "sonar_offset" => noise(xml, sensor, "mean", query.metres("cm")?, |old, m| old + m, "mean + cm / 100"),
            "sonar_noise" => {
                let added = query.metres("cm")?;
                noise(xml, sensor, "stddev", added, libm::hypot, "stddev and cm / 100 in quadrature")
            }
            "sonar_beam" => beam(xml, sensor, query.number("factor")?),
            "sonar_lag" => age(xml, sensor, query),
            _ => Err("a ray sensor has noise of a length, and no factor: multiply readings in the driver".into()),
        }
    })
}

/// Changes a number of the sensor's noise, which is 0 where it is missing.
fn noise(
    xml: &Xml,
    sensor: Node,
    name: &str,
    number_m: Estimate,
    change: impl Fn(f64, f64) -> f64,
    reason: &str,
) -> Answer {
    let ray =
        RAY_ELEMENTS.iter().find_map(|name| child(sensor, name)).ok_or("the sensor has no element ray or lidar")?;
    let Some(noise) = child(ray, "noise") else {
        let new = number_m.map(|m| change(0.0, m));
        let [mean, stddev] = if name == "mean" { [new.value, 0.0] } else { [0.0, new.value] };
        let element = format!(
            "<noise><type>gaussian</type><mean>{}</mean><stddev>{}</stddev></noise>",
            number(mean),
            number(stddev)
        );
        return Ok(vec![Change {
            tag: format!("{}/noise/{name}", xpath(ray)),
            old: String::new(),
            new: number(new.value),
            unit: "m",
            ci95: new.ci95,
            edits: vec![xml.add_elements(ray, &element)],
            reason: format!("{reason}; there was no noise"),
        }]);
    };
    if noise.attribute("type").or(child_text(noise, &["type"])) == Some("none") {
        return Err(format!("{} has type none: make it gaussian first", xpath(noise)));
    }
    let old = match child(noise, name) {
        Some(node) => xml.content(node)?.value(0)?,
        None => 0.0,
    };
    Ok(vec![set_or_add(xml, noise, &[name], number_m.map(|m| change(old, m)), "m", reason)?])
}

fn beam(xml: &Xml, sensor: Node, factor: Estimate) -> Answer {
    let horizontal = RAY_ELEMENTS.iter().find_map(|name| child(child(child(sensor, name)?, "scan")?, "horizontal"));
    let horizontal = horizontal.ok_or("the sensor has no horizontal scan")?;
    ["min_angle", "max_angle"]
        .into_iter()
        .map(|name| {
            let node = child(horizontal, name).ok_or_else(|| format!("the scan has no {name}"))?;
            let numbers = xml.content(node)?;
            let old = numbers.value(0)?;
            Ok(numbers.set(&[(0, factor.map(|f| old * f))], "rad", format!("{name} * factor")))
        })
        .collect()
}

/// A reading that is held for a period is half a period old in the mean.
fn age(xml: &Xml, sensor: Node, query: &Query) -> Answer {
    let lag_s = query.number("steps")?.map(|steps| steps * query.robot.step_ms / 1000.0);
    let rate = child(sensor, "update_rate").ok_or("the sensor has no update_rate")?;
    let numbers = xml.content(rate)?;
    let old_hz = numbers.value(0)?;
    let period_s = if old_hz > 0.0 { 1.0 / old_hz } else { 0.0 };
    let new = lag_s.map(|lag_s| 1.0 / (period_s + 2.0 * lag_s));
    Ok(vec![numbers.set(
        &[(0, new)],
        "Hz",
        "1 / (1 / update_rate + 2 lag): held readings are half a period old".into(),
    )])
}

/// Returns the reason for slip.
pub fn slip(query: &Query) -> String {
    let tags = "mu1 and mu2 of the wheels (ode mu in SDF), and those of the floor";
    refusal::slip(tags, query.engine.map(|engine| engine.combined_friction()))
}
