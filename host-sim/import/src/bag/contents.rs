//! The topics of a bag, with their types, rates and times.

use std::collections::BTreeMap;
use std::path::Path;

use super::item::{Ending, Item, Wire};
use super::messages::{Encoding, is_relevant};
use super::{container, parts};
use crate::contents::{Contents, StreamContents};
use mindgap_foundations::error::Result;

/// A topic, or the messages of one type if it has several.
#[derive(Clone, Debug)]
pub struct Topic {
    /// Name.
    pub name: String,
    /// Message type.
    pub schema: String,
    /// Encoding of its messages.
    pub wire: Wire,
    /// Number of messages.
    pub rows: usize,
    /// Number of messages that are not of the stated type.
    pub undecodable: usize,
    /// Whether messages of its type can be decoded.
    pub is_relevant: bool,
    /// First and last logging time, ms.
    pub logged_ms: [f64; 2],
}

/// The topics of a bag, by name and type.
#[derive(Default)]
pub struct Counts(BTreeMap<String, BTreeMap<String, Topic>>);

/// Ends of the names of message types that command what a differential drive cannot do, with the reason.
const UNMODELLED: [(&str, &str); 2] = [
    ("/AckermannDrive", "commands a steering angle, which is not modelled: only forward speed and turn rate are"),
    (
        "/AckermannDriveStamped",
        "commands a steering angle, which is not modelled: only forward speed and turn rate are",
    ),
];

/// Describes the bag at `path` without decoding its messages.
///
/// # Errors
/// When it cannot be read.
pub fn contents(path: &Path) -> Result<Contents> {
    let mut counts = Counts::default();
    let files = parts::of(path)?;
    let mut is_cut = false;
    for part in &files {
        let ending = container::read(part, |item| {
            counts.count(&item);
            Ok(())
        })?;
        is_cut |= ending == Ending::Truncated;
    }
    let topics = counts.topics();
    let logged = |of: fn(&Topic) -> f64, best: fn(f64, f64) -> f64| topics.iter().map(of).reduce(best);
    let [first, last] = [logged(|topic| topic.logged_ms[0], f64::min), logged(|topic| topic.logged_ms[1], f64::max)];
    let ros = if topics.iter().any(|topic| topic.wire == Wire::Known(Encoding::Ros1)) { "1" } else { "2" };
    let parts = if files.len() == 1 { String::new() } else { format!(" in {} parts", files.len()) };
    let cut = if is_cut { ", cut off at its end" } else { "" };
    Ok(Contents {
        kind: format!("a bag of ROS {ros}{parts}{cut}"),
        seconds: first.zip(last).map(|(first, last)| (last - first) / 1e3),
        streams: topics.iter().map(Topic::described).collect(),
        bodies: Vec::new(),
    })
}

impl Counts {
    /// Counts a message, and returns its topic.
    pub(super) fn count(&mut self, item: &Item) -> &mut Topic {
        // Most messages are of known topics, whose names need no copy.
        if !self.0.get(item.topic).is_some_and(|types| types.contains_key(item.schema)) {
            let topic = Topic {
                name: item.topic.into(),
                schema: item.schema.into(),
                wire: item.wire,
                rows: 0,
                undecodable: 0,
                is_relevant: is_relevant(item.schema),
                logged_ms: [item.log_ms; 2],
            };
            self.0.entry(item.topic.into()).or_default().insert(item.schema.into(), topic);
        }
        let types = self.0.get_mut(item.topic).expect("inserted above");
        let topic = types.get_mut(item.schema).expect("inserted above");
        topic.rows += 1;
        topic.logged_ms = [topic.logged_ms[0].min(item.log_ms), topic.logged_ms[1].max(item.log_ms)];
        topic
    }

    /// Returns the topics by name.
    pub fn topics(self) -> Vec<Topic> {
        self.0.into_values().flat_map(BTreeMap::into_values).collect()
    }
}

impl Topic {
    fn described(&self) -> StreamContents {
        let seconds = (self.logged_ms[1] - self.logged_ms[0]) / 1e3;
        let rate_hz = (seconds > 0.0).then(|| (self.rows - 1) as f64 / seconds);
        StreamContents { name: self.name.clone(), r#type: self.schema.clone(), rate_hz, rows: self.rows }
    }

    /// Returns whether it commands what is not modelled.
    pub(super) fn is_unmodelled_command(&self) -> bool {
        UNMODELLED.iter().any(|(end, _)| self.schema.ends_with(end))
    }

    /// Returns why it is not used.
    pub(super) fn why_unused(&self) -> String {
        let unmodelled = UNMODELLED.iter().find(|(end, _)| self.schema.ends_with(end));
        match unmodelled {
            Some((_, why)) => (*why).into(),
            None if self.schema.ends_with("/TwistWithCovarianceStamped") => "a measured velocity, not a command".into(),
            None if self.schema.ends_with("/JointState") => "no positions of joints".into(),
            None if self.schema.ends_with("/Imu") => "no turn rates".into(),
            None if self.is_relevant => "another topic of its kind was chosen, or none is needed".into(),
            None => format!("messages of type {} are not used", self.schema),
        }
    }
}
