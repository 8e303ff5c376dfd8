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
