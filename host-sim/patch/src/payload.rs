//! A load: its mass is added to the heaviest part of a model, whose centre moves towards it.

use roxmltree::Node;

use super::cause::Query;
use super::edit::{Answer, Numbers};
use super::refusal;

/// Where a format states masses, and in which words it is spoken of.
pub struct Masses<'t, 'a> {
    /// The parts with their masses.
    pub all: Vec<(Node<'t, 'a>, Numbers)>,
    /// What the parts are called.
    pub parts: &'static str,
    /// The reason if there are none.
    pub none: &'static str,
}

/// Returns the changes that add a load; `centre` returns the numbers that place a part's centre, if it has some.
///
/// # Errors
/// In words, if the share of the load or all masses are unknown.
pub fn loaded(masses: Masses, query: &Query, centre: impl FnOnce(Node) -> Result<Option<Numbers>, String>) -> Answer {
    let Ok(share) = query.number("mass_share") else { return Err(refusal::LOAD_WITHOUT_MASS.into()) };
    let Masses { all, parts, none } = masses;
    let masses: Vec<(Node, f64, Numbers)> =
        all.into_iter().filter_map(|(node, numbers)| Some((node, numbers.value(0).ok()?, numbers))).collect();
    let total_kg: f64 = masses.iter().map(|(_, kg, _)| kg).sum();
    let heaviest = masses.iter().max_by(|a, b| a.1.total_cmp(&b.1));
    let (node, kg, numbers) = heaviest.ok_or(none)?;
    let new = share.map(|share| kg + share * total_kg);
    let mut changes = vec![numbers.set(&[(0, new)], "kg", format!("mass + mass_share * mass of all {parts}"))];
    if let Ok(lateral) = query.number("lateral")
        && let Some(place) = centre(*node)?
    {
        let (old_m, added_kg) = (place.value(1)?, new.value - kg);
        let to_left = |lateral: f64| (kg * old_m + added_kg * lateral * query.robot.track_cm / 100.0) / new.value;
        changes.push(place.set(&[(1, lateral.map(to_left))], "m", "centre of both masses".into()));
    }
    Ok(changes)
}
