//! Made-up data of the kind that the figures show.

use glam::{DVec2, DVec3};
use mindgap_figures::report::expected_against_predicted::{Panel, Samples};
use mindgap_figures::report::paths::{PathPanel, Trace};
use mindgap_figures::report::sonar_surfaces::Surface;
use mindgap_foundations::geometry::{Pose, Rectangle, direction};
use mindgap_foundations::random::{Generator, generator};
use mindgap_logs::Scene;
use rand::RngExt;
use rand_distr::{Distribution, StandardNormal};

fn normal(chance: &mut Generator) -> f64 {
    StandardNormal.sample(chance)
}

/// How likely an echo is at a distance (cm) and an incidence angle (degrees).
pub fn echo_probability(distance_cm: f64, incidence_deg: f64) -> f64 {
    0.97 / (1.0 + libm::exp((incidence_deg - 58.0 + 0.1 * distance_cm) / 9.0))
}

/// What a sonar reads, cm.
pub fn echo_cm(distance_cm: f64, incidence_deg: f64) -> f64 {
    distance_cm * (1.0 + 0.25 * libm::sin(incidence_deg / 40.0)) + 4.0
}

/// The five networks; the sonar's reading has one wild prediction and one that is not a number.
pub fn networks() -> Vec<Panel> {
    let mut chance = generator(1, &[2]);
    let mut values = |title: &str, unit: &str, span: f64, noise: f64, n: usize| {
        let pair = |_| {
            let expected = span * chance.random_range(-0.3..1.0);
            DVec2::new(expected, 0.95 * expected + 0.02 * span + noise * normal(&mut chance))
        };
        Panel { title: title.into(), samples: Samples::Values { unit: unit.into(), pairs: (0..n).map(pair).collect() } }
    };
    let mut panels = vec![
        values("(a) forward", "cm", 14.0, 0.6, 500),
        values("(b) lateral", "cm", 0.4, 0.08, 500),
        values("(c) turn", "°", 40.0, 3.0, 500),
        values("(e) echo reading", "cm", 180.0, 14.0, 1400),
    ];
    let Samples::Values { pairs, .. } = &mut panels[3].samples else { unreachable!() };
    pairs.push(DVec2::new(60.0, 1e7));
    pairs.push(DVec2::new(60.0, f64::NAN));
    for i in 0..60 {
        pairs.push(DVec2::new(20.0, 30.0 + 2.0 * f64::from(i)));
    }
    let event = |_| {
        let p = libm::sqrt(chance.random::<f64>());
        (p, chance.random::<f64>() < 0.06 + 0.88 * p)
    };
    let events = (0..1700).map(event).collect();
    panels.insert(3, Panel { title: "(d) echo probability".into(), samples: Samples::Events(events) });
    panels
}

/// The two sonar networks with their test data.
pub fn surfaces() -> Vec<Surface<'static>> {
    let mut chance = generator(3, &[4]);
    let mut places = |n: usize| -> Vec<(f64, f64)> {
        (0..n).map(|_| (240.0 * chance.random::<f64>(), 90.0 * chance.random::<f64>())).collect()
    };
    let (first, second) = (places(160), places(160));
    let fired = first
        .into_iter()
        .map(|(d, a)| DVec3::new(d, a, f64::from(u8::from(chance.random::<f64>() < echo_probability(d, a)))));
    let fired = fired.collect();
    let read = second.into_iter().map(|(d, a)| DVec3::new(d, a, echo_cm(d, a) + (1.0 + a / 4.0) * normal(&mut chance)));
    let surface = |title: &str, value_name: &str, at: fn(f64, f64) -> f64, value, test| Surface {
        title: title.into(),
        value_name: value_name.into(),
        at: Box::new(at),
        known: Box::new(|_, _| true),
        distance_cm: 0.0..240.0,
        incidence_deg: 0.0..90.0,
        value,
        test,
    };
    vec![
        surface("(a) echo probability", "echo probability", echo_probability, 0.0..1.0, fired),
        surface("(b) echo reading", "echo reading (cm)", echo_cm, 0.0..320.0, read.collect()),
    ]
}

/// Four starts in a scene with four obstacles; the first start's real runs crash.
pub fn starts() -> Vec<PathPanel> {
    let obstacle = |x: f64, y: f64, width: f64, height: f64| Rectangle {
        low_cm: DVec2::new(x, y),
        high_cm: DVec2::new(x + width, y + height),
    };
    let scene = Scene {
        arena_cm: Some(DVec2::new(300.0, 220.0)),
        obstacles: vec![
            obstacle(70.0, 60.0, 40.0, 25.0),
            obstacle(150.0, 20.0, 25.0, 60.0),
            obstacle(90.0, 140.0, 60.0, 30.0),
            obstacle(200.0, 120.0, 30.0, 45.0),
        ],
        target_cm: Some(DVec2::new(265.0, 115.0)),
        ..Scene::default()
    };
    let starts = [(30.0, 30.0, 0.3), (40.0, 190.0, -0.4), (280.0, 20.0, 2.2), (30.0, 110.0, 0.0)];
    let panel = |(i, (x, y, heading)): (usize, (f64, f64, f64))| {
        let start = Pose::new(x, y, heading);
        let trace = |run: u64, real: bool| {
            let mut chance = generator(5, &[i as u64, run]);
            let (mut at, mut heading) = (start.position_cm, heading);
            let mut points_cm = vec![at];
            let crashed = real && i == 0 && run < 2;
            for _ in 0..if crashed { 14 } else { 40 } {
                let wish = DVec2::new(265.0, 115.0) - at;
                if wish.length() < 8.0 {
                    break;
                }
                heading += 0.12 * normal(&mut chance) + 0.2 * (direction(-heading).rotate(wish).to_angle());
                at += 8.0 * direction(heading);
                points_cm.push(at);
            }
            if real && i == 3 {
                points_cm[8] = DVec2::NAN;
            }
            Trace { points_cm, crashed }
        };
        PathPanel {
            title: format!("({}) start {}", char::from(b'a' + i as u8), i + 1),
            scene: scene.clone(),
            start,
            target_radius_cm: 10.0,
            simulated: (0..3).map(|run| trace(10 + run, false)).collect(),
            real: (0..3).map(|run| trace(run, true)).collect(),
        }
    };
    starts.into_iter().enumerate().map(panel).collect()
}
