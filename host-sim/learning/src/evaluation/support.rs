//! Support of the sonar samples: a network is undefined at distances and angles that no log contains.

use crate::learn::dataset::Dataset;

/// A grid over distance D and incidence angle α that marks the cells with samples and their neighbours.
#[derive(Clone, Debug, PartialEq)]
pub struct Support {
    max_cm: f64,
    known: Vec<bool>,
}

/// Number of cells along D, from zero to the sensor's range.
pub const COLUMNS: usize = 24;
/// Number of cells along α, from 0 to 90 degrees.
pub const ROWS: usize = 18;

impl Support {
    /// Marks the cells of samples from a sensor with this range, cm.
    pub fn of(samples: &Dataset<2>, max_cm: f64) -> Self {
        let mut known = vec![false; COLUMNS * ROWS];
        for (column, row) in samples.inputs.iter().filter_map(|[d, a]| cell(f64::from(*d), f64::from(*a), max_cm)) {
            for near_column in column.saturating_sub(1)..=(column + 1).min(COLUMNS - 1) {
                for near_row in row.saturating_sub(1)..=(row + 1).min(ROWS - 1) {
                    known[near_row * COLUMNS + near_column] = true;
                }
            }
        }
        Support { max_cm, known }
    }

    /// Returns whether there are samples near a distance (cm) and an angle (degrees).
    pub fn has(&self, distance_cm: f64, alpha_deg: f64) -> bool {
        cell(distance_cm, alpha_deg, self.max_cm).is_some_and(|(column, row)| self.known[row * COLUMNS + column])
    }
}

/// Returns the column and row of a sample, or `None` if it lies outside the grid.
fn cell(distance_cm: f64, alpha_deg: f64, max_cm: f64) -> Option<(usize, usize)> {
    let (across, up) = (distance_cm / max_cm, alpha_deg / 90.0);
    let inside = (0.0..=1.0).contains(&across) && (0.0..=1.0).contains(&up);
    let index = |share: f64, cells: usize| ((share * cells as f64) as usize).min(cells - 1);
    inside.then(|| (index(across, COLUMNS), index(up, ROWS)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sample_supports_its_cell_and_its_neighbours() {
        let mut samples = Dataset::default();
        samples.push([105.0, 42.0], 1.0, 0);
        samples.push([400.0, 42.0], 1.0, 0);
        let support = Support::of(&samples, 240.0);
        assert!(support.has(105.0, 42.0) && support.has(95.0, 36.0) && support.has(119.0, 49.0));
        assert!(!support.has(85.0, 42.0) && !support.has(105.0, 55.0) && !support.has(240.0, 50.0));
        assert!(!support.has(300.0, 42.0) && !support.has(f64::NAN, 42.0));
    }
}
