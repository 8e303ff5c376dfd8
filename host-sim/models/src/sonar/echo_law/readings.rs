//! The outcomes of a reading by the first-echo law.

use super::targets::{Target, TargetKind};
use super::{FirstEchoLaw, Surfaces, targets_at};
use crate::sonar::Perturbation;
use crate::sonar::model::{CONSTANT_SCATTER_CM, reach_bounds_cm};
use crate::sonar::outcomes::{Component, Distribution, Outcomes, Source};
use crate::sonar::perturbation::loss_by_incidence;
use mindgap_foundations::geometry::{Pose, first_hit};
use mindgap_foundations::statistics::summary::logistic;

/// Initial capacity for echoes, with ghost and stray readings: nearer and stronger targets mask most others.
const USUALLY_HEARD: usize = 16;

/// Direct echoes.
struct Direct {
    /// The echoes, nearest first.
    components: Vec<Component>,
    /// Probability that one of them is heard.
    heard: f64,
    /// Probability that one is heard that reads less than the ghost.
    heard_before_ghost: f64,
}

impl FirstEchoLaw {
    /// Returns the outcomes of a reading of a sensor at a pose.
    pub fn outcomes_at(&self, surfaces: &Surfaces, sensor: &Pose) -> Outcomes {
        self.outcomes(&targets_at(surfaces, sensor), reach_cm(surfaces, sensor), &Perturbation::NONE)
    }

    /// Returns the outcomes of a reading of targets, nearest first, by a perturbed sensor; `reach_cm` is the distance along
    /// the axis.
    pub fn outcomes(&self, targets: &[Target], reach_cm: f64, change: &Perturbation) -> Outcomes {
        let echoes = targets.iter().map(|target| (target, self.on_axis(target)));
        self.outcomes_of(echoes, reach_cm, change)
    }

    /// As [`outcomes`](Self::outcomes), each target with the strength that it would have on the axis.
    pub fn outcomes_of<'t>(
        &self,
        echoes: impl Iterator<Item = (&'t Target, f64)>,
        reach_cm: f64,
        change: &Perturbation,
    ) -> Outcomes {
        let known = 1.0 - self.p_stray;
        let Direct { mut components, heard, heard_before_ghost } = self.direct(echoes, change);
        components.iter_mut().for_each(|echo| echo.probability *= known);
        let ghost = self.p_ghost * (1.0 - heard_before_ghost);
        let silent = (1.0 - self.p_ghost) * (1.0 - heard);
        let other = silent * self.p_other;
        let [low_cm, high_cm] = self.range_cm;
        let [least_cm, most_cm] = reach_bounds_cm(self.range_cm);
        let reach_cm = reach_cm.clamp(least_cm, most_cm);
        let between = |low_cm, high_cm| Distribution::Uniform { low_cm, high_cm };
        let about_ghost =
            Distribution::Student { middle_cm: change.reading_cm(self.ghost_cm), scale_cm: CONSTANT_SCATTER_CM };
        let others = [
            (Source::Ghost, known * ghost, about_ghost),
            (Source::Long, known * other * self.p_long_given_other, between(reach_cm, high_cm)),
            (Source::Short, known * other * (1.0 - self.p_long_given_other), between(low_cm, reach_cm)),
            (Source::Stray, 0.5 * self.p_stray, between(low_cm, high_cm)),
        ];
        let others = others.map(|(source, probability, distribution)| Component { source, probability, distribution });
        components.extend(others);
        let none = known * (silent - other) + 0.5 * self.p_stray;
        let outcomes = Outcomes { none, components, range_cm: self.range_cm }.with_faults(change, reach_cm);
        outcomes.without_hits_led_beyond_range(change).above_floor(change, reach_cm)
    }

    /// Returns the direct echoes of targets, without stray readings.
    fn direct<'t>(&self, echoes: impl Iterator<Item = (&'t Target, f64)>, change: &Perturbation) -> Direct {
        let log_width_deg = libm::log(self.beam_deg * change.width);
        let mut components = Vec::with_capacity(USUALLY_HEARD);
        let (mut loudest, mut heard, mut heard_before_ghost) = (f64::NEG_INFINITY, 0.0, None);
        for (target, on_axis) in echoes {
            let lost = change.loss(target.distance_cm / 100.0, incidence_deg(target) / 45.0);
            let on_axis = on_axis - lost;
            if on_axis <= loudest {
                continue;
            }
            let strength = on_axis - self.beam_loss(target, log_width_deg);
            if strength <= loudest {
                continue;
            }
            loudest = strength;
            let heard_before = heard;
            heard = (1.0 - self.p_dropout) * (1.0 - change.p_dropout) * logistic(loudest);
            let off_axis = target.off_axis_deg / change.width / 10.0;
            let middle_cm = change.middle_cm(self.direct_cm(target, off_axis), self.range_cm);
            let scale_cm = libm::hypot(self.scale_cm(target, off_axis), change.scatter_cm);
            if middle_cm >= change.reading_cm(self.ghost_cm) {
                heard_before_ghost.get_or_insert(heard_before);
            }
            let not_ghost = if heard_before_ghost.is_some() { 1.0 - self.p_ghost } else { 1.0 };
            components.push(Component {
                source: Source::Hit,
                probability: not_ghost * (heard - heard_before),
                distribution: Distribution::Student { middle_cm, scale_cm },
            });
        }
        Direct { components, heard, heard_before_ghost: heard_before_ghost.unwrap_or(heard) }
    }

    /// Returns the strength of a target's echo, in units of the threshold's noise.
    pub fn strength(&self, target: &Target) -> f64 {
        self.on_axis(target) - self.beam_loss(target, libm::log(self.beam_deg))
    }

    /// Returns the strength that a target would have on the axis.
    pub fn on_axis(&self, target: &Target) -> f64 {
        let kind = match target.kind {
            TargetKind::Ray { incidence_deg } => {
                -loss_by_incidence(incidence_deg, self.specular_deg, self.oblique_loss)
            }
            TargetKind::Foot => 0.0,
            TargetKind::Corner => self.corner,
            TargetKind::Edge => self.edge,
        };
        self.gain - self.spreading * target.known.log_metres + kind
    }

    /// Returns the loss of a target off the axis, for a beam with this logarithm of its width in degrees.
    fn beam_loss(&self, target: &Target, log_width_deg: f64) -> f64 {
        libm::exp(self.beam_power * (target.known.log_off_axis - log_width_deg))
    }

    /// Returns the reading of a target before scatter, cm, at an angle off the axis in units of 10 degrees.
    fn direct_cm(&self, target: &Target, off_axis: f64) -> f64 {
        self.offset_cm + self.scale * target.distance_cm + self.off_axis_cm * off_axis * off_axis
    }

    /// Returns the scale of a target's readings, cm.
    fn scale_cm(&self, target: &Target, off_axis: f64) -> f64 {
        let growth = self.scatter_per_m * target.distance_cm / 100.0 + self.scatter_off_axis * off_axis;
        let own = self.scatter_cm * libm::exp(growth);
        let between = target.known.between_cm;
        (own * own + between * between).sqrt()
    }
}

/// Returns the incidence of a target, degrees; 0 for points.
fn incidence_deg(target: &Target) -> f64 {
    target.kind.incidence_deg().unwrap_or(0.0)
}

/// Returns the distance along the axis to the first wall, cm; infinite if there is none.
pub fn reach_cm(surfaces: &Surfaces, sensor: &Pose) -> f64 {
    first_hit(&surfaces.walls, sensor.position_cm, sensor.direction()).map_or(f64::INFINITY, |(met_cm, _)| met_cm)
}
