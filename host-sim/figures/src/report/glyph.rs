//! Small marks of a fixed size, the same in charts and legends.

use glam::DVec2;

use super::style::{Colour, INK, WHITE};
use super::svg::Svg;

/// Draws a small disc with a dark rim and a white halo, visible on any colour.
pub fn bead(svg: &mut Svg, at: DVec2, colour: Colour) {
    svg.circle(at, 3.25, WHITE.fill().opacity(0.75));
    svg.circle(at, 2.25, colour.fill().rimmed(INK, 0.75));
}

/// Draws an oblique cross on a white ground, visible on any line.
pub fn cross(svg: &mut Svg, at: DVec2, colour: Colour) {
    for style in [WHITE.line(4.5), colour.line(2.0)] {
        for arm in [DVec2::new(4.0, 4.0), DVec2::new(-4.0, 4.0)] {
            svg.line(&[at - arm, at + arm], style);
        }
    }
}

/// Draws an arrowhead about a place; `direction` has length one and points right and down.
pub fn arrowhead(svg: &mut Svg, at: DVec2, direction: DVec2, length_px: f64, colour: Colour) {
    let corner = |ahead: f64, aside: f64| at + (direction * ahead + direction.perp() * aside) * length_px;
    svg.polygon(&[corner(0.6, 0.0), corner(-0.4, 0.4), corner(-0.4, -0.4)], colour.fill());
}

/// Draws the mark of a kind of data, of which there are three forms: kinds differ without colours too.
pub fn mark(svg: &mut Svg, at: DVec2, kind: usize, colour: Colour) {
    let style = WHITE.fill().rimmed(colour, 1.75);
    let corners = |radius: f64, turn: DVec2| [0, 1, 2, 3].map(|i| at + radius * turn.rotate(QUARTERS[i]));
    match kind % 3 {
        0 => svg.circle(at, 3.5, style),
        1 => svg.polygon(&corners(4.75, DVec2::X), style),
        _ => svg.polygon(&corners(4.5, DVec2::splat(std::f64::consts::FRAC_1_SQRT_2)), style),
    }
}

const QUARTERS: [DVec2; 4] = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
