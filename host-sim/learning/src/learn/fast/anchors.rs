//! Anchors constrain a network where there are no samples: no log has every pair of commands, and no echo returns from
//! a wall that is far and oblique.

use mindgap_core::network::Scaling;

use crate::learn::dataset::Dataset;

/// A data set extended by anchors, with weights.
pub struct Anchored<const N: usize> {
    /// First the samples, then the anchors.
    pub data: Dataset<N>,
    /// One weight per sample or anchor.
    pub weights: Vec<f64>,
}

/// Number of points of the grid of anchors over all inputs.
const POINTS: f64 = 256.0;
/// Weight of an anchor, as a share of the average number of samples at a point of the grid.
const SHARE: f64 = 0.05;
/// Number of nearest samples whose mean is an anchor's target.
const NEAREST: usize = 20;

impl<const N: usize> Anchored<N> {
    /// Adds an anchor at every point of a grid over the whole range of the inputs that has no sample within one grid
    /// step. Its target is the mean target of the nearest samples.
    pub fn new(samples: &Dataset<N>, inputs: &[Scaling<f32>; N]) -> Self {
        let scaled = |x: &[f32; N]| -> [f32; N] { std::array::from_fn(|i| inputs[i].apply(x[i])) };
        let places: Vec<[f32; N]> = samples.inputs.iter().map(scaled).collect();
        let points = libm::round(libm::pow(POINTS, 1.0 / N as f64)) as usize;
        let count = points.pow(N as u32);
        let step = 1.0 / (points - 1) as f32;
        let mut data = samples.clone();
        for point in 0..count {
            let steps = |i: usize| (point / points.pow(i as u32) % points) as f32;
            let place: [f32; N] = std::array::from_fn(|i| inputs[i].low + steps(i) * step);
            if let Some(target) = beyond_samples(&places, &samples.targets, &place, step) {
                data.push(std::array::from_fn(|i| (place[i] - inputs[i].offset) / inputs[i].gain), target, 0);
            }
        }
        let weight = SHARE * samples.len() as f64 / count as f64;
        let weights = (0..data.len()).map(|i| if i < samples.len() { 1.0 } else { weight }).collect();
        Anchored { data, weights }
    }
}

/// The mean target of the samples nearest to a place, unless one of them is within `step` of it.
fn beyond_samples<const N: usize>(places: &[[f32; N]], targets: &[f32], place: &[f32; N], step: f32) -> Option<f32> {
    let distance = |p: &[f32; N]| p.iter().zip(place).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
    let mut by_distance: Vec<(f32, f32)> = places.iter().map(distance).zip(targets.iter().copied()).collect();
    if by_distance.iter().any(|(distance, _)| *distance < step * step) {
        return None;
    }
    let nearest = NEAREST.min(by_distance.len());
    by_distance.select_nth_unstable_by(nearest.checked_sub(1)?, |a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    Some(by_distance[..nearest].iter().map(|(_, target)| target).sum::<f32>() / nearest as f32)
}
