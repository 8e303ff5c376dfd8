//! Outliers: robots whose gap or effect parameter is far from the fleet's median.

use schemars::JsonSchema;
use serde::Serialize;

use super::spread::Spread;
use super::tally::Tally;
use mindgap_foundations::statistics::rounding::three_digits;

/// Inverse of the family-wise false-alarm rate.
const FLEETS: f64 = 20.0;
/// Efficiency of the median absolute deviation relative to the standard deviation (Rousseeuw and Croux 1993, Alternatives
/// to the median absolute deviation).
const EFFICIENCY: f64 = 0.37;
/// Minimum number of robots to estimate a deviation.
const FEWEST: usize = 10;
/// Number of bisections to find a quantile in double precision.
const BISECTIONS: usize = 60;

/// A robot that is an outlier in one quantity.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Outlier {
    /// Its name.
    pub robot: String,
    /// Quantity: `gap_nats` or `EFFECT.PARAMETER`.
    pub what: String,
    /// Value of the robot.
    pub value: f64,
    /// Median of the fleet.
    pub median: f64,
    /// Distance from the median, in deviations of the fleet.
    pub deviations: f64,
    /// Distance beyond which a robot is an outlier.
    pub threshold: f64,
}

/// A quantity of several robots: its name, whether it is compared by ratios, and the values by index in the tally.
struct Measure {
    what: String,
    by_ratio: bool,
    values: Vec<(usize, f64)>,
}

/// Returns the outliers, most extreme first.
pub fn outliers(tally: &Tally) -> Vec<Outlier> {
    let measures = measures(tally);
    let mut outliers: Vec<Outlier> =
        measures.iter().flat_map(|measure| beyond(measure, measures.len(), tally)).collect();
    outliers.sort_by(|a, b| b.deviations.total_cmp(&a.deviations).then_with(|| a.robot.cmp(&b.robot)));
    outliers
}

/// Returns the quantities that enough robots have.
fn measures(tally: &Tally) -> Vec<Measure> {
    // Gaps grow with the square of the error.
    let gaps =
        tally.gaps_nats.iter().enumerate().filter_map(|(place, gap)| Some((place, gap.filter(|gap| *gap > 0.0)?)));
    let mut measures = vec![Measure { what: "gap_nats".into(), by_ratio: true, values: gaps.collect() }];
    for (effect, seen) in tally.catalogue.iter().zip(&tally.sightings) {
        let Some((form, robots)) = seen.main_form() else { continue };
        let parameters = effect.variants.iter().find(|variant| variant.id == form).map_or(&[][..], |v| v.parameters);
        measures.extend(parameters.iter().enumerate().map(|(i, parameter)| Measure {
            what: format!("{}.{}", effect.id, parameter.name),
            by_ratio: false,
            values: robots.iter().map(|(place, values)| (*place, values[i])).collect(),
        }));
    }
    measures.retain(|measure| measure.values.len() >= FEWEST);
    measures
}

fn beyond(measure: &Measure, measures: usize, tally: &Tally) -> Vec<Outlier> {
    let scaled = |value: f64| if measure.by_ratio { libm::log(value) } else { value };
    let Some(spread) = Spread::of(measure.values.iter().map(|(_, value)| scaled(*value)).collect()) else {
        return Vec::new();
    };
    let threshold = threshold(spread.n, measures);
    // If more than half of the values are equal, the deviation is zero and nothing can be compared.
    let far = |value: f64| (spread.deviation > 0.0).then(|| (scaled(value) - spread.median).abs() / spread.deviation);
    let outlier = |(place, value): &(usize, f64)| {
        let deviations = far(*value).filter(|deviations| *deviations > threshold)?;
        Some(Outlier {
            robot: tally.names[*place].clone(),
            what: measure.what.clone(),
            value: three_digits(*value),
            median: three_digits(if measure.by_ratio { libm::exp(spread.median) } else { spread.median }),
            deviations: three_digits(deviations),
            threshold: three_digits(threshold),
        })
    };
    measure.values.iter().filter_map(outlier).collect()
}

/// Returns the distance from the median, in deviations, that no robot exceeds by chance: a quantile of Student's
/// distribution by its expansion about the normal quantile (Abramowitz and Stegun 1964, equation 26.7.5), corrected for the
/// number of robots and measures.
fn threshold(robots: usize, measures: usize) -> f64 {
    let z = normal_beyond(1.0 / (FLEETS * (robots * measures) as f64));
    let degrees = EFFICIENCY * (robots - 1) as f64;
    let (z3, z5, z7) = (z * z * z, libm::pow(z, 5.0), libm::pow(z, 7.0));
    let first = (z3 + z) / 4.0;
    let second = (5.0 * z5 + 16.0 * z3 + 3.0 * z) / 96.0;
    let third = (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / 384.0;
    z + first / degrees + second / (degrees * degrees) + third / (degrees * degrees * degrees)
}

/// Returns the two-sided quantile of the normal distribution for a tail probability.
fn normal_beyond(probability: f64) -> f64 {
    let (mut low, mut high) = (0.0, 40.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if libm::erfc(middle / std::f64::consts::SQRT_2) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use mindgap_foundations::random::generator;
    use mindgap_models::effects::CATALOGUE;

    /// Returns robots with randomly scattered gaps, and those with the given gaps.
    fn fleet(robots: usize, odd_nats: &[f64], seed: u64) -> Tally {
        let (mut tally, mut rng) = (Tally::new(CATALOGUE), generator(seed, &[]));
        let scattered = (0..robots).map(|_| {
            let normal: f64 = StandardNormal.sample(&mut rng);
            libm::exp(0.3 * normal)
        });
        tally.gaps_nats = scattered.chain(odd_nats.iter().copied()).map(Some).collect();
        tally.names = (0..tally.gaps_nats.len()).map(|i| i.to_string()).collect();
        tally
    }

    #[test]
    fn only_the_robot_with_a_far_larger_gap_is_an_outlier() {
        let found = outliers(&fleet(50, &[40.0], 1));
        let [Outlier { robot, what, .. }] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((robot.as_str(), what.as_str()), ("50", "gap_nats"));
        assert_eq!(outliers(&fleet(5, &[40.0], 1)), [], "six robots do not tell how robots scatter");
    }

    #[test]
    fn random_scatter_rarely_gives_an_outlier() {
        for robots in [10, 20, 100, 1000] {
            let fleets = 200;
            let alarms = (0..fleets).filter(|seed| !outliers(&fleet(robots, &[], *seed)).is_empty()).count();
            assert!(alarms <= 22, "{alarms} of {fleets} fleets of {robots} robots");
        }
    }
}
