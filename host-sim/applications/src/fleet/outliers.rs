//! Robots that stand out: the size of their gap or a parameter of an effect lies far from the fleet's.

use serde::Serialize;

use super::spread::Spread;
use super::tally::Tally;
use mindgap_foundations::statistics::rounding::three_digits;

/// One fleet in so many, whose robots scatter by chance alone, has a robot that stands out.
const FLEETS: f64 = 20.0;
/// A median deviation of n numbers is known as well as a standard deviation of this share of them (Rousseeuw and Croux
/// 1993, Alternatives to the median absolute deviation).
const EFFICIENCY: f64 = 0.37;
/// Of fewer robots a deviation is not known.
const FEWEST: usize = 10;
/// Bisections until a quantile is as narrow as double precision.
const BISECTIONS: usize = 60;

/// A robot that stands out in something.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Outlier {
    /// Its name.
    pub robot: String,
    /// In what: `gap_nats`, or `EFFECT.PARAMETER`.
    pub what: String,
    /// What it has there.
    pub value: f64,
    /// What the fleet has.
    pub median: f64,
    /// How far it is from that, in deviations of the fleet.
    pub deviations: f64,
    /// From how far on robots stand out here.
    pub threshold: f64,
}

/// Numbers of some robots: what they are, whether they are judged by their ratios, and the numbers by place in the tally.
struct Measure {
    what: String,
    by_ratio: bool,
    values: Vec<(usize, f64)>,
}

/// Whoever stands out, the furthest first.
pub fn outliers(tally: &Tally) -> Vec<Outlier> {
    let measures = measures(tally);
    let mut outliers: Vec<Outlier> =
        measures.iter().flat_map(|measure| beyond(measure, measures.len(), tally)).collect();
    outliers.sort_by(|a, b| b.deviations.total_cmp(&a.deviations).then_with(|| a.robot.cmp(&b.robot)));
    outliers
}

/// All in which enough robots can be compared.
fn measures(tally: &Tally) -> Vec<Measure> {
    // Gaps grow with the square of what is wrong.
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
    // Where more than half of the robots are the very same, no deviation is known.
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

/// So many deviations from the median nothing lies by chance, of so many robots in so many measures: a quantile of
/// Student's distribution by its expansion about the normal one's (Abramowitz and Stegun 1964, equation 26.7.5).
fn threshold(robots: usize, measures: usize) -> f64 {
    let z = normal_beyond(1.0 / (FLEETS * (robots * measures) as f64));
    let degrees = EFFICIENCY * (robots - 1) as f64;
    let (z3, z5, z7) = (z * z * z, libm::pow(z, 5.0), libm::pow(z, 7.0));
    let first = (z3 + z) / 4.0;
    let second = (5.0 * z5 + 16.0 * z3 + 3.0 * z) / 96.0;
    let third = (3.0 * z7 + 19.0 * z5 + 17.0 * z3 - 15.0 * z) / 384.0;
    z + first / degrees + second / (degrees * degrees) + third / (degrees * degrees * degrees)
}

/// From how far on, to either side, a normal law has this probability.
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
    use mindgap_foundations::chance::generator;
    use mindgap_models::effects::CATALOGUE;

    /// Robots with gaps that scatter by chance, and these.
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
    fn a_robot_with_a_far_larger_gap_stands_out_alone() {
        let found = outliers(&fleet(50, &[40.0], 1));
        let [Outlier { robot, what, .. }] = found.as_slice() else { panic!("{found:?}") };
        assert_eq!((robot.as_str(), what.as_str()), ("50", "gap_nats"));
        assert_eq!(outliers(&fleet(5, &[40.0], 1)), [], "six robots do not tell how robots scatter");
    }

    #[test]
    fn in_few_fleets_that_scatter_by_chance_alone_a_robot_stands_out() {
        for robots in [10, 20, 100, 1000] {
            let fleets = 200;
            let alarms = (0..fleets).filter(|seed| !outliers(&fleet(robots, &[], *seed)).is_empty()).count();
            assert!(alarms <= 22, "{alarms} of {fleets} fleets of {robots} robots");
        }
    }
}
