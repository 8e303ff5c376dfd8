//! Excitation: which effects these logs could show at all, and from which strength on. An effect that they hardly excite is
//! untestable, not absent.

use rayon::prelude::*;
use schemars::JsonSchema;
use serde::Serialize;

use super::calibration::Calibration;
use super::fit::{FitContext, Fitted};
use super::sample::Sample;
use super::scores::Scores;
use mindgap_foundations::channel::Channel;
use mindgap_learning::evaluation::observations::Observation;
use mindgap_logs::Robot;
use mindgap_models::effects::{Candidate, Variant};

/// The smallest strength of an effect that logs like these would show.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Detectable {
    /// Id of the effect.
    pub id: &'static str,
    /// Name of the parameter that measures its strength.
    pub parameter: &'static str,
    /// Smallest departure of that parameter from neutral at which nine of ten such logs would name the effect with a
    /// probability above one half; null if these logs do not excite it.
    pub smallest: Option<f64>,
    /// The range sensor concerned, where there are several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// What these logs promise for every effect that is not named.
pub struct Excitation {
    excited: Vec<Excited>,
    calibration: Calibration,
    robot: Robot,
}

/// The variant of an effect that these logs excite most.
struct Excited {
    candidate: Candidate,
    /// Parameters of a typical strength.
    typical: Vec<f64>,
    /// Expected evidence for that strength, nats.
    nats: f64,
    /// Share of the typical strength, as a factor on the departure from neutral, that promises the `needed` evidence.
    factor: f64,
}

/// One of ten such logs gains less than its expectation by this many standard deviations.
const ONE_IN_TEN_Z: f64 = 1.28;
/// What a parameter costs by its prior, in nats: a posterior twenty times as narrow as the prior.
const OCCAM_NATS: f64 = 3.0;
/// Strengths beyond this multiple of a typical one are not extrapolated to.
const MOST_TYPICAL: f64 = 10.0;

/// A second look that asks for more than this multiple of the first means that the effect does not grow with the square.
const MOST_CORRECTION: f64 = 2.0;
/// Halvings that find a strength to a thirtieth.
const BISECTIONS: usize = 5;

impl Excitation {
    /// Measures what the rows promise around a fit: at the effects that are there already, where residuals follow the noise.
    pub fn around(fit: &Fitted, context: &FitContext) -> Self {
        let needed = needed_nats(&context.calibration);
        let nats_at = |candidate: &Candidate, own: &[f64]| {
            let hypothesis = fit.hypothesis.with(*candidate);
            let values = [fit.values.as_slice(), own].concat();
            expected_nats(&(&hypothesis.scores_over(&fit.scores, context.rows, &values) - &fit.scores), context.rows)
        };
        let typical = |candidate: &Candidate| {
            let guesses = context.initial_guesses(candidate).into_iter();
            let starts = guesses.map(|own| (nats_at(candidate, &own), own));
            starts.max_by(|a: &(f64, _), b| a.0.total_cmp(&b.0)).map(|(nats, typical)| (*candidate, typical, nats))
        };
        let further = fit.further_candidates(context);
        let all: Vec<_> = further.par_iter().filter_map(typical).collect();
        let best = |id: &&'static str| all.iter().filter(|(c, ..)| c.effect == *id).max_by(|a, b| a.2.total_cmp(&b.2));
        let ids: Vec<&str> = context.catalogue.iter().map(|effect| effect.id).collect();
        let excited = ids.par_iter().filter_map(best).map(|(candidate, typical, nats)| {
            let nats_at = |share: f64| nats_at(candidate, &at_share(candidate.variant, typical, share));
            let factor = share_for(needed, *nats, nats_at);
            Excited { candidate: *candidate, typical: typical.clone(), nats: *nats, factor }
        });
        Excitation { excited: excited.collect(), calibration: context.calibration, robot: context.baseline().robot }
    }

    /// Returns the ids of the effects whose typical strengths promise no strong evidence, in the order of the catalogue.
    pub fn untestable(&self) -> Vec<&'static str> {
        let is_weak = |excited: &&Excited| excited.nats < self.calibration.judgement.strong_nats;
        self.excited.iter().filter(is_weak).map(|excited| excited.candidate.effect).collect()
    }

    /// Returns the smallest strength that these logs would show, in the order of the catalogue.
    pub fn detectable(&self) -> Vec<Detectable> {
        self.excited.iter().filter_map(|excited| excited.detectable(&self.robot)).collect()
    }
}

impl Excited {
    /// Returns `None` for an effect without a parameter of its strength.
    fn detectable(&self, robot: &Robot) -> Option<Detectable> {
        let Candidate { effect: id, variant } = self.candidate;
        let [neutral, typical] = [variant.nominal(), self.typical.clone()];
        let (place, parameter) = variant.parameters.iter().enumerate().find_map(|(place, parameter)| {
            let measures = typical[place] != neutral[place] && parameter.number(typical[place], robot).is_some();
            measures.then_some((place, parameter))
        })?;
        let strength = at_share(variant, &typical, self.factor)[place];
        let is_reached = self.factor <= MOST_TYPICAL && parameter.allows(strength);
        let departure = || Some(parameter.departure(parameter.number(strength, robot)?, robot));
        let smallest = if is_reached { departure() } else { None };
        Some(Detectable { id, parameter: parameter.setting().0, smallest, sensor: None })
    }
}

/// Returns the share of a typical strength that promises the `needed` evidence, if all of it promises these `nats`. Evidence grows
/// with the square of a small strength; a second look corrects where it does not, and bisection where an effect sets in only
/// beyond some strength.
fn share_for(needed: f64, nats: f64, nats_at: impl Fn(f64) -> f64) -> f64 {
    let guess = (needed / nats).sqrt().min(1.0);
    let corrected = guess * (needed / nats_at(guess)).sqrt();
    if corrected <= MOST_CORRECTION * guess {
        return corrected;
    }
    let (mut less, mut more) = (guess, 1.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (less + more);
        if nats_at(middle) < needed { less = middle } else { more = middle }
    }
    if nats < needed { corrected } else { more }
}

/// Returns parameters at a share of the way from neutral to these values.
fn at_share(variant: &Variant, values: &[f64], share: f64) -> Vec<f64> {
    variant.nominal().iter().zip(values).map(|(neutral, value)| neutral + share * (value - neutral)).collect()
}

/// Returns the expected evidence at which nine of ten logs pass the gate: an expectation of E nats scatters with a standard
/// deviation of √(2 E).
fn needed_nats(calibration: &Calibration) -> f64 {
    let gate = calibration.effect_nats + OCCAM_NATS;
    let half = 0.5 * ONE_IN_TEN_Z * std::f64::consts::SQRT_2;
    let root = half + (half * half + gate).sqrt();
    root * root
}

/// Returns the expected evidence of rows whose log-likelihoods change: to second order, half of the squared change by channel, over
/// the row's weight since that is contained in both factors.
pub fn expected_nats(changes: &Scores, rows: &Sample) -> f64 {
    let of_row = |(changes, row): (&[f64; Channel::COUNT], &Observation)| -> f64 {
        let weights = row.weights();
        let channels = changes.iter().zip(weights).filter(|(_, weight)| *weight > 0.0);
        channels.map(|(change, weight)| 0.5 * change * change / weight).sum()
    };
    changes.rows().iter().zip(&rows.rows).map(of_row).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise_model::log_density;
    use crate::test_support::*;
    use mindgap_learning::evaluation::observations::Observations;

    fn untestable_on(rows: Observations) -> Vec<&'static str> {
        let baseline = baseline_with_sonar();
        let rows = identification(&baseline, rows);
        let context = FitContext::new(&rows, METHOD);
        Excitation::around(&Fitted::null(&context), &context).untestable()
    }

    /// Residuals are two standard deviations, and the first guess of the effect is 0.1 cm.
    #[test]
    fn effect_is_testable_once_its_rows_promise_strong_evidence() {
        let change = log_density(0, 1.9, 2.0) - log_density(0, 2.0, 2.0);
        let enough = (3.0 / (0.5 * change * change)).ceil() as usize;
        let straight = |rows| {
            observations(1, rows, |_, at| Made {
                off: [2.0 * alternating(at), 0.0, 0.0],
                echo_off_cm: None,
                ..Made::default()
            })
        };
        // Without left turns and readings these are never testable.
        let never = ["longer_to_the_left", "farther"];
        assert_eq!(untestable_on(straight(2 * enough)), never);
        assert_eq!(untestable_on(straight(enough / 2)), ["longer", never[0], never[1]]);
    }

    /// Four rows with a weight of one quarter promise what one row does.
    #[test]
    fn repeated_rows_promise_evidence_by_their_weight() {
        let rows = |count: usize, weight: f64| {
            let mut rows =
                observations(1, count, |_, at| Made { off: [2.0 * alternating(at), 0.0, 0.0], ..Made::default() });
            rows.rows.iter_mut().for_each(|row| row.motion_weight = [weight; 3]);
            rows
        };
        let counts = [8, 64, 512, 4096].map(|count| untestable_on(rows(count, 1.0)).contains(&"longer"));
        assert_eq!([32, 256, 2048, 16384].map(|count| untestable_on(rows(count, 0.25)).contains(&"longer")), counts);
        assert_eq!((counts[0], counts[3]), (true, false));
    }

    /// Rows follow the noise. Four times as many rows show half the strength, and a strength without rows is null.
    #[test]
    fn smallest_detectable_strength_falls_with_the_root_of_the_rows() {
        let smallest = |rows: usize| {
            let baseline = baseline();
            let rows = identification(
                &baseline,
                observations(1, rows, |_, at| Made { off: [0.9 * alternating(at), 0.0, 0.0], ..Made::default() }),
            );
            let context = FitContext::new(&rows, METHOD);
            let detectable = Excitation::around(&Fitted::null(&context), &context).detectable();
            let [longer, to_the_left, ..] = &detectable[..] else { panic!("{detectable:?}") };
            assert_eq!((longer.id, longer.parameter, to_the_left.smallest), ("longer", "cm", None));
            longer.smallest.expect("every row shows it")
        };
        let [few, many] = [400, 1600].map(smallest);
        assert!((few / many - 2.0).abs() < 0.1, "{few} {many}");
        // Ten nats and more from four hundred steps of one centimetre's noise: a quarter of a centimetre.
        assert!((0.15..0.4).contains(&few), "{few}");
    }

    #[test]
    fn readings_make_effects_of_the_sensor_testable() {
        let rows = observations(1, 2000, |_, at| Made { echo_off_cm: Some(alternating(at)), ..Made::default() });
        assert!(!untestable_on(rows).contains(&"farther"));
    }
}
