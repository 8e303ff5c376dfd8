//! Why the success probability of a controller changed after its run.

use super::words::percent;
use mindgap_applications::closed_loop::state::Trial;
use mindgap_learning::evolve::success_probability::Endings;

/// Change that needs a reason, and difference that is one: beyond what 48 robots leave to chance.
const NOTABLE: f64 = 0.1;

/// An ending with its share of simulated runs.
type Ending = (&'static str, fn(&Endings) -> f64);

const FAILURES: [Ending; 3] = [
    ("touch a wall or an obstacle", |endings| endings.crashed),
    ("finish elsewhere", |endings| endings.missed),
    ("drive until the step limit", |endings| endings.timed_out),
];

/// Returns why the success probability of a trial's controller changed, in a few sentences; none before its run was learned from.
pub fn reason(trial: &Trial) -> Option<String> {
    let (before, after) = (trial.predicted.success, trial.chance_after?.success);
    let real = trial.real.as_ref()?;
    let [from, to] = [before, after].map(percent);
    if (after - before).abs() < NOTABLE {
        return Some(format!("The chance stays about the same ({from} before, {to} after)."));
    }
    let mut sentences =
        vec![format!("The chance {} from {from} to {to}.", if after < before { "falls" } else { "rises" })];
    sentences
        .extend(trial.predicted_endings.zip(trial.endings_after).and_then(|(before, after)| endings(&before, &after)));
    sentences.push(learned(trial, after));
    match (after < before, real.reached) {
        (true, true) => sentences.push(
            "The robot reached the target all the same: one run is one sample, and this chance counts simulated runs alone.".into(),
        ),
        (false, false) => sentences.push(
            "The robot missed the target all the same: this chance counts simulated runs alone, and the search weighs the real \
             run in addition.".into(),
        ),
        _ => (),
    }
    Some(sentences.join(" "))
}

/// The ending whose share changed most.
fn endings(before: &Endings, after: &Endings) -> Option<String> {
    let change = |(_, share): &Ending| (share(after) - share(before)).abs();
    let (name, share) = FAILURES.into_iter().max_by(|a, b| change(a).total_cmp(&change(b)))?;
    let [was, is] = [share(before), share(after)].map(percent);
    Some(format!("Of the simulated runs, {is} now {name} ({was} before)."))
}

/// What was learned that makes the difference.
fn learned(trial: &Trial, after: f64) -> String {
    match trial.chance_without_effects {
        None => "The reason is what the runs say about single commands: how far each moves and turns the robot.".into(),
        Some(without) if (after - without).abs() < NOTABLE => format!(
            "The reason is what the runs say about single commands. The effects found hardly matter: without them the chance \
             is {}.",
            percent(without)
        ),
        Some(without) => {
            format!(
                "The reason is the effects found: without them, learning from the same runs gives {}.",
                percent(without)
            )
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mindgap_applications::closed_loop::state::DrivenRun;
    use mindgap_learning::evolve::success_probability::SuccessProbability;
    use mindgap_logs::Termination;

    fn trial(before: f64, after: f64, without: Option<f64>, reached: bool) -> Trial {
        let chance = |success| SuccessProbability { success, ci95: [0.0, 1.0], epistemic_fraction: 0.0 };
        let endings = |reached| Endings { reached, crashed: 1.0 - reached, ..Endings::default() };
        let (ending, path_cm) = (Termination::Finished, Vec::new());
        Trial {
            real: Some(DrivenRun {
                ending,
                steps: 9,
                end_x_cm: 0.0,
                end_y_cm: 0.0,
                distance_cm: 3.0,
                reached,
                path_cm,
            }),
            chance_after: Some(chance(after)),
            endings_after: Some(endings(after)),
            chance_without_effects: without,
            ..Trial::planned(1, chance(before), Some(endings(before)), Vec::new())
        }
    }

    #[test]
    fn a_change_has_its_reason() {
        let said = |trial: &Trial| reason(trial).expect("a reason").replace('\u{a0}', " ");
        let fallen = said(&trial(0.97, 0.25, Some(0.95), true));
        for words in
            ["falls from 97 % to 25 %", "75 % now touch a wall", "is the effects found", "gives 95 %", "all the same"]
        {
            assert!(fallen.contains(words), "{words}: {fallen}");
        }
        let risen = said(&trial(0.2, 0.9, Some(0.88), true));
        assert!(risen.contains("rises from 20 % to 90 %") && risen.contains("single commands"), "{risen}");
        assert!(said(&trial(0.9, 0.92, None, true)).contains("about the same"));
        assert_eq!(reason(&Trial { chance_after: None, ..trial(0.9, 0.9, None, true) }), None);
    }
}
