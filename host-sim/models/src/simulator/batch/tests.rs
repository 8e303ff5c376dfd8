use super::*;
use crate::effects::applied::AppliedEffect;
use crate::effects::catalogue::Candidate;
use crate::simulator::baseline::Baseline;
use crate::simulator::environment::SensorModel;
use crate::simulator::known_steps::KnownSteps;
use crate::simulator::motion::{MotionTable, speeds};
use crate::simulator::{Noise, Simulator};
use mindgap_built_in_robot::{default_robot, four_obstacles, record, training_room};
use mindgap_core::controller::{Controller, Machine, Status, TUPLES, Tuple, When};
use mindgap_foundations::executor::Serial;
use mindgap_foundations::motion::Motion;
use mindgap_foundations::random::generator;
use mindgap_learning::evolve::genome::GenotypeDecoder;
use mindgap_learning::learn::train::{self, TABLE_ONE, Trainer};
use mindgap_logs::Termination;
use sha2::{Digest, Sha256};
use std::sync::LazyLock;

const SEED: u64 = 3;
const MAX_STEPS: u16 = 150;
const RUNS: u64 = 100;

/// Of all outcomes of [`outcomes`] on every kind of course, whatever the machine; made with [`SEED`].
const CHECKSUM: &str = "87c5cb2d373b54d657536ed606745ce29d47ba87129113ea1a28f5a6d69d5bae";

/// A simulator, and controllers for it. The training crate links this one without its tests, so its simulator comes over in
/// the form of its file.
static TRAINED: LazyLock<(Simulator, Vec<Controller>)> = LazyLock::new(|| {
    let logs = record(&default_robot(), &training_room(), 20, 40, &[], SEED).unwrap();
    let trained = train::train(&Serial, &logs, &Trainer::Fast, &TABLE_ONE, SEED, &|_| {}).unwrap();
    let decoder = GenotypeDecoder::new(&trained, MAX_STEPS);
    let controllers = (0..40).map(|i| decoder.controller(&decoder.random(&mut generator(SEED, &[i])))).collect();
    (serde_json::from_str(&serde_json::to_string(&trained).unwrap()).unwrap(), controllers)
});

static SIMULATOR: LazyLock<&Simulator> = LazyLock::new(|| &TRAINED.0);

fn environment(noise: Noise) -> Environment<'static> {
    let scene = four_obstacles();
    Environment::new(&SIMULATOR, &scene, scene.starts[0], noise).unwrap()
}

/// One of each kind: without noise, and with each of two sensors.
fn environments() -> [Environment<'static>; 3] {
    let sensing_by = |sensor| environment(Noise::Learned).sensing_by(sensor, &SIMULATOR, &four_obstacles()).unwrap();
    [environment(Noise::Paper), sensing_by(SensorModel::Networks), sensing_by(SensorModel::Beam)]
}

fn controllers() -> Vec<Controller> {
    TRAINED.1.clone()
}

/// Returns a number of runs of every controller, interleaved.
fn requests<'a>(controllers: &'a [Controller], tables: &'a [MotionTable]) -> Vec<RolloutRequest<'a>> {
    let of_seed =
        |seed| controllers.iter().zip(tables).map(move |(c, m)| RolloutRequest { controller: c, motions: m, seed });
    (0..RUNS).flat_map(of_seed).collect()
}

fn outcomes(environment: &Environment, simd: impl Simd) -> Vec<RolloutOutcome> {
    let tables: Vec<MotionTable> = controllers().iter().map(|c| environment.motions(c)).collect();
    outcomes_by(&tables, environment, simd)
}

fn outcomes_by(tables: &[MotionTable], environment: &Environment, simd: impl Simd) -> Vec<RolloutOutcome> {
    let controllers = controllers();
    let requests = requests(&controllers, tables);
    let mut outcomes = vec![None; requests.len()];
    let finish = |number: usize, outcome| outcomes[number] = Some(outcome);
    simd.vectorize(Batch { environment, requests: &requests, watch: |_, _| {}, finish });
    outcomes.into_iter().map(|outcome| outcome.expect("every run ends")).collect()
}

/// One checksum over long runs on every kind of course.
fn checksum(simd: impl Simd) -> String {
    let mut digest = Sha256::new();
    for environment in environments() {
        for outcome in outcomes(&environment, simd) {
            let end = outcome.end_cm;
            digest.update([end.x.to_bits(), end.y.to_bits(), u64::from(outcome.steps)].map(u64::to_le_bytes).concat());
        }
    }
    digest.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
}

#[test]
fn every_instruction_set_gives_the_same_checksum() {
    assert_eq!(checksum(pulp::Scalar::new()), CHECKSUM, "one by one");
    #[cfg(target_arch = "x86_64")]
    {
        use pulp::x86::{V3, V4};
        let report = |name, sum: Option<String>| match sum {
            Some(sum) => assert_eq!(sum, CHECKSUM, "{name}"),
            None => println!("not compared: this machine lacks {name}"),
        };
        report("AVX2", V3::try_new().map(checksum));
        report("AVX-512", V4::try_new().map(checksum));
    }
}

#[test]
fn a_run_does_not_depend_on_those_beside_it() {
    let environment = environment(Noise::Learned);
    let controllers = controllers();
    let tables: Vec<MotionTable> = controllers.iter().map(|c| environment.motions(c)).collect();
    let together = outcomes(&environment, pulp::Scalar::new());
    for (number, request) in requests(&controllers, &tables).into_iter().enumerate().step_by(97) {
        assert_eq!(environment.trace(request).0, together[number], "run {number}");
    }
}

#[test]
fn motions_worked_out_ahead_are_those_of_every_step() {
    for noise in [Noise::Paper, Noise::Learned] {
        let ahead = outcomes(&environment(noise), pulp::Scalar::new());
        let every_step = outcomes(&environment(noise).asking_every_step(), pulp::Scalar::new());
        assert_eq!(ahead, every_step);
        for controller in controllers() {
            let (environment, table) = (environment(noise), environment(noise).motions(&controller));
            for tuple in 0..TUPLES {
                for first in [true, false] {
                    assert_eq!(*table.step(tuple, first), environment.motion.step(speeds(&controller, tuple, first)));
                }
            }
        }
    }
}

#[test]
fn what_effects_make_of_motions_is_worked_out_ahead_as_in_every_step() {
    let applied = |effect: &str, variant: &str| {
        let candidate = Candidate::named(effect, variant).unwrap();
        AppliedEffect::new(&candidate, &candidate.variant.initial_guesses(1.0)[0], &SIMULATOR.robot)
    };
    let of = |added: &[AppliedEffect]| Simulator { added: added.to_vec(), ..SIMULATOR.clone() };
    let scene = four_obstacles();
    let by_commands = [
        vec![applied("motor_asymmetry", "command")],
        vec![applied("latency", "pose_delay"), applied("inertia", "first_order_lag")],
        vec![applied("slip", "growing"), applied("track_width", "turn")],
    ];
    for added in by_commands {
        let simulator = of(&added);
        let environment = Environment::new(&simulator, &scene, scene.starts[0], Noise::Learned).unwrap();
        let ahead = controllers().iter().all(|controller| environment.motions(controller).transients().is_some());
        assert!(ahead, "{added:?}");
        let not_ahead: Vec<MotionTable> = controllers().iter().map(|c| environment.motion.table(c)).collect();
        let every_step = outcomes_by(&not_ahead, &environment, pulp::Scalar::new());
        assert_eq!(outcomes(&environment, pulp::Scalar::new()), every_step, "{added:?}");
    }
    let timed = of(&[applied("battery_sag", "command")]);
    let environment = Environment::new(&timed, &scene, scene.starts[0], Noise::Learned).unwrap();
    assert!(environment.motions(&controllers()[0]).transients().is_none());
}

#[test]
fn every_run_steps_as_the_machine_of_the_core_does() {
    let environment = environment(Noise::Learned);
    let mut endings = [0; 3];
    for controller in &controllers() {
        let motions = &environment.motions(controller);
        for seed in 0..20 {
            let (outcome, moments) = environment.trace(RolloutRequest { controller, motions, seed });
            let mut machine = Machine::start(controller);
            for (i, moment) in moments.iter().enumerate() {
                let crashed = outcome.termination == Termination::Crashed && i + 1 == moments.len();
                if !crashed {
                    machine.step(moment.echo_cm);
                }
                assert_eq!(moment.tuple, machine.tuple(), "step {i}");
            }
            assert_eq!(moments.len(), usize::from(outcome.steps));
            let expected = match outcome.termination {
                Termination::Finished => Status::Finished,
                Termination::TimedOut => Status::TimedOut,
                Termination::Crashed => Status::Running,
            };
            assert_eq!(machine.status(), expected);
            endings[outcome.termination as usize] += 1;
        }
    }
    assert!(endings.iter().all(|count| *count > 0), "{endings:?} ended in each way");
}

/// Of three quarters of the distance three quarters of what training logs say is left, also where that is not what networks
/// say.
#[test]
fn effects_act_on_the_robot_as_it_was_known_in_training() {
    const SHARE: f64 = 0.75;
    let less = AppliedEffect::new(&Candidate::named("drive_scale", "distance").unwrap(), &[SHARE], &SIMULATOR.robot);
    let affected = Simulator { added: vec![less], ..SIMULATOR.clone() };
    let (scene, robots) = (four_obstacles(), SIMULATOR.robots(0, SEED).unwrap());
    let at_posterior_mean = |simulator| {
        Environment::new(simulator, &scene, scene.starts[0], Noise::Learned).unwrap().of_robot(&robots.mean)
    };
    let (usual, less) = (at_posterior_mean(&SIMULATOR), at_posterior_mean(&affected));
    let mut beyond_networks_cm: f32 = 0.0;
    for controller in controllers() {
        let (usual_motions, motions) = (usual.motions(&controller), less.motions(&controller));
        for (tuple, less) in motions.transients().expect("computed ahead").iter().enumerate() {
            let (expected, less) = (usual_motions.step(tuple, false), less.last().unwrap());
            let (expected, less) = (expected.motion, less.plus(motions.bias(tuple)).motion);
            assert!((less.forward - SHARE as f32 * expected.forward).abs() < 1e-4, "{less:?} {expected:?}");
            assert!((less.turn - SHARE as f32 * expected.turn).abs() < 1e-5, "{less:?} {expected:?}");
            let networks = SIMULATOR.motion_networks().unwrap().evaluate(speeds(&controller, tuple, false));
            beyond_networks_cm = beyond_networks_cm.max((expected.forward - networks.forward).abs());
        }
    }
    assert!(beyond_networks_cm > 0.1, "{beyond_networks_cm}");
}

/// Also of commands between whole ones, and of more steps than are remembered.
#[test]
fn a_step_is_known_as_the_networks_say_it() {
    const STEPS: usize = 70_000;
    let (scene, robots) = (four_obstacles(), SIMULATOR.robots(0, SEED).unwrap());
    let environment =
        Environment::new(&SIMULATOR, &scene, scene.starts[0], Noise::Learned).unwrap().of_robot(&robots.mean);
    let mut known = KnownSteps::new(&environment.motion);
    for number in (0..STEPS).chain(0..100) {
        let command = [number as f32 * 100.0 / STEPS as f32, 33.3];
        let step = known.step([command[0], command[1], 20.0, -20.0]);
        if number % 100 == 0 {
            assert_eq!(step, environment.motion.trained_step([command[0], command[1], 20.0, -20.0]), "{command:?}");
        }
    }
}

/// Networks and biases say something of commands of zero too, but rest is known without logs.
#[test]
fn commands_of_zero_stand_still() {
    let robots = SIMULATOR.robots(2, SEED).unwrap();
    let tuple = |command: i8, when| Tuple { left: command, right: command, when, threshold_cm: 0 };
    // Drives for a step and then rests.
    let mut tuples = [tuple(0, When::Smaller); TUPLES];
    tuples[0] = tuple(60, When::Larger);
    let controller = Controller { step_ms: 400, max_steps: 30, tuples };
    let kinds =
        || environments().into_iter().chain(robots.drawn.iter().map(|r| environment(Noise::Learned).of_robot(r)));
    for environment in kinds().chain(kinds().map(Environment::asking_every_step)) {
        let motions = environment.motions(&controller);
        let (outcome, points) =
            environment.trace(RolloutRequest { controller: &controller, motions: &motions, seed: SEED });
        assert_eq!((outcome.termination, points.len()), (Termination::TimedOut, 30));
        let at_rest = points.iter().rposition(|point| point.tuple == 0).map_or(1, |last| last + 2);
        let place = points[at_rest].pose;
        assert!(
            points[at_rest..].iter().all(|point| point.pose == place) && place.position_cm != environment.start_cm()
        );
    }
    for baseline in [Baseline::learned(&SIMULATOR), Baseline::at_posterior_mean(&SIMULATOR)] {
        let motion = baseline.unwrap().motion.unwrap();
        assert_eq!(motion.step([0.0; 2], [0.0; 2]), Motion::ZERO);
        assert_eq!(motion.own_error([0.0; 2], [0.0; 2]), Motion::ZERO);
    }
}
