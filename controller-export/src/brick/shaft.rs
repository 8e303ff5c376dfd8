//! A motor's shaft, which follows the drive with inertia and counts its rotation.

use super::motors::Drive;

/// Speed per percent of power, in degrees per second: about that of a loaded motor on a charged battery.
const DEG_S_PER_POWER: f64 = 7.0;
/// Time constants of the speed when the motor is driven, when it coasts and when it brakes.
const DRIVEN_MS: f64 = 60.0;
const COASTING_MS: f64 = 200.0;
const BRAKING_MS: f64 = 20.0;
/// Difference from the final speed below which it counts as reached.
const REACHED_DEG_S: f64 = 0.01;

/// The shaft of a motor without load.
///
/// ```
/// use mindgap_controller_export::brick::{Drive, Shaft};
///
/// let mut shaft = Shaft::default();
/// shaft.set(Drive::Power(50), 0);
/// assert!(shaft.angle_deg(1_000) > 300);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shaft {
    drive: Drive,
    speed_deg_s: f64,
    angle_deg: f64,
    t_ms: u32,
}

impl Shaft {
    /// Changes the drive at a time in ms.
    pub fn set(&mut self, drive: Drive, t_ms: u32) {
        self.advance(t_ms);
        self.drive = drive;
    }

    /// Returns the rotation since the start in degrees, at a time in ms.
    pub fn angle_deg(&mut self, t_ms: u32) -> i32 {
        self.advance(t_ms);
        self.angle_deg.round() as i32
    }

    /// Advances by milliseconds, and by the rest at once when the speed no longer changes.
    fn advance(&mut self, t_ms: u32) {
        let (final_deg_s, constant_ms) = match self.drive {
            Drive::Power(power) => (f64::from(power.clamp(-100, 100)) * DEG_S_PER_POWER, DRIVEN_MS),
            Drive::Coast => (0.0, COASTING_MS),
            Drive::Brake => (0.0, BRAKING_MS),
        };
        while self.t_ms < t_ms {
            let missing_deg_s = final_deg_s - self.speed_deg_s;
            let passed_ms = if missing_deg_s.abs() < REACHED_DEG_S {
                self.speed_deg_s = final_deg_s;
                t_ms - self.t_ms
            } else {
                self.speed_deg_s += missing_deg_s / constant_ms;
                1
            };
            self.angle_deg += self.speed_deg_s * f64::from(passed_ms) / 1_000.0;
            self.t_ms += passed_ms;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shaft_turns_in_proportion_to_power_and_stops_sooner_with_the_brake() {
        let after = |drive: Drive| {
            let mut shaft = Shaft::default();
            shaft.set(Drive::Power(50), 0);
            let at_deg = shaft.angle_deg(2_000);
            shaft.set(drive, 2_000);
            (at_deg, shaft.angle_deg(4_000) - at_deg)
        };
        let (at_deg, braked_deg) = after(Drive::Brake);
        let (_, coasted_deg) = after(Drive::Coast);
        assert!((670..=690).contains(&at_deg), "{at_deg}");
        assert!((5..10).contains(&braked_deg) && (60..80).contains(&coasted_deg), "{braked_deg}, {coasted_deg}");
    }

    #[test]
    fn rotation_does_not_depend_on_how_often_it_is_read() {
        let mut shafts = [Shaft::default(), Shaft::default()];
        shafts.iter_mut().for_each(|shaft| shaft.set(Drive::Power(-30), 5));
        (6..900).for_each(|t_ms| _ = shafts[0].angle_deg(t_ms));
        let [often, once] = shafts.each_mut().map(|shaft| shaft.angle_deg(900));
        assert_eq!(often, once);
    }
}
