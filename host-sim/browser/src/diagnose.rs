//! `mindgap diagnose`

use std::path::{Path, PathBuf};

use mindgap_diagnosis::Method;
use mindgap_diagnosis::between_sessions;
use mindgap_diagnosis::progress::Stage;
use mindgap_diagnosis::request::Request;
use mindgap_files as files;
use mindgap_foundations::error::Result;
use mindgap_logs::sessions;
use mindgap_models::simulator::{Simulator, textbook};
use mindgap_pages::diagnosis::comparison::Comparison;
use mindgap_pages::diagnosis::{Source, Subject, page};
use mindgap_pages::text;

use crate::report::{Answer, Report, Reporter, read_logs};

/// Diagnoses the gap between a simulator, or the textbook, and logs.
///
/// # Errors
/// When files cannot be read, or do not belong together.
pub fn answer(simulator: Option<&Path>, folders: &[PathBuf], report: Reporter) -> Result<Answer> {
    let name = simulator.map_or(textbook::NAME.into(), |path| path.display().to_string());
    let simulator = simulator.map(Simulator::read).transpose()?;
    let request = Request { simulator: simulator.as_ref(), controller: None, method: Method::default(), step_ms: None };
    let (sessions, logs) = sessions::read_all(folders, |folder| read_logs(folder, report))?;
    let watch = |stage: Stage| report(Report::Progress(stage.share_before(), stage.words().into()));
    let mut answered = request.of(logs, watch)?;
    between_sessions::compare(&request, &mut answered, &sessions)?;
    let diagnosis = &answered.findings.diagnosis;
    let names: Vec<String> = folders.iter().map(|folder| folder.display().to_string()).collect();
    let source = Source {
        simulator: name,
        logs: names.join(", "),
        written: files::days_written(folders)?,
        seed: request.method.seed,
    };
    let page = page(&Subject {
        findings: &answered.findings,
        logs: &answered.logs,
        baseline: &request.baseline(&answered.logs)?,
        catalogue: request.method.catalogue,
        source,
        comparison: Comparison::default(),
    })?;
    let json = files::json(Path::new("diagnosis.json"), diagnosis)?;
    Ok(Answer { text: text::diagnosis(diagnosis), json: Some(json), page: Some(page), ..Answer::default() })
}
