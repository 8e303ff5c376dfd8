//! The surface as a sheet in space.

use glam::{DVec2, DVec3};

use super::Surface;
use crate::report::axis::Axis;
use crate::report::glyph::bead;
use crate::report::projection::Projection;
use crate::report::style::{Colour, FAINT, GREY, INK, SMALL_PX, TEXT_PX, Text, WHITE, text_width_px};
use crate::report::svg::{Area, Svg};

const CELLS: usize = 24;
const ELEVATION_DEG: f64 = 26.0;
/// Lengths of the edges along distance, angle and value.
const EDGES: DVec3 = DVec3::new(1.15, 1.0, 0.72);
/// Margins around the box for its labels: left, above, right, below, px.
const ROOM_PX: [f64; 4] = [56.0, 6.0, 30.0, 44.0];
/// Distances of tick labels and axis names from the box, px.
const NUMBER_PX: f64 = 12.0;
const NAME_PX: f64 = 34.0;
const UPRIGHT_NAME_PX: f64 = 36.0;

/// Depth bias of samples, so that one that lies in the surface is fully visible.
const LIFT: f64 = 0.04;

/// A piece that is drawn in order of depth.
enum Piece {
    /// A cell, and whether there are data in it.
    Cell([DVec3; 4], bool),
    Sample(DVec3),
}

/// The box around the surface: its space, how it is seen, and its corner on the floor nearest to the viewer.
struct View {
    space: Area,
    projection: Projection,
    near: DVec2,
}

/// Draws the sheet in its box.
pub fn draw(svg: &mut Svg, space: Area, surface: &Surface) {
    let view = View::of(space, surface);
    view.draw_box(svg, surface);
    for piece in view.pieces(surface) {
        match piece {
            Piece::Cell(corners, known) => {
                let height = corners.iter().map(|c| c.z).sum::<f64>() / 4.0;
                let places = corners.map(|c| view.projection.place(c));
                let middle = (corners[0] + corners[2]).truncate() / 2.0;
                if known {
                    let style = Colour::viridis(height).fill().rimmed(WHITE, 0.4);
                    svg.titled(&surface.reading(middle, height), |svg| svg.polygon(&places, style));
                } else {
                    svg.polygon(&places, FAINT.line(0.5));
                }
            }
            Piece::Sample(at) => bead(svg, view.projection.place(at), Colour::viridis(at.z)),
        }
    }
}

impl View {
    /// The view from where the surface is lower, so that it does not hide itself.
    fn of(space: Area, surface: &Surface) -> Self {
        let mean = |distance: f64| -> f64 {
            let values = (0..=CELLS).map(|i| surface.at_share(distance, i as f64 / CELLS as f64));
            values.filter_map(|v| surface.share_of_value(v)).sum()
        };
        let far_is_lower = mean(1.0) <= mean(0.0);
        let (near, azimuth_deg) = if far_is_lower { (DVec2::ONE, 42.0) } else { (DVec2::Y, 138.0) };
        let room = space.without(ROOM_PX);
        let (low, high) = (DVec2::new(room.left, room.top), DVec2::new(room.right(), room.bottom()));
        View { space, projection: Projection::fitted(EDGES, azimuth_deg, ELEVATION_DEG, low, high), near }
    }

    /// The cells of the surface and the test data, farthest first.
    fn pieces(&self, surface: &Surface) -> Vec<Piece> {
        let corner = |column: usize, row: usize| {
            let (x, y) = (column as f64 / CELLS as f64, row as f64 / CELLS as f64);
            Some(DVec3::new(x, y, surface.share_of_value(surface.at_share(x, y))?))
        };
        let cell = |i: usize| {
            let (column, row) = (i % CELLS, i / CELLS);
            let corners = [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(dx, dy)| corner(column + dx, row + dy));
            let [Some(a), Some(b), Some(c), Some(d)] = corners else { return None };
            let middle = (a + b + c + d) / 4.0;
            let known = surface.is_known_at(middle.x, middle.y);
            Some((self.projection.nearness(middle), Piece::Cell([a, b, c, d], known)))
        };
        let cells = (0..CELLS * CELLS).filter_map(cell);
        let samples = surface.test_shares().map(|s| (self.projection.nearness(s) + LIFT, Piece::Sample(s)));
        let mut pieces: Vec<(f64, Piece)> = cells.chain(samples).collect();
        pieces.sort_by(|a, b| a.0.total_cmp(&b.0));
        pieces.into_iter().map(|(_, piece)| piece).collect()
    }

    /// Draws the floor, the two walls behind, and the three axes.
    fn draw_box(&self, svg: &mut Svg, surface: &Surface) {
        let (near, far) = (self.near, DVec2::ONE - self.near);
        let [distance, incidence, value] = [surface.distance_axis(), surface.incidence_axis(), surface.value_axis()];
        let across_x = |x: f64| [DVec3::new(x, near.y, 0.0), DVec3::new(x, far.y, 0.0), DVec3::new(x, far.y, 1.0)];
        let across_y = |y: f64| [DVec3::new(near.x, y, 0.0), DVec3::new(far.x, y, 0.0), DVec3::new(far.x, y, 1.0)];
        let across_z = |z: f64| [DVec3::new(near.x, far.y, z), far.extend(z), DVec3::new(far.x, near.y, z)];
        let bends = distance.labelled().map(|(x, _)| across_x(x));
        let bends = bends.chain(incidence.labelled().map(|(y, _)| across_y(y)));
        for bend in bends.chain(value.labelled().map(|(z, _)| across_z(z))) {
            svg.line(&bend.map(|p| self.projection.place(p)), FAINT.line(0.75));
        }
        let along_x = [DVec3::new(0.0, near.y, 0.0), DVec3::new(1.0, near.y, 0.0)];
        let along_y = [DVec3::new(near.x, 0.0, 0.0), DVec3::new(near.x, 1.0, 0.0)];
        let sides = [DVec3::new(near.x, far.y, 0.0), DVec3::new(far.x, near.y, 0.0)];
        let places = sides.map(|side| self.projection.place(side));
        let left = if places[0].x < places[1].x { sides[0] } else { sides[1] };
        self.draw_axis(svg, &distance, along_x);
        self.draw_axis(svg, &incidence, along_y);
        self.draw_axis(svg, &value, [left, left + DVec3::Z]);
    }

    fn draw_axis(&self, svg: &mut Svg, axis: &Axis, ends: [DVec3; 2]) {
        let upright = ends[0].z != ends[1].z;
        let places = ends.map(|end| self.projection.place(end));
        svg.line(&places, GREY.line(0.75));
        let run = places[1] - places[0];
        let down = if run.x > 0.0 { run.perp() } else { -run.perp() };
        let outward = if upright { DVec2::NEG_X } else { down.normalize() };
        let numbers = Text::new(SMALL_PX, GREY);
        for (share, label) in axis.labelled() {
            let at = self.projection.place(ends[0].lerp(ends[1], share));
            svg.line(&[at, at + outward * 3.0], GREY.line(0.75));
            if upright {
                svg.text(at + outward * NUMBER_PX / 2.0, &label, numbers.to_here());
            } else {
                svg.text(at + outward * NUMBER_PX, &label, numbers);
            }
        }
        let middle = self.projection.place(ends[0].midpoint(ends[1]));
        let words = Text::new(TEXT_PX, INK);
        if upright {
            svg.text(middle + outward * UPRIGHT_NAME_PX, &axis.name, words.turned());
        } else {
            // As far out as the words fit.
            let (at, width_px) = (middle + outward * NAME_PX, text_width_px(&axis.name, TEXT_PX));
            if outward.x < 0.0 {
                svg.text(DVec2::new(at.x.max(self.space.left + width_px), at.y), &axis.name, words.to_here());
            } else {
                svg.text(DVec2::new(at.x.min(self.space.right() - width_px), at.y), &axis.name, words.from_here());
            }
        }
    }
}
