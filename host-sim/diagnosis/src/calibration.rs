//! The thresholds of a diagnosis: those that `mindgap challenge calibrate` settled on cases with known answers, and those
//! that follow from a convention or a judgement, whose sensitivity `mindgap challenge sensitivity` measures.

use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

/// Everything that decides between one answer and another.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Calibration {
    /// Number of rows that the gates are set for.
    pub rows: f64,
    /// Share of what could be explained that effects have to explain to be the cause.
    pub adequate: f64,
    /// Width of the logistic curve by which that share decides.
    pub adequacy_width: f64,
    /// Relative likelihoods of rivals are raised to one over this: above one, doubt weighs more than its nats say.
    pub temperature: f64,
    /// How often the plainest answer is right: no answer is surer.
    pub accuracy_cap: f64,
    /// When an effect counts: least gain on held-out runs, nats, with less of the blocks that gain most.
    pub effect_nats: f64,
    /// The same for what the omnibus residual model explains in a channel, and for a wider scatter.
    pub remainder_nats: f64,
    /// This share of what effects explain in a channel is within reach of forms that are not quite right: a further effect
    /// has to gain as much more there.
    pub further_share: f64,
    /// What calibration does not touch.
    pub judgement: Judgement,
}

/// Thresholds by convention or judgement; `mindgap challenge sensitivity` prints how much they decide.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Judgement {
    /// Strong evidence, nats: odds of 20 to 1 (Kass and Raftery 1995). Held-out runs have to confirm with it, smaller leads
    /// over a rival or gaps of a channel are not told, and an effect that promises less is untestable.
    pub strong_nats: f64,
    /// Another effect can stand for one that it lags by no more than this many standard errors, and is named beside it.
    pub rival_z: f64,
    /// An effect for which more others can stand has to gain `vague_factor` times as much, alone or beside others: the
    /// misfit of a simulator is a bit like many effects.
    pub most_rivals: usize,
    /// See `most_rivals`.
    pub vague_factor: f64,
    /// Most effects that are named together: real robots differ in several ways at once.
    pub most_effects: usize,
    /// Scatter counts from this multiple of the simulator's on: five standard errors of a standard deviation that is
    /// estimated from a thousand rows.
    pub scatter_ratio: f64,
    /// Effects bring rollouts nearer by at least this share of what they foretell, or are no whole cause: an answer that is
    /// nearer to nothing than to what it foretells.
    pub rollouts_nearer: f64,
}

/// Steps that a simulator of the calibration learned its motion from: eighty runs of sixty. A test of `challenge` holds it
/// against those that it trains.
pub const CALIBRATED_STEPS: f64 = 4800.0;

/// The file that `mindgap challenge calibrate` wrote.
pub const SHIPPED: &str = include_str!("calibration.toml");

/// A file of this program that it cannot read is a fault of the program; a test reads it.
static CALIBRATION: LazyLock<Calibration> =
    LazyLock::new(|| toml::from_str(SHIPPED).expect("calibration.toml is as the command writes it"));

impl Calibration {
    /// The calibration that diagnoses use.
    pub fn shipped() -> Self {
        *CALIBRATION
    }

    /// The same with the usual thresholds in place of those by which what was found is judged: with equal ones the same is
    /// found.
    pub fn for_search(&self) -> Self {
        let Calibration { adequate, adequacy_width, temperature, accuracy_cap, .. } = Self::shipped();
        Calibration { adequate, adequacy_width, temperature, accuracy_cap, ..*self }
    }

    /// The same for this many rows, and a simulator that learned its motion from so many steps if it did.
    pub fn for_rows(self, rows: usize, trained_on: Option<f64>) -> Self {
        let growth = self.growth(rows, trained_on);
        let (effect_nats, remainder_nats) = (growth * self.effect_nats, growth * self.remainder_nats);
        Calibration { effect_nats, remainder_nats, ..self }
    }

    /// The same where so many effects and channels compete: of a hundred hypotheses one looks a hundred times as good by
    /// chance, so that beside what chance was seen to feign strong evidence is asked for of whichever it is.
    pub fn among(self, effects: usize, channels: usize) -> Self {
        let least = |competitors: usize| self.judgement.strong_nats + libm::log(competitors.max(1) as f64);
        let effect_nats = self.effect_nats.max(least(effects));
        let remainder_nats = self.remainder_nats.max(least(channels));
        Calibration { effect_nats, remainder_nats, ..self }
    }

    /// How much more is asked for with this many rows, and of a simulator that learned from so many steps; never less, since what
    /// chance feigns does not shrink. What the simulator's own misfit feigns grows with the rows. And a form that differs from a
    /// number estimated from m steps gains by n rows, where nothing has changed, half a nat times 1 + n / m: the variance of the
    /// difference of two means, in units of that of the second.
    pub fn growth(&self, rows: usize, trained_on: Option<f64>) -> f64 {
        let rows = rows as f64;
        let feigned = |rows: f64, steps: f64| 1.0 + rows / steps.max(1.0);
        let left_open = |steps: f64| feigned(rows, steps) / feigned(self.rows, CALIBRATED_STEPS);
        (rows / self.rows).max(trained_on.map_or(1.0, left_open)).max(1.0)
    }

    /// The text of a calibration file, with the command that made it.
    pub fn to_text(&self, command: &str) -> String {
        let figures = toml::to_string(self).expect("numbers can be written");
        format!("# Made by: {command}\n{figures}")
    }
}

impl Judgement {
    /// What diagnoses are calibrated with.
    pub const USUAL: Judgement = Judgement {
        strong_nats: 3.0,
        rival_z: 2.0,
        most_rivals: 3,
        vague_factor: 2.0,
        most_effects: 4,
        scatter_ratio: 1.12,
        rollouts_nearer: 0.5,
    };

    /// Relative likelihood of a rival that lags by `rival_z` standard errors.
    pub fn rival_likelihood(&self) -> f64 {
        libm::exp(-0.5 * self.rival_z * self.rival_z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_file_is_as_the_command_writes_it() {
        let command = SHIPPED.lines().next().and_then(|line| line.strip_prefix("# Made by: ")).expect("a first line");
        assert!(command.starts_with("mindgap challenge calibrate --cases "), "{command}");
        assert_eq!(Calibration::shipped().to_text(command), SHIPPED);
        assert_eq!(Calibration::shipped().judgement, Judgement::USUAL);
    }

    #[test]
    fn thresholds_are_possible() {
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
    fn the_more_compete_the_more_is_asked_for() {
        let judgement = Judgement { strong_nats: 3.0, ..Judgement::USUAL };
        let lenient = Calibration { effect_nats: 2.0, remainder_nats: 9.0, judgement, ..Calibration::shipped() };
        let among = lenient.among(29, 5);
        assert!((among.effect_nats - (3.0 + libm::log(29.0))).abs() < 1e-12);
        assert_eq!(among.remainder_nats, 9.0, "what was measured stays where it is more");
    }

    #[test]
    fn twice_the_rows_ask_for_twice_the_nats_and_few_for_no_fewer() {
        let shipped = Calibration { rows: 1000.0, ..Calibration::shipped() };
        assert_eq!(shipped.for_rows(10, None), shipped);
        let twice = shipped.for_rows(2000, None);
        assert_eq!(twice.effect_nats, 2.0 * shipped.effect_nats);
        assert_eq!(twice.remainder_nats, 2.0 * shipped.remainder_nats);
    }

    #[test]
    fn a_simulator_that_learned_from_few_steps_asks_for_more() {
        let shipped = Calibration { rows: 1200.0, ..Calibration::shipped() };
        for (rows, steps, growth) in
            [(1200, CALIBRATED_STEPS, 1.0), (1200, 1e6, 1.0), (300, 200.0, 2.0), (2400, 4800.0, 2.0)]
        {
            let found = shipped.for_rows(rows, Some(steps)).effect_nats / shipped.effect_nats;
            assert!((found - growth).abs() < 1e-12, "{rows} rows, {steps} steps: {found}");
        }
    }
}
