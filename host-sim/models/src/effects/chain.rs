//! Effects with their parameters, applied one after the other around a simulator step.

use super::applied::AppliedEffect;
use super::context::StepContext;
use super::drive_filter::{DriveFilter, FilteredDrive, StepSpeeds};
use super::variant::{Hook, Late, SensorState, Variant};
use mindgap_foundations::motion::Motion;
use mindgap_logs::Robot;

/// Effects that act together, in order. An empty chain changes nothing.
#[derive(Clone)]
pub struct EffectChain {
    /// What lies between commands and networks: the filter that these were learned behind, as effects change it.
    drive: FilteredDrive,
    links: Vec<(&'static Variant, Vec<f64>)>,
}

impl Default for EffectChain {
    fn default() -> Self {
        EffectChain { drive: DriveFilter::default().into(), links: Vec::new() }
    }
}

impl EffectChain {
    /// Returns the effects applied to a simulator of this robot, whose networks see commands behind `filter`; an effect that
    /// this program does not know is left out.
    pub fn of(filter: DriveFilter, applied: &[AppliedEffect], robot: &Robot) -> Self {
        let links = applied.iter().flat_map(|effect| effect.resolve(robot));
        EffectChain::default().followed_by(filter, links.map(|(candidate, values)| (candidate.variant, values)))
    }

    /// Returns this chain followed by further variants, whose parameters are concatenated in `values`.
    pub fn with(&self, variants: &[&'static Variant], values: &[f64]) -> Self {
        let mut rest = values;
        let links = variants.iter().map(|variant| {
            let (own, others) = rest.split_at(variant.parameters.len());
            rest = others;
            (*variant, own.to_vec())
        });
        self.followed_by(self.drive.filter(), links)
    }

    fn followed_by(&self, mut filter: DriveFilter, links: impl Iterator<Item = (&'static Variant, Vec<f64>)>) -> Self {
        let further: Vec<_> = links.collect();
        for (variant, values) in &further {
            for hook in variant.hooks {
                match hook {
                    Hook::DeadTime(steps) => filter.dead_time_steps += steps(values),
                    Hook::Filter(change) => change(values, &mut filter),
                    _ => {}
                }
            }
        }
        EffectChain { drive: filter.into(), links: [self.links.as_slice(), &further].concat() }
    }

    /// Returns whether it changes nothing.
    pub fn is_empty(&self) -> bool {
        self.links.is_empty() && self.drive.filter().is_none()
    }

    /// Returns whether any effect changes the sensor.
    pub fn senses(&self) -> bool {
        self.links.iter().any(|(variant, _)| variant.senses())
    }

    /// Returns whether their influence on the motion depends on commands alone, not on place or time.
    pub fn moves_by_commands_alone(&self) -> bool {
        self.links.iter().all(|(variant, _)| variant.moves_by_commands_alone())
    }

    /// Returns whether their influence on the sensor is the same at every place and time.
    pub fn senses_alike_everywhere(&self) -> bool {
        self.links.iter().all(|(variant, _)| variant.senses_alike_everywhere())
    }

    /// Returns the motion of a step with these effects; `step` predicts it without them, for the commands now and before.
    pub fn wrap(&self, context: &StepContext, step: impl FnMut([f64; 2], [f64; 2]) -> Motion<f64>) -> Motion<f64> {
        let (mut commands, mut late) = (context.commands, Late::default());
        self.each(|hook, values| match hook {
            Hook::Commands(change) | Hook::CommandsHere(change) => change(values, context, &mut commands),
            Hook::Delay(delay) => {
                let more = delay(values);
                late.drive_steps += more.drive_steps;
                late.poses_steps += more.poses_steps;
            }
            Hook::DeadTime(_)
            | Hook::Filter(_)
            | Hook::Motion(_)
            | Hook::MotionHere(_)
            | Hook::Sensor(_)
            | Hook::SensorHere(_)
            | Hook::Ray(_) => {}
        });
        let mut increment = delayed(|steps_ago| self.drive.speeds(&commands, steps_ago, &context.robot), late, step);
        self.each(|hook, values| {
            if let Hook::Motion(change) | Hook::MotionHere(change) = hook {
                change(values, context, &mut increment);
            }
        });
        increment
    }

    /// Returns the sensor at a row with these effects.
    pub fn sensor(&self, context: &StepContext) -> SensorState {
        let mut sensor = SensorState::nominal(context.pose);
        self.each(|hook, values| {
            if let Some(change) = hook.of_sensor() {
                change(values, context, &mut sensor);
            }
        });
        sensor
    }

    fn each(&self, mut visit: impl FnMut(&Hook, &[f64])) {
        for (variant, values) in &self.links {
            variant.hooks.iter().for_each(|hook| visit(hook, values));
        }
    }
}

/// Returns the delayed motion; `speeds` returns what the networks see of a step, by how long ago it was, in steps. Poses that
/// are late by a fraction of a step lie between those of two rows.
fn delayed(
    speeds: impl Fn(usize) -> StepSpeeds,
    late: Late,
    mut step: impl FnMut([f64; 2], [f64; 2]) -> Motion<f64>,
) -> Motion<f64> {
    let (whole, part) = (libm::floor(late.poses_steps), late.poses_steps % 1.0);
    let motion = driven_late(&speeds, late.drive_steps + whole, &mut step);
    if part == 0.0 {
        return motion;
    }
    let earlier = driven_late(&speeds, late.drive_steps + whole + 1.0, &mut step);
    weighted([(1.0 - part, motion), (part, earlier)])
}

/// Returns the motion of a drive that is late by this number of steps. For a fraction of a step, the earlier step extends into
/// this one at its final speed, and this one ends earlier by as much.
fn driven_late(
    speeds: &impl Fn(usize) -> StepSpeeds,
    late_steps: f64,
    step: &mut impl FnMut([f64; 2], [f64; 2]) -> Motion<f64>,
) -> Motion<f64> {
    let (whole, part) = (late_steps as usize, late_steps % 1.0);
    let StepSpeeds { now, before, drift_cm } = speeds(whole);
    let mut motion = step(now, before);
    motion.lateral += drift_cm;
    if part == 0.0 {
        return motion;
    }
    let earlier = step(before, before).arc().scaled(part);
    let rest = motion.arc().plus(step(now, now).arc().scaled(-part));
    earlier.motion().then(rest.motion())
}

/// Returns the weighted sum of motions.
fn weighted<const N: usize>(increments: [(f64, Motion<f64>); N]) -> Motion<f64> {
    Motion::from_fn(|axis| increments.iter().map(|(weight, increment)| weight * increment[axis]).sum())
}

#[cfg(test)]
mod tests {
    use super::super::context::HISTORY;
    use super::*;

    /// A start by a drive that misses a tenth of a step's distance. Half a step late, both forms end at the same place; but a
    /// late drive has missed its tenth by the end of the first step, and late poses show half of it in each.
    #[test]
    fn late_drive_starts_late_and_late_poses_lie_between_rows() {
        let step = |now: [f64; 2], before: [f64; 2]| Motion {
            forward: now[0] - 0.1 * (now[0] - before[0]),
            lateral: 0.0,
            turn: 0.0,
        };
        let started =
            |ago: usize| std::array::from_fn::<_, HISTORY, _>(|age| if age <= ago { [1.0; 2] } else { [0.0; 2] });
        let robot = mindgap_built_in_robot::default_robot();
        let forward_cm = |late| {
            let speeds = |ago| {
                move |steps_ago| FilteredDrive::from(DriveFilter::default()).speeds(&started(ago), steps_ago, &robot)
            };
            [0, 1, 2].map(|ago| delayed(speeds(ago), late, step).forward)
        };
        let close = |found: [f64; 3], right: [f64; 3]| {
            assert!(found.iter().zip(right).all(|(f, r)| (f - r).abs() < 1e-12), "{found:?} {right:?}");
        };
        close(forward_cm(Late { drive_steps: 0.5, poses_steps: 0.0 }), [0.4, 1.0, 1.0]);
        close(forward_cm(Late { drive_steps: 0.0, poses_steps: 0.5 }), [0.45, 0.95, 1.0]);
        close(forward_cm(Late { drive_steps: 1.0, poses_steps: 0.0 }), [0.0, 0.9, 1.0]);
        close(forward_cm(Late { drive_steps: 0.0, poses_steps: 1.0 }), [0.0, 0.9, 1.0]);
    }
}
