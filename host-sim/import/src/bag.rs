//! ROS 2 bags as MCAP: topics of commands, poses and readings become a recording.
//!
//! `records` reads the file, `messages` decode what is in it, `transforms` compose chains of frames, `topics` say which topic
//! holds what.

mod messages;
mod records;
mod topics;
mod transforms;

use std::collections::HashMap;
use std::path::Path;

use self::messages::{Decoded, Message};
use self::records::{Ending, Item};
use self::topics::Topics;
use super::frame::Frame;
use super::recording::{Commands, Kind, Readings, Recording};
use super::report::Source;
use super::timestamps::in_order;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::statistics::summary::median;

pub use self::topics::Choice;

/// Stamps that are off the times at which messages were logged by more than this are of another clock, ms.
const SAME_CLOCK_MS: f64 = 1000.0;
/// With more topics and frames of interest than this no robot's bag is meant.
const MOST_TOPICS: usize = 10_000;
/// With more messages of interest than this memory runs out.
const MOST_MESSAGES: usize = 50_000_000;

/// Messages of one topic, or of one frame of a topic of transforms.
#[derive(Default)]
pub(super) struct Stream {
    /// The messages' type.
    pub(super) schema: String,
    samples: Vec<Sample>,
    /// The streams whose transforms these are one after the other, if they are of a chain.
    composed_of: Vec<String>,
}

#[derive(Clone, Copy)]
struct Sample {
    log_ms: f64,
    /// The stamp in the message, if it has one.
    stamp_ms: Option<f64>,
    value: Decoded,
}

impl Sample {
    /// The time that the message says, or else that at which it was logged.
    fn said_ms(&self) -> f64 {
        self.stamp_ms.unwrap_or(self.log_ms)
    }
}

/// Reads a bag. `sonar_yaw_rad` is the direction in which a laser scanner's beams stand for the range sensor.
///
/// # Errors
/// When the file cannot be read or is corrupt, or when topics are missing or cannot be told apart.
pub fn recording(file: &Path, choice: &Choice, sonar_yaw_rad: f64) -> Result<Recording> {
    let mut streams: HashMap<String, Stream> = HashMap::new();
    let (mut messages, mut broken) = (0, 0);
    let ending = records::read(file, |item: Item| {
        match messages::decode(item.schema, item.data, sonar_yaw_rad) {
            Message::Of(decoded) => {
                for (frame, stamp_ms, value) in decoded {
                    let name = format!("{}{}", item.topic, frame);
                    messages += 1;
                    if messages > MOST_MESSAGES || (streams.len() >= MOST_TOPICS && !streams.contains_key(&name)) {
                        let what =
                            format!("holds more than {MOST_TOPICS} topics or {MOST_MESSAGES} messages of interest");
                        return Err(Error::in_file(file, what));
                    }
                    let stream = streams.entry(name).or_default();
                    stream.schema = item.schema.to_owned();
                    stream.samples.push(Sample { log_ms: item.log_ms, stamp_ms, value });
                }
            }
            Message::Broken => broken += 1,
            Message::OfNoInterest => {}
        }
        Ok(())
    })?;
    for (name, chain) in transforms::chains(&streams, choice.poses.as_deref()) {
        streams.entry(name).or_insert(chain);
    }
    let topics = Topics::choose(&streams, choice).map_err(|what| Error::in_file(file, what))?;
    let uses_stamps = stamped_as_logged(&streams, &topics);
    let timed = |name: &str| timed(file, name, &streams[name].samples, uses_stamps);
    let source = |name: &str, times_ms: &[f64], samples: usize, taken: &str| {
        Source::named(format!("{} {name}", file.display()), times_ms)
            .taken(vec![format!("{taken} = {}", streams[name].schema)])
            .left_out(samples - times_ms.len(), "at the time of another one")
    };
    let mut sources = Vec::new();
    let mut read = |name: &str, taken: &str| -> Result<Vec<(f64, Decoded)>> {
        let samples = timed(name)?;
        let times_ms: Vec<f64> = samples.iter().map(|(ms, _)| *ms).collect();
        sources.push(source(name, &times_ms, streams[name].samples.len(), taken));
        Ok(samples)
    };
    let commands = read(&topics.commands, "commands")?.into_iter().filter_map(|(ms, value)| match value {
        Decoded::Twist(pair) => Some((ms, pair)),
        _ => None,
    });
    let commands = Commands { kind: Kind::Twist, samples: commands.collect() };
    let poses = read(&topics.poses, "poses")?.into_iter().map(|(t_ms, value)| match value {
        Decoded::Pose(pose) => pose.map(|pose| Frame { t_ms, pose }),
        _ => None,
    });
    let poses = poses.collect();
    let readings = match &topics.ranges {
        Some(name) => {
            let samples = read(name, "readings")?.into_iter().filter_map(|(ms, value)| match value {
                Decoded::Range(cm) => Some((ms, cm)),
                _ => None,
            });
            Some(Readings { samples: samples.collect(), on_clock_of_poses: false })
        }
        None => None,
    };
    let clock = if uses_stamps { "by the stamps in the messages" } else { "by the times at which they were logged" };
    if let Some(first) = sources.first_mut() {
        first.guessed.extend(topics.guessed);
        first.guessed.push(format!("time {clock}"));
        if broken > 0 {
            first.left_out.push(format!("{broken} messages that could not be decoded"));
        }
        if let Ending::Truncated = ending {
            first.left_out.push("the end of the bag, which is cut off".into());
        }
    }
    Ok(Recording { commands, poses, track: file.into(), readings, has_one_clock: true, sources })
}

/// Whether the stamps in the messages go with the times at which all messages were logged.
fn stamped_as_logged(streams: &HashMap<String, Stream>, topics: &Topics) -> bool {
    topics.all().all(|name| {
        let off_ms = streams[name].samples.iter().filter_map(|s| Some((s.stamp_ms? - s.log_ms).abs()));
        let off_ms = median(off_ms);
        off_ms.is_nan() || off_ms <= SAME_CLOCK_MS
    })
}

/// Samples in order of time, each at a time of its own.
fn timed(file: &Path, name: &str, samples: &[Sample], uses_stamps: bool) -> Result<Vec<(f64, Decoded)>> {
    let ms = |sample: &Sample| if uses_stamps { sample.said_ms() } else { sample.log_ms };
    let mut timed: Vec<(f64, Decoded)> = samples.iter().map(|sample| (ms(sample), sample.value)).collect();
    let stamps_ms: Vec<f64> = timed.iter().map(|(ms, _)| *ms).collect();
    in_order(&stamps_ms).map_err(|(_, what)| Error::in_file(file, format!("{name}: {what}")))?;
    timed.sort_by(|a, b| a.0.total_cmp(&b.0));
    timed.dedup_by(|later, before| later.0 == before.0);
    if timed.len() < 2 {
        let what = format!("{name} has {} message(s) at times of their own: the bag has no time", timed.len());
        return Err(Error::in_file(
            file,
            if samples.len() < 2 { format!("{name} has a single message") } else { what },
        ));
    }
    Ok(timed)
}

#[cfg(test)]
mod tests;
