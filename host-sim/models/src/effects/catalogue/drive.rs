//! A first-order drive with dry friction, and how one such drive imitates another.

use crate::effects::StepContext;
use crate::effects::context::{CommandHistory, HISTORY};
use crate::effects::scales::MOTOR_MS;
use crate::effects::twist::{twist, wheels};

/// A drive of the first order with dry friction; speeds are in units of the command that keeps them without it.
pub struct Drive {
    /// Its time constant, in steps.
    steps: f64,
    /// The fraction of a change of speed that is left after a step.
    left_of_step: f64,
    /// The command that just overcomes the friction.
    friction: f64,
}

/// Time constants after which a change of speed has decayed to one part in 10¹³, which rounding hides.
const FORGOTTEN_AFTER: f64 = 30.0;

impl Drive {
    fn new(steps: f64, friction: f64) -> Self {
        Drive { steps, left_of_step: libm::exp(-1.0 / steps), friction }
    }

    /// Returns a drive slower by `ms` than the one that simulators know, with dry friction that the command for this share
    /// of the reference speed just overcomes.
    pub fn slower(ms: f64, friction: f64, context: &StepContext) -> Self {
        Drive::new((MOTOR_MS + ms) / context.robot.step_ms, context.command_for(friction))
    }

    /// Returns the drive that simulators know, with the load of the robot's body on the motors scaled by `factor`.
    pub fn loaded(factor: f64, body_share: f64, context: &StepContext) -> Self {
        Drive::slower(MOTOR_MS * body_share * (factor - 1.0), 0.0, context)
    }

    /// Replaces `commands` by those with which this drive moves as the other one does with the given ones.
    pub fn imitate(&self, other: &Drive, commands: &mut CommandHistory) {
        for motor in [0, 1] {
            let [now, before] = self.imitating(other, commands.map(|pair| pair[motor]));
            commands[0][motor] = now;
            commands[1][motor] = before;
        }
    }

    /// Does so for the turning part of the commands alone, the difference between the wheels.
    pub fn imitate_turning(&self, other: &Drive, commands: &mut CommandHistory) {
        let given = self.imitating(other, commands.map(|pair| twist(pair)[1]));
        for (pair, turning) in commands.iter_mut().zip(given) {
            *pair = wheels([twist(*pair)[0], turning]);
        }
    }

    /// Returns the present imitating command and the one before, for one motor.
    fn imitating(&self, other: &Drive, commands: [f64; HISTORY]) -> [f64; 2] {
        // This one follows a command late too: it is given what makes the mean of the other one.
        let missed = self.missed();
        let memory_steps = other.memory_steps();
        let mut speed = other.settled(commands[memory_steps + 1]);
        for command in commands[1..=memory_steps].iter().rev() {
            (_, speed) = other.step(speed, *command);
        }
        let (mean, _) = other.step(speed, commands[0]);
        [self.command_for((mean - missed * speed) / (1.0 - missed)), self.command_for(speed)]
    }

    /// Returns the number of steps after which an earlier speed no longer shows, as far as the history reaches.
    fn memory_steps(&self) -> usize {
        ((FORGOTTEN_AFTER * self.steps).ceil() as usize).min(HISTORY - 2)
    }

    /// Returns the steady-state speed of a command.
    fn settled(&self, command: f64) -> f64 {
        (command.abs() - self.friction).max(0.0).copysign(command)
    }

    /// Returns the command with this steady-state speed.
    fn command_for(&self, speed: f64) -> f64 {
        if speed == 0.0 { 0.0 } else { speed + self.friction.copysign(speed) }
    }

    /// Returns the mean speed of a step under a command, and the speed at its end.
    fn step(&self, speed: f64, command: f64) -> (f64, f64) {
        // Friction acts against the speed until there is none; from rest it acts against the command.
        let towards = if speed == 0.0 { self.settled(command) } else { command - self.friction.copysign(speed) };
        let turns_back = speed * towards < 0.0;
        let until_rest = if turns_back { self.steps * libm::log(1.0 - speed / towards) } else { f64::INFINITY };
        if until_rest >= 1.0 {
            return self.approach(speed, towards, 1.0, self.left_of_step);
        }
        let part =
            |from: f64, towards: f64, steps: f64| self.approach(from, towards, steps, libm::exp(-steps / self.steps));
        let (on, _) = part(speed, towards, until_rest);
        let (back, then) = part(0.0, self.settled(command), 1.0 - until_rest);
        (on + back, then)
    }

    /// Returns the distance covered in this number of steps towards a speed, after which the fraction `left` of the change is
    /// left, and the final speed.
    fn approach(&self, from: f64, towards: f64, steps: f64, left: f64) -> (f64, f64) {
        (towards * steps + (from - towards) * self.steps * (1.0 - left), towards + (from - towards) * left)
    }

    /// Returns the fraction of a change of speed that its first step misses.
    fn missed(&self) -> f64 {
        self.steps * (1.0 - self.left_of_step)
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
    fn step_is_the_integral_of_the_drive() {
        let drive = Drive::new(0.6, 8.0);
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
    fn drive_that_keeps_its_direction_imitates_itself_with_the_same_commands() {
        let drive = Drive::new(0.1, 5.0);
        let mut commands = [[0.0; 2]; HISTORY];
        commands[..3].copy_from_slice(&[[60.0, -40.0], [20.0, -50.0], [80.0, -30.0]]);
        let given = commands;
        drive.imitate(&drive, &mut commands);
        for (given, made) in given[..2].iter().zip(&commands).flat_map(|(a, b)| a.iter().zip(b)) {
            assert!((given - made).abs() < 0.2, "{commands:?}");
        }
    }

    /// On the spot each wheel moves as with a drive that is slower in everything.
    #[test]
    fn drive_that_is_slower_in_turns_is_unchanged_on_the_straight() {
        let (known, slower) = (Drive::new(0.1, 0.0), Drive::new(0.4, 0.0));
        let mut straight = [[0.0; 2]; HISTORY];
        straight[..3].copy_from_slice(&[[60.0; 2], [20.0; 2], [80.0; 2]]);
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
        let drive = |friction| Drive::new(0.5, friction);
        let stop = |friction: f64| drive(friction).step(40.0, 0.0).0;
        let start = |friction: f64| drive(friction).step(0.0, 40.0 + friction).0;
        assert!(stop(8.0) < 0.9 * stop(0.0), "{} {}", stop(8.0), stop(0.0));
        assert_eq!(start(8.0), start(0.0));
    }
}
