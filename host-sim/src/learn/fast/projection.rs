//! Variable projection: the residuals that the best linear weights leave for given exponents, and how they change with
//! the exponents.

use std::f64::consts::LN_2;

use levenberg_marquardt::LeastSquaresProblem;
use mindgap_core::network::Scaling;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn, Owned};

use super::anchors::Anchored;

/// How much weights are held back: power terms that are nearly alike would grow against each other, and run wild outside
/// the data.
#[derive(Clone, Copy, Debug)]
pub struct Ridges {
    /// Of the linear weights, per sample.
    pub weights: f64,
    /// Of the exponents, per sample and as a share of the targets' variance.
    pub exponents: f64,
}

/// A data set with exponents of `units` product units, as a least-squares problem in those exponents.
///
/// Residuals come in three groups: one a sample, one a linear weight (the ridge), one an exponent (the other ridge).
#[derive(Clone)]
pub struct Projection<const N: usize> {
    x: Vec<[f64; N]>,
    log2_x: Vec<[f64; N]>,
    targets: DVector<f64>,
    /// What each sample counts, whatever the loss.
    base_weights: Vec<f64>,
    /// Square roots of the samples' weights.
    roots: DVector<f64>,
    exponents: DVector<f64>,
    /// What a linear weight of one adds to the residuals.
    weight_prior: f64,
    /// The same for an exponent of one.
    exponent_prior: f64,
    fit: Fit,
}

/// What the linear least-squares problem gives for the exponents.
#[derive(Clone)]
struct Fit {
    /// Weighted samples and ridge rows by columns: one, inputs, product units.
    features: DMatrix<f64>,
    /// Of the features' normal matrix.
    normal: Option<Cholesky<f64, Dyn>>,
    /// Linear weights: bias, slopes, outputs of the product units.
    weights: DVector<f64>,
    residuals: DVector<f64>,
}

impl<const N: usize> Projection<N> {
    /// The problem for a data set whose inputs are scaled so.
    pub fn new(anchored: &Anchored<N>, inputs: &[Scaling<f32>; N], ridges: Ridges, exponents: DVector<f64>) -> Self {
        let data = &anchored.data;
        let scaled = |x: &[f32; N]| std::array::from_fn(|i| f64::from(inputs[i].apply(x[i])));
        let x: Vec<[f64; N]> = data.inputs.iter().map(scaled).collect();
        let count = x.len();
        let nothing = Fit {
            features: DMatrix::zeros(0, 0),
            normal: None,
            weights: DVector::zeros(0),
            residuals: DVector::zeros(0),
        };
        let targets = DVector::from_iterator(count, data.targets.iter().map(|t| f64::from(*t)));
        let mut problem = Projection {
            log2_x: x.iter().map(|x| x.map(libm::log2)).collect(),
            x,
            weight_prior: (ridges.weights * count as f64).sqrt(),
            exponent_prior: (ridges.exponents * count as f64 * targets.variance()).sqrt(),
            targets,
            roots: DVector::from_iterator(count, anchored.weights.iter().map(|w| w.sqrt())),
            base_weights: anchored.weights.clone(),
            exponents,
            fit: nothing,
        };
        problem.solve();
        problem
    }

    /// What the network says for each sample.
    pub fn predictions(&self) -> Vec<f64> {
        let count = self.x.len();
        (0..count).map(|i| self.features_at(i).iter().zip(self.fit.weights.iter()).map(|(f, w)| f * w).sum()).collect()
    }

    /// Gives samples other targets and weights.
    pub fn reweight(&mut self, targets: DVector<f64>, weights: &[f64]) {
        self.targets = targets;
        let weights = weights.iter().zip(&self.base_weights).map(|(w, base)| (w * base).sqrt());
        self.roots = DVector::from_iterator(self.x.len(), weights);
        self.solve();
    }

    /// Bias, slopes and outputs of the product units.
    pub fn weights(&self) -> &[f64] {
        self.fit.weights.as_slice()
    }

    /// The exponents, unit by unit.
    pub fn exponents(&self) -> &[f64] {
        self.exponents.as_slice()
    }

    fn units(&self) -> usize {
        self.exponents.len() / N
    }

    fn features_at(&self, sample: usize) -> Vec<f64> {
        let mut row = Vec::with_capacity(1 + N + self.units());
        row.push(1.0);
        row.extend(self.x[sample]);
        for unit in self.exponents.as_slice().chunks_exact(N) {
            let sum: f64 = unit.iter().zip(&self.log2_x[sample]).map(|(w, l)| w * l).sum();
            row.push(libm::exp2(sum));
        }
        row
    }

    fn solve(&mut self) {
        let (count, width) = (self.x.len(), 1 + N + self.units());
        let mut features = DMatrix::zeros(count + width, width);
        for i in 0..count {
            for (j, feature) in self.features_at(i).into_iter().enumerate() {
                features[(i, j)] = self.roots[i] * feature;
            }
        }
        (0..width).for_each(|j| features[(count + j, j)] = self.weight_prior);
        let mut targets = DVector::zeros(count + width);
        targets.rows_mut(0, count).copy_from(&self.targets.component_mul(&self.roots));
        let normal = Cholesky::new(features.tr_mul(&features));
        let moments = features.tr_mul(&targets);
        let weights = normal.as_ref().map_or(DVector::zeros(width), |n| n.solve(&moments));
        let residuals = &targets - &features * &weights;
        self.fit = Fit { features, normal, weights, residuals };
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
        self.fit.normal.as_ref()?;
        let prior = self.exponent_prior;
        let fitted = self.fit.residuals.iter().copied();
        let all = fitted.chain(self.exponents.iter().map(|e| prior * e));
        Some(DVector::from_iterator(self.fit.residuals.len() + self.exponents.len(), all))
    }

    /// Kaufman's form: the change of the features, less what the linear weights would take up of it.
    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let normal = self.fit.normal.as_ref()?;
        let (rows, count, parameters) = (self.fit.features.nrows(), self.x.len(), self.exponents.len());
        let mut change = DMatrix::zeros(rows, parameters);
        for parameter in 0..parameters {
            let (unit, input) = (parameter / N, parameter % N);
            let (column, slope) = (1 + N + unit, LN_2 * self.fit.weights[1 + N + unit]);
            for i in 0..count {
                change[(i, parameter)] = -slope * self.log2_x[i][input] * self.fit.features[(i, column)];
            }
        }
        let taken_up = normal.solve(&self.fit.features.tr_mul(&change));
        let mut jacobian = DMatrix::zeros(rows + parameters, parameters);
        jacobian.rows_mut(0, rows).copy_from(&(change - &self.fit.features * taken_up));
        (0..parameters).for_each(|p| jacobian[(rows + p, p)] = self.exponent_prior);
        Some(jacobian)
    }
}
