//! Chooses the law by which a diagnosis judges a sensor: the one that better predicts readings of held-out runs.

use rayon::prelude::*;

use super::scans::{Scans, UNCHANGED};
use super::{beam, echo_law};
use mindgap_foundations::statistics::summary::standard_error_of_sum;
use mindgap_logs::Logs;
use mindgap_models::sonar::echo_law::Surfaces;
use mindgap_models::sonar::{FirstEchoLaw, SensorLaw, SonarModel};

/// Returns whether the first-echo law predicts the sensor's readings, at poses as logged, better than a beam: by more than
/// the variation between runs, and so that the gain carries over to other rooms. Both have some twenty parameters and are
/// refitted to the other runs, since the fit to their own runs says little: five scans hold as few places as a beam has
/// parameters for. `at_place` is the share of the residual variance of the beam's echo rate that belongs to the place.
pub fn prefers_first_echo(first_echo: &FirstEchoLaw, beam: &SonarModel, at_place: f64, logs: &Logs) -> bool {
    if logs.runs.len() < FEWEST_RUNS {
        return false;
    }
    let fold = |fold: usize| gains(first_echo, beam, logs, fold);
    let gains: Vec<f64> = (0..FOLDS.min(logs.runs.len())).into_par_iter().map(fold).collect::<Vec<_>>().concat();
    is_worth_a_law(&gains, Scans::new(logs).rows().count(), at_place)
}

/// Minimum number of runs to estimate the variation between them.
const FEWEST_RUNS: usize = 3;
/// Number of folds; each run is predicted once, from the runs of the other folds.
const FOLDS: usize = 5;
/// The simpler of two models is kept unless the other is better by more than this many standard errors (Breiman et al. 1984,
/// Classification and Regression Trees, section 3.4.3). Here the simpler one is the beam, which the vectorised simulator
/// draws.
const STANDARD_ERRORS: f64 = 1.0;
/// Models whose held-out scores differ by fewer nats per reading count as equal: the score of one model varies this much
/// between places and teams, and a diagnosis is made in another room. With many readings a smaller difference would be
/// significant, but the effects found are applied with the beam, so another model would change their meaning.
const ALIKE_NATS: f64 = 0.1;
/// If more than this share of the echo variance belongs to the place, any gain suffices: a beam has no priors and learns the
/// training room, whereas the law has priors from eleven sensors. The share is up to 0.03 for sensors whose echoes are drawn
/// independently, and 0.15 or more for the others (`challenge make --place-bound`).
const PLACE_BOUND: f64 = 0.1;

/// Returns whether held-out gains on runs with `readings` readings in all are significant and carry over to other rooms;
/// `at_place` is the share of the echo variance that belongs to the place.
fn is_worth_a_law(gains: &[f64], readings: usize, at_place: f64) -> bool {
    let gained: f64 = gains.iter().sum();
    let error = standard_error_of_sum(gains);
    log::info!(
        "on held-out runs the first-echo law gains {gained:.1} nats over the beam for {readings} readings, with a standard \
         error of {error:.1}; {at_place:.2} of the beam's residual variance belongs to the place"
    );
    gained > STANDARD_ERRORS * error && (at_place > PLACE_BOUND || gained > ALIKE_NATS * readings as f64)
}

/// Returns the gain of the first-echo law over the beam on each run of a fold, in nats.
fn gains(first_echo: &FirstEchoLaw, beam: &SonarModel, logs: &Logs, fold: usize) -> Vec<f64> {
    let part = |held_out: bool| {
        let runs = logs.runs.iter().enumerate().filter(|(run, _)| (run % FOLDS == fold) == held_out);
        Logs { runs: runs.map(|(_, run)| run.clone()).collect(), ..logs.clone() }
    };
    let (others, held_out) = (part(false), Scans::new(&part(true)));
    let first_echo = SensorLaw::FirstEcho(echo_law::learn_from(first_echo, &others));
    let beam = SensorLaw::Beam(beam::learn_from(beam, &others));
    let surfaces = Surfaces::new(logs.scene.sides());
    let gain = |run: usize| -> f64 {
        let gains = held_out.runs[run].iter().map(|row| {
            let sensor = held_out.sensor(&row.robot, &UNCHANGED);
            let nats = |law: &SensorLaw| law.outcomes_at(&surfaces, &sensor).log_likelihood(row.echo_cm);
            nats(&first_echo) - nats(&beam)
        });
        gains.sum()
    };
    (0..held_out.runs.len()).map(gain).collect()
}

#[cfg(test)]
mod tests {
    use super::is_worth_a_law;
    use crate::learn::echo_law::tests::{MIXED_UP_DEG, scans};
    use crate::learn::train::{TABLE_ONE, Trainer, train};
    use mindgap_built_in_robot::{default_robot, record, training_room};
    use mindgap_foundations::executor::Serial;
    use mindgap_logs::Logs;
    use mindgap_models::sonar::SensorLaw;

    fn law_of(logs: &Logs) -> SensorLaw {
        let simulator = train(&Serial, logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
        simulator.sensor_law().expect("enough readings")
    }

    /// The built-in robot's sensor follows neither law, so the simpler beam is kept.
    #[test]
    fn sensor_is_judged_by_the_law_that_it_follows() {
        assert!(matches!(law_of(&scans(1, MIXED_UP_DEG)), SensorLaw::FirstEcho(_)));
        // Two runs are too few to estimate the variation between runs.
        let mut few = scans(1, MIXED_UP_DEG);
        few.runs.truncate(2);
        assert!(matches!(law_of(&few), SensorLaw::Beam(_)));
        let driven = record(&default_robot(), &training_room(), 40, 60, &[], 3).expect("room to drive");
        assert!(matches!(law_of(&driven), SensorLaw::Beam(_)));
    }

    /// The runs have a hundred readings each, and their gains are alternately `scatter` above and below `gain`.
    #[test]
    fn law_must_gain_significantly_and_carry_over_to_other_rooms() {
        let is_worth = |gain: f64, scatter: f64, at_place: f64| {
            let gains: Vec<f64> =
                (0..50).map(|run| if run % 2 == 0 { gain + scatter } else { gain - scatter }).collect();
            is_worth_a_law(&gains, 5000, at_place)
        };
        assert!(is_worth(15.0, 20.0, 0.0));
        assert!(!is_worth(15.0, 200.0, 0.2), "not significant");
        assert!(!is_worth(5.0, 1.0, 0.02), "significant, but less than the variation between rooms");
        assert!(is_worth(5.0, 1.0, 0.2), "a beam would learn the training room");
    }
}
