//! The sensor as its logs show it beyond the networks, for lanes of robots: a fan of rays, each of which comes back or
//! does not; the nearest that does gives the reading (see [`SonarModel`]).
//!
//! The networks know the axis alone, so what a real beam meets beside it is chance to them, drawn anew at each step.
//! Here it is a matter of where the robot stands. A controller that has to do well with both relies on neither's
//! weakness.

use mindgap_core::maths;
use mindgap_core::scalar::Scalar;
use pulp::Simd;

use super::draws::Draws;
use super::room::{Point, Room};
use super::scatter::LEVELS;
use crate::lanes::{Lanes, WIDEST};
use crate::sonar::{FAN_DEG, FAR_CM, STRENGTHS, SonarModel};

/// A sensor with a fan of rays.
#[derive(Clone, Debug)]
pub struct Beam {
    rays: [Ray; FAN_DEG.len()],
    bias: [f32; 3],
    /// Base-two logarithm of the scatter in cm: a constant, per metre, per 45 degrees.
    log2_scatter: [f32; 3],
    lost: f32,
    constant: [f32; 2],
    short: f32,
}

/// A ray of the fan.
#[derive(Clone, Copy, Debug)]
struct Ray {
    offset_deg: f32,
    cos: f32,
    sin: f32,
    /// Log-odds that it comes back, in base two: what depends on the offset alone, then the weights of distance (m), its
    /// square, incidence (45 degrees), its square, its cube, and two products of both.
    log2_odds: [f32; STRENGTHS - 2],
}

/// What came back to lanes of sensors.
pub struct Heard<S: Simd> {
    /// Of the reading's middle, cm; infinite where nothing came back.
    pub reading_cm: Lanes<S>,
    /// Its scatter, cm.
    pub scatter_cm: Lanes<S>,
}

/// Equally likely draws from Student's law with five degrees of freedom.
const STUDENT: [f32; LEVELS] = [
    -2.9674, -2.0657, -1.6677, -1.4059, -1.2075, -1.0453, -0.9065, -0.7836, -0.6722, -0.5693, -0.4728, -0.3812,
    -0.2931, -0.2076, -0.1239, -0.0412, 0.0412, 0.1239, 0.2076, 0.2931, 0.3812, 0.4728, 0.5693, 0.6722, 0.7836, 0.9065,
    1.0453, 1.2075, 1.4059, 1.6677, 2.0657, 2.9674,
];

impl Beam {
    /// The sensor that a reference describes.
    pub fn new(reference: &SonarModel) -> Self {
        let log2_e = std::f64::consts::LOG2_E;
        let [level, x, xx, a, aa, aaa, ax, aax, square, size] = reference.strength.map(|w| w * log2_e);
        let ray = |deg: f64| {
            let (offset_deg, off) = (deg * reference.fan_width, deg / 15.0);
            let middle = level + square * off * off + size * off.abs();
            Ray {
                offset_deg: offset_deg as f32,
                cos: libm::cos(offset_deg.to_radians()) as f32,
                sin: libm::sin(offset_deg.to_radians()) as f32,
                log2_odds: [middle, x, xx, a, aa, aaa, ax, aax].map(|w| w as f32),
            }
        };
        Beam {
            rays: FAN_DEG.map(ray),
            bias: reference.bias.map(|b| b as f32),
            log2_scatter: reference.log_scatter.map(|w| (w * log2_e) as f32),
            lost: reference.lost as f32,
            constant: reference.constant.map(|c| c as f32),
            short: reference.short as f32,
        }
    }

    /// Sends rays from `origin` about the unit vector `axis`, which points to `axis_deg`.
    #[inline(always)]
    pub fn hear<S: Simd>(
        &self,
        room: &Room,
        origin: Point<S>,
        axis: Point<S>,
        axis_deg: Lanes<S>,
        draws: &mut Draws<S>,
    ) -> Heard<S> {
        let infinite = axis_deg.constant(f32::INFINITY);
        let (mut nearest_cm, mut incidence) = (infinite, axis_deg.zero());
        for ray in &self.rays {
            let (c, s) = (axis_deg.constant(ray.cos), axis_deg.constant(ray.sin));
            let way = Point { x: axis.x * c - axis.y * s, y: axis.y * c + axis.x * s };
            let met = room.cast(origin, way, axis_deg + axis_deg.constant(ray.offset_deg));
            let a = met.alpha_deg * met.alpha_deg.constant(1.0 / 45.0);
            let odds = maths::exp2_within(ray.log2_odds(met.distance_cm, a));
            let draw = draws.uniform();
            // The chance is odds / (1 + odds).
            let back = (draw + draw * odds).less(odds) & met.distance_cm.less(nearest_cm);
            nearest_cm = back.select(met.distance_cm, nearest_cm);
            incidence = back.select(a, incidence);
        }
        let affine = |w: [f32; 3], x: Lanes<S>| x.constant(w[0]) + x * x.constant(w[1]) + incidence * x.constant(w[2]);
        let metres = nearest_cm.min(infinite.constant(FAR_CM as f32)) * infinite.constant(0.01);
        Heard {
            reading_cm: nearest_cm + affine(self.bias, nearest_cm),
            scatter_cm: maths::exp2(affine(self.log2_scatter, metres)),
        }
    }

    /// What sensors report for what they heard, NaN where they report nothing: `fate` is a uniform draw from [0, 1),
    /// `levels` are below [`LEVELS`].
    #[inline(always)]
    pub fn report<S: Simd>(&self, simd: S, heard: &Heard<S>, fate: Lanes<S>, levels: &[usize; WIDEST]) -> Lanes<S> {
        let (mut shares, mut student) = ([0.0; WIDEST], [0.0; WIDEST]);
        for lane in 0..Lanes::<S>::WIDTH {
            shares[lane] = levels[lane] as f32 / LEVELS as f32;
            student[lane] = STUDENT[levels[lane] % LEVELS];
        }
        let (shares, student) = (Lanes::load(simd, &shares), Lanes::load(simd, &student));
        let [short, lost, constant] = [self.short, self.short + self.lost, self.short + self.lost + self.constant[0]]
            .map(|chance| fate.constant(chance));
        let (nothing, constant_cm) = (fate.constant(f32::NAN), fate.constant(self.constant[1]));
        let middle_cm = heard.reading_cm;
        let back = middle_cm.less(fate.constant(f32::INFINITY));
        let usual_cm = fate.less(constant).select(constant_cm, middle_cm + heard.scatter_cm * student);
        let whole_cm = (back & !fate.less(lost)).select(usual_cm, nothing);
        let short_cm = back.select(middle_cm * shares, constant_cm);
        fate.less(short).select(short_cm, whole_cm)
    }
}

impl Ray {
    #[inline(always)]
    fn log2_odds<S: Simd>(&self, distance_cm: Lanes<S>, a: Lanes<S>) -> Lanes<S> {
        let x = distance_cm.min(a.constant(FAR_CM as f32)) * a.constant(0.01);
        let [middle, by_x, by_xx, by_a, by_aa, by_aaa, by_ax, by_aax] = self.log2_odds.map(|w| a.constant(w));
        let of_distance = middle + x * (by_x + x * by_xx);
        let of_incidence = a * (by_a + x * by_ax + a * (by_aa + x * by_aax + a * by_aaa));
        let odds = of_distance + of_incidence;
        odds.clamp(odds.constant(-100.0), odds.constant(100.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Pose, Rectangle};
    use crate::logs::Scene;
    use crate::simulator::draws::Seeds;
    use crate::sonar::{Perturbation, fan_at};
    use glam::DVec2;
    use pulp::Scalar as One;

    const REFERENCE: SonarModel = SonarModel {
        strength: [1.0, 2.0, -2.0, 1.0, -1.0, -0.5, -1.0, -0.5, -1.0, -0.5],
        bias: [-0.3, 0.01, -0.3],
        log_scatter: [-0.5, 0.2, 0.8],
        constant: [0.0, 20.0],
        constant_for_none: 0.0,
        short: 0.0,
        lost: 0.1,
        fan_width: 0.9,
        range_cm: [4.0, 240.0],
    };

    #[test]
    fn echoes_come_as_often_as_the_reference_says() {
        let obstacles = vec![Rectangle { low_cm: DVec2::new(110.0, 60.0), high_cm: DVec2::new(140.0, 90.0) }];
        let scene = Scene { arena_cm: Some(DVec2::new(300.0, 220.0)), obstacles, ..Scene::default() };
        let (room, beam, simd) = (Room::new(&scene), Beam::new(&REFERENCE), One::new());
        let mut seeds = Seeds::default();
        seeds.set(0, 9);
        let mut draws = Draws::load(simd, &seeds);
        let lane = |value: f64| Lanes::splat(simd, value as f32);
        for (x, y, deg) in [(40.0, 70.0, 0.0), (40.0, 70.0, 14.0), (200.0, 100.0, 70.0), (100.0, 100.0, -150.0)] {
            let heading = f64::to_radians(deg);
            let (origin, axis) =
                (Point { x: lane(x), y: lane(y) }, Point { x: lane(libm::cos(heading)), y: lane(libm::sin(heading)) });
            let (mut echoes, mut nearest_cm) = (0, f32::INFINITY);
            for _ in 0..4000 {
                let heard = beam.hear(&room, origin, axis, lane(deg), &mut draws);
                let echo = number(beam.report(simd, &heard, draws.uniform(), &[LEVELS / 2; WIDEST]));
                echoes += u32::from(!echo.is_nan());
                nearest_cm = nearest_cm.min(echo);
            }
            let fan = fan_at(&scene.sides(), &Pose::new(x, y, heading), REFERENCE.fan_width);
            let [none, _] = REFERENCE.log_likelihood(&fan, &Perturbation::NONE, None, None);
            let (found, expected) = (f64::from(echoes) / 4000.0, 1.0 - libm::exp(none));
            assert!((found - expected).abs() < 0.03, "at {x} {y} {deg}: {found} {expected}");
            let nearest_ray_cm = fan.iter().map(|ray| ray.distance_cm).fold(f64::INFINITY, f64::min);
            assert!(f64::from(nearest_cm) > nearest_ray_cm - 2.0, "at {x} {y} {deg}: {nearest_cm}");
        }
    }

    #[test]
    fn what_is_lost_constant_or_short_comes_with_its_chance() {
        let beam = Beam::new(&SonarModel { constant: [0.2, 20.0], short: 0.1, ..REFERENCE });
        let simd = One::new();
        let report = |reading_cm, scatter_cm, fate, level| {
            let lane = |value| Lanes::splat(simd, value);
            let heard = Heard { reading_cm: lane(reading_cm), scatter_cm: lane(scatter_cm) };
            number(beam.report(simd, &heard, lane(fate), &[level; WIDEST]))
        };
        assert_eq!(report(100.0, 0.0, 0.05, LEVELS / 2), 50.0);
        assert_eq!(report(f32::INFINITY, 0.0, 0.05, 0), 20.0);
        assert!(report(100.0, 0.0, 0.15, 0).is_nan());
        assert_eq!(report(100.0, 0.0, 0.3, 0), 20.0);
        assert_eq!(report(100.0, 2.0, 0.9, LEVELS - 1), 100.0 + 2.0 * STUDENT[LEVELS - 1]);
        assert!(report(f32::INFINITY, 1.0, 0.9, 3).is_nan());
    }

    fn number(lane: Lanes<One>) -> f32 {
        let mut number = [0.0];
        lane.store(&mut number);
        number[0]
    }
}
