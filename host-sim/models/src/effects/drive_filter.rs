//! The filter between commands and wheel speeds: dead time, first-order lag, rate limit, and the lag of the body's turn.
//! Times are in steps.
//!
//! It knows commands alone, so a step is still predicted from the pose tracked before it. Without rate limit and lag of the
//! turn it is exact; with them it is integrated in pieces of a fourth of a step.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::context::{CommandHistory, HISTORY};
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

/// A [`DriveFilter`] with all that does not depend on the commands worked out.
#[derive(Clone, Debug)]
pub struct FilteredDrive {
    filter: DriveFilter,
    /// The two parts of earlier steps, in which only the speeds at their end matter, and those of the present step: the command
    /// before still holds in the first.
    earlier: [Part; 2],
    present: [Part; 2],
}

impl From<DriveFilter> for FilteredDrive {
    fn from(filter: DriveFilter) -> Self {
        let first = filter.dead_time_steps.max(0.0) % 1.0;
        let is_exact = filter.turn_lag_steps <= 0.0 && filter.most_change.is_none();
        let parts = |pieces_per_step: f64| [first, 1.0 - first].map(|d| Part::new(d, pieces_per_step, &filter));
        let earlier = parts(if is_exact { 1.0 } else { PIECES_PER_STEP });
        FilteredDrive { filter, earlier, present: parts(PIECES_PER_STEP) }
    }
}

impl FilteredDrive {
    /// Returns the filter.
    pub fn filter(&self) -> DriveFilter {
        self.filter
    }

    /// Returns the speeds of the step `steps_ago` before the present one. Before the oldest command of the history that
    /// command held.
    pub fn speeds(&self, commands: &CommandHistory, steps_ago: usize, robot: &Robot) -> StepSpeeds {
        let ago = |steps: usize| commands[steps.min(HISTORY - 1)];
        let present = steps_ago + self.filter.dead_time_steps.max(0.0) as usize;
        if self.filter.is_none() {
            return StepSpeeds { now: ago(present), before: ago(present + 1), drift_cm: 0.0 };
        }
        let towards = |steps: usize| [ago(steps + 1), ago(steps)];
        let unit = command_for(1.0, robot);
        let oldest = (present + self.reach_steps(commands, unit)).min(HISTORY - 1);
        let mut drive = Moving::at(ago(oldest + 1), unit);
        for steps in (present + 1..=oldest).rev() {
            self.earlier.iter().zip(towards(steps)).for_each(|(part, towards)| drive.advance(part, towards));
        }
        let before = drive.speeds();
        drive.covered = [0.0; 2];
        drive.drift = 0.0;
        self.present.iter().zip(towards(present)).for_each(|(part, towards)| drive.advance(part, towards));
        let [way, turn] = drive.covered;
        let per_command_cm = robot.full_speed_cm_s / 100.0 * robot.step_ms / 1000.0;
        let cm = self.filter.drift_factor * 2.0 * per_command_cm * per_command_cm / robot.track_cm;
        StepSpeeds { now: wheels(drive.covered), before, drift_cm: cm * (drive.drift - 0.5 * way * turn) }
    }

    /// Returns the number of steps before the present one that still move the robot; `unit` is the command for the reference
    /// speed.
    fn reach_steps(&self, commands: &CommandHistory, unit: f64) -> usize {
        let per_step = match self.filter.most_change {
            None => f64::INFINITY,
            Some(MostChange::Wheel(change)) => unit * change,
            Some(MostChange::Twist([way, turn])) => unit * f64::min(way, turn),
        };
        // The largest change is from the fastest command to its opposite.
        let limited = if per_step.is_finite() {
            2.0 * commands.as_flattened().iter().fold(0.0, |most: f64, c| most.max(c.abs())) / per_step
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

    fn advance(&mut self, part: &Part, towards: [f64; 2]) {
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
mod tests {
    use super::*;
    use mindgap_foundations::geometry::Pose;
    use mindgap_foundations::motion::Arc;

    fn filter(dead_time_steps: f64, lag_steps: f64) -> DriveFilter {
        DriveFilter { dead_time_steps, lag_steps, ..DriveFilter::default() }
    }

    /// Integrates the same filter in small steps, from the oldest command on. Returns mean and first speed, and the drift.
    fn integrated(filter: &DriveFilter, commands: &CommandHistory, robot: &Robot) -> StepSpeeds {
        const PARTS: usize = 5000;
        let (part, unit) = (1.0 / PARTS as f64, command_for(1.0, robot));
        let at = |time_steps: f64| commands[(-time_steps.floor()).clamp(0.0, (HISTORY - 1) as f64) as usize];
        let nearer = |lag_steps: f64| if lag_steps > 0.0 { 1.0 - libm::exp(-part / lag_steps) } else { 1.0 };
        let (mut speed, mut turn_rate) = (commands[HISTORY - 1], twist(commands[HISTORY - 1])[1]);
        let (mut before, mut now, mut pose) = ([0.0; 2], [0.0; 2], Pose::new(0.0, 0.0, 0.0));
        let moved = |speed: [f64; 2], duration_s: f64| {
            let wheels_cm = speed.map(|c| c / 100.0 * robot.full_speed_cm_s * duration_s);
            Arc { length_cm: 0.0, across_cm: 0.0, turn_rad: 0.0 }.with_wheels(wheels_cm, robot.track_cm).motion()
        };
        for i in 0..HISTORY * PARTS {
            let time = (i as f64 + 0.5) * part - (HISTORY - 1) as f64;
            if i == (HISTORY - 1) * PARTS {
                before = wheels([twist(speed)[0], turn_rate]);
            }
            let towards = at(time - filter.dead_time_steps);
            let end = [0, 1].map(|m| speed[m] + nearer(filter.lag_steps) * (towards[m] - speed[m]));
            speed = match filter.most_change {
                None => end,
                Some(MostChange::Wheel(most)) => MostChange::Wheel(most * part).limited(speed, end, unit),
                Some(MostChange::Twist(most)) => {
                    MostChange::Twist(most.map(|most| most * part)).limited(speed, end, unit)
                }
            };
            turn_rate += nearer(filter.turn_lag_steps) * (twist(speed)[1] - turn_rate);
            let body = wheels([twist(speed)[0], turn_rate]);
            if time > 0.0 {
                now = [0, 1].map(|m| now[m] + body[m] * part);
                pose = moved(body, robot.step_ms / 1000.0 * part).end(&pose);
            }
        }
        let held = moved(now, robot.step_ms / 1000.0);
        StepSpeeds { now, before, drift_cm: pose.position_cm.y - held.lateral }
    }

    /// Speeds agree to these commands, for exact forms and for those in pieces.
    fn assert_like_integrated(filter: DriveFilter, within: f64) {
        let robot = mindgap_built_in_robot::default_robot();
        let commands: CommandHistory =
            std::array::from_fn(|age| [libm::sin(age as f64) * 60.0, if age < 3 { 50.0 } else { -20.0 }]);
        let (found, right) =
            (FilteredDrive::from(filter).speeds(&commands, 0, &robot), integrated(&filter, &commands, &robot));
        let near = found.inputs().iter().zip(right.inputs()).all(|(a, b)| (a - b).abs() < within);
        assert!(near, "{filter:?}: {found:?} {right:?}");
        // Of the sine of the heading the first power is taken.
        assert!((found.drift_cm - right.drift_cm).abs() < 0.05 + 0.1 * right.drift_cm.abs(), "{found:?} {right:?}");
    }

    #[test]
    fn dead_time_and_lag_are_exact() {
        for (dead_time_steps, lag_steps) in [(0.0, 0.0), (0.3, 0.0), (2.0, 0.0), (0.0, 0.5), (0.7, 1.3), (2.5, 0.2)] {
            assert_like_integrated(filter(dead_time_steps, lag_steps), 0.5);
        }
    }

    #[test]
    fn limits_and_lags_of_the_turn_are_integrated() {
        let lagging = filter(0.4, 0.6);
        for most_change in [MostChange::Wheel(0.3), MostChange::Twist([0.25, 0.1])] {
            assert_like_integrated(DriveFilter { most_change: Some(most_change), ..DriveFilter::default() }, 2.0);
            assert_like_integrated(DriveFilter { most_change: Some(most_change), ..lagging }, 2.0);
        }
        assert_like_integrated(DriveFilter { turn_lag_steps: 0.7, ..lagging }, 1.0);
        assert_like_integrated(DriveFilter { turn_lag_steps: 0.7, ..DriveFilter::default() }, 1.0);
    }

    #[test]
    fn without_dead_time_and_lag_commands_act_at_once() {
        let robot = mindgap_built_in_robot::default_robot();
        let commands: CommandHistory = std::array::from_fn(|age| [age as f64, -(age as f64)]);
        for filter in [DriveFilter::default(), filter(-1.0, -0.5)] {
            assert!(filter.is_none());
            for steps_ago in [0, 3] {
                let StepSpeeds { now, before, drift_cm } =
                    FilteredDrive::from(filter).speeds(&commands, steps_ago, &robot);
                assert_eq!(([now, before], drift_cm), ([commands[steps_ago], commands[steps_ago + 1]], 0.0));
            }
        }
    }
}
