//! A scene as lanes of robots meet it: rays to the nearest wall, and discs that sweep along a step.

use glam::DVec2;
use mindgap_core::maths::{Binary32, round};
use mindgap_core::scalar::Scalar;
use pulp::Simd;

use mindgap_foundations::geometry::{Rectangle, Wall};
use mindgap_foundations::lanes::{Lanes, Mask};
use mindgap_logs::Scene;

/// A scene prepared for lanes.
#[derive(Clone, Debug)]
pub struct Room {
    arena_cm: Option<[f32; 2]>,
    obstacles: Vec<Box>,
    walls: Vec<Segment>,
    /// Obstacles, and the rectangles round walls.
    solid: Vec<Box>,
    /// Every side again, for the exact test in double precision.
    sides: Vec<Wall>,
}

/// What a lane of rays meets.
pub struct Faced<S: Simd> {
    /// D, cm; infinite where there is nothing.
    pub distance_cm: Lanes<S>,
    /// α, degrees in 0..=90.
    pub alpha_deg: Lanes<S>,
    /// Direction of the normal there, degrees; to which side does not matter.
    pub normal_deg: Lanes<S>,
}

/// Lanes of points or vectors in the plane.
#[derive(Clone, Copy)]
pub struct Point<S: Simd> {
    /// Along x.
    pub x: Lanes<S>,
    /// Along y.
    pub y: Lanes<S>,
}

#[derive(Clone, Copy, Debug)]
struct Box {
    low: [f32; 2],
    high: [f32; 2],
}

#[derive(Clone, Copy, Debug)]
struct Segment {
    from: [f32; 2],
    along: [f32; 2],
    normal_deg: f32,
}

/// A direction is kept this far from the axes, so that its reciprocal stays finite.
const LEAST_DIRECTION: f32 = 1e-9;

impl Room {
    /// Prepares a scene.
    pub fn new(scene: &Scene) -> Self {
        let pair = |v: DVec2| [v.x as f32, v.y as f32];
        let segment = |w: &Wall| {
            let along = w.to_cm - w.from_cm;
            let normal_deg = libm::atan2(along.x, -along.y).to_degrees() as f32;
            Segment { from: pair(w.from_cm), along: pair(along), normal_deg }
        };
        let rectangle = |r: &Rectangle| Box { low: pair(r.low_cm), high: pair(r.high_cm) };
        let obstacles: Vec<Box> = scene.obstacles.iter().map(rectangle).collect();
        let walls: Vec<Segment> = scene.walls.iter().map(segment).collect();
        Room {
            arena_cm: scene.arena_cm.map(pair),
            solid: obstacles.iter().copied().chain(walls.iter().map(Segment::bounds)).collect(),
            obstacles,
            walls,
            sides: scene.sides(),
        }
    }

    /// What rays meet first. `direction` has length one and points to `angle_deg`.
    #[inline(always)]
    pub fn cast<S: Simd>(&self, origin: Point<S>, direction: Point<S>, angle_deg: Lanes<S>) -> Faced<S> {
        let (zero, right_angle) = (angle_deg.constant(0.0), angle_deg.constant(90.0));
        let one = angle_deg.constant(1.0);
        let (dx, dy) = (away_from_zero(direction.x), away_from_zero(direction.y));
        let (per_x, per_y) = (one / dx, one / dy);
        let mut nearest = Nearest { distance_cm: one.constant(f32::INFINITY), normal_deg: zero };
        if let Some([width, height]) = self.arena_cm {
            let at_x = (zero.less(dx).select(one.constant(width), zero) - origin.x) * per_x;
            let at_y = (zero.less(dy).select(one.constant(height), zero) - origin.y) * per_y;
            let vertical = at_x.less(at_y);
            let at = vertical.select(at_x, at_y);
            nearest.meet(at, vertical.select(zero, right_angle), !at.less(zero));
        }
        for Box { low, high } in &self.obstacles {
            let low_x = (zero.constant(low[0]) - origin.x) * per_x;
            let high_x = (zero.constant(high[0]) - origin.x) * per_x;
            let low_y = (zero.constant(low[1]) - origin.y) * per_y;
            let high_y = (zero.constant(high[1]) - origin.y) * per_y;
            let (near_x, near_y) = (low_x.min(high_x), low_y.min(high_y));
            let vertical = near_y.less(near_x);
            let near = vertical.select(near_x, near_y);
            let far = low_x.max(high_x).min(low_y.max(high_y));
            nearest.meet(near, vertical.select(zero, right_angle), !far.less(near) & !near.less(zero));
        }
        for wall in &self.walls {
            let (along_x, along_y) = (zero.constant(wall.along[0]), zero.constant(wall.along[1]));
            let across = away_from_zero(dx * along_y - dy * along_x);
            let offset_x = zero.constant(wall.from[0]) - origin.x;
            let offset_y = zero.constant(wall.from[1]) - origin.y;
            let at = (offset_x * along_y - offset_y * along_x) / across;
            let share = (offset_x * dy - offset_y * dx) / across;
            let met = !at.less(zero) & !share.less(zero) & !one.less(share);
            nearest.meet(at, zero.constant(wall.normal_deg), met);
        }
        // The angle between two undirected lines: what is left of their difference beyond whole half turns.
        let half_turns = (angle_deg - nearest.normal_deg) * zero.constant(1.0 / 180.0);
        let alpha_deg = (half_turns - round(half_turns)).abs() * zero.constant(180.0);
        Faced { distance_cm: nearest.distance_cm, alpha_deg, normal_deg: nearest.normal_deg }
    }

    /// Where discs that sweep along straight steps may touch something: everywhere that they do, and rarely elsewhere
    /// (beside corners), so that [`Room::touch`] has to be asked there only.
    #[inline(always)]
    pub fn may_touch<S: Simd>(&self, from: Point<S>, to: Point<S>, radius_cm: f32) -> Mask<S> {
        let (half, zero) = (from.x.constant(0.5), from.x.constant(0.0));
        let (middle_x, middle_y) = ((from.x + to.x) * half, (from.y + to.y) * half);
        let (half_x, half_y) = ((to.x - from.x) * half, (to.y - from.y) * half);
        let (reach_x, reach_y) = (half_x.abs(), half_y.abs());
        let mut touching = zero.less(zero);
        if let Some([width, height]) = self.arena_cm {
            let low = zero.constant(radius_cm);
            let (high_x, high_y) = (zero.constant(width - radius_cm), zero.constant(height - radius_cm));
            // The arena is convex: with both ends inside, the whole way is.
            touching = outside(from.x, low, high_x)
                | outside(from.y, low, high_y)
                | outside(to.x, low, high_x)
                | outside(to.y, low, high_y);
        }
        for Box { low, high } in &self.solid {
            // Separating axes of a straight piece and a rectangle widened by the radius.
            let extent_x = zero.constant(0.5 * (high[0] - low[0]) + radius_cm);
            let extent_y = zero.constant(0.5 * (high[1] - low[1]) + radius_cm);
            let offset_x = middle_x - zero.constant(0.5 * (low[0] + high[0]));
            let offset_y = middle_y - zero.constant(0.5 * (low[1] + high[1]));
            let across = (half_x * offset_y - half_y * offset_x).abs();
            let apart = (extent_x + reach_x).less(offset_x.abs())
                | (extent_y + reach_y).less(offset_y.abs())
                | (extent_x * reach_y + extent_y * reach_x).less(across);
            touching = touching | !apart;
        }
        touching
    }

    /// The share of a straight step after which a disc first touches something, exact to a thousandth; `None` where it
    /// touches nothing.
    pub fn touch(&self, from_cm: DVec2, to_cm: DVec2, radius_cm: f64) -> Option<f64> {
        let way = |share: f64| Wall { from_cm, to_cm: from_cm.lerp(to_cm, share) };
        let in_reach = |side: &&Wall| {
            let (low, high) = (from_cm.min(to_cm) - radius_cm, from_cm.max(to_cm) + radius_cm);
            side.from_cm.max(side.to_cm).cmpge(low).all() && side.from_cm.min(side.to_cm).cmple(high).all()
        };
        let touched = |side: &&Wall| in_reach(side) && side.distance_cm(&way(1.0)) <= radius_cm;
        let near: Vec<&Wall> = self.sides.iter().filter(touched).collect();
        let touches = |share: f64| near.iter().any(|side| side.distance_cm(&way(share)) <= radius_cm);
        if near.is_empty() {
            return None;
        }
        let (mut free, mut touching) = (0.0, 1.0);
        while touching - free > 0.001 {
            let middle = 0.5 * (free + touching);
            if touches(middle) { touching = middle } else { free = middle }
        }
        Some(touching)
    }
}

/// The nearest that a lane of rays has met so far.
struct Nearest<S: Simd> {
    distance_cm: Lanes<S>,
    normal_deg: Lanes<S>,
}

impl<S: Simd> Nearest<S> {
    #[inline(always)]
    fn meet(&mut self, at_cm: Lanes<S>, normal_deg: Lanes<S>, met: Mask<S>) {
        let nearer = met & at_cm.less(self.distance_cm);
        self.distance_cm = nearer.select(at_cm, self.distance_cm);
        self.normal_deg = nearer.select(normal_deg, self.normal_deg);
    }
}

/// A component of a direction, far enough from zero for a finite reciprocal.
#[inline(always)]
fn away_from_zero<S: Simd>(component: Lanes<S>) -> Lanes<S> {
    let least = component.constant(LEAST_DIRECTION);
    component.abs().less(least).select(least, component)
}

#[inline(always)]
fn outside<S: Simd>(value: Lanes<S>, low: Lanes<S>, high: Lanes<S>) -> Mask<S> {
    value.less(low) | high.less(value)
}

impl Segment {
    fn bounds(&self) -> Box {
        let to: [f32; 2] = std::array::from_fn(|i| self.from[i] + self.along[i]);
        Box {
            low: std::array::from_fn(|i| self.from[i].min(to[i])),
            high: std::array::from_fn(|i| self.from[i].max(to[i])),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_foundations::geometry;
    use proptest::prelude::*;

    fn scene() -> Scene {
        let rectangle = |x, y, w, h| Rectangle { low_cm: DVec2::new(x, y), high_cm: DVec2::new(x + w, y + h) };
        Scene {
            arena_cm: Some(DVec2::new(300.0, 220.0)),
            obstacles: vec![rectangle(70.0, 60.0, 40.0, 25.0), rectangle(180.0, 30.0, 30.0, 60.0)],
            walls: vec![Wall { from_cm: DVec2::new(120.0, 140.0), to_cm: DVec2::new(180.0, 190.0) }],
            ..Scene::default()
        }
    }

    fn lane(value: f64) -> Lanes<pulp::Scalar> {
        Lanes::splat(pulp::Scalar::new(), value as f32)
    }

    fn point(v: DVec2) -> Point<pulp::Scalar> {
        Point { x: lane(v.x), y: lane(v.y) }
    }

    fn number(lane: Lanes<pulp::Scalar>) -> f64 {
        let mut out = [0.0];
        lane.store(&mut out);
        f64::from(out[0])
    }

    proptest! {
        #[test]
        fn rays_agree_with_the_plain_geometry(x in 5.0..295.0, y in 5.0..215.0, deg in -179.0..179.0f64) {
            let (scene, origin) = (scene(), DVec2::new(x, y));
            prop_assume!(scene.has_room_for(origin, 0.5));
            let way = geometry::direction(deg.to_radians());
            let hit = geometry::cast(&scene.sides(), origin, way).unwrap();
            let faced = Room::new(&scene).cast(point(origin), point(way), lane(deg));
            let (distance, alpha) = (number(faced.distance_cm), number(faced.alpha_deg));
            // At the very edge of an obstacle single precision may pass where double precision meets.
            let edge = scene.sides().iter().any(|s| {
                let at = origin + way * hit.distance_cm;
                at.distance(s.from_cm) < 0.05 || {
                    let at = origin + way * distance;
                    at.distance(s.from_cm) < 0.05
                }
            });
            prop_assume!(!edge);
            prop_assert!((distance - hit.distance_cm).abs() < 0.02, "{distance} {hit:?}");
            prop_assert!((alpha - hit.incidence_rad.abs().to_degrees()).abs() < 0.01, "{alpha} {hit:?}");
        }

        #[test]
        fn nothing_that_touches_is_missed(
            x in 11.0..289.0, y in 11.0..209.0, dx in -20.0..20.0, dy in -20.0..20.0,
        ) {
            let (scene, from) = (scene(), DVec2::new(x, y));
            prop_assume!(scene.has_room_for(from, 10.1));
            let to = from + DVec2::new(dx, dy);
            let room = Room::new(&scene);
            let touched = room.touch(from, to, 10.0);
            let sampled = (0..=400).map(|i| from.lerp(to, f64::from(i) / 400.0));
            let mut samples = sampled.map(|p| scene.has_room_for(p, 10.0));
            let first = samples.position(|free| !free);
            match (touched, first) {
                (Some(share), Some(i)) => prop_assert!((share - i as f64 / 400.0).abs() < 0.005, "{share} {i}"),
                (Some(share), None) => {
                    let at = from.lerp(to, share);
                    let near = scene.sides().iter().any(|s| s.nearest(at).distance(at) < 10.1);
                    prop_assert!(near, "{} is not near anything", at);
                }
                (None, Some(_)) => prop_assert!(false, "missed"),
                (None, None) => (),
            }
            let may = room.may_touch(point(from), point(to), 10.0).any();
            prop_assert!(may || touched.is_none());
        }
    }

    #[test]
    fn the_middle_of_a_step_counts() {
        let room = Room::new(&scene());
        // Both ends are free, the way between them leads through a corner.
        let (from, to) = (DVec2::new(55.0, 75.0), DVec2::new(85.0, 45.0));
        assert!(room.touch(from, to, 10.0).is_some());
        assert!(room.may_touch(point(from), point(to), 10.0).any());
    }
}
