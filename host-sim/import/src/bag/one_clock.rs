//! Puts all topics of a bag on one clock.
//!
//! A message has the time at which it was logged and, in most types, the time of its content (its stamp). A simulation stamps
//! in its own time, which may run slower or faster than the recorder's clock. The clock of the poses decides; messages without
//! a stamp of that clock are placed through the pairs of logging time and stamp.

use std::collections::BTreeMap;

use super::messages::Decoded;
use super::topics::Topics;
use super::{Sample, Stream};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::statistics::summary::median;

/// Stamps further than this from where the clock has them belong to another clock, ms.
const SAME_CLOCK_MS: f64 = 1000.0;
/// Rates of two clocks that differ by more than this are reported and not taken for one clock.
const SAME_RATE: f64 = 0.01;
/// Pairs must cover this time to show a rate, ms.
const MIN_SPAN_MS: f64 = 2000.0;
/// A clock that goes back by at least this was set back, ms; by less, messages are out of order.
const SET_BACK_MS: f64 = 500.0;
/// Messages written out of order come in many short pieces; a clock that was set back leaves few, at most one for this many
/// messages.
const MESSAGES_PER_PIECE: usize = 20;

/// The clock on which all chosen topics are placed.
pub struct OneClock {
    /// The clock's time at logging times; `None` if logging times are the clock.
    pairs: Option<Pairs>,
    /// Topics whose stamps are on that clock.
    stamped: Vec<String>,
    /// What was found, one sentence each.
    pub notes: Vec<String>,
}

/// Pairs of logging time and stamp, ms, both ascending.
struct Pairs(Vec<[f64; 2]>);

impl OneClock {
    /// Determines the clock of the chosen topics.
    pub fn of(streams: &BTreeMap<String, Stream>, topics: &Topics) -> Self {
        let pairs_of = |name: &str| Pairs::of(&streams[name].samples);
        let stamped: Vec<(&str, Pairs)> = topics.all().filter_map(|name| Some((name, pairs_of(name)?))).collect();
        let near_log = |pairs: &Pairs| pairs.distance_ms(|log_ms| log_ms) <= SAME_CLOCK_MS && pairs.has_rate_of_one();
        let name = |(name, _): &(&str, Pairs)| (*name).to_owned();
        let mut notes = Vec::new();
        let simulated = streams.iter().filter(|(_, stream)| stream.is_clock()).min_by_key(|(name, _)| *name);
        let simulated = simulated.and_then(|(name, stream)| Some((name.as_str(), Pairs::of(&stream.samples)?)));
        let poses = stamped.iter().find(|(name, _)| topics.poses.as_deref() == Some(name));
        if stamped.iter().all(|(_, pairs)| near_log(pairs)) && (simulated.is_none() || poses.is_some()) {
            let clock =
                if stamped.is_empty() { "from the times of logging" } else { "from the stamps in the messages" };
            notes.push(format!("time {clock}"));
            return OneClock { pairs: None, stamped: stamped.iter().map(name).collect(), notes };
        }
        let follows = |pairs: &Pairs, clock: &Pairs| pairs.distance_ms(|log_ms| clock.at(log_ms)) <= SAME_CLOCK_MS;
        // The clock of a simulation is more exact than stamps that come through several programs.
        let simulated = simulated.filter(|(_, clock)| poses.is_none_or(|(_, pairs)| follows(pairs, clock)));
        let Some((source, clock)) =
            simulated.or(poses.map(|(name, _)| (*name, pairs_of(name).unwrap_or(Pairs(Vec::new())))))
        else {
            notes.push("time from the times of logging: stamps are on another clock, and poses have none".into());
            return OneClock { pairs: None, stamped: Vec::new(), notes };
        };
        let rate = clock.rate();
        notes.push(format!("time from the stamps of {source}, on which all topics were placed"));
        if (rate - 1.0).abs() > SAME_RATE {
            notes.push(format!(
                "stamps of {source} run at {rate:.3} times the rate of the times of logging: a simulation at a real-time factor of \
                 {rate:.2}, or a clock that is wrong"
            ));
        }
        let (same, other): (Vec<_>, Vec<_>) = stamped.iter().partition(|(_, pairs)| follows(pairs, &clock));
        for (topic, pairs) in &other {
            notes.push(format!(
                "stamps of {topic} are on another clock, which runs at {:.3} times the rate of the times of logging: placed by these",
                pairs.rate()
            ));
        }
        let stamped = same.into_iter().map(name).collect();
        OneClock { pairs: Some(clock), stamped, notes }
    }

    /// Returns the time of a topic's sample, ms.
    pub fn ms(&self, topic: &str, sample: &Sample) -> f64 {
        let stamp_ms = sample.stamp_ms.filter(|_| self.stamped.iter().any(|name| name == topic));
        stamp_ms.unwrap_or_else(|| self.pairs.as_ref().map_or(sample.log_ms, |pairs| pairs.at(sample.log_ms)))
    }
}

impl Stream {
    fn is_clock(&self) -> bool {
        matches!(self.samples.first(), Some(Sample { value: Decoded::Clock, .. }))
    }
}

impl Pairs {
    /// Returns the pairs of a stream's samples, which are in the order of logging; `None` with fewer than two.
    fn of(samples: &[Sample]) -> Option<Self> {
        let mut pairs: Vec<[f64; 2]> = Vec::new();
        for [log_ms, stamp_ms] in samples.iter().filter_map(|sample| Some([sample.log_ms, sample.stamp_ms?])) {
            if pairs.last().is_none_or(|last| last[0] < log_ms && last[1] < stamp_ms) {
                pairs.push([log_ms, stamp_ms]);
            }
        }
        (pairs.len() > 1).then_some(Pairs(pairs))
    }

    /// Returns the clock's time at a logging time; beyond the pairs, at their mean rate.
    fn at(&self, log_ms: f64) -> f64 {
        let Pairs(pairs) = self;
        let after = pairs.partition_point(|[at_ms, _]| *at_ms <= log_ms);
        match (after.checked_sub(1).and_then(|before| pairs.get(before)), pairs.get(after)) {
            (Some(a), Some(b)) => a[1] + (log_ms - a[0]) / (b[0] - a[0]) * (b[1] - a[1]),
            (Some(end), None) | (None, Some(end)) => end[1] + self.rate() * (log_ms - end[0]),
            (None, None) => log_ms,
        }
    }

    /// Returns how far the clock advances per logging time; one if the pairs cover too little time.
    fn rate(&self) -> f64 {
        match (self.0.first(), self.0.last()) {
            (Some(a), Some(b)) if b[0] - a[0] >= MIN_SPAN_MS => (b[1] - a[1]) / (b[0] - a[0]),
            _ => 1.0,
        }
    }

    fn has_rate_of_one(&self) -> bool {
        (self.rate() - 1.0).abs() <= SAME_RATE
    }

    /// Returns the median distance of the stamps from a clock, ms.
    fn distance_ms(&self, clock_at: impl Fn(f64) -> f64) -> f64 {
        median(self.0.iter().map(|[log_ms, stamp_ms]| (stamp_ms - clock_at(*log_ms)).abs()))
    }
}

/// Sorts the samples of a stream, which are in the order of the file, by their times of logging.
///
/// # Errors
/// When the recorder's clock was set back.
pub fn sort_by_logging(samples: &mut [Sample]) -> Result<()> {
    let mut piece = 0;
    let mut set_back = None;
    let mut latest_ms = f64::NEG_INFINITY;
    let pieces = samples.iter().map(|sample| {
        if sample.log_ms <= latest_ms - SET_BACK_MS {
            piece += 1;
            set_back.get_or_insert([latest_ms, sample.log_ms]);
            latest_ms = sample.log_ms;
        }
        latest_ms = latest_ms.max(sample.log_ms);
        piece
    });
    let mut by_time: Vec<(f64, usize)> =
        samples.iter().map(|sample| sample.log_ms).zip(pieces.collect::<Vec<_>>()).collect();
    by_time.sort_by(|a, b| a.0.total_cmp(&b.0));
    let changes = by_time.windows(2).filter(|pair| pair[0].1 != pair[1].1).count();
    let pieces = piece + 1;
    if let Some(times_ms) = set_back
        && pieces <= (samples.len() / MESSAGES_PER_PIECE).max(2)
        && changes >= 2 * pieces
    {
        return Err(goes_back(times_ms));
    }
    samples.sort_by(|a, b| a.log_ms.total_cmp(&b.log_ms));
    Ok(())
}

/// Checks that times in the order of logging were not set back; single late messages are possible.
///
/// # Errors
/// When the clock goes back.
pub fn check_order(times_ms: &[f64]) -> Result<()> {
    let mut latest_ms = f64::NEG_INFINITY;
    for (i, ms) in times_ms.iter().enumerate() {
        let stays_back = times_ms.get(i + 1).is_none_or(|next_ms| *next_ms < latest_ms);
        if latest_ms - ms >= SET_BACK_MS && stays_back {
            return Err(goes_back([latest_ms, *ms]));
        }
        latest_ms = latest_ms.max(*ms);
    }
    Ok(())
}

fn goes_back([from_ms, to_ms]: [f64; 2]) -> Error {
    Error::new(format!(
        "the clock goes back from {:.3} s to {:.3} s: cut the recording here and import both parts",
        from_ms / 1e3,
        to_ms / 1e3
    ))
}
