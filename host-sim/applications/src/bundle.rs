//! A bundle: logs without names and comments, the diagnosis of them and the versions of the programs, in one file to send when a
//! diagnosis seems wrong.

mod archive;
mod conditions;

use std::path::Path;

use schemars::JsonSchema;
use serde::Serialize;

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::schema_number::SchemaNumber;
use mindgap_logs::sessions::{CONDITIONS, Session};
use mindgap_logs::without_names::{numbered, texts};
use mindgap_logs::{Logs, Run, Scene};
use mindgap_models::simulator::Simulator;

/// The first file of a bundle, which says what it is.
pub const ABOUT: &str = "mindgap-bundle.json";
/// The answer in a bundle.
pub const DIAGNOSIS: &str = "diagnosis.json";
/// The simulator in a bundle.
pub const SIMULATOR: &str = "simulator.json";
/// The folder of logs in a bundle; of several the beginning of their names.
const LOGS: &str = "logs";

/// Logs without names, and their files.
pub struct Nameless {
    /// The sessions, with folders as they are in the bundle.
    pub sessions: Vec<Session>,
    /// The logs, with runs named as in the bundle.
    pub logs: Logs,
    texts: Vec<(String, String)>,
}

/// The versions of a bundle, and how to diagnose it again.
#[derive(Serialize, JsonSchema)]
pub struct About {
    /// Version of the JSON.
    schema: SchemaNumber<1>,
    /// Version of the program that made the diagnosis.
    mindgap: &'static str,
    /// Version of the program that trained the simulator; null for the textbook.
    trained_by: Option<String>,
    /// The command that gives the same diagnosis in the unpacked folder.
    command: String,
}

impl Nameless {
    /// Removes the names from logs that were read from the folders of these sessions.
    ///
    /// # Errors
    /// When a file cannot be read.
    pub fn of(sessions: &[Session], mut logs: Logs) -> Result<Self> {
        let folders: Vec<String> = match sessions {
            [_] => vec![LOGS.into()],
            several => (1..=several.len()).map(|number| format!("{LOGS}-{number}")).collect(),
        };
        let conditions = conditions::without_names(sessions.iter().map(|session| &session.conditions));
        let mut nameless = Vec::new();
        let mut all = Vec::new();
        let mut runs = logs.runs.as_mut_slice();
        for ((session, folder), conditions) in sessions.iter().zip(&folders).zip(conditions) {
            let count = if sessions.len() == 1 { runs.len() } else { runs_of(session, runs) };
            let (own, others) = std::mem::take(&mut runs).split_at_mut(count);
            runs = others;
            let mut files = texts(&session.folder, own)?;
            for (run, name) in own.iter_mut().zip(numbered(count)) {
                run.name = if sessions.len() == 1 { name } else { format!("{folder}/{name}") };
            }
            if sessions.len() > 1 && !conditions.is_empty() {
                let text = toml::to_string(&conditions).map_err(|e| Error::new(e.to_string()))?;
                files.push((CONDITIONS.into(), text));
            }
            all.extend(files.into_iter().map(|(name, text)| (format!("{folder}/{name}"), text)));
            nameless.push(Session { folder: folder.into(), conditions });
        }
        // The scene as its file has it: a number that is computed again may differ in its last digit.
        if let Some((name, text)) = all.iter().find(|(name, _)| name.ends_with("/scene.toml")) {
            logs.scene = Scene::parse(Path::new(name), text)?;
        }
        Ok(Nameless { sessions: nameless, logs, texts: all })
    }

    /// Returns the bytes of the bundle with a diagnosis in JSON.
    ///
    /// # Errors
    /// When something has no form in JSON.
    pub fn bundle(&self, simulator: Option<&Simulator>, diagnosis: String, options: &str) -> Result<Vec<u8>> {
        let name = if simulator.is_some() { SIMULATOR } else { "kinematic" };
        let folders: Vec<String> = self.sessions.iter().map(|session| session.folder.display().to_string()).collect();
        let about = About {
            schema: SchemaNumber,
            mindgap: env!("CARGO_PKG_VERSION"),
            trained_by: simulator.map(|simulator| simulator.origin.version.clone()),
            command: format!("mindgap diagnose {name} {}{options} --json again.json", folders.join(" ")),
        };
        let mut all = vec![(ABOUT.to_owned(), files::json(Path::new(ABOUT), &about)?), (DIAGNOSIS.into(), diagnosis)];
        if let Some(simulator) = simulator {
            all.push((SIMULATOR.into(), files::json(Path::new(SIMULATOR), simulator)?));
        }
        archive::zipped(all.iter().chain(&self.texts))
    }
}

/// Returns whether bytes are a bundle.
pub fn is_bundle(bytes: &[u8]) -> bool {
    archive::first_name(bytes) == Some(ABOUT.as_bytes())
}

/// Returns how many of the first runs are of a session.
fn runs_of(session: &Session, runs: &[Run]) -> usize {
    let prefix = session.prefix();
    runs.iter().take_while(|run| run.session() == prefix).count()
}
