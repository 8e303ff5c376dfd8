//! The filter against small steps of the same physics.

use super::*;
use mindgap_foundations::geometry::Pose;
use mindgap_foundations::motion::Arc;
use mindgap_logs::{CommandChange, CommandChanges, Row, Rows};

fn filter(dead_time_steps: f64, lag_steps: f64) -> DriveFilter {
    DriveFilter { dead_time_steps, lag_steps, ..DriveFilter::default() }
}

/// Integrates the same filter in small steps, from the oldest command on; `at` is the command at a time since the present step
/// began, steps. Returns mean and first speed, and the drift.
fn integrated(filter: &DriveFilter, at: impl Fn(f64) -> [f64; 2], robot: &Robot) -> StepSpeeds {
    const PARTS: usize = 5000;
    let (part, unit) = (1.0 / PARTS as f64, command_for(1.0, robot));
    let oldest = at(-(HISTORY as f64));
    let nearer = |lag_steps: f64| if lag_steps > 0.0 { 1.0 - libm::exp(-part / lag_steps) } else { 1.0 };
    let (mut speed, mut turn_rate) = (oldest, twist(oldest)[1]);
    let (mut before, mut now, mut pose) = ([0.0; 2], [0.0; 2], Pose::new(0.0, 0.0, 0.0));
    let moved = |speed: [f64; 2], duration_s: f64| {
        let wheels_cm = speed.map(|c| c / 100.0 * robot.full_speed_cm_s * duration_s);
        Arc { length_cm: 0.0, across_cm: 0.0, turn_rad: 0.0 }.with_wheels(wheels_cm, robot.track_cm).motion()
    };
    for i in 0..HISTORY * PARTS {
        let time = (i as f64 + 0.5) * part - (HISTORY - 1) as f64;
        if i == (HISTORY - 1) * PARTS {
            before = wheels([twist(speed)[0], turn_rate]);
        }
        let towards = at(time - filter.dead_time_steps);
        let end = [0, 1].map(|m| speed[m] + nearer(filter.lag_steps) * (towards[m] - speed[m]));
        speed = match filter.most_change {
            None => end,
            Some(MostChange::Wheel(most)) => MostChange::Wheel(most * part).limited(speed, end, unit),
            Some(MostChange::Twist(most)) => MostChange::Twist(most.map(|most| most * part)).limited(speed, end, unit),
        };
        turn_rate += nearer(filter.turn_lag_steps) * (twist(speed)[1] - turn_rate);
        let body = wheels([twist(speed)[0], turn_rate]);
        if time > 0.0 {
            now = [0, 1].map(|m| now[m] + body[m] * part);
            pose = moved(body, robot.step_ms / 1000.0 * part).end(&pose);
        }
    }
    let held = moved(now, robot.step_ms / 1000.0);
    StepSpeeds { now, before, drift_cm: pose.position_cm.y - held.lateral }
}

/// Speeds agree to these commands, for exact forms and for those in pieces.
fn assert_like_integrated(filter: DriveFilter, within: f64) {
    let robot = mindgap_built_in_robot::default_robot();
    let commands: CommandHistory =
        std::array::from_fn(|age| [libm::sin(age as f64) * 60.0, if age < 3 { 50.0 } else { -20.0 }]);
    let at = |time_steps: f64| commands[(-time_steps.floor()).clamp(0.0, (HISTORY - 1) as f64) as usize];
    assert_near(filter, FilteredDrive::from(filter).speeds(&commands, 0, &robot), at, within);
}

fn assert_near(filter: DriveFilter, found: StepSpeeds, at: impl Fn(f64) -> [f64; 2], within: f64) {
    let right = integrated(&filter, at, &mindgap_built_in_robot::default_robot());
    let near = found.inputs().iter().zip(right.inputs()).all(|(a, b)| (a - b).abs() < within);
    assert!(near, "{filter:?}: {found:?} {right:?}");
    // Of the sine of the heading the first power is taken.
    assert!((found.drift_cm - right.drift_cm).abs() < 0.05 + 0.1 * right.drift_cm.abs(), "{found:?} {right:?}");
}

#[test]
fn dead_time_and_lag_are_exact() {
    for (dead_time_steps, lag_steps) in [(0.0, 0.0), (0.3, 0.0), (2.0, 0.0), (0.0, 0.5), (0.7, 1.3), (2.5, 0.2)] {
        assert_like_integrated(filter(dead_time_steps, lag_steps), 0.5);
    }
}

/// Commands that change every 0.7 steps, whatever the rows.
#[test]
fn commands_act_at_their_own_times() {
    let robot = mindgap_built_in_robot::default_robot();
    let command = |k: i32| [40.0 + 20.0 * libm::sin(f64::from(k)), if k > -5 { 50.0 } else { 30.0 }];
    let change = |k: i32| CommandChange { t_ms: robot.step_ms * (0.75 + 0.7 * f64::from(k)), command: command(k) };
    let row = |k: i32| Row { t_ms: robot.step_ms * f64::from(k), ..Row::default() };
    let mut rows: Rows = (0..3).map(row).collect();
    rows.set_changes(CommandChanges::of((-24..=1).map(change)).expect("changes"));
    let pieces = Pieces::of(&rows, 0);
    let at = |time_steps: f64| command(((time_steps - 0.75) / 0.7).floor() as i32);
    let lagging = filter(0.4, 0.6);
    let limited = DriveFilter { most_change: Some(MostChange::Wheel(0.3)), ..lagging };
    let turning = DriveFilter { turn_lag_steps: 0.7, ..lagging };
    for (filter, within) in [
        (filter(0.0, 0.0), 0.1),
        (filter(0.35, 0.0), 0.1),
        (filter(2.5, 0.2), 0.5),
        (lagging, 0.5),
        (limited, 2.0),
        (turning, 1.0),
    ] {
        let found = FilteredDrive::from(filter).speeds_of(&[[0.0; 2]; HISTORY], &pieces, &robot);
        assert_near(filter, found, at, within);
    }
}

#[test]
fn limits_and_lags_of_the_turn_are_integrated() {
    let lagging = filter(0.4, 0.6);
    for most_change in [MostChange::Wheel(0.3), MostChange::Twist([0.25, 0.1])] {
        assert_like_integrated(DriveFilter { most_change: Some(most_change), ..DriveFilter::default() }, 2.0);
        assert_like_integrated(DriveFilter { most_change: Some(most_change), ..lagging }, 2.0);
    }
    assert_like_integrated(DriveFilter { turn_lag_steps: 0.7, ..lagging }, 1.0);
    assert_like_integrated(DriveFilter { turn_lag_steps: 0.7, ..DriveFilter::default() }, 1.0);
}

#[test]
fn without_dead_time_and_lag_commands_act_at_once() {
    let robot = mindgap_built_in_robot::default_robot();
    let commands: CommandHistory = std::array::from_fn(|age| [age as f64, -(age as f64)]);
    for filter in [DriveFilter::default(), filter(-1.0, -0.5)] {
        assert!(filter.is_none());
        for steps_ago in [0, 3] {
            let StepSpeeds { now, before, drift_cm } = FilteredDrive::from(filter).speeds(&commands, steps_ago, &robot);
            assert_eq!(([now, before], drift_cm), ([commands[steps_ago], commands[steps_ago + 1]], 0.0));
        }
    }
}
