//! The targets that can return an echo to a sensor at a pose.

use glam::DVec2;

use super::rays::{Met, OUTERMOST_DEG, SPACING_DEG, met_by_rays};
use super::surfaces::{Corner, Side, Surfaces};
use mindgap_foundations::geometry::{Pose, wrap_rad};

/// Something that can return an echo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Distance from the sensor, cm.
    pub distance_cm: f64,
    /// Angle off the axis, degrees, 0 to 180.
    pub off_axis_deg: f64,
    /// Kind of target.
    pub kind: TargetKind,
    /// Derived quantities, cached since laws use them repeatedly.
    pub(super) known: Known,
}

/// Quantities derived from a target's position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Known {
    /// The logarithm of its distance in metres.
    pub log_metres: f64,
    /// The logarithm of its angle off the axis in degrees.
    pub log_off_axis: f64,
    /// Standard deviation of the distance between two rays along a wall, cm.
    pub between_cm: f64,
}

/// Kind of target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TargetKind {
    /// A point of a wall that a ray hits.
    Ray {
        /// The angle between the ray and the wall's normal, degrees, 0 to 90.
        incidence_deg: f64,
    },
    /// The foot of the perpendicular from the sensor to a wall.
    Foot,
    /// A concave corner.
    Corner,
    /// A convex edge, or the free end of a wall.
    Edge,
}

/// Incidence beyond which the part of a wall between two rays is as long as the range, degrees.
const GRAZING_DEG: f64 = 80.0;
/// Least distance of a target, cm: that of the sensor's own membrane.
const NEAREST_CM: f64 = 1.0;
/// The cosine of an angle off the axis that is just beyond the outermost ray's.
const WITHIN_COSINE: f64 = 0.4999;
/// A foot within this distance of its wall's end may be that end itself, cm.
const END_CM: f64 = 1e-6;

/// Returns the targets of a sensor, nearest first, without those that cannot be the first echo for any parameters of the
/// sensor: a wall behind another part of a wall that is nearer to the axis and faces the sensor more, a corner behind
/// another corner nearer to the axis, and an edge behind such an edge.
pub fn targets_at(surfaces: &Surfaces, sensor: &Pose) -> Vec<Target> {
    let mut found = walls(surfaces, sensor);
    found.extend(feet(surfaces, sensor));
    found.extend(corners(surfaces, sensor));
    found.sort_by(|a, b| a.distance_cm.total_cmp(&b.distance_cm));
    let mut nearer = Nearer::default();
    // Visibility takes longest to compute, so it is the last question.
    found.retain(|target| {
        let is_heard = !nearer.masks(target) && target.is_visible(surfaces, sensor);
        if is_heard {
            nearer.add(target);
        }
        is_heard
    });
    found.iter().map(|target| Target::new(target.distance_cm, target.off_axis_deg, target.kind)).collect()
}

/// Initial capacity for targets, which few rooms exceed.
const CAPACITY: usize = 64;

/// A target without derived quantities.
#[derive(Clone, Copy)]
struct Found {
    distance_cm: f64,
    off_axis_deg: f64,
    kind: TargetKind,
    /// Where it is, cm, unless a ray met it.
    point_cm: Option<DVec2>,
}

impl Found {
    /// Returns whether no wall hides it. Rays end at the walls that they meet.
    fn is_visible(&self, surfaces: &Surfaces, sensor: &Pose) -> bool {
        self.point_cm.is_none_or(|point_cm| surfaces.is_visible(sensor.position_cm, point_cm))
    }

    /// Returns whether this part of a wall is nearer than another and certainly stronger.
    fn masks(&self, other: &Found) -> bool {
        let faces_more = match (self.kind.incidence_deg(), other.kind.incidence_deg()) {
            (Some(own), Some(other)) => own <= other,
            _ => false,
        };
        faces_more && self.distance_cm < other.distance_cm && self.off_axis_deg <= other.off_axis_deg
    }
}

/// The targets that are nearer than the next one.
struct Nearer {
    /// Angle off the axis and incidence of each part of a wall, degrees.
    walls: Vec<[f64; 2]>,
    /// The least angle off the axis of a corner, degrees.
    corner_deg: f64,
    /// The least angle off the axis of an edge, degrees.
    edge_deg: f64,
}

impl Default for Nearer {
    fn default() -> Self {
        Nearer { walls: Vec::with_capacity(CAPACITY), corner_deg: f64::INFINITY, edge_deg: f64::INFINITY }
    }
}

impl Nearer {
    /// Returns whether one of these is certainly stronger than a target that is not nearer.
    fn masks(&self, target: &Found) -> bool {
        let off_axis_deg = target.off_axis_deg;
        match target.kind {
            TargetKind::Corner => self.corner_deg <= off_axis_deg,
            TargetKind::Edge => self.edge_deg <= off_axis_deg,
            TargetKind::Ray { .. } | TargetKind::Foot => {
                let incidence_deg = target.kind.incidence_deg().unwrap_or(0.0);
                self.walls.iter().any(|[off, incidence]| *off <= off_axis_deg && *incidence <= incidence_deg)
            }
        }
    }

    /// Adds a target that none of these masks.
    fn add(&mut self, target: &Found) {
        match target.kind {
            TargetKind::Corner => self.corner_deg = target.off_axis_deg,
            TargetKind::Edge => self.edge_deg = target.off_axis_deg,
            TargetKind::Ray { .. } | TargetKind::Foot => {
                self.walls.push([target.off_axis_deg, target.kind.incidence_deg().unwrap_or(0.0)]);
            }
        }
    }
}

impl Target {
    /// Returns a target at `distance_cm`, and at `off_axis_deg` off the axis.
    pub fn new(distance_cm: f64, off_axis_deg: f64, kind: TargetKind) -> Self {
        let incidence_deg = kind.incidence_deg().unwrap_or(0.0);
        // A uniform distribution has a standard deviation of its width over the root of twelve.
        let spacing = libm::tan(incidence_deg.min(GRAZING_DEG).to_radians()) * SPACING_DEG.to_radians() / 12f64.sqrt();
        let known = Known {
            log_metres: libm::log(distance_cm / 100.0),
            log_off_axis: libm::log(off_axis_deg),
            between_cm: distance_cm * spacing,
        };
        Target { distance_cm, off_axis_deg, kind, known }
    }
}

impl TargetKind {
    /// Returns the incidence on a wall, degrees; `None` for points.
    pub fn incidence_deg(&self) -> Option<f64> {
        match self {
            TargetKind::Ray { incidence_deg } => Some(*incidence_deg),
            TargetKind::Foot => Some(0.0),
            TargetKind::Corner | TargetKind::Edge => None,
        }
    }
}

/// Returns the points of walls that rays hit, without those that the next point of the same wall masks.
fn walls(surfaces: &Surfaces, sensor: &Pose) -> Vec<Found> {
    let axis_deg = sensor.heading_rad.to_degrees();
    let mut found: Vec<Found> = Vec::with_capacity(CAPACITY);
    let mut along = None;
    let mut start = 0;
    for Met { off_axis_deg, distance_cm, wall } in met_by_rays(surfaces, sensor) {
        let incidence_deg = surfaces.incidence_deg(wall, axis_deg + off_axis_deg);
        let part = Found {
            distance_cm: distance_cm.max(NEAREST_CM),
            off_axis_deg: off_axis_deg.abs(),
            kind: TargetKind::Ray { incidence_deg },
            point_cm: None,
        };
        if along.replace(wall) != Some(wall) {
            start = found.len();
        }
        while found.len() > start && found.last().is_some_and(|before| part.masks(before)) {
            found.pop();
        }
        if found.len() == start || !found.last().is_some_and(|before| before.masks(&part)) {
            found.push(part);
        }
    }
    found
}

/// Returns the feet of perpendiculars that lie on their walls. If the foot lies outside, the nearest point of a wall is its
/// end, which does not reflect specularly.
fn feet(surfaces: &Surfaces, sensor: &Pose) -> impl Iterator<Item = Found> {
    let axis = sensor.direction();
    surfaces.walls.iter().filter_map(move |wall| {
        let foot_cm = wall.nearest(sensor.position_cm);
        let is_inside = || [wall.from_cm, wall.to_cm].iter().all(|end| end.distance(foot_cm) > END_CM);
        point(sensor, axis, foot_cm, || is_inside().then_some(TargetKind::Foot))
    })
}

fn corners(surfaces: &Surfaces, sensor: &Pose) -> impl Iterator<Item = Found> {
    let axis = sensor.direction();
    let kind = |side| match side {
        Side::Concave => Some(TargetKind::Corner),
        Side::Convex => Some(TargetKind::Edge),
        Side::Flat => None,
    };
    let corner = move |corner: &Corner| point(sensor, axis, corner.at_cm, || kind(corner.side(sensor.position_cm)));
    surfaces.corners.iter().filter_map(corner)
}

/// Returns a point as a target if it is one and within the beam, which most points are not; it may be hidden.
fn point(sensor: &Pose, axis: DVec2, at_cm: DVec2, kind: impl FnOnce() -> Option<TargetKind>) -> Option<Found> {
    let way = at_cm - sensor.position_cm;
    let distance_cm = way.length();
    if way.dot(axis) < WITHIN_COSINE * distance_cm {
        return None;
    }
    let kind = kind()?;
    let off_axis_deg = wrap_rad(libm::atan2(way.y, way.x) - sensor.heading_rad).abs().to_degrees();
    let is_within = distance_cm > 0.0 && off_axis_deg <= OUTERMOST_DEG;
    let distance_cm = distance_cm.max(NEAREST_CM);
    is_within.then_some(Found { distance_cm, off_axis_deg, kind, point_cm: Some(at_cm) })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use mindgap_built_in_robot::four_obstacles;

    /// Returns whether a target that is not farther is certainly stronger.
    fn masks(nearer: &Found, farther: &Target) -> bool {
        let is_alike = match (nearer.kind.incidence_deg(), farther.kind.incidence_deg()) {
            (Some(own), Some(other)) => own <= other,
            (None, None) => nearer.kind == farther.kind,
            _ => false,
        };
        is_alike && nearer.off_axis_deg <= farther.off_axis_deg
    }

    proptest! {
        /// Every omitted target has a masking target in front of it, and no returned target has one.
        #[test]
        fn omitted_targets_are_masked(x_cm in 5.0..295.0, y_cm in 5.0..215.0, heading_deg in -180.0..180.0) {
            let (surfaces, sensor) = (Surfaces::new(four_obstacles().sides()), Pose::new(x_cm, y_cm, f64::to_radians(heading_deg)));
            let heard = targets_at(&surfaces, &sensor);
            prop_assert!(heard.is_sorted_by(|a, b| a.distance_cm <= b.distance_cm));
            let axis_deg = sensor.heading_rad.to_degrees();
            let rays = met_by_rays(&surfaces, &sensor).map(|met| Found {
                distance_cm: met.distance_cm.max(NEAREST_CM),
                off_axis_deg: met.off_axis_deg.abs(),
                kind: TargetKind::Ray { incidence_deg: surfaces.incidence_deg(met.wall, axis_deg + met.off_axis_deg) },
                point_cm: None,
            });
            let points = feet(&surfaces, &sensor).chain(corners(&surfaces, &sensor));
            let all: Vec<Found> = rays.chain(points.filter(|found| found.is_visible(&surfaces, &sensor))).collect();
            for found in &all {
                let same = Target::new(found.distance_cm, found.off_axis_deg, found.kind);
                let is_before = |target: &&Target| target.distance_cm <= found.distance_cm;
                let as_found = |target: &Target| Found { distance_cm: target.distance_cm, off_axis_deg: target.off_axis_deg, kind: target.kind, point_cm: None };
                prop_assert!(heard.iter().filter(is_before).any(|target| *target == same || masks(&as_found(target), &same)));
            }
            for target in &heard {
                let is_nearer = |found: &&Found| found.distance_cm < target.distance_cm;
                prop_assert!(!all.iter().filter(is_nearer).any(|found| masks(found, target)));
            }
        }
    }
}
