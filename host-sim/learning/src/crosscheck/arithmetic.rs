//! The responses of a simulated robot in both arithmetics: the outputs of the networks, with noise.

use std::f64::consts::PI;

use fixed::types::I16F16;
use mindgap_core::chance::{Generator, happens, normal};
use mindgap_core::folded::FoldedNetwork;
use rand::Rng;

use crate::learn::dataset::{Dataset, Datasets};
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::motion::Motion;
use mindgap_models::simulator::Simulator;
use mindgap_models::simulator::fixed_point::FixedNetworks;

/// An arithmetic in which a simulated robot computes.
pub trait Arithmetic: Sync {
    /// A reading in cm.
    type Reading: PartialOrd + From<i16> + Copy + Into<f64>;

    /// Draws the motion of a step, its turn in degrees, for left, right, previous left and previous right command.
    fn motion(&self, speeds: [i8; 4], generator: &mut Generator) -> Motion<f64>;

    /// Draws the reading for D (cm) and α (degrees), clamped to the sensor's range; `None` if there is no echo.
    fn reading(&self, faced: [f64; 2], generator: &mut Generator) -> Option<Self::Reading>;
}

/// The networks in single precision, as the PC runs them.
pub struct Float {
    pub turn: FoldedNetwork<f32, 4>,
    pub forward: FoldedNetwork<f32, 4>,
    pub lateral: FoldedNetwork<f32, 4>,
    pub echo_probability: FoldedNetwork<f32, 2>,
    pub echo_value: FoldedNetwork<f32, 2>,
    scatter: Scatter,
}

/// The same in fixed point, as a board runs them.
pub struct Fixed<'s> {
    networks: &'s FixedNetworks,
    scatter: Scatter,
}

/// Standard deviations of the logged values about the networks, and the sensor's range.
#[derive(Clone, Copy)]
struct Scatter {
    turn_deg: f64,
    forward_cm: f64,
    lateral_cm: f64,
    echo_cm: f64,
    /// Smallest and largest reading, cm.
    range_cm: [f64; 2],
}

impl Float {
    /// Returns the networks of a simulator, with the scatter of these logs about them.
    ///
    /// # Errors
    /// If a network is missing; the message names it.
    pub fn new(simulator: &Simulator, data: &Datasets) -> Result<Self> {
        let turn = FoldedNetwork::fold(&simulator.need(&simulator.turn, "turn")?.network);
        let forward = FoldedNetwork::fold(&simulator.need(&simulator.forward, "forward")?.network);
        let lateral = FoldedNetwork::fold(&simulator.need(&simulator.lateral, "lateral")?.network);
        let echo_probability =
            FoldedNetwork::fold(&simulator.need(&simulator.echo_probability, "echo_probability")?.network);
        let echo_value = FoldedNetwork::fold(&simulator.need(&simulator.echo_value, "echo_value")?.network);
        let sensor = simulator.robot.ultrasonic;
        let sensor = sensor.ok_or_else(|| Error::new("the simulator's robot has no [ultrasonic]"))?;
        let scatter = Scatter {
            turn_deg: deviation(&turn, &data.turn),
            forward_cm: deviation(&forward, &data.forward),
            lateral_cm: deviation(&lateral, &data.lateral),
            echo_cm: deviation(&echo_value, &data.echo_value),
            range_cm: sensor.range_cm(),
        };
        Ok(Float { turn, forward, lateral, echo_probability, echo_value, scatter })
    }
}

impl<'s> Fixed<'s> {
    /// Returns quantised networks, with the scatter of the networks that they were made from.
    pub fn new(networks: &'s FixedNetworks, float: &Float) -> Self {
        Fixed { networks, scatter: float.scatter }
    }
}

impl Arithmetic for Float {
    type Reading = f64;

    fn motion(&self, speeds: [i8; 4], generator: &mut Generator) -> Motion<f64> {
        let speeds = speeds.map(f32::from);
        let Scatter { turn_deg, forward_cm, lateral_cm, .. } = self.scatter;
        Motion::from([(&self.forward, forward_cm), (&self.lateral, lateral_cm), (&self.turn, turn_deg)])
            .map(|(network, deviation)| float_normal(network.evaluate(speeds), deviation, generator))
    }

    fn reading(&self, faced: [f64; 2], generator: &mut Generator) -> Option<f64> {
        let faced = faced.map(|x| x as f32);
        let probability: f32 = self.echo_probability.evaluate(faced);
        let echo = f64::from(generator.next_u32()) / TWO_TO_32 < f64::from(probability);
        let Scatter { echo_cm, range_cm: [min_cm, max_cm], .. } = self.scatter;
        echo.then(|| float_normal(self.echo_value.evaluate(faced), echo_cm, generator).max(min_cm).min(max_cm))
    }
}

impl Arithmetic for Fixed<'_> {
    type Reading = I16F16;

    fn motion(&self, speeds: [i8; 4], generator: &mut Generator) -> Motion<f64> {
        let speeds = speeds.map(I16F16::from);
        let FixedNetworks { forward, lateral, turn, .. } = self.networks;
        let Scatter { turn_deg, forward_cm, lateral_cm, .. } = self.scatter;
        Motion::from([(forward, forward_cm), (lateral, lateral_cm), (turn, turn_deg)]).map(|(network, deviation)| {
            let mean = network.network.evaluate(speeds).value;
            normal(mean, I16F16::saturating_from_num(deviation), generator).into()
        })
    }

    fn reading(&self, faced: [f64; 2], generator: &mut Generator) -> Option<I16F16> {
        let faced = faced.map(I16F16::saturating_from_num);
        let FixedNetworks { echo_probability, echo_value, .. } = self.networks;
        let echo = happens(echo_probability.network.evaluate(faced).value, generator);
        let deviation = I16F16::saturating_from_num(self.scatter.echo_cm);
        let [min_cm, max_cm] = self.scatter.range_cm.map(I16F16::saturating_from_num);
        echo.then(|| normal(echo_value.network.evaluate(faced).value, deviation, generator).max(min_cm).min(max_cm))
    }
}

/// Returns the standard deviation of the residuals of a network, from their median magnitude, which is robust to outliers.
fn deviation<const N: usize>(network: &FoldedNetwork<f32, N>, data: &Dataset<N>) -> f64 {
    /// For a normal distribution.
    const DEVIATION_PER_MEDIAN: f64 = 1.4826;
    let residual = |(x, target): (&[f32; N], &f32)| f64::from((target - network.evaluate(*x)).abs());
    let mut residuals: Vec<f64> = data.inputs.iter().zip(&data.targets).map(residual).collect();
    residuals.sort_by(f64::total_cmp);
    DEVIATION_PER_MEDIAN * residuals.get(residuals.len() / 2).copied().unwrap_or_default()
}

const TWO_TO_32: f64 = 4_294_967_296.0;

/// Makes the draw of [`normal`] from the same random words, in double precision (Box and Muller 1958).
fn float_normal(mean: f32, deviation: f64, generator: &mut Generator) -> f64 {
    let u = f64::from(generator.next_u32().max(1)) / TWO_TO_32;
    let turns = f64::from(generator.next_u32()) / TWO_TO_32;
    f64::from(mean) + deviation * libm::sqrt(-2.0 * libm::log(u)) * libm::cos(2.0 * PI * turns)
}
