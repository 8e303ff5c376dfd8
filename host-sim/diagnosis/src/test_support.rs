//! Made-up robots, rows, effects and fits, simple enough that the right answer of each stage is known in closed form.

use std::collections::BTreeMap;

use glam::DVec2;

use super::calibration::{Calibration, Judgement};
use super::confirm::Confirmed;
use super::fit::{FitContext, Fitted};
use super::further_shares::FurtherShares;
use super::hypothesis::Hypothesis;
use super::method::Method;
use super::sample::Identification;
use super::scores::{Blocks, Scores};
use mindgap_foundations::channel::Channel;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::motion::Motion;
use mindgap_learning::evaluation::observations::{Observation, Observations, number_places, side_ray_ranges_cm};
use mindgap_logs::{Logs, Robot, Row, Run, Scene, Ultrasonic};
use mindgap_models::effects::context::{CommandHistory, HISTORY, Surroundings};
use mindgap_models::effects::drive_filter::StepSpeeds;
use mindgap_models::effects::parameter::Guesses;
use mindgap_models::effects::{Candidate, Effect, Hook, Parameter, StepContext, Variant};
use mindgap_models::simulator::baseline::{Baseline, MotionModel};
use mindgap_models::simulator::ensemble::CommandScale;
use mindgap_models::simulator::nominal::motion_bias::{Precision, features, products};
use mindgap_models::sonar::{SensorLaw, SonarModel};

/// Noise of the drive, as standard deviations of forward (cm), lateral (cm) and turn (rad).
pub const NOISE: [f64; 3] = [1.0, 1.0, 0.1];

/// A made-up row.
#[derive(Clone, Copy)]
pub struct Made {
    /// Commands of the step and of the one before.
    pub commands: [[f64; 2]; 2],
    /// Pose at the beginning of the step.
    pub pose: Pose,
    /// Time since the run began, minutes.
    pub elapsed_min: f64,
    /// Logged minus expected: forward (cm), lateral (cm), turn (rad).
    pub off: [f64; 3],
    /// Reading minus distance, cm.
    pub echo_off_cm: Option<f64>,
}

impl Default for Made {
    /// A straight step from the middle of the room, as expected, without a reading.
    fn default() -> Self {
        let pose = Pose::new(150.0, 100.0, 0.0);
        Made { commands: [[50.0; 2]; 2], pose, elapsed_min: 0.0, off: [0.0; 3], echo_off_cm: None }
    }
}

/// A robot that drives one centimetre per step for every ten units of command.
pub fn robot() -> Robot {
    Robot {
        wheel_diameter_cm: 5.6,
        track_cm: 10.0,
        body_radius_cm: 8.0,
        step_ms: 250.0,
        full_speed_cm_s: 40.0,
        ultrasonic: Some(Ultrasonic { x_cm: 0.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 3.0, max_cm: 250.0 }),
    }
}

/// An empty room of 300 by 200 cm.
pub fn room() -> Scene {
    Scene { arena_cm: Some(DVec2::new(300.0, 200.0)), ..Scene::default() }
}

/// The textbook's drive without a sensor.
pub fn baseline() -> Baseline<'static> {
    Baseline {
        robot: robot(),
        motion: Some(MotionModel::Kinematic { robot: robot(), scatter: NOISE.into() }),
        sonar: None,
        place_bound: [0.0; 2],
        familiar: None,
        applied: Vec::new(),
    }
}

/// The same with a ray that always returns, with noise of one centimetre.
pub fn baseline_with_sonar() -> Baseline<'static> {
    Baseline { sonar: Some(ray()), ..baseline() }
}

fn ray() -> SensorLaw {
    SensorLaw::Beam(SonarModel::ideal_ray(1.0, 0.0, [3.0, 250.0]))
}

/// Makes blocks of equally many rows.
pub fn observations(blocks: usize, rows: usize, made: impl Fn(usize, usize) -> Made) -> Observations {
    let (surroundings, law) = (Surroundings::new(&robot(), &room()), ray());
    let drive = baseline().motion.expect("a drive");
    let row = |block: usize, at: usize| {
        let Made { commands: [now, before], pose, elapsed_min, off, echo_off_cm } = made(block, at);
        let mut commands: CommandHistory = [before; HISTORY];
        commands[0] = now;
        let context =
            StepContext { commands, ..surroundings.context(&Default::default(), 60_000.0 * elapsed_min, pose) };
        let motion = drive.step(now, before) + Motion::from(off);
        Observation {
            run: block,
            at,
            block,
            place: 0,
            fold: block,
            motion_weight: [1.0; 3],
            echo_weight: [1.0; 2],
            duration_ratio: 1.0,
            context,
            following_steps: Vec::new(),
            motion: Some(motion),
            wheels_cm: None,
            gyro_rad: None,
            speeds: StepSpeeds { now, before, drift_cm: 0.0 },
            expected: Some(drive.step(now, before)),
            echo_cm: echo_off_cm.zip(context.faced).map(|(off_cm, [distance_cm, _])| distance_cm + off_cm),
            view: Some(law.view(&surroundings.surfaces, &surroundings.sensor(&pose, 0.0), 1.0)),
            side_ray_ranges_cm: side_ray_ranges_cm(&surroundings, &pose),
        }
    };
    let rows = (0..blocks).flat_map(|block| (0..rows).map(move |at| (block, at))).map(|(block, at)| row(block, at));
    let mut rows: Vec<Observation> = rows.collect();
    let places = number_places(&mut rows);
    Observations { rows, surroundings, law: Some(law), recollection: None, blocks, places }
}

/// Returns identification rows for these observations.
pub fn identification<'a>(baseline: &'a Baseline<'a>, observations: Observations) -> Identification<'a> {
    Identification::new(baseline, observations)
}

/// Calls `check` with the context of two rows in two blocks.
pub fn with_two_rows(check: impl Fn(&FitContext)) {
    let baseline = baseline();
    let rows = identification(&baseline, observations(2, 1, |_, _| Made::default()));
    check(&FitContext::new(&rows, METHOD));
}

/// Logs of runs that follow the textbook's drive, with readings equal to the distance.
pub fn driven(runs: usize, rows: usize, command: impl Fn(usize, usize) -> [f64; 2]) -> Logs {
    let (surroundings, drive) = (Surroundings::new(&robot(), &room()), baseline().motion.expect("a drive"));
    let run = |run: usize| {
        let mut pose = Made::default().pose;
        let row = |at: usize| {
            let [left, right] = command(run, at);
            let context = surroundings.context(&Default::default(), 0.0, pose);
            let echo_cm = context.faced.map(|[distance_cm, _]| distance_cm);
            let t_ms = at as f64 * surroundings.robot.step_ms;
            let row = Row { t_ms, left, right, pose: Some(pose), echo_cm, ..Row::default() };
            pose = drive.step([left, right], [0.0; 2]).end(&pose);
            row
        };
        Run { name: format!("run-{run:03}"), rows: (0..rows).map(row).collect() }
    };
    Logs { robot: robot(), scene: room(), runs: (0..runs).map(run).collect() }
}

/// Commands of a straight step.
pub const STRAIGHT: [f64; 2] = [50.0, 50.0];
/// Commands of a spin to the left.
pub const SPIN: [f64; 2] = [-30.0, 30.0];

/// Returns the information about a correction's weights of this many straight steps and spins, with a prior as wide as the noise.
pub fn precision(straight: usize, spins: usize) -> Precision {
    let step = |[left, right]: [f64; 2]| features([left, right, left, right], CommandScale::PERCENT.share()).to_vec();
    let rows = [vec![step(STRAIGHT); straight], vec![step(SPIN); spins]].concat();
    Precision { products: products(&rows), prior: Motion::splat(1.0) }
}

/// Alternates between plus and minus one.
pub fn alternating(at: usize) -> f64 {
    if at.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// A length with a flat prior, fitted from one millimetre.
const fn length(name: &'static str) -> Parameter {
    Parameter { name, ..Parameter::new("cm", 0.0, [-9.0, 9.0]).scale(5.0).from(Guesses::At(&[0.1])) }
}

/// A length added to every step.
pub const LONGER: Effect = Effect {
    id: "longer",
    name: "longer",
    what: "Made up.",
    in_logs: "",
    imitated_by: &[],
    check: "None.",
    place: None,
    needs_known_robot: false,
    variants: &[Variant {
        id: "every_step",
        parameters: &[length("cm")],
        hooks: &[Hook::Motion(&|v, _, increment| increment.forward += v[0])],
    }],
};

/// A length added to every step that is expected to be small: the standard deviation of its prior is 0.05 cm.
pub const SLIGHTLY_LONGER: Effect = Effect {
    id: "slightly_longer",
    name: "slightly_longer",
    what: "Made up.",
    in_logs: "",
    imitated_by: &[],
    check: "None.",
    place: None,
    needs_known_robot: false,
    variants: &[Variant {
        id: "every_step",
        parameters: &[length("cm").prior_sd(0.05)],
        hooks: LONGER.variants[0].hooks,
    }],
};

/// A length added to steps that turn left.
pub const LONGER_TO_THE_LEFT: Effect = Effect {
    id: "longer_to_the_left",
    name: "longer_to_the_left",
    what: "Made up.",
    in_logs: "",
    imitated_by: &[],
    check: "None.",
    place: None,
    needs_known_robot: false,
    variants: &[Variant {
        id: "left_turns",
        parameters: &[length("cm")],
        hooks: &[Hook::Motion(&|v, context, increment| {
            let [left, right] = context.commands[0];
            increment.forward += if right > left { v[0] } else { 0.0 };
        })],
    }],
};

/// A length added to readings, in two variants of which the second adds half of it.
pub const FARTHER: Effect = Effect {
    id: "farther",
    name: "farther",
    what: "Made up.",
    in_logs: "",
    imitated_by: &[],
    check: "None.",
    place: None,
    needs_known_robot: false,
    variants: &[
        Variant {
            id: "length",
            parameters: &[length("cm")],
            hooks: &[Hook::Sensor(&|v, _, sensor| sensor.perturbation.offset_cm += v[0])],
        },
        Variant {
            id: "half",
            parameters: &[length("cm")],
            hooks: &[Hook::Sensor(&|v, _, sensor| sensor.perturbation.offset_cm += 0.5 * v[0])],
        },
    ],
};

/// The effects that compete in tests.
pub const CATALOGUE: &[&Effect] = &[&LONGER, &LONGER_TO_THE_LEFT, &FARTHER];

/// Round thresholds that do not grow with the number of rows.
pub const CALIBRATION: Calibration = Calibration {
    rows: 1e9,
    adequate: 0.8,
    adequacy_width: 0.05,
    temperature: 1.0,
    accuracy_cap: 0.9,
    effect_nats: 5.0,
    remainder_nats: 5.0,
    further_share: 0.08,
    judgement: Judgement::USUAL,
};

/// The method with [`CATALOGUE`] and [`CALIBRATION`].
pub const METHOD: Method = Method {
    catalogue: CATALOGUE,
    place: None,
    calibration: CALIBRATION,
    further_shares: &NO_FURTHER_SHARES,
    seed: 1,
    is_driving: false,
};

static NO_FURTHER_SHARES: FurtherShares = FurtherShares::new(BTreeMap::new());

/// Returns the first variant of an effect.
pub fn candidate(effect: &'static Effect) -> Candidate {
    Candidate { effect: effect.id, variant: &effect.variants[0] }
}

/// Makes a fit of effects with one parameter each, with these cross-validated scores per block and rows that score zero.
pub fn made_up(effects: &[&'static Effect], values: &[f64], by_block: &[f64], context: &FitContext) -> Fitted {
    let candidates = effects.iter().map(|effect| candidate(effect)).collect();
    let mut column = vec![0.0; context.rows.rows.len()];
    by_block.iter().enumerate().for_each(|(block, nats)| column[context.rows.of_block(block).start] = *nats);
    let hypothesis = Hypothesis::null(context.baseline()).of(candidates);
    Fitted {
        witnesses: hypothesis.witnesses(context.rows, values).0,
        hypothesis,
        values: values.to_vec(),
        errors: vec![0.0; values.len()],
        noise: NOISE,
        scores: Scores::zero(context.rows.row_blocks()),
        cross_validated: context.rows.scores_of(Channel::Forward, &column),
        complexity_penalties: [0.0; 2],
    }
}

/// Confirms effects that gain this on each block over none, and leave no remainder.
pub fn confirmed(effects: &[&'static Effect], gains: &[f64], context: &FitContext) -> Confirmed {
    let null = made_up(&[], &[], &vec![0.0; gains.len()], context);
    let chosen = made_up(effects, &vec![0.5; effects.len()], gains, context);
    Confirmed::unexamined(null, chosen)
}

/// Makes scores of one row per block.
pub fn block_scores(channel: Channel, by_block: &[f64]) -> Scores {
    let rows = observations(by_block.len(), 1, |_, _| Made::default());
    Scores::zero(&Blocks::of(&rows)).with(channel, by_block)
}
