//! The description of a folder, `metadata.yaml`.

use std::path::Path;

use serde::Deserialize;

use mindgap_foundations::error::{Error, Result};

/// The description, as far as it is needed.
#[derive(Deserialize)]
struct Metadata {
    rosbag2_bagfile_information: Information,
}

#[derive(Deserialize)]
struct Information {
    #[serde(default)]
    relative_file_paths: Vec<String>,
}

/// Returns the parts that a description lists.
///
/// # Errors
/// When it cannot be read.
pub fn listed(description: &Path) -> Result<Vec<String>> {
    let text = mindgap_files::read_text(description)?;
    let metadata: Metadata = serde_saphyr::from_str(&text).map_err(|e| {
        let why = e.to_string();
        let first = why.lines().next().unwrap_or_default();
        Error::in_file(description, format!("is not the description of a bag: {first}"))
    })?;
    Ok(metadata.rosbag2_bagfile_information.relative_file_paths)
}
