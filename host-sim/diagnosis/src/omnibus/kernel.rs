//! Kernel regression by place (Nadaraya 1964, On estimating regression; Watson 1964, Smooth regression analysis): what differs at
//! one spot of the room and nowhere else, which rows show only to other rows near them.

use glam::DVec2;

use mindgap_foundations::statistics::ridge::{CONVERGED, MAX_ITERATIONS};

/// Radius of the kernel: patches of a floor and sides of obstacles are about this large, and smaller circles seldom contain a
/// second run.
const REACH_CM: f64 = 50.0;
/// Weight of the prior that nothing differs at a spot, in rows: about as many rows as 24 runs of 60 steps leave there. What
/// fewer rows show is more than half attributed to chance.
const PRIOR_ROWS: f64 = 30.0;

/// The place of a row, and how strongly the row responds to it.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// Position of the robot for steps, and of what it faces for readings.
    pub position_cm: DVec2,
    /// One for a typical row.
    pub weight: f64,
}

impl Spot {
    /// The place of a row with weight one.
    pub fn unweighted(position_cm: DVec2) -> Self {
        Spot { position_cm, weight: 1.0 }
    }
}

/// Responses of rows at their places.
#[derive(Clone, Debug, Default)]
pub struct KernelRegression {
    rows: Vec<(Spot, f64)>,
}

/// For each row the rows near it with their kernel weights.
pub struct Neighbours(Vec<Vec<(u32, f32)>>);

/// Fits `response(row, prediction)`, the working response at the current prediction, as [`ridge::fit`](mindgap_foundations::statistics::ridge::fit)
/// does. Also returns the prediction of each row by the other folds. Rows without a place are ignored.
pub fn fit(
    spots: &[Option<Spot>],
    neighbours: &Neighbours,
    folds: &[usize],
    response: impl Fn(usize, f64) -> f64,
) -> (KernelRegression, Vec<f64>) {
    let count = folds.iter().max().map_or(0, |most| most + 1);
    let mut cross_validated = vec![0.0; spots.len()];
    for fold in 0..count {
        let (_, predictions) = converged(spots, neighbours, |i| folds[i] != fold, &response);
        for i in (0..spots.len()).filter(|i| folds[*i] == fold) {
            cross_validated[i] = predictions[i];
        }
    }
    let (responses, _) = converged(spots, neighbours, |_| true, &response);
    let rows = spots.iter().zip(responses).filter_map(|(spot, response)| Some(((*spot)?, response)));
    (KernelRegression { rows: rows.collect() }, cross_validated)
}

impl KernelRegression {
    /// Predicts the response at a place, zero without one.
    pub fn at(&self, spot: Option<Spot>) -> f64 {
        let Some(spot) = spot else { return 0.0 };
        let near = self.rows.iter().map(|(row, response)| (kernel(row, &spot), *row, *response));
        predicted(&spot, near.filter(|(weight, ..)| *weight > 0.0))
    }
}

/// Returns the responses of the kept rows, and the predictions of all rows from them.
fn converged(
    spots: &[Option<Spot>],
    neighbours: &Neighbours,
    is_kept: impl Fn(usize) -> bool,
    response: &impl Fn(usize, f64) -> f64,
) -> (Vec<f64>, Vec<f64>) {
    let mut responses = vec![0.0; spots.len()];
    let mut predictions = vec![0.0; spots.len()];
    for _ in 0..MAX_ITERATIONS {
        for i in (0..spots.len()).filter(|i| spots[*i].is_some() && is_kept(*i)) {
            responses[i] = response(i, predictions[i]);
        }
        let prediction = |i: usize| {
            let near = neighbours.0[i].iter().map(|(j, weight)| (*j as usize, f64::from(*weight)));
            let near = near.filter(|(j, _)| is_kept(*j));
            let near = near.filter_map(|(j, weight)| Some((weight, spots[j]?, responses[j])));
            spots[i].map_or(0.0, |spot| predicted(&spot, near))
        };
        let next: Vec<f64> = (0..spots.len()).map(prediction).collect();
        let change = next.iter().zip(&predictions).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        predictions = next;
        if change < CONVERGED {
            break;
        }
    }
    (responses, predictions)
}

/// Predicts the response at a place from the kernel weights, places and responses of rows near it.
fn predicted(spot: &Spot, near: impl Iterator<Item = (f64, Spot, f64)>) -> f64 {
    let (mut sum, mut rows) = (0.0, PRIOR_ROWS);
    for (weight, row, response) in near {
        sum += weight * row.weight * response;
        rows += weight * row.weight * row.weight;
    }
    spot.weight * sum / rows
}

impl Neighbours {
    /// Finds the neighbours of each place.
    pub fn of(spots: &[Option<Spot>]) -> Self {
        let near = |spot: Option<Spot>| -> Vec<(u32, f32)> {
            let weight = |other: Option<Spot>| Some(kernel(&spot?, &other?)).filter(|weight| *weight > 0.0);
            let others = spots.iter().zip(0u32..);
            others.filter_map(|(other, j)| Some((j, weight(*other)? as f32))).collect()
        };
        Neighbours(spots.iter().map(|spot| near(*spot)).collect())
    }
}

/// The biweight kernel: one at the same place, zero at the reach and beyond.
fn kernel(a: &Spot, b: &Spot) -> f64 {
    let weight = 1.0 - a.position_cm.distance_squared(b.position_cm) / (REACH_CM * REACH_CM);
    weight.max(0.0) * weight.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(x_cm: f64, weight: f64) -> Option<Spot> {
        Some(Spot { position_cm: DVec2::new(x_cm, 20.0), weight })
    }

    /// Eight folds of twenty rows at one place and twenty at a distant one.
    fn rows() -> (Vec<Option<Spot>>, Vec<usize>) {
        (0..320).map(|i| (spot(if i % 2 == 0 { 50.0 } else { 250.0 }, 1.0), i / 40)).unzip()
    }

    /// Only the rows at the first place respond.
    #[test]
    fn place_predicts_its_surroundings_only() {
        let (spots, folds) = rows();
        let response = |i, _| f64::from(u8::from(i % 2 == 0));
        let (fitted, cross_validated) = fit(&spots, &Neighbours::of(&spots), &folds, response);
        // Seven folds of twenty rows against the prior.
        let expected = 140.0 / (PRIOR_ROWS + 140.0);
        assert!((cross_validated[0] - expected).abs() < 1e-9 && cross_validated[1] == 0.0, "{cross_validated:?}");
        assert!((fitted.at(spot(50.0, 1.0)) - 160.0 / (PRIOR_ROWS + 160.0)).abs() < 1e-9);
        assert!(fitted.at(spot(80.0, 1.0)) > 0.5, "near it");
        assert_eq!(fitted.at(spot(50.0 + REACH_CM, 1.0)), 0.0);
        assert_eq!(fitted.at(None), 0.0);
    }

    #[test]
    fn prediction_is_proportional_to_the_weight() {
        let (spots, folds) = rows();
        let (fitted, _) = fit(&spots, &Neighbours::of(&spots), &folds, |_, _| 1.0);
        assert_eq!(fitted.at(spot(50.0, -0.5)), -0.5 * fitted.at(spot(50.0, 1.0)));
    }

    #[test]
    fn rows_without_a_place_are_ignored() {
        let spots = [None, None, spot(50.0, 1.0)];
        let (fitted, cross_validated) = fit(&spots, &Neighbours::of(&spots), &[0, 1, 1], |_, _| 1.0);
        assert_eq!(cross_validated, [0.0; 3]);
        assert_eq!(fitted.rows.len(), 1);
    }

    /// The responses are those of log-odds: half of 2 at a prediction of zero.
    #[test]
    fn working_responses_are_iterated_to_convergence() {
        let (spots, folds) = rows();
        let (fitted, _) = fit(&spots, &Neighbours::of(&spots), &folds, |_, p| p + 0.25 * (2.0 - p));
        let share = 160.0 / (PRIOR_ROWS + 160.0);
        // p = share (p + (2 − p) / 4)
        let expected = share * 0.5 / (1.0 - 0.75 * share);
        assert!((fitted.at(spot(50.0, 1.0)) - expected).abs() < 0.02, "{}", fitted.at(spot(50.0, 1.0)));
    }
}
