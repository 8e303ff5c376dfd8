//! Effects with their parameters, applied one after the other around a simulator step.

use super::applied::AppliedEffect;
use super::context::{CommandHistory, StepContext};
use super::drive_filter::{DriveFilter, FilteredDrive, StepSpeeds};
use super::lagging_heading::{LaggingHeading, Turns};
use super::pieces::Phases;
use super::variant::{Hook, Late, SensorState, Variant};
use mindgap_foundations::motion::Motion;
use mindgap_logs::Robot;

/// Effects that act together, in order. An empty chain changes nothing.
#[derive(Clone)]
pub struct EffectChain {
    /// What lies between commands and networks: the filter that these were learned behind, as effects change it.
    drive: FilteredDrive,
    links: Vec<Link>,
    late: Late,
    lagging_heading: Option<LaggingHeading>,
}

/// A form of an effect with its parameters.
type Link = (&'static Variant, Vec<f64>);

impl Default for EffectChain {
    fn default() -> Self {
        EffectChain {
            drive: DriveFilter::default().into(),
            links: Vec::new(),
            late: Late::default(),
            lagging_heading: None,
        }
    }
}

impl EffectChain {
    /// Returns the effects applied to a simulator of this robot, whose networks see commands behind `filter`; an effect that
    /// this program does not know is left out, and so is one of a further range sensor.
    pub fn of(filter: DriveFilter, applied: &[AppliedEffect], robot: &Robot) -> Self {
        let own = applied.iter().filter(|effect| effect.sensor.is_none());
        let links = own.flat_map(|effect| effect.resolve(robot));
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

    fn followed_by(&self, mut filter: DriveFilter, links: impl Iterator<Item = Link>) -> Self {
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
        let links = [self.links.as_slice(), &further].concat();
        let (late, lagging_heading) = (late(&links), lagging_heading(&links));
        EffectChain { drive: filter.into(), links, late, lagging_heading }
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
    pub fn wrap(&self, context: &StepContext, mut step: impl FnMut([f64; 2], [f64; 2]) -> Motion<f64>) -> Motion<f64> {
        let speeds = self.speeds(context);
        let mut moved = |steps_ago: usize, is_held: bool| {
            let speeds = |ago| {
                let speeds = speeds(steps_ago + ago);
                if is_held { StepSpeeds { before: speeds.now, drift_cm: 0.0, ..speeds } } else { speeds }
            };
            let mut increment = delayed(speeds, self.late, &mut step);
            self.change_motion(context, &mut increment);
            increment
        };
        let Some(lag) = self.lagging_heading else { return moved(0, false) };
        let error_rad = lag.error_rad(|ago| Turns { rad: moved(ago, false).turn, held_rad: moved(ago, true).turn });
        let held_rad = moved(0, true).turn;
        lag.seen(moved(0, false), held_rad, error_rad)
    }

    /// Returns the same for a robot without any memory but that of its filter; `step` predicts a step under a held command.
    /// Where commands change within a step, each piece is a part of such a step, and effects change the motion of each.
    pub fn wrap_pieces(&self, context: &StepContext, step: impl Fn([f64; 2]) -> Motion<f64>) -> Motion<f64> {
        if context.pieces.is_empty() || self.lagging_heading.is_some() {
            return self.wrap(context, |now, _| step(now));
        }
        let phases = self.phases(context);
        interpolated(self.late, |late_steps| {
            let pieces = self.drive.pieces(&phases, late_steps, &context.robot);
            pieces.into_iter().fold(Motion::ZERO, |so_far, (duration, speeds)| {
                let mut held = step(speeds);
                self.change_motion(context, &mut held);
                so_far.then(held.arc().scaled(duration).motion())
            })
        })
    }

    /// Returns the motion that a robot would hold with these effects if it kept the speed with which a step begins; `hold`
    /// predicts it without them, for held commands.
    pub fn begin(&self, context: &StepContext, mut hold: impl FnMut([f64; 2]) -> Motion<f64>) -> Motion<f64> {
        let StepSpeeds { before, .. } = self.speeds(context)(self.late.drive_steps as usize);
        let mut increment = hold(before);
        self.change_motion(context, &mut increment);
        increment
    }

    /// Returns the speeds behind the filter, by how many steps ago they were.
    fn speeds<'a>(&'a self, context: &'a StepContext) -> impl Fn(usize) -> StepSpeeds + 'a {
        let robot = &context.robot;
        let phases = (!context.pieces.is_empty()).then(|| self.phases(context));
        let commands = self.changed(context, context.commands);
        move |steps_ago| match &phases {
            None => self.drive.speeds(&commands, steps_ago, robot),
            Some(phases) => self.drive.speeds_in(phases, steps_ago, robot),
        }
    }

    /// Returns the commands of a step in its phases, as they reach the filter.
    fn phases(&self, context: &StepContext) -> Phases {
        let late = self.late;
        let memory_steps = self.drive.memory_steps(&context.commands, &context.robot);
        let heading_steps = self.lagging_heading.map_or(0, |lag| lag.reach_steps()) as f64;
        // Poses that are late by a fraction of a step need the step before.
        let reach_steps = memory_steps + late.drive_steps + late.poses_steps.ceil() + heading_steps;
        let mut phases = context.pieces.phases(&context.commands, reach_steps);
        if self.changes_commands() {
            for history in &mut phases.histories {
                *history = self.changed(context, *history);
            }
        }
        phases
    }

    fn changes_commands(&self) -> bool {
        let changes = |hook: &Hook| matches!(hook, Hook::Commands(_) | Hook::CommandsHere(_));
        self.links.iter().any(|(variant, _)| variant.hooks.iter().any(changes))
    }

    /// Returns commands as effects change them.
    fn changed(&self, context: &StepContext, mut commands: CommandHistory) -> CommandHistory {
        self.each(|hook, values| {
            if let Hook::Commands(change) | Hook::CommandsHere(change) = hook {
                change(values, context, &mut commands);
            }
        });
        commands
    }

    fn change_motion(&self, context: &StepContext, increment: &mut Motion<f64>) {
        self.each(|hook, values| {
            if let Hook::Motion(change) | Hook::MotionHere(change) = hook {
                change(values, context, increment);
            }
        });
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

    fn each(&self, visit: impl FnMut(&Hook, &[f64])) {
        each(&self.links, visit);
    }
}

fn each(links: &[Link], mut visit: impl FnMut(&Hook, &[f64])) {
    for (variant, values) in links {
        variant.hooks.iter().for_each(|hook| visit(hook, values));
    }
}

fn late(links: &[Link]) -> Late {
    let mut late = Late::default();
    each(links, |hook, values| {
        if let Hook::Delay(delay) = hook {
            let more = delay(values);
            late.drive_steps += more.drive_steps;
            late.poses_steps += more.poses_steps;
        }
    });
    late
}

fn lagging_heading(links: &[Link]) -> Option<LaggingHeading> {
    let mut lag_steps = 0.0;
    each(links, |hook, values| {
        if let Hook::HeadingLag(steps) = hook {
            lag_steps += steps(values);
        }
    });
    LaggingHeading::new(lag_steps)
}

/// Returns the delayed motion; `speeds` returns what the networks see of a step, by how long ago it was, in steps.
fn delayed(
    speeds: impl Fn(usize) -> StepSpeeds,
    late: Late,
    step: &mut impl FnMut([f64; 2], [f64; 2]) -> Motion<f64>,
) -> Motion<f64> {
    interpolated(late, |late_steps| driven_late(&speeds, late_steps, step))
}

/// Returns the delayed motion; `motion` returns that of a drive which is late by this number of steps. Poses that are late by a
/// fraction of a step lie between those of two rows.
fn interpolated(late: Late, mut motion: impl FnMut(f64) -> Motion<f64>) -> Motion<f64> {
    let (whole, part) = (libm::floor(late.poses_steps), late.poses_steps % 1.0);
    let latest = motion(late.drive_steps + whole);
    if part == 0.0 {
        return latest;
    }
    weighted([(1.0 - part, latest), (part, motion(late.drive_steps + whole + 1.0))])
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
    use super::super::Candidate;
    use super::super::context::{HISTORY, RunHistory, Surroundings};
    use super::*;
    use crate::simulator::baseline::MotionModel;
    use mindgap_foundations::geometry::Pose;
    use mindgap_logs::{CommandChange, CommandChanges, Row, Rows, Scene};

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
            [0, 1, 2].map(|ago| delayed(speeds(ago), late, &mut { step }).forward)
        };
        let close = |found: [f64; 3], right: [f64; 3]| {
            assert!(found.iter().zip(right).all(|(f, r)| (f - r).abs() < 1e-12), "{found:?} {right:?}");
        };
        close(forward_cm(Late { drive_steps: 0.5, poses_steps: 0.0 }), [0.4, 1.0, 1.0]);
        close(forward_cm(Late { drive_steps: 0.0, poses_steps: 0.5 }), [0.45, 0.95, 1.0]);
        close(forward_cm(Late { drive_steps: 1.0, poses_steps: 0.0 }), [0.0, 0.9, 1.0]);
        close(forward_cm(Late { drive_steps: 0.0, poses_steps: 1.0 }), [0.0, 0.9, 1.0]);
    }

    /// A robot that turns on the spot and then drives straight, within one step, with half of its turns lost at the ground.
    #[test]
    fn pieces_of_a_step_are_driven_one_after_the_other() {
        let robot = mindgap_built_in_robot::default_robot();
        let step_ms = robot.step_ms;
        let mut rows: Rows = (0..3).map(|k| Row { t_ms: step_ms * f64::from(k), ..Row::default() }).collect();
        let change = |share: f64, command: [f64; 2]| CommandChange { t_ms: step_ms * share, command };
        let changes = [change(0.0, [0.0, 0.0]), change(0.9, [-40.0, 40.0]), change(1.2, [60.0, 60.0])];
        rows.set_changes(CommandChanges::of(changes).expect("changes"));
        let surroundings = Surroundings::new(&robot, &Scene::default());
        let mut history = RunHistory::default();
        (0..2).for_each(|row| history.command_of(&rows, row));
        let context = surroundings.unseen(&history, step_ms, Pose::new(0.0, 0.0, 0.0));

        let drive = MotionModel::Kinematic { robot, scatter: Motion::splat(0.1) };
        let track = Candidate::named("track_width", "turn").expect("it").variant;
        let motion = |late_steps: f64| {
            let late = Candidate::named("latency", "delay").expect("it").variant;
            let effects = EffectChain::default().with(&[late, track], &[late_steps, 0.5]);
            effects.wrap_pieces(&context, |held| drive.step(held, held))
        };
        let step_cm = |command: f64| command / 100.0 * robot.full_speed_cm_s * step_ms / 1000.0;
        for (late_steps, turning, straight) in [(0.0, 0.2, 0.8), (0.1, 0.3, 0.7), (0.6, 0.3, 0.2), (0.9, 0.2, 0.0)] {
            let turn = 0.5 * 2.0 * step_cm(40.0) / robot.track_cm * turning;
            let way_cm = step_cm(60.0) * straight;
            let Motion { forward, lateral, turn: turned } = motion(late_steps);
            let expected = [way_cm * libm::cos(turn), way_cm * libm::sin(turn), turn];
            let off = [forward, lateral, turned].into_iter().zip(expected).map(|(found, right)| (found - right).abs());
            assert!(off.fold(0.0, f64::max) < 1e-5, "{late_steps}: {forward} {lateral} {turned} for {expected:?}");
        }
    }
}
