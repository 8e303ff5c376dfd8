//! For tests: the readings in cells, so that the frequencies of draws can be compared with the outcomes.

use glam::DVec2;

use super::outcomes::{Distribution, Outcomes};
use super::{Perturbation, SonarModel};
use mindgap_foundations::geometry::{Pose, Rectangle};
use mindgap_foundations::statistics::student;
use mindgap_logs::Scene;

/// Sensors in which no part of the mixture is missing. Hits scatter little, so that cells separate them.
pub const SENSORS: [SonarModel; 3] = [
    SonarModel {
        strength: [1.0, 2.0, -2.0, 1.0, -1.0, -0.5, -1.0, -0.5, -1.0, -0.5],
        mirror_loss: Some(1.0),
        bias: [-0.3, 0.01, -0.3],
        log_scatter: [-2.5, 0.1, 0.1],
        constant: [0.1, 21.0],
        p_constant_given_none: 0.15,
        p_short: 0.08,
        p_dropout: 0.1,
        fan_width: 0.9,
        range_cm: [4.0, 240.0],
    },
    SonarModel {
        strength: [-2.0, 0.5, -0.4, 0.3, -0.2, -0.1, -0.3, -0.1, -0.4, -0.2],
        mirror_loss: Some(-0.5),
        bias: [1.5, -0.02, 0.5],
        log_scatter: [-2.0, -0.2, 0.3],
        constant: [0.03, 61.0],
        p_constant_given_none: 0.4,
        p_short: 0.25,
        p_dropout: 0.02,
        fan_width: 1.4,
        range_cm: [6.0, 200.0],
    },
    SonarModel {
        strength: [6.0, -1.0, 0.1, -1.0, 0.2, -0.1, -0.1, 0.1, -0.5, -0.1],
        mirror_loss: None,
        bias: [-1.0, 0.005, 0.2],
        log_scatter: [-2.2, 0.1, -0.1],
        constant: [0.25, 150.0],
        p_constant_given_none: 0.02,
        p_short: 0.02,
        p_dropout: 0.3,
        fan_width: 0.3,
        range_cm: [3.0, 255.0],
    },
];

/// A perturbation in which no part is missing either.
pub const PERTURBED: Perturbation = Perturbation {
    width: 1.0,
    attenuation: 0.2,
    attenuation_per_m: 0.1,
    attenuation_per_incidence: 0.3,
    spreading: 0.0,
    mirroring: 0.0,
    attenuation_mirrored: -0.5,
    gain: 1.05,
    offset_cm: -2.0,
    scatter_cm: 0.1,
    p_dropout: 0.1,
    p_ghost_given_echo: 0.12,
    p_ghost_given_none: 0.07,
    ghost_cm: 34.0,
    p_short: 0.05,
    p_long: 0.06,
    p_long_given_none: 0.05,
    floor_cm: f64::INFINITY,
    p_floor: 0.0,
};

/// Returns a room with an obstacle, and the obstacle alone, where a fan may hit nothing.
pub fn scenes() -> [Scene; 2] {
    let obstacles = vec![Rectangle { low_cm: DVec2::new(110.0, 60.0), high_cm: DVec2::new(140.0, 90.0) }];
    [Some(DVec2::new(300.0, 220.0)), None].map(|arena_cm| Scene {
        arena_cm,
        obstacles: obstacles.clone(),
        ..Scene::default()
    })
}

/// Returns poses of the sensor: facing the obstacle and its edge, walls near and far, a corner, and open space.
pub fn sensors() -> [Pose; 6] {
    [
        (40.0, 70.0, 0.0),
        (40.0, 70.0, 14.0),
        (200.0, 100.0, 70.0),
        (160.0, 76.0, 181.0),
        (280.0, 25.0, -50.0),
        (15.0, 140.0, 176.0),
    ]
    .map(|(x, y, deg)| Pose::new(x, y, f64::to_radians(deg)))
}

/// Cells that separate the readings about each value from one another and from the rest.
pub struct Partition {
    /// Inner borders, cm, ascending.
    borders_cm: Vec<f64>,
}

impl Partition {
    /// Number of scales to either side of a value that its cell holds: all but one in ten thousand of its readings.
    const SCALES: f64 = 10.0;

    /// Returns the cells of these outcomes.
    pub fn new(outcomes: &Outcomes) -> Self {
        let window = |distribution: &Distribution| match *distribution {
            Distribution::Student { middle_cm, scale_cm } | Distribution::Within { middle_cm, scale_cm, .. } => {
                Some([middle_cm - Self::SCALES * scale_cm, middle_cm + Self::SCALES * scale_cm])
            }
            Distribution::Uniform { .. } => None,
        };
        let possible = outcomes.components.iter().filter(|c| c.probability > 0.0);
        let mut windows: Vec<[f64; 2]> = possible.filter_map(|c| window(&c.distribution)).collect();
        windows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut joined: Vec<[f64; 2]> = Vec::new();
        for [from, to] in windows {
            match joined.last_mut() {
                Some(last) if from <= last[1] => last[1] = last[1].max(to),
                _ => joined.push([from, to]),
            }
        }
        let [low, high] = outcomes.range_cm;
        Partition { borders_cm: joined.into_iter().flatten().filter(|cm| (low..high).contains(cm)).collect() }
    }

    /// Returns both ends of each cell, cm; the first and the last are unbounded, since readings are limited to the range.
    pub fn cells(&self) -> Vec<[f64; 2]> {
        let ends = [&[f64::NEG_INFINITY], self.borders_cm.as_slice(), &[f64::INFINITY]].concat();
        ends.windows(2).map(|ends| [ends[0], ends[1]]).collect()
    }

    /// Returns the probability of no reading, then of one in each cell.
    pub fn probabilities(&self, outcomes: &Outcomes) -> Vec<f64> {
        let cells = self.cells().into_iter().map(|[from, to]| probability_between(outcomes, from, to));
        [outcomes.none].into_iter().chain(cells).collect()
    }

    /// Returns the number of these readings in each of these outcomes.
    pub fn count(&self, readings: impl Iterator<Item = Option<f64>>) -> Vec<f64> {
        let mut counts = vec![0.0; self.borders_cm.len() + 2];
        for reading in readings {
            counts[reading.map_or(0, |cm| 1 + self.borders_cm.partition_point(|border| *border <= cm))] += 1.0;
        }
        counts
    }
}

/// Returns the probability of a reading between two values, before readings are limited to the range.
pub fn probability_between(outcomes: &Outcomes, from: f64, to: f64) -> f64 {
    let below = |distribution: &Distribution, cm: f64| match *distribution {
        _ if cm.is_infinite() => f64::from(u8::from(cm > 0.0)),
        Distribution::Student { middle_cm, scale_cm } => student::cumulative((cm - middle_cm) / scale_cm),
        Distribution::Within { middle_cm, scale_cm, below, inside, at_ends: [at_low, _] } => {
            let share = (student::cumulative((cm - middle_cm) / scale_cm) - below).clamp(0.0, inside);
            (at_low + share) / distribution.reported()
        }
        Distribution::Uniform { low_cm, high_cm } => ((cm - low_cm) / (high_cm - low_cm)).clamp(0.0, 1.0),
    };
    let between = |distribution| below(distribution, to) - below(distribution, from);
    outcomes.components.iter().map(|c| c.probability * between(&c.distribution)).sum()
}

/// Asserts by Pearson's chi-square test that counts follow probabilities. Outcomes expected less than five times are
/// pooled.
pub fn assert_follow(counts: &[f64], probabilities: &[f64], what: &str) {
    let total: f64 = counts.iter().sum();
    let (mut squares, mut cells, mut pooled) = (0.0, 0.0, [0.0; 2]);
    let mut add = |n: f64, expected: f64| {
        squares += (n - expected) * (n - expected) / expected;
        cells += 1.0;
    };
    for (n, p) in counts.iter().zip(probabilities) {
        if total * p < 5.0 {
            pooled = [pooled[0] + n, pooled[1] + total * p];
        } else {
            add(*n, total * p);
        }
    }
    // Fewer outcomes cannot be tested.
    if pooled[1] >= 1.0 {
        add(pooled[0], pooled[1]);
    }
    // The quantile four standard errors out by Wilson and Hilferty (1931): of thirty thousand samples one exceeds it.
    let degrees = f64::max(cells - 1.0, 1.0);
    let cube_root = 1.0 - 2.0 / (9.0 * degrees) + 4.0 * (2.0 / (9.0 * degrees)).sqrt();
    let bound = degrees * cube_root * cube_root * cube_root;
    assert!(squares < bound, "{what}: {squares} of {bound}\n{counts:?}\n{probabilities:?}");
}
