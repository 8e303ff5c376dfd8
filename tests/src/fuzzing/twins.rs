//! Two ways to one result: fixed point and floating point, many lanes and one, a brick's bytecode and the core.

use std::array;
use std::sync::LazyLock;

use fixed::types::I16F16;
use mindgap_controller_export::brick::{self, Drive, EventKind, Program, RunConfig, ScriptedWorld, Sonar, Termination};
use mindgap_controller_export::onboard::{FAILED_STEPS_TO_STOP, NO_ECHO_CM, Safety};
use mindgap_controller_export::rxe;
use mindgap_controller_export::wiring::Wiring;
use mindgap_core::controller::{Controller, Machine, Motors, Status, TUPLES, Tuple, When};
use mindgap_core::network::Network;
use mindgap_host_sim::built_in_robot::{default_robot, four_obstacles, record, training_room};
use mindgap_host_sim::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_host_sim::simulator::environment::Environment;
use mindgap_host_sim::simulator::fixed_point::Quantised;
use mindgap_host_sim::simulator::rollout::{RolloutRequest, SensorModel};
use mindgap_host_sim::simulator::{Noise, Simulator};

use super::Target;
use crate::plausible_networks::{PlausibleNetworks, plausible_networks};

pub const TARGETS: &[Target] = &[
    Target { name: "fixed-and-float", feed: fixed_and_float },
    Target { name: "lanes-and-one", feed: lanes_and_one },
    Target { name: "brick-and-core", feed: brick_and_core },
];

/// Bytes of a controller: six tuples of a left and a right command, a test and a threshold.
const CONTROLLER_BYTES: usize = 4 * TUPLES;
/// Rooms for so many steps, and no more.
const MOST_STEPS: u16 = 20;

/// Networks in fixed point answer as in floating point, within the bound that is promised for them.
fn fixed_and_float(bytes: &[u8]) {
    static NETWORKS: LazyLock<PlausibleNetworks> = LazyLock::new(|| plausible_networks(1));
    let numbers: Vec<i16> = bytes.as_chunks::<2>().0.iter().map(|pair| i16::from_le_bytes(*pair)).collect();
    let Some(&[a, b, c, d]) = numbers.first_chunk() else { return };
    let commands = [a, b, c, d].map(|number| I16F16::from_num(100.0 * f64::from(number) / 32768.0));
    let share = |number: i16| f64::from(number.unsigned_abs()) / 32768.0;
    let facing = [255.0 * share(a), 90.0 * share(b)].map(I16F16::from_num);
    let PlausibleNetworks { turn, forward, lateral, echo_probability, echo_value } = &*NETWORKS;
    [turn, forward, lateral].into_iter().for_each(|network| answers_alike(network, commands));
    [echo_probability, echo_value].into_iter().for_each(|network| answers_alike(network, facing));
}

fn answers_alike<const N: usize>(network: &Network<f32, N>, inputs: [I16F16; N]) {
    let Quantised { network: fixed, error_bound } = Quantised::new(network).expect("a network that fits");
    let float = f64::from(network.evaluate(inputs.map(|input| input.to_num::<f32>())));
    let fixed = fixed.evaluate(inputs).value.to_num::<f64>();
    // Floating point rounds too, by much less.
    assert!((fixed - float).abs() <= 1.5 * error_bound + 1e-3, "{fixed} and {float} at {inputs:?}");
}

/// A run comes out the same beside others as alone.
fn lanes_and_one(bytes: &[u8]) {
    static SIMULATOR: LazyLock<Simulator> = LazyLock::new(|| {
        let logs = record(&default_robot(), &training_room(), 12, 40, &[], 1).expect("room to drive");
        train(&logs, &Trainer::Fast, &TABLE_ONE, 1, |_| {}).expect("networks")
    });
    let controllers: Vec<Controller> = bytes.as_chunks().0.iter().take(20).map(controller).collect();
    let scene = four_obstacles();
    let environment = Environment::new(&SIMULATOR, &scene, scene.starts[0], Noise::Learned);
    let environment = environment.expect("a room to drive in").with_beam(&SIMULATOR);
    let motions: Vec<_> = controllers.iter().map(|controller| environment.motions(controller)).collect();
    let requests: Vec<RolloutRequest> = controllers
        .iter()
        .zip(&motions)
        .enumerate()
        .map(|(number, (controller, motions))| RolloutRequest {
            controller,
            motions,
            sensor: if number % 3 == 0 { SensorModel::Beam } else { SensorModel::Networks },
            seed: number as u64,
        })
        .collect();
    for (request, outcome) in requests.iter().zip(environment.run(&requests)) {
        assert_eq!(environment.trace(*request).0, outcome);
    }
}

/// A brick's program commands what the core's machine does.
fn brick_and_core(bytes: &[u8]) {
    let Some((first, rest)) = bytes.split_first_chunk::<CONTROLLER_BYTES>() else { return };
    let controller = controller(first);
    let answers = rest.iter().map(|byte| match byte {
        254 => Sonar::Silent,
        cm => Sonar::Echo(*cm),
    });
    let sonar: Vec<Sonar> = answers.chain([Sonar::Silent; 2]).take(usize::from(MOST_STEPS)).collect();
    let file = rxe::program(&controller, &Wiring::default(), Safety::default()).expect("a sound controller");
    let program = Program::load(&file).expect("its own program");
    let report = brick::run(&program, &mut ScriptedWorld::sonar(sonar.clone()), &RunConfig::default());
    assert_eq!(report.end, Termination::Finished);
    let powers = report.events.iter().filter_map(|event| match event.kind {
        EventKind::Motor { drive: Drive::Power(power), .. } => Some(power),
        EventKind::Motor { .. } => Some(0),
        _ => None,
    });
    let powers: Vec<i8> = powers.collect();
    let commands: Vec<Motors> =
        powers.as_chunks().0.iter().map(|[left, right]| Motors { left: *left, right: *right }).collect();
    assert_eq!(commands, commanded(&controller, &sonar));
}

/// The commands of the core's machine, and the stop of a run whose sensor is dead; without one at the begin there are none.
fn commanded(controller: &Controller, sonar: &[Sonar]) -> Vec<Motors> {
    if sonar.first() == Some(&Sonar::Silent) {
        return Vec::new();
    }
    let mut machine = Machine::start();
    let mut commands = vec![machine.motors(controller)];
    let mut failed_steps = 0;
    for answer in sonar {
        let tuple = machine.tuple();
        let reading_cm = match answer {
            Sonar::Echo(cm) if *cm != NO_ECHO_CM => Some(i16::from(*cm)),
            _ => None,
        };
        failed_steps = if matches!(answer, Sonar::Echo(_)) { 0 } else { failed_steps + 1 };
        if machine.step(controller, reading_cm) != Status::Running || failed_steps == FAILED_STEPS_TO_STOP {
            commands.push(Motors { left: 0, right: 0 });
            break;
        }
        if machine.tuple() != tuple {
            commands.push(machine.motors(controller));
        }
    }
    commands
}

fn controller(bytes: &[u8; CONTROLLER_BYTES]) -> Controller {
    let tuple = |place: usize| Tuple {
        left: bytes[4 * place].cast_signed().clamp(-100, 100),
        right: bytes[4 * place + 1].cast_signed().clamp(-100, 100),
        when: if bytes[4 * place + 2] % 2 == 0 { When::Larger } else { When::Smaller },
        threshold_cm: i16::from(bytes[4 * place + 3]),
    };
    Controller { step_ms: 400, max_steps: MOST_STEPS, tuples: array::from_fn(tuple) }
}
