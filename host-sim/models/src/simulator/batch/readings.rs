//! What the sensors of a vector of robots read. NaN stands for no reading: it ends no tuple.

use std::f32::consts::PI;

use mindgap_core::folded::evaluate_all;
use mindgap_core::scalar::Scalar;
use pulp::Simd;

use super::robots::Robots;
use super::{Row, StepDraws, level, load, row};
use crate::simulator::Noise;
use crate::simulator::beam::{Beam, Fate};
use crate::simulator::draws::Draws;
use crate::simulator::first_echo::FirstEchoSensor;
use crate::simulator::room::Point;
use mindgap_foundations::lanes::{Lanes, WIDEST};

/// Where every sensor is, its axis as a unit vector, and its angle in degrees.
struct Sensors<S: Simd> {
    origin: Point<S>,
    axis: Point<S>,
    axis_deg: Lanes<S>,
}

impl Robots<'_> {
    /// The reading of every robot, cm.
    #[inline(always)]
    pub fn sense<S: Simd>(&mut self, simd: S, draws: &StepDraws) -> Row {
        let environment = self.environment;
        let effects = environment.effect_layer.as_ref().filter(|effects| effects.senses());
        let reading_cm = match (effects, &environment.first_echo, &environment.beam) {
            (Some(effects), ..) => match effects.beam() {
                Some(beam) => self.hear(simd, beam, draws),
                None => return self.sense_through_effects(draws),
            },
            (None, Some(sensor), _) => return self.listen(sensor, draws),
            (None, None, Some(beam)) => self.hear(simd, beam, draws),
            (None, None, None) => self.look(simd, draws),
        };
        let sonar = &environment.robot.ultrasonic;
        let (low, high) = (reading_cm.constant(sonar.min_cm as f32), reading_cm.constant(sonar.max_cm as f32));
        self.echo_before_cm = row(reading_cm.clamp(low, high));
        self.echo_before_cm
    }

    /// The readings where added effects change the sensor.
    fn sense_through_effects(&mut self, draws: &StepDraws) -> Row {
        let mut echo_cm = [f32::NAN; WIDEST];
        for (lane, echo_cm) in echo_cm.iter_mut().enumerate() {
            let pose = self.pose(lane);
            let (Some(effect_layer), Some(run)) = (&self.environment.effect_layer, &mut self.runs[lane]) else {
                continue;
            };
            *echo_cm = effect_layer.echo_cm(&mut run.memory, pose, draws.echo[lane]).unwrap_or(f32::NAN);
        }
        echo_cm
    }

    /// The readings by the first-echo law.
    fn listen(&self, sensor: &FirstEchoSensor, draws: &StepDraws) -> Row {
        std::array::from_fn(|lane| {
            let draws_of_lane = [draws.echo[lane], draws.constant[lane]];
            let is_running = self.runs[lane].is_some();
            is_running.then(|| sensor.echo_cm(&self.pose(lane), draws_of_lane)).flatten().unwrap_or(f32::NAN)
        })
    }

    #[inline(always)]
    fn sensors<S: Simd>(&self, simd: S) -> Sensors<S> {
        let environment = self.environment;
        let sonar = &environment.robot.ultrasonic;
        let heading = load(simd, &self.heading_rad);
        let (c, s) = (load(simd, &self.heading_cos), load(simd, &self.heading_sin));
        let ahead = heading.constant(sonar.x_cm as f32);
        let left = heading.constant(sonar.y_cm as f32);
        let origin = Point {
            x: load(simd, &self.x_cm) + (ahead * c - left * s),
            y: load(simd, &self.y_cm) + (ahead * s + left * c),
        };
        let (cos_yaw, sin_yaw) =
            (heading.constant(environment.yaw_direction[0]), heading.constant(environment.yaw_direction[1]));
        let axis = Point { x: c * cos_yaw - s * sin_yaw, y: s * cos_yaw + c * sin_yaw };
        let axis_deg = heading * heading.constant(180.0 / PI) + heading.constant(sonar.yaw_deg as f32);
        Sensors { origin, axis, axis_deg }
    }

    /// Listens with every beam.
    #[inline(always)]
    fn hear<S: Simd>(&mut self, simd: S, beam: &Beam, draws: &StepDraws) -> Lanes<S> {
        let Sensors { origin, axis, axis_deg } = self.sensors(simd);
        let mut generators = Draws::load(simd, &self.sensor_seeds);
        let heard = beam.hear(&self.environment.room, origin, axis, axis_deg, &mut generators);
        generators.store(&mut self.sensor_seeds);
        let mut levels = [0; WIDEST];
        for (level_of_lane, bits) in levels.iter_mut().zip(draws.bits) {
            *level_of_lane = level(bits, 3);
        }
        let fate = Fate {
            outcome: load(simd, &draws.constant),
            place: load(simd, &draws.echo),
            student: beam.scatter(simd, &levels),
            before_cm: load(simd, &self.echo_before_cm),
        };
        beam.report(&heard, &fate)
    }

    /// Casts every sensor's axis into the room and asks the two sonar networks; where it faces nothing it reads nothing.
    #[inline(always)]
    fn look<S: Simd>(&self, simd: S, draws: &StepDraws) -> Lanes<S> {
        let environment = self.environment;
        let sensors = self.sensors(simd);
        let faced = environment.room.cast(sensors.origin, sensors.axis, sensors.axis_deg);
        let [probability, mut reading_cm] = evaluate_all(&environment.sonar, [faced.distance_cm, faced.alpha_deg]);
        let echo =
            load(simd, &draws.echo).less(probability) & faced.distance_cm.less(probability.constant(f32::INFINITY));
        if environment.noise == Noise::Learned {
            let mut readings_cm = row(reading_cm);
            let contexts = [row(faced.distance_cm), row(faced.alpha_deg)];
            self.scatter(&mut readings_cm[..Lanes::<S>::WIDTH], &contexts, draws);
            reading_cm = load(simd, &readings_cm);
        }
        echo.select(reading_cm, reading_cm.constant(f32::NAN))
    }

    /// What chance makes of the readings.
    #[inline(always)]
    fn scatter(&self, readings_cm: &mut [f32], contexts: &[Row; 2], draws: &StepDraws) {
        let environment = self.environment;
        for (lane, reading_cm) in readings_cm.iter_mut().enumerate() {
            let bits = draws.bits[lane];
            *reading_cm += environment.echo_residuals.residual([contexts[0][lane], contexts[1][lane]], level(bits, 3));
            if let Some(constant) = environment.constant_reading.filter(|c| draws.constant[lane] < c.probability) {
                // It scatters by a centimetre to either side.
                *reading_cm = constant.value_cm + (bits >> 20) as f32 % 3.0 - 1.0;
            }
        }
    }
}
