//! Parameters of the built-in robot in SI units: a LEGO NXT differential drive with measured parts and without effects. Every
//! parameter that an effect changes has its healthy value here.

use glam::DVec2;

use super::acoustics::Acoustics;
use mindgap_logs::{Robot, Scene};

/// Gravitational acceleration, m/s².
pub(super) const GRAVITY: f64 = 9.81;
/// Index of the left side in arrays of two.
pub(super) const LEFT: usize = 0;
/// Index of the right side.
pub(super) const RIGHT: usize = 1;

/// All parts, and the floor.
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

/// The link that carries commands to the motor driver.
#[derive(Clone, Debug)]
pub(super) struct Link {
    /// Delay between the logged time and the driver.
    pub delay_ms: f64,
    /// Maximum additional random delay, drawn per command.
    pub delay_jitter_ms: f64,
    /// Probability that a command is lost.
    pub lost: f64,
    /// Quantisation step of commands at the driver; zero for none.
    pub grain: f64,
    /// Standard deviation of the duration of a step.
    pub step_jitter_ms: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Battery {
    pub fresh_v: f64,
    pub inner_ohm: f64,
    /// Current drawn by the brick itself.
    pub idle_a: f64,
    /// Voltage lost per coulomb drawn since the start of the run.
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
    /// Dry friction at rest as a multiple of `friction_nm`.
    pub breakaway: f64,
    /// Viscous friction of the gear.
    pub viscous_nm_s: f64,
    /// Additional viscous friction of cold grease at the start of a run.
    pub cold_nm_s: f64,
    /// Fraction of the commanded voltage that the bridge passes.
    pub bridge: f64,
    /// Speed backwards relative to forwards.
    pub backwards: f64,
    /// Largest voltage of the bridge.
    pub limit_v: f64,
    /// Time in which the bridge raises its duty cycle from 0 to 1; it lowers it instantly.
    pub rise_ms: f64,
    /// Backlash between shaft and wheel.
    pub play_rad: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Tyre {
    pub radius_m: f64,
    /// Eccentricity of the hub, as a fraction of the radius.
    pub eccentricity: f64,
    /// Coefficient of static friction: maximum force as a fraction of the load.
    pub grip: f64,
    /// Sliding friction relative to static friction.
    pub sliding: f64,
    /// Slip velocity at which the force approaches its maximum.
    pub creep_m_s: f64,
    /// Load on the tyre.
    pub load_n: f64,
    /// Dry rolling resistance as a fraction of the load.
    pub rolling: f64,
    /// Rolling resistance per speed from flexing of the tyre, as a fraction of the load.
    pub flexing_s_per_m: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Chassis {
    pub mass_kg: f64,
    pub yaw_inertia_kg_m2: f64,
    /// Distance from the centre of the axle to the contact points of the tyres.
    pub half_track_m: f64,
}

/// The rear support, a wheel that swivels behind its pivot.
#[derive(Clone, Debug)]
pub(super) struct Castor {
    /// Distance behind the axle.
    pub behind_m: f64,
    /// Distance from its pivot to its contact point.
    pub trail_m: f64,
    /// Sideways force while it swivels.
    pub scrub_n: f64,
    /// Rolling drag.
    pub drag_n: f64,
    /// Additional drag per rad/s of turn rate.
    pub turning_drag_n_s: f64,
    /// Maximum of that additional drag: a jammed castor rubs with its load, and half as much again where it digs in.
    pub max_turning_drag_n: f64,
}

#[derive(Clone, Debug)]
pub(super) struct Floor {
    /// Sine of its tilt along the world's axes, pointing downhill.
    pub downhill: DVec2,
    /// Drag of leaning fibres; the vector points in the direction of greatest drag.
    pub nap_n: DVec2,
    /// Drag on a round patch in the middle of the room.
    pub patch_n: f64,
    pub patch_centre_cm: DVec2,
    pub patch_radius_cm: f64,
    /// Component of the weight along the floor where the waves across the x axis are steepest.
    pub waves_n: f64,
    /// Scrub torque of the wide tyres against turning on the spot.
    pub scrub_nm: f64,
    /// Maximum fraction of distance that a wheel loses or gains on a grain of grit.
    pub grit: f64,
    /// Standard deviation of the relative rolling radius from place to place.
    pub roughness: f64,
    /// Standard deviation of the contact point from place to place.
    pub contact_wander_m: f64,
    /// Standard deviation of the toe angle from place to place.
    pub toe_wander_rad: f64,
    /// Standard deviation of the relative scrub torque from place to place.
    pub scrub_wander: f64,
}

/// The ultrasonic sensor and the acoustics of the room. Levels are dB above the threshold of the sensor.
#[derive(Clone, Debug)]
pub(super) struct Sonar {
    /// Position ahead of the centre of the axle and to its left.
    pub mount_cm: DVec2,
    /// Direction of the axis, counter-clockwise.
    pub yaw_rad: f64,
    pub min_cm: f64,
    pub max_cm: f64,
    pub half_angle_rad: f64,
    /// Attenuation at the beam's edge relative to its axis.
    pub edge_db: f64,
    /// Level added at the beam's left edge and subtracted at the right one.
    pub lean_db: f64,
    /// Level of an echo from a wall one metre ahead at normal incidence.
    pub level_db: f64,
    pub absorption_db_per_m: f64,
    /// Level added to echoes from anything other than the arena's own sides.
    pub obstacle_db: f64,
    /// Number of the arena's own sides, which come first in the list of all sides.
    pub arena_sides: usize,
    /// Incidence angle at which the amplitude of the echo from a wall's facets falls to 1/e.
    pub facet_rad: f64,
    /// Fraction of the sound that a wall scatters diffusely.
    pub diffuse: f64,
    /// Loss of a specular reflection.
    pub mirror_db: f64,
    /// Standard deviation of the level from ping to ping.
    pub ping_db: f64,
    /// Standard deviation of the level between directions within a ping.
    pub speckle_db: f64,
    /// Standard deviation of the level from place to place.
    pub place_db: f64,
    /// Distribution of the place-dependent level over the room.
    pub acoustics: Acoustics,
    /// Level lost to motor noise when both motors run at full speed.
    pub whine_db: f64,
    /// Standard deviation of a reading at normal incidence.
    pub scatter_cm: f64,
    /// Additional standard deviation at grazing incidence.
    pub grazing_cm: f64,
    /// Clock rate of the timer.
    pub timer: f64,
    /// Delay of the timer.
    pub delay_cm: f64,
    /// Change of the clock rate per minute as the timer warms up.
    pub warming_per_min: f64,
    /// Probability that the transducer's own ringing triggers the sensor.
    pub ringing: f64,
    /// Distance read when the ringing triggers the sensor.
    pub ringing_cm: f64,
    /// Probability of an echo from a fixed object such as the floor or a cable.
    pub ghost: f64,
    /// Distance of the fixed object.
    pub ghost_cm: f64,
    /// Probability of receiving the ping of another sensor.
    pub crosstalk: f64,
    /// Fraction of time in which the plug has no contact.
    pub loose: f64,
    /// Age of the ping behind a reading.
    pub age_ms: f64,
    /// Distance along the floor at which the axis meets it; infinite for a level beam.
    pub floor_cm: f64,
}

/// The ceiling camera and the compass on the robot.
#[derive(Clone, Debug)]
pub(super) struct Tracker {
    /// Point of the floor at the centre of the picture, cm.
    pub centre_cm: DVec2,
    pub scale: f64,
    pub turn_rad: f64,
    /// Radial distortion of the lens.
    pub distortion_per_m2: f64,
    /// Position of the marker ahead of the centre of the axle and to its left.
    pub marker_cm: DVec2,
    /// Field of iron on the robot relative to the earth's field, in the robot's frame.
    pub iron: DVec2,
    /// Time constant of the compass needle.
    pub needle_ms: f64,
    /// Time over which the tracker averages headings.
    pub averaged_ms: f64,
    /// Age of a pose when it arrives.
    pub age_ms: f64,
    pub position_noise_cm: f64,
    /// Additional position noise one metre from the centre of the picture; it grows with the square of the distance.
    pub blur_cm_per_m2: f64,
    pub marker_noise_rad: f64,
    pub compass_noise_rad: f64,
    /// Probability of a lost frame.
    pub lost: f64,
}

impl Hardware {
    /// Returns the healthy robot, with the battery voltage that gives the specified full speed on the specified wheels.
    pub fn new(spec: &Robot, scene: &Scene) -> Self {
        let motor = Motor {
            torque_nm_per_a: 0.317,
            back_emf_v_s: 0.468,
            winding_ohm: 6.69,
            inertia_kg_m2: 1.1e-3,
            friction_nm: 0.010,
            breakaway: 1.4,
            viscous_nm_s: 0.0011,
            cold_nm_s: 0.0,
            bridge: 1.0,
            backwards: 1.0,
            limit_v: f64::INFINITY,
            rise_ms: 0.0,
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
        let castor = Castor {
            behind_m: 0.07,
            trail_m: 0.015,
            scrub_n: 0.0,
            drag_n: 0.05,
            turning_drag_n_s: 0.0,
            max_turning_drag_n: 1.5 * (chassis.mass_kg * GRAVITY - 2.0 * tyre.load_n),
        };
        let battery = Battery {
            fresh_v: voltage_for(&motor, &tyre, &castor, full_speed_m_s),
            inner_ohm: 0.3,
            idle_a: 0.1,
            fade_v_per_c: 2e-4,
        };
        Hardware {
            step_ms: spec.step_ms,
            full_speed_m_s,
            link: Link { delay_ms: 0.0, delay_jitter_ms: 0.0, lost: 0.0, grain: 0.0, step_jitter_ms: 4.0 },
            battery,
            motors: [motor.clone(), motor],
            tyres: [tyre.clone(), tyre],
            chassis,
            castor,
            floor: Floor {
                downhill: DVec2::ZERO,
                nap_n: DVec2::ZERO,
                patch_n: 0.0,
                patch_centre_cm: centre_cm(scene),
                patch_radius_cm: 70.0,
                waves_n: 0.0,
                scrub_nm: 0.02,
                grit: 0.0,
                roughness: 0.006,
                contact_wander_m: 0.001,
                toe_wander_rad: 0.006,
                scrub_wander: 0.15,
            },
            sonar: Sonar::new(spec, scene),
            tracker: Tracker::new(scene),
        }
    }

    /// Returns the speed that a wheel loses per newton of drag.
    pub fn compliance_m_s_per_n(&self) -> f64 {
        let (motor, radius_m) = (&self.motors[LEFT], self.tyres[LEFT].radius_m);
        radius_m * radius_m / (motor.damping_nm_s() + motor.viscous_nm_s)
    }

    /// Returns the force on the body at which both wheels together lose a fraction `share` of half their full speed.
    pub fn force_for_loss_n(&self, share: f64) -> f64 {
        share * self.full_speed_m_s / self.compliance_m_s_per_n()
    }
}

impl Link {
    /// Returns a command as quantised by the driver.
    pub fn quantised(&self, command: f64) -> f64 {
        if self.grain > 0.0 { (command / self.grain).round() * self.grain } else { command }
    }
}

impl Motor {
    /// Returns the motor's own damping: torque per rad/s at a fixed voltage.
    pub fn damping_nm_s(&self) -> f64 {
        self.torque_nm_per_a * self.back_emf_v_s / self.winding_ohm
    }
}

/// Returns the voltage at which a wheel's rim keeps a speed.
fn voltage_for(motor: &Motor, tyre: &Tyre, castor: &Castor, speed_m_s: f64) -> f64 {
    let turning = speed_m_s / tyre.radius_m;
    let drag_n = tyre.load_n * (tyre.rolling + tyre.flexing_s_per_m * speed_m_s) + castor.drag_n / 2.0;
    let torque_nm = motor.friction_nm + motor.viscous_nm_s * turning + drag_n * tyre.radius_m;
    motor.back_emf_v_s * turning + motor.winding_ohm * torque_nm / motor.torque_nm_per_a
}

impl Sonar {
    fn new(spec: &Robot, scene: &Scene) -> Self {
        // No reading lies within the empty range of a robot without a sensor.
        let [min_cm, max_cm] = spec.ultrasonic.map_or([0.0; 2], |sensor| sensor.range_cm());
        Sonar {
            mount_cm: spec.ultrasonic.map_or(DVec2::ZERO, |sensor| DVec2::new(sensor.x_cm, sensor.y_cm)),
            yaw_rad: spec.ultrasonic.map_or(0.0, |sensor| sensor.yaw_deg.to_radians()),
            min_cm,
            max_cm,
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
            place_db: 0.0,
            acoustics: Acoustics::default(),
            whine_db: 0.0,
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
            floor_cm: f64::INFINITY,
        }
    }
}

impl Tracker {
    fn new(scene: &Scene) -> Self {
        Tracker {
            centre_cm: centre_cm(scene),
            scale: 1.0,
            turn_rad: 0.0,
            distortion_per_m2: 0.0,
            marker_cm: DVec2::ZERO,
            iron: DVec2::ZERO,
            needle_ms: 0.0,
            averaged_ms: 0.0,
            age_ms: 0.0,
            position_noise_cm: 0.22,
            blur_cm_per_m2: 0.0,
            marker_noise_rad: 0.017,
            compass_noise_rad: 0.019,
            lost: 0.003,
        }
    }
}

/// Returns the centre of a scene, above which the camera hangs, cm.
fn centre_cm(scene: &Scene) -> DVec2 {
    scene.bounding_box().map_or(DVec2::ZERO, |all| (all.low_cm + all.high_cm) / 2.0)
}
