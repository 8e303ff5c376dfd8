//! The law that a sensor follows, and the view of a room that it depends on.

use super::echo_law::{Surfaces, Target, reach_cm, targets_at};
use super::{Fan, FirstEchoLaw, Outcomes, Perturbation, SonarModel, fan_at};
use mindgap_foundations::geometry::Pose;

/// The law of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub enum SensorLaw {
    /// A fan of rays, each of which returns or does not.
    Beam(SonarModel),
    /// The first echo that rises above a threshold.
    FirstEcho(FirstEchoLaw),
}

/// The part of a room that a law depends on, from a pose.
#[derive(Clone, Debug, PartialEq)]
pub enum View {
    /// The paths of the rays of a beam.
    Fan(Fan),
    /// The targets of the first-echo law.
    Targets {
        /// Targets, nearest first, each with the strength of its echo if it were on the axis.
        targets: Vec<(Target, f64)>,
        /// Distance to the first wall on the axis, cm; infinite if there is none.
        reach_cm: f64,
    },
}

impl SensorLaw {
    /// Returns the view of a sensor at a pose whose beam is `width` times as wide as in the law. The view of the first-echo
    /// law does not depend on the width.
    pub fn view(&self, surfaces: &Surfaces, sensor: &Pose, width: f64) -> View {
        match self {
            SensorLaw::Beam(model) => View::Fan(fan_at(surfaces.walls(), sensor, model.fan_width * width)),
            SensorLaw::FirstEcho(law) => {
                let targets = targets_at(surfaces, sensor).into_iter();
                let targets = targets.map(|target| (target, law.on_axis(&target))).collect();
                View::Targets { targets, reach_cm: reach_cm(surfaces, sensor) }
            }
        }
    }

    /// Returns the outcomes of a reading of a view that this law made.
    pub fn outcomes(&self, view: &View, change: &Perturbation) -> Outcomes {
        match (self, view) {
            (SensorLaw::Beam(model), View::Fan(fan)) => model.outcomes(fan, change),
            (SensorLaw::FirstEcho(law), View::Targets { targets, reach_cm }) => {
                law.outcomes_of(targets.iter().map(|(target, on_axis)| (target, *on_axis)), *reach_cm, change)
            }
            _ => unreachable!("a view is shown to the law that made it"),
        }
    }

    /// Returns the outcomes of a reading of a sensor at a pose.
    pub fn outcomes_at(&self, surfaces: &Surfaces, sensor: &Pose) -> Outcomes {
        self.outcomes(&self.view(surfaces, sensor, 1.0), &Perturbation::NONE)
    }

    /// Returns whether the view depends on the width of the beam.
    pub fn looks_by_width(&self) -> bool {
        matches!(self, SensorLaw::Beam(_))
    }

    /// Returns whether it is the textbook's ideal ray.
    pub fn is_ray(&self) -> bool {
        matches!(self, SensorLaw::FirstEcho(law) if law.is_ray())
    }

    /// Returns the least and largest reading, cm.
    pub fn range_cm(&self) -> [f64; 2] {
        match self {
            SensorLaw::Beam(model) => model.range_cm,
            SensorLaw::FirstEcho(law) => law.range_cm,
        }
    }
}
