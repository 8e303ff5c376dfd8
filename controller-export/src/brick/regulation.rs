//! Regulation of motors: once per window, the firmware sets their power from the rotation of the shafts.
//!
//! Source: `dOutputCalculateMotorPosition` and `dOutputSyncMotorPosition` in `d_output.c` of the firmware.

/// Time between two measurements of a shaft.
pub(super) const WINDOW_MS: u32 = 101;
/// Default gains of a motor: proportional, integral, derivative.
pub(super) const GAINS: [u8; 3] = [96, 32, 32];

/// The value that stands for a gain of one.
const GAIN_UNIT: i32 = 32;
const MAX_POWER: i32 = 100;
/// Bounds on the errors and accumulated errors of a single motor and of a pair.
const MAX_ERROR_DEG: i32 = 32_000;
const MAX_ACCUMULATED_DEG: i32 = 800;
const MAX_DIFFERENCE_DEG: i32 = 500;
const MAX_ACCUMULATED_PAIR_DEG: i32 = 900;

/// Holds a speed: the shaft has to turn by as many degrees per window as its power is in percent.
#[derive(Clone, Debug, Default)]
pub(super) struct Speed {
    /// Angle by which the shaft lags behind.
    error_deg: i32,
    accumulated_deg: i32,
}

/// Keeps two shafts together, or apart by a turn ratio.
#[derive(Clone, Debug, Default)]
pub(super) struct Pair {
    /// Angle by which the second shaft has to be ahead.
    wanted_deg: i32,
    error_deg: i32,
    accumulated_deg: i32,
}

impl Speed {
    /// Returns the power for the next window, and whether it is less than needed.
    pub(super) fn power(&mut self, target: i8, turned_deg: i32, gains: [u8; 3]) -> (i8, bool) {
        let [proportional, integral, derivative] = gains.map(|gain| i32::from(gain) / GAIN_UNIT);
        let max_deg = MAX_ERROR_DEG / i32::from(gains[0]).max(1);
        let error_deg =
            self.error_deg.saturating_sub(turned_deg).saturating_add(target.into()).clamp(-max_deg, max_deg);
        let change = (error_deg - self.error_deg) * derivative;
        self.error_deg = error_deg;
        let accumulated_deg = (self.accumulated_deg * 3 + error_deg) / 4;
        self.accumulated_deg = accumulated_deg.clamp(-MAX_ACCUMULATED_DEG, MAX_ACCUMULATED_DEG);
        let limited = |power: i32| power.clamp(-MAX_POWER, MAX_POWER);
        let wanted = (limited(error_deg * proportional) + limited(self.accumulated_deg * integral) + change) / 2;
        (limited(wanted) as i8, limited(wanted) != wanted)
    }
}

impl Pair {
    /// Returns the powers of both motors for the next window. `turned_deg` is their rotation in this movement.
    pub(super) fn powers(&mut self, target: i8, turn_ratio: i8, turned_deg: [i32; 2], gains: [u8; 3]) -> [i8; 2] {
        let [proportional, integral, derivative] = gains.map(|gain| i32::from(gain) / GAIN_UNIT);
        let (target, turn_ratio) = (i32::from(target), i32::from(turn_ratio));
        let has_moved = turned_deg != [0, 0];
        let turn = if has_moved { turn_ratio * target.abs() / 100 } else { turn_ratio };
        self.wanted_deg = self.wanted_deg.saturating_add(2 * turn);
        let apart_deg = turned_deg[0].saturating_sub(turned_deg[1]).saturating_add(self.wanted_deg);
        let error_deg = apart_deg.clamp(-MAX_DIFFERENCE_DEG, MAX_DIFFERENCE_DEG);
        let change = (error_deg - self.error_deg) * derivative;
        self.error_deg = error_deg;
        let accumulated_deg = self.accumulated_deg + error_deg;
        self.accumulated_deg = accumulated_deg.clamp(-MAX_ACCUMULATED_PAIR_DEG, MAX_ACCUMULATED_PAIR_DEG);
        let correction = (error_deg * proportional + self.accumulated_deg * integral + change) / 4;
        // In a turn no motor runs faster than commanded.
        let limit = if turn_ratio == 0 { MAX_POWER } else { target.abs().min(MAX_POWER) };
        [target - correction, target + correction].map(|power| power.clamp(-limit, limit) as i8)
    }
}

#[cfg(test)]
mod tests {
    use super::super::motors::Drive;
    use super::super::shaft::Shaft;
    use super::*;

    /// Returns the rotation of a regulated shaft in the last of `windows`, in degrees. Its motor gives a share of its power.
    fn turned_deg(target: i8, share: f64, windows: u32) -> i32 {
        let (mut shaft, mut speed, mut before_deg, mut turned_deg) = (Shaft::default(), Speed::default(), 0, 0);
        for window in 1..=windows {
            let angle_deg = shaft.angle_deg(window * WINDOW_MS);
            turned_deg = angle_deg - before_deg;
            before_deg = angle_deg;
            let (power, _) = speed.power(target, turned_deg, GAINS);
            shaft.set(Drive::Power((f64::from(power) * share) as i8), window * WINDOW_MS);
        }
        turned_deg
    }

    /// The firmware showed 495 degrees per second at power 50, whatever the motor's strength.
    #[test]
    fn speed_is_held_whatever_the_strength_of_the_motor() {
        for share in [1.0, 0.9, 0.8] {
            assert!((48..=52).contains(&turned_deg(50, share, 100)), "{share}: {}", turned_deg(50, share, 100));
            assert!((-32..=-28).contains(&turned_deg(-30, share, 100)), "{share}: {}", turned_deg(-30, share, 100));
        }
        assert!(turned_deg(100, 1.0, 100) < 72, "no motor is faster than it can be");
    }

    #[test]
    fn pair_stays_together_and_turns_by_its_ratio() {
        let apart_deg = |turn_ratio, weak: f64| {
            let (mut shafts, mut pair) = ([Shaft::default(), Shaft::default()], Pair::default());
            for window in 1..=60 {
                let t_ms = window * WINDOW_MS;
                let turned_deg = shafts.each_mut().map(|shaft| shaft.angle_deg(t_ms));
                let [one, other] = pair.powers(50, turn_ratio, turned_deg, GAINS);
                shafts[0].set(Drive::Power(one), t_ms);
                shafts[1].set(Drive::Power((f64::from(other) * weak) as i8), t_ms);
            }
            let [one, other] = shafts.each_mut().map(|shaft| shaft.angle_deg(60 * WINDOW_MS));
            one - other
        };
        assert!(apart_deg(0, 0.8).abs() < 40, "{}", apart_deg(0, 0.8));
        assert!(apart_deg(100, 1.0) < -3_000 && apart_deg(-100, 1.0) > 3_000);
    }
}
