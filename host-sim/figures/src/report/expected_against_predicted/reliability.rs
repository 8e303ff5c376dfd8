//! Reliability diagram: the observed frequency of an event in bins of its predicted probability.

use glam::DVec2;

use super::{headed, lines};
use crate::report::axis::Axis;
use crate::report::chart::{Plane, no_data};
use crate::report::style::{BLUE, GREY, Text};
use crate::report::svg::{Area, Svg};
use crate::report::trend::Trend;

const BINS: usize = 10;
/// Margin below probability 0 for the counts.
const FLOOR: f64 = -0.14;
const CEILING: f64 = 1.04;
const COUNT_PX: f64 = 8.5;
const INTERVAL_PX: f64 = 1.25;
const DOT_PX: f64 = 3.0;
/// Quantile of the normal distribution for a 95 % interval.
const Z95: f64 = 1.96;

/// The samples of one bin.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Bin {
    samples: usize,
    events: usize,
    predicted_sum: f64,
}

/// Draws the bins, and the trend over the single samples. Its R² is that of binary outcomes, which is low even for the
/// true probabilities.
pub fn draw(svg: &mut Svg, space: Area, title: &str, events: &[(f64, bool)]) {
    let sound: Vec<(f64, bool)> = events.iter().copied().filter(|(p, _)| (0.0..=1.0).contains(p)).collect();
    let points: Vec<DVec2> = sound.iter().map(|(p, came)| DVec2::new(*p, f64::from(u8::from(*came)))).collect();
    let trend = Trend::of(&points);
    let mut counts = format!("n = {}", sound.len());
    if sound.len() < events.len() {
        counts += &format!(", {} not in 0..1", events.len() - sound.len());
    }
    let body = headed(svg, space, title, trend, counts);
    let mut y = Axis::new("observed share", 0.0..1.0, 5);
    y.range = FLOOR..CEILING;
    let plane = Plane::new(body, Axis::new("predicted probability", 0.0..1.0, 5), y);
    plane.draw_axes(svg);
    if sound.is_empty() {
        return no_data(svg, plane.area);
    }
    lines(svg, &plane, 0.0, 1.0, trend);
    for (place, bin) in bins(&sound).iter().enumerate().filter(|(_, bin)| bin.samples > 0) {
        let x = bin.predicted_sum / bin.samples as f64;
        let (low, high) = bin.interval();
        svg.titled(&format!("{} samples", bin.samples), |svg| {
            svg.line(&[plane.place(x, low), plane.place(x, high)], BLUE.line(INTERVAL_PX));
            svg.circle(plane.place(x, bin.share()), DOT_PX, BLUE.fill());
        });
        let below = plane.place((place as f64 + 0.5) / BINS as f64, FLOOR / 2.0);
        svg.text(below, &bin.samples.to_string(), Text::new(COUNT_PX, GREY));
    }
}

/// Draws a bin's mark for the legend.
pub fn mark(svg: &mut Svg, at: DVec2) {
    svg.line(&[at - DVec2::Y * 8.0, at + DVec2::Y * 8.0], BLUE.line(INTERVAL_PX));
    svg.circle(at, DOT_PX, BLUE.fill());
}

fn bins(events: &[(f64, bool)]) -> [Bin; BINS] {
    let mut bins = [Bin::default(); BINS];
    for (predicted, came) in events {
        let bin = &mut bins[((predicted * BINS as f64) as usize).min(BINS - 1)];
        bin.samples += 1;
        bin.events += usize::from(*came);
        bin.predicted_sum += predicted;
    }
    bins
}

impl Bin {
    fn share(&self) -> f64 {
        self.events as f64 / self.samples as f64
    }

    /// Wilson's 95 % interval for the share.
    fn interval(&self) -> (f64, f64) {
        let (n, share, z2) = (self.samples as f64, self.share(), Z95 * Z95);
        let middle = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
        let half = Z95 / (1.0 + z2 / n) * (share * (1.0 - share) / n + z2 / (4.0 * n * n)).sqrt();
        (middle - half, middle + half)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sample_falls_into_its_tenth() {
        let bins = bins(&[(0.0, false), (0.05, true), (0.1, false), (0.999, true), (1.0, true)]);
        let counts = bins.map(|b| (b.samples, b.events));
        assert_eq!((counts[0], counts[1], counts[9]), ((2, 1), (1, 0), (2, 2)));
        assert_eq!(counts.iter().map(|c| c.0).sum::<usize>(), 5);
    }

    #[test]
    fn the_interval_is_wilsons() {
        // R: prop.test(8, 10, correct = FALSE) gives 0.4901625, 0.9433178.
        let (low, high) = Bin { samples: 10, events: 8, predicted_sum: 8.0 }.interval();
        assert!((low - 0.49016).abs() < 1e-4 && (high - 0.94332).abs() < 1e-4, "{low} {high}");
    }
}
