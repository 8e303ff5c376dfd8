//! Length of the route from anywhere in a room to the target, around the obstacles. The straight line may lead through a
//! wall, so it would reward controllers that end behind one.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DVec2, IVec2};

use mindgap_foundations::geometry::Rectangle;
use mindgap_logs::Scene;

/// Side of a cell, cm.
const CELL_CM: f64 = 4.0;
/// Factor on lengths where the robot's body does not fit: places there have a finite length too, but no route is shorter
/// through them.
const BLOCKED: f64 = 20.0;
/// Steps from cell to cell, in sixteen directions: routes are at most 2.7 % too long.
const STEPS: [IVec2; 16] = [
    IVec2::new(1, 0),
    IVec2::new(2, 1),
    IVec2::new(1, 1),
    IVec2::new(1, 2),
    IVec2::new(0, 1),
    IVec2::new(-1, 2),
    IVec2::new(-1, 1),
    IVec2::new(-2, 1),
    IVec2::new(-1, 0),
    IVec2::new(-2, -1),
    IVec2::new(-1, -1),
    IVec2::new(-1, -2),
    IVec2::new(0, -1),
    IVec2::new(1, -2),
    IVec2::new(1, -1),
    IVec2::new(2, -1),
];
/// Lengths are compared in whole hundredths of a millimetre.
const UNITS_PER_CM: f64 = 1000.0;

/// Lengths of the routes to a target.
#[derive(Clone, Debug)]
pub struct RouteMap {
    low_cm: DVec2,
    /// Number of cells along x and y.
    cells: IVec2,
    /// One length per cell, in row-major order.
    lengths_cm: Vec<f32>,
}

impl RouteMap {
    /// Finds the shortest routes of a disc of `radius_cm` through a scene (Dijkstra 1959).
    pub fn new(scene: &Scene, target_cm: DVec2, radius_cm: f64) -> Self {
        let Rectangle { low_cm, high_cm } =
            scene.bounding_box().unwrap_or(Rectangle { low_cm: target_cm, high_cm: target_cm });
        let (low_cm, high_cm) = (low_cm.min(target_cm), high_cm.max(target_cm));
        let cells = ((high_cm - low_cm) / CELL_CM).ceil().as_ivec2() + IVec2::ONE;
        let mut map = RouteMap { low_cm, cells, lengths_cm: Vec::new() };
        let count = (cells.x * cells.y) as usize;
        let free: Vec<bool> = (0..count).map(|i| scene.has_room_for(map.middle_cm(map.cell(i)), radius_cm)).collect();
        // Integer lengths, so that rounding never makes a route shorter than itself.
        let mut lengths = vec![u64::MAX; count];
        let mut next = BinaryHeap::new();
        let nearest = ((target_cm - low_cm) / CELL_CM).round().as_ivec2();
        for cell in (-1..=1).flat_map(|x| (-1..=1).map(move |y| nearest + IVec2::new(x, y))) {
            if let Some(place) = map.place(cell) {
                next.push(Reverse((units(map.middle_cm(cell).distance(target_cm)), place)));
            }
        }
        while let Some(Reverse((length, place))) = next.pop() {
            if lengths[place] <= length {
                continue;
            }
            lengths[place] = length;
            for step in STEPS {
                let Some(to) = map.place(map.cell(place) + step) else { continue };
                let per_cm = if free[place] && free[to] { 1.0 } else { BLOCKED };
                let length = length + units(per_cm * CELL_CM * step.as_dvec2().length());
                if length < lengths[to] {
                    next.push(Reverse((length, to)));
                }
            }
        }
        map.lengths_cm = lengths.iter().map(|length| (*length as f64 / UNITS_PER_CM) as f32).collect();
        map
    }

    /// Returns the length of the route from a point, cm; from outside the room, the length from its edge.
    pub fn length_cm(&self, from_cm: DVec2) -> f64 {
        let last = (self.cells - IVec2::ONE).as_dvec2();
        let place = ((from_cm - self.low_cm) / CELL_CM).clamp(DVec2::ZERO, last);
        let corner = place.floor().min((last - DVec2::ONE).max(DVec2::ZERO));
        let part = place - corner;
        let at = |x: i32, y: i32| {
            let cell = (corner.as_ivec2() + IVec2::new(x, y)).min(self.cells - IVec2::ONE);
            f64::from(self.lengths_cm[(cell.y * self.cells.x + cell.x) as usize])
        };
        let along = |y: i32| at(0, y) + part.x * (at(1, y) - at(0, y));
        along(0) + part.y * (along(1) - along(0))
    }

    fn middle_cm(&self, cell: IVec2) -> DVec2 {
        self.low_cm + CELL_CM * cell.as_dvec2()
    }

    fn cell(&self, place: usize) -> IVec2 {
        let (place, width) = (place as i32, self.cells.x);
        IVec2::new(place % width, place / width)
    }

    fn place(&self, cell: IVec2) -> Option<usize> {
        let inside = cell.cmpge(IVec2::ZERO).all() && cell.cmplt(self.cells).all();
        inside.then(|| (cell.y * self.cells.x + cell.x) as usize)
    }
}

fn units(length_cm: f64) -> u64 {
    (length_cm * UNITS_PER_CM) as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::geometry::Wall;

    /// Returns a room with a wall across it that is open at the top.
    fn room() -> Scene {
        let wall = Wall { from_cm: DVec2::new(100.0, 0.0), to_cm: DVec2::new(100.0, 150.0) };
        Scene { arena_cm: Some(DVec2::new(200.0, 200.0)), walls: vec![wall], ..Scene::default() }
    }

    #[test]
    fn route_is_straight_in_free_space() {
        let target = DVec2::new(150.0, 50.0);
        let map = RouteMap::new(&room(), target, 10.0);
        for from in [DVec2::new(180.0, 50.0), DVec2::new(120.0, 90.0), DVec2::new(141.0, 163.0)] {
            let straight = from.distance(target);
            assert!((map.length_cm(from) / straight - 1.0).abs() < 0.04, "{from}: {} {straight}", map.length_cm(from));
        }
    }

    #[test]
    fn route_leads_around_a_wall() {
        let target = DVec2::new(150.0, 50.0);
        let map = RouteMap::new(&room(), target, 10.0);
        let from = DVec2::new(50.0, 50.0);
        // Two tangents to the disc of the body's radius about the end of the wall, and the arc between them.
        let round = 2.0 * 111.36 + 23.9;
        assert!((map.length_cm(from) / round - 1.0).abs() < 0.05, "{} {round}", map.length_cm(from));
    }

    #[test]
    fn blocked_and_outside_places_have_finite_lengths() {
        let map = RouteMap::new(&room(), DVec2::new(150.0, 50.0), 10.0);
        for from in [DVec2::new(0.0, 0.0), DVec2::new(-500.0, 900.0), DVec2::new(99.0, 20.0)] {
            assert!(map.length_cm(from).is_finite() && map.length_cm(from) > 50.0, "{from}: {}", map.length_cm(from));
        }
    }
}
