//! The surface as a sheet in space.

use glam::{DVec2, DVec3};
use plotters::element::Polygon;
use plotters::style::text_anchor::{HPos, VPos};
use plotters::style::{Color, FontTransform, WHITE};

use super::{Surface, colour};
use crate::report::chart::{Axis, share};
use crate::report::figure::{Canvas, Drawn};
use crate::report::glyph::{Place, bead, solid_line};
use crate::report::projection::Projection;
use crate::report::style::{FAINT, GREY, INK, SMALL_PX, TEXT_PX, UNIT, line, px, text};

const CELLS: usize = 24;
const ELEVATION_DEG: f64 = 26.0;
/// Lengths of the edges along distance, angle and value.
const EDGES: DVec3 = DVec3::new(1.15, 1.0, 0.72);
/// Margins around the box for its labels: left, above, right, below, px.
const ROOM_PX: [f64; 4] = [56.0, 6.0, 30.0, 34.0];
/// Distances of tick labels and axis names from the box, px.
const NUMBER_PX: f64 = 12.0;
const NAME_PX: f64 = 27.0;
const UPRIGHT_NAME_PX: f64 = 36.0;

/// Depth bias of samples, so that one that lies in the surface is fully visible.
const LIFT: f64 = 0.04;

/// A piece that is drawn in order of depth.
enum Piece {
    /// A cell, and whether there are data in it.
    Cell([DVec3; 4], bool),
    Sample(DVec3),
}

/// The box around the surface: how it is seen, and its corner on the floor nearest to the viewer.
struct View {
    projection: Projection,
    near: DVec2,
}

pub fn draw(canvas: &Canvas, surface: &Surface) -> Drawn {
    let view = View::of(canvas, surface);
    view.draw_box(canvas, surface)?;
    for piece in view.pieces(surface) {
        match piece {
            Piece::Cell(corners, known) => {
                let height = corners.iter().map(|c| c.z).sum::<f64>() / 4.0;
                let mut places: Vec<Place> = corners.iter().map(|c| view.place(*c)).collect();
                if known {
                    canvas.draw(&Polygon::new(places.as_slice(), colour(height).filled()))?;
                }
                places.push(places[0]);
                let edge = if known { line(WHITE.mix(0.55), 0.5) } else { line(FAINT, 0.5) };
                solid_line(canvas, &places, edge)?;
            }
            Piece::Sample(at) => bead(canvas, view.place(at), colour(at.z))?,
        }
    }
    Ok(())
}

impl View {
    /// The view from where the surface is lower, so that it does not hide itself.
    fn of(canvas: &Canvas, surface: &Surface) -> Self {
        let mean = |distance: f64| -> f64 {
            let values = (0..=CELLS).map(|i| surface.at_share(distance, i as f64 / CELLS as f64));
            values.filter_map(|v| surface.share_of_value(v)).sum()
        };
        let far_is_lower = mean(1.0) <= mean(0.0);
        let (near, azimuth_deg) = if far_is_lower { (DVec2::ONE, 42.0) } else { (DVec2::Y, 138.0) };
        let (width, height) = canvas.dim_in_pixel();
        let [left, above, right, below] = ROOM_PX.map(|room| room * f64::from(UNIT));
        let low = DVec2::new(left, above);
        let high = DVec2::new(f64::from(width) - right, f64::from(height) - below);
        View { projection: Projection::fitted(EDGES, azimuth_deg, ELEVATION_DEG, low, high), near }
    }

    fn place(&self, point: DVec3) -> Place {
        let at = self.projection.place(point);
        (libm::round(at.x) as i32, libm::round(at.y) as i32)
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

    /// The floor, the two walls behind, and the three axes.
    fn draw_box(&self, canvas: &Canvas, surface: &Surface) -> Drawn {
        let (near, far) = (self.near, DVec2::ONE - self.near);
        let [distance, incidence, value] = [surface.distance_axis(), surface.incidence_axis(), surface.value_axis()];
        for x in shares(&distance) {
            let bend = [DVec3::new(x, near.y, 0.0), DVec3::new(x, far.y, 0.0), DVec3::new(x, far.y, 1.0)];
            solid_line(canvas, &bend.map(|p| self.place(p)), line(FAINT, 0.75))?;
        }
        for y in shares(&incidence) {
            let bend = [DVec3::new(near.x, y, 0.0), DVec3::new(far.x, y, 0.0), DVec3::new(far.x, y, 1.0)];
            solid_line(canvas, &bend.map(|p| self.place(p)), line(FAINT, 0.75))?;
        }
        for z in shares(&value) {
            let bend = [DVec3::new(near.x, far.y, z), far.extend(z), DVec3::new(far.x, near.y, z)];
            solid_line(canvas, &bend.map(|p| self.place(p)), line(FAINT, 0.75))?;
        }
        let along_x = [DVec3::new(0.0, near.y, 0.0), DVec3::new(1.0, near.y, 0.0)];
        let along_y = [DVec3::new(near.x, 0.0, 0.0), DVec3::new(near.x, 1.0, 0.0)];
        let sides = [DVec3::new(near.x, far.y, 0.0), DVec3::new(far.x, near.y, 0.0)];
        let left = if self.place(sides[0]).0 < self.place(sides[1]).0 { sides[0] } else { sides[1] };
        self.draw_axis(canvas, &distance, along_x)?;
        self.draw_axis(canvas, &incidence, along_y)?;
        self.draw_axis(canvas, &value, [left, left + DVec3::Z])
    }

    fn draw_axis(&self, canvas: &Canvas, axis: &Axis, ends: [DVec3; 2]) -> Drawn {
        let upright = ends[0].z != ends[1].z;
        let places = ends.map(|end| self.place(end));
        solid_line(canvas, &places, line(GREY, 0.75))?;
        let run = DVec2::new(f64::from(places[1].0 - places[0].0), f64::from(places[1].1 - places[0].1));
        let down = if run.x > 0.0 { run.perp() } else { -run.perp() };
        let outward = if upright { DVec2::NEG_X } else { down.normalize() };
        let beside = |at: Place, by_px: f64| (at.0 + px(outward.x * by_px), at.1 + px(outward.y * by_px));
        let anchor = if upright { HPos::Right } else { HPos::Center };
        for (share, value) in shares(axis).zip(&axis.ticks.at) {
            let at = self.place(ends[0].lerp(ends[1], share));
            solid_line(canvas, &[at, beside(at, 3.0)], line(GREY, 0.75))?;
            let by_px = if upright { NUMBER_PX / 2.0 } else { NUMBER_PX };
            let style = text(SMALL_PX, INK, anchor, VPos::Center);
            canvas.draw_text(&axis.ticks.label(*value), &style, beside(at, by_px))?;
        }
        let middle = self.place(ends[0].midpoint(ends[1]));
        let name = |across: HPos| text(TEXT_PX, INK, across, VPos::Center);
        if upright {
            let style = name(HPos::Center).transform(FontTransform::Rotate270);
            return canvas.draw_text(&axis.name, &style, beside(middle, UPRIGHT_NAME_PX));
        }
        let across = if outward.x < 0.0 { HPos::Right } else { HPos::Left };
        canvas.draw_text(&axis.name, &name(across), beside(middle, NAME_PX))
    }
}

/// Where an axis' ticks lie along it.
fn shares(axis: &Axis) -> impl Iterator<Item = f64> {
    axis.ticks.at.iter().map(|value| share(&axis.range, *value))
}
