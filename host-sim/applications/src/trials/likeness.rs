//! How alike two controllers drive, as far as a real run of one got: what the simulator does not know of that run happens to
//! the other as well.

use glam::DVec2;
use mindgap_core::controller::Controller;

use mindgap_foundations::chance::derive;
use mindgap_models::simulator::environment::Environment;
use mindgap_models::simulator::rollout::RolloutRequest;

/// Where a robot is at the start and after each step, cm, run by run.
pub type Paths = Vec<Vec<DVec2>>;

/// Runs that are compared.
const RUNS: usize = 8;
/// Paths this far apart, as a share of the way, are as alike as one standard deviation. What keeps a controller from working
/// displaces a robot by about that: a motor 10 % weaker turns it by 0.05 rad each step of 11 cm, and on other tyres it goes a
/// tenth too far.
const APART: f64 = 0.1;

/// Simulated paths of a controller. The same seed gives all controllers the same chance.
pub fn paths(environment: &Environment, controller: &Controller, seed: u64) -> Paths {
    let motions = environment.motions(controller);
    let request = |run| RolloutRequest { controller, motions: &motions, seed: derive(seed, &[run as u64]) };
    let requests: Vec<_> = (0..RUNS).map(request).collect();
    let mut paths = vec![vec![environment.start_cm()]; RUNS];
    environment.run_watched(&requests, |run, point| paths[run].push(point.pose.position_cm));
    paths
}

/// How alike the first steps of two controllers are, 0..=1: the mean over runs. Whose run has ended stays where it is.
pub fn likeness(one: &Paths, other: &Paths, steps: usize) -> f64 {
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

    /// Ten steps along x and ten along y, so long each, from one place.
    fn corner(first_cm: f64, then_cm: f64) -> Paths {
        let x_cm = |step: usize| first_cm * step.min(10) as f64;
        let y_cm = |step: usize| then_cm * step.saturating_sub(10) as f64;
        vec![(0..=20).map(|step| DVec2::new(x_cm(step), y_cm(step))).collect()]
    }

    #[test]
    fn paths_are_alike_within_a_tenth_of_the_way() {
        let alike = |first_cm| likeness(&corner(10.0, 0.0), &corner(first_cm, 0.0), 10);
        assert_eq!(alike(10.0), 1.0);
        // They end ten centimetres apart after a metre.
        assert!((alike(9.0) - libm::exp(-0.5)).abs() < 1e-9 && (alike(11.0) - libm::exp(-0.5)).abs() < 1e-9);
        assert!(alike(5.0) < 1e-5 && alike(-10.0) < 1e-9);
    }

    #[test]
    fn what_comes_after_the_end_of_a_run_does_not_count() {
        let alike = |steps| likeness(&corner(10.0, 10.0), &corner(10.0, -10.0), steps);
        assert!(alike(10) == 1.0 && alike(11) < 1.0 && alike(20) < 1e-9);
    }

    #[test]
    fn who_has_ended_stays_where_it_is() {
        let mut ended = corner(10.0, 0.0);
        ended[0].truncate(11);
        assert_eq!(likeness(&corner(10.0, 0.0), &ended, 20), 1.0);
        assert_eq!(likeness(&ended, &corner(10.0, 0.0), 20), 1.0);
    }
}
