//! URDF, with Gazebo's tags.

use std::path::Path;

use roxmltree::Node;

use super::cause::Query;
use super::edit::{Answer, Change, Numbers, number};
use super::engine::{Engine, Tag};
use super::estimate::Estimate;
use super::orientation::{Sequence, about, times};
use super::payload::{Masses, loaded};
use super::wheels::{Axle, Sides, by_side};
use super::xml::{Xml, child, xpath};
use super::{gazebo, refusal};
use mindgap_foundations::error::{Error, Result};

/// Checks that a file is whole, and describes one robot.
///
/// # Errors
/// If it is xacro, or if its plug-in names joints that do not exist.
pub fn check(path: &Path, xml: &Xml) -> Result<()> {
    refuse_xacro(path, xml)?;
    gazebo::check(path, xml, |name| joint(xml, name).is_some())
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
        "drive_scale" => drive_scale(xml, query.number("factor")?),
        "track_width" => track_width(xml, query.number("factor")?),
        "sonar_yaw" => sonar_yaw(xml, query.number("deg")?),
        "payload" => payload(xml, query),
        "rate_limit" => gazebo::acceleration(xml, gazebo::drive(xml)?, query),
        "motor_asymmetry" => {
            Err("neither URDF nor its plug-in has a gain per wheel, and another radius tilts the robot: scale \
                                  that wheel's speed in the driver, or left_wheel_radius_multiplier of ros2_control"
                .into())
        }
        "inertia" => Err("max_wheel_acceleration is a ramp, not a lag: filter commands in the driver".into()),
        "deadband" => {
            query.obeyed(Tag::JointFriction, "dynamics friction")?;
            Err("behind a drive that enforces a speed, dynamics friction changes nothing, and URDF has no gain to convert it \
                 by: subtract the dead band in the driver"
                .into())
        }
        "saturation" => match gazebo::drive(xml).and_then(|plugin| gazebo::speed(xml, plugin, query)) {
            Ok(changes) if is_of_gz_sim(xml) => Ok(changes),
            _ => Err("no engine acts on limit velocity: limit the speed in the driver".into()),
        },
        "slip" => Err(gazebo::slip(query)),
        "latency" => Err("URDF has no tag for it: hold commands back in a relay node".into()),
        _ => Err(refusal::no_tag("URDF")),
    }
}

/// Returns what the engine adds to the file by itself, which must not be taken for the robot's.
pub fn notes(xml: &Xml, engine: Option<Engine>) -> Vec<String> {
    let root = xml.tree.root_element();
    let links = root.children().filter(|node| node.has_tag_name("link"));
    let then = match engine {
        Some(Engine::MuJoCo | Engine::Newton) => "the engine gives them the mass of their shape at 1000 kg/m^3",
        Some(Engine::PyBullet) => "the engine gives them 1 kg, and 1 kg m^2 with the flag that reads inertias",
        Some(Engine::Drake | Engine::Genesis) => "the engine gives them no mass",
        Some(Engine::Dart) => "the engine gives them 1 kg and 1 kg m^2",
        _ => "engines give them 0 to 1 kg and up to 1 kg m^2",
    };
    let mut notes: Vec<String> = gazebo::without_inertia(links, then).into_iter().collect();
    if engine == Some(Engine::PyBullet) {
        notes.push(
            "PyBullet brakes each link by 0.04 (1 + |w|) per second unless angularDamping is 0, and limits joints to 100 rad/s: \
             set these before friction or damping"
                .into(),
        );
    }
    notes
}

/// The plug-in of gz-sim has limits on speed.
fn is_of_gz_sim(xml: &Xml) -> bool {
    gazebo::drives(xml).iter().any(|plugin| {
        plugin.attribute("filename").is_some_and(|file| file.contains("gz-sim") || file.contains("ignition"))
    })
}

fn refuse_xacro(path: &Path, xml: &Xml) -> Result<()> {
    let is_xacro = |node: &Node| node.tag_name().namespace().is_some_and(|uri| uri.contains("xacro"));
    let in_attribute = |node: &Node| node.attributes().any(|attribute| attribute.value().contains("${"));
    let in_text = |node: &Node| node.text().is_some_and(|text| text.contains("${"));
    let uses = |node: &Node| is_xacro(node) || node.is_element() && (in_attribute(node) || in_text(node));
    let Some(first) = xml.tree.descendants().find(uses) else { return Ok(()) };
    let properties: Vec<String> = xml
        .tree
        .descendants()
        .filter(|node| is_xacro(node) && node.tag_name().name() == "property")
        .filter_map(|node| Some(format!("{} in line {}", node.attribute("name")?, xml.line(node))))
        .collect();
    let defined =
        if properties.is_empty() { String::new() } else { format!(" (properties: {})", properties.join(", ")) };
    let what = format!(
        "is xacro: expand it with `xacro FILE > robot.urdf` and patch that, then change the properties{defined}"
    );
    Err(Error::at_line(path, xml.line(first), what))
}

fn joint<'t, 'a>(xml: &'t Xml<'a>, name: &str) -> Option<Node<'t, 'a>> {
    let root = xml.tree.root_element();
    root.children().find(|node| node.has_tag_name("joint") && node.attribute("name").map(str::trim) == Some(name))
}

fn link<'t, 'a>(xml: &'t Xml<'a>, name: &str) -> Option<Node<'t, 'a>> {
    let root = xml.tree.root_element();
    root.children().find(|node| node.has_tag_name("link") && node.attribute("name") == Some(name))
}

/// Returns the joints of the driven wheels: those that the plug-in names, or else all continuous and revolute ones.
fn wheels<'t, 'a>(xml: &'t Xml<'a>) -> std::result::Result<Sides<Node<'t, 'a>>, String> {
    if let Some(driven) = gazebo::driven(xml, |name| joint(xml, name)) {
        return Ok(driven);
    }
    let root = xml.tree.root_element();
    let turning = root.children().filter(|node| {
        node.has_tag_name("joint") && node.attribute("type").is_some_and(|kind| gazebo::TURNING.contains(&kind))
    });
    let name = |node: &Node| node.attribute("name").unwrap_or_default().to_owned();
    let all: Vec<Node> = turning.collect();
    // Casters turn, too.
    let called =
        |word: &str| all.iter().filter(|node| name(node).to_lowercase().contains(word)).copied().collect::<Vec<Node>>();
    let chosen = if all.len() == 2 { all.clone() } else { called("wheel") };
    let chosen: Vec<Node> = chosen.into_iter().filter(|node| !name(node).to_lowercase().contains("caster")).collect();
    let with_side = |node: Node<'t, 'a>| Ok((node, name(&node), place(xml, node)?[1]));
    let chosen = chosen.into_iter().map(with_side).collect::<std::result::Result<Vec<_>, String>>()?;
    if chosen.is_empty() {
        return Err("no joint of the file is known to turn a wheel: name them in the plug-in".into());
    }
    by_side(chosen)
}

/// Returns where a joint is in the frame of its parent link.
fn place(xml: &Xml, joint: Node) -> std::result::Result<[f64; 3], String> {
    match origin(xml, joint)? {
        Some(numbers) => Ok([numbers.value(0)?, numbers.value(1)?, numbers.value(2)?]),
        None => Ok([0.0; 3]),
    }
}

fn origin(xml: &Xml, joint: Node) -> std::result::Result<Option<Numbers>, String> {
    child(joint, "origin").map_or(Ok(None), |origin| xml.attribute(origin, "xyz"))
}

/// Returns the joints that place each wheel in the frame that all share, and where they stand in it.
#[expect(clippy::type_complexity, reason = "joints by side, and the axle")]
fn axle<'t, 'a>(
    xml: &'t Xml<'a>,
    wheels: &Sides<Node<'t, 'a>>,
) -> std::result::Result<(Sides<(Node<'t, 'a>, [f64; 3])>, Axle), String> {
    let chains: Vec<Vec<Node>> = wheels.iter().flatten().map(|wheel| chain(xml, *wheel)).collect();
    // The link that all chains share, counted from the root.
    let shared = (0..).take_while(|i| {
        let at = |chain: &Vec<Node>| chain.get(*i).map(|node| node.id());
        chains.iter().all(|chain| at(chain).is_some() && at(chain) == at(&chains[0]))
    });
    let shared = shared.count();
    let mut placed: Sides<(Node, [f64; 3])> = [Vec::new(), Vec::new()];
    let sides = wheels.iter().enumerate().flat_map(|(side, wheels)| wheels.iter().map(move |_| side));
    for (side, chain) in sides.zip(&chains) {
        let own = &chain[shared..];
        let first = own.first().ok_or("two wheels turn on one joint")?;
        let mut sum = [0.0; 3];
        for joint in own {
            let place = place(xml, *joint)?;
            sum = [0, 1, 2].map(|i| sum[i] + place[i]);
        }
        if !placed[side].iter().any(|(node, _)| node.id() == first.id()) {
            placed[side].push((*first, sum));
        }
    }
    let axle = Axle::of(&[0, 1].map(|side| placed[side].iter().map(|(_, place)| *place).collect()))?;
    Ok((placed, axle))
}

/// Returns the joints from the root to a joint.
fn chain<'t, 'a>(xml: &'t Xml<'a>, joint: Node<'t, 'a>) -> Vec<Node<'t, 'a>> {
    let mut chain = vec![joint];
    while let Some(parent) = child(chain[chain.len() - 1], "parent").and_then(|node| node.attribute("link")) {
        let above =
            xml.all("joint").find(|node| child(*node, "child").and_then(|node| node.attribute("link")) == Some(parent));
        match above {
            // A circle is not a robot.
            Some(above) if !chain.iter().any(|known| known.id() == above.id()) => chain.push(above),
            _ => break,
        }
    }
    chain.reverse();
    chain
}

fn drive_scale(xml: &Xml, factor: Estimate) -> Answer {
    let radii =
        wheels(xml)?.iter().flatten().map(|wheel| radii(xml, *wheel)).collect::<std::result::Result<Vec<_>, _>>();
    match (radii, gazebo::drives(xml).first()) {
        (Ok(radii), _) => {
            let scaled = radii.iter().flatten().map(|radius| {
                let old = radius.value(0)?;
                Ok(radius.set(
                    &[(0, factor.map(|f| old * f))],
                    "m",
                    "radius * factor; wheel_diameter of the plug-in stays".into(),
                ))
            });
            scaled.collect()
        }
        (Err(_), Some(plugin)) => {
            let reason = "wheel_diameter / factor: the wheels' own shape has no radius";
            Ok(vec![gazebo::scaled(xml, *plugin, gazebo::SIZE, factor, |f| 1.0 / f, reason)?])
        }
        (Err(why), None) => Err(why),
    }
}

/// Returns the radii of the shapes with which a wheel touches the floor.
fn radii(xml: &Xml, joint: Node) -> std::result::Result<Vec<Numbers>, String> {
    let name = child(joint, "child").and_then(|node| node.attribute("link")).unwrap_or_default();
    let link = link(xml, name).ok_or_else(|| format!("link {name} is not in the file"))?;
    let radii = gazebo::round_shapes(link).map(|shape| xml.attribute(shape, "radius"));
    let radii: Vec<Numbers> = radii.collect::<std::result::Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    if radii.is_empty() { Err(format!("wheel {name} has no shape with a radius")) } else { Ok(radii) }
}

fn track_width(xml: &Xml, factor: Estimate) -> Answer {
    match (axle(xml, &wheels(xml)?), gazebo::drives(xml).first()) {
        (Ok((placed, axle)), _) => {
            let moved = placed.iter().flatten().map(|(joint, place)| {
                let numbers = origin(xml, *joint)?.ok_or_else(|| format!("{} has no origin", xpath(*joint)))?;
                let new = axle.moved(numbers.value(axle.axis)?, place[axle.axis], factor);
                Ok(numbers.set(
                    &[(axle.axis, new)],
                    "m",
                    "distance from the middle / factor; wheel_separation of the plug-in stays".into(),
                ))
            });
            moved.collect()
        }
        (Err(_), Some(plugin)) => {
            let reason = "wheel_separation * factor: the joints do not show how far the wheels stand apart";
            Ok(vec![gazebo::scaled(xml, *plugin, gazebo::SEPARATION, factor, |f| f, reason)?])
        }
        (Err(why), None) => Err(why),
    }
}

fn sonar_yaw(xml: &Xml, deg: Estimate) -> Answer {
    let sensor = gazebo::sensor(xml)?;
    let reference = sensor.ancestors().find_map(|node| node.attribute("reference")).unwrap_or_default();
    let mount = xml.all("joint").find(|node| {
        child(*node, "child").and_then(|node| node.attribute("link")) == Some(reference)
            && node.attribute("type") == Some("fixed")
    });
    // A link with a shape is more than a sensor.
    let is_bare = link(xml, reference).is_some_and(|link| child(link, "collision").is_none());
    match mount.filter(|_| is_bare) {
        Some(joint) => Ok(vec![turned_origin(xml, joint, deg)?]),
        None => Ok(vec![turned_pose(xml, sensor, deg)?]),
    }
}

/// Turns the origin of a joint about the vertical of its parent.
fn turned_origin(xml: &Xml, joint: Node, deg: Estimate) -> std::result::Result<Change, String> {
    let reason = "turned by deg about the vertical";
    let added = |yaw_rad: f64| format!("0 0 {}", number(yaw_rad));
    let yaw = deg.map(f64::to_radians);
    let Some(origin) = child(joint, "origin") else {
        return Ok(Change {
            tag: format!("{}/origin/@rpy", xpath(joint)),
            old: String::new(),
            new: added(yaw.value),
            unit: "rad",
            ci95: yaw.ci95,
            edits: vec![xml.add_elements(joint, &format!("<origin xyz=\"0 0 0\" rpy=\"{}\"/>", added(yaw.value)))],
            reason: format!("{reason}; there was no origin"),
        });
    };
    match xml.attribute(origin, "rpy")? {
        Some(numbers) => turned(&numbers, 0, deg, true, reason),
        None => {
            Ok(Change { ci95: yaw.ci95, ..xml.added_attribute(origin, "rpy", &added(yaw.value), "rad", reason.into()) })
        }
    }
}

/// Turns three angles, roll, pitch and yaw, about the vertical.
///
/// # Errors
/// In words, if they are not three numbers.
pub fn turned(
    numbers: &Numbers,
    first: usize,
    deg: Estimate,
    is_rad: bool,
    reason: &str,
) -> std::result::Result<Change, String> {
    let to_rad = |angle: f64| if is_rad { angle } else { angle.to_radians() };
    let from_rad = |angle: f64| if is_rad { angle } else { angle.to_degrees() };
    let sequence = Sequence::ROLL_PITCH_YAW;
    let old = [numbers.value(first)?, numbers.value(first + 1)?, numbers.value(first + 2)?];
    let angles = |deg: f64| {
        let rotation = times(&about(2, deg.to_radians()), &sequence.rotation(old.map(to_rad)));
        sequence.angles_rad(&rotation).map(from_rad)
    };
    let [roll, pitch, yaw] = [0, 1, 2].map(|i| Estimate { ci95: None, ..deg.map(|deg| angles(deg)[i]) });
    let yaw = Estimate { ci95: deg.map(|d| yaw.value + from_rad((d - deg.value).to_radians())).ci95, ..yaw };
    let unit = if is_rad { "rad" } else { "deg" };
    Ok(numbers.set(&[(first + 2, yaw), (first, roll), (first + 1, pitch)], unit, reason.into()))
}

/// Turns the pose of a sensor about the vertical.
///
/// # Errors
/// In words, if the pose is in a form that is not read.
pub fn turned_pose(xml: &Xml, sensor: Node, deg: Estimate) -> std::result::Result<Change, String> {
    let reason = "turned by deg about the vertical";
    let yaw = deg.map(f64::to_radians);
    let Some(pose) = child(sensor, "pose") else {
        let new = format!("0 0 0 0 0 {}", number(yaw.value));
        return Ok(Change {
            tag: format!("{}/pose", xpath(sensor)),
            old: String::new(),
            edits: vec![xml.add_elements(sensor, &format!("<pose>{new}</pose>"))],
            new,
            unit: "rad",
            ci95: yaw.ci95,
            reason: format!("{reason}; there was no pose"),
        });
    };
    if pose.attribute("rotation_format").is_some_and(|format| format != "euler_rpy") {
        return Err(format!("{} is a quaternion: write it as roll, pitch and yaw first", xpath(pose)));
    }
    turned(&xml.content(pose)?, 3, deg, pose.attribute("degrees") != Some("true"), reason)
}

/// Adds a load to the heaviest link.
fn payload(xml: &Xml, query: &Query) -> Answer {
    let mass = |inertial: Node<'_, '_>| xml.attribute(child(inertial, "mass")?, "value").ok()?;
    let all = xml.all("inertial").filter_map(|inertial| Some((inertial, mass(inertial)?))).collect();
    let centre = |inertial: Node| child(inertial, "origin").map_or(Ok(None), |origin| xml.attribute(origin, "xyz"));
    loaded(Masses { all, parts: "links", none: "no link of the file has a mass" }, query, centre)
}
