//! Kernel regression (Nadaraya 1964, On estimating regression; Watson 1964, Smooth regression analysis): what is so at one
//! spot of the room and nowhere else, which a row tells of others near it and of no other.

use glam::DVec2;

use mindgap_foundations::statistics::ridge::{CONVERGED, MAX_ITERATIONS};

/// Rows that lie this far apart or farther say nothing of each other: the patches of a floor and the sides of an obstacle
/// are about so large, and in a smaller circle there is seldom a second run.
const REACH_CM: f64 = 50.0;
/// That nothing is different at a spot counts as much as so many rows there, about as many as 24 runs of 60 steps leave
/// there: of what fewer say, more than half is taken for chance.
const PRIOR_ROWS: f64 = 30.0;

/// Where a row is in the room, and how much what is so there shows in it.
#[derive(Clone, Copy, Debug)]
pub struct Spot {
    /// Of the robot for steps, of what it faces for readings.
    pub position_cm: DVec2,
    /// One for a usual row.
    pub weight: f64,
}

impl Spot {
    /// Where what is so shows as in any row.
    pub fn usual(position_cm: DVec2) -> Self {
        Spot { position_cm, weight: 1.0 }
    }
}

/// What rows say of the spots where they are.
#[derive(Clone, Debug, Default)]
pub struct Nearby {
    rows: Vec<(Spot, f64)>,
}

/// The rows near each row, each with how much it counts there, whatever their weights.
pub struct Neighbours(Vec<Vec<(u32, f32)>>);

/// Fits `response(row, prediction)`, the working response of a row where its prediction stands, as `ridge::fit` does;
/// with the prediction of each row from the other folds. A row without a spot neither says anything nor is told.
pub fn fit(
    spots: &[Option<Spot>],
    neighbours: &Neighbours,
    folds: &[usize],
    response: impl Fn(usize, f64) -> f64,
) -> (Nearby, Vec<f64>) {
    let count = folds.iter().max().map_or(0, |most| most + 1);
    let mut held_out = vec![0.0; spots.len()];
    for fold in 0..count {
        let (_, predictions) = settled(spots, neighbours, |i| folds[i] != fold, &response);
        for i in (0..spots.len()).filter(|i| folds[*i] == fold) {
            held_out[i] = predictions[i];
        }
    }
    let (responses, _) = settled(spots, neighbours, |_| true, &response);
    let rows = spots.iter().zip(responses).filter_map(|(spot, response)| Some(((*spot)?, response)));
    (Nearby { rows: rows.collect() }, held_out)
}

impl Nearby {
    /// What rows near it say of a spot.
    pub fn at(&self, spot: Option<Spot>) -> f64 {
        let Some(spot) = spot else { return 0.0 };
        let near = self.rows.iter().map(|(row, response)| (kernel(row, &spot), *row, *response));
        predicted(&spot, near.filter(|(share, ..)| *share > 0.0))
    }
}

/// The responses of the rows that are kept, and the predictions of all from those.
fn settled(
    spots: &[Option<Spot>],
    neighbours: &Neighbours,
    kept: impl Fn(usize) -> bool,
    response: &impl Fn(usize, f64) -> f64,
) -> (Vec<f64>, Vec<f64>) {
    let mut responses = vec![0.0; spots.len()];
    let mut predictions = vec![0.0; spots.len()];
    for _ in 0..MAX_ITERATIONS {
        for i in (0..spots.len()).filter(|i| spots[*i].is_some() && kept(*i)) {
            responses[i] = response(i, predictions[i]);
        }
        let told = |i: usize| {
            let near = neighbours.0[i].iter().map(|(j, share)| (*j as usize, f64::from(*share)));
            let near = near.filter(|(j, _)| kept(*j)).filter_map(|(j, share)| Some((share, spots[j]?, responses[j])));
            spots[i].map_or(0.0, |spot| predicted(&spot, near))
        };
        let next: Vec<f64> = (0..spots.len()).map(told).collect();
        let change = next.iter().zip(&predictions).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        predictions = next;
        if change < CONVERGED {
            break;
        }
    }
    (responses, predictions)
}

/// A spot's prediction from the shares, spots and responses of rows near it.
fn predicted(spot: &Spot, near: impl Iterator<Item = (f64, Spot, f64)>) -> f64 {
    let (mut pull, mut rows) = (0.0, PRIOR_ROWS);
    for (share, row, response) in near {
        pull += share * row.weight * response;
        rows += share * row.weight * row.weight;
    }
    spot.weight * pull / rows
}

impl Neighbours {
    /// Of these spots.
    pub fn of(spots: &[Option<Spot>]) -> Self {
        let near = |spot: Option<Spot>| -> Vec<(u32, f32)> {
            let share = |other: Option<Spot>| Some(kernel(&spot?, &other?)).filter(|share| *share > 0.0);
            let others = spots.iter().zip(0u32..);
            others.filter_map(|(other, j)| Some((j, share(*other)? as f32))).collect()
        };
        Neighbours(spots.iter().map(|spot| near(*spot)).collect())
    }
}

/// The biweight kernel: one at the same place, and nothing from the reach on.
fn kernel(a: &Spot, b: &Spot) -> f64 {
    let share = 1.0 - a.position_cm.distance_squared(b.position_cm) / (REACH_CM * REACH_CM);
    share.max(0.0) * share.max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spot(x_cm: f64, weight: f64) -> Option<Spot> {
        Some(Spot { position_cm: DVec2::new(x_cm, 20.0), weight })
    }

    /// Eight folds of twenty rows here and twenty far away; those here say one.
    fn rows() -> (Vec<Option<Spot>>, Vec<usize>) {
        (0..320).map(|i| (spot(if i % 2 == 0 { 50.0 } else { 250.0 }, 1.0), i / 40)).unzip()
    }

    #[test]
    fn a_spot_tells_of_itself_alone() {
        let (spots, folds) = rows();
        let (nearby, held_out) = fit(&spots, &Neighbours::of(&spots), &folds, |i, _| f64::from(u8::from(i % 2 == 0)));
        // Seven folds of twenty rows against the prior.
        let expected = 140.0 / (PRIOR_ROWS + 140.0);
        assert!((held_out[0] - expected).abs() < 1e-9 && held_out[1] == 0.0, "{} {}", held_out[0], held_out[1]);
        assert!((nearby.at(spot(50.0, 1.0)) - 160.0 / (PRIOR_ROWS + 160.0)).abs() < 1e-9);
        assert!(nearby.at(spot(80.0, 1.0)) > 0.5, "near it");
        assert_eq!(nearby.at(spot(50.0 + REACH_CM, 1.0)), 0.0);
        assert_eq!(nearby.at(None), 0.0);
    }

    #[test]
    fn what_shows_half_as_much_is_told_half_as_much() {
        let (spots, folds) = rows();
        let (nearby, _) = fit(&spots, &Neighbours::of(&spots), &folds, |_, _| 1.0);
        assert_eq!(nearby.at(spot(50.0, -0.5)), -0.5 * nearby.at(spot(50.0, 1.0)));
    }

    #[test]
    fn rows_without_a_spot_say_nothing() {
        let spots = [None, None, spot(50.0, 1.0)];
        let (nearby, held_out) = fit(&spots, &Neighbours::of(&spots), &[0, 1, 1], |_, _| 1.0);
        assert_eq!(held_out, [0.0; 3]);
        assert_eq!(nearby.rows.len(), 1);
    }

    /// Log-odds of yes and no, half of them at a prediction of zero.
    #[test]
    fn working_responses_are_followed_to_where_they_settle() {
        let (spots, folds) = rows();
        let (nearby, _) = fit(&spots, &Neighbours::of(&spots), &folds, |_, p| p + 0.25 * (2.0 - p));
        let share = 160.0 / (PRIOR_ROWS + 160.0);
        // p = share (p + (2 − p) / 4)
        let expected = share * 0.5 / (1.0 - 0.75 * share);
        assert!((nearby.at(spot(50.0, 1.0)) - expected).abs() < 0.02, "{}", nearby.at(spot(50.0, 1.0)));
    }
}
