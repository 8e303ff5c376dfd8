//! Two ways to one result: fixed point and floating point, many lanes and one, the core's
//! elementary functions and those of `libm`.

use std::array;
use std::sync::LazyLock;

use fixed::types::I16F16;
use mindgap_built_in_robot::{default_robot, four_obstacles, record, training_room};
use mindgap_core::controller::{Controller, TUPLES, Tuple, When};
use mindgap_core::maths;
use mindgap_core::network::Network;
use mindgap_learning::learn::train::{TABLE_ONE, Trainer, train};
use mindgap_models::simulator::environment::{Environment, SensorModel};
use mindgap_models::simulator::fixed_point::Quantised;
use mindgap_models::simulator::rollout::RolloutRequest;
use mindgap_models::simulator::{Noise, Simulator};

use crate::Target;
use mindgap_tests::plausible_networks::{PlausibleNetworks, plausible_networks};

pub const TARGETS: &[Target] = &[
    Target { name: "fixed-and-float", feed: fixed_and_float },
    Target { name: "lanes-and-one", feed: lanes_and_one },
    Target { name: "maths", feed: elementary },
];

/// Bytes of a controller: six tuples of a left and a right command, a test and a threshold.
const CONTROLLER_BYTES: usize = 4 * TUPLES;
/// Distance of neighbouring numbers in 32 bits, at most, as a share of them.
const ULP: f64 = f32::EPSILON as f64;
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
        train(&logs, &Trainer::Fast, &TABLE_ONE, 1, &|_| {}).expect("networks")
    });
    let controllers: Vec<Controller> = bytes.as_chunks().0.iter().take(20).map(controller).collect();
    let scene = four_obstacles();
    for sensor in [SensorModel::Beam, SensorModel::Networks] {
        let environment = Environment::new(&SIMULATOR, &scene, scene.starts[0], Noise::Learned);
        let environment = environment.expect("a room to drive in").sensing_by(sensor, &SIMULATOR, &scene);
        let environment = environment.expect("no law is asked for");
        let motions: Vec<_> = controllers.iter().map(|controller| environment.motions(controller)).collect();
        let request = |((controller, motions), seed)| RolloutRequest { controller, motions, seed };
        let requests: Vec<RolloutRequest> = controllers.iter().zip(&motions).zip(0..).map(request).collect();
        for (request, outcome) in requests.iter().zip(environment.run(&requests)) {
            assert_eq!(environment.trace(*request).0, outcome);
        }
    }
}

/// The core's elementary functions, of any bits, keep the bounds that it states.
fn elementary(bytes: &[u8]) {
    for four in bytes.as_chunks::<4>().0 {
        let x = f32::from_le_bytes(*four);
        let (sin, cos, exp2, log2) = (maths::sin(x), maths::cos(x), maths::exp2(x), maths::log2(x));
        let exact = f64::from(x);
        let near = |found: f32, expected: f64, bound: f64| {
            assert!((f64::from(found) - expected).abs() <= bound, "{found} and {expected} of {x}");
        };
        if x.abs() <= 1000.0 {
            let bound = libm::exp2(-22.0) + libm::exp2(-23.0) * exact.abs();
            near(sin, libm::sin(exact), bound);
            near(cos, libm::cos(exact), bound);
        }
        if x.abs() <= 126.0 {
            let expected = libm::exp2(exact);
            near(exp2, expected, 3.0 * ULP * expected);
        }
        if x.is_normal() && x > 0.0 {
            let expected = libm::log2(exact);
            near(log2, expected, (3.0 * ULP * expected.abs()).max(libm::exp2(-24.0)));
        }
    }
}

fn controller(bytes: &[u8; CONTROLLER_BYTES]) -> Controller {
    let tuple = |place: usize| Tuple {
        left: bytes[4 * place].cast_signed().clamp(-100, 100),
        right: bytes[4 * place + 1].cast_signed().clamp(-100, 100),
        when: if bytes[4 * place + 2].is_multiple_of(2) { When::Larger } else { When::Smaller },
        threshold_cm: i16::from(bytes[4 * place + 3]),
    };
    Controller { step_ms: 400, max_steps: MOST_STEPS, tuples: array::from_fn(tuple) }
}
