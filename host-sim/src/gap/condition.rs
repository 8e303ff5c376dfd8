//! Conditioning: logs become observations, split into runs on which effects are identified and runs held out.

use crate::evaluation::observations::Observations;
use crate::logs::Logs;
use crate::simulator::baseline::Baseline;

/// One run in this many is held out: a quarter confirms within twice the error of the rest.
const EVERY: usize = 4;
/// With fewer runs than this none is held out: two confirm nothing that one does not.
pub const FEWEST_RUNS: usize = 8;

/// Logs in two parts.
pub struct Conditioned {
    /// Runs on which effects are sought and fitted.
    pub identification: Observations,
    /// Runs that nothing is sought on; none of few.
    pub hold_out: Option<Observations>,
}

impl Conditioned {
    /// Holds every fourth run out.
    pub fn of(logs: &Logs, baseline: &Baseline) -> Self {
        let fan_width = baseline.sonar.as_ref().map_or(1.0, |sonar| sonar.fan_width);
        let part = |held_out: bool| Observations::of(&runs(logs, held_out), fan_width);
        if logs.runs.len() < FEWEST_RUNS {
            return Conditioned { identification: Observations::of(logs, fan_width), hold_out: None };
        }
        Conditioned { identification: part(false), hold_out: Some(part(true)) }
    }

    /// Asks the baseline once what it expects of every row on which effects are identified.
    pub fn expecting(self, baseline: &Baseline) -> Self {
        Conditioned { identification: self.identification.expect(baseline.motion.as_ref()), ..self }
    }

    /// The runs that confirm: those held out, or the others where none is.
    pub fn confirming(&self) -> &Observations {
        self.hold_out.as_ref().unwrap_or(&self.identification)
    }
}

fn runs(logs: &Logs, held_out: bool) -> Logs {
    let runs = logs.runs.iter().enumerate().filter(|(i, _)| (i % EVERY == EVERY - 1) == held_out);
    Logs { robot: logs.robot, scene: logs.scene.clone(), runs: runs.map(|(_, run)| run.clone()).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::test_support::{baseline, driven};

    /// The runs of the two parts, told apart by their left commands.
    fn parts(runs: usize) -> (Vec<usize>, Option<Vec<usize>>) {
        let mut logs = driven(runs, 4, |_, _| [50.0; 2]);
        for (run, logged) in logs.runs.iter_mut().enumerate() {
            logged.rows.iter_mut().for_each(|row| row.left = run as f64);
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
