//! The injected strength of an effect, in the parameters that a diagnosis reports.

use mindgap_built_in_robot::{ActiveEffect, Effect};

/// A reported number and its true value.
pub type Truth = (&'static str, f64);

/// Returns the parameters of an effect that have a true value. A dead band has none: the built-in robot's is that of all friction, a
/// diagnosis reports what was added to a healthy robot's.
pub fn truth(active: &ActiveEffect) -> Vec<Truth> {
    let ActiveEffect { effect, strength, detail } = *active;
    match effect {
        Effect::MotorAsymmetry => vec![("factor", 1.0 - strength.abs())],
        Effect::Payload => vec![("loss", strength.abs())],
        Effect::BatterySag => vec![("loss_per_min", strength)],
        Effect::DriveScale
        | Effect::TrackWidth
        | Effect::TrackerScale
        | Effect::SonarScale
        | Effect::SonarBeam
        | Effect::SonarAbsorption => vec![("factor", strength)],
        Effect::Saturation => vec![("command", strength)],
        Effect::Latency | Effect::Inertia | Effect::HeadingLag | Effect::TrackerDelay => vec![("ms", strength)],
        Effect::Slope | Effect::CarpetNap => vec![("loss", strength), ("direction_deg", detail)],
        Effect::Slip => vec![("onset", strength)],
        Effect::TurnLoss => vec![("cm_per_rad", strength)],
        Effect::SonarOffset | Effect::SonarNoise | Effect::SonarPitch => vec![("cm", strength)],
        Effect::SonarYaw | Effect::TrackerRotation | Effect::CompassDisturbance => vec![("deg", strength)],
        Effect::SonarGhost => vec![("probability", strength), ("cm", detail)],
        Effect::SonarDropout | Effect::SonarCrosstalk => vec![("probability", strength)],
        Effect::SonarLag => vec![("steps", strength)],
        Effect::LensDistortion => vec![("per_m2", strength)],
        Effect::MarkerOffset => vec![("ahead_cm", strength)],
        _ => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_models::effects::CATALOGUE;

    /// A diagnosis can report every number that has a true value.
    #[test]
    fn true_values_have_the_names_of_reported_parameters() {
        for effect in Effect::all().filter(|effect| effect.in_table()) {
            let known = CATALOGUE.iter().find(|known| known.id == effect.id()).expect("a known effect");
            let names: Vec<&str> =
                known.variants.iter().flat_map(|v| v.parameters).map(|parameter| parameter.setting().0).collect();
            for (name, _) in truth(&ActiveEffect::new(effect)) {
                assert!(names.contains(&name), "{effect}: {name} is not among {names:?}");
            }
        }
    }
}
