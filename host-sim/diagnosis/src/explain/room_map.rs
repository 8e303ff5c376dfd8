//! Map of the gap over the floor.

use glam::DVec2;
use serde::Serialize;

use super::strata::excess;
use crate::confirm::Confirmed;
use crate::fit::FitContext;
use crate::verdict::Verdict;

/// The gap by squares of the floor.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RoomMap {
    /// Side of a square, cm.
    pub side_cm: f64,
    /// The squares that the robot visited, row by row from the bottom.
    pub squares: Vec<Square>,
}

/// A square of the floor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Square {
    /// Its lower left corner, cm.
    pub x_cm: f64,
    /// Its lower left corner, cm.
    pub y_cm: f64,
    /// Number of logged rows in it.
    pub rows: usize,
    /// Mean gap of these rows, nats.
    pub nats: f64,
}

/// Number of squares along the longer side of the visited area.
const SQUARES: f64 = 12.0;

/// Returns the map of a gap, or `None` if there is no gap.
pub fn room_map(found: &Confirmed, verdict: Verdict, context: &FitContext) -> Option<RoomMap> {
    if verdict == Verdict::NoGap {
        return None;
    }
    let positions = context.rows.rows.iter().map(|row| row.context.pose.position_cm);
    let places: Vec<(DVec2, f64)> = positions.zip(excess(found, verdict).by_row()).collect();
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
    fn square_has_the_mean_gap_of_its_rows() {
        let at = |x: f64, y: f64| DVec2::new(x, y);
        let map = in_squares(&[(at(0.0, 0.0), 1.0), (at(3.0, 9.0), 2.0), (at(115.0, 1.0), -4.0)]).expect("places");
        assert_eq!(map.side_cm, 10.0);
        let squares: Vec<_> = map.squares.iter().map(|s| (s.x_cm, s.y_cm, s.rows, s.nats)).collect();
        assert_eq!(squares, [(0.0, 0.0, 2, 1.5), (110.0, 0.0, 1, -4.0)]);
        assert_eq!(in_squares(&[]), None);
    }

    #[test]
    fn standing_robot_has_one_square() {
        let map = in_squares(&[(DVec2::splat(7.5), 1.0); 3]).expect("places");
        assert_eq!((map.side_cm, map.squares.len(), map.squares[0].rows), (1.0, 1, 3));
    }
}
