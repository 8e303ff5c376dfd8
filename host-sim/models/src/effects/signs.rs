//! What each effect looks like in logs, and which others it can be mistaken for.

/// The signs of an effect.
#[derive(Clone, Copy, Debug)]
pub struct Signs {
    /// Id of the effect.
    pub effect: &'static str,
    /// A sentence about the residuals that it leaves.
    pub in_logs: &'static str,
    /// Ids of the effects that leave similar residuals.
    pub imitated_by: &'static [&'static str],
}

/// Returns the signs of a built-in effect, or `None` for one of the user's own.
pub fn signs(effect: &str) -> Option<&'static Signs> {
    SIGNS.iter().find(|signs| signs.effect == effect)
}

/// The signs of all effects, in the order of [`CATALOGUE`](super::CATALOGUE).
const SIGNS: &[Signs] = &[
    Signs {
        effect: "battery_sag",
        in_logs: "Steps agree at the start of a run and get shorter with time, on both wheels alike.",
        imitated_by: &["drive_scale", "payload"],
    },
    Signs {
        effect: "motor_asymmetry",
        in_logs: "Straight commands bend to one side, in proportion to the speed.",
        imitated_by: &["payload", "slip"],
    },
    Signs {
        effect: "drive_scale",
        in_logs: "Forward motion and turns are off by one factor at all speeds.",
        imitated_by: &["saturation", "payload", "tracker_scale"],
    },
    Signs {
        effect: "track_width",
        in_logs: "Turns are off by one factor; straight steps agree.",
        imitated_by: &["turn_loss", "compass_disturbance"],
    },
    Signs {
        effect: "deadband",
        in_logs: "Small commands move the robot too little or not at all; large ones agree.",
        imitated_by: &["payload", "inertia"],
    },
    Signs {
        effect: "saturation",
        in_logs: "Steps at high commands are too short and all alike; slower ones agree.",
        imitated_by: &["battery_sag", "slip"],
    },
    Signs {
        effect: "latency",
        in_logs: "Residuals appear only after a change of the command, and the motion is that of the command before.",
        imitated_by: &["inertia", "tracker_delay"],
    },
    Signs {
        effect: "inertia",
        in_logs: "After a change of the command the motion approaches its new value over several steps.",
        imitated_by: &["latency", "slip"],
    },
    Signs {
        effect: "rate_limit",
        in_logs: "After a change of the command the motion approaches its new value at a constant rate: large changes take longer.",
        imitated_by: &["inertia", "slip"],
    },
    Signs {
        effect: "turn_lag",
        in_logs: "After a change of the command turns approach their new value over several steps; straight runs do at once.",
        imitated_by: &["inertia", "latency"],
    },
    Signs {
        effect: "payload",
        in_logs: "The robot is slower at all speeds, slow to start, and bends to the loaded side.",
        imitated_by: &["motor_asymmetry", "drive_scale", "slope"],
    },
    Signs {
        effect: "slope",
        in_logs: "Residuals depend on the heading: too long downhill, too short uphill, sideways drift across the slope.",
        imitated_by: &["carpet_nap", "tracker_rotation"],
    },
    Signs {
        effect: "slip",
        in_logs: "Steps after large changes of the command, or at high speed, are too short.",
        imitated_by: &["inertia", "saturation"],
    },
    Signs {
        effect: "turn_loss",
        in_logs: "Forward motion is too short in proportion to the turn; straight steps agree.",
        imitated_by: &["track_width", "marker_offset"],
    },
    Signs {
        effect: "carpet_nap",
        in_logs: "Forward motion is shortest in one direction of travel and longest in the opposite one.",
        imitated_by: &["slope"],
    },
    Signs {
        effect: "sonar_scale",
        in_logs: "The error of readings grows in proportion to the distance.",
        imitated_by: &["sonar_offset", "tracker_scale"],
    },
    Signs {
        effect: "sonar_offset",
        in_logs: "The error of readings is the same at all distances.",
        imitated_by: &["sonar_scale", "marker_offset"],
    },
    Signs {
        effect: "sonar_yaw",
        in_logs: "Readings belong to a direction to one side of the heading: too long or too short as a wall slants.",
        imitated_by: &["sonar_beam", "tracker_rotation"],
    },
    Signs {
        effect: "sonar_pitch",
        in_logs: "Beyond one distance readings are missing, or all are of that distance; nearer ones agree.",
        imitated_by: &["sonar_absorption", "sonar_ghost"],
    },
    Signs {
        effect: "sonar_beam",
        in_logs: "Edges and corners are seen too early or too late; walls that are met squarely agree.",
        imitated_by: &["sonar_yaw", "sonar_multipath"],
    },
    Signs {
        effect: "sonar_ghost",
        in_logs: "One reading recurs at places where nothing is at that distance.",
        imitated_by: &["sonar_crosstalk"],
    },
    Signs {
        effect: "sonar_dropout",
        in_logs: "Missing readings follow each other, at any distance and incidence angle.",
        imitated_by: &["sonar_absorption"],
    },
    Signs {
        effect: "sonar_lag",
        in_logs: "Readings are too long on the way towards a wall and too short on the way from it.",
        imitated_by: &["latency", "sonar_offset"],
    },
    Signs {
        effect: "sonar_absorption",
        in_logs: "Echoes are missing at distances and incidence angles at which the simulator expects them.",
        imitated_by: &["sonar_dropout", "sonar_beam"],
    },
    Signs {
        effect: "sonar_crosstalk",
        in_logs: "Single readings are too short by random amounts.",
        imitated_by: &["sonar_ghost", "sonar_noise"],
    },
    Signs {
        effect: "sonar_multipath",
        in_logs: "Readings at oblique incidence are now and then much too long.",
        imitated_by: &["sonar_noise", "sonar_beam"],
    },
    Signs {
        effect: "sonar_noise",
        in_logs: "Readings scatter around the right value more than expected, at all distances.",
        imitated_by: &["sonar_crosstalk", "sonar_lag"],
    },
    Signs {
        effect: "tracker_rotation",
        in_logs: "The robot moves at a fixed angle to its heading, wherever it drives.",
        imitated_by: &["compass_disturbance", "sonar_yaw"],
    },
    Signs {
        effect: "tracker_scale",
        in_logs: "Forward motion is off by one factor; turns agree.",
        imitated_by: &["drive_scale"],
    },
    Signs {
        effect: "lens_distortion",
        in_logs: "Forward motion is off by a factor that changes with the distance from the middle of the picture.",
        imitated_by: &["tracker_scale"],
    },
    Signs {
        effect: "marker_offset",
        in_logs: "Turns on the spot come with lateral motion in proportion to the turn.",
        imitated_by: &["turn_loss", "tracker_rotation"],
    },
    Signs {
        effect: "compass_disturbance",
        in_logs: "Turns are off depending on the heading; the errors cancel over a full turn.",
        imitated_by: &["tracker_rotation", "track_width"],
    },
    Signs {
        effect: "heading_lag",
        in_logs: "In turns the robot moves to the inside of its heading; after a change of turn rate the heading moves on over several steps.",
        imitated_by: &["turn_lag", "marker_offset"],
    },
    Signs {
        effect: "tracker_delay",
        in_logs: "The motion is that of the command before, and readings are those of a place ahead of the pose.",
        imitated_by: &["latency", "sonar_lag"],
    },
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::CATALOGUE;

    #[test]
    fn every_effect_has_signs_and_known_imitators() {
        let ids: Vec<&str> = CATALOGUE.iter().map(|effect| effect.id).collect();
        assert_eq!(SIGNS.iter().map(|signs| signs.effect).collect::<Vec<_>>(), ids);
        for Signs { effect, in_logs, imitated_by } in SIGNS {
            assert!(in_logs.ends_with('.'), "{effect}");
            assert!(imitated_by.iter().all(|id| ids.contains(id) && id != effect), "{effect}");
        }
    }
}
