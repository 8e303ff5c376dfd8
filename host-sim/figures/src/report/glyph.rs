//! Small marks of a fixed size, the same in charts and legends. Positions are in canvas units.

use glam::DVec2;
use plotters::element::{Circle, DashedPathElement, PathElement, Polygon};
use plotters::style::{Color, ShapeStyle, WHITE};

use super::figure::{Canvas, Drawn};
use super::style::{INK, line, px};

/// A position on the canvas, right and down.
pub type Place = (i32, i32);

/// A filled disc.
pub fn dot(canvas: &Canvas, at: Place, radius_px: f64, colour: impl Color) -> Drawn {
    canvas.draw(&Circle::new(at, px(radius_px), colour.filled()))
}

/// A disc with a rim.
pub fn rimmed_dot(canvas: &Canvas, at: Place, radius_px: f64, fill: impl Color, rim: impl Color) -> Drawn {
    dot(canvas, at, radius_px, fill)?;
    canvas.draw(&Circle::new(at, px(radius_px), line(rim, 0.75)))
}

/// A small disc with a dark rim and a white halo, visible on any colour.
pub fn bead(canvas: &Canvas, at: Place, fill: impl Color) -> Drawn {
    dot(canvas, at, 3.25, WHITE.mix(0.75))?;
    rimmed_dot(canvas, at, 2.25, fill, INK)
}

/// An oblique cross on a white ground, visible on any line.
pub fn cross(canvas: &Canvas, at: Place, colour: impl Color) -> Drawn {
    let arm = px(4.0);
    for style in [line(WHITE, 4.5), line(colour, 2.0)] {
        for side in [arm, -arm] {
            let ends = [(at.0 - side, at.1 - arm), (at.0 + side, at.1 + arm)];
            canvas.draw(&PathElement::new(ends, style))?;
        }
    }
    Ok(())
}

/// An arrowhead about a place; `direction` has length one, right and up.
pub fn arrowhead(canvas: &Canvas, at: Place, direction: DVec2, length_px: f64, colour: impl Color) -> Drawn {
    let corner = |ahead: f64, left: f64| {
        let offset = (direction * ahead + direction.perp() * left) * length_px;
        (at.0 + px(offset.x), at.1 - px(offset.y))
    };
    canvas.draw(&Polygon::new([corner(0.6, 0.0), corner(-0.4, 0.4), corner(-0.4, -0.4)], colour.filled()))
}

/// A line through places.
pub fn solid_line(canvas: &Canvas, places: &[Place], style: ShapeStyle) -> Drawn {
    canvas.draw(&PathElement::new(places, style))
}

/// A dashed line through places.
pub fn dashed_line(canvas: &Canvas, places: &[Place], style: ShapeStyle) -> Drawn {
    canvas.draw(&DashedPathElement::new(places.iter().copied(), px(5.0), px(3.5), style))
}
