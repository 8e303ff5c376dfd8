//! Which effects show on what a robot measures of its own motion: rotation counters see it up to the rims, and a gyro sees the
//! body. They distinguish a slipping wheel from a weak motor, and a wrong camera from another wheel.

use super::catalogue::{Candidate, place};
use super::variant::Place;

/// Whether an effect shows on rotation counters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OnCounters {
    /// It acts before the rims.
    Shows,
    /// It acts behind the rims.
    Hidden,
    /// Motors without speed control yield to what holds the robot back, and others do not; more rotation comes from the
    /// motors, and more way per rotation from the tyres.
    Either,
}

/// Returns whether an effect shows on rotation counters.
pub fn on_counters(candidate: &Candidate) -> OnCounters {
    match (place(candidate.effect), candidate.effect) {
        _ if is_of_the_tracker(candidate) => OnCounters::Hidden,
        (Some(Place::Link | Place::Motor), _) => OnCounters::Shows,
        // A load slows the robot by slowing its motors. Hidden behind the rims it would imitate smaller wheels.
        (_, "payload") => OnCounters::Shows,
        (_, "track_width" | "slip" | "turn_lag") => OnCounters::Hidden,
        _ => OnCounters::Either,
    }
}

/// Returns whether an effect shows on a gyro.
pub fn on_gyro(candidate: &Candidate) -> bool {
    !is_of_the_tracker(candidate)
}

fn is_of_the_tracker(candidate: &Candidate) -> bool {
    // Poses that are late are the tracker's, whatever the effect is called.
    let is_late = (candidate.effect, candidate.variant.id) == ("latency", "pose_delay");
    is_late || matches!(place(candidate.effect), Some(Place::Tracker | Place::Sensor))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(effect: &str, variant: &str) -> Candidate {
        Candidate::named(effect, variant).expect("in the catalogue")
    }

    #[test]
    fn counters_see_up_to_the_rims_and_a_gyro_all_but_the_tracker() {
        for (effect, variant, counters, gyro) in [
            ("latency", "delay", OnCounters::Shows, true),
            ("latency", "pose_delay", OnCounters::Hidden, false),
            ("motor_asymmetry", "distance", OnCounters::Shows, true),
            ("drive_scale", "distance", OnCounters::Either, true),
            ("track_width", "turn", OnCounters::Hidden, true),
            ("slip", "change", OnCounters::Hidden, true),
            ("turn_lag", "first_order", OnCounters::Hidden, true),
            ("payload", "motor_load", OnCounters::Shows, true),
            ("marker_offset", "rigid", OnCounters::Hidden, false),
            ("tracker_scale", "about_the_middle", OnCounters::Hidden, false),
        ] {
            let candidate = named(effect, variant);
            assert_eq!((on_counters(&candidate), on_gyro(&candidate)), (counters, gyro), "{effect} {variant}");
        }
    }
}
