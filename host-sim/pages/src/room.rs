//! The room as the charts draw it.

use glam::DVec2;
use serde::Serialize;

use super::words::tenths;
use mindgap_logs::Scene;

/// Walls, obstacles and target, cm; `bounds` holds them and all places besides, or no more than the places in a hall.
#[derive(Serialize)]
pub struct Room {
    bounds: [f64; 4],
    walls: Vec<[f64; 4]>,
    obstacles: Vec<[f64; 4]>,
    target: Option<[f64; 3]>,
}

/// A room that is so many times as long as the part of it that the robot was in is a hall: of it that part is shown.
const HALL: f64 = 2.0;
/// As long counts that part at least, cm.
const NEAR_CM: f64 = 150.0;
/// A room without anything in it is shown as wide as this at least, cm.
const LEAST_CM: f64 = 50.0;

impl Room {
    /// The room of a scene in which a robot was at `places`; the target is a disc of this radius.
    pub fn new(scene: &Scene, target_radius_cm: f64, places: impl Iterator<Item = DVec2>) -> Self {
        let sides = scene.sides();
        let seen = bounds(scene.target_cm.into_iter().chain(places));
        let whole = bounds(sides.iter().flat_map(|wall| [wall.from_cm, wall.to_cm]).chain(seen.into_iter().flatten()));
        let whole = whole.unwrap_or_default();
        let longest = |[low, high]: [DVec2; 2]| (high - low).max_element();
        let near_cm = seen.map_or(NEAR_CM, |seen| longest(seen).max(NEAR_CM));
        let [low, high] = match seen {
            Some([low, high]) if longest(whole) > HALL * near_cm => [low - 0.25 * near_cm, high + 0.25 * near_cm],
            _ => whole,
        };
        let more = 0.5 * (DVec2::splat(LEAST_CM) - (high - low)).max(DVec2::ZERO);
        let (low, high) = (low - more, high + more);
        Room {
            bounds: [low.x, low.y, high.x, high.y].map(tenths),
            walls: sides.iter().map(|w| [w.from_cm.x, w.from_cm.y, w.to_cm.x, w.to_cm.y].map(tenths)).collect(),
            obstacles: scene
                .obstacles
                .iter()
                .map(|o| [o.low_cm.x, o.low_cm.y, o.high_cm.x, o.high_cm.y].map(tenths))
                .collect(),
            target: scene.target_cm.map(|at| [at.x, at.y, target_radius_cm].map(tenths)),
        }
    }
}

/// The corners of the smallest rectangle that holds all places; none of none.
fn bounds(mut places: impl Iterator<Item = DVec2>) -> Option<[DVec2; 2]> {
    let first = places.next()?;
    Some(places.fold([first, first], |[low, high], at| [low.min(at), high.max(at)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_room_holds_its_walls_and_whoever_left_it() {
        let scene = Scene { arena_cm: Some(DVec2::new(300.0, 200.0)), ..Scene::default() };
        let left = [DVec2::new(-20.0, 10.0), DVec2::new(180.0, 90.0)].into_iter();
        assert_eq!(Room::new(&scene, 15.0, left).bounds, [-20.0, 0.0, 300.0, 200.0]);
        let hall = Scene { arena_cm: Some(DVec2::splat(2000.0)), ..Scene::default() };
        let corner = [DVec2::new(100.0, 100.0), DVec2::new(500.0, 300.0)].into_iter();
        assert_eq!(Room::new(&hall, 15.0, corner).bounds, [0.0, 0.0, 600.0, 400.0], "a corner of a hall");
        assert_eq!(Room::new(&hall, 15.0, std::iter::empty()).bounds, [0.0, 0.0, 2000.0, 2000.0]);
        let empty = Room::new(&Scene::default(), 15.0, std::iter::empty());
        assert_eq!(empty.bounds, [-25.0, -25.0, 25.0, 25.0]);
    }
}
