//! `mindgap monitor`

use std::path::PathBuf;

use clap::Args;

use super::json_output::JsonOption;
use super::{Run, kinds, table, textbook};
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_models::simulator::monitor::findings::{AlarmFound, Findings};
use mindgap_models::simulator::monitor::replay::Replay;

/// Replay logs through the onboard monitor to see whether the robot still matches its simulator.
///
/// The monitor is that of `mindgap export SIM --format c --monitor`, and so is every bit of its evidence.
#[derive(Args)]
pub struct Monitor {
    /// The simulator file.
    sim: PathBuf,
    /// Folder of logs, whose runs are replayed one after the other.
    logs: PathBuf,
    #[command(flatten)]
    json: JsonOption,
}

/// Number of alternatives that are printed.
const PRINTED: usize = 5;

impl Run for Monitor {
    fn places(&self) -> Places {
        Places::default().reading([&self.sim, &self.logs]).writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let simulator = textbook::simulator(&self.sim)?;
        let replay = Replay::of(&simulator).map_err(|error| error.or_in_file(&self.sim))?;
        let logs = super::read_logs_of(&simulator, &self.logs)?;
        let findings = Findings::of(&replay, &logs);
        self.json.emit(&findings, describe(&findings))
    }
}

fn describe(findings: &Findings) -> String {
    let Findings { steps, paused, threshold_nats, evidence, alarm, .. } = findings;
    let first = match alarm {
        None => "No alarm: the robot matches its simulator.\n".to_owned(),
        Some(AlarmFound { what, size, unit, began, raised, .. }) => {
            let size = size.zip(*unit).map_or(String::new(), |(size, unit)| format!(", about {size:.3} ({unit})"));
            format!(
                "Alarm: {what}{size}.\nIt began in {} at {} ms; the alarm came in {} at {} ms.\n",
                began.run, began.t_ms, raised.run, raised.t_ms
            )
        }
    };
    let rows = evidence.iter().take(PRINTED).map(|e| {
        let size = e.size.map_or(String::new(), |size| format!("{size:.3}"));
        [e.what.clone(), size, format!("{:.1}", e.nats)]
    });
    let rows: Vec<[String; 3]> = rows.collect();
    let counts =
        format!("{steps} steps, {paused} of them without evidence; the threshold is {threshold_nats:.1} nats.\n");
    first + &counts + "\n" + &table::text(["evidence after the last step", "size", "nats"], &rows)
}
