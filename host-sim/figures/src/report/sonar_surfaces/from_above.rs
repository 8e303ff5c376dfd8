//! The surface as colours on the plane of distance and angle.

use glam::DVec2;

use super::Surface;
use crate::report::chart::Plane;
use crate::report::glyph::bead;
use crate::report::scale::{self, SCALE_PX};
use crate::report::style::{Colour, FAINT, GREY};
use crate::report::svg::{Area, Svg};

/// Cells along distance and angle.
const COLUMNS: usize = 48;
const ROWS: usize = 36;
/// Distance of the lines of a hatch, px.
const HATCH_PX: f64 = 7.0;

/// Draws the map and its scale.
pub fn draw(svg: &mut Svg, space: Area, surface: &Surface) {
    let (map, _) = space.split_across(space.width - SCALE_PX);
    let plane = Plane::new(map, surface.distance_axis(), surface.incidence_axis());
    plane.draw_axes(svg);
    if has_gaps(surface) {
        hatch(svg, plane.area);
    }
    for (cell, place) in plane.area.cells(ROWS, COLUMNS).zip(places()) {
        let value = surface.share_of_value(surface.at_share(place.x, place.y));
        let Some(value) = value.filter(|_| surface.is_known_at(place.x, place.y)) else { continue };
        // A little overlap with the next cells keeps the ground from shining through the seams.
        let width = (cell.width + 0.5).min(plane.area.right() - cell.left);
        let height = (cell.height + 0.5).min(plane.area.bottom() - cell.top);
        let colour = Colour::viridis(value).fill();
        svg.titled(&surface.reading(place, value), |svg| svg.rect(Area { width, height, ..cell }, colour));
    }
    for sample in surface.test_shares() {
        let at = DVec2::new(sample.x * plane.area.width, (1.0 - sample.y) * plane.area.height);
        bead(svg, at + DVec2::new(plane.area.left, plane.area.top), Colour::viridis(sample.z));
    }
    scale::draw(svg, plane.area, &surface.value_axis());
}

/// Draws an area without data.
pub fn hatch(svg: &mut Svg, area: Area) {
    svg.clipped(area, |svg| {
        svg.rect(area, FAINT.fill());
        svg.group(GREY.line(0.5), |svg| {
            let lines = ((area.width + area.height) / HATCH_PX) as usize;
            for right in (0..=lines).map(|line| area.left + line as f64 * HATCH_PX) {
                let ends = [DVec2::new(right, area.top), DVec2::new(right - area.height, area.bottom())];
                svg.line(&ends, Default::default());
            }
        });
    });
}

/// Whether a cell of the map has no data.
pub fn has_gaps(surface: &Surface) -> bool {
    places().any(|place| !surface.is_known_at(place.x, place.y))
}

/// Middles of the cells as shares of distance and angle, the row of the largest angle first.
fn places() -> impl Iterator<Item = DVec2> {
    let middle = |cell: usize, of: usize| (cell as f64 + 0.5) / of as f64;
    (0..ROWS * COLUMNS).map(move |i| DVec2::new(middle(i % COLUMNS, COLUMNS), 1.0 - middle(i / COLUMNS, ROWS)))
}
