//! Effects held out: outside the table of the diagnosis, and unseen by all that its thresholds and its residual model were
//! chosen on.
//!
//! They were made after the residual model (`gap::omnibus`) was, and no diagnosis was tried on them meanwhile. `challenge calibrate`
//! never draws them, and `challenge make` only with `--outside held-out`. Once a diagnosis is changed on account of one of
//! them, it belongs in the catalogue with the others outside the table, and a new one here.
//!
//! Four change the motion, one the compass, one the camera, and two the sonar. Two that there were before,
//! a loss of speed in turns and echoes by way of a second wall, are in the table by now.

use super::Scale;
use super::entry::Entry;
use crate::hardware::Hardware;

/// A held-out effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum HeldOut {
    /// Commands that never arrive.
    LostCommands,
    /// Viscous friction that fades after the start of a run.
    ColdGrease,
    /// Gravity along a slope that is periodic in the position.
    FloorWaves,
    /// Voltages that rise slowly and fall at once.
    SoftStart,
    /// A compass that follows the heading late.
    CompassDamping,
    /// Noise of the tracked position that grows with the distance from the middle of the picture.
    EdgeBlur,
    /// Echoes lost at high wheel speeds.
    MotorWhine,
    /// Nothing heard from near.
    BlindZone,
}

impl HeldOut {
    const ALL: [HeldOut; 8] = [
        HeldOut::LostCommands,
        HeldOut::ColdGrease,
        HeldOut::FloorWaves,
        HeldOut::SoftStart,
        HeldOut::CompassDamping,
        HeldOut::EdgeBlur,
        HeldOut::MotorWhine,
        HeldOut::BlindZone,
    ];

    /// All of them.
    pub fn all() -> impl Iterator<Item = HeldOut> {
        Self::ALL.into_iter()
    }

    pub(super) fn entry(self) -> Entry {
        let (id, about, strength) = match self {
            HeldOut::LostCommands => (
                "lost_commands",
                "A link that loses a command now and then, so that the one before stays.",
                Scale::rising("chance per step", 0.1, 0.25, 0.5),
            ),
            HeldOut::ColdGrease => (
                "cold_grease",
                "Grease in the gears that is stiff until they have run for a while.",
                Scale::rising("share of speed lost at the start of a run", 0.08, 0.2, 0.4),
            ),
            HeldOut::FloorWaves => (
                "floor_waves",
                "A floor of shallow waves, 30 cm from crest to crest.",
                Scale::rising("share of speed lost at half power where they are steepest", 0.04, 0.1, 0.2),
            ),
            HeldOut::SoftStart => (
                "soft_start",
                "A motor driver that raises voltages slowly and cuts them at once.",
                Scale::rising("ms from none to the full voltage", 200.0, 500.0, 1000.0),
            ),
            HeldOut::CompassDamping => (
                "compass_damping",
                "A compass whose damped needle follows the robot late.",
                Scale::rising("ms", 60.0, 150.0, 400.0),
            ),
            HeldOut::EdgeBlur => (
                "edge_blur",
                "A camera that is out of focus towards the edge of the picture.",
                Scale::rising("cm of scatter one metre from the middle of the picture", 0.3, 0.8, 2.0),
            ),
            HeldOut::MotorWhine => (
                "motor_whine",
                "Gears that whine at the sensor's pitch and drown faint echoes.",
                Scale::rising("decibels lost to them at full speed", 8.0, 20.0, 40.0),
            ),
            HeldOut::BlindZone => (
                "blind_zone",
                "A transducer that rings on after its ping and drowns what comes back from near.",
                Scale::rising("cm within which nothing is heard", 12.0, 25.0, 50.0),
            ),
        };
        Entry { id, about, in_table: false, strength, detail: None }
    }

    /// Applies it to the hardware.
    pub(super) fn fit(self, hardware: &mut Hardware, strength: f64) {
        match self {
            HeldOut::LostCommands => hardware.link.lost = strength,
            HeldOut::ColdGrease => {
                for motor in &mut hardware.motors {
                    let warm_nm_s = motor.damping_nm_s() + motor.viscous_nm_s;
                    motor.cold_nm_s += warm_nm_s * strength / (1.0 - strength);
                }
            }
            HeldOut::FloorWaves => hardware.floor.waves_n += hardware.force_for_loss_n(strength),
            HeldOut::SoftStart => hardware.motors.iter_mut().for_each(|motor| motor.rise_ms += strength),
            HeldOut::CompassDamping => hardware.tracker.needle_ms += strength,
            HeldOut::EdgeBlur => hardware.tracker.blur_cm_per_m2 += strength,
            HeldOut::MotorWhine => hardware.sonar.whine_db += strength,
            HeldOut::BlindZone => hardware.sonar.min_cm = hardware.sonar.min_cm.max(strength),
        }
    }
}
