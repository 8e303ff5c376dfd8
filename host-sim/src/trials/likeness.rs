//! How alike two controllers drive, as far as a real run of one got: what the simulator does not know of that run happens to
//! the other as well.

use glam::DVec2;
use mindgap_core::controller::Controller;

use crate::chance::derive;
use crate::simulator::environment::Environment;
use crate::simulator::rollout::RolloutRequest;

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
    use crate::built_in_robot::four_obstacles;
    use crate::evolve::test_support::SIMULATOR;
    use crate::simulator::Noise;
    use mindgap_core::controller::{Tuple, When};

    /// On until a wall is near, then back.
    fn controller(on: i8, back: i8) -> Controller {
        let tuple = |speed| Tuple { left: speed, right: speed, when: When::Smaller, threshold_cm: 40 };
        let mut tuples = [tuple(back); 6];
        tuples[0] = tuple(on);
        tuples[1].threshold_cm = 0;
        Controller { step_ms: 400, max_steps: 40, tuples }
    }

    #[test]
    fn what_comes_after_the_end_of_a_run_does_not_count() {
        let scene = four_obstacles();
        let environment = Environment::new(&SIMULATOR, &scene, scene.starts[0], Noise::Learned).expect("room");
        let paths = |controller: &Controller| paths(&environment, controller, 7);
        let one = paths(&controller(60, -50));
        let alike = |other: &Controller, steps| likeness(&one, &paths(other), steps);
        assert_eq!(alike(&controller(60, -50), 40), 1.0);
        // Another way back after the same way on, but for a reading out of nowhere that ends it.
        let slower = [3, 40].map(|steps| alike(&controller(60, -10), steps));
        assert!(slower[0] > 0.8 && slower[1] < 0.2, "{slower:?}");
        // Nearly as fast, half as fast, and backwards.
        let other = [58, 30, -60].map(|on| alike(&controller(on, -50), 3));
        assert!(other[0] > 0.8 && other[1] < 0.1 && other[2] < 1e-6, "{other:?}");
    }
}
