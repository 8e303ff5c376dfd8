//! Chains of transforms: where a robot is in a fixed frame, of which its messages say only the steps between.
//!
//! A localiser says where `odom` lies in `map`, a base where it is in `odom`, and a static transform where the axle is on
//! it. As in tf, each is taken at one time, between its neighbours.

use std::collections::{BTreeMap, HashMap};

use super::messages::Decoded;
use super::topics::{is_body, is_fixed};
use super::{Sample, Stream};
use mindgap_foundations::geometry::{Pose, wrap_rad};

/// A robot's frames lie no deeper; those that go round in a circle do.
const DEEPEST: usize = 16;

/// Where a frame is in its parent.
struct Link {
    /// The stream that says so.
    name: String,
    parent: String,
    /// In order of time, ms; a frame that never moves has one.
    poses: Vec<(f64, Pose)>,
}

/// Robots in fixed frames, under the names that single transforms would have; where there is such a transform, or only
/// the robot's own reckoning moves, there is none. `said` is the name that a user gives.
pub fn chains(streams: &HashMap<String, Stream>, said: Option<&str>) -> Vec<(String, Stream)> {
    let mut trees: BTreeMap<&str, BTreeMap<&str, Link>> = BTreeMap::new();
    let mut names: Vec<&String> = streams.keys().collect();
    names.sort_unstable();
    for name in names {
        let Some((topic, parent, child)) = frames(name) else { continue };
        let tree = trees.entry(topic.trim_end_matches("_static")).or_default();
        tree.entry(child).or_insert_with(|| Link {
            name: name.clone(),
            parent: parent.into(),
            poses: poses(&streams[name], topic.ends_with("_static")),
        });
    }
    let of_tree = |(topic, tree): (&&str, &BTreeMap<&str, Link>)| {
        let chain = |child: &&str| {
            let name = |parent: &str| format!("{topic}:{parent}>{child}");
            let is_said = |parent: &str| said == Some(name(parent).as_str());
            let links = way_up(tree, child, |parent| is_said(parent) || is_fixed(parent))?;
            let parent = links.last()?.parent.as_str();
            let another_comes_first = links.iter().any(|link| is_body(&link.parent));
            let is_meant = is_body(child) && !another_comes_first && !is_reckoning(&links) || is_said(parent);
            let composed = composed(&links, streams).filter(|_| is_meant && links.len() > 1)?;
            Some((name(parent), composed))
        };
        tree.keys().filter_map(chain).collect::<Vec<_>>()
    };
    trees.iter().flat_map(of_tree).collect()
}

/// Topic, parent and child of a stream of transforms.
fn frames(name: &str) -> Option<(&str, &str, &str)> {
    let (topic, frames) = name.rsplit_once(':')?;
    let (parent, child) = frames.split_once('>')?;
    Some((topic, parent, child))
}

fn poses(stream: &Stream, is_static: bool) -> Vec<(f64, Pose)> {
    let pose = |sample: &Sample| match sample.value {
        Decoded::Pose(pose) => Some((sample.said_ms(), pose?)),
        _ => None,
    };
    let mut poses: Vec<(f64, Pose)> = stream.samples.iter().filter_map(pose).collect();
    poses.sort_by(|a, b| a.0.total_cmp(&b.0));
    if is_static {
        poses.drain(..poses.len().saturating_sub(1));
    }
    poses
}

/// The links from a frame up to the first that is an end; none where there is no way.
fn way_up<'a>(tree: &'a BTreeMap<&str, Link>, child: &str, is_end: impl Fn(&str) -> bool) -> Option<Vec<&'a Link>> {
    let mut links = vec![tree.get(child)?];
    while !is_end(&links.last()?.parent) {
        if links.len() == DEEPEST {
            return None;
        }
        links.push(tree.get(links.last()?.parent.as_str())?);
    }
    Some(links)
}

/// Whether only the robot's own reckoning moves: its frame lies in the fixed one where somebody put it once.
fn is_reckoning(links: &[&Link]) -> bool {
    let mut moving = links.iter().filter(|link| link.poses.len() > 1);
    let is_of_odometry = moving.next().is_some_and(|link| link.parent.rsplit('/').next() == Some("odom"));
    is_of_odometry && moving.next().is_none()
}

/// Links one after the other, at the times of the lowest that moves.
fn composed(links: &[&Link], streams: &HashMap<String, Stream>) -> Option<Stream> {
    let lowest = links.iter().find(|link| link.poses.len() > 1)?;
    let at = |ms: f64| {
        let down = links.iter().rev().map(|link| link.at(ms));
        down.reduce(|above, below| Some(above?.compose(&below?))).flatten()
    };
    let stream = &streams[&lowest.name];
    let sample = |sample: &Sample| Sample { value: Decoded::Pose(at(sample.said_ms())), ..*sample };
    Some(Stream {
        schema: stream.schema.clone(),
        samples: stream.samples.iter().map(sample).collect(),
        composed_of: links.iter().rev().map(|link| link.name.clone()).collect(),
    })
}

impl Link {
    /// Where the frame is at a time; none before it is first seen. The last pose holds until another one is said.
    fn at(&self, ms: f64) -> Option<Pose> {
        if let [(_, always)] = self.poses.as_slice() {
            return Some(*always);
        }
        let after = self.poses.partition_point(|(at_ms, _)| *at_ms <= ms);
        let (from_ms, from) = self.poses.get(after.checked_sub(1)?)?;
        let Some((to_ms, to)) = self.poses.get(after) else { return Some(*from) };
        let share = (ms - from_ms) / (to_ms - from_ms);
        Some(Pose {
            position_cm: from.position_cm.lerp(to.position_cm, share),
            heading_rad: wrap_rad(from.heading_rad + share * wrap_rad(to.heading_rad - from.heading_rad)),
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    /// A stream of poses at times.
    fn stream(name: &str, poses: &[(f64, Pose)]) -> (String, Stream) {
        let sample =
            |(ms, pose): &(f64, Pose)| Sample { log_ms: *ms, stamp_ms: None, value: Decoded::Pose(Some(*pose)) };
        let samples = poses.iter().map(sample).collect();
        (name.into(), Stream { schema: "tf2_msgs/msg/TFMessage".into(), samples, composed_of: Vec::new() })
    }

    fn localised() -> HashMap<String, Stream> {
        HashMap::from([
            // The localiser moves the frame of the reckoning by 10 cm in 100 ms.
            stream("/tf:map>odom", &[(0.0, Pose::new(0.0, 0.0, FRAC_PI_2)), (100.0, Pose::new(10.0, 0.0, FRAC_PI_2))]),
            stream("/tf:odom>base_footprint", &[(-5.0, Pose::new(0.0, 0.0, 0.0)), (50.0, Pose::new(20.0, 0.0, 0.0))]),
            stream("/tf_static:base_footprint>base_link", &[(-9.0, Pose::new(1.0, 0.0, 0.0))]),
        ])
    }

    #[test]
    fn a_chain_is_composed_at_the_times_of_the_lowest_that_moves() {
        let chains = chains(&localised(), None);
        let [(name, chain)] = chains.as_slice() else { panic!("{} chains", chains.len()) };
        assert_eq!(name, "/tf:map>base_footprint");
        assert_eq!(chain.composed_of, ["/tf:map>odom", "/tf:odom>base_footprint"]);
        let Decoded::Pose(Some(pose)) = chain.samples[1].value else { panic!("no pose") };
        assert!((pose.position_cm - glam::DVec2::new(5.0, 20.0)).length() < 1e-9, "{pose:?}");
        assert!((pose.heading_rad - FRAC_PI_2).abs() < 1e-12);
        assert_eq!(chain.samples[0].value, Decoded::Pose(None), "before the localiser began");
    }

    #[test]
    fn a_user_may_name_any_frame() {
        let chains = chains(&localised(), Some("/tf:odom>base_link"));
        let parts = chains.iter().find(|(name, _)| name == "/tf:odom>base_link").map(|(_, chain)| &chain.composed_of);
        assert_eq!(parts.map(Vec::len), Some(2));
        let markers = HashMap::from([
            stream("/tf:room>marker", &[(0.0, Pose::new(0.0, 0.0, 0.0)), (50.0, Pose::new(20.0, 0.0, 0.0))]),
            stream("/tf_static:marker>axle", &[(0.0, Pose::new(-3.0, 0.0, 0.0))]),
        ]);
        assert!(super::chains(&markers, None).is_empty());
        let chains = super::chains(&markers, Some("/tf:room>axle"));
        assert_eq!(chains.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), ["/tf:room>axle"]);
    }

    #[test]
    fn frames_in_a_circle_and_reckoning_alone_are_no_chain() {
        let still = Pose::new(0.0, 0.0, 0.0);
        let two = [(0.0, still), (50.0, Pose::new(20.0, 0.0, 0.0))];
        let circle = HashMap::from([stream("/tf:a>base_link", &two), stream("/tf:b>a", &two), stream("/tf:a>b", &two)]);
        assert!(chains(&circle, None).is_empty());
        let reckoning =
            HashMap::from([stream("/tf:odom>base_link", &two), stream("/tf_static:map>odom", &[(0.0, still)])]);
        assert!(chains(&reckoning, None).is_empty());
    }
}
