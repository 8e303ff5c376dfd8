//! Effects that are held out from all that a diagnosis is made and fitted on.

use std::f64::consts::TAU;

use mindgap_built_in_robot::{Effect, HeldOut};
use mindgap_foundations::geometry::Pose;
use mindgap_logs::samples::{MotionSample, SonarSample};

use super::measures::{
    Measured, asked_motion, covered_cm, drivings, jump, mean, scatter, share, slope, surplus_cm, two_slopes,
};

/// Covered way forward against asked one over chosen steps.
fn forward(m: &Measured, chosen: impl Fn(&MotionSample) -> bool) -> f64 {
    slope(m.motion.iter().filter(|s| chosen(s)).map(|s| (asked_motion(s).0, s.forward_cm)))
}

/// Logged pose at the beginning of a step.
fn pose(m: &Measured, s: &MotionSample) -> Pose {
    m.logs.runs[s.run].rows.at(s.row).pose.expect("a sample has a pose")
}

#[test]
fn the_held_out_effects_are_in_no_table_and_end_the_list() {
    let held_out: Vec<Effect> = HeldOut::all().map(Effect::HeldOut).collect();
    assert_eq!(held_out.len(), 8);
    assert!(held_out.iter().all(|effect| !effect.in_table()));
    assert!(Effect::all().collect::<Vec<_>>().ends_with(&held_out));
}

#[test]
fn lost_commands_leave_the_one_before_at_work() {
    for driving in drivings() {
        let late = |m: &Measured| {
            two_slopes(m.motion.iter().filter(|s| jump(s).abs() > 25.0).map(|s| {
                let [left, right, last_left, last_right] = s.speeds;
                (left + right, last_left + last_right, s.forward_cm)
            }))
        };
        let (without, with) = driving.without_and_with("lost_commands=0.4", late);
        let share = |(now, before): (f64, f64)| before / (now + before);
        assert!(share(without) < 0.25 && (0.3..0.65).contains(&share(with)), "{without:?} {with:?}");
    }
}

#[test]
fn cold_grease_holds_the_robot_back_until_it_has_run_for_a_while() {
    for driving in drivings() {
        let early = |m: &Measured| forward(m, |s| (2..10).contains(&s.row)) / forward(m, |s| s.row >= 40);
        let (without, with) = driving.without_and_with("cold_grease", early);
        assert!((0.97..1.03).contains(&without) && (0.8..0.92).contains(&with), "{without} {with}");
    }
}

#[test]
fn floor_waves_push_and_pull_every_30_cm() {
    for driving in drivings() {
        let waves = |m: &Measured| {
            two_slopes(m.motion.iter().map(|s| {
                let from = pose(m, s);
                let along_x = libm::cos(from.heading_rad);
                let phase = TAU * (from.position_cm.x + along_x * s.forward_cm / 2.0) / 30.0;
                (along_x * libm::sin(phase), along_x * libm::cos(phase), surplus_cm(s))
            }))
        };
        let (without, with) = driving.without_and_with("floor_waves", waves);
        assert!(without.0.abs() < 0.15 && without.1.abs() < 0.15, "{without:?}");
        assert!((0.7..1.2).contains(&with.0) && with.1.abs() < 0.15, "{with:?}");
    }
}

#[test]
fn soft_start_loses_way_as_a_wheel_speeds_up_and_none_as_it_slows_down() {
    for driving in drivings() {
        let jumps = |m: &Measured| {
            let wheels: Vec<(f64, f64)> = m
                .motion
                .iter()
                .flat_map(|s| {
                    let covered = covered_cm(s);
                    [0, 1].map(|side| (s.speeds[side], s.speeds[side + 2], covered[side]))
                })
                .filter(|(now, last, _)| now * last > 0.0)
                .map(|(now, last, covered)| {
                    let asked = 0.164 * (0.85 * now + 0.15 * last);
                    (now.abs() - last.abs(), (covered - 0.93 * asked) * now.signum())
                })
                .collect();
            let surplus =
                |up: f64| mean(wheels.iter().filter(|(jump, _)| jump * up > 25.0).map(|(_, surplus)| *surplus));
            [surplus(1.0), surplus(-1.0)]
        };
        let (without, with) = driving.without_and_with("soft_start", jumps);
        assert!(with[0] < without[0] - 1.2 && (with[1] - without[1]).abs() < 0.2, "{without:?} {with:?}");
    }
}

#[test]
fn compass_damping_gives_the_last_command_more_of_the_turn_alone() {
    for driving in drivings() {
        let last = |m: &Measured| {
            let turn = |s: &MotionSample| (s.speeds[1] - s.speeds[0], s.speeds[3] - s.speeds[2], s.turn_rad / 0.0143);
            let way = |s: &MotionSample| (s.speeds[0] + s.speeds[1], s.speeds[2] + s.speeds[3], s.forward_cm / 0.082);
            [two_slopes(m.motion.iter().map(turn)).1, two_slopes(m.motion.iter().map(way)).1]
        };
        let (without, with) = driving.without_and_with("compass_damping", last);
        assert!(with[0] > without[0] + 0.1 && (with[1] - without[1]).abs() < 0.02, "{without:?} {with:?}");
    }
}

#[test]
fn edge_blur_scatters_positions_far_from_the_middle() {
    for driving in drivings() {
        let aside = |m: &Measured| {
            let middle_cm = m.logs.scene.arena_cm.expect("the room has walls") / 2.0;
            [(0.0, 60.0), (110.0, 1e3)].map(|(near_cm, far_cm): (f64, f64)| {
                let straight = m.motion.iter().filter(|s| s.turn_rad.abs() < 0.1);
                let there =
                    straight.filter(|s| (near_cm..far_cm).contains(&pose(m, s).position_cm.distance(middle_cm)));
                scatter(there.map(|s| s.lateral_cm))
            })
        };
        let (without, with) = driving.without_and_with("edge_blur", aside);
        assert!(without[1] < 1.2 * without[0] && with[1] > 3.0 * with[0], "{without:?} {with:?}");
    }
}

#[test]
fn motor_whine_drowns_echoes_at_high_wheel_speeds() {
    for driving in drivings() {
        let rates = |m: &Measured| {
            let pace = |s: &SonarSample| {
                let [left, right] = m.logs.runs[s.run].rows.at(s.row - 1).command();
                (left.abs() + right.abs()) / 2.0
            };
            [(0.0, 30.0), (50.0, 100.0)].map(|(slow, fast)| {
                let far = m.sonar.iter().filter(|s| s.row > 0 && s.distance_cm > 30.0 && s.alpha_deg() < 40.0);
                share(far.filter(|s| (slow..fast).contains(&pace(s))).map(|s| s.echo_cm.is_some()))
            })
        };
        let (without, with) = driving.without_and_with("motor_whine", rates);
        assert!(with[1] < without[1] - 0.2 && (with[0] - without[0]).abs() < 0.12, "{without:?} {with:?}");
    }
}

#[test]
fn a_blind_zone_takes_near_echoes_and_leaves_others() {
    for driving in drivings() {
        let rates = |m: &Measured| {
            [(10.0, 22.0), (45.0, 70.0)].map(|(near_cm, far_cm)| {
                let ahead = m.sonar.iter().filter(|s| s.alpha_deg() < 25.0);
                share(ahead.filter(|s| (near_cm..far_cm).contains(&s.distance_cm)).map(|s| s.echo_cm.is_some()))
            })
        };
        let (without, with) = driving.without_and_with("blind_zone=30", rates);
        assert!(without[0] > 0.9 && with[0] < 0.3 && (with[1] - without[1]).abs() < 0.1, "{without:?} {with:?}");
    }
}
