//! Aligns the clocks of a brick and a camera by matching wheel odometry with the motion seen by the camera.
//!
//! Both measure cumulative motion (rotation, travel). Between two rows of the brick log they must agree up to one scale factor
//! per component. An exhaustive search over offsets is followed by a joint refinement of offset and drift, which maximises a
//! posterior with a Student likelihood and a Cauchy prior on the drift.

use super::frame::GAP_MS;
use super::motion::{CumulativeMotion, MOTIONS};
use mindgap_foundations::statistics::summary::median;

/// The affine map from brick time to camera time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clocks {
    /// Camera time at brick time 0, ms.
    pub offset_ms: f64,
    /// Relative drift of the camera's clock: 1e-4 is 0.1 ms per second faster than the brick's.
    pub drift: f64,
}

/// The best alignment of two clocks and its quality.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// The clocks.
    pub clocks: Clocks,
    /// Fraction of the motion's variance that the alignment leaves unexplained, 0..=1.
    pub unexplained: f64,
    /// Unexplained fraction of the best other alignment; close to `unexplained` if the motion is repetitive.
    pub unexplained_elsewhere: f64,
    /// Number of the log's steps that the track covers.
    pub steps: usize,
}

/// Why an alignment cannot be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// Even the best alignment leaves much of the motion unexplained.
    Differs,
    /// Another alignment is nearly as good.
    Repeats,
    /// The clocks would drift apart faster than working clocks do.
    Drifts,
}

/// Maximum unexplained fraction of the motion's variance; slipping wheels or a rotated camera frame stay far below it.
const MAX_UNEXPLAINED: f64 = 0.3;
/// Maximum ratio of the unexplained fraction to that of any other alignment.
const MAX_RATIO_TO_OTHER: f64 = 0.5;
/// Maximum drift between two working clocks: 5 ms per second.
const MAX_DRIFT: f64 = 5e-3;

/// Increment of the offsets in the exhaustive search, ms.
const SEARCH_STEP_MS: f64 = 20.0;
/// Maximum number of step comparisons; more would take minutes.
const MAX_COMPARISONS: f64 = 1e8;
/// Offsets closer than this belong to the same alignment, ms.
const ELSEWHERE_MS: f64 = 600.0;
/// Minimum fraction of the log's steps that the track must cover.
const MIN_COVERED: f64 = 0.5;
/// Scale of the Cauchy prior on the drift, typical of quartz clocks: it keeps short logs from overfitting, and its heavy tails
/// still allow clocks that drift more.
const USUAL_DRIFT: f64 = 3e-5;
/// Degrees of freedom of the Student likelihood, whose heavy tails allow for slipping wheels.
const DEGREES_OF_FREEDOM: f64 = 4.0;
/// Lower bound on the scale of residuals (rad or cm) and on the unexplained fraction, which keeps logarithms finite.
const MIN_SCALE: f64 = 1e-6;
/// Initial drifts of the refinement.
const FIRST_DRIFTS: [f64; 7] = [0.0, 1e-3, -1e-3, 3e-3, -3e-3, 1e-2, -1e-2];
/// Initial step size of the refinement in time, ms.
const FIRST_STEP_MS: f64 = 16.0;
/// Initial step size of the refinement in drift.
const FIRST_DRIFT_STEP: f64 = 4e-4;
/// Number of halvings of the step sizes.
const HALVINGS: usize = 10;

impl Clocks {
    /// Converts brick time to camera time, ms.
    pub fn camera_ms(&self, brick_ms: f64) -> f64 {
        self.offset_ms + (1.0 + self.drift) * brick_ms
    }
}

impl Alignment {
    /// Returns why the alignment cannot be trusted, or `None` if it can.
    pub fn doubt(&self) -> Option<Doubt> {
        if self.unexplained > MAX_UNEXPLAINED {
            Some(Doubt::Differs)
        } else if self.unexplained > MAX_RATIO_TO_OTHER * self.unexplained_elsewhere {
            Some(Doubt::Repeats)
        } else if self.clocks.drift.abs() > MAX_DRIFT {
            Some(Doubt::Drifts)
        } else {
            None
        }
    }
}

/// Returns the alignment with the least unexplained motion; `None` if no offset makes track and log overlap enough, or nothing
/// moves.
pub fn align(log: &[CumulativeMotion], track: &[CumulativeMotion]) -> Option<Alignment> {
    let (first_ms, last_ms) = (track.first()?.t_ms, track.last()?.t_ms);
    let (from_ms, to_ms) = (log.first()?.t_ms, log.last()?.t_ms);
    let span_ms = last_ms - from_ms - (first_ms - to_ms);
    // Long recordings are searched with a coarser increment; the refinement makes up for it.
    let step_ms = SEARCH_STEP_MS.max(span_ms * log.len() as f64 / MAX_COMPARISONS);
    let candidates = unexplained_at_offsets(
        log,
        track,
        (0..=(span_ms / step_ms) as usize).map(|i| first_ms - to_ms + step_ms * i as f64),
    );
    let best = candidates.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let elsewhere =
        candidates.iter().filter(|(ms, _)| (ms - best.0).abs() > ELSEWHERE_MS).map(|(_, unexplained)| *unexplained);
    let unexplained_elsewhere = elsewhere.fold(1.0, f64::min);
    let clocks = refine(best.0, log, track);
    let misfit = Misfit::of(&clocks, log, track)?;
    Some(Alignment { clocks, unexplained: misfit.mean(), unexplained_elsewhere, steps: misfit.steps })
}

/// Returns the lag of at most `max_ms` with the smallest unexplained fraction, and that fraction, for a shared clock.
pub fn lag(log: &[CumulativeMotion], track: &[CumulativeMotion], max_ms: f64) -> Option<(f64, f64)> {
    let steps = (max_ms / SEARCH_STEP_MS) as i32;
    let candidates = unexplained_at_offsets(log, track, (-steps..=steps).map(|i| SEARCH_STEP_MS * f64::from(i)));
    candidates.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Returns the track's rotation and travel per rotation and travel of the log; `None` for what does not move.
pub fn gains(clocks: &Clocks, log: &[CumulativeMotion], track: &[CumulativeMotion]) -> [Option<f64>; MOTIONS] {
    Misfit::of(clocks, log, track).map_or([None; MOTIONS], |misfit| misfit.gains)
}

/// Returns the unexplained fraction at each offset, ms, at which track and log overlap enough.
fn unexplained_at_offsets(
    log: &[CumulativeMotion],
    track: &[CumulativeMotion],
    offsets_ms: impl Iterator<Item = f64>,
) -> Vec<(f64, f64)> {
    let unexplained = |offset_ms| Some(Misfit::of(&Clocks { offset_ms, drift: 0.0 }, log, track)?.mean());
    offsets_ms.filter_map(|offset_ms| Some((offset_ms, unexplained(offset_ms)?))).collect()
}

/// Refines offset and drift jointly about the middle of the log, where they are uncorrelated. From each initial drift the
/// search first descends the normal likelihood, whose basin is wide, then the robust Student likelihood, which also selects the
/// best result.
fn refine(offset_ms: f64, log: &[CumulativeMotion], track: &[CumulativeMotion]) -> Clocks {
    let middle_ms = log[log.len() / 2].t_ms;
    let clocks_of = |(at_middle_ms, drift): (f64, f64)| Clocks { offset_ms: at_middle_ms - drift * middle_ms, drift };
    let negative_log_posterior = |point: (f64, f64), likelihood: fn(&Misfit) -> f64| {
        let scaled_drift = point.1 / USUAL_DRIFT;
        Misfit::of(&clocks_of(point), log, track).map_or(f64::INFINITY, |misfit| likelihood(&misfit))
            + libm::log1p(scaled_drift * scaled_drift)
    };
    let optima = FIRST_DRIFTS.iter().flat_map(|drift| {
        let first = (offset_ms + drift * middle_ms, *drift);
        let by_squares = descend(first, |point| negative_log_posterior(point, Misfit::normal_negative_log_likelihood));
        [first, by_squares]
            .map(|point| descend(point, |point| negative_log_posterior(point, Misfit::student_negative_log_likelihood)))
    });
    let best = optima.min_by(|a, b| {
        negative_log_posterior(*a, Misfit::student_negative_log_likelihood)
            .total_cmp(&negative_log_posterior(*b, Misfit::student_negative_log_likelihood))
    });
    clocks_of(best.unwrap_or((offset_ms, 0.0)))
}

/// Finds a local minimum by pattern search with step halving.
fn descend(from: (f64, f64), value: impl Fn((f64, f64)) -> f64) -> (f64, f64) {
    let (mut best, mut least) = (from, value(from));
    let (mut step_ms, mut step_drift) = (FIRST_STEP_MS, FIRST_DRIFT_STEP);
    for _ in 0..HALVINGS {
        loop {
            let (ms, drift) = best;
            let around =
                [(ms + step_ms, drift), (ms - step_ms, drift), (ms, drift + step_drift), (ms, drift - step_drift)];
            let next = around.map(|point| (value(point), point)).into_iter().min_by(|a, b| a.0.total_cmp(&b.0));
            match next {
                Some((value, point)) if value < least => (least, best) = (value, point),
                _ => break,
            }
        }
        step_ms /= 2.0;
        step_drift /= 2.0;
    }
    best
}

/// Disagreement of wheels and camera for given clocks.
struct Misfit {
    /// Residuals per step of each component that moved: the camera's motion minus the scaled wheel motion.
    residuals: Vec<Vec<f64>>,
    /// Unexplained fraction of the variance of each of these components.
    unexplained: Vec<f64>,
    /// Camera's motion per wheel motion of each component; `None` if it did not move.
    gains: [Option<f64>; MOTIONS],
    /// Number of steps compared.
    steps: usize,
}

impl Misfit {
    /// Compares wheels and camera; `None` if too few steps are covered, or nothing moved.
    fn of(clocks: &Clocks, log: &[CumulativeMotion], track: &[CumulativeMotion]) -> Option<Self> {
        let seen: Vec<Option<[f64; MOTIONS]>> = log.iter().map(|row| at(track, clocks.camera_ms(row.t_ms))).collect();
        let steps: Vec<(usize, [f64; MOTIONS], [f64; MOTIONS])> =
            seen.windows(2).enumerate().filter_map(|(i, pair)| Some((i, pair[0]?, pair[1]?))).collect();
        if (steps.len() as f64) < MIN_COVERED * (log.len() - 1) as f64 {
            return None;
        }
        let (mut residuals, mut unexplained, mut gains) = (Vec::new(), Vec::new(), [None; MOTIONS]);
        for motion in 0..MOTIONS {
            let wheels = steps.iter().map(|(i, ..)| log[i + 1].by[motion] - log[*i].by[motion]);
            let camera = steps.iter().map(|(_, before, after)| after[motion] - before[motion]);
            let sum = |products: &mut dyn Iterator<Item = f64>| products.sum::<f64>();
            let cross_power = sum(&mut wheels.clone().zip(camera.clone()).map(|(w, c)| w * c)).max(0.0);
            let (wheel_power, camera_power) =
                (sum(&mut wheels.clone().map(|w| w * w)), sum(&mut camera.clone().map(|c| c * c)));
            if wheel_power > 0.0 && camera_power > 0.0 {
                gains[motion] = Some(cross_power / wheel_power);
                residuals.push(wheels.zip(camera).map(|(w, c)| c - cross_power / wheel_power * w).collect());
                unexplained.push(1.0 - cross_power * cross_power / (wheel_power * camera_power));
            }
        }
        (!residuals.is_empty()).then_some(Misfit { residuals, unexplained, gains, steps: steps.len() })
    }

    fn mean(&self) -> f64 {
        self.unexplained.iter().sum::<f64>() / self.unexplained.len() as f64
    }

    /// Returns the negative log-likelihood of the residuals under a normal distribution of unknown scale, up to a constant.
    fn normal_negative_log_likelihood(&self) -> f64 {
        let logs: f64 = self.unexplained.iter().map(|share| libm::log(share.max(MIN_SCALE))).sum();
        0.5 * self.steps as f64 * logs
    }

    /// Returns the negative log-likelihood of the residuals under a Student distribution scaled by their median, which is robust
    /// to occasional wheel slip.
    fn student_negative_log_likelihood(&self) -> f64 {
        let component = |residuals: &Vec<f64>| {
            let width = median(residuals.iter().map(|v| v.abs())).max(MIN_SCALE);
            let likelihood =
                |v: &f64| (DEGREES_OF_FREEDOM + 1.0) / 2.0 * libm::log1p(v * v / (DEGREES_OF_FREEDOM * width * width));
            residuals.iter().map(|v| likelihood(v) + libm::log(width)).sum::<f64>()
        };
        self.residuals.iter().map(component).sum()
    }
}

/// Interpolates cumulative motion between two frames; `None` outside the track and in its gaps.
fn at(track: &[CumulativeMotion], t_ms: f64) -> Option<[f64; MOTIONS]> {
    let after = track.partition_point(|frame| frame.t_ms < t_ms);
    let (before, after) = (track.get(after.checked_sub(1)?)?, track.get(after)?);
    let span_ms = after.t_ms - before.t_ms;
    if span_ms > GAP_MS {
        return None;
    }
    let share = (t_ms - before.t_ms) / span_ms;
    Some(std::array::from_fn(|motion| before.by[motion] + share * (after.by[motion] - before.by[motion])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pseudo-random number in -1..1.
    fn noise(n: u64) -> f64 {
        let mut x = n.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03;
        x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x ^= x >> 29;
        (x >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Integrates random rates of motion, each held for 400 ms.
    fn truth(seed: u64, t_ms: f64) -> [f64; MOTIONS] {
        let t_s = t_ms.max(0.0) / 1000.0;
        let whole = (t_s / 0.4) as u64;
        let rate = |k: u64| [1.5 * noise(seed + 2 * k), 20.0 * noise(seed + 2 * k + 1)];
        let mut sum = [0.0; MOTIONS];
        for k in 0..=whole {
            let share = if k == whole { t_s - 0.4 * whole as f64 } else { 0.4 };
            sum.iter_mut().zip(rate(k)).for_each(|(sum, rate)| *sum += rate * share);
        }
        sum
    }

    #[test]
    fn offset_and_drift_are_accurate_to_fifteen_milliseconds() {
        for seed in 0..20u64 {
            let salt = seed * 100_000;
            let clocks =
                Clocks { offset_ms: 3_000.0 + 50_000.0 * noise(salt + 7).abs(), drift: 3e-4 * noise(salt + 8) };
            let log: Vec<CumulativeMotion> = (0..=150u64)
                .map(|k| {
                    let t_ms = 400.0 * k as f64 + 15.0 * noise(salt + 9_000 + k).abs();
                    let by = truth(salt, t_ms);
                    CumulativeMotion {
                        t_ms,
                        by: [1.07 * by[0] + 0.02 * noise(salt + k), 0.94 * by[1] + 0.2 * noise(salt + 1 + k)],
                    }
                })
                .collect();
            let track: Vec<CumulativeMotion> = (0..4_500u64)
                .filter(|k| !(900..1_000).contains(k) && k % 17 != 3)
                .map(|k| {
                    let t_ms = 33.0 * k as f64 + 4.0 * noise(salt + 20_000 + k);
                    let by = truth(salt, ((t_ms - clocks.offset_ms) / (1.0 + clocks.drift)).clamp(0.0, 60_000.0));
                    CumulativeMotion {
                        t_ms,
                        by: [by[0] + 0.01 * noise(salt + 30_000 + k), by[1] + 0.3 * noise(salt + 40_000 + k)],
                    }
                })
                .collect();
            let found = align(&log, &track).unwrap();
            for brick_ms in [0.0, 30_000.0, 60_000.0] {
                let off_ms = found.clocks.camera_ms(brick_ms) - clocks.camera_ms(brick_ms);
                assert!(off_ms.abs() < 15.0, "seed {seed}: off by {off_ms} ms at {brick_ms}: {found:?}");
            }
            assert!(found.unexplained < 0.2 * found.unexplained_elsewhere, "{found:?}");
        }
    }

    #[test]
    fn no_alignment_without_overlap_or_motion() {
        let still = |n: u64, ms: f64| {
            (0..n).map(|k| CumulativeMotion { t_ms: ms * k as f64, by: [0.0; 2] }).collect::<Vec<_>>()
        };
        assert_eq!(align(&still(150, 400.0), &still(2_000, 33.0)), None);
        assert_eq!(align(&still(150, 400.0), &still(300, 33.0)), None);
        assert_eq!(align(&still(150, 400.0), &[]), None);
    }
}
