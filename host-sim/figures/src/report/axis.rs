//! Axes: ranges and round numbers along them.

use std::ops::Range;

use glam::DVec2;

use super::style::number;

/// Values of larger magnitude count as not drawable: an axis could not show them together with anything else.
const BOUND: f64 = 1e9;
/// Least span of an axis relative to the magnitude of its values.
const LEAST_SPAN: f64 = 1e-6;

/// Name, range and ticks of an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Quantity and unit.
    pub name: String,
    /// From its start to its end.
    pub range: Range<f64>,
    /// Values of the ticks.
    pub ticks: Vec<f64>,
    /// Number of decimals of the tick labels.
    decimals: usize,
}

/// Whether a chart can show a point.
pub fn is_drawable(point: DVec2) -> bool {
    point.abs().cmple(DVec2::splat(BOUND)).all()
}

/// Whether a range is wide enough for an axis.
pub fn is_range(range: &Range<f64>) -> bool {
    let ends = DVec2::new(range.start, range.end);
    is_drawable(ends) && range.end - range.start > LEAST_SPAN * (1.0 + ends.abs().max_element())
}

/// Position of a value in a range: 0 at its start, 1 at its end.
pub fn share(range: &Range<f64>, value: f64) -> f64 {
    (value - range.start) / (range.end - range.start)
}

/// The smallest range of values.
pub fn span(values: impl Iterator<Item = f64>) -> Range<f64> {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    low..high
}

impl Axis {
    /// An axis over a range for which [`is_range`] holds, with ticks at multiples of 1, 2 or 5 times a power of ten, at most
    /// `most` + 1 of them.
    pub fn new(name: impl Into<String>, range: Range<f64>, most: usize) -> Self {
        let (step, decimals) = step(&range, most);
        let (first, last) = (libm::ceil(range.start / step - 1e-9), libm::floor(range.end / step + 1e-9));
        let ticks = (0..=(last - first) as usize).map(|i| (first + i as f64) * step).collect();
        Axis { name: name.into(), range, ticks, decimals }
    }

    /// The same with ends moved outwards to ticks.
    pub fn rounded(name: impl Into<String>, range: Range<f64>, most: usize) -> Self {
        let (step, _) = step(&range, most);
        let (start, end) = (libm::floor(range.start / step + 1e-9), libm::ceil(range.end / step - 1e-9));
        Self::new(name, start * step..end * step, most + 1)
    }

    /// Returns an axis with ticks at some of the `counts`, evenly thinned so that at most `most` remain.
    pub fn of_counts(name: impl Into<String>, range: Range<f64>, counts: &[usize], most: usize) -> Self {
        let every = counts.len().div_ceil(most).max(1);
        let ticks = counts.iter().step_by(every).map(|count| *count as f64).collect();
        Axis { name: name.into(), range, ticks, decimals: 0 }
    }

    /// An axis of rows, the first at the top, without name and ticks.
    pub fn of_rows(rows: usize) -> Self {
        Axis { name: String::new(), range: rows as f64..0.0, ticks: Vec::new(), decimals: 0 }
    }

    /// Ticks as shares of the axis, with their labels.
    pub fn labelled(&self) -> impl Iterator<Item = (f64, String)> {
        self.ticks.iter().map(|tick| (share(&self.range, *tick), number(*tick, self.decimals)))
    }
}

/// Distance of ticks and the decimals that it needs.
fn step(range: &Range<f64>, most: usize) -> (f64, usize) {
    let finest = (range.end - range.start) / most as f64;
    let exponent = libm::floor(libm::log10(finest));
    let power = libm::exp10(exponent);
    let (step, exponent) = [(1.0, 0.0), (2.0, 0.0), (5.0, 0.0), (10.0, 1.0)]
        .into_iter()
        .map(|(digit, carry)| (digit * power, exponent + carry))
        .find(|(step, _)| *step >= finest)
        .unwrap_or((finest, exponent));
    (step, (-exponent).max(0.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn labels(axis: &Axis) -> Vec<String> {
        axis.labelled().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(Axis::new("", 0.0..300.0, 6).ticks, [0.0, 50.0, 100.0, 150.0, 200.0, 250.0, 300.0]);
        assert_eq!(labels(&Axis::new("", -0.31..0.33, 5)), ["−0.2", "0.0", "0.2"]);
    }

    #[test]
    fn rounded_axes_end_at_ticks() {
        assert_eq!(Axis::rounded("", -3.0..41.0, 5).range, -10.0..50.0);
        assert_eq!(Axis::rounded("", 0.0..1.0, 5).range, 0.0..1.0);
    }

    #[test]
    fn many_counts_have_few_ticks() {
        let counts: Vec<usize> = (1..=100).collect();
        assert_eq!(Axis::of_counts("", 0.5..100.5, &counts, 4).ticks, [1.0, 26.0, 51.0, 76.0]);
    }

    proptest! {
        #[test]
        fn every_range_has_a_few_ticks_inside(start in -1e5..1e5, exponent in -3.0..5.0, most in 3_usize..9) {
            let range = start..start + libm::exp10(exponent);
            let axis = Axis::new("", range.clone(), most);
            let slack = (range.end - range.start) * 1e-6;
            prop_assert!((1..=most + 1).contains(&axis.ticks.len()), "{axis:?}");
            prop_assert!(axis.ticks.iter().all(|t| *t >= range.start - slack && *t <= range.end + slack));
            let mut different = labels(&axis);
            different.dedup();
            prop_assert_eq!(different.len(), axis.ticks.len());
        }
    }
}
