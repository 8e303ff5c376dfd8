//! A quantity in squares on a map of the room.

use std::ops::Range;

use glam::DVec2;

use super::axis::{Axis, share};
use super::figure::{CHART_PX, Figure, MARGIN_PX};
use super::room::Room;
use super::scale::{self, SCALE_PX};
use super::style::{Colour, FAINT};

const MOST_HEIGHT_PX: f64 = 460.0;

/// A quantity on the floor of a room.
#[derive(Clone, Debug, PartialEq)]
pub struct RoomMap {
    /// The room.
    pub room: Room,
    /// The quantity and its unit.
    pub value_name: String,
    /// Values of the scale; those beyond have the colours of its ends.
    pub values: Range<f64>,
    /// Side of a square, cm.
    pub side_cm: f64,
    /// Lower left corner of each square, its value, and what is read under the pointer.
    pub squares: Vec<(DVec2, f64, String)>,
}

impl RoomMap {
    /// Draws the map.
    pub fn draw(&self) -> Figure {
        let most = DVec2::new(CHART_PX - 2.0 * MARGIN_PX - SCALE_PX, MOST_HEIGHT_PX);
        let size = self.room.size_px(most);
        Figure::draw(size.x + SCALE_PX, size.y, &[], |svg, space| {
            let plane = self.room.plane(space.split_across(size.x).0);
            plane.draw_axes(svg);
            svg.clipped(plane.area, |svg| {
                for (corner, value, title) in &self.squares {
                    let colour = Colour::viridis(share(&self.values, *value));
                    let area = plane.between(*corner, *corner + self.side_cm);
                    svg.titled(title, |svg| svg.rect(area, colour.fill().rimmed(FAINT, 0.5)));
                }
                self.room.draw(svg, &plane);
            });
            scale::draw(svg, plane.area, &Axis::new(self.value_name.as_str(), self.values.clone(), 5));
        })
    }
}
