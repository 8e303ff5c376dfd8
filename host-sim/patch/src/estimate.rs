//! A number with its uncertainty.

/// An estimated number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The estimate.
    pub value: f64,
    /// Its 95 % interval, if known.
    pub ci95: Option<[f64; 2]>,
}

impl Estimate {
    /// Returns what a monotonic function makes of it.
    pub fn map(self, f: impl Fn(f64) -> f64) -> Self {
        let ends = self.ci95.map(|ends| ends.map(&f)).map(|[a, b]| [a.min(b), a.max(b)]);
        Estimate { value: f(self.value), ci95: ends }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decreasing_functions_swap_the_ends_of_an_interval() {
        let halved = Estimate { value: 2.0, ci95: Some([1.0, 4.0]) }.map(|x| 1.0 / x);
        assert_eq!(halved, Estimate { value: 0.5, ci95: Some([0.25, 1.0]) });
    }
}
