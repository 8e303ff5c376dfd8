//! One motor, its gear and its tyre: from a voltage to a force on the floor.

use glam::DVec2;

use super::hardware::{Motor, Tyre};

/// Time in which running gears warm their grease to 1/e of its additional stiffness.
const WARMING_S: f64 = 8.0;

/// State of a motor, gear and wheel.
#[derive(Clone, Debug, Default)]
pub(super) struct Wheel {
    /// Angular velocity of the motor's shaft at the axle.
    turning_rad_s: f64,
    /// Angle of the shaft since the run began.
    turned_rad: f64,
    /// Angle of the shaft within the gear's backlash, from 0 (engaged backwards) to `play_rad` (engaged forwards).
    in_play_rad: f64,
    /// Angle of the wheel when the run began.
    rim_rad: f64,
    /// Duty cycle of the bridge, -1..=1.
    duty: f64,
    /// Time since the run began.
    age_s: f64,
}

/// Inputs of a wheel in one time step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tick {
    /// Voltage at the bridge.
    pub supply_v: f64,
    /// Commanded duty cycle, -1..=1.
    pub duty: f64,
    /// Velocity of the hub over the floor: forward and to the left, m/s.
    pub ground_m_s: DVec2,
    /// Factor on the rolling radius, about 1.
    pub roll: f64,
    /// Duration of the step.
    pub seconds: f64,
}

/// Force and current of a wheel in one time step.
#[derive(Clone, Copy, Debug)]
pub(super) struct WheelOutput {
    /// Force on the robot: forward and to the left.
    pub push_n: DVec2,
    /// Current drawn from the battery.
    pub current_a: f64,
}

impl Wheel {
    /// A wheel at rest.
    pub fn at_rest(motor: &Motor, rim_rad: f64) -> Self {
        Wheel { in_play_rad: motor.play_rad / 2.0, rim_rad, ..Wheel::default() }
    }

    /// The motor's rotation counter, in whole degrees.
    pub fn counter_deg(&self) -> f64 {
        self.turned_rad.to_degrees().round()
    }

    /// Speed of the rim, forwards above zero.
    pub fn rim_m_s(&self, tyre: &Tyre) -> f64 {
        self.turning_rad_s * tyre.radius_m
    }

    pub fn tick(&mut self, motor: &Motor, tyre: &Tyre, tick: &Tick) -> WheelOutput {
        self.duty = motor.ramped(self.duty, tick.duty, tick.seconds);
        let way = if self.duty < 0.0 { motor.backwards } else { 1.0 };
        let volts = (self.duty * tick.supply_v * motor.bridge * way).clamp(-motor.limit_v, motor.limit_v);
        let current_a = (volts - motor.back_emf_v_s * self.turning_rad_s) / motor.winding_ohm;
        let radius_m = tyre.radius_m * self.hub(tyre) * tick.roll;
        let slip = DVec2::new(self.turning_rad_s * radius_m, 0.0) - tick.ground_m_s;
        let mut push_n = tyre.push_n(slip);
        if !self.takes_up(motor, slip.x) {
            push_n.x = 0.0;
            self.in_play_rad = (self.in_play_rad + slip.x / radius_m * tick.seconds).clamp(0.0, motor.play_rad);
        }
        let free_nm = motor.torque_nm_per_a * current_a
            - self.viscous_nm_s(motor) * self.turning_rad_s
            - (push_n.x + tyre.load_n * tyre.flexing_s_per_m * self.turning_rad_s * radius_m) * radius_m;
        let dry_nm = motor.friction_nm + tyre.load_n * tyre.rolling * radius_m;
        self.turning_rad_s = dragged(
            self.turning_rad_s,
            free_nm * tick.seconds / motor.inertia_kg_m2,
            dry_nm * tick.seconds / motor.inertia_kg_m2,
            motor.breakaway,
        );
        self.turned_rad += self.turning_rad_s * tick.seconds;
        self.age_s += tick.seconds;
        WheelOutput { push_n, current_a: current_a * self.duty.abs() }
    }

    /// Viscous friction of the gear with its grease as warm as it is by now.
    fn viscous_nm_s(&self, motor: &Motor) -> f64 {
        let cold = if motor.cold_nm_s == 0.0 { 0.0 } else { libm::exp(-self.age_s / WARMING_S) };
        motor.viscous_nm_s + motor.cold_nm_s * cold
    }

    /// Height of the hub over the floor relative to the tyre's radius.
    fn hub(&self, tyre: &Tyre) -> f64 {
        if tyre.eccentricity == 0.0 { 1.0 } else { 1.0 + tyre.eccentricity * libm::sin(self.turned_rad + self.rim_rad) }
    }

    /// Whether the backlash is taken up on the side that the shaft presses.
    fn takes_up(&self, motor: &Motor, ahead_m_s: f64) -> bool {
        if ahead_m_s >= 0.0 { self.in_play_rad >= motor.play_rad } else { self.in_play_rad <= 0.0 }
    }
}

impl Motor {
    /// The bridge's next duty cycle on its way from one to another: its magnitude rises no faster than the bridge raises
    /// it, from zero when the sign changes.
    fn ramped(&self, from: f64, to: f64, seconds: f64) -> f64 {
        if self.rise_ms == 0.0 {
            return to;
        }
        let kept = if from * to > 0.0 { from.abs() } else { 0.0 };
        to.abs().min(kept + seconds * 1000.0 / self.rise_ms).copysign(to)
    }
}

impl Tyre {
    /// Force on the robot for a slip velocity of the rim over the floor: nearly proportional for small slip, then limited
    /// by grip, and smaller once the tyre slides.
    fn push_n(&self, slip_m_s: DVec2) -> DVec2 {
        let slide2 = slip_m_s.length_squared();
        let sliding = slide2 / (slide2 + 25.0 * self.creep_m_s * self.creep_m_s);
        let grip = self.grip * (1.0 - (1.0 - self.sliding) * sliding);
        slip_m_s * (grip * self.load_n / (slide2 + self.creep_m_s * self.creep_m_s).sqrt())
    }
}

/// A speed after an unresisted change and Coulomb friction, which removes at most `dry`, or `breakaway` times that from
/// rest.
pub(super) fn dragged(speed: f64, free_change: f64, dry: f64, breakaway: f64) -> f64 {
    if speed == 0.0 && free_change.abs() <= breakaway * dry {
        return 0.0;
    }
    let free = speed + free_change;
    let left = free.abs() - dry;
    if left > 0.0 { left.copysign(free) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hardware::{Hardware, LEFT};
    use crate::{default_robot, training_room};

    fn parts() -> (Motor, Tyre) {
        let hardware = Hardware::new(&default_robot(), &training_room());
        (hardware.motors[LEFT].clone(), hardware.tyres[LEFT].clone())
    }

    /// Shaft speed of a wheel lifted off the floor after one second.
    fn spun_rad_s(duty: f64, motor: &Motor) -> f64 {
        let tyre = Tyre { load_n: 0.0, ..parts().1 };
        let mut wheel = Wheel::at_rest(motor, 0.0);
        for _ in 0..500 {
            let tick = Tick { supply_v: 7.5, duty, ground_m_s: DVec2::ZERO, roll: 1.0, seconds: 0.002 };
            wheel.tick(motor, &tyre, &tick);
        }
        wheel.turning_rad_s
    }

    #[test]
    fn a_lifted_wheel_comes_to_where_torque_and_friction_balance() {
        let (motor, _) = parts();
        let (volts, speed) = (0.8 * 7.5, spun_rad_s(0.8, &motor));
        let torque_nm = motor.torque_nm_per_a * (volts - motor.back_emf_v_s * speed) / motor.winding_ohm;
        assert!((torque_nm - motor.friction_nm - motor.viscous_nm_s * speed).abs() < 1e-6, "{speed}");
        assert_eq!(spun_rad_s(-0.8, &motor), -speed);
    }

    #[test]
    fn a_motor_breaks_away_above_its_friction_at_rest_alone() {
        let (motor, _) = parts();
        let needed_v = motor.friction_nm * motor.breakaway / motor.torque_nm_per_a * motor.winding_ohm;
        assert_eq!(spun_rad_s(0.99 * needed_v / 7.5, &motor), 0.0);
        assert!(spun_rad_s(1.01 * needed_v / 7.5, &motor) > 0.1);
    }

    #[test]
    fn a_tyre_pushes_against_its_slip_and_no_harder_than_its_grip() {
        let (_, tyre) = parts();
        for slip in [0.001, 0.01, 0.1, 1.0] {
            let push_n = tyre.push_n(DVec2::new(slip, -slip));
            assert!(push_n.x > 0.0 && push_n.y == -push_n.x && push_n.length() < tyre.grip * tyre.load_n);
        }
        assert!(tyre.push_n(DVec2::new(1.0, 0.0)).x < 0.9 * tyre.grip * tyre.load_n);
    }
}
