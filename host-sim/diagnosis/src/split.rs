//! Splitting logs into identification rows and held-out rows.

use super::sample::{HoldOut, Identification, RowSet};
use mindgap_learning::evaluation::observations::Observations;
use mindgap_learning::evaluation::repeats::weighted;
use mindgap_logs::{Logs, Run};
use mindgap_models::effects::context::HISTORY;
use mindgap_models::simulator::baseline::Baseline;

/// One block in this many is held out: a quarter of the rows confirms a gain within twice the error of the others.
const EVERY: usize = 4;
/// With fewer runs than this none is held out unless they are long.
pub const FEWEST_RUNS: usize = 8;
/// Parts of fewer runs replace runs if they have this many rows: about one minute of driving.
const AS_A_RUN: usize = 100;
/// Maximum number of identification rows. Strong evidence is a few nats, and an effect that a tenth of these rows do not show is
/// too weak to matter to a controller; further rows are held out.
const MOST_IDENTIFICATION_ROWS: usize = 3000;
/// Maximum number of held-out rows: enough to know a share to one hundredth.
const MOST_HELD_OUT_ROWS: usize = 6000;

/// Largest plausible command latency, ms.
const LONGEST_LATENCY_MS: f64 = 800.0;

/// Returns whether a block is held out, where there are enough of them and not too many rows.
pub fn is_held_out(block: usize) -> bool {
    block % EVERY == EVERY - 1
}

/// The rows of logs in two parts.
pub struct Parts {
    /// Rows of blocks to which effects are fitted.
    pub identification: Observations,
    /// Rows of the other blocks, if there are enough.
    pub hold_out: Option<Observations>,
}

/// The same with the simulator that they are compared with.
pub struct Split<'a> {
    /// Rows to which effects are fitted.
    pub identification: Identification<'a>,
    /// Rows that confirm them.
    pub hold_out: Option<HoldOut<'a>>,
}

impl Parts {
    /// Holds out every fourth session where there are four, otherwise every fourth block, and more if there are many rows.
    pub fn of(logs: &Logs, baseline: &Baseline) -> Self {
        let all = Observations::of(logs, baseline.motion.as_ref(), baseline.sonar.as_ref());
        let all = all.recalling(baseline.familiar);
        if let Some(roles) = roles_by_session(logs, &all) {
            let [identification, hold_out] = all.split(&roles).map(|part| weighted(part, baseline));
            return Parts { identification, hold_out: Some(hold_out) };
        }
        let (rows, blocks) = (all.rows.len(), all.blocks);
        if logs.runs.len() < FEWEST_RUNS && rows < AS_A_RUN * blocks {
            return Parts { identification: weighted(all, baseline), hold_out: None };
        }
        let identifying = MOST_IDENTIFICATION_ROWS as f64 / rows as f64;
        let held_out = MOST_HELD_OUT_ROWS as f64 / rows as f64;
        let usual = (EVERY - 1) as f64 / EVERY as f64;
        // As a fraction of the blocks that do not identify.
        let (held_out, mut others) = (held_out / (1.0 - identifying).max(0.0), 0);
        let role = |block| {
            if identifying >= usual {
                return Some(is_held_out(block));
            }
            if is_among(block, identifying) {
                return Some(false);
            }
            others += 1;
            is_among(others - 1, held_out).then_some(true)
        };
        let roles: Vec<Option<bool>> = (0..blocks).map(role).collect();
        let [identification, hold_out] = all.split(&roles).map(|part| weighted(part, baseline));
        Parts { identification, hold_out: Some(hold_out) }
    }

    /// Joins the rows with the simulator that they are compared with.
    pub fn against<'a>(self, baseline: &'a Baseline<'a>) -> Split<'a> {
        Split {
            identification: Identification::new(baseline, self.identification),
            hold_out: self.hold_out.map(|rows| HoldOut::new(baseline, rows)),
        }
    }

    /// Returns a note about what few runs leave open, if there are few.
    pub fn caveat(&self, runs: usize) -> Option<String> {
        let are_few = (2..FEWEST_RUNS).contains(&runs);
        are_few.then(|| match self.hold_out {
            None => format!(
                "With fewer than {FEWEST_RUNS} runs none is held out: the gap reduction is that of runs that were fitted."
            ),
            Some(_) => format!(
                "With fewer than {FEWEST_RUNS} runs only parts of them are held out: whether the result holds for other runs \
                 remains open."
            ),
        })
    }
}

impl<'a> Split<'a> {
    /// Returns the rows that confirm: the held-out rows, or the identification rows if none are held out.
    pub fn confirming(&'a self) -> RowSet<'a> {
        self.hold_out.as_ref().map_or(RowSet::Fitted(&self.identification), RowSet::HeldOut)
    }
}

/// Returns the step in which logs of `own_ms` steps are compared if no simulator sets it: the least multiple with which the
/// history of commands reaches back over the longest latency.
pub fn step_ms(own_ms: f64) -> f64 {
    let least_ms = LONGEST_LATENCY_MS / (HISTORY - 2) as f64;
    own_ms * (least_ms / own_ms).ceil().max(1.0)
}

/// Returns the role of every block where every fourth session is held out, or `None` if there are too few sessions for it. Of too
/// many rows, evenly spaced blocks are used.
fn roles_by_session(logs: &Logs, all: &Observations) -> Option<Vec<Option<bool>>> {
    let mut sessions: Vec<&str> = logs.runs.iter().map(Run::session).collect();
    sessions.dedup();
    if sessions.len() < EVERY {
        return None;
    }
    let session = |run: usize| sessions.iter().position(|session| *session == logs.runs[run].session());
    let mut held_out = vec![None; all.blocks];
    let mut rows = [0; 2];
    for row in &all.rows {
        let is_held_out = session(row.run).is_some_and(is_held_out);
        held_out[row.block] = Some(is_held_out);
        rows[usize::from(is_held_out)] += 1;
    }
    let used = [MOST_IDENTIFICATION_ROWS, MOST_HELD_OUT_ROWS].map(|most| most as f64);
    let mut seen = [0; 2];
    let role = |held_out: &Option<bool>| {
        let part = usize::from((*held_out)?);
        seen[part] += 1;
        is_among(seen[part] - 1, used[part] / rows[part] as f64).then_some(part == 1)
    };
    // Nothing is held out if a session that would be has no tracked row.
    (rows[0] > 0 && rows[1] > 0).then(|| held_out.iter().map(role).collect())
}

/// Returns whether a number belongs to an evenly spaced fraction of all numbers.
fn is_among(number: usize, fraction: f64) -> bool {
    let fraction = fraction.min(1.0);
    (((number + 1) as f64) * fraction).floor() > ((number as f64) * fraction).floor()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{baseline, driven};

    fn parts_of(runs: usize, rows: usize) -> Parts {
        Parts::of(&driven(runs, rows, |_, _| [50.0; 2]), &baseline())
    }

    /// Returns the runs of the two parts, which are recognised by their left commands.
    fn runs_of_parts(runs: usize) -> (Vec<usize>, Option<Vec<usize>>) {
        let mut logs = driven(runs, 4, |_, _| [50.0; 2]);
        for (run, logged) in logs.runs.iter_mut().enumerate() {
            logged.rows.edit_each(|row| row.left = run as f64);
        }
        let parts = Parts::of(&logs, &baseline());
        let runs = |part: &Observations| {
            let mut runs: Vec<usize> = part.rows.iter().map(|row| row.context.commands[0][0] as usize).collect();
            runs.dedup();
            runs
        };
        (runs(&parts.identification), parts.hold_out.as_ref().map(runs))
    }

    #[test]
    fn every_fourth_run_is_held_out() {
        assert_eq!(runs_of_parts(9), (vec![0, 1, 2, 4, 5, 6, 8], Some(vec![3, 7])));
        assert_eq!(runs_of_parts(8).1, Some(vec![3, 7]));
    }

    /// Of five sessions the fourth is held out as a whole; three are too few for it.
    #[test]
    fn every_fourth_session_is_held_out() {
        let sessions_of_parts = |sessions: usize| {
            let mut logs = driven(3 * sessions, 40, |_, _| [50.0; 2]);
            for (run, logged) in logs.runs.iter_mut().enumerate() {
                logged.name = format!("day-{}/{}", run / 3, logged.name);
                logged.rows.edit_each(|row| row.left = (run / 3) as f64);
            }
            let Parts { identification, hold_out } = Parts::of(&logs, &baseline());
            [Some(identification), hold_out].map(|part| {
                let rows = part.map_or_else(Vec::new, |part| part.rows);
                let mut sessions: Vec<usize> = rows.iter().map(|row| row.context.commands[0][0] as usize).collect();
                sessions.dedup();
                sessions
            })
        };
        assert_eq!(sessions_of_parts(5), [vec![0, 1, 2, 4], vec![3]]);
        assert_eq!(sessions_of_parts(3), [vec![0, 1, 2], vec![1, 2]], "by runs");
    }

    #[test]
    fn few_runs_are_all_fitted() {
        assert_eq!(runs_of_parts(7), ((0..7).collect(), None));
    }

    #[test]
    fn few_runs_have_a_caveat() {
        let caveat = |runs, rows| parts_of(runs, rows).caveat(runs);
        assert!(caveat(7, 4).is_some_and(|note| note.ends_with("that were fitted.")));
        assert!(caveat(5, 801).is_some_and(|note| note.contains("only parts of them")));
        assert_eq!([caveat(8, 4), caveat(1, 1601)], [None, None]);
    }

    #[test]
    fn long_runs_are_split_into_parts() {
        let Parts { identification, hold_out } = parts_of(1, 1601);
        let hold_out = hold_out.expect("a long run");
        assert_eq!(identification.blocks + hold_out.blocks, 10);
        let first = |rows: &Observations| rows.rows.iter().map(|row| row.at).min();
        assert_eq!((first(&identification), first(&hold_out)), (Some(0), Some(481)));
    }

    /// Of 400 runs of 31 rows, 12,400 in all, 3,000 rows identify and 6,000 are held out.
    #[test]
    fn many_runs_are_used_in_part() {
        let Parts { identification, hold_out } = parts_of(400, 31);
        let hold_out = hold_out.expect("many runs");
        let rows = [identification.rows.len(), hold_out.rows.len()];
        assert!((2900..=3000).contains(&rows[0]) && (5800..=6100).contains(&rows[1]), "{rows:?}");
        assert!(hold_out.rows.iter().all(|row| row.block < hold_out.blocks));
    }

    #[test]
    fn parts_of_all_long_runs_identify() {
        let rows = parts_of(10, 4001).identification.rows;
        let runs: std::collections::BTreeSet<usize> = rows.iter().map(|row| row.run).collect();
        assert!((2500..=3000).contains(&rows.len()) && runs.len() == 10, "{} of {runs:?}", rows.len());
    }

    #[test]
    fn identification_rows_confirm_if_none_are_held_out() {
        let count = |runs| {
            let baseline = baseline();
            let split = parts_of(runs, 4).against(&baseline);
            (split.identification.rows.len(), split.confirming().sample().rows.len())
        };
        assert_eq!((count(8), count(2)), ((24, 8), (8, 8)));
    }

    #[test]
    fn rows_know_what_the_simulator_expects() {
        let drive = baseline().motion.expect("a drive");
        assert!(
            parts_of(8, 4)
                .identification
                .rows
                .iter()
                .all(|row| { row.expected == Some(drive.step([50.0; 2], row.context.commands[1])) })
        );
    }
}
