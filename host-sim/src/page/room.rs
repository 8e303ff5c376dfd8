//! The room as the charts draw it.

use glam::DVec2;
use serde::Serialize;

use super::words::tenths;
use crate::logs::Scene;

/// Walls, obstacles and target, cm; `bounds` holds them and all places besides.
#[derive(Serialize)]
pub struct Room {
    bounds: [f64; 4],
    walls: Vec<[f64; 4]>,
    obstacles: Vec<[f64; 4]>,
    target: Option<[f64; 3]>,
}

/// A room without anything in it is shown as wide as this at least, cm.
const LEAST_CM: f64 = 50.0;

impl Room {
    /// The room of a scene in which a robot was at `places`; the target is a disc of this radius.
    pub fn new(scene: &Scene, target_radius_cm: f64, places: impl Iterator<Item = DVec2>) -> Self {
        let sides = scene.sides();
        let outer = || sides.iter().flat_map(|wall| [wall.from_cm, wall.to_cm]);
        let all = outer().chain(scene.target_cm).chain(places);
        let (low, high) = all.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(l, h), at| (l.min(at), h.max(at)));
        let (low, high) = if low.x <= high.x { (low, high) } else { (DVec2::ZERO, DVec2::ZERO) };
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_room_holds_its_walls_and_whoever_left_it() {
        let scene = Scene { arena_cm: Some(DVec2::new(300.0, 200.0)), ..Scene::default() };
        let room = Room::new(&scene, 15.0, [DVec2::new(-20.0, 10.0)].into_iter());
        assert_eq!(room.bounds, [-20.0, 0.0, 300.0, 200.0]);
        let empty = Room::new(&Scene::default(), 15.0, std::iter::empty());
        assert_eq!(empty.bounds, [-25.0, -25.0, 25.0, 25.0]);
    }
}
