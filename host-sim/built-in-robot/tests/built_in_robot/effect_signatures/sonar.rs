//! Effects of the ultrasonic sensor.

use mindgap_logs::samples::SonarSample;

use super::measures::{Measured, drivings, mean, median, scatter, share};

/// Samples of a wall at nearly normal incidence within a range of distances.
fn square(m: &Measured, near_cm: f64, far_cm: f64) -> impl Iterator<Item = &SonarSample> {
    m.sonar.iter().filter(move |s| s.alpha_deg() < 12.0 && (near_cm..far_cm).contains(&s.distance_cm))
}

/// Readings minus distances.
fn errors<'a>(samples: impl Iterator<Item = &'a SonarSample>) -> impl Iterator<Item = f64> {
    samples.filter_map(|s| Some(s.echo_cm? - s.distance_cm))
}

/// Fraction of samples with a reading.
fn rate<'a>(samples: impl Iterator<Item = &'a SonarSample>) -> f64 {
    share(samples.map(|s| s.echo_cm.is_some()))
}

/// Fraction of readings that satisfy a condition.
fn readings_that<'a>(samples: impl Iterator<Item = &'a SonarSample>, holds: impl Fn(f64, f64) -> bool) -> f64 {
    share(samples.filter_map(|s| Some(holds(s.echo_cm?, s.distance_cm))))
}

/// Echo rate with the wall's normal to the left of the axis minus that to its right, at oblique incidence.
pub fn one_sidedness(m: &Measured) -> f64 {
    let oblique = |left: bool| {
        let far = m.sonar.iter().filter(|s| s.distance_cm > 40.0 && (20.0..60.0).contains(&s.alpha_deg()));
        rate(far.filter(move |s| (s.incidence_rad > 0.0) == left))
    };
    oblique(true) - oblique(false)
}

#[test]
fn sonar_scale_stretches_readings() {
    for driving in drivings() {
        let ratio = |m: &Measured| {
            [(20.0, 50.0), (70.0, 140.0)]
                .map(|(near, far)| median(square(m, near, far).filter_map(|s| Some(s.echo_cm? / s.distance_cm))))
        };
        let (without, with) = driving.without_and_with("sonar_scale=1.08", ratio);
        for (without, with) in without.iter().zip(with) {
            assert!((1.05..1.11).contains(&(with / without)), "{without} {with}");
        }
    }
}

#[test]
fn sonar_offset_adds_one_length() {
    for driving in drivings() {
        let error =
            |m: &Measured| [(20.0, 50.0), (70.0, 140.0)].map(|(near, far)| median(errors(square(m, near, far))));
        let (without, with) = driving.without_and_with("sonar_offset=-4", error);
        for (without, with) in without.iter().zip(with) {
            assert!((-5.0..-3.0).contains(&(with - without)), "{without} {with}");
        }
    }
}

#[test]
fn sonar_yaw_makes_echoes_depend_on_the_side() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("sonar_yaw=20", one_sidedness);
        let other = driving.with_effect("sonar_yaw=-20", one_sidedness);
        assert!(other < without - 0.12 && without < with - 0.12, "{other} {without} {with}");
    }
}

#[test]
fn sonar_pitch_hides_what_is_beyond_the_floor() {
    for driving in drivings() {
        let beyond = |m: &Measured| {
            let far = || m.sonar.iter().filter(|s| s.distance_cm > 90.0);
            [readings_that(far(), |echo, _| echo > 85.0), readings_that(far(), |echo, _| (echo - 70.0).abs() < 8.0)]
        };
        let near = |m: &Measured| rate(square(m, 10.0, 40.0));
        let (without, with) = driving.without_and_with("sonar_pitch=70", |m| (beyond(m), near(m)));
        assert!(without.0[0] > 0.5 && with.0[0] < 0.05, "{without:?} {with:?}");
        assert!(without.0[1] < 0.1 && with.0[1] > 0.6, "{without:?} {with:?}");
        assert!((without.1 - with.1).abs() < 0.03, "{without:?} {with:?}");
    }
}

#[test]
fn sonar_beam_wider_reads_shorter_at_oblique_walls() {
    for driving in drivings() {
        let ratio = |m: &Measured| {
            let oblique = m.sonar.iter().filter(|s| (25.0..55.0).contains(&s.alpha_deg()) && s.distance_cm < 100.0);
            median(oblique.filter_map(|s| Some(s.echo_cm? / s.distance_cm)))
        };
        let (without, wide) = driving.without_and_with("sonar_beam=2.4", ratio);
        let narrow = driving.with_effect("sonar_beam=0.3", ratio);
        assert!(wide < without - 0.03 && narrow > without + 0.03, "{narrow} {without} {wide}");
    }
}

#[test]
fn sonar_ghost_reads_one_distance() {
    for driving in drivings() {
        let ghosts = |m: &Measured| {
            readings_that(m.sonar.iter().filter(|s| s.distance_cm > 75.0), |echo, _| (echo - 48.0).abs() < 2.5)
        };
        let (without, with) = driving.without_and_with("sonar_ghost=0.15@48", ghosts);
        assert!(without < 0.05 && with > without + 0.08, "{without} {with}");
    }
}

#[test]
fn sonar_dropout_loses_consecutive_readings() {
    for driving in drivings() {
        // In this range a healthy sensor hardly ever misses.
        let near = |s: &&SonarSample| s.distance_cm < 30.0 && s.alpha_deg() < 40.0;
        let missed = |m: &Measured| 1.0 - rate(m.sonar.iter().filter(near));
        let missed_again = |m: &Measured| {
            let pairs = m.sonar.windows(2).filter(|w| w[0].row + 1 == w[1].row && w.iter().all(|s| near(&s)));
            share(pairs.filter(|w| w[0].echo_cm.is_none()).map(|w| w[1].echo_cm.is_none()))
        };
        let (without, (with, again)) =
            (driving.healthy(missed), driving.with_effect("sonar_dropout=0.25", |m| (missed(m), missed_again(m))));
        assert!(without < 0.05 && with > 0.12 && again > with + 0.25, "{without} {with} {again}");
    }
}

#[test]
fn sonar_lag_reads_past_distances() {
    for driving in drivings() {
        let stale = |m: &Measured| {
            let pairs =
                m.sonar.windows(2).filter(|w| w[0].row + 1 == w[1].row && w.iter().all(|s| s.alpha_deg() < 20.0));
            let moved = pairs.filter(|w| (3.0..12.0).contains(&(w[0].distance_cm - w[1].distance_cm).abs()));
            median(
                moved.filter_map(|w| Some((w[1].echo_cm? - w[1].distance_cm) / (w[0].distance_cm - w[1].distance_cm))),
            )
        };
        let (without, with) = driving.without_and_with("sonar_lag=1", stale);
        assert!(without.abs() < 0.35 && (0.7..1.3).contains(&with), "{without} {with}");
    }
}

#[test]
fn sonar_absorption_removes_far_echoes() {
    for driving in drivings() {
        let rates = |m: &Measured| [rate(square(m, 10.0, 30.0)), rate(m.sonar.iter().filter(|s| s.distance_cm > 80.0))];
        let (without, with) = driving.without_and_with("sonar_absorption=0.35", rates);
        assert!(with[0] > 0.9 && with[1] < without[1] - 0.1, "{without:?} {with:?}");
    }
}

#[test]
fn sonar_crosstalk_gives_short_readings_at_random() {
    for driving in drivings() {
        let short = |m: &Measured| {
            let far = m.sonar.iter().filter(|s| s.distance_cm > 60.0);
            let readings: Vec<f64> = far.filter_map(|s| s.echo_cm).collect();
            // Below and above the constant reading of a ringing transducer.
            [(4.0, 17.0), (23.0, 50.0)].map(|(from, to)| share(readings.iter().map(|echo| (from..to).contains(echo))))
        };
        let (without, with) = driving.without_and_with("sonar_crosstalk=0.3", short);
        for (without, with) in without.iter().zip(with) {
            assert!(with > without + 0.015, "{without} {with}");
        }
    }
}

#[test]
fn sonar_multipath_gives_long_readings_at_oblique_incidence() {
    for driving in drivings() {
        let long = |m: &Measured| {
            let oblique = m.sonar.iter().filter(|s| s.distance_cm > 20.0 && s.alpha_deg() > 50.0);
            share(oblique.filter_map(|s| Some(s.echo_cm? > s.distance_cm + 15.0)))
        };
        let (without, with) = driving.without_and_with("sonar_multipath=16", long);
        assert!(without < 0.12 && with > without + 0.08, "{without} {with}");
    }
}

#[test]
fn sonar_noise_scatters_readings() {
    for driving in drivings() {
        let (without, with) = driving.without_and_with("sonar_noise=4", |m| {
            let close = || errors(square(m, 30.0, 100.0)).filter(|e| e.abs() < 15.0);
            (mean(close()), scatter(close()))
        });
        assert!(without.1 < 2.0 && (3.0..5.0).contains(&with.1), "{without:?} {with:?}");
        assert!((with.0 - without.0).abs() < 1.0, "{without:?} {with:?}");
    }
}
