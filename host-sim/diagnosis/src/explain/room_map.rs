//! Where in the room the gap lies.

use glam::DVec2;
use serde::Serialize;

use super::Judged;
use super::strata::excess;
use crate::channel::Channel;
use crate::compare::Comparison;
use crate::fit::FitContext;

/// The gap over the floor, in squares.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RoomMap {
    /// Side of a square, cm.
    pub side_cm: f64,
    /// The squares in which the robot was, row by row from below.
    pub squares: Vec<Square>,
}

/// A square of the floor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Square {
    /// Its lower left corner, cm.
    pub x_cm: f64,
    /// Its lower left corner, cm.
    pub y_cm: f64,
    /// Rows of the logs in it.
    pub rows: usize,
    /// By how many nats each of them would be likelier.
    pub nats: f64,
}

/// Squares along the longer side of what was driven over.
const SQUARES: f64 = 12.0;

/// The map of a gap; none where there is no gap or nothing was tracked.
pub fn room_map(found: &Comparison, judged: &Judged, context: &FitContext) -> Option<RoomMap> {
    if matches!(judged, Judged::NoGap) {
        return None;
    }
    let known = !matches!(judged, Judged::Unknown);
    let rows = &context.observations.rows;
    let mut nats = vec![0.0; rows.len()];
    for channel in Channel::ALL {
        let excess = excess(found, known, channel, context);
        nats.iter_mut().zip(excess).for_each(|(sum, excess)| *sum += excess);
    }
    let places: Vec<(DVec2, f64)> = rows.iter().map(|row| row.context.pose.position_cm).zip(nats).collect();
    in_squares(&places)
}

fn in_squares(places: &[(DVec2, f64)]) -> Option<RoomMap> {
    let positions = || places.iter().map(|(at, _)| *at);
    let (low, high) = (positions().reduce(DVec2::min)?, positions().reduce(DVec2::max)?);
    // Whole centimetres, so that borders are round numbers.
    let side_cm = libm::ceil((high - low).max_element() / SQUARES).max(1.0);
    let mut squares = std::collections::BTreeMap::<[i64; 2], (usize, f64)>::new();
    for (at, nats) in places {
        let cell = (*at / side_cm).floor();
        let square = squares.entry([cell.y as i64, cell.x as i64]).or_default();
        *square = (square.0 + 1, square.1 + nats);
    }
    let square = |([y, x], (rows, nats)): ([i64; 2], (usize, f64))| Square {
        x_cm: x as f64 * side_cm,
        y_cm: y as f64 * side_cm,
        rows,
        nats: nats / rows as f64,
    };
    Some(RoomMap { side_cm, squares: squares.into_iter().map(square).collect() })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_hold_the_mean_of_what_lies_in_them() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let map = in_squares(&[(at(0.0, 0.0), 1.0), (at(3.0, 9.0), 2.0), (at(115.0, 1.0), -4.0)]).expect("places");
        assert_eq!(map.side_cm, 10.0);
        let told: Vec<_> = map.squares.iter().map(|s| (s.x_cm, s.y_cm, s.rows, s.nats)).collect();
        assert_eq!(told, [(0.0, 0.0, 2, 1.5), (110.0, 0.0, 1, -4.0)]);
        assert_eq!(in_squares(&[]), None);
    }

    #[test]
    fn a_robot_that_stands_has_one_square() {
        let map = in_squares(&[(DVec2::splat(7.5), 1.0); 3]).expect("places");
        assert_eq!((map.side_cm, map.squares.len(), map.squares[0].rows), (1.0, 1, 3));
    }
}
