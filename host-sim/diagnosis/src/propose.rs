//! Proposal: the command script that best discriminates between confused causes, by expected evidence.

mod scripts;

use glam::DVec2;
use rayon::prelude::*;

use super::confirm::Confirmed;
use super::fit::{FitContext, Fitted};
use super::slot::relative_likelihood;
use mindgap_foundations::geometry::{Pose, Rectangle, bounding_box};
use mindgap_learning::evaluation::predictions;
use mindgap_logs::{self as logs, Run};
use mindgap_models::effects::StepContext;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::context::RunHistory;
use scripts::Script;

/// A script to drive next.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The causes between which it discriminates.
    pub between: [&'static str; 2],
    /// The script, described in words.
    pub script: &'static str,
    /// Expected evidence per run, nats.
    pub nats_per_run: f64,
    /// Number of runs that decide between the causes.
    pub runs: usize,
    /// Its commands and the expected poses.
    pub commands: Run,
}

/// Two causes are discriminated if they differ by this many standard errors.
const DECISIVE_Z: f64 = 3.0;
/// Maximum number of runs that are proposed: an afternoon's work.
const MOST_RUNS: f64 = 50.0;
/// Grid over readings, about their standard deviation.
const GRID_CM: f64 = 4.0;
/// Clearance between the robot and everything else: the error of the predicted path at the end of a script.
const CLEAR_CM: f64 = 3.0;
/// Number of places along each axis of the scene, and of headings, at which a script may begin.
const PLACES: usize = 7;
const HEADINGS: usize = 4;

/// Returns the best experiment between the chosen effects and the one most confused with them, if there is one.
pub fn next(found: &Confirmed, context: &FitContext) -> Option<Experiment> {
    let (rival, between) = closest_rival(found, context)?;
    let bench = Bench { context, chosen: found.chosen.effects(), rival: rival.effects() };
    let scripts = scripts::all();
    let candidates: Vec<(f64, &Script, Vec<StepContext>)> = scripts
        .par_iter()
        .filter_map(|script| {
            let steps = bench.steps(script)?;
            Some((bench.expected_nats(&steps, found.chosen.noise), script, steps))
        })
        .collect();
    let (nats_per_run, script, steps) = candidates.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let runs = runs_needed(nats_per_run);
    (runs <= MOST_RUNS).then(|| Experiment {
        between,
        script: script.name,
        nats_per_run,
        runs: runs as usize,
        commands: Run { name: "run-000".into(), rows: steps.iter().map(logged).collect() },
    })
}

impl Experiment {
    /// Describes the proposal in one sentence.
    pub fn sentence(&self) -> String {
        let Experiment { between: [one, other], script, runs, nats_per_run, .. } = self;
        format!(
            "To distinguish {one} from {other}: log {runs} run(s) of {script} (about {nats_per_run:.1} nats per run)."
        )
    }
}

/// Normal distributions z standard errors apart differ by ½z² nats, and the nats of runs add up.
fn runs_needed(nats_per_run: f64) -> f64 {
    (0.5 * DECISIVE_Z * DECISIVE_Z / nats_per_run).ceil().max(1.0)
}

/// Returns the fit with the effect that is most confused with one of the chosen, and the ids of the two; `None` if nothing is
/// confused.
fn closest_rival<'f>(found: &'f Confirmed, context: &FitContext) -> Option<(&'f Fitted, [&'static str; 2])> {
    let (ids, calibration) = (found.chosen.ids(), &context.calibration);
    let confused = |effect: usize| {
        let rival = *found.rivals_of(effect).first()?;
        let other = rival.ids().into_iter().find(|id| !ids.contains(id))?;
        let likelihood = relative_likelihood(&found.chosen, rival, calibration);
        (likelihood >= calibration.judgement.rival_likelihood()).then_some((likelihood, rival, [ids[effect], other]))
    };
    let closest = (0..ids.len()).filter_map(confused).max_by(|a, b| a.0.total_cmp(&b.0));
    closest.map(|(_, rival, between)| (rival, between))
}

/// Simulates scripts under two hypotheses.
struct Bench<'a> {
    context: &'a FitContext<'a>,
    chosen: EffectChain,
    rival: EffectChain,
}

impl Bench<'_> {
    /// Returns the expected steps of a script from the first start where the robot touches nothing.
    fn steps(&self, script: &Script) -> Option<Vec<StepContext>> {
        self.starts().into_iter().find_map(|start| self.drive(script, start))
    }

    /// Returns possible starts, those with the largest clearance first.
    fn starts(&self) -> Vec<Pose> {
        let Some(Rectangle { low_cm: low, high_cm: high }) =
            bounding_box(self.context.rows.surroundings.surfaces.walls())
        else {
            return Vec::new();
        };
        let share = |i: usize| (i as f64 + 0.5) / PLACES as f64;
        let places =
            (0..PLACES * PLACES).map(|i| low + (high - low) * DVec2::new(share(i % PLACES), share(i / PLACES)));
        let mut places: Vec<(f64, DVec2)> = places.map(|at| (self.clearance_cm(at), at)).collect();
        places.sort_by(|a, b| b.0.total_cmp(&a.0));
        let heading = |i: usize| std::f64::consts::TAU * i as f64 / HEADINGS as f64;
        places.iter().flat_map(|(_, at)| (0..HEADINGS).map(move |h| Pose::new(at.x, at.y, heading(h)))).collect()
    }

    fn clearance_cm(&self, at_cm: DVec2) -> f64 {
        let walls = self.context.rows.surroundings.surfaces.walls();
        walls.iter().map(|wall| wall.nearest(at_cm).distance(at_cm)).fold(f64::INFINITY, f64::min)
    }

    /// Returns the steps of a script from a pose, or `None` if the robot would touch something.
    fn drive(&self, script: &Script, start: Pose) -> Option<Vec<StepContext>> {
        let surroundings = &self.context.rows.surroundings;
        let least_cm = surroundings.robot.body_radius_cm + CLEAR_CM;
        let mut steps = Vec::with_capacity(script.commands.len());
        let (mut history, mut pose) = (RunHistory::default(), start);
        for (at, command) in script.commands.iter().enumerate() {
            if self.clearance_cm(pose.position_cm) < least_cm {
                return None;
            }
            history.command(*command);
            let step = surroundings.context(&history, at as f64 * surroundings.robot.step_ms, pose);
            let expected_cm = step.faced.map(|[distance_cm, _]| distance_cm);
            history.leave(Some(&step), expected_cm);
            if let Some(drive) = &self.context.baseline().motion {
                pose = predictions::step(&self.chosen, drive, &step).end(&pose);
            }
            steps.push(step);
        }
        Some(steps)
    }

    /// Returns the expected log-likelihood ratio of the chosen effects and the rival if the chosen effects are true.
    fn expected_nats(&self, steps: &[StepContext], noise: [f64; 3]) -> f64 {
        steps.iter().map(|step| self.motion_nats(step, noise) + self.reading_nats(step)).sum()
    }

    fn motion_nats(&self, step: &StepContext, noise: [f64; 3]) -> f64 {
        let Some(drive) = &self.context.baseline().motion else { return 0.0 };
        let [a, b] = [&self.chosen, &self.rival].map(|effects| predictions::step(effects, drive, step).into_array());
        (0..3).map(|c| 0.5 * ((a[c] - b[c]) / noise[c]) * ((a[c] - b[c]) / noise[c])).sum()
    }

    /// Returns the Kullback-Leibler divergence of the expected readings.
    fn reading_nats(&self, step: &StepContext) -> f64 {
        let Some(sonar) = &self.context.baseline().sonar else { return 0.0 };
        let likelihood = |effects: &EffectChain| {
            let outcomes = effects.sensor(step).outcomes(sonar, &self.context.rows.surroundings);
            move |echo_cm: Option<f64>| outcomes.log_likelihood(echo_cm)
        };
        let (a, b) = (likelihood(&self.chosen), likelihood(&self.rival));
        let divergence = |echo_cm: Option<f64>, width: f64| {
            let log = a(echo_cm);
            width * libm::exp(log) * (log - b(echo_cm))
        };
        let [low, high] = sonar.range_cm();
        let cells = ((high - low) / GRID_CM) as usize;
        let readings = (0..cells).map(|i| low + (i as f64 + 0.5) * GRID_CM);
        divergence(None, 1.0) + readings.map(|z| divergence(Some(z), GRID_CM)).sum::<f64>()
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
        assert_eq!(runs_needed(0.5), 9.0);
        assert_eq!(runs_needed(100.0), 1.0);
    }
}
