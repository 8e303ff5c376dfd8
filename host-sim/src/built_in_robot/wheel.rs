//! One motor, its gear, and the tyre that it turns: from a voltage to a push on the floor.

use glam::DVec2;

use super::hardware::{Motor, Tyre};

/// What a wheel's parts are doing.
#[derive(Clone, Debug, Default)]
pub(super) struct Wheel {
    /// Turning speed of the motor's shaft at the axle.
    turning_rad_s: f64,
    /// How far the shaft has turned since the run began.
    turned_rad: f64,
    /// Where the shaft stands within the gear's play, from 0 (pulling back) to `play_rad` (pushing on).
    in_play_rad: f64,
    /// Where on its rim the wheel stood when the run began.
    rim_rad: f64,
}

/// What happens at a wheel during one tick.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tick {
    /// Voltage at the bridge.
    pub supply_v: f64,
    /// Share of it that is commanded, -1..=1.
    pub duty: f64,
    /// How the floor passes under the hub: forward and to the left, m/s.
    pub ground_m_s: DVec2,
    /// Rolled way against turned angle, about 1.
    pub roll: f64,
    /// Length of the tick.
    pub seconds: f64,
}

/// What comes of it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outcome {
    /// Push on the robot: forward and to the left.
    pub push_n: DVec2,
    /// Current from the battery.
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

    pub fn tick(&mut self, motor: &Motor, tyre: &Tyre, tick: &Tick) -> Outcome {
        let volts = (tick.duty * tick.supply_v * motor.bridge).clamp(-motor.limit_v, motor.limit_v);
        let current_a = (volts - motor.back_emf_v_s * self.turning_rad_s) / motor.winding_ohm;
        let hub = 1.0 + tyre.eccentricity * libm::sin(self.turned_rad + self.rim_rad);
        let radius_m = tyre.radius_m * hub * tick.roll;
        let slip = DVec2::new(self.turning_rad_s * radius_m, 0.0) - tick.ground_m_s;
        let mut push_n = tyre.push_n(slip);
        if !self.takes_up(motor, slip.x) {
            push_n.x = 0.0;
            self.in_play_rad = (self.in_play_rad + slip.x / radius_m * tick.seconds).clamp(0.0, motor.play_rad);
        }
        let free_nm = motor.torque_nm_per_a * current_a
            - motor.viscous_nm_s * self.turning_rad_s
            - (push_n.x + tyre.load_n * tyre.flexing_s_per_m * self.turning_rad_s * radius_m) * radius_m;
        let dry_nm = motor.friction_nm + tyre.load_n * tyre.rolling * radius_m;
        self.turning_rad_s = dragged(
            self.turning_rad_s,
            free_nm * tick.seconds / motor.inertia_kg_m2,
            dry_nm * tick.seconds / motor.inertia_kg_m2,
            motor.breakaway,
        );
        self.turned_rad += self.turning_rad_s * tick.seconds;
        Outcome { push_n, current_a: current_a * tick.duty.abs() }
    }

    /// Whether the gear's play is taken up on the side that the shaft now presses.
    fn takes_up(&self, motor: &Motor, ahead_m_s: f64) -> bool {
        if ahead_m_s >= 0.0 { self.in_play_rad >= motor.play_rad } else { self.in_play_rad <= 0.0 }
    }
}

impl Tyre {
    /// Push on the robot at this slip of the rim over the floor: nearly in proportion at first, then limited by grip,
    /// less once it slides.
    fn push_n(&self, slip_m_s: DVec2) -> DVec2 {
        let slide2 = slip_m_s.length_squared();
        let sliding = slide2 / (slide2 + 25.0 * self.creep_m_s * self.creep_m_s);
        let grip = self.grip * (1.0 - (1.0 - self.sliding) * sliding);
        slip_m_s * (grip * self.load_n / (slide2 + self.creep_m_s * self.creep_m_s).sqrt())
    }
}

/// A speed after a free change and a dry friction that can take away at most `dry`, or `breakaway` times that from rest.
pub(super) fn dragged(speed: f64, free_change: f64, dry: f64, breakaway: f64) -> f64 {
    if speed == 0.0 && free_change.abs() <= breakaway * dry {
        return 0.0;
    }
    let free = speed + free_change;
    let left = free.abs() - dry;
    if left > 0.0 { left.copysign(free) } else { 0.0 }
}
