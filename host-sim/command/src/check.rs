//! `mindgap check`

use std::path::PathBuf;

use clap::Args;

use super::json_output::JsonOption;
use super::{Run, kinds};
use mindgap_diagnosis::survey::Survey;
use mindgap_files::places::Places;
use mindgap_foundations::error::Result;
use mindgap_foundations::executor::Executor;
use mindgap_pages::text;

/// Check logs: what they contain, what is wrong with them, which effects they can identify, and what to drive next.
#[derive(Args)]
pub struct Check {
    /// Folder with robot.toml, scene.toml and run-*.csv.
    logs: PathBuf,
    #[command(flatten)]
    json: JsonOption,
}

impl Run for Check {
    fn places(&self) -> Places {
        Places::default().reading([&self.logs]).writing(self.json.path(), kinds::REPORT)
    }

    fn run(&self, _: &dyn Executor) -> Result<String> {
        let survey = Survey::of(super::read_logs(&self.logs)?);
        self.json.emit(&survey, text::survey(&survey))
    }
}
