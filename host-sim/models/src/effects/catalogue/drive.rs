//! A drive that follows its commands late and has dry friction: what slows it, and what its friction does to it.

use crate::effects::StepContext;
use crate::effects::context::{CommandHistory, HISTORY};

/// Time constant of the drive that simulators know: that of an NXT motor.
const KNOWN_MS: f64 = 50.0;

/// A drive of the first order with dry friction; speeds are in units of the command that keeps them without it.
pub struct Drive {
    /// Its time constant, in steps.
    steps: f64,
    /// The command that does no more than overcome the friction.
    friction: f64,
}

impl Drive {
    /// Slower by so much than the one that simulators know, with dry friction that the command for this wheel speed does no
    /// more than overcome.
    pub fn slower(ms: f64, friction_cm_s: f64, context: &StepContext) -> Self {
        Drive { steps: (KNOWN_MS + ms) / context.robot.step_ms, friction: context.command_for(friction_cm_s) }
    }

    /// The one that simulators know, where the robot's body weighs by this factor more on the motors.
    pub fn loaded(factor: f64, body_share: f64, context: &StepContext) -> Self {
        Drive::slower(KNOWN_MS * body_share * (factor - 1.0), 0.0, context)
    }

    /// The commands by which this drive moves as the other one does by these.
    pub fn imitate(&self, other: &Drive, commands: &mut CommandHistory) {
        for motor in [0, 1] {
            let [now, before] = self.imitating(other, commands.map(|pair| pair[motor]));
            commands[0][motor] = now;
            commands[1][motor] = before;
        }
    }

    /// The same where both wheels turn the robot; what they do alike stays.
    pub fn imitate_turning(&self, other: &Drive, commands: &mut CommandHistory) {
        let given = self.imitating(other, commands.map(|[left, right]| (right - left) / 2.0));
        for (pair, turning) in commands.iter_mut().zip(given) {
            let straight = (pair[0] + pair[1]) / 2.0;
            *pair = [straight - turning, straight + turning];
        }
    }

    /// The present command and the one before, of one series of commands.
    fn imitating(&self, other: &Drive, commands: [f64; HISTORY]) -> [f64; 2] {
        // This one follows a command late too: it is given what makes the mean of the other one.
        let missed = self.missed();
        let mut speed = other.settled(commands[HISTORY - 1]);
        for command in commands[1..HISTORY - 1].iter().rev() {
            (_, speed) = other.step(speed, *command);
        }
        let (mean, _) = other.step(speed, commands[0]);
        [self.command_for((mean - missed * speed) / (1.0 - missed)), self.command_for(speed)]
    }

    /// The speed that a command comes to.
    fn settled(&self, command: f64) -> f64 {
        (command.abs() - self.friction).max(0.0).copysign(command)
    }

    /// The command that comes to a speed.
    fn command_for(&self, speed: f64) -> f64 {
        if speed == 0.0 { 0.0 } else { speed + self.friction.copysign(speed) }
    }

    /// The mean speed of a step under a command, and the speed at its end.
    fn step(&self, speed: f64, command: f64) -> (f64, f64) {
        // Friction acts against the speed until there is none; from rest it acts against the command.
        let towards = if speed == 0.0 { self.settled(command) } else { command - self.friction.copysign(speed) };
        let turns_back = speed * towards < 0.0;
        let until_rest = if turns_back { self.steps * libm::log(1.0 - speed / towards) } else { f64::INFINITY };
        if until_rest >= 1.0 {
            return self.approach(speed, towards, 1.0);
        }
        let (on, _) = self.approach(speed, towards, until_rest);
        let (back, then) = self.approach(0.0, self.settled(command), 1.0 - until_rest);
        (on + back, then)
    }

    /// The way covered in so many steps towards a speed, and the speed then.
    fn approach(&self, from: f64, towards: f64, steps: f64) -> (f64, f64) {
        let left = libm::exp(-steps / self.steps);
        (towards * steps + (from - towards) * self.steps * (1.0 - left), towards + (from - towards) * left)
    }

    /// The share of a change of speed that its first step misses.
    fn missed(&self) -> f64 {
        self.steps * (1.0 - libm::exp(-1.0 / self.steps))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same by many small steps.
    fn integrated(drive: &Drive, mut speed: f64, command: f64) -> (f64, f64) {
        let (parts, mut way) = (100_000, 0.0);
        for _ in 0..parts {
            let towards = if speed == 0.0 { drive.settled(command) } else { command - drive.friction.copysign(speed) };
            let next = speed + (towards - speed) / (drive.steps * f64::from(parts));
            speed = if next * speed < 0.0 { 0.0 } else { next };
            way += speed / f64::from(parts);
        }
        (way, speed)
    }

    #[test]
    fn a_step_is_the_integral_of_the_drive_from_rest_to_rest_and_backwards() {
        let drive = Drive { steps: 0.6, friction: 8.0 };
        for (speed, command) in
            [(0.0, 50.0), (0.0, 5.0), (40.0, 0.0), (2.0, 0.0), (40.0, -60.0), (-3.0, 5.0), (-30.0, 90.0), (10.0, 60.0)]
        {
            let ((way, then), (expected_way, expected)) =
                (drive.step(speed, command), integrated(&drive, speed, command));
            let off = (way - expected_way).abs().max((then - expected).abs());
            assert!(off < 2e-3, "{speed} by {command}: {way} and {then}, not {expected_way} and {expected}");
        }
    }

    #[test]
    fn a_drive_that_goes_on_one_way_imitates_itself_by_the_commands_that_it_is_given() {
        let drive = Drive { steps: 0.1, friction: 5.0 };
        let mut commands = [[60.0, -40.0], [20.0, -50.0], [80.0, -30.0], [0.0; 2], [0.0; 2], [0.0; 2], [0.0; 2]];
        let given = commands;
        drive.imitate(&drive, &mut commands);
        for (given, made) in given[..2].iter().zip(&commands).flat_map(|(a, b)| a.iter().zip(b)) {
            assert!((given - made).abs() < 0.2, "{commands:?}");
        }
    }

    /// Straight on nothing is different; on the spot each wheel is driven as by a drive that is slower in everything.
    #[test]
    fn a_slower_drive_in_turns_goes_straight_on_as_before() {
        let (known, slower) = (Drive { steps: 0.1, friction: 0.0 }, Drive { steps: 0.4, friction: 0.0 });
        let straight = [60.0, 20.0, 80.0, 0.0, 0.0, 0.0, 0.0].map(|command| [command; 2]);
        let mut commands = straight;
        known.imitate_turning(&slower, &mut commands);
        assert_eq!(commands, straight);
        let on_the_spot = straight.map(|[left, right]| [-left, right]);
        let (mut turning, mut each) = (on_the_spot, on_the_spot);
        known.imitate_turning(&slower, &mut turning);
        known.imitate(&slower, &mut each);
        assert_eq!(turning, each);
        assert!(turning[0][1] < 60.0, "{turning:?}: it is on its way from 20");
    }

    #[test]
    fn friction_helps_to_stop_and_not_to_start() {
        let drive = |friction| Drive { steps: 0.5, friction };
        let stop = |friction: f64| drive(friction).step(40.0, 0.0).0;
        let start = |friction: f64| drive(friction).step(0.0, 40.0 + friction).0;
        assert!(stop(8.0) < 0.9 * stop(0.0), "{} {}", stop(8.0), stop(0.0));
        assert_eq!(start(8.0), start(0.0));
    }
}
