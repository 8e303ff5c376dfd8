//! The first echo of a fan. Each ray returns independently, with a probability that depends on its path length, its
//! incidence and its angle off the axis, and the nearest one that returns gives the reading. Mirrored rays lose strength at
//! the mirroring wall.

use super::Perturbation;
use super::fan::{DIRECT, FAN_DEG, Fan, RAYS, Ray};
use super::model::{FAR_CM, STRENGTHS, SonarModel};
use mindgap_foundations::statistics::summary::logistic;

/// A candidate for the first echo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstEcho {
    /// Probability that it arrives and that no nearer one does.
    pub probability: f64,
    /// Centre of its reading's distribution, cm.
    pub middle_cm: f64,
    /// Scale of its reading's Student distribution, cm.
    pub scale_cm: f64,
}

/// Returns the candidates, nearest first.
pub fn first_echoes(model: &SonarModel, fan: &Fan, perturbation: &Perturbation) -> [FirstEcho; RAYS] {
    let mut order: [usize; RAYS] = std::array::from_fn(|i| i);
    order.sort_by(|a, b| fan[*a].distance_cm.total_cmp(&fan[*b].distance_cm));
    let mut none_yet = 1.0;
    order.map(|i| {
        let ray = &fan[i];
        if ray.distance_cm.is_infinite() {
            return FirstEcho { probability: 0.0, middle_cm: model.range_cm[1], scale_cm: 1.0 };
        }
        let returns = if i < DIRECT {
            logistic(log_odds(model, ray, FAN_DEG[i], perturbation))
        } else {
            model.mirror_loss.map_or(0.0, |loss| {
                logistic(log_odds(model, ray, FAN_DEG[i], perturbation) - loss - perturbation.attenuation_mirrored)
            })
        };
        let probability = none_yet * returns;
        none_yet *= 1.0 - returns;
        FirstEcho {
            probability,
            middle_cm: middle_cm(model, ray, perturbation),
            scale_cm: scale_cm(model, ray, perturbation),
        }
    })
}

/// Returns the log-odds that a ray returns.
fn log_odds(model: &SonarModel, ray: &Ray, offset_deg: f64, perturbation: &Perturbation) -> f64 {
    let [metres, incidence] = units(ray);
    let strength: f64 = ray_features(ray, offset_deg).iter().zip(&model.strength).map(|(f, w)| f * w).sum();
    strength - perturbation.loss(metres, incidence)
}

/// Returns the reading that a ray gives, before scatter, cm.
fn middle_cm(model: &SonarModel, ray: &Ray, perturbation: &Perturbation) -> f64 {
    let bias = model.bias[0] + model.bias[1] * ray.distance_cm + model.bias[2] * ray.alpha_deg / 45.0;
    perturbation.middle_cm(ray.distance_cm + bias, model.range_cm)
}

fn scale_cm(model: &SonarModel, ray: &Ray, perturbation: &Perturbation) -> f64 {
    let [metres, incidence] = units(ray);
    let own = libm::exp(model.log_scatter[0] + model.log_scatter[1] * metres + model.log_scatter[2] * incidence);
    (own * own + perturbation.scatter_cm * perturbation.scatter_cm).sqrt()
}

/// Returns the features of a ray's log-odds.
fn ray_features(ray: &Ray, offset_deg: f64) -> [f64; STRENGTHS] {
    let [x, a] = units(ray);
    let off = offset_deg / 15.0;
    [1.0, x, x * x, a, a * a, a * a * a, a * x, a * a * x, off * off, off.abs()]
}

/// Returns the distance in metres, and the incidence in units of 45 degrees.
fn units(ray: &Ray) -> [f64; 2] {
    [ray.distance_cm.min(FAR_CM) / 100.0, ray.alpha_deg / 45.0]
}
