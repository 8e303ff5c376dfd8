//! The sensor as its logs show it beyond the networks, for lanes of robots: a fan of rays, each of which comes back or
//! does not; the nearest that does gives the reading (see [`SonarModel`]).
//!
//! The networks know the axis alone, so what a real beam meets off axis is noise to them, drawn independently at each step.
//! Here it follows from where the robot stands.
//!
//! The probabilities are those of [`Outcomes`](crate::sonar::Outcomes). A lane does not work out all candidates: it
//! draws whether each ray comes back and keeps the nearest, then one draw falls to an outcome by the [`MixingWeights`].

use mindgap_core::maths;
use mindgap_core::scalar::Scalar;
use pulp::Simd;

use super::draws::Draws;
use super::residuals::LEVELS;
use super::room::{Point, Room};
use crate::effects::SensorState;
use crate::sonar::fan::{AXIS, BEFORE_WALL_CM, DIRECT, FAN_DEG, MIRRORED};
use crate::sonar::model::{CONSTANT_SCATTER_CM, FAR_CM, STRENGTHS};
use crate::sonar::perturbation::ROUNDED_BY_CM;
use crate::sonar::{MixingWeights, Perturbation, SonarModel};
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::lanes::{Lanes, WIDEST};
use mindgap_foundations::statistics::student;

/// A sensor with a fan of rays.
#[derive(Clone, Debug)]
pub struct Beam {
    rays: [Ray; DIRECT],
    /// Log-odds that a mirrored ray loses, in base two.
    log2_mirror_loss: Option<f32>,
    bias: [f32; 3],
    /// Base-two logarithm of the scatter in cm: a constant, per metre, per 45 degrees.
    log2_scatter: [f32; 3],
    /// Scatter in cm beside that. Hits that it leads beyond the range are not reported,
    added_scatter_cm: f32,
    /// and none beyond an end of the range that the gain and the offset lead beyond it.
    leads_ends_beyond: [bool; 2],
    /// Between what the middles of hits lie, cm.
    middle_bounds_cm: [f32; 2],
    /// Factor on the readings of echoes.
    gain: f32,
    /// Added to them after that, cm.
    offset_cm: f32,
    /// Of an echo that arrives, and of none.
    thresholds: [Thresholds; 2],
    /// The same where the reading before was none, if that matters.
    thresholds_after_none: Option<[Thresholds; 2]>,
    constant_cm: f32,
    ghost_cm: f32,
    range_cm: [f32; 2],
    reach_bounds_cm: [f32; 2],
    /// Equally likely draws from Student's distribution.
    student: [f32; LEVELS],
}

/// Upper ends of the outcomes on one uniform draw, in this order; above them there is no reading.
#[derive(Clone, Copy, Debug)]
struct Thresholds {
    short: f32,
    stray: f32,
    long: f32,
    constant: f32,
    ghost: f32,
    hit: f32,
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

/// The first echo of those heard so far.
struct Nearest<S: Simd> {
    /// Infinite before the first.
    distance_cm: Lanes<S>,
    /// In units of 45 degrees.
    incidence: Lanes<S>,
}

/// What came back to lanes of sensors.
pub struct Heard<S: Simd> {
    /// Middle of the first echo's reading, cm; infinite where nothing came back.
    pub reading_cm: Lanes<S>,
    /// Its scale, cm.
    pub scatter_cm: Lanes<S>,
    /// Distance along the axis, cm; infinite where there is nothing.
    pub axis_cm: Lanes<S>,
}

/// What decides about the reports of lanes of sensors, beside what they heard.
pub struct Fate<S: Simd> {
    /// Chooses the outcome: a uniform draw from [0, 1).
    pub outcome: Lanes<S>,
    /// The place within an interval: a uniform draw from [0, 1).
    pub place: Lanes<S>,
    /// Scatter about a value, in scales: a draw of [`Beam::scatter`].
    pub student: Lanes<S>,
    /// The reading before, cm: not a number where there was none.
    pub before_cm: Lanes<S>,
}

impl Beam {
    /// The sensor that a reference describes.
    pub fn new(reference: &SonarModel) -> Self {
        Self::of(reference, &SensorState::nominal(Pose::new(0.0, 0.0, 0.0)))
    }

    /// The same as effects leave it after an echo and after none, if these differ only in the probabilities of outcomes, and
    /// what rays lose by distance and incidence keeps its form. A beam that meets the floor does not.
    pub fn changed(reference: &SonarModel, [after_echo, after_none]: &[SensorState; 2]) -> Option<Self> {
        let Perturbation { p_dropout, p_ghost_given_echo, p_ghost_given_none, p_short, p_long, .. } =
            after_echo.perturbation;
        let p_long_given_none = after_echo.perturbation.p_long_given_none;
        let otherwise = SensorState {
            perturbation: Perturbation {
                p_dropout,
                p_ghost_given_echo,
                p_ghost_given_none,
                p_short,
                p_long,
                p_long_given_none,
                ..after_none.perturbation
            },
            ..*after_none
        };
        let thresholds = |after: &SensorState| Thresholds::both(reference, &after.perturbation);
        let matters = after_none != after_echo;
        let keeps_rays = !after_echo.perturbation.shapes_losses() && !after_echo.perturbation.meets_floor();
        let is_known = otherwise == *after_echo && keeps_rays;
        is_known.then(|| Beam {
            thresholds_after_none: matters.then(|| thresholds(after_none)),
            ..Self::of(reference, after_echo)
        })
    }

    fn of(reference: &SonarModel, state: &SensorState) -> Self {
        let log2_e = std::f64::consts::LOG2_E;
        let SensorState { yaw_rad, perturbation, .. } = state;
        let Perturbation { width, attenuation, attenuation_per_m, attenuation_per_incidence, .. } = perturbation;
        let mut strength = reference.strength;
        strength[0] -= attenuation;
        strength[1] -= attenuation_per_m;
        strength[3] -= attenuation_per_incidence;
        let [level, x, xx, a, aa, aaa, ax, aax, square, size] = strength.map(|w| w * log2_e);
        let ray = |deg: f64| {
            let (offset_deg, off) = (deg * reference.fan_width * width + yaw_rad.to_degrees(), deg / 15.0);
            let middle = level + square * off * off + size * off.abs();
            Ray {
                offset_deg: offset_deg as f32,
                cos: libm::cos(offset_deg.to_radians()) as f32,
                sin: libm::sin(offset_deg.to_radians()) as f32,
                log2_odds: [middle, x, xx, a, aa, aaa, ax, aax].map(|w| w as f32),
            }
        };
        Beam {
            rays: std::array::from_fn(|place| ray(FAN_DEG[place])),
            log2_mirror_loss: reference
                .mirror_loss
                .map(|loss| ((loss + perturbation.attenuation_mirrored) * log2_e) as f32),
            bias: reference.bias.map(|b| b as f32),
            log2_scatter: reference.log_scatter.map(|w| (w * log2_e) as f32),
            added_scatter_cm: perturbation.scatter_cm as f32,
            leads_ends_beyond: perturbation.leads_ends_beyond(reference.range_cm),
            middle_bounds_cm: perturbation.middle_bounds_cm(reference.range_cm).map(|cm| cm as f32),
            gain: perturbation.gain as f32,
            offset_cm: perturbation.offset_cm as f32,
            thresholds: Thresholds::both(reference, perturbation),
            thresholds_after_none: None,
            constant_cm: perturbation.reading_cm(reference.constant[1]) as f32,
            ghost_cm: perturbation.ghost_cm as f32,
            range_cm: reference.range_cm.map(|cm| cm as f32),
            reach_bounds_cm: reference.reach_bounds_cm().map(|cm| cm as f32),
            student: std::array::from_fn(|level| student::quantile((level as f64 + 0.5) / LEVELS as f64) as f32),
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
        let mut nearest = Nearest { distance_cm: infinite, incidence: axis_deg.zero() };
        let mut axis_cm = infinite;
        for (place, ray) in self.rays.iter().enumerate() {
            let (c, s) = (axis_deg.constant(ray.cos), axis_deg.constant(ray.sin));
            let way = Point { x: axis.x * c - axis.y * s, y: axis.y * c + axis.x * s };
            let way_deg = axis_deg + axis_deg.constant(ray.offset_deg);
            let met = room.cast(origin, way, way_deg);
            if place == AXIS {
                axis_cm = met.distance_cm;
            }
            nearest.hear(ray, met.distance_cm, met.alpha_deg, 0.0, draws.uniform());
            if let Some(log2_loss) = self.log2_mirror_loss
                && MIRRORED.contains(&place)
            {
                let first_cm = met.distance_cm - met.distance_cm.constant(BEFORE_WALL_CM as f32);
                let at = Point { x: origin.x + way.x * first_cm, y: origin.y + way.y * first_cm };
                // Where nothing is met this is not a number, and nothing is heard.
                let on_deg = met.normal_deg + met.normal_deg - way_deg + way_deg.constant(180.0);
                let half_turns = on_deg * on_deg.constant(1.0 / 180.0);
                let on = Point { x: maths::cos_pi(half_turns), y: maths::sin_pi(half_turns) };
                let second = room.cast(at, on, on_deg);
                nearest.hear(ray, first_cm + second.distance_cm, second.alpha_deg, log2_loss, draws.uniform());
            }
        }
        let Nearest { distance_cm: nearest_cm, incidence } = nearest;
        let affine = |w: [f32; 3], x: Lanes<S>| x.constant(w[0]) + x * x.constant(w[1]) + incidence * x.constant(w[2]);
        let metres = nearest_cm.min(infinite.constant(FAR_CM as f32)) * infinite.constant(0.01);
        let echo_cm = nearest_cm + affine(self.bias, nearest_cm);
        let own_cm = maths::exp2(affine(self.log2_scatter, metres));
        let added_cm = own_cm.constant(self.added_scatter_cm);
        Heard {
            reading_cm: echo_cm * echo_cm.constant(self.gain) + echo_cm.constant(self.offset_cm),
            scatter_cm: if self.added_scatter_cm > 0.0 {
                (own_cm * own_cm + added_cm * added_cm).sqrt()
            } else {
                own_cm
            },
            axis_cm,
        }
    }

    /// Scatter of sensors in scales, for levels below [`LEVELS`].
    #[inline(always)]
    pub fn scatter<S: Simd>(&self, simd: S, levels: &[usize; WIDEST]) -> Lanes<S> {
        Lanes::load(simd, &levels.map(|level| self.student[level % LEVELS]))
    }

    /// What sensors report for what they heard, NaN where they report nothing; beyond their range too, where a scatter
    /// leads there.
    #[inline(always)]
    pub fn report<S: Simd>(&self, heard: &Heard<S>, fate: &Fate<S>) -> Lanes<S> {
        let lane = |value| fate.outcome.constant(value);
        let arrives = heard.reading_cm.less(lane(f32::INFINITY));
        let below = |threshold: fn(&Thresholds) -> f32| {
            let of =
                |[heard, silent]: &[Thresholds; 2]| arrives.select(lane(threshold(heard)), lane(threshold(silent)));
            let usual = of(&self.thresholds);
            fate.outcome.less(match &self.thresholds_after_none {
                Some(after_none) => fate.before_cm.less(lane(f32::INFINITY)).select(usual, of(after_none)),
                None => usual,
            })
        };
        let [low, high] = self.range_cm;
        let within = |high_cm: Lanes<S>| lane(low) + (high_cm - lane(low)) * fate.place;
        let [least, most] = self.reach_bounds_cm;
        let reach_cm = heard.axis_cm.clamp(lane(least), lane(most));
        let long_cm = reach_cm + (lane(high) - reach_cm) * fate.place;
        let about = |value_cm: f32| lane(value_cm) + lane(CONSTANT_SCATTER_CM as f32) * fate.student;
        let [below_is_lost, above_is_lost] = self.leads_ends_beyond;
        let [least_cm, most_cm] = self.middle_bounds_cm;
        let middle_cm = heard.reading_cm.clamp(lane(least_cm), lane(most_cm));
        let scattered_cm = middle_cm + heard.scatter_cm * fate.student;
        let mut hit_cm = scattered_cm;
        if self.added_scatter_cm > 0.0 || below_is_lost || above_is_lost {
            let led_cm = middle_cm + lane(self.added_scatter_cm) * fate.student;
            let led = |is_lost: bool| if is_lost { scattered_cm } else { led_cm };
            let rounded_by_cm = ROUNDED_BY_CM as f32;
            let below = led(below_is_lost).less(lane(low - rounded_by_cm));
            let above = lane(high + rounded_by_cm).less(led(above_is_lost));
            hit_cm = (below | above).select(lane(f32::NAN), hit_cm);
        }
        let echo_cm = below(|t| t.hit).select(hit_cm, lane(f32::NAN));
        let echo_cm = below(|t| t.ghost).select(about(self.ghost_cm), echo_cm);
        let echo_cm = below(|t| t.constant).select(about(self.constant_cm), echo_cm);
        let echo_cm = below(|t| t.long).select(long_cm, echo_cm);
        let echo_cm = below(|t| t.stray).select(within(lane(high)), echo_cm);
        below(|t| t.short).select(within(reach_cm), echo_cm)
    }
}

impl Thresholds {
    /// Of an echo that arrives, and of none.
    fn both(reference: &SonarModel, perturbation: &Perturbation) -> [Self; 2] {
        [true, false].map(|arrives| {
            let weights = MixingWeights::new(reference, perturbation, arrives);
            let mut end = 0.0;
            let mut next = |weight: f64| {
                end += weight;
                end as f32
            };
            Thresholds {
                short: next(weights.short),
                stray: next(weights.stray),
                long: next(weights.long),
                constant: next(weights.constant),
                ghost: next(weights.ghost),
                hit: next(weights.hit),
            }
        })
    }
}

impl<S: Simd> Nearest<S> {
    /// A method and no closure: what is not inlined is compiled without the processor's wide instructions.
    #[inline(always)]
    fn hear(&mut self, ray: &Ray, distance_cm: Lanes<S>, alpha_deg: Lanes<S>, log2_loss: f32, draw: Lanes<S>) {
        let a = alpha_deg * alpha_deg.constant(1.0 / 45.0);
        let odds = maths::exp2_within(ray.log2_odds(distance_cm, a, log2_loss));
        // The chance is odds / (1 + odds).
        let back = (draw + draw * odds).less(odds) & distance_cm.less(self.distance_cm);
        self.distance_cm = back.select(distance_cm, self.distance_cm);
        self.incidence = back.select(a, self.incidence);
    }
}

impl Ray {
    #[inline(always)]
    fn log2_odds<S: Simd>(&self, distance_cm: Lanes<S>, a: Lanes<S>, log2_loss: f32) -> Lanes<S> {
        let x = distance_cm.min(a.constant(FAR_CM as f32)) * a.constant(0.01);
        let [middle, by_x, by_xx, by_a, by_aa, by_aaa, by_ax, by_aax] = self.log2_odds.map(|w| a.constant(w));
        let of_distance = middle - a.constant(log2_loss) + x * (by_x + x * by_xx);
        let of_incidence = a * (by_a + x * by_ax + a * (by_aa + x * by_aax + a * by_aaa));
        let odds = of_distance + of_incidence;
        odds.clamp(odds.constant(-100.0), odds.constant(100.0))
    }
}

#[cfg(test)]
mod tests;
