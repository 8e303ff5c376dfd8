//! Attributes of MJCF, which an element has itself or from a class of defaults.

use roxmltree::Node;

use crate::edit::{Answer, Change, number};
use crate::estimate::Estimate;
use crate::xml::{Xml, child};

/// The element that an attribute comes from.
#[derive(Clone, Copy)]
pub struct Source<'t, 'a> {
    /// The element.
    pub node: Node<'t, 'a>,
    name: &'t str,
    is_class: bool,
}

impl<'t> Source<'t, '_> {
    /// Returns the text of the attribute.
    pub fn value(&self) -> &'t str {
        self.node.attribute(self.name).unwrap_or_default()
    }
}

/// Returns where an element has an attribute from: itself, its class, or a class around that.
pub fn resolved<'t, 'a>(xml: &'t Xml<'a>, node: Node<'t, 'a>, name: &'t str) -> Option<Source<'t, 'a>> {
    if node.has_attribute(name) {
        return Some(Source { node, name, is_class: false });
    }
    let mut class = Some(class_of(xml, node)?);
    while let Some(default) = class {
        let of_kind = child(default, node.tag_name().name()).filter(|own| own.has_attribute(name));
        if let Some(node) = of_kind {
            return Some(Source { node, name, is_class: true });
        }
        class = default.parent_element().filter(|parent| parent.has_tag_name("default"));
    }
    None
}

/// Returns the class of defaults of an element: its own, that of the bodies around it, or the main one.
fn class_of<'t, 'a>(xml: &'t Xml<'a>, node: Node<'t, 'a>) -> Option<Node<'t, 'a>> {
    let around = || node.ancestors().skip(1).find_map(|body| body.attribute("childclass"));
    let top = || xml.all("default").find(|node| node.parent_element().is_some_and(|n| n.has_tag_name("mujoco")));
    match node.attribute("class").or_else(around) {
        Some(name) => xml.all("default").find(|node| node.attribute("class") == Some(name)),
        None => top(),
    }
}

/// Returns the elements of a kind that have an attribute from a source.
pub fn users<'t, 'a>(xml: &'t Xml<'a>, source: &Source<'t, 'a>, kind: &'t str) -> Vec<Node<'t, 'a>> {
    let all = xml.all(kind).filter(|node| node.ancestors().all(|above| !above.has_tag_name("default")));
    let from =
        |node: &Node<'t, 'a>| resolved(xml, *node, source.name).is_some_and(|own| own.node.id() == source.node.id());
    all.filter(from).collect()
}

/// Sets the first number of an attribute of some elements: where it is defined, if that is for these elements alone, and else
/// on each. Where it is missing it is `default`.
pub fn set_on_each<'t, 'a>(
    xml: &'t Xml<'a>,
    nodes: &[Node<'t, 'a>],
    name: &'t str,
    default: f64,
    mut change: impl FnMut(f64) -> Estimate,
    unit: &'static str,
    reason: &str,
) -> Answer {
    let mut changes: Vec<Change> = Vec::new();
    for node in nodes {
        let source = resolved(xml, *node, name);
        let is_shared = source.is_some_and(|source| {
            let is_ours = |user: &Node| nodes.iter().any(|node| node.id() == user.id());
            source.is_class && !users(xml, &source, node.tag_name().name()).iter().all(is_ours)
        });
        let numbers = source.map(|source| xml.attribute(source.node, name)).transpose()?.flatten();
        let new = match &numbers {
            Some(numbers) => change(numbers.value(0)?),
            None => change(default),
        };
        let made = match numbers.filter(|_| !is_shared) {
            Some(numbers) => numbers.set(&[(0, new)], unit, reason.into()),
            None => {
                let why = if is_shared { "others share the class's" } else { "there was none" };
                let added = xml.added_attribute(*node, name, &number(new.value), unit, format!("{reason}; {why}"));
                Change { ci95: new.ci95, ..added }
            }
        };
        // A class is changed once.
        if !changes.contains(&made) {
            changes.push(made);
        }
    }
    Ok(changes)
}
