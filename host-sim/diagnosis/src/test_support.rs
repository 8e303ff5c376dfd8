//! Made-up robots, rows, effects and fits, plain enough that what a stage has to answer is known in closed form.

use glam::DVec2;

use super::calibration::{Calibration, Judgement};
use super::compare::Comparison;
use super::fit::{FitContext, Fitted};
use super::hypothesis::{Hypothesis, LogLikelihood};
use super::method::Method;
use mindgap_foundations::geometry::Pose;
use mindgap_learning::evaluation::observations::{Observation, Observations, beside_cm, number_places};
use mindgap_logs::{Logs, Robot, Row, Run, Scene, Ultrasonic};
use mindgap_models::effects::context::{CommandHistory, HISTORY, Surroundings};
use mindgap_models::effects::parameter::Guesses;
use mindgap_models::effects::{Candidate, Effect, Hook, Parameter, StepContext, Variant};
use mindgap_models::simulator::baseline::{Baseline, MotionModel};
use mindgap_models::simulator::ensemble::CommandScale;
use mindgap_models::simulator::nominal::motion_bias::{Precision, features, products};
use mindgap_models::sonar::{SensorLaw, SonarModel};

/// Standard deviations of the drive: forward (cm), lateral (cm) and turn (rad).
pub const SCATTER: [f64; 3] = [1.0, 1.0, 0.1];

/// A row as it is made up.
#[derive(Clone, Copy)]
pub struct Made {
    /// Command of the step, and of the one before.
    pub commands: [[f64; 2]; 2],
    /// Pose at the begin of the step.
    pub pose: Pose,
    /// Time since the run began, minutes.
    pub elapsed_min: f64,
    /// Logged minus expected: forward (cm), lateral (cm), turn (rad).
    pub off: [f64; 3],
    /// Reading minus distance, cm.
    pub echo_off_cm: Option<f64>,
}

impl Default for Made {
    /// Straight on from the middle, as expected, without a reading.
    fn default() -> Self {
        let pose = Pose::new(150.0, 100.0, 0.0);
        Made { commands: [[50.0; 2]; 2], pose, elapsed_min: 0.0, off: [0.0; 3], echo_off_cm: None }
    }
}

/// A robot that covers a centimetre a step for every ten of command.
pub fn robot() -> Robot {
    Robot {
        wheel_diameter_cm: 5.6,
        track_cm: 10.0,
        body_radius_cm: 8.0,
        step_ms: 250.0,
        full_speed_cm_s: 40.0,
        ultrasonic: Ultrasonic { x_cm: 0.0, y_cm: 0.0, yaw_deg: 0.0, min_cm: 3.0, max_cm: 250.0 },
    }
}

/// An empty room of 300 by 200 cm.
pub fn room() -> Scene {
    Scene { arena_cm: Some(DVec2::new(300.0, 200.0)), ..Scene::default() }
}

/// The textbook's drive, without a sensor.
pub fn baseline() -> Baseline<'static> {
    Baseline {
        motion: Some(MotionModel::Kinematic { robot: robot(), scatter: SCATTER }),
        sonar: None,
        place_bound: [0.0; 2],
        familiar: None,
        applied: Vec::new(),
    }
}

/// The same with a ray that comes back for certain and scatters by a centimetre.
pub fn baseline_with_sonar() -> Baseline<'static> {
    Baseline { sonar: Some(ray()), ..baseline() }
}

fn ray() -> SensorLaw {
    SensorLaw::Beam(SonarModel::ideal_ray(1.0, 0.0, [3.0, 250.0]))
}

/// Blocks of equally many rows.
pub fn observations(blocks: usize, rows: usize, made: impl Fn(usize, usize) -> Made) -> Observations {
    let (surroundings, law) = (Surroundings::new(&robot(), &room()), ray());
    let drive = baseline().motion.expect("a drive");
    let row = |block: usize, at: usize| {
        let Made { commands: [now, before], pose, elapsed_min, off, echo_off_cm } = made(block, at);
        let mut commands: CommandHistory = [before; HISTORY];
        commands[0] = now;
        let context =
            StepContext { commands, ..surroundings.context(&Default::default(), 60_000.0 * elapsed_min, pose) };
        let mut motion = drive.step(now, before);
        motion.forward_cm += off[0];
        motion.lateral_cm += off[1];
        motion.turn_rad += off[2];
        Observation {
            run: block,
            at,
            block,
            place: 0,
            fold: block,
            motion_weight: [1.0; 3],
            echo_weight: [1.0; 2],
            stretch: 1.0,
            context,
            then: Vec::new(),
            motion: Some(motion),
            expected: None,
            echo_cm: echo_off_cm.zip(context.faced).map(|(off_cm, [distance_cm, _])| distance_cm + off_cm),
            view: Some(law.view(&surroundings.surfaces, &surroundings.sensor(&pose, 0.0), 1.0)),
            beside_cm: beside_cm(&surroundings, &pose),
        }
    };
    let rows = (0..blocks).flat_map(|block| (0..rows).map(move |at| (block, at))).map(|(block, at)| row(block, at));
    let mut rows: Vec<Observation> = rows.collect();
    let places = number_places(&mut rows);
    Observations { rows, surroundings, law: Some(law), recollection: None, blocks, places }
}

/// Logs of runs that do what the textbook says of their commands, with readings that are the distance.
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
            pose = drive.step([left, right], [0.0; 2]).from(&pose);
            row
        };
        Run { name: format!("run-{run:03}"), rows: (0..rows).map(row).collect() }
    };
    Logs { robot: robot(), scene: room(), runs: (0..runs).map(run).collect() }
}

/// Straight on, and a spin to the left.
pub const STRAIGHT: [f64; 2] = [50.0, 50.0];
/// See [`STRAIGHT`].
pub const SPIN: [f64; 2] = [-30.0, 30.0];

/// What so many steps straight on and in spins tell of a correction's weights, with a prior as wide as the noise.
pub fn precision(straight: usize, spins: usize) -> Precision {
    let step = |[left, right]: [f64; 2]| features([left, right, left, right], CommandScale::PERCENT.share()).to_vec();
    let rows = [vec![step(STRAIGHT); straight], vec![step(SPIN); spins]].concat();
    Precision { products: products(&rows), prior: [1.0; 3] }
}

/// What alternates between plus and minus one.
pub fn alternating(at: usize) -> f64 {
    if at.is_multiple_of(2) { 1.0 } else { -1.0 }
}

/// A length without a prior, fitted from a millimetre; derivatives are taken over a fifth of one.
const fn length(name: &'static str) -> Parameter {
    Parameter { name, ..Parameter::new("cm", 0.0, [-9.0, 9.0]).scale(5.0).from(Guesses::At(&[0.1])) }
}

/// A length added to every step.
pub const LONGER: Effect = Effect {
    id: "longer",
    name: "longer",
    what: "Made up.",
    check: "None.",
    variants: &[Variant {
        id: "every_step",
        parameters: &[length("cm")],
        hooks: &[Hook::Motion(&|v, _, increment| increment.forward_cm += v[0])],
    }],
};

/// A length added to every step, and expected to be small: its prior deviates by 0.05 cm.
pub const SLIGHTLY_LONGER: Effect = Effect {
    id: "slightly_longer",
    name: "slightly_longer",
    what: "Made up.",
    check: "None.",
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
    check: "None.",
    variants: &[Variant {
        id: "left_turns",
        parameters: &[length("cm")],
        hooks: &[Hook::Motion(&|v, context, increment| {
            let [left, right] = context.commands[0];
            increment.forward_cm += if right > left { v[0] } else { 0.0 };
        })],
    }],
};

/// A length by which readings are too long, in two variants of which the second works with half of it.
pub const FARTHER: Effect = Effect {
    id: "farther",
    name: "farther",
    what: "Made up.",
    check: "None.",
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

/// Round thresholds that do not grow with the rows of a test.
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

/// Diagnoses with [`CATALOGUE`] and [`CALIBRATION`].
pub const METHOD: Method = Method { catalogue: CATALOGUE, calibration: CALIBRATION, seed: 1 };

/// The first variant of an effect.
pub fn candidate(effect: &'static Effect) -> Candidate {
    Candidate { effect: effect.id, variant: &effect.variants[0] }
}

/// A fit of effects at these values, each of one parameter, and with these log-likelihoods of blocks; its rows are
/// left at zero.
pub fn made_up(effects: &[&'static Effect], values: &[f64], held_out: &[f64], context: &FitContext) -> Fitted {
    let candidates = effects.iter().map(|effect| candidate(effect)).collect();
    let rows = context.observations.rows.len();
    Fitted {
        hypothesis: Hypothesis::none(context.baseline).of(candidates),
        values: values.to_vec(),
        log_likelihood: LogLikelihood { motion: vec![[0.0; 3]; rows], sonar: vec![[0.0; 2]; rows] },
        held_out: held_out.to_vec(),
        errors: vec![0.0; values.len()],
        occam: 0.0,
    }
}

/// A comparison whose chosen effects gain this on each block over none, and leave nothing over.
pub fn comparison(effects: &[&'static Effect], gains: &[f64], context: &FitContext) -> Comparison {
    let none = made_up(&[], &[], &vec![0.0; gains.len()], context);
    let chosen = made_up(effects, &vec![0.5; effects.len()], gains, context);
    Comparison::of(none, chosen)
}
