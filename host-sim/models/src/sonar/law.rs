//! The law that a sensor follows, whichever that is, and what the law looks at from a pose.

use super::echo_law::{Surfaces, Target, reach_cm, targets_at};
use super::{Fan, FirstEchoLaw, Outcomes, Perturbation, SonarModel, fan_at};
use mindgap_foundations::geometry::Pose;

/// The law of a sensor.
#[derive(Clone, Debug, PartialEq)]
pub enum SensorLaw {
    /// A fan of rays, each of which comes back or does not.
    Beam(SonarModel),
    /// The first echo that rises above a threshold.
    FirstEcho(FirstEchoLaw),
}

/// What a law looks at from a pose.
#[derive(Clone, Debug, PartialEq)]
pub enum View {
    /// What the rays of a beam meet.
    Fan(Fan),
    /// What can return an echo.
    Targets {
        /// Nearest first, each with the strength of its echo if it stood on the axis.
        targets: Vec<(Target, f64)>,
        /// How far the axis reaches, cm; infinite where it meets nothing.
        reach_cm: f64,
    },
}

impl SensorLaw {
    /// What a sensor at a pose looks at if its beam is so much wider than the law says; the first-echo law looks at the same
    /// whatever its width.
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

    /// What it may report of a view that it made.
    pub fn outcomes(&self, view: &View, change: &Perturbation) -> Outcomes {
        match (self, view) {
            (SensorLaw::Beam(model), View::Fan(fan)) => model.outcomes(fan, change),
            (SensorLaw::FirstEcho(law), View::Targets { targets, reach_cm }) => {
                law.outcomes_of(targets.iter().map(|(target, on_axis)| (target, *on_axis)), *reach_cm, change)
            }
            _ => unreachable!("a view is shown to the law that made it"),
        }
    }

    /// What a sensor at a pose may report.
    pub fn outcomes_at(&self, surfaces: &Surfaces, sensor: &Pose) -> Outcomes {
        self.outcomes(&self.view(surfaces, sensor, 1.0), &Perturbation::NONE)
    }

    /// Whether what it looks at depends on the width of its beam.
    pub fn looks_by_width(&self) -> bool {
        matches!(self, SensorLaw::Beam(_))
    }

    /// Whether it is the textbook's ideal ray.
    pub fn is_ray(&self) -> bool {
        matches!(self, SensorLaw::FirstEcho(law) if law.is_ray())
    }

    /// Least and largest reading, cm.
    pub fn range_cm(&self) -> [f64; 2] {
        match self {
            SensorLaw::Beam(model) => model.range_cm,
            SensorLaw::FirstEcho(law) => law.range_cm,
        }
    }
}
