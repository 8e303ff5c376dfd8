//! Reads bags of ROS 2 and ROS 1: topics of commands, poses and readings become a recording.
//!
//! `parts` finds the files of a bag, `container` opens them (`mcap`, `sqlite`, `ros1`), `messages` decodes their messages,
//! `transforms` composes chains of frames, `topics` selects the topics (readings by `ranges`, wheels and gyro by `own_motion`), and
//! `one_clock` puts them on one clock.

mod container;
mod contents;
mod item;
mod mcap;
mod messages;
mod one_clock;
mod own_motion;
mod parts;
mod ranges;
mod roles;
#[cfg(not(target_family = "wasm"))]
mod ros1;
#[cfg(not(target_family = "wasm"))]
mod sqlite;
mod topics;
mod transforms;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use self::contents::{Counts, Topic};
use self::item::{Ending, Item, Wire};
use self::messages::{Decoded, Message, of_part};
use self::one_clock::{OneClock, check_order, sort_by_logging};
use self::own_motion::OwnStreams;
use self::topics::Topics;
use super::frame::Frame;
use super::left_out::LeftOut;
use super::own_motion::{OwnMotion, Series};
use super::recording::{Commands, Kind, Readings, Recording};
use super::report::Source;
use super::streams::Recordings;
use super::upright::Axis;
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::range_sensor::RangeSensor;

pub use self::contents::contents;
pub use self::roles::Choice;

/// Returns whether a path is a bag: a file, or the folder that a recorder writes.
pub fn is_bag(path: &Path) -> bool {
    if mindgap_files::source::is_folder(path) { parts::is_bag_folder(path) } else { container::is_bag_file(path) }
}

/// Maximum number of relevant topics and frames; no robot has more.
const MAX_TOPICS: usize = 10_000;
/// Maximum number of relevant messages, to bound memory.
const MAX_MESSAGES: usize = 50_000_000;

/// Messages of one topic, or of one frame of a transform topic.
#[derive(Clone, Default)]
pub(super) struct Stream {
    /// Message type.
    pub(super) schema: String,
    samples: Vec<Sample>,
    /// The frame of a range sensor.
    pub(super) frame: String,
    /// The streams of a chain of transforms, if this stream is their composition.
    composed_of: Vec<String>,
}

#[derive(Clone, Copy)]
struct Sample {
    log_ms: f64,
    /// Stamp in the message, if it has one.
    stamp_ms: Option<f64>,
    value: Decoded,
}

impl Sample {
    /// Returns the stamp of the message, or else its logging time.
    fn stamp_or_log_ms(&self) -> f64 {
        self.stamp_ms.unwrap_or(self.log_ms)
    }
}

/// A bag as read.
struct Bag {
    path: PathBuf,
    streams: BTreeMap<String, Stream>,
    /// All topics, including those that are not decoded, by name and type.
    topics: Vec<Topic>,
    /// Parts that were cut off.
    truncated: Vec<PathBuf>,
}

/// Reads bags, one recording or error each: a bag is a file, or a folder with its parts. Static transforms hold for the later
/// files of a bag too, which differ from the first in the number at the end of their names. `sensors` are the robot's range
/// sensors; a beam of a laser scanner in its direction stands in for each. `watch` receives the number of bags read so far.
pub fn recordings(
    paths: &[PathBuf],
    choice: &Choice,
    sensors: &[RangeSensor],
    watch: impl Fn(usize),
) -> Vec<Result<Recording>> {
    let mut fixed: BTreeMap<PathBuf, Vec<(String, Stream)>> = BTreeMap::new();
    let read = |(path, before): (&PathBuf, usize)| {
        watch(before);
        let mut bag = Bag::read(path, sensors)?;
        let known = fixed.entry(parts::stem(path)).or_default();
        for (name, stream) in known.iter() {
            bag.streams.entry(name.clone()).or_insert_with(|| stream.clone());
        }
        let is_fixed = |(name, _): &(&String, &Stream)| name.contains("_static:");
        *known = bag.streams.iter().filter(is_fixed).map(|(name, stream)| (name.clone(), stream.clone())).collect();
        bag.recording(choice, sensors)
    };
    paths.iter().zip(0..).map(read).collect()
}

/// Reads bags as [`recordings`] does. A bad bag leaves the batch.
///
/// # Errors
/// That of the first bag if no bag is good.
pub fn usable(
    paths: &[PathBuf],
    choice: &Choice,
    sensors: &[RangeSensor],
    watch: impl Fn(usize),
) -> Result<Recordings> {
    let (mut recordings, mut left_out, mut first) = (Vec::new(), Vec::new(), None);
    for (path, read) in paths.iter().zip(self::recordings(paths, choice, sensors, watch)) {
        match read {
            Ok(recording) => recordings.push(recording),
            Err(why) => {
                left_out.push(LeftOut::failed(path, &why));
                first.get_or_insert(why);
            }
        }
    }
    first.filter(|_| recordings.is_empty()).map_or(Ok(Recordings { recordings, left_out }), Err)
}

impl Bag {
    fn read(path: &Path, sensors: &[RangeSensor]) -> Result<Self> {
        let beams = ranges::beams(sensors);
        let mut bag = Bag { path: path.into(), streams: BTreeMap::new(), topics: Vec::new(), truncated: Vec::new() };
        let mut counts = Counts::default();
        let mut messages = 0;
        for part in parts::of(path)? {
            let ending = container::read(&part, |item: Item| {
                let topic = counts.count(&item);
                let (Wire::Known(encoding), true) = (item.wire, topic.is_relevant) else { return Ok(()) };
                let decoded = item.content().map(|data| messages::decode(item.schema, encoding, &data, &beams));
                match decoded {
                    Some(Message::Decoded(decoded)) => {
                        messages += decoded.len();
                        for (frame, stamp_ms, value) in decoded {
                            bag.take(&item, &frame, Sample { log_ms: item.log_ms, stamp_ms, value });
                        }
                    }
                    Some(Message::Ignored) => {}
                    Some(Message::Undecodable) | None => topic.undecodable += 1,
                }
                if messages > MAX_MESSAGES || bag.streams.len() > MAX_TOPICS {
                    let what = format!("contains more than {MAX_TOPICS} topics or {MAX_MESSAGES} relevant messages");
                    return Err(Error::in_file(&part, what));
                }
                Ok(())
            })?;
            if ending == Ending::Truncated {
                bag.truncated.push(part);
            }
        }
        for (name, stream) in &mut bag.streams {
            sort_by_logging(&mut stream.samples).map_err(|why| Error::in_file(path, format!("{name}: {why}")))?;
        }
        bag.topics = counts.topics();
        bag.name_by_topic();
        Ok(bag)
    }

    /// Names the streams of range sensors, which are named by topic and frame, by their topics alone where these have one frame.
    fn name_by_topic(&mut self) {
        for topic in self.topics.iter().filter(|topic| topic.schema.ends_with("/Range")) {
            let start = topic.name.clone() + &of_part("");
            let frames: Vec<String> = self.streams.keys().filter(|name| name.starts_with(&start)).cloned().collect();
            for name in &frames {
                let Some(mut stream) = self.streams.remove(name) else { continue };
                stream.frame = name[start.len()..].to_owned();
                self.streams.insert(if frames.len() == 1 { topic.name.clone() } else { name.clone() }, stream);
            }
        }
    }

    fn take(&mut self, item: &Item, frame: &str, sample: Sample) {
        let stream = self.streams.entry(format!("{}{frame}", item.topic)).or_default();
        if stream.schema.is_empty() {
            stream.schema = item.schema.to_owned();
        }
        stream.samples.push(sample);
    }

    fn recording(mut self, choice: &Choice, sensors: &[RangeSensor]) -> Result<Recording> {
        for (name, chain) in transforms::chains(&self.streams, choice.poses.as_deref()) {
            self.streams.entry(name).or_insert(chain);
        }
        let fail = |what| Error::in_file(&self.path, what);
        let topics = Topics::choose(&self.streams, choice, sensors).map_err(|what| fail(what + &self.undecoded()))?;
        if let Some(changed) = topics.all().find_map(|name| self.changes_type(name)) {
            return Err(fail(changed));
        }
        let clock = OneClock::of(&self.streams, &topics);
        let (commands, mut source_of_commands) = self.read_stream(&topics.commands, "commands", &clock)?;
        let (commands, sideways) = twists(commands);
        let number = commands.samples.len();
        source_of_commands.unused.extend(sideways.map(|reason| LeftOut::topic(&topics.commands, number, reason)));
        source_of_commands.unused.extend(self.left_out(&topics));
        source_of_commands.guessed.extend(topics.guessed.iter().chain(&clock.notes).cloned());
        let mut sources = vec![source_of_commands];
        let mut poses = Vec::new();
        if let Some(name) = &topics.poses {
            let (samples, mut source) = self.read_stream(name, "poses", &clock)?;
            let (frames, converted) = on_floor(samples);
            source.guessed.extend(converted);
            sources.push(source);
            poses = frames;
        }
        let own_motion = self.own_motion(&topics.own_motion, &clock, &mut sources);
        let mut readings = Vec::new();
        for (index, name) in &topics.ranges {
            let sensor = sensors.get(*index);
            let of =
                sensor.filter(|_| sensors.len() > 1).map_or(String::new(), |sensor| format!(" of {}", sensor.name));
            let (samples, mut source) = self.read_stream(name, &format!("readings{of}"), &clock)?;
            let mount = sensor.map(RangeSensor::mount);
            let (samples, noted, left_out) = ranges::within_limits(&samples, mount.as_ref());
            source.guessed.extend(noted);
            source.unused.extend(left_out);
            sources.push(source);
            readings.push(Readings { sensor: *index, samples, on_clock_of_poses: false });
        }
        Ok(Recording { commands, poses, file: self.path, readings, own_motion, has_one_clock: true, sources })
    }

    /// Returns the samples of a stream on the clock of the bag, and what the report says of it.
    fn read_stream(&self, name: &str, role: &str, clock: &OneClock) -> Result<(Vec<(f64, Decoded)>, Source)> {
        let samples = self.timed(name, clock)?;
        let times_ms: Vec<f64> = samples.iter().map(|(ms, _)| *ms).collect();
        let stream = &self.streams[name];
        let mut source = Source::named(format!("{} {name}", self.path.display()), &times_ms)
            .mapped(vec![format!("{role} = {}", stream.schema)]);
        let duplicates = stream.samples.len() - times_ms.len();
        if duplicates > 0 {
            let reason = format!("messages of {name} with the time of the one before");
            source.unused.push(LeftOut::rows("duplicate time", duplicates, reason));
        }
        Ok((samples, source))
    }

    /// Returns what the robot measured of its own motion. A stream that cannot be used is left out, with its reason.
    fn own_motion(&self, chosen: &OwnStreams, clock: &OneClock, sources: &mut Vec<Source>) -> OwnMotion {
        let mut own_motion = OwnMotion::default();
        let mut failed = Vec::new();
        let mut read = |name: &String, role: &str| match self.read_stream(name, role, clock) {
            Ok((samples, source)) => {
                sources.push(source);
                samples
            }
            Err(why) => {
                failed.push(LeftOut::topic(
                    name,
                    self.streams[name].samples.len(),
                    LeftOut::failed(&self.path, &why).reason,
                ));
                Vec::new()
            }
        };
        let mut dropped = Vec::new();
        for ((names, side), wheels) in chosen.wheels.iter().zip(["left", "right"]).zip(&mut own_motion.wheels) {
            let angle = |(ms, value)| if let Decoded::Angle(rad) = value { Some((ms, rad)) } else { None };
            for name in names {
                let samples = read(name, &format!("{side} rotation counter"));
                let (wheel, left_out) = Series::of_wheel(samples.into_iter().filter_map(angle).collect(), false);
                wheels.push(wheel);
                dropped.extend(left_out);
            }
        }
        if let Some(name) = &chosen.gyro {
            let (samples, mounting) = own_motion::yaw_rates(&read(name, "gyro"));
            let (gyro, left_out) = Series::of_gyro(samples, false);
            own_motion.gyro = Some(gyro);
            dropped.extend(left_out);
            sources.last_mut().into_iter().for_each(|source| source.guessed.extend(mounting.clone()));
        }
        if let Some(first) = sources.first_mut() {
            first.unused.extend(failed.into_iter().chain(dropped));
        }
        own_motion
    }

    /// Returns the samples of a topic in temporal order with distinct times; of two with one time, the first.
    fn timed(&self, name: &str, clock: &OneClock) -> Result<Vec<(f64, Decoded)>> {
        let samples = &self.streams[name].samples;
        let mut timed: Vec<(f64, Decoded)> = samples.iter().map(|s| (clock.ms(name, s), s.value)).collect();
        let times_ms: Vec<f64> = timed.iter().map(|(ms, _)| *ms).collect();
        check_order(&times_ms).map_err(|why| Error::in_file(&self.path, format!("{name}: {why}")))?;
        timed.sort_by(|a, b| a.0.total_cmp(&b.0));
        timed.dedup_by(|later, before| later.0 == before.0);
        if timed.len() < 2 {
            let what = format!("{name} has {} distinct timestamp(s): the bag has no usable clock", timed.len());
            return Err(Error::in_file(
                &self.path,
                if samples.len() < 2 { format!("{name} has a single message") } else { what },
            ));
        }
        Ok(timed)
    }

    /// Returns what is left out besides single messages: parts, and topics that are not chosen.
    fn left_out(&self, topics: &Topics) -> Vec<LeftOut> {
        let cut = |part: &PathBuf| LeftOut::file(part, "its end is cut off; what comes before was read");
        let is_chosen = |topic: &&Topic| topics.all().any(|name| uses(&self.streams, name, &topic.name));
        let undecodable = self.topics.iter().filter(|topic| topic.undecodable > 0).map(|topic| {
            LeftOut::topic(&topic.name, topic.undecodable, format!("messages that are not {} as stated", topic.schema))
        });
        let unused = self.topics.iter().filter(|topic| !is_chosen(topic) && topic.rows > topic.undecodable);
        let unused = unused.map(|topic| {
            let reason =
                topics.unused.iter().find(|(name, _)| is_of(name, &topic.name)).map(|(_, reason)| reason.clone());
            let rows = topic.rows - topic.undecodable;
            LeftOut::topic(&topic.name, rows, reason.unwrap_or_else(|| topic.why_unused()))
        });
        // Parts of topics that are used otherwise, such as joints.
        let parts = topics.unused.iter().filter_map(|(name, reason)| {
            self.topics.iter().filter(is_chosen).find(|topic| is_of(name, &topic.name))?;
            Some(LeftOut::topic(name, self.streams.get(name)?.samples.len(), reason.clone()))
        });
        self.truncated.iter().map(cut).chain(undecodable).chain(unused).chain(parts).collect()
    }

    /// Returns what is known of messages that could not be decoded, as the end of a sentence about a missing topic.
    fn undecoded(&self) -> String {
        let foreign = self.topics.iter().find(|topic| topic.is_relevant && matches!(topic.wire, Wire::Foreign));
        let undecodable = self.topics.iter().find(|topic| topic.undecodable > 0);
        let measured = self.topics.iter().find(|topic| topic.is_unmodelled_command());
        match (foreign, undecodable, measured) {
            (Some(topic), ..) => format!("; messages of {} are not in the encoding of ROS", topic.name),
            (_, Some(topic), _) => {
                format!("; {} messages of {} are not {} as stated", topic.undecodable, topic.name, topic.schema)
            }
            (.., Some(topic)) => format!("; {} ({}) {}", topic.name, topic.schema, topic.why_unused()),
            _ => String::new(),
        }
    }

    /// Returns an error message if a topic has messages of several types.
    fn changes_type(&self, name: &str) -> Option<String> {
        let schemas: Vec<&str> =
            self.topics.iter().filter(|topic| topic.name == name).map(|topic| topic.schema.as_str()).collect();
        (schemas.len() > 1).then(|| {
            format!("{name} has messages of several types ({}): record them as separate topics", schemas.join(", "))
        })
    }
}

/// Returns whether the stream `name` is made of messages of `topic`.
fn uses(streams: &BTreeMap<String, Stream>, name: &str, topic: &str) -> bool {
    is_of(name, topic) || streams[name].composed_of.iter().any(|part| is_of(part, topic))
}

/// Returns whether a stream is a topic or a part of it.
fn is_of(name: &str, topic: &str) -> bool {
    name.strip_prefix(topic).is_some_and(|rest| rest.is_empty() || rest.starts_with(':'))
}

/// Projects poses onto the floor, and says how if z does not point up.
fn on_floor(poses: Vec<(f64, Decoded)>) -> (Vec<Frame>, Option<String>) {
    let seen =
        poses.iter().filter_map(|(_, value)| if let Decoded::Pose(Some(pose)) = value { Some(pose) } else { None });
    let vertical = Axis::of_movement(seen);
    let frames = poses.iter().filter_map(|(t_ms, value)| match value {
        Decoded::Pose(pose) => pose.map(|pose| vertical.frame(*t_ms, &pose)),
        _ => None,
    });
    let converted = "poses move in x and z: y is vertical, so they were turned to x and -z".to_owned();
    (frames.collect(), (vertical == Axis::Y).then_some(converted))
}

/// Returns commands, and what they ask for that a differential drive cannot do.
fn twists(samples: Vec<(f64, Decoded)>) -> (Commands, Option<String>) {
    let [mut ahead, mut left] = [0.0, 0.0];
    let mut largest_cm_s: f64 = 0.0;
    let pair = |(ms, value): (f64, Decoded)| match value {
        Decoded::Twist { ahead_cm_s, left_cm_s, turn_rad_s } => {
            ahead += ahead_cm_s.abs();
            left += left_cm_s.abs();
            largest_cm_s = largest_cm_s.max(left_cm_s.abs());
            Some((ms, [ahead_cm_s, turn_rad_s]))
        }
        _ => None,
    };
    let commands = Commands { kind: Kind::Twist, samples: samples.into_iter().filter_map(pair).collect() };
    let share = 100.0 * left / (ahead + left);
    let sideways = (left > 0.0).then(|| {
        format!(
            "linear.y commands sideways motion of up to {largest_cm_s:.0} cm/s, {share:.0} % of the commanded travel, which a \
             differential drive cannot do and which is not modelled"
        )
    });
    (commands, sideways)
}

#[cfg(test)]
mod tests;
