//! The thresholds of a diagnosis: those calibrated by `mindgap challenge calibrate` on cases with known answers, and those set by
//! convention or judgement, whose influence `mindgap challenge sensitivity` measures.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::shipped;

/// All thresholds that decide between answers.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Number of rows for which the gates are set.
    pub rows: f64,
    /// Fraction of the explainable gap that effects have to explain to be its cause.
    pub adequate: f64,
    /// Width of the logistic curve from that fraction to a probability.
    pub adequacy_width: f64,
    /// Relative likelihoods of rivals are raised to the power of its inverse: above one, rivals weigh more than their nats.
    pub temperature: f64,
    /// How often the clearest answer is right: the maximum probability.
    pub accuracy_cap: f64,
    /// Gate of an effect: its least winsorized gain by cross-validation, nats.
    pub effect_nats: f64,
    /// Gate of a remainder in a channel, and of wider noise, nats.
    pub remainder_nats: f64,
    /// Fraction of what effects explain in a channel that model-form error could account for: a further effect has to gain that
    /// much more there. Some effects have [their own](super::further_shares::FurtherShares).
    pub further_share: f64,
    /// The thresholds that are not calibrated.
    pub judgement: Judgement,
}

/// Thresholds by convention or judgement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Judgement {
    /// Strong evidence, nats: odds of 20 to 1 (Kass and Raftery 1995). Held-out runs have to confirm with it, smaller leads over a
    /// rival and smaller gaps of a channel are not reported, and an effect that promises less is untestable.
    pub strong_nats: f64,
    /// An effect is ambiguous with rivals that lag by no more than this many standard errors.
    pub rival_z: f64,
    /// An effect with more rivals than this has to gain `vague_factor` times as much: the misfit of a simulator resembles many
    /// effects a little.
    pub most_rivals: usize,
    /// See `most_rivals`.
    pub vague_factor: f64,
    /// Maximum number of effects that are named together: real robots differ in several ways at once.
    pub most_effects: usize,
    /// Noise is wider from this multiple of the simulator's on: five standard errors of a standard deviation estimated from a
    /// thousand rows.
    pub scatter_ratio: f64,
    /// Effects are the whole cause only if they improve open-loop paths by at least this fraction of what they predict: with
    /// less, no improvement would be the better prediction.
    pub rollouts_nearer: f64,
}

/// Number of steps from which the simulators of the calibration learned their motion: eighty runs of sixty. A test of `challenge`
/// checks it.
pub const CALIBRATED_STEPS: f64 = 4800.0;

/// The file written by `mindgap challenge calibrate`.
pub const SHIPPED: &str = include_str!("calibration.toml");

static CALIBRATION: LazyLock<Calibration> = LazyLock::new(|| shipped::read(SHIPPED));

impl Calibration {
    /// The calibration that diagnoses use.
    pub fn shipped() -> Self {
        *CALIBRATION
    }

    /// The same with the usual thresholds in place of those that only affect the verdict. Calibrations that are equal then find the
    /// same effects.
    pub fn for_search(&self) -> Self {
        let Calibration { adequate, adequacy_width, temperature, accuracy_cap, .. } = Self::shipped();
        Calibration { adequate, adequacy_width, temperature, accuracy_cap, ..*self }
    }

    /// Scales the gates to a number of rows, against a simulator that learned its motion from `trained_on` steps.
    pub fn for_rows(self, rows: usize, trained_on: Option<f64>) -> Self {
        let growth = self.growth(rows, trained_on);
        let (effect_nats, remainder_nats) = (growth * self.effect_nats, growth * self.remainder_nats);
        Calibration { effect_nats, remainder_nats, ..self }
    }

    /// Raises the gates to at least strong evidence for the best of this many competitors: of a hundred hypotheses one looks a
    /// hundred times as likely by chance.
    pub fn among(self, effects: usize, channels: usize) -> Self {
        let least = |competitors: usize| self.judgement.strong_nats + libm::log(competitors.max(1) as f64);
        let effect_nats = self.effect_nats.max(least(effects));
        let remainder_nats = self.remainder_nats.max(least(channels));
        Calibration { effect_nats, remainder_nats, ..self }
    }

    /// Returns the factor on the gates for a number of rows and training steps. It is never below one, since chance gains do not
    /// shrink. Gains from the simulator's own misfit grow with the rows. A parameter that the simulator estimated from m steps
    /// gains, on n rows where nothing has changed, half a nat times 1 + n / m: the variance of the difference of two means, over
    /// that of the second.
    pub fn growth(&self, rows: usize, trained_on: Option<f64>) -> f64 {
        let rows = rows as f64;
        let chance_gain = |rows: f64, steps: f64| 1.0 + rows / steps.max(1.0);
        let by_training = |steps: f64| chance_gain(rows, steps) / chance_gain(self.rows, CALIBRATED_STEPS);
        (rows / self.rows).max(trained_on.map_or(1.0, by_training)).max(1.0)
    }

    /// Returns the text of a calibration file, with the command that made it.
    pub fn to_text(&self, command: &str) -> String {
        shipped::to_text(self, command)
    }
}

impl Judgement {
    /// The thresholds with which diagnoses are calibrated.
    pub const USUAL: Judgement = Judgement {
        strong_nats: 3.0,
        rival_z: 2.0,
        most_rivals: 3,
        vague_factor: 2.0,
        most_effects: 4,
        scatter_ratio: 1.12,
        rollouts_nearer: 0.5,
    };

    /// Returns the relative likelihood of a rival that lags by `rival_z` standard errors.
    pub fn rival_likelihood(&self) -> f64 {
        libm::exp(-0.5 * self.rival_z * self.rival_z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shipped_file_equals_what_the_command_writes() {
        let command = shipped::command(SHIPPED);
        assert!(command.starts_with("mindgap challenge calibrate --cases "), "{command}");
        assert_eq!(Calibration::shipped().to_text(command), SHIPPED);
        assert_eq!(Calibration::shipped().judgement, Judgement::USUAL);
    }

    #[test]
    fn shipped_thresholds_are_plausible() {
        let Calibration {
            rows,
            effect_nats,
            remainder_nats,
            adequate,
            adequacy_width,
            temperature,
            accuracy_cap,
            further_share,
            ..
        } = Calibration::shipped();
        assert!(effect_nats > 0.0 && remainder_nats > 0.0);
        assert!([adequate, accuracy_cap, further_share].iter().all(|share| (0.0..=1.0).contains(share)));
        assert!(rows > 0.0 && adequacy_width > 0.0 && temperature > 0.0);
    }

    #[test]
    fn gates_grow_with_the_number_of_competitors() {
        let judgement = Judgement { strong_nats: 3.0, ..Judgement::USUAL };
        let lenient = Calibration { effect_nats: 2.0, remainder_nats: 9.0, judgement, ..Calibration::shipped() };
        let among = lenient.among(29, 5);
        assert!((among.effect_nats - (3.0 + libm::log(29.0))).abs() < 1e-12);
        assert_eq!(among.remainder_nats, 9.0, "a larger calibrated gate stays");
    }

    #[test]
    fn gates_grow_with_the_rows_and_never_shrink() {
        let shipped = Calibration { rows: 1000.0, ..Calibration::shipped() };
        assert_eq!(shipped.for_rows(10, None), shipped);
        let twice = shipped.for_rows(2000, None);
        assert_eq!(twice.effect_nats, 2.0 * shipped.effect_nats);
        assert_eq!(twice.remainder_nats, 2.0 * shipped.remainder_nats);
    }

    #[test]
    fn gates_are_higher_for_a_simulator_with_few_training_steps() {
        let shipped = Calibration { rows: 1200.0, ..Calibration::shipped() };
        for (rows, steps, growth) in
            [(1200, CALIBRATED_STEPS, 1.0), (1200, 1e6, 1.0), (300, 200.0, 2.0), (2400, 4800.0, 2.0)]
        {
            let found = shipped.for_rows(rows, Some(steps)).effect_nats / shipped.effect_nats;
            assert!((found - growth).abs() < 1e-12, "{rows} rows, {steps} steps: {found}");
        }
    }
}
