//! Poses, walls and rays in the plane: centimetres, radians, x to the right, y up, headings counter-clockwise from +x.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

/// A position and a heading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Position in the world, cm.
    pub position_cm: DVec2,
    /// Heading in (-π, π].
    pub heading_rad: f64,
}

/// A straight wall segment, or one edge of an obstacle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wall {
    /// One end, cm.
    pub from_cm: DVec2,
    /// The other end, cm.
    pub to_cm: DVec2,
}

/// An axis-parallel rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rectangle {
    /// Lower-left corner, cm.
    pub low_cm: DVec2,
    /// Upper-right corner, cm.
    pub high_cm: DVec2,
}

/// Where a ray first meets a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance from the ray's origin, cm (D in the paper's figure 1).
    pub distance_cm: f64,
    /// Incidence angle: from the reversed ray to the wall's normal on the ray's side, in (-π/2, π/2), positive if the normal
    /// lies counter-clockwise of the ray. Its magnitude is α in the paper's figure 1.
    pub incidence_rad: f64,
    /// Index of the wall in the list.
    pub wall: usize,
}

impl Pose {
    /// Returns a pose with the heading wrapped to (-π, π].
    pub fn new(x_cm: f64, y_cm: f64, heading_rad: f64) -> Self {
        Pose { position_cm: DVec2::new(x_cm, y_cm), heading_rad: wrap_rad(heading_rad) }
    }

    /// Returns the unit vector along the heading.
    pub fn direction(&self) -> DVec2 {
        direction(self.heading_rad)
    }

    /// Returns `other` in this pose's frame: forward, left, and the turn to its heading.
    pub fn relative(&self, other: &Pose) -> Pose {
        let unturn = direction(-self.heading_rad);
        let position_cm = unturn.rotate(other.position_cm - self.position_cm);
        Pose { position_cm, heading_rad: wrap_rad(other.heading_rad - self.heading_rad) }
    }

    /// Returns the pose after `share` of the way to another: 0 is this one, 1 the other. The heading turns the shorter way.
    pub fn between(&self, other: &Pose, share: f64) -> Pose {
        let at_cm = self.position_cm.lerp(other.position_cm, share);
        let turn_rad = wrap_rad(other.heading_rad - self.heading_rad);
        Pose::new(at_cm.x, at_cm.y, self.heading_rad + share * turn_rad)
    }

    /// Returns the world pose of `relative`, given in this pose's frame: the inverse of [`Pose::relative`].
    pub fn compose(&self, relative: &Pose) -> Pose {
        Pose {
            position_cm: self.position_cm + self.direction().rotate(relative.position_cm),
            heading_rad: wrap_rad(self.heading_rad + relative.heading_rad),
        }
    }
}

impl Rectangle {
    /// Returns whether a point lies inside or on the edge.
    pub fn contains(&self, point_cm: DVec2) -> bool {
        point_cm.cmpge(self.low_cm).all() && point_cm.cmple(self.high_cm).all()
    }

    /// Returns the four edges, counter-clockwise from the lower left corner.
    pub fn edges(&self) -> [Wall; 4] {
        let (low, high) = (self.low_cm, self.high_cm);
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        std::array::from_fn(|i| Wall { from_cm: corners[i], to_cm: corners[(i + 1) % 4] })
    }
}

/// Returns the smallest axis-parallel rectangle that contains all walls, or `None` without walls.
pub fn bounding_box(walls: &[Wall]) -> Option<Rectangle> {
    let ends = || walls.iter().flat_map(|wall| [wall.from_cm, wall.to_cm]);
    let low_cm = ends().reduce(DVec2::min)?;
    let high_cm = ends().reduce(DVec2::max)?;
    Some(Rectangle { low_cm, high_cm })
}

impl Wall {
    /// Returns the distance along a ray to this wall, cm, if the ray hits it; `direction` has length one.
    pub fn distance_along_cm(&self, origin_cm: DVec2, direction: DVec2) -> Option<f64> {
        let along = self.to_cm - self.from_cm;
        let across = direction.perp_dot(along);
        if across == 0.0 {
            return None;
        }
        let offset = self.from_cm - origin_cm;
        let distance_cm = offset.perp_dot(along) / across;
        let is_hit = distance_cm >= 0.0 && (0.0..=1.0).contains(&(offset.perp_dot(direction) / across));
        is_hit.then_some(distance_cm)
    }

    /// Returns the signed incidence angle of a ray that hits this wall (see [`Hit::incidence_rad`]).
    fn incidence_rad(&self, direction: DVec2) -> f64 {
        let along = self.to_cm - self.from_cm;
        let normal = along.perp() * direction.perp_dot(along).signum();
        let back = -direction;
        let normal = if normal.dot(back) < 0.0 { -normal } else { normal };
        libm::atan2(back.perp_dot(normal), back.dot(normal))
    }

    /// Returns the point of this wall nearest to `point_cm`.
    pub fn nearest(&self, point_cm: DVec2) -> DVec2 {
        let along = self.to_cm - self.from_cm;
        let length2 = along.length_squared();
        let share = if length2 > 0.0 { ((point_cm - self.from_cm).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
        self.from_cm + along * share
    }

    /// Returns the smallest distance between two segments, cm; zero if they cross.
    pub fn distance_cm(&self, other: &Wall) -> f64 {
        let (p, r) = (self.from_cm, self.to_cm - self.from_cm);
        let (q, s) = (other.from_cm, other.to_cm - other.from_cm);
        let across = r.perp_dot(s);
        if across != 0.0 {
            let (t, u) = ((q - p).perp_dot(s) / across, (q - p).perp_dot(r) / across);
            if (0.0..=1.0).contains(&t) && (0.0..=1.0).contains(&u) {
                return 0.0;
            }
        }
        let ends = [
            self.nearest(other.from_cm).distance(other.from_cm),
            self.nearest(other.to_cm).distance(other.to_cm),
            other.nearest(self.from_cm).distance(self.from_cm),
            other.nearest(self.to_cm).distance(self.to_cm),
        ];
        ends.into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// Returns where a ray first hits a wall; `direction` has length one.
pub fn cast(walls: &[Wall], origin_cm: DVec2, direction: DVec2) -> Option<Hit> {
    let (distance_cm, wall) = first_hit(walls, origin_cm, direction)?;
    Some(Hit { distance_cm, incidence_rad: walls[wall].incidence_rad(direction), wall })
}

/// Returns the distance to the first wall that a ray hits, cm, and that wall's index; `direction` has length one.
pub fn first_hit(walls: &[Wall], origin_cm: DVec2, direction: DVec2) -> Option<(f64, usize)> {
    let mut first: Option<(f64, usize)> = None;
    for (wall, w) in walls.iter().enumerate() {
        if let Some(distance_cm) = w.distance_along_cm(origin_cm, direction)
            && first.is_none_or(|(nearest_cm, _)| distance_cm < nearest_cm)
        {
            first = Some((distance_cm, wall));
        }
    }
    first
}

/// Returns the unit vector at an angle.
pub fn direction(angle_rad: f64) -> DVec2 {
    DVec2::new(libm::cos(angle_rad), libm::sin(angle_rad))
}

/// Wraps an angle to (-π, π].
pub fn wrap_rad(angle_rad: f64) -> f64 {
    let wrapped = angle_rad - TAU * libm::round(angle_rad / TAU);
    if wrapped <= -PI { wrapped + TAU } else { wrapped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn room() -> Vec<Wall> {
        Rectangle { low_cm: DVec2::ZERO, high_cm: DVec2::new(300.0, 220.0) }.edges().to_vec()
    }

    #[test]
    fn head_on_ray_has_zero_incidence() {
        let hit = cast(&room(), DVec2::new(100.0, 50.0), DVec2::X).unwrap();
        assert_eq!((hit.distance_cm, hit.incidence_rad, hit.wall), (200.0, 0.0, 1));
    }

    #[test]
    fn sign_of_incidence_gives_the_side() {
        let hit = cast(&room(), DVec2::new(100.0, 50.0), direction(0.3)).unwrap();
        // The normal points to -x (heading π); the reversed ray points to 0.3 - π, so the normal lies clockwise of it.
        assert!((hit.incidence_rad + 0.3).abs() < 1e-12);
        let hit = cast(&room(), DVec2::new(100.0, 50.0), direction(-0.2)).unwrap();
        assert!((hit.incidence_rad - 0.2).abs() < 1e-12);
    }

    #[test]
    fn open_map_gives_no_hit() {
        let wall = Wall { from_cm: DVec2::new(0.0, 10.0), to_cm: DVec2::new(10.0, 10.0) };
        assert_eq!(cast(&[wall], DVec2::new(5.0, 0.0), DVec2::NEG_Y), None);
        assert_eq!(cast(&[wall], DVec2::new(5.0, 0.0), DVec2::X), None);
    }

    #[test]
    fn between_two_poses_the_heading_turns_the_shorter_way() {
        let [from, to] = [Pose::new(10.0, 20.0, 3.1), Pose::new(14.0, 20.0, -3.1)];
        let halfway = from.between(&to, 0.5);
        assert!(halfway.position_cm == DVec2::new(12.0, 20.0) && halfway.heading_rad.abs() > 3.12, "{halfway:?}");
        assert_eq!((from.between(&to, 0.0), from.between(&to, 1.0).position_cm), (from, to.position_cm));
    }

    #[test]
    fn half_turn_wraps_to_positive() {
        assert_eq!(wrap_rad(-PI), PI);
        assert_eq!(wrap_rad(3.0 * PI), PI);
    }

    fn pose() -> impl Strategy<Value = Pose> {
        (-300.0..300.0, -300.0..300.0, -PI..PI).prop_map(|(x, y, h)| Pose::new(x, y, h))
    }

    proptest! {
        #[test]
        fn compose_inverts_relative(a in pose(), b in pose()) {
            let back = a.compose(&a.relative(&b));
            prop_assert!(back.position_cm.distance(b.position_cm) < 1e-9);
            prop_assert!(wrap_rad(back.heading_rad - b.heading_rad).abs() < 1e-12);
        }

        #[test]
        fn every_ray_inside_a_room_hits_the_reported_point(x in 1.0..299.0, y in 1.0..219.0, h in -PI..PI) {
            let (origin, along) = (DVec2::new(x, y), direction(h));
            let hit = cast(&room(), origin, along).unwrap();
            let at = origin + along * hit.distance_cm;
            prop_assert!(room()[hit.wall].nearest(at).distance(at) < 1e-9);
            prop_assert!(hit.incidence_rad.abs() <= PI / 2.0);
            let normal_distance = room()[hit.wall].nearest(origin).distance(origin);
            prop_assert!((hit.distance_cm * libm::cos(hit.incidence_rad) - normal_distance).abs() < 1e-6);
        }

        #[test]
        fn distance_between_segments_is_the_minimum_over_their_points(
            a in prop::array::uniform4(-50.0..50.0), b in prop::array::uniform4(-50.0..50.0),
        ) {
            let wall = |v: [f64; 4]| Wall { from_cm: DVec2::new(v[0], v[1]), to_cm: DVec2::new(v[2], v[3]) };
            let (a, b) = (wall(a), wall(b));
            let sampled = (0..=2000).map(|i| {
                let p = a.from_cm.lerp(a.to_cm, f64::from(i) / 2000.0);
                b.nearest(p).distance(p)
            }).fold(f64::INFINITY, f64::min);
            let exact = a.distance_cm(&b);
            prop_assert!(exact <= sampled + 1e-9 && sampled - exact < 0.05, "{exact} {sampled}");
        }
    }
}
