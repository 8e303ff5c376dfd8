//! Proposal: the command script that is expected to say most about which of several names is the cause.

mod information;
mod names;
mod room;
mod scripts;

use super::confirm::Confirmed;
use super::fit::FitContext;
use information::{Information, Logged};
use mindgap_logs::{self as logs, Run};
use mindgap_models::effects::StepContext;
use mindgap_models::simulator::baseline::MotionModel;
use names::Name;
use room::Room;

/// A script to drive next.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The two most likely names, between which it discriminates; `no_gap` is the simulator as it is.
    pub between: [&'static str; 2],
    /// The relative likelihood of the second.
    pub rival_likelihood: f64,
    /// The script, described in words.
    pub script: String,
    /// Expected evidence per run between these two, nats.
    pub nats_per_run: f64,
    /// Expected information of the run about which of all names is the cause, nats.
    pub information_nats: f64,
    /// Number of runs that decide between the causes.
    pub runs: usize,
    /// Its commands and the expected poses.
    pub commands: Run,
}

/// Two causes are discriminated if they differ by this many standard errors.
const DECISIVE_Z: f64 = 3.0;
/// Maximum number of runs that are proposed: an afternoon's work.
const MOST_RUNS: usize = 50;
/// The name of the simulator as it is.
const NO_GAP: &str = "no_gap";

/// Returns the experiment that says most about which of the names is the cause that the logs leave, if they leave several and
/// any script says something. With a single name left there is nothing to decide.
pub fn next(found: &Confirmed, context: &FitContext) -> Option<Experiment> {
    let names = names::left(found, context);
    let [first, second, ..] = names.as_slice() else { return None };
    if !context.is_driving && second.likelihood < context.calibration.judgement.rival_likelihood() {
        return None;
    }
    let room = Room::new(context, first.fit.effects());
    let repeated = Logged::of(context);
    let value = |script: &scripts::Script| {
        let steps = room.steps(script)?;
        let information = information::expected(&names, &steps, &repeated, context);
        Some((information.nats, (information, steps)))
    };
    let (script, (information, steps)) = scripts::best(known_commands(context), value)?;
    let Information { nats, between_first } = information;
    (nats > 0.0 && between_first > 0.0).then(|| Experiment {
        between: [first, second].map(|name: &Name| name.id.unwrap_or(NO_GAP)),
        rival_likelihood: second.likelihood,
        script: script.name,
        nats_per_run: between_first,
        information_nats: nats,
        runs: runs_needed(between_first),
        commands: Run { name: "run-000".into(), rows: steps.iter().map(logged).collect() },
    })
}

impl Experiment {
    /// Returns whether it is worth proposing to people: between causes that these logs cannot distinguish, and in an afternoon.
    pub fn is_worthwhile(&self, context: &FitContext) -> bool {
        let is_confused = self.rival_likelihood >= context.calibration.judgement.rival_likelihood();
        is_confused && self.runs <= MOST_RUNS && !self.between.contains(&NO_GAP)
    }

    /// Describes the proposal in one sentence.
    pub fn sentence(&self) -> String {
        let Experiment { between: [one, other], script, runs, nats_per_run, .. } = self;
        format!(
            "To distinguish {one} from {other}: log {runs} run(s) of {script} (about {nats_per_run:.1} nats per run)."
        )
    }
}

/// Normal distributions z standard errors apart differ by ½z² nats, and the nats of runs add up.
fn runs_needed(nats_per_run: f64) -> usize {
    (0.5 * DECISIVE_Z * DECISIVE_Z / nats_per_run).ceil().max(1.0) as usize
}

/// Returns the least and largest command of which the simulator knows anything.
fn known_commands(context: &FitContext) -> [f64; 2] {
    match &context.baseline().motion {
        Some(MotionModel::Learned { commands, .. }) => *commands,
        _ => [-100.0, 100.0],
    }
}

/// Returns a step of the proposal as a row of a log.
fn logged(step: &StepContext) -> logs::Row {
    let [left, right] = step.commands[0];
    logs::Row { t_ms: 60_000.0 * step.elapsed_min, left, right, pose: Some(step.pose), ..logs::Row::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With half a nat per run, the means of nine runs lie three standard errors apart.
    #[test]
    fn enough_runs_are_proposed_for_three_standard_errors() {
        assert_eq!(runs_needed(0.5), 9);
        assert_eq!(runs_needed(100.0), 1);
    }
}
