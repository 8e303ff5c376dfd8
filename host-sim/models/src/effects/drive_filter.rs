//! The filter between commands and wheel speeds: dead time, first-order lag, rate limit, and the lag of the body's turn.
//! Times are in steps.
//!
//! It knows commands alone, so a step is still predicted from the pose tracked before it. Without rate limit and lag of the
//! turn it is exact; with them it is integrated in pieces of a fourth of a step.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::context::{CommandHistory, HISTORY};
use super::pieces::{Phases, Pieces};
use super::scales::{command_for, reference_cm_s};
use super::twist::{twist, wheels};
use mindgap_logs::Robot;

/// What lies between commands and the motion of the body. The default changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct DriveFilter {
    /// Time until a command acts on the wheels, steps.
    pub dead_time_steps: f64,
    /// Time constant with which the wheels then approach the commanded speed, steps.
    pub lag_steps: f64,
    /// Time constant with which the body's turn rate approaches that of its wheels, steps.
    pub turn_lag_steps: f64,
    /// Limit on how fast the wheels change their speed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most_change: Option<MostChange>,
    /// How much the robot drifts sideways while its speed and turn rate change within a step, in multiples of the
    /// textbook's differential drive: less for one that is slower or turns less than robot.toml says.
    pub drift_factor: f64,
}

/// The most by which speeds change per step, as shares of the reference speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum MostChange {
    /// Of each wheel.
    Wheel(#[schemars(description = "Of each wheel.")] f64),
    /// Of the mean of both wheels, and of half of their difference.
    Twist(#[schemars(description = "Of the mean of both wheels, and of half of their difference.")] [f64; 2]),
}

/// What a filter makes of the commands in one step. Speeds are those of both wheels, as the commands that would hold them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepSpeeds {
    /// Mean over the step.
    pub now: [f64; 2],
    /// At the beginning of the step.
    pub before: [f64; 2],
    /// Drift to the left beyond that at constant speeds, cm: a robot that turns first and drives then ends elsewhere than one
    /// that does both at once.
    pub drift_cm: f64,
}

/// Pieces per step in which it is integrated where there is no exact form.
const PIECES_PER_STEP: f64 = 4.0;
/// A change of speed is over after this many time constants: half a percent of it is left.
const OVER: f64 = 5.0;

impl Default for DriveFilter {
    fn default() -> Self {
        DriveFilter { dead_time_steps: 0.0, lag_steps: 0.0, turn_lag_steps: 0.0, most_change: None, drift_factor: 1.0 }
    }
}

impl DriveFilter {
    /// Returns whether it changes nothing.
    pub fn is_none(&self) -> bool {
        self.times().iter().all(|steps| *steps <= 0.0) && self.most_change.is_none()
    }

    /// Returns the filter up to the rims, which have no lag of the body.
    pub fn up_to_the_rims(self) -> Self {
        DriveFilter { turn_lag_steps: 0.0, drift_factor: 0.0, ..self }
    }

    /// Returns whether its times are at most as long as commands are remembered, and its other numbers are possible.
    pub fn is_sound(&self) -> bool {
        let is_change = |change: &f64| *change > 0.0 && change.is_finite();
        let is_limit = match self.most_change {
            None => true,
            Some(MostChange::Wheel(change)) => is_change(&change),
            Some(MostChange::Twist(changes)) => changes.iter().all(is_change),
        };
        self.times().iter().all(|steps| (0.0..=HISTORY as f64).contains(steps))
            && is_limit
            && self.drift_factor.is_finite()
    }

    /// Describes it for people.
    pub fn in_words(&self, robot: &Robot) -> String {
        let times = ["dead time", "lag", "lag of turns"].into_iter().zip(self.times());
        let times = times.filter(|(_, steps)| *steps > 0.0);
        let mut words: Vec<String> =
            times.map(|(name, steps)| format!("{name} {:.0} ms", steps * robot.step_ms)).collect();
        let per_second = |change: f64| format!("{:.0} cm/s^2", change * reference_cm_s(robot) * 1000.0 / robot.step_ms);
        words.extend(match self.most_change {
            None => None,
            Some(MostChange::Wheel(change)) => Some(format!("ramp {}", per_second(change))),
            Some(MostChange::Twist([way, turn])) => {
                Some(format!("ramp {}, of turns {} at the wheels", per_second(way), per_second(turn)))
            }
        });
        words.join(", ")
    }

    fn times(&self) -> [f64; 3] {
        [self.dead_time_steps, self.lag_steps, self.turn_lag_steps]
    }
}

/// A [`DriveFilter`] with everything computed that does not depend on the commands.
#[derive(Clone, Debug)]
pub struct FilteredDrive {
    filter: DriveFilter,
    /// The segments of a step whose command does not change: the command before still holds in the first.
    segments: [Segment; 2],
}

/// A part of every step in which one command is at work.
#[derive(Clone, Debug)]
struct Segment {
    /// The phase of a step in which that was set.
    phase: usize,
    /// Whether it was set one step earlier than dead time shifts it by whole steps.
    ago: usize,
    /// In earlier steps, in which only the speeds at their end matter, and in the present step.
    parts: [Part; 2],
}

impl From<DriveFilter> for FilteredDrive {
    fn from(filter: DriveFilter) -> Self {
        let first = filter.dead_time_steps.max(0.0) % 1.0;
        let segment = |ago: usize, duration: f64| Segment { phase: 0, ago, parts: Part::pair(duration, &filter) };
        FilteredDrive { filter, segments: [segment(1, first), segment(0, 1.0 - first)] }
    }
}

impl FilteredDrive {
    /// Returns the filter.
    pub fn filter(&self) -> DriveFilter {
        self.filter
    }

    /// Returns the speeds of the present step, by its commands and those of the steps before, at their own times where these
    /// are known.
    pub fn speeds_of(&self, commands: &CommandHistory, pieces: &Pieces, robot: &Robot) -> StepSpeeds {
        if pieces.is_empty() {
            return self.speeds(commands, 0, robot);
        }
        self.speeds_in(&pieces.phases(commands, self.memory_steps(commands, robot)), 0, robot)
    }

    /// Returns the speeds of the step `steps_ago` before the present one. Before the oldest command of the history that
    /// command held.
    pub fn speeds(&self, commands: &CommandHistory, steps_ago: usize, robot: &Robot) -> StepSpeeds {
        let ago = |steps: usize| commands[steps.min(HISTORY - 1)];
        let present = steps_ago + self.filter.dead_time_steps.max(0.0) as usize;
        if self.filter.is_none() {
            return StepSpeeds { now: ago(present), before: ago(present + 1), drift_cm: 0.0 };
        }
        let (drive, before) = self.driven(&self.segments, |_, steps| ago(steps), present, robot, |_, _| ());
        self.step_speeds(&drive, before, robot)
    }

    /// Returns the same where commands change within steps.
    pub fn speeds_in(&self, phases: &Phases, steps_ago: usize, robot: &Robot) -> StepSpeeds {
        let (drive, before) = self.driven_in(phases, steps_ago as f64, robot, |_, _| ());
        self.step_speeds(&drive, before, robot)
    }

    /// Returns the pieces of the step `steps_ago` before the present one, which may be a fraction: their durations in steps,
    /// and the mean speeds in them.
    pub fn pieces(&self, phases: &Phases, steps_ago: f64, robot: &Robot) -> Vec<(f64, [f64; 2])> {
        let mut pieces: Vec<(f64, [f64; 2])> = Vec::new();
        self.driven_in(phases, steps_ago, robot, |duration, speeds| match pieces.last_mut() {
            Some((held, last)) if *last == speeds => *held += duration,
            _ => pieces.push((duration, speeds)),
        });
        pieces
    }

    /// Returns for how long before the present step commands matter to it, steps.
    pub fn memory_steps(&self, commands: &CommandHistory, robot: &Robot) -> f64 {
        self.filter.dead_time_steps.max(0.0) + self.reach_steps(commands, command_for(1.0, robot)) as f64
    }

    fn driven_in(
        &self,
        phases: &Phases,
        steps_ago: f64,
        robot: &Robot,
        visit: impl FnMut(f64, [f64; 2]),
    ) -> (Moving, [f64; 2]) {
        let late_steps = self.filter.dead_time_steps.max(0.0) + steps_ago;
        let segments = self.segments_in(phases, late_steps % 1.0);
        let command = |phase: usize, steps: usize| phases.histories[phase][steps.min(HISTORY - 1)];
        self.driven(&segments, command, late_steps as usize, robot, visit)
    }

    /// Returns the segments of a step whose commands act a fraction of a step late.
    fn segments_in(&self, phases: &Phases, late_steps: f64) -> Vec<Segment> {
        let mut begins: Vec<f64> = phases.begins_steps.iter().map(|begin| (begin + late_steps) % 1.0).collect();
        begins.push(0.0);
        begins.sort_by(f64::total_cmp);
        begins.dedup();
        let end = |i: usize| begins.get(i + 1).copied().unwrap_or(1.0);
        let segment = |(i, begin): (usize, &f64)| {
            let set = 0.5 * (begin + end(i)) - late_steps;
            let ago = usize::from(set < 0.0);
            Segment { phase: phases.at(set + ago as f64), ago, parts: Part::pair(end(i) - begin, &self.filter) }
        };
        begins.iter().enumerate().map(segment).collect()
    }

    /// Drives through the steps that matter. `command` returns that of a phase by its age in steps, `visit` receives the duration
    /// of each piece of the present step and the mean speeds in it. Returns the drive after the present step, in which all that
    /// it covered lies, and its speeds before it.
    fn driven(
        &self,
        segments: &[Segment],
        command: impl Fn(usize, usize) -> [f64; 2],
        present: usize,
        robot: &Robot,
        mut visit: impl FnMut(f64, [f64; 2]),
    ) -> (Moving, [f64; 2]) {
        let unit = command_for(1.0, robot);
        let commanded = (0..HISTORY).map(|steps| command(0, steps));
        let oldest = (present + self.reach_of(commanded, unit)).min(HISTORY - 1);
        let at_last = segments.last().map_or(0, |segment| segment.phase);
        let mut drive = Moving::at(command(at_last, oldest + 1), unit);
        for steps in (present + 1..=oldest).rev() {
            for segment in segments {
                drive.advance(&segment.parts[0], command(segment.phase, steps + segment.ago), |_, _| ());
            }
        }
        let before = drive.speeds();
        drive.covered = [0.0; 2];
        drive.drift = 0.0;
        for segment in segments {
            drive.advance(&segment.parts[1], command(segment.phase, present + segment.ago), &mut visit);
        }
        (drive, before)
    }

    fn step_speeds(&self, drive: &Moving, before: [f64; 2], robot: &Robot) -> StepSpeeds {
        let [way, turn] = drive.covered;
        let per_command_cm = robot.full_speed_cm_s / 100.0 * robot.step_ms / 1000.0;
        let cm = self.filter.drift_factor * 2.0 * per_command_cm * per_command_cm / robot.track_cm;
        StepSpeeds { now: wheels(drive.covered), before, drift_cm: cm * (drive.drift - 0.5 * way * turn) }
    }

    /// Returns the number of steps before the present one that still move the robot; `unit` is the command for the reference
    /// speed.
    fn reach_steps(&self, commands: &CommandHistory, unit: f64) -> usize {
        self.reach_of(commands.iter().copied(), unit)
    }

    fn reach_of(&self, commands: impl Iterator<Item = [f64; 2]>, unit: f64) -> usize {
        let per_step = match self.filter.most_change {
            None => f64::INFINITY,
            Some(MostChange::Wheel(change)) => unit * change,
            Some(MostChange::Twist([way, turn])) => unit * f64::min(way, turn),
        };
        // The largest change is from the fastest command to its opposite.
        let limited = if per_step.is_finite() {
            2.0 * commands.flatten().fold(0.0, |most: f64, c| most.max(c.abs())) / per_step
        } else {
            0.0
        };
        let lags = self.filter.lag_steps.max(0.0) + self.filter.turn_lag_steps.max(0.0);
        (OVER * lags + limited).ceil().min(HISTORY as f64) as usize
    }
}

/// A part of a step under one command, in equal pieces.
#[derive(Clone, Debug)]
struct Part {
    pieces: usize,
    /// Duration of a piece, steps.
    duration: f64,
    lag: Lag,
    turn_lag: Lag,
    /// The most by which speeds change in a piece, as shares of the reference speed.
    most_change: Option<MostChange>,
}

/// A first-order lag over one piece.
#[derive(Clone, Debug)]
struct Lag {
    /// The fraction of a change that is still missing at the end of it.
    missing: f64,
    /// The same in the mean over it.
    mean_missing: f64,
}

/// A drive in motion.
struct Moving {
    /// The command for the reference speed.
    unit: f64,
    /// Speed of the left and the right wheel.
    wheels: [f64; 2],
    /// Of the body, half of the difference of the wheels that would hold it.
    turn_rate: f64,
    /// What the body has covered, as a [`twist`].
    covered: [f64; 2],
    /// The way weighted by the turn covered before.
    drift: f64,
}

impl Part {
    /// Returns the part of earlier steps and that of the present one.
    fn pair(duration: f64, filter: &DriveFilter) -> [Self; 2] {
        let is_exact = filter.turn_lag_steps <= 0.0 && filter.most_change.is_none();
        [if is_exact { 1.0 } else { PIECES_PER_STEP }, PIECES_PER_STEP]
            .map(|pieces| Part::new(duration, pieces, filter))
    }

    fn new(duration: f64, pieces_per_step: f64, filter: &DriveFilter) -> Self {
        let pieces = (pieces_per_step * duration).ceil().max(1.0);
        let duration = duration / pieces;
        let most_change = filter.most_change.map(|change| match change {
            MostChange::Wheel(change) => MostChange::Wheel(change * duration),
            MostChange::Twist(changes) => MostChange::Twist(changes.map(|change| change * duration)),
        });
        let lag = |steps: f64| Lag::new(steps, duration);
        let (lag, turn_lag) = (lag(filter.lag_steps), lag(filter.turn_lag_steps));
        Part { pieces: if duration > 0.0 { pieces as usize } else { 0 }, duration, lag, turn_lag, most_change }
    }
}

impl Lag {
    fn new(steps: f64, duration: f64) -> Self {
        if steps <= 0.0 || duration <= 0.0 {
            return Lag { missing: 0.0, mean_missing: 0.0 };
        }
        let missing = libm::exp(-duration / steps);
        Lag { missing, mean_missing: steps / duration * (1.0 - missing) }
    }
}

impl Moving {
    /// Returns a drive that has held a command for long.
    fn at(command: [f64; 2], unit: f64) -> Self {
        Moving { unit, wheels: command, turn_rate: twist(command)[1], covered: [0.0; 2], drift: 0.0 }
    }

    /// Returns the speeds of the wheels that would hold the motion of the body.
    fn speeds(&self) -> [f64; 2] {
        wheels([twist(self.wheels)[0], self.turn_rate])
    }

    fn advance(&mut self, part: &Part, towards: [f64; 2], mut visit: impl FnMut(f64, [f64; 2])) {
        for _ in 0..part.pieces {
            let begin = self.wheels;
            let end = [0, 1].map(|m| towards[m] + part.lag.missing * (begin[m] - towards[m]));
            let mean = [0, 1].map(|m| towards[m] + part.lag.mean_missing * (begin[m] - towards[m]));
            let mean = match &part.most_change {
                None => {
                    self.wheels = end;
                    mean
                }
                Some(most) => {
                    self.wheels = most.limited(begin, end, self.unit);
                    most.mean(begin, mean, end, self.wheels)
                }
            };
            let [way, turn_rate] = twist(mean);
            let turn = turn_rate + part.turn_lag.mean_missing * (self.turn_rate - turn_rate);
            self.turn_rate = turn_rate + part.turn_lag.missing * (self.turn_rate - turn_rate);
            visit(part.duration, wheels([way, turn]));
            let (way, turn) = (way * part.duration, turn * part.duration);
            self.drift += way * (self.covered[1] + 0.5 * turn);
            self.covered = [self.covered[0] + way, self.covered[1] + turn];
        }
        if part.pieces > 0 && part.turn_lag.missing == 0.0 {
            self.turn_rate = twist(self.wheels)[1];
        }
    }
}

impl MostChange {
    /// Returns the speeds that are reached on the way from `begin` to `end`; `unit` is the command for the reference speed.
    fn limited(&self, begin: [f64; 2], end: [f64; 2], unit: f64) -> [f64; 2] {
        let within = |begin: [f64; 2], end: [f64; 2], most: [f64; 2]| {
            [0, 1].map(|i| begin[i] + (end[i] - begin[i]).clamp(-unit * most[i], unit * most[i]))
        };
        match *self {
            MostChange::Wheel(most) => within(begin, end, [most; 2]),
            MostChange::Twist(most) => wheels(within(twist(begin), twist(end), most)),
        }
    }

    /// Returns the mean speeds of a piece whose change was limited: the limited ones change evenly.
    fn mean(&self, begin: [f64; 2], mean: [f64; 2], end: [f64; 2], reached: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|m| if reached[m] == end[m] { mean[m] } else { 0.5 * (begin[m] + reached[m]) })
    }
}

impl StepSpeeds {
    /// Returns left, right, previous left and previous right speed.
    pub fn inputs(&self) -> [f64; 4] {
        [self.now[0], self.now[1], self.before[0], self.before[1]]
    }
}

#[cfg(test)]
mod tests;
