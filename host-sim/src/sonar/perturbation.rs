//! How a sensor differs from its model.

/// Changes to a sensor; [`Perturbation::NONE`] changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbation {
    /// Subtracted from every ray's log-odds.
    pub attenuation: f64,
    /// Subtracted from a ray's log-odds per metre of its distance.
    pub attenuation_per_m: f64,
    /// Subtracted from a ray's log-odds per 45 degrees of its incidence.
    pub attenuation_per_incidence: f64,
    /// Subtracted from the log-odds of a ray that a wall has mirrored.
    pub attenuation_mirrored: f64,
    /// Factor on the readings of echoes.
    pub gain: f64,
    /// Added to the readings of echoes after the factor, cm.
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
    /// Probability of a random reading from beyond what the axis meets, in place of a reading.
    pub p_long: f64,
}

impl Perturbation {
    /// What an echo loses in log-odds over a distance in metres, at an incidence in units of 45 degrees.
    pub fn loss(&self, metres: f64, incidence: f64) -> f64 {
        self.attenuation + self.attenuation_per_m * metres + self.attenuation_per_incidence * incidence
    }

    /// The reading of an echo that otherwise reads `echo_cm`.
    pub fn reading_cm(&self, echo_cm: f64) -> f64 {
        echo_cm * self.gain + self.offset_cm
    }

    /// The sensor as its model has it.
    pub const NONE: Perturbation = Perturbation {
        attenuation: 0.0,
        attenuation_per_m: 0.0,
        attenuation_per_incidence: 0.0,
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
    };
}
