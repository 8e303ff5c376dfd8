//! A further effect is a file, here [`turning_loss`](crate::turning_loss), and a line.

use mindgap_diagnosis::{Method, findings};
use mindgap_foundations::motion::Motion;
use mindgap_logs::Logs;
use mindgap_logs::inspection::Inspection;
use mindgap_models::effects::{CATALOGUE, Effect};
use mindgap_models::simulator::baseline::Baseline;

use crate::{SIMULATOR, logs, turning_loss};

/// What the altered logs lose of forward speed per rad/s.
pub const LOSS_PER_RAD_S: f64 = 0.12;

/// The built-in effects and one more: this is the line.
fn catalogue() -> &'static [&'static Effect] {
    [CATALOGUE, &[&turning_loss::EFFECT]].concat().leak()
}

/// Logs as they would be with the loss; without readings, which would be those of other places.
pub fn with_turning_loss(mut logs: Logs) -> Logs {
    let step_s = logs.robot.step_ms / 1000.0;
    for run in &mut logs.runs {
        // Where the tracker lost the robot, the steps to its next sight count as one.
        let mut last = None;
        run.rows.edit_poses(|pose| {
            let logged = *pose;
            let altered = last.map_or(logged, |(logged_before, altered_before)| {
                let mut increment = Motion::between(&logged_before, &logged);
                increment.forward *= 1.0 - LOSS_PER_RAD_S * (increment.turn / step_s).abs();
                increment.end(&altered_before)
            });
            last = Some((logged, altered));
            *pose = altered;
        });
        run.rows.edit_each(|row| row.echo_cm = None);
    }
    logs
}

#[test]
fn an_effect_that_is_added_is_found_with_its_strength_and_written() {
    let inspected = Inspection::new(with_turning_loss(logs(16, &[], 91)));
    let method = Method { catalogue: catalogue(), ..Method::default() };
    let found =
        findings(Baseline::at_posterior_mean(&SIMULATOR).expect("a reference"), &inspected, method).expect("poses");
    let written = serde_json::to_value(&found.diagnosis).expect("JSON");
    assert_eq!(written["verdict"], "known", "{written}");
    let [effect] = written["effects"].as_array().expect("effects").as_slice() else { panic!("{written}") };
    assert_eq!(effect["id"], "turning_loss", "{written}");
    let loss = effect["parameters"]["loss_per_rad_s"].as_f64().expect("a number");
    assert!((loss - LOSS_PER_RAD_S).abs() < 0.1 * LOSS_PER_RAD_S, "{written}");
    assert!(written["shrink"]["reducible_closed"].as_f64().expect("a gap that shrinks") > 0.8, "{written}");
    assert_eq!(found.applied[0].effect, "turning_loss");
}

/// What is there to be found decides, not what is in the catalogue.
#[test]
fn an_effect_that_is_added_is_not_found_where_it_is_not() {
    let inspected = Inspection::new(logs(16, &["track_width"], 92));
    let method = Method { catalogue: catalogue(), ..Method::default() };
    let found =
        findings(Baseline::at_posterior_mean(&SIMULATOR).expect("a reference"), &inspected, method).expect("poses");
    assert_eq!(found.diagnosis.effects.iter().map(|e| e.id).collect::<Vec<_>>(), ["track_width"]);
}
