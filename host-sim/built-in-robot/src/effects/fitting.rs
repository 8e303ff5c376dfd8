//! Applies effects to the hardware. Several effects at once all change their parts.

use glam::DVec2;

use super::{ActiveEffect, Effect};
use crate::acoustics::Acoustics;
use crate::hardware::{GRAVITY, Hardware, LEFT, RIGHT};
use mindgap_foundations::geometry::direction;

/// Mean battery current in random driving, which converts a fade per minute to a fade per coulomb.
const USUAL_CURRENT_A: f64 = 0.137;

/// Force that a tyre transmits, as a fraction of its load, when the command jumps from 0 to 100.
const STEP_PUSH: f64 = 0.8;

/// Applies an effect to the hardware; neutral strength changes nothing.
pub(crate) fn fit(hardware: &mut Hardware, active: &ActiveEffect) {
    let (strength, detail) = (active.strength, active.detail);
    if strength == active.effect.strength_range().neutral {
        return;
    }
    match active.effect {
        Effect::BatterySag => {
            let lost_v_per_min = strength * hardware.battery.fresh_v;
            hardware.battery.fade_v_per_c += lost_v_per_min / (60.0 * USUAL_CURRENT_A);
        }
        Effect::MotorAsymmetry => {
            let weak = if strength > 0.0 { LEFT } else { RIGHT };
            hardware.motors[weak].bridge *= 1.0 - strength.abs();
        }
        Effect::DriveScale => hardware.tyres.iter_mut().for_each(|tyre| tyre.radius_m *= strength),
        Effect::TrackWidth => hardware.chassis.half_track_m /= strength,
        Effect::Deadband => {
            let command = strength / 100.0;
            for (motor, tyre) in hardware.motors.iter_mut().zip(&hardware.tyres) {
                let stalled_nm = command * hardware.battery.fresh_v / motor.winding_ohm * motor.torque_nm_per_a;
                motor.breakaway = 1.1;
                let rolling_nm = tyre.load_n * tyre.rolling * tyre.radius_m;
                motor.friction_nm = motor.friction_nm.max(stalled_nm / motor.breakaway - rolling_nm);
            }
        }
        Effect::Latency => hardware.link.delay_ms += strength,
        Effect::Inertia => {
            for motor in &mut hardware.motors {
                motor.inertia_kg_m2 += strength / 1000.0 * motor.damping_nm_s();
            }
        }
        Effect::Saturation => {
            let max_v = strength / 100.0 * hardware.battery.fresh_v;
            hardware.motors.iter_mut().for_each(|motor| motor.limit_v = motor.limit_v.min(max_v));
        }
        Effect::Payload => load(hardware, if strength > 0.0 { LEFT } else { RIGHT }, strength.abs()),
        Effect::Slope => {
            let weight_n = hardware.chassis.mass_kg * GRAVITY;
            hardware.floor.downhill +=
                direction(detail.to_radians()) * (hardware.force_for_loss_n(strength) / weight_n);
        }
        Effect::Slip => {
            for tyre in &mut hardware.tyres {
                tyre.grip = tyre.grip.min(strength / 100.0 * STEP_PUSH);
                tyre.sliding = 0.6;
            }
        }
        Effect::CarpetNap => {
            hardware.floor.nap_n += direction(detail.to_radians()) * hardware.force_for_loss_n(strength);
        }
        Effect::TurnLoss => {
            let lost_m_per_rad = strength / 100.0;
            hardware.castor.turning_drag_n_s += 2.0 * lost_m_per_rad / hardware.compliance_m_s_per_n();
        }
        Effect::SonarScale => hardware.sonar.timer *= strength,
        Effect::SonarOffset => hardware.sonar.delay_cm += strength,
        Effect::SonarGhost => (hardware.sonar.ghost, hardware.sonar.ghost_cm) = (strength, detail),
        Effect::SonarDropout => hardware.sonar.loose = strength,
        Effect::SonarYaw => hardware.sonar.yaw_rad += strength.to_radians(),
        Effect::SonarPitch => hardware.sonar.floor_cm = hardware.sonar.floor_cm.min(strength),
        Effect::SonarBeam => hardware.sonar.half_angle_rad *= strength,
        Effect::SonarLag => hardware.sonar.age_ms += strength * hardware.step_ms,
        Effect::SonarAbsorption => hardware.sonar.level_db += 20.0 * libm::log10(strength),
        Effect::SonarCrosstalk => hardware.sonar.crosstalk = strength,
        Effect::SonarMultipath => {
            hardware.sonar.mirror_db -= strength;
            hardware.sonar.diffuse *= libm::pow(10.0, -strength / 20.0);
        }
        Effect::SonarNoise => hardware.sonar.scatter_cm = libm::hypot(hardware.sonar.scatter_cm, strength),
        Effect::TrackerRotation => hardware.tracker.turn_rad += strength.to_radians(),
        Effect::TrackerScale => hardware.tracker.scale *= strength,
        Effect::LensDistortion => hardware.tracker.distortion_per_m2 += strength,
        Effect::MarkerOffset => hardware.tracker.marker_cm += DVec2::new(strength, detail),
        Effect::CompassDisturbance => {
            // Averaging with the camera halves the compass error.
            let field = libm::sin(2.0 * strength.to_radians());
            hardware.tracker.iron += direction(detail.to_radians()) * field;
        }
        Effect::HeadingLag => hardware.tracker.averaged_ms += 2.0 * strength,
        Effect::TrackerDelay => hardware.tracker.age_ms += strength,
        Effect::WheelEccentricity => hardware.tyres.iter_mut().for_each(|tyre| tyre.eccentricity += strength),
        Effect::Backlash => hardware.motors.iter_mut().for_each(|motor| motor.play_rad += strength.to_radians()),
        Effect::CastorKick => hardware.castor.scrub_n += strength,
        Effect::BrushAdvance => hardware.motors.iter_mut().for_each(|motor| motor.backwards *= 1.0 - strength),
        Effect::StickyPatch => hardware.floor.patch_n += hardware.force_for_loss_n(strength),
        Effect::CommandQuantisation => hardware.link.grain = hardware.link.grain.max(strength),
        Effect::LinkJitter => hardware.link.delay_jitter_ms += strength,
        Effect::SoftObstacles => hardware.sonar.obstacle_db -= strength,
        Effect::SonarDrift => hardware.sonar.warming_per_min += strength,
        Effect::SonarOneSided => hardware.sonar.lean_db += strength,
        Effect::MotionNoise => hardware.floor.grit += strength,
        Effect::PlaceBound => {
            let sonar = &mut hardware.sonar;
            let chance_db = libm::hypot(sonar.ping_db, sonar.speckle_db);
            sonar.place_db = strength.sqrt() * chance_db;
            sonar.ping_db *= (1.0 - strength).sqrt();
            sonar.speckle_db *= (1.0 - strength).sqrt();
            sonar.acoustics = Acoustics::of_room(detail);
        }
        Effect::Unchanged => {}
        Effect::HeldOut(effect) => effect.fit(hardware, strength),
    }
}

/// Adds the mass over one wheel whose rolling resistance costs a fraction `share` of half its full speed.
fn load(hardware: &mut Hardware, side: usize, share: f64) {
    let half_speed_m_s = hardware.full_speed_m_s / 2.0;
    let drag_n = share * half_speed_m_s / hardware.compliance_m_s_per_n();
    let tyre = &mut hardware.tyres[side];
    let load_n = drag_n / (tyre.rolling + tyre.flexing_s_per_m * half_speed_m_s);
    tyre.load_n += load_n;
    let (mass_kg, arm_m) = (load_n / GRAVITY, hardware.chassis.half_track_m);
    hardware.chassis.mass_kg += mass_kg;
    hardware.chassis.yaw_inertia_kg_m2 += mass_kg * arm_m * arm_m;
}
