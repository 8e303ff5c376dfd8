//! Effects outside the table of docs/reference/effects.md, which a diagnosis should report as unknown.

use mindgap_built_in_robot::Effect;
use mindgap_foundations::geometry::cast;
use mindgap_logs::samples::MotionSample;

use super::measures::{
    Measured, asked_motion, covered_cm, drivings, is_steady, jump, mean, median, scatter, share, slope, surplus_cm,
};
use super::sonar::one_sidedness;

/// Turn in excess of the healthy robot's, degrees.
fn turn_surplus_deg(s: &MotionSample) -> f64 {
    (s.turn_rad - 0.88 * asked_motion(s).1).to_degrees()
}

#[test]
fn table_has_32_effects_and_others_are_outside() {
    let (inside, outside): (Vec<Effect>, Vec<Effect>) = Effect::all().partition(|effect| effect.in_table());
    assert_eq!(inside.len(), 32);
    assert!(outside.len() >= 7 && outside.contains(&Effect::Unchanged));
}

#[test]
fn wheel_eccentricity_makes_straight_runs_wobble() {
    for driving in drivings() {
        let wobble = |m: &Measured| {
            let straight = m.motion.iter().filter(|s| is_steady(s) && (s.speeds[0] - s.speeds[1]).abs() <= 3.0);
            scatter(straight.map(|s| s.turn_rad.to_degrees()))
        };
        let (without, with) = driving.without_and_with("wheel_eccentricity", wobble);
        assert!(with > 1.4 * without, "{without} {with}");
    }
}

#[test]
fn backlash_loses_travel_when_a_wheel_reverses() {
    for driving in drivings() {
        let reversal =
            |m: &Measured| {
                let lost = m.motion.iter().flat_map(|s| {
                    let covered = covered_cm(s);
                    [0, 1].map(|side| (s.speeds[side], s.speeds[side + 2], covered[side]))
                });
                let reversed = lost.filter(|(now, last, _)| now * last < 0.0 && now.abs() > 15.0);
                mean(reversed.map(|(now, last, covered)| {
                    covered * now.signum() - 0.164 * (0.85 * now.abs() - 0.15 * last.abs())
                }))
            };
        let (without, with) = driving.without_and_with("backlash", reversal);
        assert!(with < without - 0.4, "{without} {with}");
    }
}

#[test]
fn castor_kick_turns_the_robot_when_it_reverses() {
    for driving in drivings() {
        let kick = |m: &Measured| {
            let backed =
                |s: &&MotionSample| asked_motion(s).0 * (s.speeds[2] + s.speeds[3]) < 0.0 && jump(s).abs() > 20.0;
            scatter(m.motion.iter().filter(backed).map(turn_surplus_deg))
        };
        let (without, with) = driving.without_and_with("castor_kick=1.5", kick);
        assert!(with > 1.3 * without, "{without} {with}");
    }
}

#[test]
fn brush_advance_weakens_wheels_backwards() {
    for driving in drivings() {
        let backwards = |m: &Measured| {
            let steady = m.motion.iter().filter(|s| is_steady(s));
            let wheels: Vec<(f64, f64)> = steady
                .flat_map(|s| {
                    let covered = covered_cm(s);
                    [0, 1].map(|side| (s.speeds[side], covered[side]))
                })
                .collect();
            let way = |sign: f64| slope(wheels.iter().copied().filter(|(command, _)| command * sign > 15.0));
            way(-1.0) / way(1.0)
        };
        let (without, with) = driving.without_and_with("brush_advance", backwards);
        assert!(with < 0.9 * without, "{without} {with}");
    }
}

#[test]
fn sticky_patch_slows_the_robot_in_the_centre_of_the_room() {
    for driving in drivings() {
        let middle = |m: &Measured| {
            let middle_cm = m.logs.scene.arena_cm.expect("the room has walls") / 2.0;
            let way = |inside: bool| {
                slope(m.motion.iter().filter_map(|s| {
                    let at_cm = m.logs.runs[s.run].rows.at(s.row).pose?.position_cm;
                    ((at_cm.distance(middle_cm) < 65.0) == inside).then_some((asked_motion(s).0, s.forward_cm))
                }))
            };
            way(true) / way(false)
        };
        let (without, with) = driving.without_and_with("sticky_patch", middle);
        assert!((0.96..1.04).contains(&without) && with < 0.92, "{without} {with}");
    }
}

#[test]
fn command_quantisation_rounds_speeds() {
    for driving in drivings() {
        let speed = |m: &Measured, low: f64, high: f64| {
            let steady = m.motion.iter().filter(|s| is_steady(s)).flat_map(|s| {
                let covered = covered_cm(s);
                [0, 1].map(|side| (s.speeds[side], covered[side]))
            });
            slope(steady.filter(|(command, _)| (low..high).contains(&command.abs())))
        };
        let (without, with) =
            driving.without_and_with("command_quantisation=20", |m| [speed(m, 21.0, 29.0), speed(m, 31.0, 39.0)]);
        assert!(without[1] < 1.2 * without[0] && with[1] > 1.4 * with[0], "{without:?} {with:?}");
    }
}

#[test]
fn link_jitter_scatters_steps_at_which_the_command_jumps() {
    for driving in drivings() {
        let scattered = |m: &Measured| {
            let at_jumps =
                |large: bool| scatter(m.motion.iter().filter(|s| (jump(s).abs() > 30.0) == large).map(surplus_cm));
            at_jumps(true) / at_jumps(false)
        };
        let (without, with) = driving.without_and_with("link_jitter", scattered);
        assert!(without < 1.6 && with > 1.8 * without, "{without} {with}");
    }
}

#[test]
fn soft_obstacles_echo_less_than_the_arena() {
    for driving in drivings() {
        let rate = |m: &Measured, obstacle: bool| {
            let sides = m.logs.scene.sides();
            share(m.sonar.iter().filter(|s| s.distance_cm > 30.0 && s.alpha_deg() < 45.0).filter_map(|s| {
                let sensor = m.logs.robot.sensor_pose(&m.logs.runs[s.run].rows.at(s.row).pose?);
                let hit = cast(&sides, sensor.position_cm, sensor.direction())?;
                ((hit.wall >= 4) == obstacle).then_some(s.echo_cm.is_some())
            }))
        };
        let (without, with) = driving.without_and_with("soft_obstacles", |m| [rate(m, false), rate(m, true)]);
        assert!(with[1] < without[1] - 0.2 && (with[0] - without[0]).abs() < 0.12, "{without:?} {with:?}");
    }
}

#[test]
fn sonar_drift_stretches_readings_over_the_run() {
    for driving in drivings() {
        let later = |m: &Measured| {
            let ratio = |late: bool| {
                let square = m.sonar.iter().filter(|s| s.alpha_deg() < 15.0 && s.distance_cm > 25.0);
                median(square.filter(|s| (s.row > 35) == late).filter_map(|s| Some(s.echo_cm? / s.distance_cm)))
            };
            ratio(true) / ratio(false)
        };
        let (without, with) = driving.without_and_with("sonar_drift=0.4", later);
        assert!((0.98..1.02).contains(&without) && (1.04..1.15).contains(&with), "{without} {with}");
    }
}

#[test]
fn sonar_one_sided_makes_echoes_depend_on_the_side() {
    for driving in drivings() {
        let left = driving.with_effect("sonar_one_sided=30", one_sidedness);
        let right = driving.with_effect("sonar_one_sided=-30", one_sidedness);
        assert!((left - right).abs() > 0.2 && left * right < 0.0, "{left} {right}");
    }
}

#[test]
fn motion_noise_scatters_travel_but_keeps_its_mean() {
    for driving in drivings() {
        let ways = |m: &Measured| {
            let ahead = || m.motion.iter().filter(|s| is_steady(s) && asked_motion(s).0 > 4.0);
            let share = mean(ahead().map(|s| s.forward_cm / asked_motion(s).0));
            (share, scatter(ahead().map(|s| s.forward_cm - share * asked_motion(s).0)))
        };
        let (without, with) = driving.without_and_with("motion_noise", ways);
        assert!((with.0 / without.0 - 1.0).abs() < 0.05 && with.1 > 1.1 * without.1, "{without:?} {with:?}");
    }
}
