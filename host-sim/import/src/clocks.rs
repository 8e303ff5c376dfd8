//! Aligns the clock of a brick with that of a camera by matching wheel odometry with the motion that the camera saw.
//!
//! Both give the same cumulative motions (rotation, travel). Between two rows of the brick's log they have to agree up to
//! one scale factor for each motion. An exhaustive search over offsets is followed by a joint refinement of offset and
//! drift, which maximises a posterior with a Student likelihood and a Cauchy prior on the drift.

use super::frame::GAP_MS;
use super::motion::{CumulativeMotion, MOTIONS};
use mindgap_foundations::statistics::summary::median;

/// The affine map from brick time to camera time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clocks {
    /// Camera time at brick time 0, ms.
    pub offset_ms: f64,
    /// Relative drift of the camera's clock: 1e-4 is 0.1 ms a second faster than the brick's.
    pub drift: f64,
}

/// The best alignment of two clocks and its quality.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alignment {
    /// The clocks.
    pub clocks: Clocks,
    /// Share of the motion's variance that the alignment leaves unexplained, 0..=1.
    pub unexplained: f64,
    /// The same of the best alignment elsewhere; close to `unexplained` if the motion repeats itself.
    pub unexplained_elsewhere: f64,
    /// Number of steps of the log that the track covers.
    pub steps: usize,
}

/// Why an alignment is not to be trusted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Doubt {
    /// Even the best one leaves much of the motion unexplained.
    Differs,
    /// Another one is nearly as good.
    Repeats,
    /// The clocks would run apart faster than working clocks do.
    Drifts,
}

/// Largest share of the motion's variance that an alignment may leave unexplained; slipping wheels or a rotated camera
/// frame stay far below it.
const MOST_UNEXPLAINED: f64 = 0.3;
/// The unexplained share must be at most this fraction of that of any other alignment.
const CLEARLY: f64 = 0.5;
/// Largest drift between two working clocks: 5 ms a second.
const MOST_DRIFT: f64 = 5e-3;

/// Spacing of the offsets in the exhaustive search.
const SEARCH_STEP_MS: f64 = 20.0;
/// With more comparisons of steps the search takes minutes.
const MOST_COMPARISONS: f64 = 1e8;
/// Offsets closer than this belong to the same alignment.
const ELSEWHERE_MS: f64 = 600.0;
/// Least share of the log's steps that the track has to cover.
const LEAST_COVERED: f64 = 0.5;
/// Scale of the Cauchy prior on the drift, that of ordinary quartz clocks: short logs cannot overfit it, and its heavy
/// tails still admit clocks that drift more.
const USUAL_DRIFT: f64 = 3e-5;
/// Degrees of freedom of the Student likelihood, whose heavy tails admit slipping wheels.
const DEGREES_OF_FREEDOM: f64 = 4.0;
/// Lower bound on the scale of residuals (rad or cm) and on the unexplained share, which keeps logarithms finite.
const EXACT: f64 = 1e-6;
/// Initial drifts of the refinement.
const FIRST_DRIFTS: [f64; 7] = [0.0, 1e-3, -1e-3, 3e-3, -3e-3, 1e-2, -1e-2];
/// Initial step sizes of the refinement.
const FIRST_STEP_MS: f64 = 16.0;
const FIRST_DRIFT: f64 = 4e-4;
/// Number of times that the step sizes are halved.
const HALVINGS: usize = 10;

impl Clocks {
    /// Camera time of a brick time, ms.
    pub fn camera_ms(&self, brick_ms: f64) -> f64 {
        self.offset_ms + (1.0 + self.drift) * brick_ms
    }
}

impl Alignment {
    /// Why it is not to be trusted; `None` if it is.
    pub fn doubt(&self) -> Option<Doubt> {
        if self.unexplained > MOST_UNEXPLAINED {
            Some(Doubt::Differs)
        } else if self.unexplained > CLEARLY * self.unexplained_elsewhere {
            Some(Doubt::Repeats)
        } else if self.clocks.drift.abs() > MOST_DRIFT {
            Some(Doubt::Drifts)
        } else {
            None
        }
    }
}

/// The alignment with the least unexplained motion; `None` if no offset makes track and log overlap enough, or nothing
/// moves.
pub fn align(log: &[CumulativeMotion], track: &[CumulativeMotion]) -> Option<Alignment> {
    let (first_ms, last_ms) = (track.first()?.t_ms, track.last()?.t_ms);
    let (from_ms, to_ms) = (log.first()?.t_ms, log.last()?.t_ms);
    let span_ms = last_ms - from_ms - (first_ms - to_ms);
    // Twice as long recordings are searched half as finely beyond what takes seconds: the refinement finds the rest.
    let step_ms = SEARCH_STEP_MS.max(span_ms * log.len() as f64 / MOST_COMPARISONS);
    let tried = tried(log, track, (0..=(span_ms / step_ms) as usize).map(|i| first_ms - to_ms + step_ms * i as f64));
    let best = tried.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let elsewhere = tried.iter().filter(|(ms, _)| (ms - best.0).abs() > ELSEWHERE_MS).map(|(_, left)| *left);
    let unexplained_elsewhere = elsewhere.fold(1.0, f64::min);
    let clocks = refine(best.0, log, track);
    let misfit = Misfit::of(&clocks, log, track)?;
    Some(Alignment { clocks, unexplained: misfit.mean(), unexplained_elsewhere, steps: misfit.steps })
}

/// The least unexplained share among clocks that are one but for a lag of at most `most_ms`, and that lag, ms.
pub fn lag(log: &[CumulativeMotion], track: &[CumulativeMotion], most_ms: f64) -> Option<(f64, f64)> {
    let steps = (most_ms / SEARCH_STEP_MS) as i32;
    let tried = tried(log, track, (-steps..=steps).map(|i| SEARCH_STEP_MS * f64::from(i)));
    tried.into_iter().min_by(|a, b| a.1.total_cmp(&b.1))
}

/// The unexplained share at each offset, ms, that makes track and log overlap enough.
fn tried(
    log: &[CumulativeMotion],
    track: &[CumulativeMotion],
    offsets_ms: impl Iterator<Item = f64>,
) -> Vec<(f64, f64)> {
    let unexplained = |offset_ms| Some(Misfit::of(&Clocks { offset_ms, drift: 0.0 }, log, track)?.mean());
    offsets_ms.filter_map(|offset_ms| Some((offset_ms, unexplained(offset_ms)?))).collect()
}

/// Refines offset and drift jointly about the middle of the log, where they are uncorrelated. From each initial drift the
/// search descends first the normal likelihood, whose basin is wide, and then the robust Student likelihood, by which the
/// best result is selected.
fn refine(offset_ms: f64, log: &[CumulativeMotion], track: &[CumulativeMotion]) -> Clocks {
    let middle_ms = log[log.len() / 2].t_ms;
    let about = |(at_middle_ms, drift): (f64, f64)| Clocks { offset_ms: at_middle_ms - drift * middle_ms, drift };
    let negative_log_posterior = |point: (f64, f64), law: fn(&Misfit) -> f64| {
        let usual = point.1 / USUAL_DRIFT;
        Misfit::of(&about(point), log, track).map_or(f64::INFINITY, |misfit| law(&misfit)) + libm::log1p(usual * usual)
    };
    let found = FIRST_DRIFTS.iter().flat_map(|drift| {
        let first = (offset_ms + drift * middle_ms, *drift);
        let by_squares = descend(first, |point| negative_log_posterior(point, Misfit::normal_negative_log_likelihood));
        [first, by_squares]
            .map(|point| descend(point, |point| negative_log_posterior(point, Misfit::student_negative_log_likelihood)))
    });
    let best = found.min_by(|a, b| {
        negative_log_posterior(*a, Misfit::student_negative_log_likelihood)
            .total_cmp(&negative_log_posterior(*b, Misfit::student_negative_log_likelihood))
    });
    about(best.unwrap_or((offset_ms, 0.0)))
}

/// A local minimum by pattern search with halved steps.
fn descend(from: (f64, f64), value: impl Fn((f64, f64)) -> f64) -> (f64, f64) {
    let (mut best, mut least) = (from, value(from));
    let (mut step_ms, mut step_drift) = (FIRST_STEP_MS, FIRST_DRIFT);
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

/// Disagreement of wheels and camera under given clocks.
struct Misfit {
    /// Residuals of each motion that occurred, one a step: the camera's motion minus the scaled motion of the wheels.
    left: Vec<Vec<f64>>,
    /// Unexplained share of the variance of each of these motions.
    unexplained: Vec<f64>,
    /// Number of steps compared.
    steps: usize,
}

impl Misfit {
    /// `None` if too few steps are covered, or nothing moved.
    fn of(clocks: &Clocks, log: &[CumulativeMotion], track: &[CumulativeMotion]) -> Option<Self> {
        let seen: Vec<Option<[f64; MOTIONS]>> = log.iter().map(|row| at(track, clocks.camera_ms(row.t_ms))).collect();
        let steps: Vec<(usize, [f64; MOTIONS], [f64; MOTIONS])> =
            seen.windows(2).enumerate().filter_map(|(i, pair)| Some((i, pair[0]?, pair[1]?))).collect();
        if (steps.len() as f64) < LEAST_COVERED * (log.len() - 1) as f64 {
            return None;
        }
        let (mut left, mut unexplained) = (Vec::new(), Vec::new());
        for motion in 0..MOTIONS {
            let wheels = steps.iter().map(|(i, ..)| log[i + 1].by[motion] - log[*i].by[motion]);
            let camera = steps.iter().map(|(_, before, after)| after[motion] - before[motion]);
            let sum = |products: &mut dyn Iterator<Item = f64>| products.sum::<f64>();
            let both = sum(&mut wheels.clone().zip(camera.clone()).map(|(w, c)| w * c)).max(0.0);
            let (of_wheels, of_camera) =
                (sum(&mut wheels.clone().map(|w| w * w)), sum(&mut camera.clone().map(|c| c * c)));
            if of_wheels > 0.0 && of_camera > 0.0 {
                left.push(wheels.zip(camera).map(|(w, c)| c - both / of_wheels * w).collect());
                unexplained.push(1.0 - both * both / (of_wheels * of_camera));
            }
        }
        (!left.is_empty()).then_some(Misfit { left, unexplained, steps: steps.len() })
    }

    fn mean(&self) -> f64 {
        self.unexplained.iter().sum::<f64>() / self.unexplained.len() as f64
    }

    /// Negative log-likelihood of the residuals under a normal law of unknown scale, up to a constant.
    fn normal_negative_log_likelihood(&self) -> f64 {
        let logs: f64 = self.unexplained.iter().map(|share| libm::log(share.max(EXACT))).sum();
        0.5 * self.steps as f64 * logs
    }

    /// Negative log-likelihood of the residuals under a Student law scaled by their median, since wheels slip now and then.
    fn student_negative_log_likelihood(&self) -> f64 {
        let of_motion = |left: &Vec<f64>| {
            let width = median(left.iter().map(|v| v.abs())).max(EXACT);
            let law =
                |v: &f64| (DEGREES_OF_FREEDOM + 1.0) / 2.0 * libm::log1p(v * v / (DEGREES_OF_FREEDOM * width * width));
            left.iter().map(|v| law(v) + libm::log(width)).sum::<f64>()
        };
        self.left.iter().map(of_motion).sum()
    }
}

/// Cumulative motion interpolated between two frames; `None` outside the track and in its gaps.
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

    /// A number in -1..1 from a counter.
    fn noise(n: u64) -> f64 {
        let mut x = n.wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0xD1B5_4A32_D192_ED03;
        x = (x ^ (x >> 31)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        x ^= x >> 29;
        (x >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Rates of motion held for 400 ms steps, integrated.
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
    fn offset_and_drift_are_found_within_fifteen_milliseconds() {
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
    fn nothing_is_aligned_without_overlap_or_motion() {
        let still = |n: u64, ms: f64| {
            (0..n).map(|k| CumulativeMotion { t_ms: ms * k as f64, by: [0.0; 2] }).collect::<Vec<_>>()
        };
        assert_eq!(align(&still(150, 400.0), &still(2_000, 33.0)), None);
        assert_eq!(align(&still(150, 400.0), &still(300, 33.0)), None);
        assert_eq!(align(&still(150, 400.0), &[]), None);
    }
}
