//! Effects of camera and compass.

use mindgap_foundations::geometry::wrap_rad;

use super::measures::{Measured, asked_motion, drivings, is_steady, median, slope, two_slopes};

/// Observed per commanded forward travel between two distances from the centre of the picture.
fn forward_between(m: &Measured, near_cm: f64, far_cm: f64) -> f64 {
    let middle_cm = m.logs.scene.arena_cm.expect("the room has walls") / 2.0;
    slope(m.motion.iter().filter_map(|s| {
        let pose = m.logs.runs[s.run].rows.at(s.row).pose?;
        let inside = (near_cm..far_cm).contains(&pose.position_cm.distance(middle_cm));
        inside.then_some((asked_motion(s).0, s.forward_cm))
    }))
}

#[test]
fn tracker_rotation_turns_displacements_against_headings() {
    for driving in drivings() {
        let aside = |m: &Measured| {
            let straight = m.motion.iter().filter(|s| s.turn_rad.abs() < 0.1 && s.forward_cm.abs() > 3.0);
            slope(straight.map(|s| (s.forward_cm, s.lateral_cm)))
        };
        let (without, with) = driving.without_and_with("tracker_rotation=6", aside);
        assert!(without.abs() < 0.02 && (0.085..0.125).contains(&with), "{without} {with}");
    }
}

#[test]
fn tracker_scale_stretches_only_displacements() {
    for driving in drivings() {
        let both = |m: &Measured| {
            let turn = slope(m.motion.iter().map(|s| (asked_motion(s).1, s.turn_rad)));
            (forward_between(m, 0.0, 1e3), turn)
        };
        let (without, with) = driving.without_and_with("tracker_scale=1.06", both);
        assert!((1.045..1.075).contains(&(with.0 / without.0)), "{without:?} {with:?}");
        assert!((0.99..1.01).contains(&(with.1 / without.1)), "{without:?} {with:?}");
    }
}

#[test]
fn lens_distortion_stretches_displacements_at_the_edge() {
    for driving in drivings() {
        let edge = |m: &Measured| forward_between(m, 110.0, 1e3) / forward_between(m, 0.0, 60.0);
        let (without, with) = driving.without_and_with("lens_distortion=0.05", edge);
        assert!((0.95..1.05).contains(&without) && with > without + 0.06, "{without} {with}");
    }
}

#[test]
fn compass_disturbance_gives_heading_dependent_errors() {
    for driving in drivings() {
        let amplitude_deg = |m: &Measured| {
            let (a, b) = two_slopes(m.motion.iter().filter_map(|s| {
                let rows = &m.logs.runs[s.run].rows;
                let (from, to) = (rows.at(s.row).pose?.heading_rad, rows.at(s.row + 1).pose?.heading_rad);
                let surplus_deg = wrap_rad(s.turn_rad - 0.88 * asked_motion(s).1).to_degrees();
                Some((libm::sin(to) - libm::sin(from), libm::cos(to) - libm::cos(from), surplus_deg))
            }));
            libm::hypot(a, b)
        };
        let (without, with) = driving.without_and_with("compass_disturbance=8@70", amplitude_deg);
        assert!(without < 1.5 && (5.0..11.0).contains(&with), "{without} {with}");
    }
}

/// Of a heading that is old by a share of a step, a steady turn shows that share too little at the start of each step.
#[test]
fn heading_lag_turns_displacements_to_the_inside_of_turns() {
    for driving in drivings() {
        let inside = |m: &Measured| {
            let steady = m.motion.iter().filter(|s| is_steady(s) && s.forward_cm > 4.0);
            slope(steady.map(|s| (s.turn_rad, libm::atan2(s.lateral_cm, s.forward_cm) - 0.5 * s.turn_rad)))
        };
        let (without, with) = driving.without_and_with("heading_lag=160", inside);
        assert!(without.abs() < 0.03 && (0.33..0.47).contains(&with), "{without} {with}");
    }
}

#[test]
fn tracker_delay_shows_motion_late_and_readings_ahead() {
    for driving in drivings() {
        let late = |m: &Measured| {
            let mean = |pair: [f64; 2]| 0.5 * (pair[0] + pair[1]);
            let (now, before) = two_slopes(m.motion.iter().map(|s| {
                let [left, right, left_before, right_before] = s.speeds;
                (mean([left, right]), mean([left_before, right_before]), s.forward_cm)
            }));
            before / (now + before)
        };
        let ahead = |m: &Measured| {
            let pairs =
                m.sonar.windows(2).filter(|w| w[0].row + 1 == w[1].row && w.iter().all(|s| s.alpha_deg() < 20.0));
            let moved = pairs.filter(|w| (4.0..12.0).contains(&(w[0].distance_cm - w[1].distance_cm).abs()));
            median(
                moved.filter_map(|w| Some((w[1].distance_cm - w[1].echo_cm?) / (w[0].distance_cm - w[1].distance_cm))),
            )
        };
        let (without, with) = driving.without_and_with("tracker_delay=160", |m| (late(m), ahead(m)));
        assert!((0.3..0.5).contains(&(with.0 - without.0)), "{without:?} {with:?}");
        assert!((0.2..0.6).contains(&(with.1 - without.1)), "{without:?} {with:?}");
    }
}

#[test]
fn marker_offset_moves_the_tracked_point_around_the_axle() {
    for driving in drivings() {
        let carried = |m: &Measured| {
            let spins = || m.motion.iter().filter(|s| (s.speeds[0] + s.speeds[1]).abs() < 1.0);
            let aside = slope(spins().map(|s| (libm::sin(s.turn_rad), s.lateral_cm)));
            (aside, slope(spins().map(|s| (-libm::sin(s.turn_rad), s.forward_cm))))
        };
        let (without, with) = driving.without_and_with("marker_offset=4@-3", carried);
        assert!(without.0.abs() < 0.3 && (3.5..4.5).contains(&with.0), "{without:?} {with:?}");
        assert!(without.1.abs() < 0.3 && (-3.5..-2.5).contains(&with.1), "{without:?} {with:?}");
    }
}
