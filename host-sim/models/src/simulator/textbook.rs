//! The textbook as a simulator file: the differential drive and an ideal ray sonar written as networks of summation and
//! product units, so that everything that takes a learned simulator takes a textbook with effects too.
//!
//! For wheels that cover a and b in a step, a robot of track t turns by θ = (b − a) / t and moves along the chord of an arc
//! of length s = (a + b) / 2: s sin θ / θ forward and s (1 − cos θ) / θ to the left. The series of these in θ are
//! polynomials of the commands, and a polynomial is a sum of product units with whole exponents.

use std::collections::BTreeMap;

use mindgap_core::network::{Activation, Network, ProductUnit, Scaling, SummationUnit};

use super::baseline::{Baseline, MotionModel};
use super::ensemble::CommandScale;
use super::nominal::NominalModel;
use super::nominal::motion_bias::{FEATURES, MotionBias};
use super::residuals::{CELLS, LEVELS, ResidualQuantiles, VarianceComponents};
use super::{Learned, Origin, SCHEMA, Simulator};
use crate::effects::drive_filter::DriveFilter;
use crate::sonar::{SensorLaw, SonarModel};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::motion::{Axis, Motion};
use mindgap_foundations::statistics::student;
use mindgap_logs::Robot;

/// What the textbook is called beside files of simulators.
pub const NAME: &str = "the textbook's differential drive and an ideal sonar, from robot.toml (kinematic)";

/// Largest command.
const FULL: f32 = 100.0;
/// Log-odds of an echo per centimetre within the largest reading: a step, as nearly as a ramp can be one.
const EDGE_PER_CM: f32 = 10.0;

/// A polynomial of the scaled left and right command: coefficients by their exponents.
type Polynomial = BTreeMap<(u8, u8), f64>;

/// The simulator of a textbook baseline whose steps scatter by these standard deviations.
///
/// # Errors
/// When the baseline is learned from logs, or knows no motion.
pub fn simulator(baseline: &Baseline, scatter: Motion<f64>) -> Result<Simulator> {
    let Some(MotionModel::Kinematic { robot, .. }) = &baseline.motion else {
        return Err(Error::new("only the textbook's motion can be written as a simulator"));
    };
    let wheels = wheels_cm(robot);
    let turn_rad = times(&sum(&wheels[1], &times(&wheels[0], &constant(-1.0))), &constant(1.0 / robot.track_cm));
    let arc_cm = times(&sum(&wheels[0], &wheels[1]), &constant(0.5));
    // Up to the powers that thirty-two units hold; at a radian they are right to a thousandth.
    let forward_cm = times(&arc_cm, &series(&turn_rad, &[1.0, 0.0, -1.0 / 6.0, 0.0, 1.0 / 120.0]));
    let lateral_cm = times(&arc_cm, &series(&turn_rad, &[0.0, 0.5, 0.0, -1.0 / 24.0, 0.0, 1.0 / 720.0]));
    let turn_deg = times(&turn_rad, &constant(180.0 / std::f64::consts::PI));
    let network_scatter = scatter.turn_in_degrees();
    let learned = |polynomial, axis: Axis| -> Result<_> {
        Ok(Some(Learned { network: network(polynomial)?, residuals: residuals(network_scatter[axis], FULL) }))
    };
    // Runs hear by the same ideal ray as a beam, which lanes of them can draw.
    let (first_echo, sonar) = match &baseline.sonar {
        Some(SensorLaw::FirstEcho(law)) => {
            (Some(law.clone()), Some(SonarModel::ideal_ray(law.scatter_cm, law.p_dropout, law.range_cm)))
        }
        Some(SensorLaw::Beam(model)) => (None, Some(model.clone())),
        None => (None, None),
    };
    let range_cm = robot.ultrasonic.map(|sensor| sensor.range_cm().map(|cm| cm as f32));
    Ok(Simulator {
        schema: SCHEMA,
        origin: Origin { version: env!("CARGO_PKG_VERSION").into(), trainer: "textbook".into(), seed: 0, runs: 0 },
        robot: *robot,
        sensor: None,
        commands: [-FULL, FULL],
        filter: DriveFilter::default(),
        turn: learned(&turn_deg, Axis::Turn)?,
        forward: learned(&forward_cm, Axis::Forward)?,
        lateral: learned(&lateral_cm, Axis::Lateral)?,
        echo_probability: range_cm
            .map(|[_, far_cm]| Learned { network: within(far_cm), residuals: residuals(0.0, far_cm) }),
        echo_value: range_cm
            .map(|[near_cm, far_cm]| Learned { network: distance(near_cm, far_cm), residuals: residuals(0.0, far_cm) }),
        constant_reading: None,
        further: Vec::new(),
        reference: Some(NominalModel {
            motion: Some(MotionBias {
                scale: CommandScale::PERCENT,
                weights: Motion::from_fn(|_| vec![0.0; FEATURES]),
                scatter,
                precision: None,
            }),
            wheels: None,
            sonar,
            first_echo: first_echo.clone(),
            place_bound: baseline.place_bound,
            familiar: None,
        }),
        first_echo,
        ensemble: None,
        table_one: None,
        added: baseline.applied.clone(),
        missing: Vec::new(),
    })
}

/// What the left and the right wheel cover in a step, cm.
fn wheels_cm(robot: &Robot) -> [Polynomial; 2] {
    let full_cm = robot.full_speed_cm_s * robot.step_ms / 1000.0;
    // Commands of -100 to 100 are scaled onto 1 to 2.
    [(1, 0), (0, 1)].map(|exponents| Polynomial::from([(exponents, 2.0 * full_cm), ((0, 0), -3.0 * full_cm)]))
}

fn network(polynomial: &Polynomial) -> Result<Network<f32, 4>> {
    let mut network = Network::constant([Scaling::onto_one_to_two(-FULL, FULL); 4], 0.0);
    for ((left, right), coefficient) in polynomial {
        let output = *coefficient as f32;
        if (*left, *right) == (0, 0) {
            network.bias = output;
            continue;
        }
        let unit = ProductUnit { exponents: [f32::from(*left), f32::from(*right), 0.0, 0.0], output };
        network
            .product
            .push(unit)
            .map_err(|_| Error::new("a textbook's motion takes more units than a network has"))?;
    }
    Ok(network)
}

/// One nearer than `far_cm` and zero farther away.
fn within(far_cm: f32) -> Network<f32, 2> {
    let mut network = Network::constant(sonar_inputs(2.0 * far_cm), 0.5 + EDGE_PER_CM * far_cm);
    network.activation = Activation::Ramp;
    // The network has room for one unit.
    let _ =
        network.summation.push(SummationUnit { weights: [1.0, 0.0], bias: -1.0, output: -EDGE_PER_CM * 2.0 * far_cm });
    network
}

/// The distance itself.
fn distance(near_cm: f32, far_cm: f32) -> Network<f32, 2> {
    let mut inputs = sonar_inputs(far_cm);
    inputs[0].low = 1.0 + near_cm / far_cm;
    let mut network = Network::constant(inputs, 0.0);
    // The network has room for one unit.
    let _ = network.summation.push(SummationUnit { weights: [1.0, 0.0], bias: -1.0, output: far_cm });
    network
}

fn sonar_inputs(far_cm: f32) -> [Scaling<f32>; 2] {
    [Scaling::onto_one_to_two(0.0, far_cm), Scaling::onto_one_to_two(0.0, 90.0)]
}

/// The same scatter everywhere: quantiles of Student's distribution.
fn residuals(scatter: f64, reach: f32) -> ResidualQuantiles {
    let level = |i: usize| (scatter * student::quantile((i as f64 + 0.5) / LEVELS as f64)) as f32;
    let edges = std::array::from_fn(|i| reach * (i + 1) as f32 / CELLS as f32);
    ResidualQuantiles {
        edges: [edges; 2],
        quantiles: vec![(0..LEVELS).map(level).collect(); CELLS * CELLS],
        components: vec![VarianceComponents::STEP; CELLS * CELLS],
    }
}

fn constant(value: f64) -> Polynomial {
    Polynomial::from([((0, 0), value)])
}

fn sum(a: &Polynomial, b: &Polynomial) -> Polynomial {
    let mut sum = a.clone();
    b.iter().for_each(|(exponents, coefficient)| *sum.entry(*exponents).or_default() += coefficient);
    sum
}

fn times(a: &Polynomial, b: &Polynomial) -> Polynomial {
    let mut product = Polynomial::new();
    for ((i, j), x) in a {
        for ((k, l), y) in b {
            *product.entry((i + k, j + l)).or_default() += x * y;
        }
    }
    product
}

/// A power series of a polynomial, from the constant term on.
fn series(of: &Polynomial, coefficients: &[f64]) -> Polynomial {
    let last = coefficients.iter().rev();
    last.fold(Polynomial::new(), |rest, coefficient| sum(&constant(*coefficient), &times(of, &rest)))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::simulator::Noise;
    use crate::simulator::environment::Environment;
    use mindgap_foundations::geometry::Pose;
    use mindgap_logs::Scene;

    const SCATTER: Motion<f64> = Motion { forward: 0.1, lateral: 0.1, turn: 0.005 };

    fn baseline() -> Baseline<'static> {
        let robot = mindgap_built_in_robot::default_robot();
        let motion = Some(MotionModel::Kinematic { robot, scatter: SCATTER });
        Baseline { robot, motion, sonar: None, place_bound: [0.0; 2], familiar: None, applied: Vec::new() }
    }

    proptest! {
        /// Steps of up to a radian, which is a wheel's 11 cm.
        #[test]
        fn it_moves_as_the_textbook_does(left in -100.0..100.0f64, difference in -60.0..60.0f64) {
            let right = (left + difference).clamp(-100.0, 100.0);
            let baseline = baseline();
            let simulator = simulator(&baseline, SCATTER).unwrap();
            let step = simulator.motion_networks().unwrap().evaluate([left, right, 0.0, 0.0].map(|c| c as f32));
            let exact = baseline.motion.as_ref().unwrap().step([left, right], [0.0; 2]);
            prop_assert!((f64::from(step.forward) - exact.forward).abs() < 0.02, "{step:?} {exact:?}");
            prop_assert!((f64::from(step.lateral) - exact.lateral).abs() < 0.02, "{step:?} {exact:?}");
            prop_assert!((f64::from(step.turn) - exact.turn).abs() < 1e-4, "{step:?} {exact:?}");
        }

        #[test]
        fn it_hears_the_distance_within_its_range(distance_cm in 0f32..400.0, alpha_deg in 0f32..90.0) {
            let simulator = simulator(&baseline(), SCATTER).unwrap();
            let [near, far] = simulator.robot.ultrasonic.unwrap().range_cm().map(|cm| cm as f32);
            let probability: f32 = simulator.echo_probability.as_ref().unwrap().network.evaluate([distance_cm, alpha_deg]);
            let value: f32 = simulator.echo_value.as_ref().unwrap().network.evaluate([distance_cm, alpha_deg]);
            if (distance_cm - far).abs() > 0.2 {
                prop_assert_eq!(probability, if distance_cm < far { 1.0 } else { 0.0 });
            }
            prop_assert!((value - distance_cm.clamp(near, far)).abs() < 0.01, "{} {}", value, distance_cm);
        }
    }

    #[test]
    fn it_is_sound_and_controllers_run_in_it() {
        let simulator = simulator(&baseline(), SCATTER).unwrap();
        let file = serde_json::to_string(&simulator).unwrap();
        assert_eq!(serde_json::from_str::<Simulator>(&file).unwrap(), simulator);
        let scene = Scene { arena_cm: Some(glam::DVec2::new(300.0, 220.0)), ..Scene::default() };
        assert!(Environment::new(&simulator, &scene, Pose::new(100.0, 100.0, 0.0), Noise::Learned).is_ok());
    }
}
