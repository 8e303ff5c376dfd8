//! The covariates of a row on which a gap may depend.

use crate::evaluation::observations::Observation;

/// Time since the run began, s.
pub fn seconds(row: &Observation) -> f64 {
    60.0 * row.context.elapsed_min
}

/// Mean magnitude of the commands.
pub fn speed(row: &Observation) -> f64 {
    let [left, right] = row.context.commands[0];
    0.5 * (left.abs() + right.abs())
}

/// Largest change of a command.
pub fn change(row: &Observation) -> f64 {
    let [now, before, ..] = row.context.commands;
    (now[0] - before[0]).abs().max((now[1] - before[1]).abs())
}

/// Whether a motor turns the other way than before.
pub fn reverses(row: &Observation) -> bool {
    let [now, before, ..] = row.context.commands;
    (0..2).any(|m| now[m] * before[m] < 0.0)
}

/// Right minus left command: above zero when it turns to the left.
pub fn turning(row: &Observation) -> f64 {
    let [left, right] = row.context.commands[0];
    right - left
}

/// Mean command, below zero when it drives back.
pub fn driving(row: &Observation) -> f64 {
    let [left, right] = row.context.commands[0];
    0.5 * (left + right)
}

/// Heading, degrees.
pub fn heading_deg(row: &Observation) -> f64 {
    row.context.pose.heading_rad.to_degrees()
}

/// Distance from the scene's middle, cm.
pub fn off_middle_cm(row: &Observation) -> f64 {
    row.context.pose.position_cm.distance(row.context.middle_cm)
}

/// Place from left to right, cm.
pub fn x_cm(row: &Observation) -> f64 {
    row.context.pose.position_cm.x
}

/// Place from bottom to top, cm.
pub fn y_cm(row: &Observation) -> f64 {
    row.context.pose.position_cm.y
}

/// What the sensor's axis meets, cm; 300 for what is farther.
pub fn distance_cm(row: &Observation) -> f64 {
    row.context.faced.map_or(300.0, |[distance_cm, _]| distance_cm.min(300.0))
}

/// At which angle it is met, degrees: above zero where the wall leans to the left.
pub fn incidence_deg(row: &Observation) -> f64 {
    row.context.faced.map_or(0.0, |[_, incidence_rad]| incidence_rad.to_degrees())
}

/// The reading before: one if there was one.
pub fn echo_before(row: &Observation) -> f64 {
    f64::from(u8::from(row.context.echo_before == Some(true)))
}

/// Whether the rays beside the axis meet something much nearer or farther.
pub fn edge_in_beam(row: &Observation) -> bool {
    let middle = row.fan.len() / 2;
    let [right, axis, left] = [middle - 1, middle, middle + 1].map(|i| row.fan[i].distance_cm);
    let expected = 2.0 * right * left / (right + left);
    (axis - expected).abs() > 0.15 * axis
}
