//! What can return an echo to a sensor at a pose.

use std::sync::LazyLock;

use glam::DVec2;

use super::surfaces::{Side, Surfaces};
use crate::geometry::{Pose, direction, first_met, wrap_rad};
use crate::sonar::perturbation::shaped;

/// Something that can return an echo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Distance from the sensor, cm.
    pub distance_cm: f64,
    /// Angle off the axis, degrees, 0 to 180.
    pub off_axis_deg: f64,
    /// What it is.
    pub kind: TargetKind,
    /// Laws ask for these again and again.
    pub(super) known: Known,
}

/// What follows from a target's place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Known {
    /// Of its distance and incidence: see [`shaped`].
    pub shaped: [f64; 2],
    /// The logarithm of its angle off the axis in degrees.
    pub log_off_axis: f64,
    /// Standard deviation of what lies between two rays along a wall, cm.
    pub between_cm: f64,
}

/// Beyond this incidence a wall's part between two rays is as long as the range, degrees.
const GRAZING_DEG: f64 = 80.0;

/// What returns an echo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TargetKind {
    /// A wall where a ray meets it.
    Ray {
        /// The angle between the ray and the wall's normal, degrees, 0 to 90.
        incidence_deg: f64,
    },
    /// A wall where its normal points to the sensor.
    Foot,
    /// A concave corner.
    Corner,
    /// A convex edge, or the free end of a wall.
    Edge,
}

/// Angle between two rays, degrees.
const SPACING_DEG: f64 = 3.0;
/// Rays to either side of the axis: out to 60 degrees, where a wall a hand's breadth away is no longer heard.
const RAYS: i32 = 20;
/// Nothing is nearer to the sensor than its own membrane, cm.
const NEAREST_CM: f64 = 1.0;
/// A foot within this of its wall's end may be that end itself, cm.
const END_CM: f64 = 1e-6;

/// The targets of a sensor, nearest first, without such as cannot be the first echo whatever the sensor's parameters:
/// a wall behind another part of a wall that is nearer to the axis and faces the sensor more.
pub fn targets_at(surfaces: &Surfaces, sensor: &Pose) -> Vec<Target> {
    let mut targets: Vec<Target> = rays(surfaces, sensor).collect();
    targets.extend(feet(surfaces, sensor));
    targets.extend(corners(surfaces, sensor));
    targets.sort_by(|a, b| a.distance_cm.total_cmp(&b.distance_cm));
    let mut heard: Vec<Target> = Vec::with_capacity(targets.len());
    for target in targets {
        if !heard.iter().any(|nearer| nearer.masks(&target)) {
            heard.push(target);
        }
    }
    heard.iter_mut().for_each(|target| *target = target.with_known());
    heard
}

impl Target {
    /// A target at a distance in cm, so many degrees off the axis.
    pub fn new(distance_cm: f64, off_axis_deg: f64, kind: TargetKind) -> Self {
        Target::unknown(distance_cm, off_axis_deg, kind).with_known()
    }

    /// The same before what follows from its place is worked out.
    fn unknown(distance_cm: f64, off_axis_deg: f64, kind: TargetKind) -> Self {
        Target { distance_cm, off_axis_deg, kind, known: Known::default() }
    }

    fn with_known(self) -> Self {
        let incidence_deg = self.incidence_deg().unwrap_or(0.0);
        // A uniform distribution has a standard deviation of its width over the root of twelve.
        let spacing = libm::tan(incidence_deg.min(GRAZING_DEG).to_radians()) * SPACING_DEG.to_radians() / 12f64.sqrt();
        let known = Known {
            shaped: shaped(self.distance_cm / 100.0, incidence_deg / 45.0),
            log_off_axis: libm::log(self.off_axis_deg),
            between_cm: self.distance_cm * spacing,
        };
        Target { known, ..self }
    }

    /// The incidence of a wall, degrees.
    pub fn incidence_deg(&self) -> Option<f64> {
        match self.kind {
            TargetKind::Ray { incidence_deg } => Some(incidence_deg),
            TargetKind::Foot => Some(0.0),
            TargetKind::Corner | TargetKind::Edge => None,
        }
    }

    /// Whether this, which is nearer, is stronger for certain.
    fn masks(&self, farther: &Target) -> bool {
        let faces_more = match (self.incidence_deg(), farther.incidence_deg()) {
            (Some(own), Some(other)) => own <= other,
            (None, None) => self.kind == farther.kind,
            _ => false,
        };
        faces_more && self.off_axis_deg <= farther.off_axis_deg
    }
}

fn rays(surfaces: &Surfaces, sensor: &Pose) -> impl Iterator<Item = Target> {
    let (axis, axis_deg) = (sensor.direction(), sensor.heading_rad.to_degrees());
    FAN.iter().filter_map(move |(off_axis_deg, turn)| {
        let (distance_cm, wall) = first_met(&surfaces.walls, sensor.position_cm, axis.rotate(*turn))?;
        let kind = TargetKind::Ray { incidence_deg: surfaces.incidence_deg(wall, axis_deg + off_axis_deg) };
        Some(Target::unknown(distance_cm.max(NEAREST_CM), off_axis_deg.abs(), kind))
    })
}

/// The rays: their angles off the axis, degrees, and the unit vectors there if the axis is that of x.
static FAN: LazyLock<Vec<(f64, DVec2)>> = LazyLock::new(|| {
    let ray = |ray: i32| SPACING_DEG * f64::from(ray);
    (-RAYS..=RAYS).map(|number| (ray(number), direction(ray(number).to_radians()))).collect()
});

/// The feet of the perpendiculars that lie on their walls. The nearest point of a wall to which no perpendicular leads is
/// its end, and that is no mirror.
fn feet(surfaces: &Surfaces, sensor: &Pose) -> impl Iterator<Item = Target> {
    surfaces.walls.iter().filter_map(|wall| {
        let foot_cm = wall.nearest(sensor.position_cm);
        let is_inside = [wall.from_cm, wall.to_cm].iter().all(|end| end.distance(foot_cm) > END_CM);
        is_inside.then(|| point(surfaces, sensor, foot_cm, TargetKind::Foot))?
    })
}

fn corners(surfaces: &Surfaces, sensor: &Pose) -> impl Iterator<Item = Target> {
    surfaces.corners.iter().filter_map(|corner| {
        let kind = match corner.side(sensor.position_cm) {
            Side::Concave => TargetKind::Corner,
            Side::Convex => TargetKind::Edge,
            Side::Flat => return None,
        };
        point(surfaces, sensor, corner.at_cm, kind)
    })
}

/// A point as a target, if it is within the beam and in sight.
fn point(surfaces: &Surfaces, sensor: &Pose, at_cm: glam::DVec2, kind: TargetKind) -> Option<Target> {
    let way = at_cm - sensor.position_cm;
    let distance_cm = way.length();
    let off_axis_deg = wrap_rad(libm::atan2(way.y, way.x) - sensor.heading_rad).abs().to_degrees();
    let is_heard = distance_cm > 0.0
        && off_axis_deg <= SPACING_DEG * f64::from(RAYS)
        && surfaces.is_visible(sensor.position_cm, at_cm);
    is_heard.then(|| Target::unknown(distance_cm.max(NEAREST_CM), off_axis_deg, kind))
}
