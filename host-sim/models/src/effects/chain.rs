//! Effects with their parameters, at work one after the other round a simulator's step.

use super::applied::AppliedEffect;
use super::context::{CommandHistory, StepContext};
use super::pose_increment::PoseIncrement;
use super::variant::{Hook, Late, SensorState, Variant};

/// Effects that act together, in their order; an empty chain changes nothing.
#[derive(Clone, Default)]
pub struct EffectChain {
    links: Vec<(&'static Variant, Vec<f64>)>,
}

impl EffectChain {
    /// The effects of a simulator file; one that this program does not know is left out.
    pub fn of(applied: &[AppliedEffect]) -> Self {
        let links = applied.iter().flat_map(AppliedEffect::resolve);
        EffectChain { links: links.map(|(candidate, values)| (candidate.variant, values)).collect() }
    }

    /// This chain with further variants behind it, whose parameters follow one another in `values`.
    pub fn with(&self, variants: &[&'static Variant], values: &[f64]) -> Self {
        let mut links = self.links.clone();
        let mut rest = values;
        for variant in variants {
            let (own, others) = rest.split_at(variant.parameters.len());
            links.push((variant, own.to_vec()));
            rest = others;
        }
        EffectChain { links }
    }

    /// Whether any of them changes the sensor.
    pub fn senses(&self) -> bool {
        self.links.iter().any(|(variant, _)| variant.senses())
    }

    /// Whether what they do to the motion follows from commands, wherever and whenever they are driven.
    pub fn moves_by_commands_alone(&self) -> bool {
        self.links.iter().all(|(variant, _)| variant.moves_by_commands_alone())
    }

    /// Whether what they do to the sensor is the same wherever and whenever that is asked.
    pub fn senses_alike_everywhere(&self) -> bool {
        self.links.iter().all(|(variant, _)| variant.senses_alike_everywhere())
    }

    /// The increment of a step with these effects; `step` gives that of the simulator for the commands now and before.
    pub fn wrap(&self, context: &StepContext, step: impl FnMut([f64; 2], [f64; 2]) -> PoseIncrement) -> PoseIncrement {
        let (mut commands, mut late) = (context.commands, Late::default());
        self.each(|hook, values| match hook {
            Hook::Commands(change) | Hook::CommandsHere(change) => change(values, context, &mut commands),
            Hook::Delay(delay) => {
                let more = delay(values, context);
                late.drive_steps += more.drive_steps;
                late.poses_steps += more.poses_steps;
            }
            Hook::Motion(_) | Hook::MotionHere(_) | Hook::Sensor(_) | Hook::SensorHere(_) | Hook::Ray(_) => {}
        });
        let mut increment = delayed(&commands, late, step);
        self.each(|hook, values| {
            if let Hook::Motion(change) | Hook::MotionHere(change) = hook {
                change(values, context, &mut increment);
            }
        });
        increment
    }

    /// The sensor at a row with these effects.
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

/// The motion that comes so late. Poses that are late by a part of a step lie between those of two rows.
fn delayed(
    commands: &CommandHistory,
    late: Late,
    mut step: impl FnMut([f64; 2], [f64; 2]) -> PoseIncrement,
) -> PoseIncrement {
    let (whole, part) = (libm::floor(late.poses_steps), late.poses_steps % 1.0);
    let motion = driven_late(commands, late.drive_steps + whole, &mut step);
    if part == 0.0 {
        return motion;
    }
    let earlier = driven_late(commands, late.drive_steps + whole + 1.0, &mut step);
    weighted([(1.0 - part, motion), (part, earlier)])
}

/// The motion of a drive that is so many steps late. Where that is no whole number, the earlier step lasts into this one at the
/// speed that it came to, and this one ends so much before it.
fn driven_late(
    commands: &CommandHistory,
    late_steps: f64,
    step: &mut impl FnMut([f64; 2], [f64; 2]) -> PoseIncrement,
) -> PoseIncrement {
    let (whole, part) = (late_steps as usize, late_steps % 1.0);
    let ago = |steps: usize| commands.get(steps).copied().unwrap_or([0.0; 2]);
    let (now, before) = (ago(whole), ago(whole + 1));
    let motion = step(now, before);
    if part == 0.0 {
        return motion;
    }
    weighted([(1.0, motion), (part, step(before, before)), (-part, step(now, now))])
}

/// The sum of increments, each times its weight.
fn weighted<const N: usize>(increments: [(f64, PoseIncrement); N]) -> PoseIncrement {
    let sum = |of: fn(&PoseIncrement) -> f64| increments.iter().map(|(weight, increment)| weight * of(increment)).sum();
    PoseIncrement {
        forward_cm: sum(|increment| increment.forward_cm),
        lateral_cm: sum(|increment| increment.lateral_cm),
        turn_rad: sum(|increment| increment.turn_rad),
    }
}

#[cfg(test)]
mod tests {
    use super::super::context::HISTORY;
    use super::*;

    /// A start, by a drive that misses a tenth of a step's way: half a step late both ways it ends at the same place, but a late
    /// drive has missed its tenth by the end of the first step, and late poses tell half of it in each.
    #[test]
    fn a_late_drive_starts_late_and_late_poses_lie_between_rows() {
        let step = |now: [f64; 2], before: [f64; 2]| PoseIncrement {
            forward_cm: now[0] - 0.1 * (now[0] - before[0]),
            lateral_cm: 0.0,
            turn_rad: 0.0,
        };
        let started =
            |ago: usize| std::array::from_fn::<_, HISTORY, _>(|age| if age <= ago { [1.0; 2] } else { [0.0; 2] });
        let forward_cm = |late| [0, 1, 2].map(|ago| delayed(&started(ago), late, step).forward_cm);
        let close = |found: [f64; 3], right: [f64; 3]| {
            assert!(found.iter().zip(right).all(|(f, r)| (f - r).abs() < 1e-12), "{found:?} {right:?}");
        };
        close(forward_cm(Late { drive_steps: 0.5, poses_steps: 0.0 }), [0.4, 1.0, 1.0]);
        close(forward_cm(Late { drive_steps: 0.0, poses_steps: 0.5 }), [0.45, 0.95, 1.0]);
        close(forward_cm(Late { drive_steps: 1.0, poses_steps: 0.0 }), [0.0, 0.9, 1.0]);
        close(forward_cm(Late { drive_steps: 0.0, poses_steps: 1.0 }), [0.0, 0.9, 1.0]);
    }
}
