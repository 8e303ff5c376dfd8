//! Regulation of motors: once in a window the firmware sets their power anew, from how far the shafts have turned.
//!
//! Source: `dOutputCalculateMotorPosition` and `dOutputSyncMotorPosition` in `d_output.c` of the firmware.

/// Time between two looks at a shaft, ms.
pub(super) const WINDOW_MS: u32 = 101;
/// Gains of a motor that was told no others: proportional, integral, derivative.
pub(super) const GAINS: [u8; 3] = [96, 32, 32];

/// A gain of this is one.
const GAIN_UNIT: i32 = 32;
const MOST_POWER: i32 = 100;
/// Bounds of what is accumulated by a motor alone and by a pair, and of the difference within a pair.
const MOST_ERROR_DEG: i32 = 32_000;
const MOST_ACCUMULATED_DEG: i32 = 800;
const MOST_DIFFERENCE_DEG: i32 = 500;
const MOST_ACCUMULATED_OF_PAIR_DEG: i32 = 900;

/// Holds a speed: a shaft has to turn by as many degrees in a window as its power has percents.
#[derive(Clone, Debug, Default)]
pub(super) struct Speed {
    /// How far the shaft is behind.
    error_deg: i32,
    accumulated_deg: i32,
}

/// Keeps two shafts together, or apart as a turn ratio says.
#[derive(Clone, Debug, Default)]
pub(super) struct Pair {
    /// By how much the second shaft has to be ahead.
    wanted_deg: i32,
    error_deg: i32,
    accumulated_deg: i32,
}

impl Speed {
    /// The power for the next window, and whether it is less than is needed.
    pub(super) fn power(&mut self, target: i8, turned_deg: i32, gains: [u8; 3]) -> (i8, bool) {
        let [proportional, integral, derivative] = gains.map(|gain| i32::from(gain) / GAIN_UNIT);
        let most = MOST_ERROR_DEG / i32::from(gains[0]).max(1);
        let error_deg = self.error_deg.saturating_sub(turned_deg).saturating_add(target.into()).clamp(-most, most);
        let change = (error_deg - self.error_deg) * derivative;
        self.error_deg = error_deg;
        let accumulated_deg = (self.accumulated_deg * 3 + error_deg) / 4;
        self.accumulated_deg = accumulated_deg.clamp(-MOST_ACCUMULATED_DEG, MOST_ACCUMULATED_DEG);
        let limited = |power: i32| power.clamp(-MOST_POWER, MOST_POWER);
        let wanted = (limited(error_deg * proportional) + limited(self.accumulated_deg * integral) + change) / 2;
        (limited(wanted) as i8, limited(wanted) != wanted)
    }
}

impl Pair {
    /// The powers of both motors for the next window; `turned_deg` is how far they have turned in this movement.
    pub(super) fn powers(&mut self, target: i8, turn_ratio: i8, turned_deg: [i32; 2], gains: [u8; 3]) -> [i8; 2] {
        let [proportional, integral, derivative] = gains.map(|gain| i32::from(gain) / GAIN_UNIT);
        let (target, turn_ratio) = (i32::from(target), i32::from(turn_ratio));
        let has_moved = turned_deg != [0, 0];
        let turn = if has_moved { turn_ratio * target.abs() / 100 } else { turn_ratio };
        self.wanted_deg = self.wanted_deg.saturating_add(2 * turn);
        let apart_deg = turned_deg[0].saturating_sub(turned_deg[1]).saturating_add(self.wanted_deg);
        let error_deg = apart_deg.clamp(-MOST_DIFFERENCE_DEG, MOST_DIFFERENCE_DEG);
        let change = (error_deg - self.error_deg) * derivative;
        self.error_deg = error_deg;
        let accumulated_deg = self.accumulated_deg + error_deg;
        self.accumulated_deg = accumulated_deg.clamp(-MOST_ACCUMULATED_OF_PAIR_DEG, MOST_ACCUMULATED_OF_PAIR_DEG);
        let correction = (error_deg * proportional + self.accumulated_deg * integral + change) / 4;
        // In a turn no motor runs faster than it was told to.
        let most = if turn_ratio == 0 { MOST_POWER } else { target.abs().min(MOST_POWER) };
        [target - correction, target + correction].map(|power| power.clamp(-most, most) as i8)
    }
}

#[cfg(test)]
mod tests {
    use super::super::motors::Drive;
    use super::super::shaft::Shaft;
    use super::*;

    /// Rotation of a regulated shaft in the last of `windows`, degrees; its motor gives a part of what is asked of it.
    fn turned_deg(target: i8, part: f64, windows: u32) -> i32 {
        let (mut shaft, mut speed, mut before_deg, mut turned_deg) = (Shaft::default(), Speed::default(), 0, 0);
        for window in 1..=windows {
            let angle_deg = shaft.angle_deg(window * WINDOW_MS);
            turned_deg = angle_deg - before_deg;
            before_deg = angle_deg;
            let (power, _) = speed.power(target, turned_deg, GAINS);
            shaft.set(Drive::Power((f64::from(power) * part) as i8), window * WINDOW_MS);
        }
        turned_deg
    }

    /// 495 degrees a second at power 50 were seen in the firmware, whatever the motor's strength.
    #[test]
    fn a_speed_is_held_whatever_the_motor_is_like() {
        for part in [1.0, 0.9, 0.8] {
            assert!((48..=52).contains(&turned_deg(50, part, 100)), "{part}: {}", turned_deg(50, part, 100));
            assert!((-32..=-28).contains(&turned_deg(-30, part, 100)), "{part}: {}", turned_deg(-30, part, 100));
        }
        assert!(turned_deg(100, 1.0, 100) < 72, "no motor is faster than it can be");
    }

    #[test]
    fn a_pair_stays_together_and_turns_by_its_ratio() {
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
