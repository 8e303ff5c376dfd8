//! MJCF, the format of MuJoCo.

mod attributes;
mod mount;

use std::path::Path;

use roxmltree::Node;

use self::attributes::{Source, resolved, set_on_each, users};
use super::cause::Query;
use super::edit::{Answer, Change, Edit, number};
use super::engine::Tag;
use super::estimate::Estimate;
use super::payload::{Masses, loaded};
use super::refusal;
use super::wheels::{Axle, Sides, by_side};
use super::xml::{Xml, child, xpath};
use mindgap_foundations::error::{Error, Result};
use mindgap_models::effects::parameter::ActsOn;

/// Actuators that can drive a wheel.
const DRIVES: [&str; 5] = ["velocity", "motor", "general", "intvelocity", "damper"];
/// Shapes whose first size is a radius.
const ROUND: [&str; 4] = ["sphere", "cylinder", "capsule", "ellipsoid"];
/// Length of a step where the file states none, s.
const TIMESTEP_S: f64 = 0.002;

/// A driven wheel.
#[derive(Clone, Copy)]
struct Wheel<'t, 'a> {
    actuator: Node<'t, 'a>,
    joint: Node<'t, 'a>,
    body: Node<'t, 'a>,
}

/// Checks that a file describes one robot whose wheels are driven.
///
/// # Errors
/// If it includes the file that does, has several robots, or an actuator names a joint that does not exist.
pub fn check(path: &Path, xml: &Xml) -> Result<()> {
    let include = xml.all("include").next();
    for actuator in actuators(xml) {
        let name = actuator.attribute("joint").unwrap_or_default();
        if joint(xml, name).is_none() && include.is_none() {
            let what = format!("actuator {} names joint {name}, which is not in the file", actuator.tag_name().name());
            return Err(Error::at_line(path, xml.line(actuator), what));
        }
    }
    let free = |body: &Node| {
        body.children().any(|node| node.has_tag_name("freejoint") || node.attribute("type") == Some("free"))
            && body.descendants().any(|node| actuators(xml).any(|a| is_named(node, a.attribute("joint"))))
    };
    if let Some(second) = xml.all("body").filter(free).nth(1) {
        return Err(Error::at_line(
            path,
            xml.line(second),
            "is a second robot: several robots in a file cannot be distinguished",
        ));
    }
    if let (Err(_), Some(include)) = (wheels(xml), include) {
        let file = include.attribute("file").unwrap_or_default();
        let what = format!("includes {file}: patch that file, or expand this one with mujoco.mj_saveLastXML");
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
    match query.cause.effect.as_str() {
        "motor_asymmetry" => {
            let side = query.side()?;
            gains_scaled(xml, &wheels(xml)?[side], query.number("factor")?)
        }
        "drive_scale" => drive_scale(xml, query.number("factor")?),
        "track_width" => track_width(xml, query.number("factor")?),
        "deadband" => {
            query.obeyed(Tag::FrictionLoss, "frictionloss")?;
            let all: Vec<Wheel> = wheels(xml)?.into_iter().flatten().collect();
            let gain = servo_gain(xml, &all)?;
            let added = query.wheel_rad_s(query.number("command")?).map(|rad_s| gain * rad_s);
            let joints: Vec<Node> = all.iter().map(|wheel| wheel.joint).collect();
            set_on_each(
                xml,
                &joints,
                "frictionloss",
                0.0,
                |old| added.map(|nm| old + nm),
                "N m",
                "frictionloss + kv * speed at the command",
            )
        }
        "inertia" => {
            query.obeyed(Tag::Armature, "armature")?;
            let all: Vec<Wheel> = wheels(xml)?.into_iter().flatten().collect();
            let (gain, seconds) = (servo_gain(xml, &all)?, query.seconds()?);
            let joints: Vec<Node> = all.iter().map(|wheel| wheel.joint).collect();
            set_on_each(
                xml,
                &joints,
                "armature",
                0.0,
                |old| seconds.map(|s| old + gain * s),
                "kg m^2",
                "armature + kv * time constant",
            )
        }
        "latency" => {
            query.obeyed(Tag::Delay, "delay")?;
            let seconds = query.seconds()?;
            let actuators: Vec<Node> = wheels(xml)?.iter().flatten().map(|wheel| wheel.actuator).collect();
            delayed(xml, &actuators, seconds)
        }
        "saturation" => saturation(xml, query),
        "payload" => payload(xml, query),
        "sonar_yaw" => mount::turned(xml, site(xml)?, query.number("deg")?),
        "sonar_offset" => mount::moved_back(xml, site(xml)?, query.metres("cm")?),
        "sonar_lag" => {
            query.obeyed(Tag::Delay, "delay")?;
            let lag_s = query.number("steps")?.map(|steps| steps * query.robot.step_ms / 1000.0);
            delayed(xml, &[sensor(xml)?], lag_s)
        }
        "sonar_noise" => {
            Err("noise of an MJCF sensor is a number that the simulation ignores: add noise in the driver".into())
        }
        "sonar_beam" => Err("a rangefinder has one ray: take more of them, or a camera".into()),
        "slip" => {
            let combined = query.engine.map(|engine| engine.combined_friction());
            Err(refusal::slip("friction of the wheels' geoms and of the floor", combined))
        }
        "rate_limit" => Err("MJCF has no ramp: limit how fast the driver changes ctrl".into()),
        _ => Err(refusal::no_tag("MJCF")),
    }
}

fn is_named(node: Node, name: Option<&str>) -> bool {
    name.is_some() && node.has_tag_name("joint") && node.attribute("name") == name
}

fn joint<'t, 'a>(xml: &'t Xml<'a>, name: &str) -> Option<Node<'t, 'a>> {
    xml.tree
        .descendants()
        .find(|node| is_named(*node, Some(name)) && node.parent().is_some_and(|n| !n.has_tag_name("default")))
}

/// Returns the actuators of joints.
fn actuators<'t, 'a>(xml: &'t Xml<'a>) -> impl Iterator<Item = Node<'t, 'a>> {
    let sections = xml.all("actuator").filter(|node| node.parent_element().is_some_and(|n| n.has_tag_name("mujoco")));
    let all = sections.flat_map(|section| section.children().filter(Node::is_element));
    all.filter(|node| node.has_attribute("joint"))
}

/// Returns the driven wheels: the two hinges with an actuator, or those that are called wheels.
fn wheels<'t, 'a>(xml: &'t Xml<'a>) -> std::result::Result<Sides<Wheel<'t, 'a>>, String> {
    let wheel = |actuator: Node<'t, 'a>| {
        let joint = joint(xml, actuator.attribute("joint")?)?;
        let is_hinge = resolved(xml, joint, "type").is_none_or(|source| source.value() == "hinge");
        let is_drive = DRIVES.contains(&actuator.tag_name().name());
        let body = joint.ancestors().find(|node| node.has_tag_name("body"))?;
        (is_hinge && is_drive).then_some(Wheel { actuator, joint, body })
    };
    let all: Vec<Wheel> = actuators(xml).filter_map(wheel).collect();
    let words = |wheel: &Wheel| {
        let nodes = [wheel.joint, wheel.actuator, wheel.body];
        nodes.iter().filter_map(|node| node.attribute("name")).collect::<Vec<&str>>().join(" ").to_lowercase()
    };
    let chosen: Vec<Wheel> =
        if all.len() == 2 { all } else { all.into_iter().filter(|wheel| words(wheel).contains("wheel")).collect() };
    if chosen.is_empty() {
        return Err("no actuator of the file is known to turn a wheel".into());
    }
    let name = |wheel: &Wheel| wheel.joint.attribute("name").unwrap_or_default().to_owned();
    let with_side = |wheel: Wheel<'t, 'a>| Ok((wheel, name(&wheel), place(xml, wheel.body)?[1]));
    by_side(chosen.into_iter().map(with_side).collect::<std::result::Result<Vec<_>, String>>()?)
}

/// Returns where a body or a frame is in the one around it.
fn place(xml: &Xml, body: Node) -> std::result::Result<[f64; 3], String> {
    match xml.attribute(body, "pos")? {
        Some(numbers) => Ok([numbers.value(0)?, numbers.value(1)?, numbers.value(2)?]),
        None => Ok([0.0; 3]),
    }
}

/// Returns the bodies that place the wheels in the body that all share, and where they stand in it.
#[expect(clippy::type_complexity, reason = "bodies by side, and the axle")]
fn axle<'t, 'a>(
    xml: &'t Xml<'a>,
    wheels: &Sides<Wheel<'t, 'a>>,
) -> std::result::Result<(Sides<(Node<'t, 'a>, [f64; 3])>, Axle), String> {
    let chain = |wheel: &Wheel<'t, 'a>| {
        let mut chain: Vec<Node> =
            wheel.body.ancestors().filter(|node| node.has_tag_name("body") || node.has_tag_name("frame")).collect();
        chain.reverse();
        chain
    };
    let chains = wheels.each_ref().map(|side| side.iter().map(chain).collect::<Vec<_>>());
    let all: Vec<&Vec<Node>> = chains.iter().flatten().collect();
    let shared = (0..).take_while(|i| {
        let at = |chain: &Vec<Node>| chain.get(*i).map(|node| node.id());
        all.iter().all(|chain| at(chain).is_some() && at(chain) == at(all[0]))
    });
    let shared = shared.count();
    let mut placed: Sides<(Node, [f64; 3])> = [Vec::new(), Vec::new()];
    for (side, chains) in chains.iter().enumerate() {
        for chain in chains {
            let first = chain.get(shared).ok_or("two wheels turn in one body")?;
            let mut sum = [0.0; 3];
            for body in &chain[shared..] {
                let own = place(xml, *body)?;
                sum = [0, 1, 2].map(|i| sum[i] + own[i]);
            }
            if !placed[side].iter().any(|(node, _)| node.id() == first.id()) {
                placed[side].push((*first, sum));
            }
        }
    }
    let axle = Axle::of(&[0, 1].map(|side: usize| placed[side].iter().map(|(_, place)| *place).collect()))?;
    Ok((placed, axle))
}

fn track_width(xml: &Xml, factor: Estimate) -> Answer {
    let (placed, axle) = axle(xml, &wheels(xml)?)?;
    let moved = placed.iter().flatten().map(|(body, place)| {
        let numbers = xml.attribute(*body, "pos")?.ok_or_else(|| format!("{} has no pos", xpath(*body)))?;
        let new = axle.moved(numbers.value(axle.axis)?, place[axle.axis], factor);
        Ok(numbers.set(&[(axle.axis, new)], "m", "distance from the middle / factor".into()))
    });
    moved.collect()
}

fn drive_scale(xml: &Xml, factor: Estimate) -> Answer {
    let all: Vec<Wheel> = wheels(xml)?.into_iter().flatten().collect();
    let is_round = |geom: &Node| resolved(xml, *geom, "type").is_none_or(|kind| ROUND.contains(&kind.value()));
    let touches = |geom: &Node| resolved(xml, *geom, "contype").is_none_or(|source| source.value() != "0");
    let tyres = |wheel: &Wheel<'_, '_>| {
        let geoms = wheel.body.children().filter(|node| node.has_tag_name("geom"));
        geoms.filter(|geom| is_round(geom) && touches(geom)).map(|geom| geom.id()).collect::<Vec<_>>()
    };
    let by_wheel: Vec<_> = all.iter().map(tyres).collect();
    if by_wheel.iter().any(Vec::is_empty) {
        return gains_scaled(xml, &all, factor);
    }
    let mut changes = Vec::new();
    let mut done = Vec::new();
    for geom in by_wheel.iter().flatten().filter_map(|id| xml.tree.get_node(*id)) {
        let source = resolved(xml, geom, "size").ok_or_else(|| format!("{} has no size", xpath(geom)))?;
        // A size of a class is changed once, and only if nothing but tyres has it.
        let own = |user: Node| by_wheel.iter().flatten().any(|id| *id == user.id());
        if !users(xml, &source, "geom").into_iter().all(own) {
            return Err(format!(
                "{} is the size of more than the wheels: give them a class of their own",
                source.path()
            ));
        }
        let numbers = xml.attribute(source.node, "size")?.ok_or("the geom has no size")?;
        if !done.contains(&source.node.id()) {
            done.push(source.node.id());
            let old = numbers.value(0)?;
            changes.push(numbers.set(&[(0, factor.map(|f| old * f))], "m", "radius * factor".into()));
        }
    }
    Ok(changes)
}

/// Returns the gain of the servos that hold the wheels' speeds, N m s, times the square of their gear.
fn servo_gain(xml: &Xml, wheels: &[Wheel]) -> std::result::Result<f64, String> {
    let first = wheels.first().ok_or("there is no wheel")?;
    let gear = gear(xml, first.actuator)?;
    Ok(gear * gear * gain(xml, first.actuator)?)
}

fn gear(xml: &Xml, actuator: Node) -> std::result::Result<f64, String> {
    let Some(source) = resolved(xml, actuator, "gear") else { return Ok(1.0) };
    xml.attribute(source.node, "gear")?.map_or(Ok(1.0), |numbers| numbers.value(0))
}

/// Returns the gain of a speed servo.
fn gain(xml: &Xml, actuator: Node) -> std::result::Result<f64, String> {
    let of = |name: &str, index: usize| match resolved(xml, actuator, name) {
        Some(source) => xml.attribute(source.node, name)?.map_or(Ok(None), |numbers| numbers.value(index).map(Some)),
        None => Ok(None),
    };
    let not_a_servo = || format!("{} is not a servo of speed", xpath(actuator));
    match actuator.tag_name().name() {
        "velocity" => Ok(of("kv", 0)?.unwrap_or(1.0)),
        "general" => Ok(-of("biasprm", 2)?.filter(|bias| *bias < 0.0).ok_or_else(not_a_servo)?),
        _ => Err(not_a_servo()),
    }
}

/// Scales what wheels reach per command: exactly, by a servo whose gain differs from its bias.
fn gains_scaled(xml: &Xml, wheels: &[Wheel], factor: Estimate) -> Answer {
    let scaled = |wheel: &Wheel| match wheel.actuator.tag_name().name() {
        "velocity" => weakened_servo(xml, wheel.actuator, factor),
        "general" => {
            let reason = "gainprm * factor, biasprm stays";
            let changes =
                set_on_each(xml, &[wheel.actuator], "gainprm", 1.0, |old| factor.map(|f| old * f), "N m s", reason)?;
            changes.into_iter().next().ok_or_else(|| String::from("nothing to change"))
        }
        "motor" => {
            let reason = "gear * factor: the torque per command, which only nearly scales the speed";
            let changes = set_on_each(xml, &[wheel.actuator], "gear", 1.0, |old| factor.map(|f| old * f), "", reason)?;
            changes.into_iter().next().ok_or_else(|| String::from("nothing to change"))
        }
        other => Err(format!("an actuator {other} has no gain that scales the speed of its wheel")),
    };
    wheels.iter().map(scaled).collect()
}

/// Replaces a velocity servo, which has one gain for command and speed, by a general one that has two.
fn weakened_servo(xml: &Xml, actuator: Node, factor: Estimate) -> std::result::Result<Change, String> {
    let kv = gain(xml, actuator)?;
    let new = factor.map(|f| f * kv);
    let attributes = format!("gainprm=\"{}\" biastype=\"affine\" biasprm=\"0 0 {}\"", number(new.value), number(-kv));
    let mut edits = xml.rename(actuator, "general");
    edits.push(match actuator.attribute_node("kv") {
        Some(own) => Edit { at: own.range(), text: attributes },
        None => xml.add_attributes(actuator, &attributes),
    });
    let range = actuator.range();
    let local: Vec<Edit> = edits
        .iter()
        .map(|edit| Edit { at: edit.at.start - range.start..edit.at.end - range.start, ..edit.clone() })
        .collect();
    let old = &xml.text[range];
    Ok(Change {
        tag: xpath(actuator),
        old: old.into(),
        new: super::edit::applied(old, &local),
        unit: "N m s",
        ci95: new.ci95,
        edits,
        reason: "a general servo with gainprm kv * factor and the bias of kv".into(),
    })
}

/// Sets the delay of actuators or sensors, and as many samples as it needs.
fn delayed(xml: &Xml, nodes: &[Node], added_s: Estimate) -> Answer {
    let timestep_s = match xml.all("option").find_map(|option| xml.attribute(option, "timestep").transpose()) {
        Some(numbers) => numbers?.value(0)?,
        None => TIMESTEP_S,
    };
    let reason = "delay + the time; samples for as many steps";
    let mut changes = Vec::new();
    let mut most_s: f64 = 0.0;
    changes.extend(set_on_each(
        xml,
        nodes,
        "delay",
        0.0,
        |old| {
            most_s = most_s.max(old + added_s.value);
            added_s.map(|s| old + s)
        },
        "s",
        reason,
    )?);
    let samples = (most_s / timestep_s - 1e-9).ceil() + 1.0;
    let enough = |old: f64| Estimate { value: old.max(samples), ci95: None };
    changes.extend(set_on_each(xml, nodes, "nsample", 0.0, enough, "", reason)?);
    Ok(changes)
}

fn saturation(xml: &Xml, query: &Query) -> Answer {
    if query.cause.acts_on.is_some_and(|acts_on| acts_on != ActsOn::Wheel) {
        return Err("ctrlrange limits each wheel by itself: limit both together in the driver".into());
    }
    let limit = query.wheel_rad_s(query.number("command")?);
    let mut changes = Vec::new();
    for wheel in wheels(xml)?.iter().flatten() {
        gain(xml, wheel.actuator)?;
        let gear = gear(xml, wheel.actuator)?;
        let most = limit.map(|rad_s| gear * rad_s);
        let reason = String::from("plus and minus the wheel's speed at the command");
        let own = xml.attribute(wheel.actuator, "ctrlrange")?;
        changes.push(match own {
            Some(numbers) => {
                let change = numbers.set(&[(1, most), (0, most.map(|x| -x))], "rad/s", reason);
                if numbers.values().len() == 2 {
                    change
                } else {
                    return Err(format!("{} is not a range", numbers.tag));
                }
            }
            None => {
                let text = format!("{} {}", number(-most.value), number(most.value));
                let added = xml.added_attribute(wheel.actuator, "ctrlrange", &text, "rad/s", reason);
                Change { ci95: most.ci95, ..added }
            }
        });
    }
    Ok(changes)
}

/// Adds a load to the body that holds the wheels.
fn payload(xml: &Xml, query: &Query) -> Answer {
    let parts = xml.tree.descendants().filter(|node| {
        (node.has_tag_name("geom") || node.has_tag_name("inertial"))
            && node.ancestors().all(|n| !n.has_tag_name("default"))
    });
    let all = parts.filter_map(|node| Some((node, xml.attribute(node, "mass").ok()??))).collect();
    // A geom's place is that of its shape, too.
    let centre = |node: Node| if node.has_tag_name("inertial") { xml.attribute(node, "pos") } else { Ok(None) };
    loaded(Masses { all, parts: "bodies", none: "no body of the file states its mass" }, query, centre)
}

/// Returns the range sensor.
fn sensor<'t, 'a>(xml: &'t Xml<'a>) -> std::result::Result<Node<'t, 'a>, String> {
    let sensors: Vec<Node> = xml.all("rangefinder").filter(|node| node.has_attribute("site")).collect();
    match sensors.as_slice() {
        [one] => Ok(*one),
        [] => Err("the file has no rangefinder".into()),
        several => Err(format!("the file has {} rangefinders, and the diagnosis does not say which", several.len())),
    }
}

/// Returns the site of the range sensor.
fn site<'t, 'a>(xml: &'t Xml<'a>) -> std::result::Result<Node<'t, 'a>, String> {
    let name = sensor(xml)?.attribute("site").unwrap_or_default();
    let site = xml.all("site").find(|node| node.attribute("name") == Some(name));
    site.ok_or_else(|| format!("site {name} of the rangefinder is not in the file"))
}

/// Returns an attribute of the element `compiler`.
fn compiler<'t>(xml: &'t Xml, name: &str) -> Option<&'t str> {
    let root = xml.tree.root_element();
    child(root, "compiler").and_then(|compiler| compiler.attribute(name))
}

impl Source<'_, '_> {
    /// Returns the path of the attribute's node, for messages.
    fn path(&self) -> String {
        xpath(self.node)
    }
}
