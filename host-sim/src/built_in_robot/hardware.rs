//! What the built-in robot is made of, in SI units: a LEGO NXT differential drive as its parts are measured, before
//! any effect. Effects are other parts, so every number that one of them changes stands here, at its healthy value.

use glam::DVec2;

use crate::logs::{Robot, Scene};

/// m/s².
pub(super) const GRAVITY: f64 = 9.81;
/// One side of the robot in arrays of two.
pub(super) const LEFT: usize = 0;
/// The other.
pub(super) const RIGHT: usize = 1;

/// All parts, and the floor that they stand on.
#[derive(Clone, Debug)]
pub(super) struct Hardware {
    /// Time between two rows of a log.
    pub step_ms: f64,
    /// Rim speed at command 100 with healthy parts.
    pub full_speed_m_s: f64,
    pub link: Link,
    pub battery: Battery,
    pub motors: [Motor; 2],
    pub tyres: [Tyre; 2],
    pub chassis: Chassis,
    pub castor: Castor,
    pub floor: Floor,
    pub sonar: Sonar,
    pub tracker: Tracker,
}

/// The way of a command to the motor driver.
#[derive(Clone, Debug)]
pub(super) struct Link {
    /// From the logged time to the driver.
    pub delay_ms: f64,
    /// At most so much more, another time for each command.
    pub delay_jitter_ms: f64,
    /// The driver knows multiples of this command alone; zero for all.
    pub grain: f64,
    /// Standard deviation of a step's length.
    pub step_jitter_ms: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Battery {
    pub fresh_v: f64,
    pub inner_ohm: f64,
    /// What the brick itself draws.
    pub idle_a: f64,
    /// Voltage lost for each coulomb drawn since the run began.
    pub fade_v_per_c: f64,
}

/// A geared DC motor, seen at the wheel's axle.
#[derive(Clone, Debug)]
pub(super) struct Motor {
    pub torque_nm_per_a: f64,
    pub back_emf_v_s: f64,
    pub winding_ohm: f64,
    pub inertia_kg_m2: f64,
    /// Dry friction of the gear while it turns.
    pub friction_nm: f64,
    /// Dry friction at rest as a multiple of that.
    pub breakaway: f64,
    /// Viscous friction of the gear.
    pub viscous_nm_s: f64,
    /// Share of the commanded voltage that its bridge lets through.
    pub bridge: f64,
    /// Share of the speed forwards that it reaches backwards.
    pub backwards: f64,
    /// The bridge gives no more than this.
    pub limit_v: f64,
    /// Play between shaft and wheel.
    pub play_rad: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Tyre {
    pub radius_m: f64,
    /// Distance of its hub from its middle, as a share of the radius.
    pub eccentricity: f64,
    /// Largest push, as a share of the load on it.
    pub grip: f64,
    /// What is left of the grip when it slides.
    pub sliding: f64,
    /// Slip at which the push comes near its largest.
    pub creep_m_s: f64,
    /// Load that it carries.
    pub load_n: f64,
    /// Rolling resistance as a share of the load: the dry part.
    pub rolling: f64,
    /// And the part that grows with speed, as the tyre flexes.
    pub flexing_s_per_m: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Chassis {
    pub mass_kg: f64,
    pub yaw_inertia_kg_m2: f64,
    /// From the middle of the axle to where the tyres touch the floor.
    pub half_track_m: f64,
}

/// The rear support, a wheel that swivels behind its pivot.
#[derive(Clone, Debug)]
pub(super) struct Castor {
    /// How far behind the axle it stands.
    pub behind_m: f64,
    /// From its pivot to where it touches the floor.
    pub trail_m: f64,
    /// Sideways push while it is being turned round.
    pub scrub_n: f64,
    /// Rolling drag.
    pub drag_n: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Floor {
    /// Sine of its tilt along the world's axes, pointing downhill.
    pub downhill: DVec2,
    /// Drag of leaning fibres when driven against them; the vector points the way of most drag.
    pub nap_n: DVec2,
    /// Drag on a round patch in the middle of the room.
    pub patch_n: f64,
    pub patch_middle_cm: DVec2,
    pub patch_radius_cm: f64,
    /// Torque against turning on the spot, from tyres as wide as these.
    pub scrub_nm: f64,
    /// Standard deviations of what changes from place to place: rolled way (share), where the tyre touches, toe angle,
    /// scrub (share).
    pub roughness: f64,
    pub contact_wander_m: f64,
    pub toe_wander_rad: f64,
    pub scrub_wander: f64,
}

/// The ultrasonic sensor, and what sound meets in this room. Levels are dB above what triggers it.
#[derive(Clone, Debug)]
pub(super) struct Sonar {
    /// Ahead of the axle's middle and to its left, cm; the axis, counter-clockwise.
    pub place_cm: DVec2,
    pub yaw_rad: f64,
    pub min_cm: f64,
    pub max_cm: f64,
    pub half_angle_rad: f64,
    /// Level at the beam's edge against its middle.
    pub edge_db: f64,
    /// Extra level at the left edge, taken from the right one.
    pub lean_db: f64,
    /// Level of an echo from a wall one metre ahead, met squarely.
    pub level_db: f64,
    pub absorption_db_per_m: f64,
    /// Level of an echo from anything but the arena's own sides, which are the first so many of all.
    pub obstacle_db: f64,
    pub arena_sides: usize,
    /// How far a wall's facets lean from its normal.
    pub facet_rad: f64,
    /// Share of the sound that a wall scatters every way.
    pub diffuse: f64,
    /// What one mirroring at a wall costs.
    pub mirror_db: f64,
    /// Standard deviations of the level: from ping to ping, and between directions within one.
    pub ping_db: f64,
    pub speckle_db: f64,
    /// Standard deviation of a reading from a square echo, and what a grazing one adds.
    pub scatter_cm: f64,
    pub grazing_cm: f64,
    /// Clock rate and delay of its timer.
    pub timer: f64,
    pub delay_cm: f64,
    /// Change of its clock rate in a minute, as it warms.
    pub warming_per_min: f64,
    /// Chance that the transducer's own ringing triggers it, and at what distance.
    pub ringing: f64,
    pub ringing_cm: f64,
    /// Chance of an echo from something that is always there, such as the floor or a cable, and its distance.
    pub ghost: f64,
    pub ghost_cm: f64,
    /// Chance of hearing another's ping.
    pub crosstalk: f64,
    /// Share of the time that its plug has no contact.
    pub loose: f64,
    /// A reading is of a ping sent so long ago.
    pub age_ms: f64,
}

/// The camera at the ceiling and the compass on the robot.
#[derive(Clone, Debug)]
pub(super) struct Tracker {
    /// What the picture's middle shows, cm.
    pub middle_cm: DVec2,
    pub scale: f64,
    pub turn_rad: f64,
    /// Radial distortion of the lens.
    pub distortion_per_m2: f64,
    /// Where the marker sits on the robot, ahead of the axle's middle and to its left.
    pub marker_cm: DVec2,
    /// Field of iron on the robot against the earth's, in the robot's frame.
    pub iron: DVec2,
    pub position_noise_cm: f64,
    pub marker_noise_rad: f64,
    pub compass_noise_rad: f64,
    /// Chance of a lost frame.
    pub lost: f64,
}

impl Hardware {
    /// The healthy robot, with a battery that takes it to the spec's full speed on the spec's wheels.
    pub fn new(spec: &Robot, scene: &Scene) -> Self {
        let motor = Motor {
            torque_nm_per_a: 0.317,
            back_emf_v_s: 0.468,
            winding_ohm: 6.69,
            inertia_kg_m2: 1.1e-3,
            friction_nm: 0.010,
            breakaway: 1.4,
            viscous_nm_s: 0.0011,
            bridge: 1.0,
            backwards: 1.0,
            limit_v: f64::INFINITY,
            play_rad: 0.0,
        };
        let chassis = Chassis { mass_kg: 0.75, yaw_inertia_kg_m2: 3.5e-3, half_track_m: spec.track_cm / 200.0 };
        let tyre = Tyre {
            radius_m: spec.wheel_diameter_cm / 200.0,
            eccentricity: 0.0,
            grip: 0.9,
            sliding: 0.8,
            creep_m_s: 0.02,
            load_n: 0.4 * chassis.mass_kg * GRAVITY,
            rolling: 0.04,
            flexing_s_per_m: 0.3,
        };
        let full_speed_m_s = spec.full_speed_cm_s / 100.0;
        let castor = Castor { behind_m: 0.07, trail_m: 0.015, scrub_n: 0.0, drag_n: 0.05 };
        let battery = Battery {
            fresh_v: voltage_for(&motor, &tyre, &castor, full_speed_m_s),
            inner_ohm: 0.3,
            idle_a: 0.1,
            fade_v_per_c: 2e-4,
        };
        Hardware {
            step_ms: spec.step_ms,
            full_speed_m_s,
            link: Link { delay_ms: 0.0, delay_jitter_ms: 0.0, grain: 0.0, step_jitter_ms: 4.0 },
            battery,
            motors: [motor.clone(), motor],
            tyres: [tyre.clone(), tyre],
            chassis,
            castor,
            floor: Floor {
                downhill: DVec2::ZERO,
                nap_n: DVec2::ZERO,
                patch_n: 0.0,
                patch_middle_cm: middle_cm(scene),
                patch_radius_cm: 70.0,
                scrub_nm: 0.02,
                roughness: 0.006,
                contact_wander_m: 0.001,
                toe_wander_rad: 0.006,
                scrub_wander: 0.15,
            },
            sonar: Sonar::new(spec, scene),
            tracker: Tracker::new(scene),
        }
    }

    /// Speed that a wheel loses for each newton that holds it back.
    pub fn yielding_m_s_per_n(&self) -> f64 {
        let (motor, radius_m) = (&self.motors[LEFT], self.tyres[LEFT].radius_m);
        radius_m * radius_m / (motor.damping_nm_s() + motor.viscous_nm_s)
    }
}

impl Link {
    /// What the driver makes of a command.
    pub fn passes(&self, command: f64) -> f64 {
        if self.grain > 0.0 { (command / self.grain).round() * self.grain } else { command }
    }
}

impl Motor {
    /// The motor's own braking: torque for each rad/s at a fixed voltage.
    pub fn damping_nm_s(&self) -> f64 {
        self.torque_nm_per_a * self.back_emf_v_s / self.winding_ohm
    }
}

/// The voltage at which a wheel's rim keeps this speed.
fn voltage_for(motor: &Motor, tyre: &Tyre, castor: &Castor, speed_m_s: f64) -> f64 {
    let turning = speed_m_s / tyre.radius_m;
    let drag_n = tyre.load_n * (tyre.rolling + tyre.flexing_s_per_m * speed_m_s) + castor.drag_n / 2.0;
    let torque_nm = motor.friction_nm + motor.viscous_nm_s * turning + drag_n * tyre.radius_m;
    motor.back_emf_v_s * turning + motor.winding_ohm * torque_nm / motor.torque_nm_per_a
}

impl Sonar {
    fn new(spec: &Robot, scene: &Scene) -> Self {
        let seat = &spec.ultrasonic;
        Sonar {
            place_cm: DVec2::new(seat.x_cm, seat.y_cm),
            yaw_rad: seat.yaw_deg.to_radians(),
            min_cm: seat.min_cm,
            max_cm: seat.max_cm,
            half_angle_rad: 0.23,
            edge_db: 20.0,
            lean_db: 0.0,
            level_db: 11.0,
            absorption_db_per_m: 5.0,
            obstacle_db: 0.0,
            arena_sides: if scene.arena_cm.is_some() { 4 } else { 0 },
            facet_rad: 0.42,
            diffuse: 0.12,
            mirror_db: 18.0,
            ping_db: 5.0,
            speckle_db: 2.0,
            scatter_cm: 0.7,
            grazing_cm: 2.5,
            timer: 1.0,
            delay_cm: 0.0,
            warming_per_min: 0.0,
            ringing: 0.025,
            ringing_cm: 20.0,
            ghost: 0.0,
            ghost_cm: 0.0,
            crosstalk: 0.0,
            loose: 0.0,
            age_ms: 0.0,
        }
    }
}

impl Tracker {
    fn new(scene: &Scene) -> Self {
        Tracker {
            middle_cm: middle_cm(scene),
            scale: 1.0,
            turn_rad: 0.0,
            distortion_per_m2: 0.0,
            marker_cm: DVec2::ZERO,
            iron: DVec2::ZERO,
            position_noise_cm: 0.22,
            marker_noise_rad: 0.017,
            compass_noise_rad: 0.019,
            lost: 0.003,
        }
    }
}

/// The middle of everything in a scene: the camera hangs above it.
fn middle_cm(scene: &Scene) -> DVec2 {
    scene.bounding_box().map_or(DVec2::ZERO, |all| (all.low_cm + all.high_cm) / 2.0)
}
