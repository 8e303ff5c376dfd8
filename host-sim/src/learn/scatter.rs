//! Learns how logs scatter about networks, and whether the sensor has a constant wrong reading.

use crate::simulator::scatter::{CELLS, ConstantReading, LEVELS, Spread};

/// A cell with fewer residuals borrows those of its whole row.
const FEWEST: usize = LEVELS;
/// A cell with fewer pairs of neighbours takes the share of all.
const FEWEST_NEIGHBOURS: usize = 50;
/// A reading this far off the network's may be a constant wrong one.
const FAR_OFF_CM: f32 = 10.0;
/// Half the width of the window that a constant reading scatters in.
const WINDOW_CM: f32 = 1.5;
/// A peak of wrong readings must stand out of its neighbourhood by so many standard deviations.
const STANDS_OUT: f64 = 6.0;

/// Residuals (logged minus predicted) by context. Cell borders put equally many samples on each side.
pub fn spread(contexts: &[[f32; 2]], residuals: &[f32]) -> Spread {
    let edges = [0, 1].map(|axis| {
        let values = sorted(contexts.iter().map(|c| c[axis]));
        std::array::from_fn(|i| values.get(values.len() * (i + 1) / CELLS).copied().unwrap_or(0.0))
    });
    let mut spread = Spread { edges, residuals: Vec::new(), own_share: vec![1.0; CELLS * CELLS] };
    let mut cells = vec![Vec::new(); CELLS * CELLS];
    for (context, residual) in contexts.iter().zip(residuals) {
        cells[spread.cell(*context)].push(*residual);
    }
    spread.residuals = (0..CELLS * CELLS)
        .map(|cell| {
            let row = &cells[cell / CELLS * CELLS..][..CELLS];
            if cells[cell].len() >= FEWEST {
                levels(&cells[cell])
            } else if row.iter().map(Vec::len).sum::<usize>() >= FEWEST {
                levels(&row.concat())
            } else {
                levels(residuals)
            }
        })
        .collect();
    spread
}

/// For each cell of a motion network's spread, how much of the size of its residuals is the robot's own.
///
/// A tracker's error at a row enters the step before and the step after with opposite signs, which shows as a negative
/// correlation of neighbours; what the robot does itself in one step and the next is taken to be independent. `runs`
/// tells which residuals follow each other. A cell with few neighbours takes the share of all.
pub fn own_share(spread: &Spread, contexts: &[[f32; 2]], residuals: &[f32], runs: &[usize]) -> Vec<f32> {
    let mut sums = vec![Neighbours::default(); CELLS * CELLS];
    let mut all = Neighbours::default();
    for i in 1..residuals.len() {
        if runs[i - 1] == runs[i] {
            let (before, after) = (f64::from(residuals[i - 1]), f64::from(residuals[i]));
            all.add(before, after);
            sums[spread.cell(contexts[i])].add(before, after);
        }
    }
    let share = |sum: &Neighbours| if sum.count >= FEWEST_NEIGHBOURS { sum.share() } else { all.share() };
    sums.iter().map(share).collect()
}

/// Sums over residuals that follow each other.
#[derive(Clone, Copy, Debug, Default)]
struct Neighbours {
    products: f64,
    squares: f64,
    count: usize,
}

impl Neighbours {
    fn add(&mut self, before: f64, after: f64) {
        self.products += before * after;
        self.squares += after * after;
        self.count += 1;
    }

    fn share(&self) -> f32 {
        if self.squares <= 0.0 {
            return 1.0;
        }
        (1.0 + 2.0 * self.products / self.squares).clamp(0.0, 1.0).sqrt() as f32
    }
}

/// Finds a reading that comes too often among those far off what was predicted.
pub fn constant_reading(echoes_cm: &[f32], predicted_cm: &[f32]) -> Option<ConstantReading> {
    let wrong: Vec<f32> = echoes_cm
        .iter()
        .zip(predicted_cm)
        .filter(|(echo, predicted)| (*echo - *predicted).abs() > FAR_OFF_CM)
        .map(|(echo, _)| *echo)
        .collect();
    let near = |value: f32, reach: f32| wrong.iter().filter(|w| (*w - value).abs() <= reach).count() as f64;
    let (value_cm, at, around) = sorted(wrong.iter().map(|w| w.round()))
        .chunk_by(|a, b| a == b)
        .map(|chunk| {
            let value = chunk[0];
            let at = near(value, WINDOW_CM);
            // The neighbourhood on both sides, brought to the window's width.
            let around = (near(value, 5.0 * WINDOW_CM) - at) / 4.0;
            (value, at, around)
        })
        .max_by(|a, b| (a.1 - a.2).total_cmp(&(b.1 - b.2)))?;
    let excess = at - around;
    let outstanding = excess > STANDS_OUT * (around + 1.0).sqrt();
    outstanding.then(|| ConstantReading { value_cm, probability: (excess / echoes_cm.len() as f64) as f32 })
}

/// Whether a reading is rather the constant one than what was predicted.
pub fn is_constant(constant: &ConstantReading, echo_cm: f32, predicted_cm: f32) -> bool {
    (echo_cm - constant.value_cm).abs() <= WINDOW_CM && (echo_cm - predicted_cm).abs() > FAR_OFF_CM
}

/// Equally likely stand-ins for values: the middles of equal shares of them.
fn levels(values: &[f32]) -> Vec<f32> {
    let values = sorted(values.iter().copied());
    let at = |share: f64| values.get((share * values.len() as f64) as usize).copied().unwrap_or(0.0);
    (0..LEVELS).map(|level| at((level as f64 + 0.5) / LEVELS as f64)).collect()
}

fn sorted(values: impl Iterator<Item = f32>) -> Vec<f32> {
    let mut values: Vec<f32> = values.collect();
    values.sort_by(f32::total_cmp);
    values
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chance::generator;
    use rand::RngExt;

    #[test]
    fn a_spread_that_widens_with_the_context_is_found_again() {
        let mut rng = generator(1, &[]);
        let contexts: Vec<[f32; 2]> =
            (0..8000).map(|_| [rng.random_range(0.0..100.0), rng.random_range(0.0..90.0)]).collect();
        let residuals: Vec<f32> = contexts.iter().map(|c| (rng.random::<f32>() - 0.5) * c[1]).collect();
        let spread = spread(&contexts, &residuals);
        assert!(spread.is_sound());
        let width = |alpha: f32| spread.residual([50.0, alpha], LEVELS - 1) - spread.residual([50.0, alpha], 0);
        assert!((8.0..20.0).contains(&width(5.0)), "{}", width(5.0));
        assert!((65.0..85.0).contains(&width(85.0)), "{}", width(85.0));
    }

    #[test]
    fn few_residuals_stand_for_every_cell() {
        let spread = spread(&[[1.0, 1.0], [2.0, 2.0]], &[-1.0, 1.0]);
        assert!(spread.is_sound());
        assert_eq!(spread.residual([0.0, 9.0], 1), -1.0);
        assert_eq!(spread.residual([9.0, 0.0], LEVELS - 2), 1.0);
    }

    #[test]
    fn the_trackers_part_of_residuals_is_told_from_the_robots() {
        let mut rng = generator(4, &[]);
        let mut error = || rng.random::<f32>() - 0.5;
        // Twenty runs of a robot whose own scatter has half the variance of the whole.
        let (mut residuals, mut runs) = (Vec::new(), Vec::new());
        for run in 0..20 {
            let mut before = error();
            for _ in 0..200 {
                let after = error();
                residuals.push(std::f32::consts::SQRT_2 * error() + after - before);
                runs.push(run);
                before = after;
            }
        }
        let contexts = vec![[0.0; 2]; residuals.len()];
        let spread = spread(&contexts, &residuals);
        let share = own_share(&spread, &contexts, &residuals, &runs)[spread.cell([0.0; 2])];
        assert!((share - std::f32::consts::FRAC_1_SQRT_2).abs() < 0.05, "{share}");
        assert_eq!(own_share(&spread, &[], &[], &[]), vec![1.0; CELLS * CELLS]);
    }

    #[test]
    fn a_constant_reading_is_found_with_its_chance() {
        let mut rng = generator(2, &[]);
        let predicted: Vec<f32> = (0..4000).map(|_| rng.random_range(15.0..200.0)).collect();
        let echoes: Vec<f32> = predicted
            .iter()
            .map(|p| match rng.random::<f32>() {
                d if d < 0.03 => 34.0 + rng.random_range(-1i8..=1) as f32,
                d if d < 0.06 => rng.random_range(10.0f32..p.max(11.0)).round(),
                _ => p.round(),
            })
            .collect();
        let found = constant_reading(&echoes, &predicted).unwrap();
        assert!((33.0..=35.0).contains(&found.value_cm), "{found:?}");
        assert!((0.02..0.035).contains(&found.probability), "{found:?}");
        assert!(is_constant(&found, 34.0, 100.0) && !is_constant(&found, 34.0, 33.0));
    }

    #[test]
    fn scattered_wrong_readings_are_no_constant_one() {
        let mut rng = generator(3, &[]);
        let predicted: Vec<f32> = (0..4000).map(|_| rng.random_range(15.0..200.0)).collect();
        let echoes: Vec<f32> = predicted
            .iter()
            .map(|p| if rng.random_bool(0.1) { rng.random_range(10.0f32..p.max(11.0)).round() } else { p.round() })
            .collect();
        assert_eq!(constant_reading(&echoes, &predicted), None);
        assert_eq!(constant_reading(&[], &[]), None);
    }
}
