//! The effects that a diagnosis knows, one file a family, each effect in every functional form that it may take.

pub mod drive;
pub mod floor;
pub mod frame;
pub mod motor;
pub mod sonar;

use serde_json::{Value, json};

use super::effect::{Form, Window};
use crate::geometry::wrap_rad;

/// All forms of all effects.
pub fn all() -> Vec<&'static Form> {
    [drive::FORMS, motor::FORMS, floor::FORMS, sonar::FORMS, frame::FORMS].into_iter().flatten().collect()
}

/// Changes the magnitude of every command and keeps its sign.
fn magnitude(window: &mut Window, change: impl Fn(f64) -> f64) {
    magnitude_each(window, |c, _| change(c));
}

/// The same with the motor: 0 left, 1 right.
fn magnitude_each(window: &mut Window, change: impl Fn(f64, usize) -> f64) {
    for commands in window {
        for (motor, c) in commands.iter_mut().enumerate() {
            *c = change(c.abs(), motor) * c.signum();
        }
    }
}

/// Three significant digits.
fn rounded(value: f64) -> Value {
    let text = format!("{value:.2e}");
    json!(text.parse::<f64>().unwrap_or(value))
}

fn degrees(angle_rad: f64) -> Value {
    json!((wrap_rad(angle_rad).to_degrees() * 10.0).round() / 10.0)
}

/// Which side a signed strength means: the left one when positive.
fn side_of(signed: f64) -> Value {
    json!(if signed > 0.0 { "left" } else { "right" })
}
