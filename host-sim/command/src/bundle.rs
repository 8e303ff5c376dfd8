//! `mindgap bundle`

use std::path::{Path, PathBuf};

use clap::Args;

use super::diagnose::{DiagnoseResults, answered, positive};
use super::textbook::{not_a_recording, simulator_file, simulator_or_textbook};
use super::{Run, kinds};
use mindgap_applications::bundle::{DIAGNOSIS, Nameless};
use mindgap_diagnosis::Method;
use mindgap_diagnosis::between_sessions;
use mindgap_diagnosis::request::Request;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_logs::sessions;
use mindgap_pages::text;

/// Pack logs, their diagnosis and versions into one file, to send when a diagnosis seems wrong.
///
/// Names of folders and runs are replaced by numbers, and so are names and texts of conditions in session.toml. Comments, other files
/// and columns that mindgap does not read are left out. What remains: times, commands, poses, readings and all other numbers
/// that mindgap reads from the logs, the dimensions of robot and room, names of range sensors, and the simulator with any
/// effects of your own that were added to it. The diagnosis is that of `mindgap diagnose` with the same arguments.
#[derive(Args)]
pub struct Bundle {
    /// Simulator file, which is packed too; or `kinematic` for the textbook differential drive and an ideal sonar.
    #[arg(value_name = "SIM|kinematic", value_parser = not_a_recording)]
    sim: PathBuf,
    /// Folders of logs, each a session of one robot.
    #[arg(required = true)]
    logs: Vec<PathBuf>,
    /// The bundle, a ZIP archive.
    #[arg(long, value_name = "FILE.zip")]
    out: PathBuf,
    /// Random seed of the diagnosis.
    #[arg(long, value_name = "N", default_value_t = Method::SEED)]
    seed: u64,
    /// Step length of a comparison with `kinematic`, as for `mindgap diagnose`.
    #[arg(long, value_name = "MS", value_parser = positive)]
    step_ms: Option<f64>,
}

impl Run for Bundle {
    fn places(&self) -> Places {
        let inputs = simulator_file(&self.sim).into_iter().chain(&self.logs);
        Places::default().reading(inputs).writing([&self.out], kinds::BUNDLE)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let simulator = simulator_file(&self.sim).map(|path| simulator_or_textbook(path)).transpose()?;
        let (sessions, logs) = sessions::read_all(&self.logs, super::read_logs)?;
        let nameless = Nameless::of(&sessions, logs)?;
        let request = Request {
            simulator: simulator.as_ref(),
            controller: None,
            method: Method { seed: self.seed, ..Method::default() },
            step_ms: self.step_ms,
        };
        let mut answered = answered(&request, nameless.logs.clone())?;
        between_sessions::compare(&request, &mut answered, &nameless.sessions)?;
        let diagnosis = &answered.findings.diagnosis;
        let json = files::json(Path::new(DIAGNOSIS), &DiagnoseResults::of(diagnosis))?;
        files::write(&self.out, nameless.bundle(simulator.as_ref(), json, &self.options())?)?;
        Ok(format!(
            "{}{}: logs without names and comments, their diagnosis and versions. Positions and readings remain: look into it \
             before you send it.\n",
            text::diagnosis(diagnosis),
            self.out.display()
        ))
    }
}

impl Bundle {
    /// Returns the options with which the unpacked logs are diagnosed again.
    fn options(&self) -> String {
        let step = self.step_ms.map_or(String::new(), |ms| format!(" --step-ms {ms}"));
        format!(" --seed {}{step}", self.seed)
    }
}
