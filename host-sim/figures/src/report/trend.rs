//! Linear regression.

use glam::DVec2;

/// A line `y = slope * x + intercept` by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trend {
    /// Slope.
    pub slope: f64,
    /// Value at x = 0.
    pub intercept: f64,
    /// Coefficient of determination; 0 if y does not vary.
    pub r2: f64,
}

impl Trend {
    /// The trend of finite points; `None` if their x are all equal.
    pub fn of(points: &[DVec2]) -> Option<Self> {
        let mean = points.iter().sum::<DVec2>() / points.len() as f64;
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for point in points {
            let d = *point - mean;
            (xx, xy, yy) = (xx + d.x * d.x, xy + d.x * d.y, yy + d.y * d.y);
        }
        if points.is_empty() || xx <= 0.0 {
            return None;
        }
        let slope = xy / xx;
        let r2 = if yy > 0.0 { xy * xy / (xx * yy) } else { 0.0 };
        Some(Trend { slope, intercept: mean.y - slope * mean.x, r2 })
    }

    /// The value of the line at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.slope * x + self.intercept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_again() {
        let points: Vec<DVec2> = (0..9).map(|i| DVec2::new(f64::from(i), 3.0 - 0.5 * f64::from(i))).collect();
        assert_eq!(Trend::of(&points), Some(Trend { slope: -0.5, intercept: 3.0, r2: 1.0 }));
    }

    #[test]
    fn noise_lowers_the_share_explained() {
        let points = [(0.0, 0.0), (1.0, 3.0), (2.0, 0.0), (3.0, 3.0)].map(DVec2::from);
        let trend = Trend::of(&points).unwrap();
        assert!((trend.slope - 0.6).abs() < 1e-12 && (trend.intercept - 0.6).abs() < 1e-12);
        assert!((trend.r2 - 0.2).abs() < 1e-12);
    }

    #[test]
    fn no_spread_no_trend() {
        assert_eq!(Trend::of(&[]), None);
        assert_eq!(Trend::of(&[DVec2::ONE, DVec2::X]), None);
    }
}
