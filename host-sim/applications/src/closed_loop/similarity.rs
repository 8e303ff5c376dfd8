//! Similarity of two controllers' paths up to the end of a real run: on similar paths the simulator has similar errors.

use glam::DVec2;
use mindgap_core::controller::Controller;

use mindgap_foundations::random::derive;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::RolloutRequest;

/// Position in cm at the start and after each step, for each run.
pub type Paths = Vec<Vec<DVec2>>;

/// Number of compared runs.
const RUNS: usize = 8;
/// Length scale of the similarity: distance between two paths as a share of the path length. Typical faults displace a
/// robot by about that: a motor that is 10 % weaker turns it by 0.05 rad per step of 11 cm, and other tyres change the
/// distance by a tenth.
const APART: f64 = 0.1;

/// Simulates paths of a controller. The same seed gives all controllers common random numbers.
pub fn paths(environment: &Environment, controller: &Controller, seed: u64) -> Paths {
    let motions = environment.motions(controller);
    let request = |run| RolloutRequest { controller, motions: &motions, seed: derive(seed, &[run as u64]) };
    let requests: Vec<_> = (0..RUNS).map(request).collect();
    let mut paths = vec![vec![environment.start_cm()]; RUNS];
    environment.run_watched(&requests, |run, point| paths[run].push(point.pose.position_cm));
    paths
}

/// Returns the similarity of the first `steps` steps of two controllers, 0..=1, as the mean over runs. A robot stays where
/// its run ended.
pub fn similarity(one: &Paths, other: &Paths, steps: usize) -> f64 {
    let of = |(one, other): (&Vec<DVec2>, &Vec<DVec2>)| {
        let at = |path: &[DVec2], step: usize| path[step.min(path.len() - 1)];
        let apart_cm = (1..=steps).map(|step| at(one, step).distance(at(other, step))).fold(0.0, f64::max);
        let way_cm: f64 = one.windows(2).take(steps).map(|step| step[0].distance(step[1])).sum();
        let deviations = apart_cm / (APART * way_cm).max(f64::EPSILON);
        libm::exp(-0.5 * deviations * deviations)
    };
    one.iter().zip(other).map(of).sum::<f64>() / one.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a path of ten steps along x and ten along y with the given step lengths.
    fn corner(first_cm: f64, then_cm: f64) -> Paths {
        let x_cm = |step: usize| first_cm * step.min(10) as f64;
        let y_cm = |step: usize| then_cm * step.saturating_sub(10) as f64;
        vec![(0..=20).map(|step| DVec2::new(x_cm(step), y_cm(step))).collect()]
    }

    #[test]
    fn similarity_decays_over_a_tenth_of_the_path_length() {
        let alike = |first_cm| similarity(&corner(10.0, 0.0), &corner(first_cm, 0.0), 10);
        assert_eq!(alike(10.0), 1.0);
        // They end ten centimetres apart after a metre.
        assert!((alike(9.0) - libm::exp(-0.5)).abs() < 1e-9 && (alike(11.0) - libm::exp(-0.5)).abs() < 1e-9);
        assert!(alike(5.0) < 1e-5 && alike(-10.0) < 1e-9);
    }

    #[test]
    fn steps_after_the_end_of_the_real_run_are_ignored() {
        let alike = |steps| similarity(&corner(10.0, 10.0), &corner(10.0, -10.0), steps);
        assert!(alike(10) == 1.0 && alike(11) < 1.0 && alike(20) < 1e-9);
    }

    #[test]
    fn an_ended_run_stays_at_its_last_position() {
        let mut ended = corner(10.0, 0.0);
        ended[0].truncate(11);
        assert_eq!(similarity(&corner(10.0, 0.0), &ended, 20), 1.0);
        assert_eq!(similarity(&ended, &corner(10.0, 0.0), 20), 1.0);
    }
}
