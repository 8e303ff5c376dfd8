//! Walls, and the points where they meet or end.

use glam::DVec2;

use mindgap_foundations::geometry::Wall;

/// Everything that can return an echo.
#[derive(Clone, Debug)]
pub struct Surfaces {
    pub(super) walls: Vec<Wall>,
    /// Directions of the normals of the walls, degrees.
    normals_deg: Vec<f64>,
    pub(super) corners: Vec<Corner>,
}

/// A point where two walls meet, or where one ends.
#[derive(Clone, Debug)]
pub(super) struct Corner {
    pub at_cm: DVec2,
    /// Directions along the walls away from it, cm, as a pair for each two walls; empty at a free end.
    arms: Vec<[DVec2; 2]>,
}

/// The kind of a corner, seen from a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The point is between the two walls.
    Concave,
    /// The point is outside both walls, or the corner is a free end.
    Convex,
    /// The point is behind a wall that another wall meets from the other side.
    Flat,
}

/// Walls within this distance touch, cm.
const TOUCHING_CM: f64 = 0.1;

impl Surfaces {
    /// Returns the surfaces of walls.
    pub fn new(walls: Vec<Wall>) -> Self {
        let mut corners = Vec::new();
        for (i, one) in walls.iter().enumerate() {
            for other in &walls[i + 1..] {
                corners.extend(meeting(one, other));
            }
            let others = || walls.iter().enumerate().filter(|(j, _)| *j != i);
            let is_free = |end: &DVec2| others().all(|(_, wall)| wall.nearest(*end).distance(*end) > TOUCHING_CM);
            let ends = [one.from_cm, one.to_cm].into_iter().filter(is_free);
            corners.extend(ends.map(|at_cm| Corner { at_cm, arms: Vec::new() }));
        }
        let normal_deg = |wall: &Wall| {
            let normal = (wall.to_cm - wall.from_cm).perp();
            libm::atan2(normal.y, normal.x).to_degrees()
        };
        let normals_deg = walls.iter().map(normal_deg).collect();
        Surfaces { walls, normals_deg, corners }
    }

    /// Returns the walls.
    pub fn walls(&self) -> &[Wall] {
        &self.walls
    }

    /// Returns the angle between a ray at `ray_deg` and a wall's normal, degrees, 0 to 90.
    pub(super) fn incidence_deg(&self, wall: usize, ray_deg: f64) -> f64 {
        let turned = (ray_deg - self.normals_deg[wall]) / 180.0;
        180.0 * (turned - libm::round(turned)).abs()
    }

    /// Returns whether no wall is between two points.
    pub(super) fn is_visible(&self, from_cm: DVec2, point_cm: DVec2) -> bool {
        let way = point_cm - from_cm;
        let distance_cm = way.length();
        let direction = way / distance_cm;
        let is_between = |wall: &Wall| {
            wall.distance_along_cm(from_cm, direction).is_some_and(|met_cm| met_cm <= distance_cm - TOUCHING_CM)
        };
        !self.walls.iter().any(is_between)
    }
}

impl Corner {
    /// Returns the kind of the corner, seen from a point.
    pub fn side(&self, from_cm: DVec2) -> Side {
        let way = from_cm - self.at_cm;
        // A direction between two others is a positive combination of both.
        let between =
            |[a, b]: &[DVec2; 2]| way.perp_dot(*b) / a.perp_dot(*b) > 0.0 && a.perp_dot(way) / a.perp_dot(*b) > 0.0;
        match self.arms.as_slice() {
            arms if arms.iter().any(between) => Side::Concave,
            [] | [_] => Side::Convex,
            _ => Side::Flat,
        }
    }
}

/// Returns the corner where two walls meet; `None` if they do not meet or are collinear.
fn meeting(one: &Wall, other: &Wall) -> Option<Corner> {
    let (a, b) = (one.to_cm - one.from_cm, other.to_cm - other.from_cm);
    let across = a.perp_dot(b);
    if across.abs() < 1e-6 * a.length() * b.length() {
        return None;
    }
    let at_cm = one.from_cm + a * ((other.from_cm - one.from_cm).perp_dot(b) / across);
    if [one, other].iter().any(|wall| wall.nearest(at_cm).distance(at_cm) > TOUCHING_CM) {
        return None;
    }
    let arms_of = |wall: &Wall| {
        let arms = [wall.from_cm - at_cm, wall.to_cm - at_cm].into_iter();
        arms.filter(|arm| arm.length() > TOUCHING_CM).collect::<Vec<_>>()
    };
    let arms = arms_of(one).into_iter().flat_map(|a| arms_of(other).into_iter().map(move |b| [a, b])).collect();
    Some(Corner { at_cm, arms })
}
