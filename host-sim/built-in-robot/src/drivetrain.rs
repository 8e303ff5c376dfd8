//! Rigid-body dynamics of the robot on the floor: battery, two driven wheels, a castor, and floor drag.

use std::f64::consts::TAU;

use glam::DVec2;
use rand::RngExt;

use super::hardware::{GRAVITY, Hardware, LEFT, RIGHT};
use super::noise::{Wander, happens, normal};
use super::wheel::{Tick, Wheel, dragged};
use mindgap_foundations::chance::Generator;
use mindgap_foundations::geometry::{Pose, direction, wrap_rad};

/// Time after which the floor under the wheels has changed.
const PATCH_MS: f64 = 40.0;
/// Probability of a grain under a wheel, where there is grit at all.
const GRAINS: f64 = 0.3;
/// Distance between the crests of a wavy floor.
const WAVE_CM: f64 = 30.0;
/// Least speed at which the castor aligns with the motion, m/s.
const STANDSTILL_M_S: f64 = 1e-4;

/// Pose, velocities and electrical state.
#[derive(Clone, Debug)]
pub(super) struct Drivetrain {
    pose: Pose,
    /// A unit vector along the heading.
    facing: DVec2,
    /// Forward and to the left, in the robot's own frame.
    speed_m_s: DVec2,
    turning_rad_s: f64,
    wheels: [Wheel; 2],
    /// A unit vector along which the castor rolls, in the robot's own frame.
    castor: DVec2,
    /// Battery current now, and charge drawn since the run began.
    current_a: f64,
    drawn_c: f64,
    patch: Patch,
    patch_left_ms: f64,
}

/// Random properties of the floor under the wheels, in standard deviations; the grit as a share of the ground.
#[derive(Clone, Debug)]
struct Patch {
    grit: [f64; 2],
    roll: [Wander; 2],
    contact: Wander,
    toe: Wander,
    scrub: Wander,
}

impl Drivetrain {
    /// A robot at rest with a fresh battery.
    pub fn at_rest(hardware: &Hardware, pose: Pose, rng: &mut Generator) -> Self {
        Drivetrain {
            pose,
            facing: pose.direction(),
            speed_m_s: DVec2::ZERO,
            turning_rad_s: 0.0,
            wheels: [LEFT, RIGHT].map(|side| Wheel::at_rest(&hardware.motors[side], rng.random_range(0.0..TAU))),
            castor: direction(0.1 * normal(rng)),
            current_a: 0.0,
            drawn_c: 0.0,
            patch: Patch {
                grit: [0.0; 2],
                roll: [Wander::anywhere(rng), Wander::anywhere(rng)],
                contact: Wander::anywhere(rng),
                toe: Wander::anywhere(rng),
                scrub: Wander::anywhere(rng),
            },
            patch_left_ms: PATCH_MS,
        }
    }

    pub fn pose(&self) -> Pose {
        self.pose
    }

    /// The motors' rotation counters.
    pub fn counters_deg(&self) -> [f64; 2] {
        [self.wheels[LEFT].counter_deg(), self.wheels[RIGHT].counter_deg()]
    }

    /// Mean speed of the wheels' rims, forwards or backwards, relative to full speed.
    pub fn wheel_speed(&self, hardware: &Hardware) -> f64 {
        let [left, right] = [LEFT, RIGHT].map(|side| self.wheels[side].rim_m_s(&hardware.tyres[side]).abs());
        (left + right) / (2.0 * hardware.full_speed_m_s)
    }

    /// Terminal voltage of the battery.
    pub fn battery_v(&self, hardware: &Hardware) -> f64 {
        let battery = &hardware.battery;
        (battery.fresh_v - battery.fade_v_per_c * self.drawn_c - battery.inner_ohm * self.current_a).max(0.0)
    }

    /// Advances by one time step under left and right command, -100..=100; returns the distance travelled, cm.
    pub fn tick(&mut self, hardware: &Hardware, command: [f64; 2], tick_ms: f64, rng: &mut Generator) -> f64 {
        self.patch_left_ms -= tick_ms;
        if self.patch_left_ms <= 0.0 {
            self.patch_left_ms += PATCH_MS;
            self.patch.step(hardware.floor.grit, rng);
        }
        let seconds = tick_ms / 1000.0;
        let (mut force_n, mut torque_nm) = self.wheels_push(hardware, command, seconds);
        let (castor_n, castor_nm) = self.castor_push(hardware, seconds);
        force_n += castor_n + self.weight_push(hardware);
        torque_nm += castor_nm;
        self.accelerate(hardware, force_n, torque_nm, seconds);
        self.advance(seconds)
    }

    /// Force and torque on the body from both tyres.
    fn wheels_push(&mut self, hardware: &Hardware, command: [f64; 2], seconds: f64) -> (DVec2, f64) {
        let supply_v = self.battery_v(hardware);
        let floor = &hardware.floor;
        let arm_m = hardware.chassis.half_track_m + floor.contact_wander_m * self.patch.contact.value();
        let side_slip = self.speed_m_s.y - floor.toe_wander_rad * self.patch.toe.value() * self.speed_m_s.x;
        let (mut force_n, mut torque_nm) = (DVec2::ZERO, 0.0);
        self.current_a = hardware.battery.idle_a;
        for (side, arm_m) in [(LEFT, -arm_m), (RIGHT, arm_m)] {
            let tick = Tick {
                supply_v,
                duty: command[side] / 100.0,
                ground_m_s: DVec2::new(self.speed_m_s.x + self.turning_rad_s * arm_m, side_slip),
                roll: 1.0 + floor.roughness * self.patch.roll[side].value() + self.patch.grit[side],
                seconds,
            };
            let outcome = self.wheels[side].tick(&hardware.motors[side], &hardware.tyres[side], &tick);
            force_n += outcome.push_n;
            torque_nm += outcome.push_n.x * arm_m;
            self.current_a += outcome.current_a;
        }
        self.drawn_c += self.current_a.max(0.0) * seconds;
        (force_n, torque_nm)
    }

    /// Force and torque of the castor, which swivels into the direction of motion and pushes sideways until it has.
    fn castor_push(&mut self, hardware: &Hardware, seconds: f64) -> (DVec2, f64) {
        let castor = &hardware.castor;
        let dragged_m_s = DVec2::new(self.speed_m_s.x, self.speed_m_s.y - self.turning_rad_s * castor.behind_m);
        let speed_m_s = dragged_m_s.length();
        if speed_m_s < STANDSTILL_M_S {
            return (DVec2::ZERO, 0.0);
        }
        let across = self.castor.perp();
        let across_m_s = dragged_m_s.dot(across);
        self.castor = (self.castor + across * (across_m_s / castor.trail_m * seconds)).normalize();
        let force_n = across * (-castor.scrub_n * across_m_s / speed_m_s);
        (force_n, -castor.behind_m * force_n.y)
    }

    /// Component of gravity along the tilted floor, N.
    fn weight_push(&self, hardware: &Hardware) -> DVec2 {
        let floor = &hardware.floor;
        let wave_n = floor.waves_n * libm::sin(TAU * self.pose.position_cm.x / WAVE_CM);
        let weight_n = floor.downhill * (hardware.chassis.mass_kg * GRAVITY) + DVec2::new(wave_n, 0.0);
        DVec2::new(weight_n.dot(self.facing), weight_n.dot(self.facing.perp()))
    }

    fn accelerate(&mut self, hardware: &Hardware, force_n: DVec2, torque_nm: f64, seconds: f64) {
        let (chassis, floor) = (&hardware.chassis, &hardware.floor);
        let turned_away = -self.turning_rad_s * self.speed_m_s.perp();
        let free_m_s = (force_n / chassis.mass_kg + turned_away) * seconds;
        let castor = &hardware.castor;
        let turning_n = (castor.turning_drag_n_s * self.turning_rad_s.abs()).min(castor.most_turning_drag_n);
        let castor_n = castor.drag_n + turning_n;
        let drag_n = castor_n + self.floor_drag_n(hardware);
        self.speed_m_s.x = dragged(self.speed_m_s.x, free_m_s.x, drag_n * seconds / chassis.mass_kg, 1.0);
        self.speed_m_s.y += free_m_s.y;
        let scrub_nm = floor.scrub_nm * (1.0 + floor.scrub_wander * self.patch.scrub.value()).max(0.0);
        let (free_rad_s, dry_rad_s) = (torque_nm * seconds, scrub_nm * seconds);
        self.turning_rad_s = dragged(
            self.turning_rad_s,
            free_rad_s / chassis.yaw_inertia_kg_m2,
            dry_rad_s / chassis.yaw_inertia_kg_m2,
            1.0,
        );
    }

    /// Drag of the floor, N: leaning fibres resist motion against them only, a rough patch resists any motion.
    fn floor_drag_n(&self, hardware: &Hardware) -> f64 {
        let floor = &hardware.floor;
        let way = self.facing * self.speed_m_s.x.signum();
        let on_patch = self.pose.position_cm.distance(floor.patch_middle_cm) < floor.patch_radius_cm;
        let patch_n = if on_patch { floor.patch_n } else { 0.0 };
        (floor.nap_n.length() + floor.nap_n.dot(way)) / 2.0 + patch_n
    }

    fn advance(&mut self, seconds: f64) -> f64 {
        let turned_rad = self.turning_rad_s * seconds;
        let way_cm = self.speed_m_s * (100.0 * seconds);
        let faced = self.facing;
        self.pose.heading_rad = wrap_rad(self.pose.heading_rad + turned_rad);
        self.facing = self.pose.direction();
        self.pose.position_cm += ((faced + self.facing) / 2.0).rotate(way_cm);
        way_cm.length()
    }
}

impl Patch {
    fn step(&mut self, grit: f64, rng: &mut Generator) {
        let [left, right] = &mut self.roll;
        for wander in [left, right, &mut self.contact, &mut self.toe, &mut self.scrub] {
            wander.step(rng);
        }
        if grit > 0.0 {
            self.grit = [LEFT, RIGHT].map(|_| if happens(GRAINS, rng) { rng.random_range(-grit..=grit) } else { 0.0 });
        }
    }
}
