//! The files of a bag: a single file, or the folder that `ros2 bag record` writes, with the parts of one drive.

#[cfg(not(target_family = "wasm"))]
mod description;

use std::path::{Path, PathBuf};

use mindgap_files::{source, unreadable};
use mindgap_foundations::error::{Error, Result};

/// Name of the file that describes a folder.
const METADATA: &str = "metadata.yaml";
/// Endings of the parts of a bag.
const ENDINGS: [&str; 4] = [".mcap", ".db3", ".mcap.zstd", ".db3.zstd"];

/// Returns the files of the bag at `path`, in the order of recording.
///
/// # Errors
/// When a folder holds no bag, or not all parts that it lists.
pub fn of(path: &Path) -> Result<Vec<PathBuf>> {
    if !source::is_folder(path) {
        return Ok(vec![path.into()]);
    }
    let description = path.join(METADATA);
    // A browser reads the parts by number, which is the same unless they were renamed.
    #[cfg(target_family = "wasm")]
    let listed: Vec<String> = Vec::new();
    #[cfg(not(target_family = "wasm"))]
    let listed = if source::exists(&description) { description::listed(&description)? } else { Vec::new() };
    if listed.is_empty() {
        return found(path);
    }
    // Older recorders list paths from where they were started.
    let within = |name: &String| {
        let file = Path::new(name).file_name().map(|name| path.join(name));
        [path.join(name)].into_iter().chain(file).find(|file| source::is_file(file))
    };
    let missing = listed.iter().find(|name| within(name).is_none());
    match missing {
        Some(name) => Err(Error::in_file(&description, format!("lists {name}, which is not in the folder"))),
        None => Ok(listed.iter().filter_map(within).collect()),
    }
}

/// Returns whether a folder holds a bag, and is no folder of logs.
pub fn is_bag_folder(path: &Path) -> bool {
    !source::exists(&path.join("robot.toml")) && (source::is_file(&path.join(METADATA)) || found(path).is_ok())
}

/// Returns the path without the number and endings of a part: parts of one bag differ in these alone.
pub fn stem(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = name.split('.').next().unwrap_or_default();
    path.with_file_name(stem.trim_end_matches(|c: char| c.is_ascii_digit()))
}

/// Returns the parts of a folder without description, as a recorder that was killed leaves it, by number.
fn found(folder: &Path) -> Result<Vec<PathBuf>> {
    let names = source::names(folder).map_err(|e| unreadable(folder, &e))?;
    let mut parts: Vec<String> =
        names.into_iter().filter(|name| ENDINGS.iter().any(|ending| name.ends_with(ending))).collect();
    parts.sort_by_key(|name| (number(name), name.clone()));
    if parts.is_empty() {
        return Err(Error::in_file(folder, format!("holds no bag: neither {METADATA} nor {}", ENDINGS.join(", "))));
    }
    Ok(parts.iter().map(|name| folder.join(name)).collect())
}

/// Returns the number at the end of a part's name.
fn number(name: &str) -> u64 {
    let stem = name.split('.').next().unwrap_or_default();
    let digits = stem.rfind(|c: char| !c.is_ascii_digit()).map_or(stem, |at| &stem[at + 1..]);
    digits.parse().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn parts(files: &[(&str, &str)]) -> Result<Vec<String>> {
        let folder = tempfile::tempdir().expect("a folder");
        files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).expect("written"));
        let name = |path: PathBuf| path.file_name().map(|name| name.to_string_lossy().into_owned());
        of(folder.path()).map(|parts| parts.into_iter().filter_map(name).collect())
    }

    #[test]
    fn parts_come_in_the_order_of_the_description() {
        let text = "rosbag2_bagfile_information:\n  version: 9\n  relative_file_paths:\n    - second.mcap\n    - old/first.mcap\n";
        let read = parts(&[(METADATA, text), ("first.mcap", ""), ("second.mcap", ""), ("else.mcap", "")]);
        assert_eq!(read.expect("parts"), ["second.mcap", "first.mcap"]);
        let refused = parts(&[(METADATA, text), ("second.mcap", "")]).expect_err("incomplete").to_string();
        assert!(refused.contains("lists old/first.mcap, which is not in the folder"), "{refused}");
        let refused = parts(&[(METADATA, "- 1\n- 2\n")]).expect_err("other YAML").to_string();
        assert!(refused.contains("is not the description of a bag") && refused.lines().count() == 1, "{refused}");
    }

    #[test]
    fn parts_without_description_come_by_number() {
        let read = parts(&[("a_10.mcap", ""), ("a_2.mcap", ""), ("a_0.mcap.zstd", ""), ("notes.txt", "")]);
        assert_eq!(read.expect("parts"), ["a_0.mcap.zstd", "a_2.mcap", "a_10.mcap"]);
        assert!(parts(&[("notes.txt", "")]).expect_err("no bag").to_string().contains("holds no bag"));
    }
}
