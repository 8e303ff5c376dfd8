//! Estimates the noise of logs about networks: residual quantiles, variance components, and a constant wrong reading.

use mindgap_models::simulator::residuals::{CELLS, ConstantReading, LEVELS, ResidualQuantiles, VarianceComponents};

/// A cell with fewer residuals uses those of its whole row.
const FEWEST: usize = LEVELS;
/// Least number of products or squares for a mean.
const FEWEST_TO_AVERAGE: usize = 50;
/// A reading at least this far from the prediction may be a constant wrong one.
const FAR_OFF_CM: f32 = 10.0;
/// Half width of the window about a constant reading.
const WINDOW_CM: f32 = 1.5;
/// Number of standard deviations by which a peak of wrong readings must exceed its neighbourhood.
const STANDS_OUT: f64 = 6.0;

/// Returns the quantiles of residuals (logged minus predicted) by context. Cell borders are quantiles of the contexts along
/// each axis.
pub fn residual_quantiles(contexts: &[[f32; 2]], residuals: &[f32]) -> ResidualQuantiles {
    let edges = [0, 1].map(|axis| {
        let values = sorted(contexts.iter().map(|c| c[axis]));
        std::array::from_fn(|i| values.get(values.len() * (i + 1) / CELLS).copied().unwrap_or(0.0))
    });
    let mut quantiles =
        ResidualQuantiles { edges, quantiles: Vec::new(), components: vec![VarianceComponents::STEP; CELLS * CELLS] };
    let mut cells = vec![Vec::new(); CELLS * CELLS];
    for (context, residual) in contexts.iter().zip(residuals) {
        cells[quantiles.cell(*context)].push(*residual);
    }
    quantiles.quantiles = (0..CELLS * CELLS)
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
    quantiles
}

/// Returns the variance components of a motion network's residuals in each cell: the robot's own process noise, as opposed
/// to the tracker's measurement noise.
///
/// The tracker's error at a row enters the steps before and after it with opposite signs, which gives neighbouring
/// residuals a negative covariance. Noise that lasts while a command is held adds to the covariance of neighbours under
/// one command. The rest of a cell's variance is independent in each step. All slices have one entry per residual:
/// `commands` are the inputs of the network, and `runs` the run that the residual comes from.
pub fn variance_components(
    quantiles: &ResidualQuantiles,
    contexts: &[[f32; 2]],
    residuals: &[f32],
    commands: &[[f32; 4]],
    runs: &[usize],
) -> Vec<VarianceComponents> {
    // A step is steady if its command is that of the step before.
    let is_steady = |i: usize| commands[i][..2] == commands[i][2..];
    let neighbours: Vec<usize> = (1..residuals.len()).filter(|i| runs[i - 1] == runs[*i]).collect();
    let covariance = |is_counted: &dyn Fn(usize) -> bool| {
        let pairs = neighbours.iter().filter(|i| is_counted(**i));
        mean(pairs.map(|i| residuals[i - 1] * residuals[*i]))
    };
    let Some(changed) = covariance(&|i| !is_steady(i)) else { return vec![VarianceComponents::STEP; CELLS * CELLS] };
    let tracker = (-changed).max(0.0);
    let held = covariance(&|i| is_steady(i) && is_steady(i - 1)).map_or(0.0, |steady| (steady - changed).max(0.0));
    (0..CELLS * CELLS)
        .map(|cell| {
            let here = contexts.iter().zip(residuals).filter(|(context, _)| quantiles.cell(**context) == cell);
            let squares = |r: &f32| r * r;
            let here = mean(here.map(|(_, r)| squares(r))).or_else(|| mean(residuals.iter().map(squares)));
            let all = here.unwrap_or(0.0).max(f32::MIN_POSITIVE);
            let held = (held / all).min(1.0);
            let step = (1.0 - 2.0 * tracker / all - held).max(0.0);
            VarianceComponents { step: step.sqrt(), held: held.sqrt() }
        })
        .collect()
}

/// Returns the mean of at least [`FEWEST_TO_AVERAGE`] numbers.
fn mean(values: impl Iterator<Item = f32>) -> Option<f32> {
    let (sum, count) = values.fold((0.0, 0), |(sum, count), v| (sum + f64::from(v), count + 1));
    (count >= FEWEST_TO_AVERAGE).then(|| (sum / count as f64) as f32)
}

/// Finds a value that is too frequent among the readings far from their predictions.
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
            // The count in the neighbourhood on both sides, scaled to the width of the window.
            let around = (near(value, 5.0 * WINDOW_CM) - at) / 4.0;
            (value, at, around)
        })
        .max_by(|a, b| (a.1 - a.2).total_cmp(&(b.1 - b.2)))?;
    let excess = at - around;
    let outstanding = excess > STANDS_OUT * (around + 1.0).sqrt();
    outstanding.then(|| ConstantReading { value_cm, probability: (excess / echoes_cm.len() as f64) as f32 })
}

/// Returns whether a reading is closer to the constant one than to its prediction.
pub fn is_constant(constant: &ConstantReading, echo_cm: f32, predicted_cm: f32) -> bool {
    (echo_cm - constant.value_cm).abs() <= WINDOW_CM && (echo_cm - predicted_cm).abs() > FAR_OFF_CM
}

/// Returns equally likely representatives of values: the quantiles at the middles of equal shares.
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
    use mindgap_foundations::random::generator;
    use rand::RngExt;

    #[test]
    fn quantiles_that_widen_with_the_context_are_recovered() {
        let mut rng = generator(1, &[]);
        let contexts: Vec<[f32; 2]> =
            (0..8000).map(|_| [rng.random_range(0.0..100.0), rng.random_range(0.0..90.0)]).collect();
        let residuals: Vec<f32> = contexts.iter().map(|c| (rng.random::<f32>() - 0.5) * c[1]).collect();
        let quantiles = residual_quantiles(&contexts, &residuals);
        assert!(quantiles.is_sound());
        let width = |alpha: f32| quantiles.residual([50.0, alpha], LEVELS - 1) - quantiles.residual([50.0, alpha], 0);
        assert!((8.0..20.0).contains(&width(5.0)), "{}", width(5.0));
        assert!((65.0..85.0).contains(&width(85.0)), "{}", width(85.0));
    }

    #[test]
    fn few_residuals_serve_every_cell() {
        let quantiles = residual_quantiles(&[[1.0, 1.0], [2.0, 2.0]], &[-1.0, 1.0]);
        assert!(quantiles.is_sound());
        assert_eq!(quantiles.residual([0.0, 9.0], 1), -1.0);
        assert_eq!(quantiles.residual([9.0, 0.0], LEVELS - 2), 1.0);
    }

    #[test]
    fn measurement_noise_is_separated_from_process_noise() {
        let mut rng = generator(4, &[]);
        let mut error = || rng.random::<f32>() - 0.5;
        // Sixty runs of commands held for four steps. Two sixths of the variance belong to the tracker, one sixth persists
        // with the command, and three sixths are independent.
        let (mut residuals, mut commands, mut runs) = (Vec::new(), Vec::new(), Vec::new());
        for run in 0..60 {
            let (mut before, mut lasting, mut command) = (error(), 0.0, [0.0; 2]);
            for step in 0..200 {
                let (after, command_before) = (error(), command);
                if step % 4 == 0 {
                    (lasting, command) = (error(), [error(), error()]);
                }
                commands.push([command[0], command[1], command_before[0], command_before[1]]);
                residuals.push(3f32.sqrt() * error() + lasting + after - before);
                runs.push(run);
                before = after;
            }
        }
        let contexts = vec![[0.0; 2]; residuals.len()];
        let quantiles = residual_quantiles(&contexts, &residuals);
        let found = variance_components(&quantiles, &contexts, &residuals, &commands, &runs)[quantiles.cell([0.0; 2])];
        assert!((found.step - 0.5f32.sqrt()).abs() < 0.03, "{found:?}");
        assert!((found.held - (1f32 / 6.0).sqrt()).abs() < 0.03, "{found:?}");
        assert_eq!(variance_components(&quantiles, &[], &[], &[], &[]), vec![VarianceComponents::STEP; CELLS * CELLS]);
    }

    #[test]
    fn constant_reading_is_found_with_its_probability() {
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
    fn scattered_wrong_readings_are_not_a_constant_reading() {
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
