//! Where a range sensor of MJCF sits: the place and orientation of its site, whose z axis is the ray.

use roxmltree::Node;

use super::attributes::resolved;
use super::compiler;
use crate::edit::{Answer, Change, Numbers, number};
use crate::estimate::Estimate;
use crate::orientation::{
    IDENTITY, Rotation, Sequence, about, axis, axis_and_angle, of_quaternion, quaternion_about, times, transposed,
    turned_quaternion,
};
use crate::xml::{Xml, xpath};

/// Orientations that are directions: only one that gives the ray is read.
const ZAXIS: &str = "zaxis";

/// Turns a site about the vertical of the robot.
///
/// # Errors
/// In words, if its orientation is in a form that is not read.
pub fn turned(xml: &Xml, site: Node, deg: Estimate) -> Answer {
    let reason = "turned by deg about the vertical";
    let upright = around(xml, site)?;
    // Turned about the vertical of the bodies around it.
    let turn = |deg: f64| times(&transposed(&upright), &times(&about(2, deg.to_radians()), &upright));
    let change = |numbers: &Numbers, new: &dyn Fn(f64) -> Vec<f64>, unit: &'static str| {
        let values = new(deg.value);
        let main = largest_change(&numbers.values(), &values);
        let estimate =
            |i: usize| Estimate { value: values[i], ci95: deg.map(|d| new(d)[i]).ci95.filter(|_| i == main) };
        let others = (0..values.len()).filter(|i| *i != main);
        let all: Vec<(usize, Estimate)> = [main].into_iter().chain(others).map(|i| (i, estimate(i))).collect();
        Ok(vec![numbers.set(&all, unit, reason.into())])
    };
    let is_degrees = compiler(xml, "angle") != Some("radian");
    let unit = if is_degrees { "deg" } else { "rad" };
    let [to_rad, from_rad]: [fn(f64) -> f64; 2] =
        if is_degrees { [f64::to_radians, f64::to_degrees] } else { [|x| x, |x| x] };
    if let Some(numbers) = xml.attribute(site, "euler")? {
        let sequence = sequence(xml)?;
        let old = sequence.rotation(three(&numbers)?.map(to_rad));
        return change(&numbers, &|d| sequence.angles_rad(&times(&turn(d), &old)).map(from_rad).to_vec(), unit);
    }
    if let Some(numbers) = xml.attribute(site, "quat")? {
        let old = four(&numbers)?;
        if upright == IDENTITY {
            return change(&numbers, &|d| turned_quaternion(old, d.to_radians()).to_vec(), "");
        }
        return Err(format!("{} stands in bodies that are turned themselves: turn it by hand", xpath(site)));
    }
    if let Some(numbers) = xml.attribute(site, ZAXIS)? {
        let old = three(&numbers)?;
        return change(&numbers, &|d| applied_to(&turn(d), old).to_vec(), "");
    }
    if let Some(numbers) = xml.attribute(site, "axisangle")? {
        let [x, y, z, angle] = four(&numbers)?;
        let old = quaternion_about([x, y, z], to_rad(angle));
        if upright == IDENTITY {
            let new = |d: f64| {
                let ([x, y, z], angle) = axis_and_angle(turned_quaternion(old, d.to_radians()));
                vec![x, y, z, from_rad(angle)]
            };
            return change(&numbers, &new, unit);
        }
    }
    if let Some(numbers) = xml.attribute(site, "xyaxes")? {
        let all = numbers.values();
        if let [a, b, c, d, e, f] = all[..] {
            let new = |deg: f64| [applied_to(&turn(deg), [a, b, c]), applied_to(&turn(deg), [d, e, f])].concat();
            return change(&numbers, &new, "");
        }
    }
    if let Some(source) =
        ["euler", "quat", ZAXIS, "axisangle", "xyaxes"].iter().find_map(|name| resolved(xml, site, name))
    {
        return Err(format!("the orientation of the site comes from {}: write it at the site first", source.path()));
    }
    Err(format!("{} has no orientation, so its ray points up", xpath(site)))
}

/// Moves a site back along its ray, so that readings get longer.
///
/// # Errors
/// In words, if the ray would then hit the robot itself.
pub fn moved_back(xml: &Xml, site: Node, back_m: Estimate) -> Answer {
    let ray = axis(&orientation(xml, site)?, 2);
    let has_shape = site.parent_element().is_some_and(|body| body.children().any(|node| node.has_tag_name("geom")));
    if back_m.value > 0.0 && !has_shape {
        return Err(format!(
            "{} sits on a body without a shape, so a ray from farther back hits the robot itself: add to readings in the driver",
            xpath(site)
        ));
    }
    let reason = "moved back by cm / 100 along the ray; right on its axis only";
    let Some(numbers) = xml.attribute(site, "pos")? else {
        let text = ray.map(|r| number(-r * back_m.value)).join(" ");
        return Ok(vec![Change { ci95: None, ..xml.added_attribute(site, "pos", &text, "m", reason.into()) }]);
    };
    let old = three(&numbers)?;
    let new = [0, 1, 2].map(|i| back_m.map(|m| old[i] - m * ray[i]));
    let main = largest_change(&[0.0; 3], &ray);
    let all: Vec<(usize, Estimate)> =
        [main].into_iter().chain((0..3).filter(|i| *i != main)).map(|i| (i, new[i])).collect();
    Ok(vec![numbers.set(&all, "m", reason.into())])
}

/// Returns the orientation of the bodies around a site within that which has no body around it.
fn around(xml: &Xml, site: Node) -> std::result::Result<Rotation, String> {
    let bodies: Vec<Node> =
        site.ancestors().skip(1).filter(|node| node.has_tag_name("body") || node.has_tag_name("frame")).collect();
    let inner = bodies.len().saturating_sub(1);
    bodies[..inner].iter().try_fold(IDENTITY, |so_far, body| Ok(times(&orientation(xml, *body)?, &so_far)))
}

/// Returns the orientation of an element.
fn orientation(xml: &Xml, node: Node) -> std::result::Result<Rotation, String> {
    let is_degrees = compiler(xml, "angle") != Some("radian");
    let to_rad = |angle: f64| if is_degrees { angle.to_radians() } else { angle };
    if let Some(numbers) = xml.attribute(node, "euler")? {
        return Ok(sequence(xml)?.rotation(three(&numbers)?.map(to_rad)));
    }
    if let Some(numbers) = xml.attribute(node, "quat")? {
        return Ok(of_quaternion(four(&numbers)?));
    }
    if let Some(numbers) = xml.attribute(node, "axisangle")? {
        let [x, y, z, angle] = four(&numbers)?;
        return Ok(of_quaternion(quaternion_about([x, y, z], to_rad(angle))));
    }
    if let Some(numbers) = xml.attribute(node, ZAXIS)? {
        let [x, y, z] = three(&numbers)?;
        // The shortest way from up to the axis.
        let angle = libm::atan2(libm::hypot(x, y), z);
        return Ok(of_quaternion(quaternion_about([-y, x, 0.0], angle)));
    }
    if node.has_attribute("xyaxes") {
        return Err(format!("{} has xyaxes, which is not read here", xpath(node)));
    }
    Ok(IDENTITY)
}

fn sequence(xml: &Xml) -> std::result::Result<Sequence, String> {
    let name = compiler(xml, "eulerseq").unwrap_or("xyz");
    Sequence::parse(name)
        .ok_or_else(|| format!("eulerseq {name} is not read here: write the orientation as a quaternion"))
}

fn applied_to(r: &Rotation, v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| r[i][0] * v[0] + r[i][1] * v[1] + r[i][2] * v[2])
}

fn three(numbers: &Numbers) -> std::result::Result<[f64; 3], String> {
    numbers.values().try_into().map_err(|_| format!("{} is not three numbers", numbers.tag))
}

fn four(numbers: &Numbers) -> std::result::Result<[f64; 4], String> {
    numbers.values().try_into().map_err(|_| format!("{} is not four numbers", numbers.tag))
}

/// Returns the index at which two lists differ most.
fn largest_change(old: &[f64], new: &[f64]) -> usize {
    let change = |i: usize| (new[i] - old.get(i).copied().unwrap_or_default()).abs();
    (0..new.len()).max_by(|a, b| change(*a).total_cmp(&change(*b))).unwrap_or_default()
}
