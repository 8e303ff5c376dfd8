//! The kernel: many runs advance together, one a lane, and a lane whose run has ended takes up the next.
//!
//! A step is computed for all lanes alike. What happens to single robots only, such as a reading that ends a tuple,
//! is looked at where the lanes say that it may happen.
//!
//! Each run draws from its own generator and no operation crosses lanes, so an outcome depends neither on the runs
//! beside it nor on the width of a vector.

mod readings;
mod robots;
#[cfg(test)]
mod tests;

use pulp::{Arch, Simd, WithSimd};

use super::environment::Environment;
use super::rollout::{RolloutOutcome, RolloutRequest, TrajectoryPoint};
use mindgap_foundations::lanes::{Lanes, WIDEST};
use robots::Robots;

impl Environment<'_> {
    /// Simulates runs side by side and returns their outcomes, in the order of the requests.
    pub fn run(&self, requests: &[RolloutRequest]) -> Vec<RolloutOutcome> {
        self.run_watched(requests, |_, _| {})
    }

    /// As [`run`](Self::run); `watch` receives every point of every trajectory, in order within each run, with the index of
    /// its request.
    pub fn run_watched(
        &self,
        requests: &[RolloutRequest],
        mut watch: impl FnMut(usize, TrajectoryPoint),
    ) -> Vec<RolloutOutcome> {
        let mut outcomes = vec![None; requests.len()];
        let finish = |request: usize, outcome| outcomes[request] = Some(outcome);
        Arch::new().dispatch(Batch { environment: self, requests, watch: &mut watch, finish });
        outcomes.into_iter().flatten().collect()
    }

    /// Simulates one run and returns its outcome and trajectory.
    pub fn trace(&self, request: RolloutRequest) -> (RolloutOutcome, Vec<TrajectoryPoint>) {
        let mut trajectory = Vec::new();
        let outcomes = self.run_watched(&[request], |_, point| trajectory.push(point));
        (outcomes[0], trajectory)
    }
}

/// Runs `requests`; `finish` receives the outcome of each with its index, and `watch` every trajectory point.
struct Batch<'a, W, F> {
    pub environment: &'a Environment<'a>,
    pub requests: &'a [RolloutRequest<'a>],
    pub watch: W,
    pub finish: F,
}

/// A number a lane.
type Row = [f32; WIDEST];

/// The draws of one step.
struct StepDraws {
    /// For the networks, an echo comes back where this is below its probability; for the beam, the place within an
    /// interval of readings.
    echo: Row,
    /// For the networks, the reading is the constant one where this is below its probability; for the beam, what chooses
    /// the outcome.
    constant: Row,
    /// Raw bits that choose residuals of the step.
    bits: [u32; WIDEST],
    /// The same for residuals that last.
    held_bits: [u32; WIDEST],
}

impl<W: FnMut(usize, TrajectoryPoint), F: FnMut(usize, RolloutOutcome)> WithSimd for Batch<'_, W, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let width = Lanes::<S>::WIDTH;
        let mut waiting = self.requests.iter().copied().enumerate();
        let mut robots = Robots::new(self.environment);
        for lane in 0..width {
            robots.begin(lane, waiting.next());
        }
        while robots.running > 0 {
            let draws = robots.draw(simd);
            let from = robots.place();
            let may_touch = robots.advance(simd, &draws);
            let echo_cm = robots.sense(simd, &draws);
            let happens = robots.happens(simd, &echo_cm, may_touch);
            for (lane, happens) in happens.iter().enumerate().take(width) {
                let ended = if *happens > 0.0 { robots.close(lane, *happens, &from, &echo_cm) } else { None };
                if let Some((number, point)) = robots.trajectory_point(lane, &echo_cm, &ended) {
                    (self.watch)(number, point);
                }
                if let Some((number, outcome)) = ended {
                    (self.finish)(number, outcome);
                    robots.begin(lane, waiting.next());
                }
            }
        }
    }
}

/// One of the equally likely residuals, five bits each: networks 0 to 2 of motion, 3 of the sonar.
#[inline(always)]
fn level(bits: u32, network: u32) -> usize {
    (bits >> (5 * network)) as usize % super::residuals::LEVELS
}

#[inline(always)]
fn load<S: Simd>(simd: S, row: &Row) -> Lanes<S> {
    Lanes::load(simd, &row[..Lanes::<S>::WIDTH])
}

#[inline(always)]
fn row<S: Simd>(lanes: Lanes<S>) -> Row {
    let mut row = [0.0; WIDEST];
    lanes.store(&mut row[..Lanes::<S>::WIDTH]);
    row
}
