//! Finds items near a pose of a sensor.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use mindgap_foundations::geometry::{Pose, wrap_rad};

/// Items by the pose of the sensor that they belong to.
pub struct PoseGrid<T> {
    cells: BTreeMap<[i32; 3], Vec<(Pose, T)>>,
}

/// Poses within this distance are near each other. A robot that is put back, or tracked again, at a pose is off by one or
/// two centimetres and degrees, and a beam of 40 degrees then covers nearly the same surfaces.
const NEAR_CM: f64 = 4.0;
/// Number of sectors of 4 degrees.
const SECTORS: i32 = 90;
const NEAR_RAD: f64 = TAU / SECTORS as f64;

impl<T> PoseGrid<T> {
    /// Makes the grid of items with their poses.
    pub fn new(items: impl IntoIterator<Item = (Pose, T)>) -> Self {
        let mut cells: BTreeMap<[i32; 3], Vec<(Pose, T)>> = BTreeMap::new();
        items.into_iter().for_each(|(pose, item)| cells.entry(cell_of(&pose)).or_default().push((pose, item)));
        PoseGrid { cells }
    }

    /// Returns the items near a pose.
    pub fn near(&self, pose: &Pose) -> impl Iterator<Item = &T> {
        let ([x, y, sector], pose) = (cell_of(pose), *pose);
        let around = (0..27).filter_map(move |i| {
            let [dx, dy, turn] = [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1];
            Some([x.checked_add(dx)?, y.checked_add(dy)?, (sector + turn).rem_euclid(SECTORS)])
        });
        let is_near = move |other: &Pose| {
            other.position_cm.distance(pose.position_cm) < NEAR_CM
                && wrap_rad(other.heading_rad - pose.heading_rad).abs() < NEAR_RAD
        };
        around
            .filter_map(|cell| self.cells.get(&cell))
            .flatten()
            .filter_map(move |(at, item)| is_near(at).then_some(item))
    }
}

fn cell_of(pose: &Pose) -> [i32; 3] {
    let [x, y] = [pose.position_cm.x, pose.position_cm.y].map(|cm| (cm / NEAR_CM).floor() as i32);
    let sector = (pose.heading_rad.rem_euclid(TAU) / NEAR_RAD).floor() as i32;
    [x, y, sector % SECTORS]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pose() -> impl Strategy<Value = Pose> {
        (-20.0..20.0f64, -20.0..20.0f64, -7.0..7.0f64).prop_map(|(x, y, heading)| Pose::new(x, y, heading))
    }

    proptest! {
        /// Finds the same pairs as comparing all poses, from both ends.
        #[test]
        fn all_near_items_are_found(poses in prop::collection::vec(pose(), 1..60)) {
            let grid = PoseGrid::new(poses.iter().enumerate().map(|(i, pose)| (*pose, i)));
            for one in &poses {
                let mut found: Vec<usize> = grid.near(one).copied().collect();
                found.sort_unstable();
                let near = |other: &Pose| {
                    one.position_cm.distance(other.position_cm) < NEAR_CM
                        && wrap_rad(one.heading_rad - other.heading_rad).abs() < NEAR_RAD
                };
                let all: Vec<usize> = (0..poses.len()).filter(|i| near(&poses[*i])).collect();
                prop_assert_eq!(found, all);
            }
        }
    }

    #[test]
    fn distant_poses_do_not_overflow() {
        let far = Pose::new(1e300, -1e300, 0.0);
        assert_eq!(PoseGrid::new([(far, 7)]).near(&far).copied().collect::<Vec<_>>(), [7]);
    }
}
