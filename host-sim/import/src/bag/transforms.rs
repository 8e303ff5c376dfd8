//! Composes chains of transforms into the pose of a robot in a fixed frame.
//!
//! A localiser publishes the pose of `odom` in `map`, the base its pose in `odom`, and a static transform the axle on the base.
//! As in tf, all are interpolated at one time.

use std::collections::BTreeMap;

use super::messages::Decoded;
use super::roles::{is_body, is_fixed};
use super::{Sample, Stream};
use crate::spatial_pose::SpatialPose;

/// Maximum depth of a robot's frames, which also ends cycles.
const MAX_DEPTH: usize = 16;

/// The pose of a frame in its parent over time.
struct Link {
    /// Name of the stream.
    name: String,
    parent: String,
    /// Poses with their times, ms, in order; a static frame has one.
    poses: Vec<(f64, SpatialPose)>,
}

/// Returns composed streams of robots in fixed frames, named like single transforms. Chains are omitted if there is such a
/// single transform or only the robot's odometry moves. `selected` is the stream that the user names.
pub fn chains(streams: &BTreeMap<String, Stream>, selected: Option<&str>) -> Vec<(String, Stream)> {
    let mut trees: BTreeMap<&str, BTreeMap<&str, Link>> = BTreeMap::new();
    for name in streams.keys() {
        let Some((topic, parent, child)) = frames(name) else { continue };
        let tree = trees.entry(topic.trim_end_matches("_static")).or_default();
        tree.entry(child).or_insert_with(|| Link {
            name: name.clone(),
            parent: parent.into(),
            poses: poses(&streams[name], topic.ends_with("_static")),
        });
    }
    let chains_of_tree = |(topic, tree): (&&str, &BTreeMap<&str, Link>)| {
        let chain = |child: &&str| {
            let name = |parent: &str| format!("{topic}:{parent}>{child}");
            let is_selected = |parent: &str| selected == Some(name(parent).as_str());
            let links = path_to_root(tree, child, |parent| is_selected(parent) || is_fixed(parent))?;
            let parent = links.last()?.parent.as_str();
            let passes_another_body = links.iter().any(|link| is_body(&link.parent));
            let is_wanted = is_body(child) && !passes_another_body && !is_pure_odometry(&links) || is_selected(parent);
            let composed = composed(&links, streams).filter(|_| is_wanted && links.len() > 1)?;
            Some((name(parent), composed))
        };
        tree.keys().filter_map(chain).collect::<Vec<_>>()
    };
    trees.iter().flat_map(chains_of_tree).collect()
}

/// Returns topic, parent and child of a stream of transforms.
fn frames(name: &str) -> Option<(&str, &str, &str)> {
    let (topic, frames) = name.rsplit_once(':')?;
    let (parent, child) = frames.split_once('>')?;
    Some((topic, parent, child))
}

fn poses(stream: &Stream, is_static: bool) -> Vec<(f64, SpatialPose)> {
    let pose = |sample: &Sample| match sample.value {
        Decoded::Pose(pose) => Some((sample.stamp_or_log_ms(), pose?)),
        _ => None,
    };
    let mut poses: Vec<(f64, SpatialPose)> = stream.samples.iter().filter_map(pose).collect();
    poses.sort_by(|a, b| a.0.total_cmp(&b.0));
    if is_static {
        poses.drain(..poses.len().saturating_sub(1));
    }
    poses
}

/// Returns the links from a frame up to the first end; `None` if no end can be reached.
fn path_to_root<'a>(
    tree: &'a BTreeMap<&str, Link>,
    child: &str,
    is_end: impl Fn(&str) -> bool,
) -> Option<Vec<&'a Link>> {
    let mut links = vec![tree.get(child)?];
    while !is_end(&links.last()?.parent) {
        if links.len() == MAX_DEPTH {
            return None;
        }
        links.push(tree.get(links.last()?.parent.as_str())?);
    }
    Some(links)
}

/// Returns whether only the robot's odometry moves, while its frame is static in the fixed one.
fn is_pure_odometry(links: &[&Link]) -> bool {
    let mut moving = links.iter().filter(|link| link.poses.len() > 1);
    let is_odometry = moving.next().is_some_and(|link| link.parent.rsplit('/').next() == Some("odom"));
    is_odometry && moving.next().is_none()
}

/// Composes links at the times of the lowest moving one.
fn composed(links: &[&Link], streams: &BTreeMap<String, Stream>) -> Option<Stream> {
    let lowest = links.iter().find(|link| link.poses.len() > 1)?;
    let at = |ms: f64| {
        let down = links.iter().rev().map(|link| link.at(ms));
        down.reduce(|above, below| Some(above?.compose(&below?))).flatten()
    };
    let stream = &streams[&lowest.name];
    let sample = |sample: &Sample| Sample { value: Decoded::Pose(at(sample.stamp_or_log_ms())), ..*sample };
    Some(Stream {
        schema: stream.schema.clone(),
        samples: stream.samples.iter().map(sample).collect(),
        composed_of: links.iter().rev().map(|link| link.name.clone()).collect(),
        ..Stream::default()
    })
}

impl Link {
    /// Returns the pose of the frame at a time; `None` before its first pose. The last pose holds thereafter.
    fn at(&self, ms: f64) -> Option<SpatialPose> {
        if let [(_, always)] = self.poses.as_slice() {
            return Some(*always);
        }
        let after = self.poses.partition_point(|(at_ms, _)| *at_ms <= ms);
        let (from_ms, from) = self.poses.get(after.checked_sub(1)?)?;
        let Some((to_ms, to)) = self.poses.get(after) else { return Some(*from) };
        let share = (ms - from_ms) / (to_ms - from_ms);
        Some(from.between(to, share))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use glam::{DQuat, DVec3};

    use super::*;
    use crate::upright::Axis;

    /// A pose on the floor, cm and rad.
    fn pose(x: f64, y: f64, rad: f64) -> SpatialPose {
        let rotation = DQuat::from_xyzw(0.0, 0.0, libm::sin(rad / 2.0), libm::cos(rad / 2.0));
        SpatialPose { at_cm: DVec3::new(x, y, 0.0), rotation }
    }

    /// A stream of poses at times.
    fn stream(name: &str, poses: &[(f64, SpatialPose)]) -> (String, Stream) {
        let sample =
            |(ms, pose): &(f64, SpatialPose)| Sample { log_ms: *ms, stamp_ms: None, value: Decoded::Pose(Some(*pose)) };
        let samples = poses.iter().map(sample).collect();
        (name.into(), Stream { schema: "tf2_msgs/msg/TFMessage".into(), samples, ..Stream::default() })
    }

    fn localised() -> BTreeMap<String, Stream> {
        BTreeMap::from([
            // The localiser moves the odometry frame by 10 cm in 100 ms.
            stream("/tf:map>odom", &[(0.0, pose(0.0, 0.0, FRAC_PI_2)), (100.0, pose(10.0, 0.0, FRAC_PI_2))]),
            stream("/tf:odom>base_footprint", &[(-5.0, pose(0.0, 0.0, 0.0)), (50.0, pose(20.0, 0.0, 0.0))]),
            stream("/tf_static:base_footprint>base_link", &[(-9.0, pose(1.0, 0.0, 0.0))]),
        ])
    }

    #[test]
    fn chain_is_composed_at_the_times_of_the_lowest_moving_frame() {
        let chains = chains(&localised(), None);
        let [(name, chain)] = chains.as_slice() else { panic!("{} chains", chains.len()) };
        assert_eq!(name, "/tf:map>base_footprint");
        assert_eq!(chain.composed_of, ["/tf:map>odom", "/tf:odom>base_footprint"]);
        let Decoded::Pose(Some(composed)) = chain.samples[1].value else { panic!("no pose") };
        let pose = Axis::Z.on_floor(&composed);
        assert!((pose.position_cm - glam::DVec2::new(5.0, 20.0)).length() < 1e-9, "{pose:?}");
        assert!((pose.heading_rad - FRAC_PI_2).abs() < 1e-12);
        assert_eq!(chain.samples[0].value, Decoded::Pose(None), "before the localiser started");
    }

    #[test]
    fn user_may_select_any_frame() {
        let chains = chains(&localised(), Some("/tf:odom>base_link"));
        let parts = chains.iter().find(|(name, _)| name == "/tf:odom>base_link").map(|(_, chain)| &chain.composed_of);
        assert_eq!(parts.map(Vec::len), Some(2));
        let markers = BTreeMap::from([
            stream("/tf:room>marker", &[(0.0, pose(0.0, 0.0, 0.0)), (50.0, pose(20.0, 0.0, 0.0))]),
            stream("/tf_static:marker>axle", &[(0.0, pose(-3.0, 0.0, 0.0))]),
        ]);
        assert!(super::chains(&markers, None).is_empty());
        let chains = super::chains(&markers, Some("/tf:room>axle"));
        assert_eq!(chains.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["/tf:room>axle"]);
    }

    #[test]
    fn cycles_and_pure_odometry_are_not_chains() {
        let still = pose(0.0, 0.0, 0.0);
        let two = [(0.0, still), (50.0, pose(20.0, 0.0, 0.0))];
        let circle =
            BTreeMap::from([stream("/tf:a>base_link", &two), stream("/tf:b>a", &two), stream("/tf:a>b", &two)]);
        assert!(chains(&circle, None).is_empty());
        let odometry =
            BTreeMap::from([stream("/tf:odom>base_link", &two), stream("/tf_static:map>odom", &[(0.0, still)])]);
        assert!(chains(&odometry, None).is_empty());
    }
}
