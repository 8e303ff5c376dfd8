//! Conditioning: logs become observations, split into blocks on which effects are identified and blocks held out.

use mindgap_learning::evaluation::observations::Observations;
use mindgap_learning::evaluation::repeats::weighed;
use mindgap_logs::Logs;
use mindgap_models::effects::context::HISTORY;
use mindgap_models::simulator::baseline::Baseline;

/// One block in this many is held out: a quarter confirms within twice the error of the rest.
const EVERY: usize = 4;
/// With fewer runs than this none is held out, unless they are long: two confirm nothing that one does not.
const FEWEST_RUNS: usize = 8;
/// Parts of fewer runs stand for runs where they have this many rows: as many as a run that one drives in a minute.
const AS_A_RUN: usize = 100;
/// Effects are identified on this many rows at most. Strong evidence is a few nats, and an effect that a tenth of this does
/// not show moves no controller; what is beyond confirms.
const MOST_IDENTIFYING: usize = 3000;
/// And no more than this many rows confirm: a share is known to a hundredth then.
const MOST_CONFIRMING: usize = 6000;

/// Nobody steers a robot whose commands act later than this.
const LATEST_MS: f64 = 800.0;

/// Logs in two parts.
pub struct Conditioned {
    /// Blocks on which effects are sought and fitted.
    pub identification: Observations,
    /// Blocks that nothing is sought on; none of few.
    pub hold_out: Option<Observations>,
}

impl Conditioned {
    /// Holds every fourth block out, and more of what is plentiful.
    pub fn of(logs: &Logs, baseline: &Baseline) -> Self {
        let all = Observations::of(logs, baseline.sonar.as_ref()).recalling(baseline.familiar);
        let (rows, blocks) = (all.rows.len(), all.blocks);
        if logs.runs.len() < FEWEST_RUNS && rows < AS_A_RUN * blocks {
            return Conditioned { identification: weighed(all, baseline), hold_out: None };
        }
        let identifying = MOST_IDENTIFYING as f64 / rows as f64;
        let confirming = MOST_CONFIRMING as f64 / rows as f64;
        let usual = (EVERY - 1) as f64 / EVERY as f64;
        // Of what does not identify, as large a share as may confirm.
        let (confirming, mut others) = (confirming / (1.0 - identifying).max(0.0), 0);
        let role = |block| {
            if identifying >= usual {
                return Some(block % EVERY == EVERY - 1);
            }
            if is_among(block, identifying) {
                return Some(false);
            }
            others += 1;
            is_among(others - 1, confirming).then_some(true)
        };
        let roles: Vec<Option<bool>> = (0..blocks).map(role).collect();
        let [identification, hold_out] = all.split(&roles).map(|part| weighed(part, baseline));
        Conditioned { identification, hold_out: Some(hold_out) }
    }

    /// Asks the baseline once what it expects of every row on which effects are identified.
    pub fn expecting(self, baseline: &Baseline) -> Self {
        Conditioned { identification: self.identification.expect(baseline.motion.as_ref()), ..self }
    }

    /// What so few runs leave open, in words; none where they are enough.
    pub fn caveat(&self, runs: usize) -> Option<String> {
        let few = (2..FEWEST_RUNS).contains(&runs);
        few.then(|| match self.hold_out {
            None => {
                format!(
                    "With fewer than {FEWEST_RUNS} runs none is kept back: the gap shrinks on runs that were fitted."
                )
            }
            Some(_) => format!(
                "With fewer than {FEWEST_RUNS} runs none is kept back but parts of them: what holds for other runs can \
                 hardly be told."
            ),
        })
    }

    /// The blocks that confirm: those held out, or the others where none is.
    pub fn confirming(&self) -> &Observations {
        self.hold_out.as_ref().unwrap_or(&self.identification)
    }
}

/// The step in which rows are compared that come every `own_ms`, where no simulator sets it: the least multiple over which
/// the history of commands reaches as far back as the latest command can act.
pub fn step_ms(own_ms: f64) -> f64 {
    let least_ms = LATEST_MS / (HISTORY - 2) as f64;
    own_ms * (least_ms / own_ms).ceil().max(1.0)
}

/// Whether a number is among an even share of all numbers.
fn is_among(number: usize, share: f64) -> bool {
    let share = share.min(1.0);
    (((number + 1) as f64) * share).floor() > ((number as f64) * share).floor()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_support::{baseline, driven};

    /// The runs of the two parts, told apart by their left commands.
    fn parts(runs: usize) -> (Vec<usize>, Option<Vec<usize>>) {
        let mut logs = driven(runs, 4, |_, _| [50.0; 2]);
        for (run, logged) in logs.runs.iter_mut().enumerate() {
            logged.rows.edit_each(|row| row.left = run as f64);
        }
        let conditioned = Conditioned::of(&logs, &baseline());
        let runs = |part: &Observations| {
            let mut runs: Vec<usize> = part.rows.iter().map(|row| row.context.commands[0][0] as usize).collect();
            runs.dedup();
            runs
        };
        (runs(&conditioned.identification), conditioned.hold_out.as_ref().map(runs))
    }

    #[test]
    fn every_fourth_run_is_held_out() {
        assert_eq!(parts(9), (vec![0, 1, 2, 4, 5, 6, 8], Some(vec![3, 7])));
        assert_eq!(parts(8).1, Some(vec![3, 7]));
    }

    #[test]
    fn of_few_runs_none_is_held_out() {
        assert_eq!(parts(7), ((0..7).collect(), None));
    }

    #[test]
    fn what_few_runs_leave_open_is_told() {
        let told = |runs, rows| Conditioned::of(&driven(runs, rows, |_, _| [50.0; 2]), &baseline()).caveat(runs);
        assert!(told(7, 4).is_some_and(|told| told.ends_with("that were fitted.")));
        assert!(told(5, 801).is_some_and(|told| told.contains("but parts of them")));
        assert_eq!([told(8, 4), told(1, 1601)], [None, None]);
    }

    #[test]
    fn long_runs_are_split_into_parts() {
        let conditioned = Conditioned::of(&driven(1, 1601, |_, _| [50.0; 2]), &baseline());
        let hold_out = conditioned.hold_out.as_ref().expect("a long run");
        assert_eq!(conditioned.identification.blocks + hold_out.blocks, 10);
        let first = |rows: &Observations| rows.rows.iter().map(|row| row.at).min();
        assert_eq!((first(&conditioned.identification), first(hold_out)), (Some(0), Some(481)));
    }

    /// Of 400 runs of 31 rows, 12,400 in all, 3,000 rows identify and 6,000 confirm.
    #[test]
    fn of_many_runs_a_part_identifies_and_a_part_confirms() {
        let conditioned = Conditioned::of(&driven(400, 31, |_, _| [50.0; 2]), &baseline());
        let hold_out = conditioned.hold_out.as_ref().expect("many runs");
        let rows = [conditioned.identification.rows.len(), hold_out.rows.len()];
        assert!((2900..=3000).contains(&rows[0]) && (5800..=6100).contains(&rows[1]), "{rows:?}");
        assert!(hold_out.rows.iter().all(|row| row.block < hold_out.blocks));
    }

    /// Of ten runs of 4,000 rows a part of each identifies.
    #[test]
    fn of_many_long_runs_parts_identify() {
        let conditioned = Conditioned::of(&driven(10, 4001, |_, _| [50.0; 2]), &baseline());
        let rows = &conditioned.identification.rows;
        let runs: std::collections::BTreeSet<usize> = rows.iter().map(|row| row.run).collect();
        assert!((2500..=3000).contains(&rows.len()) && runs.len() == 10, "{} of {runs:?}", rows.len());
    }

    #[test]
    fn what_confirms_is_what_is_held_out_or_else_all() {
        let count = |runs| {
            let conditioned = Conditioned::of(&driven(runs, 4, |_, _| [50.0; 2]), &baseline());
            (conditioned.identification.rows.len(), conditioned.confirming().rows.len())
        };
        assert_eq!((count(8), count(2)), ((24, 8), (8, 8)));
    }

    #[test]
    fn what_the_baseline_expects_is_asked_once() {
        let logs = driven(2, 4, |_, _| [50.0; 2]);
        let rows = Conditioned::of(&logs, &baseline()).expecting(&baseline()).identification.rows;
        let drive = baseline().motion.expect("a drive");
        assert!(rows.iter().all(|row| row.expected == Some(drive.step([50.0; 2], [0.0; 2]))));
    }
}
