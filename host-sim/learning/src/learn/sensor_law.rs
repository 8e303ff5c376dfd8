//! Chooses the law by which a diagnosis judges a sensor: the one that foretells readings of runs that it was not fitted to.

use rayon::prelude::*;

use super::scans::{Scans, UNCHANGED};
use super::{beam, echo_law};
use mindgap_foundations::statistics::summary::error_of_sum;
use mindgap_logs::Logs;
use mindgap_models::sonar::echo_law::Surfaces;
use mindgap_models::sonar::{FirstEchoLaw, SensorLaw, SonarModel};

/// Whether the first-echo law foretells the sensor's readings, at poses as logged, better than a beam does: by more than runs
/// differ in that, and so that it will in another room. Both have some twenty parameters and are fitted to other runs
/// again, since what either makes of its own runs says little: five scans hold as few places as a beam has parameters for.
/// `at_place` is the share of the chance of an echo that the beam leaves to the place.
pub fn is_first_echo(first_echo: &FirstEchoLaw, beam: &SonarModel, at_place: f64, logs: &Logs) -> bool {
    if logs.runs.len() < FEWEST_RUNS {
        return false;
    }
    let fold = |fold: usize| gains(first_echo, beam, logs, fold);
    let gains: Vec<f64> = (0..FOLDS.min(logs.runs.len())).into_par_iter().map(fold).collect::<Vec<_>>().concat();
    is_worth_a_law(&gains, Scans::of(logs).rows().count(), at_place)
}

/// Fewer runs say nothing of how runs differ.
const FEWEST_RUNS: usize = 3;
/// Every run is foretold once, from the runs of the other folds.
const FOLDS: usize = 5;
/// The simpler of two models is kept unless the other is better by more than this (Breiman and others 1984, Classification and
/// Regression Trees, section 3.4.3): here the beam, which lanes of robots can draw.
const STANDARD_ERRORS: f64 = 1.0;
/// Models whose held-out scores differ by fewer nats a reading are alike: by so much a model's score differs from place to place
/// and from team to team, and a diagnosis is made in another room. Many readings make a smaller difference certain, and the
/// effects that are found are applied with the beam, so that another model costs them some of their meaning.
const ALIKE_NATS: f64 = 0.1;
/// Where the place decides more than this share of the chance of an echo, rooms are what matters: a beam, which nothing but
/// readings is known of, learns the training room, and the law has priors from eleven sensors. So any gain will do. Of sensors
/// that draw anew the beam leaves up to 0.03 to the place, of those that do not 0.15 and more (`challenge make --place-bound`).
const PLACE_BOUND: f64 = 0.1;

/// Whether gains on runs of so many readings in all, of whose chance the place decides a share, are more than chance and hold
/// in other rooms.
fn is_worth_a_law(gains: &[f64], readings: usize, at_place: f64) -> bool {
    let gained: f64 = gains.iter().sum();
    let error = error_of_sum(gains);
    log::info!(
        "on runs that neither saw the first-echo law gains {gained:.1} nats on the beam for {readings} readings, with a standard \
         error of {error:.1}; the place decides {at_place:.2} of what the beam leaves to chance"
    );
    gained > STANDARD_ERRORS * error && (at_place > PLACE_BOUND || gained > ALIKE_NATS * readings as f64)
}

/// By how many nats the first-echo law foretells each run of a fold better than the beam.
fn gains(first_echo: &FirstEchoLaw, beam: &SonarModel, logs: &Logs, fold: usize) -> Vec<f64> {
    let part = |held_out: bool| {
        let runs = logs.runs.iter().enumerate().filter(|(run, _)| (run % FOLDS == fold) == held_out);
        Logs { runs: runs.map(|(_, run)| run.clone()).collect(), ..logs.clone() }
    };
    let (others, held_out) = (part(false), Scans::of(&part(true)));
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
    use mindgap_logs::Logs;
    use mindgap_models::sonar::SensorLaw;

    fn law_of(logs: &Logs) -> SensorLaw {
        let simulator = train(logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks");
        simulator.sensor_law().expect("enough readings")
    }

    /// The built-in robot's sensor follows neither, so that the beam, which lanes of robots can draw, is as good.
    #[test]
    fn a_sensor_is_judged_by_the_law_that_it_follows() {
        assert!(matches!(law_of(&scans(1, MIXED_UP_DEG)), SensorLaw::FirstEcho(_)));
        // Two runs do not say how runs differ.
        let mut few = scans(1, MIXED_UP_DEG);
        few.runs.truncate(2);
        assert!(matches!(law_of(&few), SensorLaw::Beam(_)));
        let driven = record(&default_robot(), &training_room(), 40, 60, &[], 3).expect("room to drive");
        assert!(matches!(law_of(&driven), SensorLaw::Beam(_)));
    }

    /// Runs of a hundred readings that gain so much each, and as much more or less in turn.
    #[test]
    fn a_law_has_to_gain_more_than_chance_and_to_hold_in_other_rooms() {
        let is_worth = |gain: f64, scatter: f64, at_place: f64| {
            let gains: Vec<f64> =
                (0..50).map(|run| if run % 2 == 0 { gain + scatter } else { gain - scatter }).collect();
            is_worth_a_law(&gains, 5000, at_place)
        };
        assert!(is_worth(15.0, 20.0, 0.0));
        assert!(!is_worth(15.0, 200.0, 0.2), "chance");
        assert!(!is_worth(5.0, 1.0, 0.02), "certain, but less than rooms differ");
        assert!(is_worth(5.0, 1.0, 0.2), "of a sensor whose beam would be that of one room");
    }
}
