//! The walls that a fan of rays about a sensor's axis hits.

use std::ops::Range;
use std::sync::LazyLock;

use glam::DVec2;

use super::surfaces::Surfaces;
use mindgap_foundations::geometry::{Pose, Wall, direction};

/// The first wall that a ray hits.
pub(super) struct Met {
    /// The angle between the ray and the sensor's axis, degrees; positive to the left.
    pub off_axis_deg: f64,
    /// Distance to the wall, cm.
    pub distance_cm: f64,
    /// Index of the wall.
    pub wall: usize,
}

/// Angle between two rays, degrees.
pub(super) const SPACING_DEG: f64 = 3.0;
/// Angle of the outermost rays to either side, degrees: at 60 degrees a wall a hand's breadth away is no longer heard.
pub(super) const OUTERMOST_DEG: f64 = SPACING_DEG * TO_A_SIDE as f64;
const TO_A_SIDE: usize = 20;
const RAYS: usize = 2 * TO_A_SIDE + 1;
/// A sensor within this distance of a wall's line may be on the wall, cm.
const ON_WALL_CM: f64 = 1e-6;

/// Returns the walls that the rays hit, from the rightmost ray to the leftmost, without the rays that hit nothing.
pub(super) fn met_by_rays(surfaces: &Surfaces, sensor: &Pose) -> impl Iterator<Item = Met> {
    let axis = sensor.direction();
    let directions = FAN.each_ref().map(|(_, turn)| axis.rotate(*turn));
    let mut nearest = [(f64::INFINITY, 0); RAYS];
    for (wall, side) in surfaces.walls().iter().enumerate() {
        for ray in across(side, sensor.position_cm, axis, &directions) {
            if let Some(distance_cm) = side.distance_along_cm(sensor.position_cm, directions[ray])
                && distance_cm < nearest[ray].0
            {
                nearest[ray] = (distance_cm, wall);
            }
        }
    }
    let met = nearest.into_iter().zip(FAN.iter()).filter(|((distance_cm, _), _)| *distance_cm < f64::INFINITY);
    met.map(|((distance_cm, wall), (off_axis_deg, _))| Met { off_axis_deg: *off_axis_deg, distance_cm, wall })
}

/// The rays: their angles off the axis, degrees, and their unit vectors if the axis is +x.
static FAN: LazyLock<[(f64, DVec2); RAYS]> = LazyLock::new(|| {
    std::array::from_fn(|ray| {
        let off_axis_deg = SPACING_DEG * (ray as f64 - TO_A_SIDE as f64);
        (off_axis_deg, direction(off_axis_deg.to_radians()))
    })
});

/// Returns the rays that may hit a wall; most walls of a room lie across few of them.
fn across(wall: &Wall, from_cm: DVec2, axis: DVec2, directions: &[DVec2; RAYS]) -> Range<usize> {
    let (from, to) = (wall.from_cm - from_cm, wall.to_cm - from_cm);
    let turn = from.perp_dot(to);
    if turn.abs() <= ON_WALL_CM * from.distance(to) {
        return 0..RAYS;
    }
    let [right, left] = if turn > 0.0 { [from, to] } else { [to, from] };
    let is_ahead = |end: DVec2| end.dot(axis) > 0.0;
    if !is_ahead(right) && !is_ahead(left) {
        return 0..0;
    }
    let on_its_right = |end: DVec2| directions.partition_point(|ray| ray.perp_dot(end) > 0.0);
    // One more ray to either side, for rays that just touch an end.
    let first = if is_ahead(right) { on_its_right(right).saturating_sub(1) } else { 0 };
    let end = if is_ahead(left) { (on_its_right(left) + 1).min(RAYS) } else { RAYS };
    first..end
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use mindgap_foundations::geometry::first_hit;

    fn point() -> impl Strategy<Value = DVec2> {
        // Whole centimetres too, so that some sensors are on walls and some rays hit ends.
        let coordinate = || prop_oneof![-200.0..200.0, (-20..20).prop_map(f64::from)];
        (coordinate(), coordinate()).prop_map(|(x, y)| DVec2::new(x, y))
    }

    fn wall() -> impl Strategy<Value = Wall> {
        (point(), point()).prop_map(|(from_cm, to_cm)| Wall { from_cm, to_cm })
    }

    proptest! {
        #[test]
        fn no_wall_is_missed(
            walls in prop::collection::vec(wall(), 0..12),
            at_cm in point(),
            heading_deg in prop_oneof![-180.0..180.0, (-6..7).prop_map(|turn| 30.0 * f64::from(turn))],
        ) {
            let sensor = Pose { position_cm: at_cm, heading_rad: f64::to_radians(heading_deg) };
            let surfaces = Surfaces::new(walls.clone());
            let found: Vec<_> = met_by_rays(&surfaces, &sensor).map(|met| (met.off_axis_deg, met.distance_cm, met.wall)).collect();
            let one_by_one: Vec<_> = FAN
                .iter()
                .filter_map(|(off_axis_deg, turn)| {
                    let (distance_cm, wall) = first_hit(&walls, at_cm, sensor.direction().rotate(*turn))?;
                    Some((*off_axis_deg, distance_cm, wall))
                })
                .collect();
            prop_assert_eq!(found, one_by_one);
        }
    }
}
