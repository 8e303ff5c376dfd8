//! Proposal: what to log next, the script that tells confused causes apart best, by expected evidence.

mod scripts;

use glam::DVec2;
use rayon::prelude::*;

use super::compare::{Comparison, relative_likelihood};
use super::fit::{FitContext, Fitted};
use mindgap_foundations::geometry::{Pose, Rectangle, bounding_box};
use mindgap_learning::evaluation::predictions;
use mindgap_logs::{self as logs, Run};
use mindgap_models::effects::StepContext;
use mindgap_models::effects::chain::EffectChain;
use mindgap_models::effects::context::RunHistory;
use scripts::Script;

/// A script worth driving.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// The causes that it tells apart.
    pub between: [&'static str; 2],
    /// The script in words.
    pub script: &'static str,
    /// Expected evidence of a run, nats.
    pub nats_a_run: f64,
    /// Number of runs that make it plain.
    pub runs: usize,
    /// Its commands, with the poses that are expected.
    pub commands: Run,
}

/// Two causes are told apart when they differ by this many standard errors.
const PLAIN_Z: f64 = 3.0;
/// More runs than this are no proposal: an afternoon's work.
const MOST_RUNS: f64 = 50.0;
/// Readings are tried on a grid of this many cm, about what a reading scatters.
const GRID_CM: f64 = 4.0;
/// The robot keeps clear of everything by this, cm: the predicted path of a script is that far off at its end.
const CLEAR_CM: f64 = 3.0;
/// Places along each axis of the scene, and headings, from which a script may begin.
const PLACES: usize = 7;
const HEADINGS: usize = 4;

/// The best experiment between the chosen effects and the one that is confused with them most, if any is.
pub fn next(found: &Comparison, context: &FitContext) -> Option<Experiment> {
    let (rival, between) = closest_rival(found, context)?;
    let bench = Bench { context, chosen: found.chosen.effects(), rival: rival.effects() };
    let scatter = found.chosen.hypothesis.scatter(context.baseline, context.observations, &found.chosen.values);
    let scripts = scripts::all();
    let tried: Vec<(f64, &Script, Vec<StepContext>)> = scripts
        .par_iter()
        .filter_map(|script| {
            let steps = bench.steps(script)?;
            Some((bench.expected_nats(&steps, scatter), script, steps))
        })
        .collect();
    let (nats_a_run, script, steps) = tried.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let runs = runs_needed(nats_a_run);
    (runs <= MOST_RUNS).then(|| Experiment {
        between,
        script: script.name,
        nats_a_run,
        runs: runs as usize,
        commands: Run { name: "run-000".into(), rows: steps.iter().map(logged).collect() },
    })
}

impl Experiment {
    /// The proposal in one sentence.
    pub fn sentence(&self) -> String {
        let Experiment { between: [one, other], script, runs, nats_a_run, .. } = self;
        format!("To tell {one} from {other}: log {runs} run(s) of {script} (about {nats_a_run:.1} nats a run).")
    }
}

/// Two normal laws that lie z standard errors apart differ by ½z² nats, and the nats of runs add up.
fn runs_needed(nats_a_run: f64) -> f64 {
    (0.5 * PLAIN_Z * PLAIN_Z / nats_a_run).ceil().max(1.0)
}

/// The fit with the effect that is confused most with one of the chosen, and the two effects; none when the answer is
/// plain.
fn closest_rival<'f>(found: &'f Comparison, context: &FitContext) -> Option<(&'f Fitted, [&'static str; 2])> {
    let (ids, calibration) = (found.chosen.ids(), &context.calibration);
    let confused = |place: usize| {
        let rival = *found.rivals_of(place).first()?;
        let other = rival.ids().into_iter().find(|id| !ids.contains(id))?;
        let likelihood = relative_likelihood(&found.chosen, rival, calibration);
        (likelihood >= calibration.judgement.rival_likelihood()).then_some((likelihood, rival, [ids[place], other]))
    };
    let closest = (0..ids.len()).filter_map(confused).max_by(|a, b| a.0.total_cmp(&b.0));
    closest.map(|(_, rival, between)| (rival, between))
}

/// Where scripts are tried.
struct Bench<'a> {
    context: &'a FitContext<'a>,
    chosen: EffectChain,
    rival: EffectChain,
}

impl Bench<'_> {
    /// The steps that a script is expected to make, from the first place where it leads the robot nowhere against a wall.
    fn steps(&self, script: &Script) -> Option<Vec<StepContext>> {
        self.starts().into_iter().find_map(|start| self.drive(script, start))
    }

    /// Where the robot stands free, the freest place first.
    fn starts(&self) -> Vec<Pose> {
        let Some(Rectangle { low_cm: low, high_cm: high }) =
            bounding_box(self.context.observations.surroundings.surfaces.walls())
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
        let walls = self.context.observations.surroundings.surfaces.walls();
        walls.iter().map(|wall| wall.nearest(at_cm).distance(at_cm)).fold(f64::INFINITY, f64::min)
    }

    /// The steps of a script from a pose; none when the robot would touch something.
    fn drive(&self, script: &Script, start: Pose) -> Option<Vec<StepContext>> {
        let surroundings = &self.context.observations.surroundings;
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
            if let Some(drive) = &self.context.baseline.motion {
                pose = predictions::step(&self.chosen, drive, &step).from(&pose);
            }
            steps.push(step);
        }
        Some(steps)
    }

    /// By how many nats the chosen effects are expected to be likelier than the rival where they are there.
    fn expected_nats(&self, steps: &[StepContext], scatter: [f64; 3]) -> f64 {
        steps.iter().map(|step| self.of_motion(step, scatter) + self.of_reading(step)).sum()
    }

    fn of_motion(&self, step: &StepContext, scatter: [f64; 3]) -> f64 {
        let Some(drive) = &self.context.baseline.motion else { return 0.0 };
        let [a, b] = [&self.chosen, &self.rival].map(|effects| {
            let increment = predictions::step(effects, drive, step);
            [increment.forward_cm, increment.lateral_cm, increment.turn_rad]
        });
        (0..3).map(|c| 0.5 * ((a[c] - b[c]) / scatter[c]) * ((a[c] - b[c]) / scatter[c])).sum()
    }

    /// The divergence between the readings that either expects.
    fn of_reading(&self, step: &StepContext) -> f64 {
        let Some(sonar) = &self.context.baseline.sonar else { return 0.0 };
        let likelihood = |effects: &EffectChain| {
            let outcomes = effects.sensor(step).outcomes(sonar, &self.context.observations.surroundings);
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

/// A step of the proposal as a row of a log.
fn logged(step: &StepContext) -> logs::Row {
    let [left, right] = step.commands[0];
    logs::Row { t_ms: 60_000.0 * step.elapsed_min, left, right, pose: Some(step.pose), ..logs::Row::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where each run shows half a standard error's square in nats, the means of nine runs lie three standard errors apart.
    #[test]
    fn as_many_runs_as_three_standard_errors_take() {
        assert_eq!(runs_needed(0.5), 9.0);
        assert_eq!(runs_needed(100.0), 1.0);
    }
}
