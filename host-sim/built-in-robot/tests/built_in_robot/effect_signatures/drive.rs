//! Effects of battery, motors, tyres and floor.

use mindgap_logs::samples::MotionSample;

use super::measures::{
    Measured, asked_cm, asked_motion, covered_cm, drivings, is_steady, jump, mean, slope, surplus_cm, two_slopes,
};

/// Covered way forward against asked one over chosen steps.
fn forward(m: &Measured, chosen: impl Fn(&MotionSample) -> bool) -> f64 {
    slope(m.motion.iter().filter(|s| chosen(s)).map(|s| (asked_motion(s).0, s.forward_cm)))
}

/// Covered turn against asked one.
fn turn(m: &Measured) -> f64 {
    slope(m.motion.iter().map(|s| (asked_motion(s).1, s.turn_rad)))
}

/// Covered way of one wheel against asked one.
fn wheel(m: &Measured, side: usize) -> f64 {
    slope(m.motion.iter().map(|s| (asked_cm(s)[side], covered_cm(s)[side])))
}

/// Weights of this step's and the last one's command.
fn weights(m: &Measured) -> (f64, f64) {
    two_slopes(m.motion.iter().map(|s| (s.speeds[0] + s.speeds[1], s.speeds[2] + s.speeds[3], s.forward_cm / 0.082)))
}

/// Heading at the beginning of a step, from the log.
fn heading_rad(m: &Measured, s: &MotionSample) -> f64 {
    m.logs.runs[s.run].rows.at(s.row).pose.expect("a sample has a pose").heading_rad
}

#[test]
fn battery_sag_weakens_the_drive_as_the_run_goes_on() {
    for driving in drivings() {
        let (without, with) =
            driving.without_and_with("battery_sag", |m| forward(m, |s| s.row >= 40) / forward(m, |s| s.row < 20));
        assert!((0.97..1.03).contains(&without) && (0.85..0.94).contains(&with), "{without} {with}");
    }
}

#[test]
fn motor_asymmetry_weakens_one_wheel() {
    for driving in drivings() {
        let left_to_right = |m: &Measured| wheel(m, 0) / wheel(m, 1);
        let (without, left) = driving.without_and_with("motor_asymmetry=0.12", left_to_right);
        let right = driving.with_effect("motor_asymmetry=-0.12", left_to_right);
        assert!((0.98..1.02).contains(&without), "{without}");
        assert!((0.85..0.94).contains(&left) && (1.06..1.18).contains(&right), "{left} {right}");
    }
}

#[test]
fn drive_scale_changes_ways_and_turns_alike() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("drive_scale=0.9", |m| (forward(m, |_| true), turn(m)));
        let (ways, turns) = (with.0 / without.0, with.1 / without.1);
        assert!((0.88..0.94).contains(&ways) && (0.88..0.94).contains(&turns), "{ways} {turns}");
    }
}

#[test]
fn track_width_changes_turns_alone() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("track_width=0.87", |m| (forward(m, |_| true), turn(m)));
        let (ways, turns) = (with.0 / without.0, with.1 / without.1);
        assert!((0.98..1.02).contains(&ways) && (0.84..0.92).contains(&turns), "{ways} {turns}");
    }
}

#[test]
fn deadband_holds_small_commands_back() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("deadband=18", |m| {
            let wheels = m.motion.iter().filter(|s| is_steady(s)).flat_map(|s| {
                let covered = covered_cm(s);
                [0, 1].map(|side| (s.speeds[side], covered[side]))
            });
            let small = wheels.filter(|(command, _)| (10.0..17.0).contains(&command.abs()));
            mean(small.map(|(command, covered)| covered * command.signum()))
        });
        assert!(without > 1.0 && with.abs() < 0.4, "{without} {with}");
    }
}

#[test]
fn saturation_keeps_high_commands_from_adding_speed() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("saturation=45", |m| {
            let pace = |s: &MotionSample| (s.speeds[0] + s.speeds[1]) / 2.0;
            forward(m, |s| is_steady(s) && pace(s) > 58.0)
                / forward(m, |s| is_steady(s) && (25.0..42.0).contains(&pace(s)))
        });
        assert!(without > 1.0 && with < 0.85, "{without} {with}");
    }
}

#[test]
fn latency_gives_the_last_command_more_of_the_step() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("latency=100", weights);
        assert!((0.08..0.18).contains(&without.1) && with.1 - without.1 > 0.18, "{without:?} {with:?}");
        assert!((with.0 + with.1 - without.0 - without.1).abs() < 0.03, "{without:?} {with:?}");
    }
}

#[test]
fn inertia_lets_the_last_command_go_on_even_two_steps_later() {
    for driving in drivings() {
        let two_back = |m: &Measured| {
            let third = m.motion.iter().filter(|s| s.row >= 2 && is_steady(s)).map(|s| {
                let before = m.logs.runs[s.run].rows.at(s.row - 2).command();
                (before[0] + before[1] - s.speeds[0] - s.speeds[1], surplus_cm(s))
            });
            slope(third.filter(|(change, _)| *change != 0.0)) / 0.082
        };
        let (without, with) = driving.without_and_with("inertia=250", |m| (weights(m).1, two_back(m)));
        assert!(with.0 - without.0 > 0.2, "{without:?} {with:?}");
        assert!(without.1.abs() < 0.02 && with.1 > 0.04, "{without:?} {with:?}");
    }
}

#[test]
fn payload_slows_its_side_most() {
    for driving in drivings() {
        let (without, left) = driving.without_and_with("payload=0.12", |m| [wheel(m, 0), wheel(m, 1)]);
        let right = driving.with_effect("payload=-0.12", |m| [wheel(m, 0), wheel(m, 1)]);
        assert!(
            left[0] / without[0] < 0.93 && left[0] / without[0] < left[1] / without[1] - 0.03,
            "{without:?} {left:?}"
        );
        assert!(right[1] / without[1] < 0.93 && right[1] / without[1] < right[0] / without[0] - 0.03, "{right:?}");
    }
}

#[test]
fn slope_adds_way_downhill() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("slope=0.1@30", |m| {
            two_slopes(m.motion.iter().map(|s| {
                let from_downhill = heading_rad(m, s) - 30f64.to_radians();
                (libm::cos(from_downhill), libm::sin(from_downhill), surplus_cm(s))
            }))
        });
        assert!(without.0.abs() < 0.15 && without.1.abs() < 0.15, "{without:?}");
        assert!((0.5..1.3).contains(&with.0) && with.1.abs() < 0.2, "{with:?}");
    }
}

#[test]
fn slip_loses_way_when_the_command_jumps() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("slip=40", |m| {
            let jumped = m.motion.iter().filter(|s| jump(s).abs() > 45.0);
            mean(jumped.map(|s| surplus_cm(s) * jump(s).signum()))
        });
        assert!(without.abs() < 0.3 && with < without - 0.4, "{without} {with}");
    }
}

#[test]
fn turn_loss_takes_way_from_turns_and_leaves_spins() {
    for driving in drivings() {
        let marks = |m: &Measured| {
            let ahead = |s: &&MotionSample| is_steady(s) && asked_motion(s).0 > 5.0;
            let lost = |s: &MotionSample| (s.turn_rad.abs(), -surplus_cm(s));
            let spins = m.motion.iter().filter(|s| (s.speeds[0] + s.speeds[1]).abs() < 1.0);
            (slope(m.motion.iter().filter(ahead).map(lost)), slope(spins.map(|s| (asked_motion(s).1, s.turn_rad))))
        };
        let (without, with) = driving.without_and_with("turn_loss=4", marks);
        // A castor drags more in the tighter turns.
        assert!((2.5..6.5).contains(&(with.0 - without.0)), "{without:?} {with:?}");
        assert!((with.1 / without.1 - 1.0).abs() < 0.05, "{without:?} {with:?}");
    }
}

#[test]
fn carpet_nap_holds_back_in_one_direction() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("carpet_nap=0.15@-60", |m| {
            two_slopes(m.motion.iter().filter(|s| asked_motion(s).0.abs() > 3.0).map(|s| {
                // A robot that backs moves the other way than it faces.
                let way_rad = heading_rad(m, s) + 60f64.to_radians();
                let sign = asked_motion(s).0.signum();
                (libm::cos(way_rad), libm::sin(way_rad), surplus_cm(s) * sign * sign)
            }))
        });
        assert!(without.0.abs() < 0.15 && without.1.abs() < 0.15, "{without:?}");
        assert!(with.0 < -0.25 && with.1.abs() < 0.2, "{with:?}");
    }
}
