//! Variable projection (Golub and Pereyra 1973): the residuals of the best linear weights for given exponents,
//! and their Jacobian in Kaufman's (1975) approximation.
//!
//! Least squares and Levenberg–Marquardt need the samples only through the inner products of their columns, so these are
//! summed once for each set of exponents, and a problem of a few rows replaces that of all samples.

use std::f64::consts::LN_2;

use levenberg_marquardt::LeastSquaresProblem;
use mindgap_core::network::Scaling;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Owned};

use super::anchors::Anchored;
use super::gram::inner_products;

/// Ridge penalties: nearly collinear power terms would otherwise take large opposite weights and diverge outside the
/// data.
#[derive(Clone, Copy, Debug)]
pub struct Ridges {
    /// Penalty on the linear weights, per sample.
    pub weights: f64,
    /// Penalty on the exponents, per sample and relative to the variance of the targets.
    pub exponents: f64,
}

/// A data set and the exponents of a number of product units, as a least-squares problem in those exponents.
#[derive(Clone)]
pub struct Projection<const N: usize> {
    x: Vec<[f64; N]>,
    log2_x: Vec<[f64; N]>,
    targets: Vec<f64>,
    /// Weight of each sample, independent of the loss.
    base_weights: Vec<f64>,
    /// Weight of each sample in the current iteration.
    sample_weights: Vec<f64>,
    exponents: DVector<f64>,
    /// Penalty on the square of a linear weight, in units of squared residuals.
    weight_prior: f64,
    /// Penalty on the square of an exponent, in units of squared residuals.
    exponent_prior: f64,
    fit: Option<Fit>,
}

/// Solution of the linear least-squares problem for the current exponents.
#[derive(Clone)]
struct Fit {
    /// Linear weights: bias, slopes, outputs of the product units.
    weights: DVector<f64>,
    /// Reduced residuals: same norm and inner products as the residuals of all samples and ridges.
    residuals: DVector<f64>,
    /// The Jacobian of the residuals by the exponents, reduced alike.
    jacobian: DMatrix<f64>,
}

impl<const N: usize> Projection<N> {
    /// The problem for a data set whose inputs are scaled by `inputs`; `exponents` are those of each unit in turn.
    pub fn new(anchored: &Anchored<N>, inputs: &[Scaling<f32>; N], ridges: Ridges, exponents: DVector<f64>) -> Self {
        let data = &anchored.data;
        let scaled = |x: &[f32; N]| std::array::from_fn(|i| f64::from(inputs[i].apply(x[i])));
        let x: Vec<[f64; N]> = data.inputs.iter().map(scaled).collect();
        let count = x.len() as f64;
        let targets = DVector::from_iterator(x.len(), data.targets.iter().map(|t| f64::from(*t)));
        let mut problem = Projection {
            log2_x: x.iter().map(|x| x.map(libm::log2)).collect(),
            x,
            weight_prior: ridges.weights * count,
            exponent_prior: ridges.exponents * count * targets.variance(),
            targets: targets.as_slice().to_vec(),
            sample_weights: anchored.weights.clone(),
            base_weights: anchored.weights.clone(),
            exponents,
            fit: None,
        };
        problem.solve();
        problem
    }

    /// Returns the predictions, one per sample.
    pub fn predictions(&self) -> Vec<f64> {
        let weights = self.weights();
        let mut features = vec![0.0; weights.len()];
        let at = |sample| {
            self.features_at(sample, &mut features);
            features.iter().zip(&weights).map(|(f, w)| f * w).sum()
        };
        (0..self.x.len()).map(at).collect()
    }

    /// Replaces the targets and weights of the samples.
    pub fn reweight(&mut self, targets: Vec<f64>, weights: &[f64]) {
        self.targets = targets;
        self.sample_weights = weights.iter().zip(&self.base_weights).map(|(w, base)| w * base).collect();
        self.solve();
    }

    /// Returns bias, slopes and output weights of the product units; zeros where the normal equations are singular.
    pub fn weights(&self) -> Vec<f64> {
        self.fit.as_ref().map_or(vec![0.0; self.width()], |fit| fit.weights.as_slice().to_vec())
    }

    /// Returns the exponents, unit by unit.
    pub fn exponents(&self) -> &[f64] {
        self.exponents.as_slice()
    }

    /// Returns the number of linear weights: bias, slopes, product units.
    fn width(&self) -> usize {
        1 + N + self.exponents.len() / N
    }

    /// Writes the regressors of a sample: one, inputs, product units.
    fn features_at(&self, sample: usize, features: &mut [f64]) {
        let (affine, powers) = features.split_at_mut(1 + N);
        affine[0] = 1.0;
        affine[1..].copy_from_slice(&self.x[sample]);
        for (power, unit) in powers.iter_mut().zip(self.exponents.as_slice().chunks_exact(N)) {
            let sum: f64 = unit.iter().zip(&self.log2_x[sample]).map(|(w, l)| w * l).sum();
            *power = libm::exp2(sum);
        }
    }

    fn solve(&mut self) {
        self.fit = self.fitted();
    }

    fn fitted(&self) -> Option<Fit> {
        let (width, parameters) = (self.width(), self.exponents.len());
        // Columns: features, each product unit times the logarithm of each of its inputs, target.
        let products = inner_products(width + parameters + 1, &self.sample_weights, |sample, row| {
            let (features, others) = row.split_at_mut(width);
            self.features_at(sample, features);
            let logarithms = features[1 + N..].iter().flat_map(|p| self.log2_x[sample].iter().map(move |l| p * l));
            others.iter_mut().zip(logarithms.chain([self.targets[sample]])).for_each(|(place, x)| *place = x);
        });
        let target = width + parameters;
        let normal =
            products.view((0, 0), (width, width)) + DMatrix::from_diagonal_element(width, width, self.weight_prior);
        let normal = Cholesky::new(normal)?;
        let moments = products.view((0, target), (width, 1)).column(0).into_owned();
        let weights = normal.solve(&moments);
        let squares = products[(target, target)] - moments.dot(&weights);

        // Kaufman: the derivative of the features, less its projection onto the features.
        let slopes = DVector::from_fn(parameters, |p, _| -LN_2 * weights[1 + N + p / N]);
        let scale = DMatrix::from_diagonal(&slopes);
        let onto_features = products.view((0, width), (width, parameters)) * &scale;
        let taken_up = onto_features.tr_mul(&normal.solve(&onto_features));
        let of_changes = &scale * products.view((width, width), (parameters, parameters)) * &scale - taken_up
            + DMatrix::from_diagonal_element(parameters, parameters, self.exponent_prior);
        let with_residuals = &scale * products.view((width, target), (parameters, 1)).column(0)
            - onto_features.tr_mul(&weights)
            + &self.exponents * self.exponent_prior;
        let squares = squares + self.exponent_prior * self.exponents.norm_squared();

        // A triangular factor has the same inner products as the rows of all samples; a last row holds the rest.
        let triangle = Cholesky::new(of_changes)?;
        let along = triangle.l_dirty().solve_lower_triangular(&with_residuals)?;
        let rest = (squares - along.norm_squared()).max(0.0).sqrt();
        let residuals = along.push(rest);
        let jacobian = triangle.l().transpose().insert_row(parameters, 0.0);
        Some(Fit { weights, residuals, jacobian })
    }
}

impl<const N: usize> LeastSquaresProblem<f64, Dyn, Dyn> for Projection<N> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, exponents: &DVector<f64>) {
        self.exponents.copy_from(exponents);
        self.solve();
    }

    fn params(&self) -> DVector<f64> {
        self.exponents.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        Some(self.fit.as_ref()?.residuals.clone())
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        Some(self.fit.as_ref()?.jacobian.clone())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::learn::dataset::Dataset;
    use mindgap_foundations::random::generator;
    use rand::RngExt;

    const RIDGES: Ridges = Ridges { weights: 1e-3, exponents: 1e-3 };

    /// Returns a problem with forty samples of a curved surface, a third of which count double, and two random product
    /// units.
    fn problem(seed: u64) -> Projection<2> {
        let mut rng = generator(seed, &[]);
        let mut data = Dataset::default();
        for run in 0..40 {
            let x: [f32; 2] = std::array::from_fn(|_| rng.random_range(1.0..2.0));
            data.push(x, x[0] * x[0] / x[1] + rng.random_range(-0.1..0.1), run);
        }
        let weights = (0..40).map(|i| if i % 3 == 0 { 2.0 } else { 1.0 }).collect();
        let exponents = DVector::from_fn(4, |_, _| rng.random_range(-2.0..2.0));
        let inputs = [Scaling::onto_one_to_two(1.0, 2.0); 2];
        Projection::new(&Anchored { data, weights }, &inputs, RIDGES, exponents)
    }

    /// Returns the penalised sum of squares, from every sample and every ridge.
    fn sum_of_squares(problem: &Projection<2>) -> f64 {
        let errors = problem.predictions().into_iter().zip(&problem.targets).map(|(p, t)| (t - p) * (t - p));
        let samples: f64 = errors.zip(&problem.sample_weights).map(|(e, w)| e * w).sum();
        let squares = |numbers: &[f64]| numbers.iter().map(|x| x * x).sum::<f64>();
        samples
            + problem.weight_prior * squares(&problem.weights())
            + problem.exponent_prior * squares(problem.exponents())
    }

    #[test]
    fn reduced_problem_has_the_norm_and_the_gradient_of_all_samples() {
        for seed in 0..20 {
            let problem = problem(seed);
            let residuals = problem.residuals().unwrap();
            let whole = sum_of_squares(&problem);
            assert!((residuals.norm_squared() - whole).abs() < 1e-9 * whole, "seed {seed}");
            let slope = 2.0 * problem.jacobian().unwrap().tr_mul(&residuals);
            for (parameter, slope) in slope.iter().enumerate() {
                let at = |step: f64| {
                    let mut moved = problem.clone();
                    let mut exponents = problem.params();
                    exponents[parameter] += step;
                    moved.set_params(&exponents);
                    sum_of_squares(&moved)
                };
                let seen = (at(1e-5) - at(-1e-5)) / 2e-5;
                assert!((seen - slope).abs() < 1e-5 * (1.0 + seen.abs()), "seed {seed}: {seen} {slope}");
            }
        }
    }
}
