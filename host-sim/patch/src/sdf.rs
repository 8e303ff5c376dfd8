//! SDF, for gz-sim, Gazebo classic and Drake.

use std::path::Path;

use roxmltree::Node;

use super::cause::Query;
use super::edit::{Answer, Numbers};
use super::engine::{Engine, Tag};
use super::estimate::Estimate;
use super::payload::{Masses, loaded};
use super::urdf::turned_pose;
use super::wheels::{Axle, Sides, by_side};
use super::xml::{Xml, child, child_text, xpath};
use super::{gazebo, refusal};
use mindgap_foundations::error::{Error, Result};

/// Checks that a file describes one robot, and that its plug-in names joints that exist.
///
/// # Errors
/// As [`Result`] says, with the line.
pub fn check(path: &Path, xml: &Xml) -> Result<()> {
    gazebo::check(path, xml, |name| joint(xml, name).is_some())?;
    if let (Err(_), Some(include)) = (wheels(xml), xml.all("include").next()) {
        let uri = child_text(include, &["uri"]).unwrap_or_default();
        let what = format!("includes {uri}: patch that file, or expand this one with `gz sdf -p FILE > model.sdf`");
        return Err(Error::at_line(path, xml.line(include), what));
    }
    Ok(())
}

/// Returns the distance between the wheels, m, if it can be read.
pub fn track_m(xml: &Xml) -> Option<f64> {
    let (_, axle) = axle(xml, &wheels(xml).ok()?).ok()?;
    Some(axle.distance())
}

/// Returns the changes that write a cause.
///
/// # Errors
/// In words, if there is no tag for it.
pub fn changes(xml: &Xml, query: &Query) -> Answer {
    if let Some(answer) = gazebo::readings(xml, query) {
        return answer;
    }
    match query.cause.effect.as_str() {
        "motor_asymmetry" => {
            let side = query.side()?;
            let wheels = wheels(xml)?;
            radii_scaled(
                xml,
                &wheels[side],
                query.number("factor")?,
                "radius of the wheel * factor: SDF has no gain per wheel",
            )
        }
        "drive_scale" => drive_scale(xml, query.number("factor")?),
        "track_width" => track_width(xml, query.number("factor")?),
        "sonar_yaw" => Ok(vec![turned_pose(xml, gazebo::sensor(xml)?, query.number("deg")?)?]),
        "payload" => payload(xml, query),
        "rate_limit" => gazebo::acceleration(xml, gazebo::drive(xml)?, query),
        "saturation" => gazebo::speed(xml, gazebo::drive(xml)?, query),
        "inertia" => Err(
            "max_linear_acceleration and max_angular_acceleration are ramps, not a lag: filter commands in the driver"
                .into(),
        ),
        "deadband" => {
            query.obeyed(Tag::JointFriction, "friction of the joint")?;
            Err("behind a drive that enforces a speed, friction of the joint changes nothing, and SDF has no gain to convert it \
                 by: subtract the dead band in the driver"
                .into())
        }
        "slip" => Err(gazebo::slip(query)),
        "latency" => Err("SDF has no tag for it: hold commands back in a relay node".into()),
        _ => Err(refusal::no_tag("SDF")),
    }
}

/// Returns what the engine adds to the file by itself.
pub fn notes(xml: &Xml, engine: Option<Engine>) -> Vec<String> {
    let then = match engine {
        Some(Engine::Drake) | None => "SDF gives them 1 kg and 1 kg m^2",
        Some(_) => "the engine gives them a mass of its own",
    };
    gazebo::without_inertia(xml.all("link"), then).into_iter().collect()
}

fn joint<'t, 'a>(xml: &'t Xml<'a>, name: &str) -> Option<Node<'t, 'a>> {
    let own = name.rsplit("::").next();
    xml.tree
        .descendants()
        .find(|node| node.has_tag_name("joint") && node.attribute("name") == own && child(*node, "child").is_some())
}

/// Returns the joints of the driven wheels: those that the plug-in names, or else those that are called wheels.
fn wheels<'t, 'a>(xml: &'t Xml<'a>) -> std::result::Result<Sides<Node<'t, 'a>>, String> {
    if let Some(driven) = gazebo::driven(xml, |name| joint(xml, name)) {
        return Ok(driven);
    }
    let is_turning = |node: &Node| {
        child(*node, "child").is_some() && node.attribute("type").is_some_and(|kind| gazebo::TURNING.contains(&kind))
    };
    let all: Vec<Node> = xml.tree.descendants().filter(|n| n.has_tag_name("joint") && is_turning(n)).collect();
    let name = |node: &Node| node.attribute("name").unwrap_or_default().to_owned();
    let is_wheel = |node: &Node| {
        let words = name(node).to_lowercase() + &child_text(*node, &["child"]).unwrap_or_default().to_lowercase();
        words.contains("wheel") && !words.contains("caster")
    };
    let chosen: Vec<Node> = if all.len() == 2 { all } else { all.into_iter().filter(is_wheel).collect() };
    if chosen.is_empty() {
        return Err("no joint of the file is known to turn a wheel: name them in the plug-in".into());
    }
    let with_side = |node: Node<'t, 'a>| Ok((node, name(&node), place(xml, node)?.1[1]));
    by_side(chosen.into_iter().map(with_side).collect::<std::result::Result<Vec<_>, String>>()?)
}

/// Returns the link that a joint turns.
fn wheel_link<'t, 'a>(xml: &'t Xml<'a>, joint: Node<'t, 'a>) -> std::result::Result<Node<'t, 'a>, String> {
    let name = child_text(joint, &["child"]).unwrap_or_default();
    let link = joint.parent().and_then(|model| {
        model.children().find(|node| node.has_tag_name("link") && node.attribute("name") == Some(name))
    });
    let link =
        link.or_else(|| xml.tree.descendants().find(|n| n.has_tag_name("link") && n.attribute("name") == Some(name)));
    link.ok_or_else(|| format!("link {name} of {} is not in the file", xpath(joint)))
}

/// Returns the pose that places a wheel, and where: that of its link; of its joint, if the link is placed relative to that.
fn place(xml: &Xml, joint: Node) -> std::result::Result<(Numbers, [f64; 3]), String> {
    let link = wheel_link(xml, joint)?;
    let own = child(link, "pose");
    let is_on_joint = own.is_none_or(|pose| pose.attribute("relative_to") == joint.attribute("name"));
    let of_joint = child(joint, "pose").filter(|pose| is_on_joint && pose.has_attribute("relative_to"));
    let pose = of_joint.or(own).ok_or_else(|| format!("{} has no pose", xpath(link)))?;
    let numbers = xml.content(pose)?;
    let place = [numbers.value(0)?, numbers.value(1)?, numbers.value(2)?];
    Ok((numbers, place))
}

#[expect(clippy::type_complexity, reason = "poses by side, and the axle")]
fn axle(xml: &Xml, wheels: &Sides<Node>) -> std::result::Result<(Sides<(Numbers, [f64; 3])>, Axle), String> {
    let places =
        |side: usize| wheels[side].iter().map(|wheel| place(xml, *wheel)).collect::<std::result::Result<Vec<_>, _>>();
    let placed = [places(0)?, places(1)?];
    let axle = Axle::of(&[0, 1].map(|side: usize| placed[side].iter().map(|(_, place)| *place).collect()))?;
    Ok((placed, axle))
}

fn drive_scale(xml: &Xml, factor: Estimate) -> Answer {
    let wheels = wheels(xml)?;
    let both: Vec<Node> = wheels.into_iter().flatten().collect();
    let by_radius = radii_scaled(xml, &both, factor, "radius * factor; wheel_radius of the plug-in stays");
    match (by_radius, gazebo::drives(xml).first()) {
        (Err(_), Some(plugin)) => {
            let reason = "wheel_radius / factor: the wheels' own shape has no radius";
            Ok(vec![gazebo::scaled(xml, *plugin, gazebo::SIZE, factor, |f| 1.0 / f, reason)?])
        }
        (answer, _) => answer,
    }
}

/// Scales the shapes with which wheels touch the floor.
fn radii_scaled(xml: &Xml, wheels: &[Node], factor: Estimate, reason: &str) -> Answer {
    let mut changes = Vec::new();
    for wheel in wheels {
        let link = wheel_link(xml, *wheel)?;
        let round: Vec<Node> = gazebo::round_shapes(link).collect();
        if round.is_empty() {
            return Err(format!("{} has no shape with a radius", xpath(link)));
        }
        for shape in round {
            let radius = child(shape, "radius").ok_or_else(|| format!("{} has no radius", xpath(shape)))?;
            let numbers = xml.content(radius)?;
            let old = numbers.value(0)?;
            changes.push(numbers.set(&[(0, factor.map(|f| old * f))], "m", reason.into()));
        }
    }
    Ok(changes)
}

fn track_width(xml: &Xml, factor: Estimate) -> Answer {
    match (axle(xml, &wheels(xml)?), gazebo::drives(xml).first()) {
        (Ok((placed, axle)), _) => {
            let moved = placed.iter().flatten().map(|(numbers, place)| {
                let new = axle.moved(numbers.value(axle.axis)?, place[axle.axis], factor);
                let reason = "distance from the middle / factor; wheel_separation of the plug-in stays";
                Ok(numbers.set(&[(axle.axis, new)], "m", reason.into()))
            });
            moved.collect()
        }
        (Err(_), Some(plugin)) => {
            let reason = "wheel_separation * factor: the links do not show how far the wheels stand apart";
            Ok(vec![gazebo::scaled(xml, *plugin, gazebo::SEPARATION, factor, |f| f, reason)?])
        }
        (Err(why), None) => Err(why),
    }
}

/// Adds a load to the heaviest link.
fn payload(xml: &Xml, query: &Query) -> Answer {
    let mass = |inertial: Node<'_, '_>| xml.content(child(inertial, "mass")?).ok();
    let all = xml.all("inertial").filter_map(|inertial| Some((inertial, mass(inertial)?))).collect();
    let centre = |inertial: Node| child(inertial, "pose").map(|pose| xml.content(pose)).transpose();
    loaded(Masses { all, parts: "links", none: "no link of the file has a mass" }, query, centre)
}
