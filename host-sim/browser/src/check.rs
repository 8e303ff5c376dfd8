//! `mindgap check`

use std::path::Path;

use mindgap_diagnosis::survey::Survey;
use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_pages::text;

use crate::drive::Drives;
use crate::report::{Answer, Reporter, read_logs};

/// Checks a folder of logs.
///
/// # Errors
/// When it cannot be read.
pub fn answer(folder: &Path, report: Reporter) -> Result<Answer> {
    let logs = read_logs(folder, report)?;
    let drives = Some(Drives::of(&logs));
    let survey = Survey::of(logs);
    Ok(Answer { text: text::survey(&survey), json: Some(files::json(folder, &survey)?), drives, ..Answer::default() })
}
