//! Which runs an effect is found on and which confirm it: how far a gap shrinks is judged on runs never used before.

use crate::logs::Logs;

/// One run in so many is kept back.
const EVERY: usize = 4;
/// With fewer runs than this none is kept back.
pub const FEWEST_RUNS: usize = 8;

/// Logs in two parts.
pub struct Parts {
    /// Runs on which effects are sought and fitted.
    pub found_on: Logs,
    /// Runs that nothing was sought on; none of few.
    pub kept_back: Option<Logs>,
}

/// Keeps every fourth run back.
pub fn parts(logs: &Logs) -> Parts {
    if logs.runs.len() < FEWEST_RUNS {
        return Parts { found_on: logs.clone(), kept_back: None };
    }
    let is_kept_back = |run: usize| run % EVERY == EVERY - 1;
    let part = |kept_back: bool| {
        let runs = logs.runs.iter().enumerate().filter(|(i, _)| is_kept_back(*i) == kept_back);
        Logs { robot: logs.robot, scene: logs.scene.clone(), runs: runs.map(|(_, run)| run.clone()).collect() }
    };
    Parts { found_on: part(false), kept_back: Some(part(true)) }
}
