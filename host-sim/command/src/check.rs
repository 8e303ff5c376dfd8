//! `mindgap check`

use std::path::{Path, PathBuf};

use clap::Args;

use super::json_output::JsonOption;
use super::{Run, kinds};
use mindgap_diagnosis::survey::Survey;
use mindgap_files as files;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_logs::Logs;
use mindgap_pages::logs::{Subject, page};
use mindgap_pages::text;

/// Check logs: what they contain, what is wrong with them, which effects they can identify, and what to drive next.
#[derive(Args)]
pub struct Check {
    /// Folder with robot.toml, scene.toml and run-*.csv.
    logs: PathBuf,
    #[command(flatten)]
    json: JsonOption,
    /// Write an HTML page: paths, commands and speeds, readings, where the defects are, and what the logs can identify.
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,
}

impl Run for Check {
    fn places(&self) -> Places {
        let places = Places::default().reading([&self.logs]).writing(self.json.path(), kinds::REPORT);
        places.writing(&self.html, kinds::PAGE)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let mut notes = Vec::new();
        let logs = super::read_logs_noting(&self.logs, |note| notes.push(note))?;
        let survey = match &self.html {
            Some(path) => {
                let (survey, page) = surveyed(logs, &self.logs, &notes);
                files::write(path, page)?;
                survey
            }
            None => Survey::of(logs),
        };
        self.json.emit(&survey, text::survey(&survey))
    }
}

/// Surveys logs and returns their page too; `notes` are what was noticed when they were read.
pub fn surveyed(logs: Logs, folder: &Path, notes: &[String]) -> (Survey, String) {
    let (survey, corrected) = Survey::with_logs(logs.clone());
    let folder = folder.display().to_string();
    let page = page(&Subject { survey: &survey, logged: &logs, corrected: &corrected, folder: &folder, notes });
    (survey, page)
}
