//! The sensor as its logs show it: a fan of rays, of which the first that comes back gives the reading.
//!
//! The networks know the axis alone (D, α). A real beam is wide: beside an edge it reads the nearer thing, and at an
//! oblique wall the part that faces it. Each ray of the fan comes back with a chance that depends on its own distance
//! and incidence and on how far it is off the axis.

use serde::{Deserialize, Serialize};

use crate::geometry::{Pose, Wall, cast, direction};

/// Offsets of the rays from the axis, degrees.
pub const FAN_DEG: [f64; 9] = [-20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0];
/// How many numbers describe a ray's strength.
pub const STRENGTHS: usize = 10;
/// Beyond this nothing changes any more, cm.
pub const FAR_CM: f64 = 300.0;
/// The chance of a reading from nowhere: no model is certain.
pub const STRAY: f64 = 0.003;
/// A constant reading scatters by about this, cm.
const CONSTANT_SCATTER_CM: f64 = 0.8;

/// What is normal for the sensor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SonarModel {
    /// Weights of [`ray_features`]: the log-odds that a ray comes back.
    pub strength: [f64; STRENGTHS],
    /// Reading minus distance: a constant, a share of the distance, and per 45 degrees of incidence; cm.
    pub bias: [f64; 3],
    /// Logarithm of the scatter in cm: a constant, per metre, per 45 degrees.
    pub log_scatter: [f64; 3],
    /// Chance of the constant reading in place of an echo, and its value in cm.
    pub constant: [f64; 2],
    /// Chance of the constant reading where no echo comes back.
    pub constant_for_none: f64,
    /// Chance of a random short reading.
    pub short: f64,
    /// Chance that a value is lost whatever came back.
    pub lost: f64,
    /// The beam against [`FAN_DEG`].
    pub fan_width: f64,
    /// What the sensor can report, cm.
    pub range_cm: [f64; 2],
}

/// What one ray meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Distance, cm; infinite where there is nothing.
    pub distance_cm: f64,
    /// Incidence angle, degrees, 0..=90.
    pub alpha_deg: f64,
}

/// A fan's rays, in the order of [`FAN_DEG`].
pub type Fan = [Ray; FAN_DEG.len()];

/// What a sensor at `sensor` sees whose beam is `width` times as wide as [`FAN_DEG`].
pub fn fan_at(sides: &[Wall], sensor: &Pose, width: f64) -> Fan {
    FAN_DEG.map(|offset| {
        let way = direction(sensor.heading_rad + (offset * width).to_radians());
        cast(sides, sensor.position_cm, way).map_or(Ray { distance_cm: f64::INFINITY, alpha_deg: 90.0 }, |hit| Ray {
            distance_cm: hit.distance_cm,
            alpha_deg: hit.incidence_rad.abs().to_degrees(),
        })
    })
}

/// How a sensor differs from the reference; [`Perturbation::NONE`] changes nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Perturbation {
    /// Taken off every ray's log-odds.
    pub damping: f64,
    /// The same per metre of distance.
    pub damping_per_m: f64,
    /// The same per 45 degrees of incidence.
    pub damping_per_incidence: f64,
    /// Readings are multiplied by this,
    pub gain: f64,
    /// and this is added, cm.
    pub offset_cm: f64,
    /// Further scatter of readings, cm.
    pub scatter_cm: f64,
    /// Chance that an echo is lost.
    pub lost: f64,
    /// Chance of a constant reading in place of an echo,
    pub ghost_for_echo: f64,
    /// in place of none,
    pub ghost_for_none: f64,
    /// and its value, cm.
    pub ghost_cm: f64,
    /// Chance of a random short reading.
    pub short: f64,
    /// Chance of a random reading from beyond what the axis meets.
    pub long: f64,
    /// Chance that the reading is the one before.
    pub stale: f64,
}

/// What a drawn reading depends on beside the fan.
pub struct Draw<'a> {
    /// How the sensor differs.
    pub change: &'a Perturbation,
    /// The reading before.
    pub previous_cm: Option<f64>,
    /// Whether readings scatter.
    pub scatters: bool,
}

impl Perturbation {
    /// The sensor as it was.
    pub const NONE: Perturbation = Perturbation {
        damping: 0.0,
        damping_per_m: 0.0,
        damping_per_incidence: 0.0,
        gain: 1.0,
        offset_cm: 0.0,
        scatter_cm: 0.0,
        lost: 0.0,
        ghost_for_echo: 0.0,
        ghost_for_none: 0.0,
        ghost_cm: 20.0,
        short: 0.0,
        long: 0.0,
        stale: 0.0,
    };
}

impl SonarModel {
    /// The log-likelihood of what was logged at a row, and the part of it that is about echo or none. `previous_cm` is
    /// the reading of the row before.
    pub fn log_likelihood(
        &self,
        fan: &Fan,
        change: &Perturbation,
        echo_cm: Option<f64>,
        previous_cm: Option<f64>,
    ) -> [f64; 2] {
        let [any, density] = self.first_echo(fan, change, echo_cm);
        let echo = (any * (1.0 - change.lost) * (1.0 - self.lost)).clamp(STRAY, 1.0 - STRAY);
        let kept = (1.0 - change.short) * (1.0 - self.short);
        let ghost = 1.0 - echo * (1.0 - change.ghost_for_echo) - (1.0 - echo) * (1.0 - change.ghost_for_none);
        let none = (1.0 - echo) * (1.0 - change.ghost_for_none) * (1.0 - self.constant_for_none);
        let value = 1.0 - kept * none;
        let value = value.clamp(STRAY, 1.0 - STRAY);
        let Some(z) = echo_cm else {
            let none = libm::log(1.0 - value);
            return [none, none];
        };
        let [low, high] = self.range_cm;
        // A random short reading lies anywhere before what the axis meets.
        let reach = fan[FAN_DEG.len() / 2].distance_cm.clamp(low + 10.0, high);
        let before = if z >= low && z <= reach { 1.0 / (reach - low) } else { 0.0 };
        let true_echo = if any > 0.0 { echo * density / any } else { 0.0 };
        let fresh = true_echo * (1.0 - change.ghost_for_echo) * (1.0 - self.constant[0])
            + self.constant_chance(echo, change) * near(z, self.constant[1]);
        let mut reading = kept * (fresh + ghost * near(z, change.ghost_cm)) + (1.0 - kept) * before;
        if change.long > 0.0 && z > reach {
            reading += change.long * value * (1.0 / (high - reach).max(1.0) - reading / value);
        } else {
            reading *= 1.0 - change.long;
        }
        if let Some(previous_cm) = previous_cm {
            reading = (1.0 - change.stale) * reading + change.stale * value * near(z, previous_cm);
        }
        let reading = (1.0 - STRAY) * reading + STRAY * value / (high - low);
        [libm::log(reading.max(1e-9)), libm::log(value)]
    }

    /// The chance of the constant reading.
    fn constant_chance(&self, echo: f64, change: &Perturbation) -> f64 {
        echo * (1.0 - change.ghost_for_echo) * self.constant[0]
            + (1.0 - echo) * (1.0 - change.ghost_for_none) * self.constant_for_none
    }

    /// One of the readings that [`SonarModel::log_likelihood`] tells of. `uniform` draws from 0 to 1.
    pub fn draw(&self, fan: &Fan, draw: &Draw, mut uniform: impl FnMut() -> f64) -> Option<f64> {
        let change = draw.change;
        let [low, high] = self.range_cm;
        let reach = fan[FAN_DEG.len() / 2].distance_cm.clamp(low + 10.0, high);
        let arrives = |i: &usize, uniform: &mut dyn FnMut() -> f64| {
            fan[*i].distance_cm.is_finite() && uniform() < self.back(&fan[*i], FAN_DEG[*i], change)
        };
        let first = nearest_first(fan).into_iter().find(|i| arrives(i, &mut uniform));
        let first = first.filter(|_| uniform() < (1.0 - change.lost) * (1.0 - self.lost));
        let (ghost, constant) = match first {
            Some(_) => (change.ghost_for_echo, self.constant[0]),
            None => (change.ghost_for_none, self.constant_for_none),
        };
        let mut reading = if uniform() < ghost {
            Some(change.ghost_cm)
        } else if uniform() < constant {
            Some(self.constant[1])
        } else {
            first.map(|i| {
                let scatter = if draw.scatters { self.scatter_cm(&fan[i], change) } else { 0.0 };
                self.middle_cm(&fan[i], change) + scatter * quantile(uniform())
            })
        };
        if uniform() < 1.0 - (1.0 - change.short) * (1.0 - self.short) {
            reading = Some(low + (reach - low) * uniform());
        }
        if reading.is_some() && uniform() < change.long {
            reading = Some(reach + (high - reach) * uniform());
        }
        let stale = draw.previous_cm.filter(|_| reading.is_some() && uniform() < change.stale);
        stale.or(reading).map(|cm| cm.clamp(low, high))
    }

    /// The reading to expect of an echo, cm; none where nothing is in reach.
    pub fn expected_cm(&self, fan: &Fan, change: &Perturbation) -> Option<f64> {
        let (mut none_yet, mut sum) = (1.0, 0.0);
        for i in nearest_first(fan) {
            let (ray, back) = (&fan[i], self.back(&fan[i], FAN_DEG[i], change));
            if ray.distance_cm.is_finite() {
                sum += none_yet * back * self.middle_cm(ray, change);
                none_yet *= 1.0 - back;
            }
        }
        (none_yet < 1.0).then(|| sum / (1.0 - none_yet))
    }

    /// The chance that a ray comes back.
    fn back(&self, ray: &Ray, offset_deg: f64, change: &Perturbation) -> f64 {
        let (metres, incidence) = (ray.distance_cm.min(FAR_CM) / 100.0, ray.alpha_deg / 45.0);
        let damping = change.damping + change.damping_per_m * metres + change.damping_per_incidence * incidence;
        let strength: f64 = ray_features(ray, offset_deg).iter().zip(&self.strength).map(|(f, w)| f * w).sum();
        logistic(strength - damping)
    }

    /// By how much the reading of a ray scatters, cm.
    fn scatter_cm(&self, ray: &Ray, change: &Perturbation) -> f64 {
        let (metres, incidence) = (ray.distance_cm.min(FAR_CM) / 100.0, ray.alpha_deg / 45.0);
        let own = libm::exp(self.log_scatter[0] + self.log_scatter[1] * metres + self.log_scatter[2] * incidence);
        (own * own + change.scatter_cm * change.scatter_cm).sqrt()
    }

    /// The reading that a ray gives, before scatter.
    fn middle_cm(&self, ray: &Ray, change: &Perturbation) -> f64 {
        let bias = self.bias[0] + self.bias[1] * ray.distance_cm + self.bias[2] * ray.alpha_deg / 45.0;
        let [low, high] = self.range_cm;
        ((ray.distance_cm + bias) * change.gain + change.offset_cm).clamp(low, high)
    }

    /// The chance that any ray comes back, and the density of the reading and of that.
    fn first_echo(&self, fan: &Fan, change: &Perturbation, echo_cm: Option<f64>) -> [f64; 2] {
        let (mut none_yet, mut density) = (1.0, 0.0);
        for i in nearest_first(fan) {
            let ray = &fan[i];
            if ray.distance_cm.is_infinite() {
                break;
            }
            let back = self.back(ray, FAN_DEG[i], change);
            if let Some(z) = echo_cm {
                density += none_yet * back * student(z - self.middle_cm(ray, change), self.scatter_cm(ray, change));
            }
            none_yet *= 1.0 - back;
        }
        [1.0 - none_yet, density]
    }
}

/// Places of a fan's rays in the order in which their echoes arrive.
fn nearest_first(fan: &Fan) -> [usize; FAN_DEG.len()] {
    let mut order = std::array::from_fn(|i| i);
    order.sort_by(|a: &usize, b| fan[*a].distance_cm.total_cmp(&fan[*b].distance_cm));
    order
}

/// What a ray's strength is made of.
pub fn ray_features(ray: &Ray, offset_deg: f64) -> [f64; STRENGTHS] {
    let x = ray.distance_cm.min(FAR_CM) / 100.0;
    let a = ray.alpha_deg / 45.0;
    let off = offset_deg / 15.0;
    [1.0, x, x * x, a, a * a, a * a * a, a * x, a * a * x, off * off, off.abs()]
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + libm::exp(-x))
}

/// Density of Student's law with five degrees of freedom.
fn student(x: f64, scale: f64) -> f64 {
    let t = x / scale;
    let base = 1.0 + t * t / 5.0;
    0.379_606_689_822_494_4 / (scale * base * base * base)
}

/// The quantile of Student's law with five degrees of freedom by the expansion of Cornish and Fisher.
fn quantile(uniform: f64) -> f64 {
    let p = uniform.clamp(1e-4, 1.0 - 1e-4);
    let z = normal_quantile(p);
    let (z3, z5) = (z * z * z, z * z * z * z * z);
    z + (z3 + z) / 20.0 + (5.0 * z5 + 16.0 * z3 + 3.0 * z) / 2400.0
}

/// The standard normal quantile (Hastings 1955, equation 26.2.23 in Abramowitz and Stegun), right to 0.0005.
fn normal_quantile(p: f64) -> f64 {
    let t = (-2.0 * libm::log(p.min(1.0 - p))).sqrt();
    let above = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    let below = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
    (t - above / below) * (p - 0.5).signum()
}

fn near(z_cm: f64, constant_cm: f64) -> f64 {
    student(z_cm - constant_cm, CONSTANT_SCATTER_CM)
}

#[cfg(test)]
mod tests {
    use rand::RngExt;

    use super::*;
    use crate::chance::generator;

    const SENSOR: SonarModel = SonarModel {
        strength: [2.0, -1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, -0.5, 0.0],
        bias: [1.0, 0.0, 0.0],
        log_scatter: [0.5, 0.0, 0.0],
        constant: [0.1, 20.0],
        constant_for_none: 0.2,
        short: 0.05,
        lost: 0.1,
        fan_width: 1.0,
        range_cm: [4.0, 240.0],
    };

    /// Draws follow the law that logs are judged by: the share of missing readings and of each range is as likely.
    #[test]
    fn drawn_readings_are_as_likely_as_they_come() {
        let ray = |i: usize| Ray { distance_cm: 90.0 + 8.0 * i as f64, alpha_deg: 10.0 * i as f64 };
        let fan: Fan = std::array::from_fn(ray);
        let change = Perturbation { ghost_for_echo: 0.2, ghost_cm: 55.0, gain: 1.1, long: 0.05, ..Perturbation::NONE };
        let draw = Draw { change: &change, previous_cm: None, scatters: true };
        let mut rng = generator(3, &[]);
        const DRAWS: usize = 40_000;
        let drawn: Vec<Option<f64>> = (0..DRAWS).map(|_| SENSOR.draw(&fan, &draw, || rng.random())).collect();
        let share =
            |holds: &dyn Fn(&Option<f64>) -> bool| drawn.iter().filter(|d| holds(d)).count() as f64 / DRAWS as f64;
        let likely = |z: Option<f64>| libm::exp(SENSOR.log_likelihood(&fan, &change, z, None)[0]);
        assert!((share(&|z| z.is_none()) - likely(None)).abs() < 0.01);
        for (from, to) in [(15.0, 25.0), (50.0, 60.0), (60.0, 90.0), (95.0, 110.0), (110.0, 150.0), (150.0, 230.0)] {
            let cells = 400;
            let width = (to - from) / f64::from(cells);
            let expected: f64 = (0..cells).map(|i| width * likely(Some(from + (f64::from(i) + 0.5) * width))).sum();
            let there = share(&|z| z.is_some_and(|z| (from..to).contains(&z)));
            assert!((there - expected).abs() < 0.015, "{from} to {to}: {there} drawn, {expected} likely");
        }
    }
}
