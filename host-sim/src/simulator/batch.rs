//! The kernel: many runs advance together, one a lane, and a lane whose run has ended takes up the next.
//!
//! A step is worked out for all lanes alike. What happens to single robots only, such as a reading that ends a tuple,
//! is looked at where the lanes say that it may happen.
//!
//! Each run draws from its own generator and no operation crosses lanes, so an outcome depends neither on the runs
//! beside it nor on the width of a vector.

mod readings;
mod robots;
#[cfg(test)]
mod tests;

use pulp::{Simd, WithSimd};

use super::course::{Course, Job, Moment, Outcome, Sensor};
use crate::lanes::{Lanes, WIDEST};
use robots::Robots;

/// Runs `jobs`, which all have `sensor`; `finish` is told the outcome of each by its number, `watch` every moment of
/// all.
pub(super) struct Batch<'a, W, F> {
    pub course: &'a Course<'a>,
    pub sensor: Sensor,
    pub jobs: &'a [(usize, Job<'a>)],
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

impl<W: FnMut(Moment), F: FnMut(usize, Outcome)> WithSimd for Batch<'_, W, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let width = Lanes::<S>::WIDTH;
        let mut waiting = self.jobs.iter().copied();
        let mut robots = Robots::new(self.course);
        for lane in 0..width {
            robots.begin(lane, waiting.next());
        }
        while robots.running > 0 {
            let draws = robots.draw(simd);
            let from = robots.place();
            let may_touch = robots.advance(simd, &draws);
            let echo_cm = robots.sense(simd, self.sensor, &draws);
            let happens = robots.happens(simd, &echo_cm, may_touch);
            for (lane, happens) in happens.iter().enumerate().take(width) {
                let ended = if *happens > 0.0 { robots.close(lane, *happens, &from, &echo_cm) } else { None };
                if let Some(moment) = robots.moment(lane, &echo_cm, &ended) {
                    (self.watch)(moment);
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
    (bits >> (5 * network)) as usize % super::scatter::LEVELS
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
