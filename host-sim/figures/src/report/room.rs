//! The room from above: walls, obstacles and target, and the part of it that is shown.

use glam::DVec2;

use super::axis::{Axis, is_drawable};
use super::chart::{ABOVE_PX, BELOW_PX, LEFT_PX, Plane, RIGHT_PX};
use super::style::{GREEN, GREY, INK, SOLID};
use super::svg::{Area, Svg};
use mindgap_logs::Scene;

/// A scene and the rectangle of it that is shown, cm.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// Its walls and obstacles.
    pub scene: Scene,
    /// Radius of the target.
    pub target_radius_cm: f64,
    /// Lower left corner of what is shown.
    pub low: DVec2,
    /// Upper right corner of it.
    pub high: DVec2,
}

/// A room that is this many times as long as the part of it that the robot was in is a hall, of which only that part is shown.
const HALL: f64 = 2.0;
/// Least length of that part, cm.
const NEAR_CM: f64 = 150.0;
/// Least width of a room, cm.
const LEAST_CM: f64 = 50.0;
/// Margin around a room, as a share of its longer side.
const EDGE: f64 = 0.03;

impl Room {
    /// The room of a scene in which a robot was at `places`, with a disc of this radius as target. It contains all places, and
    /// the whole scene unless that is a hall.
    pub fn new(scene: &Scene, target_radius_cm: f64, places: impl Iterator<Item = DVec2>) -> Self {
        let seen = bounds(scene.target_cm.into_iter().chain(places));
        let walls = scene.sides().into_iter().flat_map(|wall| [wall.from_cm, wall.to_cm]);
        let whole = bounds(walls.chain(seen.into_iter().flatten())).unwrap_or_default();
        let longest = |[low, high]: [DVec2; 2]| (high - low).max_element();
        let near_cm = seen.map_or(NEAR_CM, |seen| longest(seen).max(NEAR_CM));
        let [low, high] = match seen {
            Some([low, high]) if longest(whole) > HALL * near_cm => [low - 0.25 * near_cm, high + 0.25 * near_cm],
            _ => whole,
        };
        let more = 0.5 * (DVec2::splat(LEAST_CM) - (high - low)).max(DVec2::ZERO);
        Room { scene: scene.clone(), target_radius_cm, low: low - more, high: high + more }
    }

    /// Corners of what is shown with a margin, cm.
    pub fn framed(&self) -> [DVec2; 2] {
        let edge = DVec2::splat(EDGE * (self.high - self.low).max_element());
        [self.low - edge, self.high + edge]
    }

    /// Size of a plane of the room with equal scales within this size, px, with room for its labels.
    pub fn size_px(&self, most_px: DVec2) -> DVec2 {
        let labels = DVec2::new(LEFT_PX + RIGHT_PX, ABOVE_PX + BELOW_PX);
        let [low, high] = self.framed();
        let scale = ((most_px - labels) / (high - low)).min_element();
        scale * (high - low) + labels
    }

    /// The room's plane in an area of [`size_px`](Self::size_px).
    pub fn plane(&self, area: Area) -> Plane {
        let [low, high] = self.framed();
        let most = |length_px: f64| (length_px / 55.0) as usize + 1;
        let x = Axis::new("x (cm)", low.x..high.x, most(area.width));
        Plane::new(area, x, Axis::new("y (cm)", low.y..high.y, most(area.height)))
    }

    /// Draws walls, obstacles and target.
    pub fn draw(&self, svg: &mut Svg, plane: &Plane) {
        let place = |at: DVec2| plane.place(at.x, at.y);
        if let Some(target) = self.scene.target_cm {
            let radius = plane.between(target, target + self.target_radius_cm).width;
            svg.circle(place(target), radius, GREEN.fill().opacity(0.18));
            svg.circle(place(target), radius, GREEN.line(1.5));
            for arm in [DVec2::X * 3.0, DVec2::Y * 3.0] {
                svg.line(&[place(target) - arm, place(target) + arm], GREEN.line(1.0));
            }
        }
        for obstacle in &self.scene.obstacles {
            svg.rect(plane.between(obstacle.low_cm, obstacle.high_cm), SOLID.fill().rimmed(GREY, 0.75));
        }
        if let Some(size) = self.scene.arena_cm {
            svg.rect(plane.between(DVec2::ZERO, size), INK.line(1.5));
        }
        for wall in &self.scene.walls {
            svg.line(&[place(wall.from_cm), place(wall.to_cm)], INK.line(1.5));
        }
    }
}

/// The corners of the smallest rectangle that contains all drawable places; `None` without places.
fn bounds(places: impl Iterator<Item = DVec2>) -> Option<[DVec2; 2]> {
    places.filter(|at| is_drawable(*at)).map(|at| [at, at]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_room_contains_its_walls_and_robots_beyond_them() {
        let shown = |scene: &Scene, places: &[[f64; 2]]| {
            let room = Room::new(scene, 15.0, places.iter().copied().map(DVec2::from));
            [room.low.x, room.low.y, room.high.x, room.high.y]
        };
        let scene = Scene { arena_cm: Some(DVec2::new(300.0, 200.0)), ..Scene::default() };
        assert_eq!(shown(&scene, &[[-20.0, 10.0], [180.0, 90.0], [f64::NAN, 0.0]]), [-20.0, 0.0, 300.0, 200.0]);
        let hall = Scene { arena_cm: Some(DVec2::splat(2000.0)), ..Scene::default() };
        assert_eq!(shown(&hall, &[[100.0, 100.0], [500.0, 300.0]]), [0.0, 0.0, 600.0, 400.0], "a corner of a hall");
        assert_eq!(shown(&hall, &[]), [0.0, 0.0, 2000.0, 2000.0]);
        assert_eq!(shown(&Scene::default(), &[]), [-25.0, -25.0, 25.0, 25.0]);
    }
}
