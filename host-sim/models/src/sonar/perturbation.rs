//! Differences of a sensor from its model.

use mindgap_foundations::statistics::summary::logistic;

/// i₀ and f of the first-echo law's loss by incidence, the medians over eleven sensors.
const USUAL_SPECULAR_DEG: f64 = 15.0;
const USUAL_OBLIQUE_LOSS: f64 = 10.7;
/// Width of the floor's edge as a fraction of its distance: a beam has some height.
const FLOOR_EDGE: f64 = 0.05;
/// Readings that exceed the range by no more than this are still reported, since sensors report whole centimetres, cm.
pub const ROUNDED_BY_CM: f64 = 0.5;

/// Changes to a sensor; [`Perturbation::NONE`] changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbation {
    /// Factor on the width of the beam.
    pub width: f64,
    /// Subtracted from every ray's log-odds.
    pub attenuation: f64,
    /// Subtracted from a ray's log-odds per metre of its distance.
    pub attenuation_per_m: f64,
    /// Subtracted from a ray's log-odds per 45 degrees of its incidence.
    pub attenuation_per_incidence: f64,
    /// Subtracted from a ray's log-odds per unit of the natural logarithm of its distance in metres: sound spreads.
    pub spreading: f64,
    /// Share of the usual loss of walls by incidence that is subtracted from a ray's log-odds: see [`loss_by_incidence`].
    pub mirroring: f64,
    /// Subtracted from the log-odds of a mirrored ray.
    pub attenuation_mirrored: f64,
    /// Factor on the readings of echoes and on the constant one, which the same electronics measure.
    pub gain: f64,
    /// Added to them after the factor, cm.
    pub offset_cm: f64,
    /// Further scatter of the readings of echoes, cm, independent of the model's.
    pub scatter_cm: f64,
    /// Probability that an echo is dropped.
    pub p_dropout: f64,
    /// Probability of the ghost in place of an echo.
    pub p_ghost_given_echo: f64,
    /// Probability of the ghost in place of none.
    pub p_ghost_given_none: f64,
    /// The ghost's reading, cm.
    pub ghost_cm: f64,
    /// Probability of a random short reading.
    pub p_short: f64,
    /// Probability of a random reading from beyond the wall on the axis, in place of a reading.
    pub p_long: f64,
    /// Probability of the same in place of none.
    pub p_long_given_none: f64,
    /// Distance at which the beam meets the floor, cm; infinite where it does not.
    pub floor_cm: f64,
    /// Probability that the floor returns an echo where nothing before it does.
    pub p_floor: f64,
}

impl Perturbation {
    /// Returns the loss of an echo in log-odds over a distance in metres, at an incidence in units of 45 degrees.
    pub fn loss(&self, metres: f64, incidence: f64) -> f64 {
        let loss = self.attenuation + self.attenuation_per_m * metres + self.attenuation_per_incidence * incidence;
        if !self.shapes_losses() {
            return loss;
        }
        let usual = loss_by_incidence(45.0 * incidence, USUAL_SPECULAR_DEG, USUAL_OBLIQUE_LOSS);
        loss + self.spreading * libm::log(metres) + self.mirroring * usual
    }

    /// Returns whether the loss of echoes is not linear in distance and incidence.
    pub fn shapes_losses(&self) -> bool {
        self.spreading != 0.0 || self.mirroring != 0.0
    }

    /// Returns the fraction of echoes from this distance that the floor keeps from coming back.
    pub fn behind_floor(&self, distance_cm: f64) -> f64 {
        logistic((distance_cm / self.floor_cm - 1.0) / FLOOR_EDGE)
    }

    /// Returns whether the beam meets the floor.
    pub fn meets_floor(&self) -> bool {
        self.floor_cm.is_finite()
    }

    /// Returns the reading of the perturbed sensor where the model reads `echo_cm`.
    pub fn reading_cm(&self, echo_cm: f64) -> f64 {
        echo_cm * self.gain + self.offset_cm
    }

    /// Returns the centre of the perturbed readings where the model reads `echo_cm`.
    pub fn middle_cm(&self, echo_cm: f64, range_cm: [f64; 2]) -> f64 {
        let [least_cm, most_cm] = self.middle_bounds_cm(range_cm);
        self.reading_cm(echo_cm).clamp(least_cm, most_cm)
    }

    /// Returns the bounds of the centres of readings: the ends of the range, or infinity at ends that are
    /// [led beyond it](Self::leads_ends_beyond).
    pub fn middle_bounds_cm(&self, [low_cm, high_cm]: [f64; 2]) -> [f64; 2] {
        let [below, above] = self.leads_ends_beyond([low_cm, high_cm]);
        [if below { f64::NEG_INFINITY } else { low_cm }, if above { f64::INFINITY } else { high_cm }]
    }

    /// Returns for the low and the high end of a range whether readings there are led beyond it, and so are not reported.
    /// Other readings beyond the range are reported as its end.
    pub fn leads_ends_beyond(&self, [low_cm, high_cm]: [f64; 2]) -> [bool; 2] {
        [low_cm - self.reading_cm(low_cm), self.reading_cm(high_cm) - high_cm]
            .map(|beyond_cm| beyond_cm > ROUNDED_BY_CM)
    }

    /// No perturbation.
    pub const NONE: Perturbation = Perturbation {
        width: 1.0,
        attenuation: 0.0,
        attenuation_per_m: 0.0,
        attenuation_per_incidence: 0.0,
        spreading: 0.0,
        mirroring: 0.0,
        attenuation_mirrored: 0.0,
        gain: 1.0,
        offset_cm: 0.0,
        scatter_cm: 0.0,
        p_dropout: 0.0,
        p_ghost_given_echo: 0.0,
        p_ghost_given_none: 0.0,
        ghost_cm: 20.0,
        p_short: 0.0,
        p_long: 0.0,
        p_long_given_none: 0.0,
        floor_cm: f64::INFINITY,
        p_floor: 0.0,
    };
}

/// Returns the loss of a wall in log-odds by its incidence: that of a mirror, but at most `most`; at `specular_deg` it is
/// about one.
pub fn loss_by_incidence(incidence_deg: f64, specular_deg: f64, most: f64) -> f64 {
    let turned = incidence_deg / specular_deg;
    most * (1.0 - libm::exp(-turned * turned / most))
}
