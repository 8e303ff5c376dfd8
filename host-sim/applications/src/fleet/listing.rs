//! The robots of a fleet: the folders in a folder.

use std::fs;
use std::path::Path;

use mindgap_foundations::error::{Error, Result};

/// The robots of a fleet, sorted by the names of their folders.
#[derive(Debug, Default, PartialEq)]
pub struct Listing {
    /// Names of the robots.
    pub names: Vec<String>,
    /// Files that belong to no robot.
    pub left_out: Vec<String>,
}

impl Listing {
    /// Lists the robots in a folder, which contains one folder of logs per robot.
    ///
    /// # Errors
    /// If the folder cannot be read or contains no folder.
    pub fn of(folder: &Path) -> Result<Self> {
        let failed = |e: std::io::Error| Error::in_file(folder, format!("cannot be read: {e}"));
        let mut listing = Listing::default();
        for entry in fs::read_dir(folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            match entry.file_name().into_string() {
                Ok(name) if name.starts_with('.') => (),
                // Follows symbolic links.
                Ok(name) if entry.path().is_dir() => listing.names.push(name),
                Ok(name) => listing.left_out.push(name),
                Err(name) => listing.left_out.push(name.to_string_lossy().into_owned()),
            }
        }
        if listing.names.is_empty() {
            return Err(Error::in_file(
                folder,
                "contains no folder: a fleet is a folder with one folder of logs per robot",
            ));
        }
        listing.names.sort();
        listing.left_out.sort();
        Ok(listing)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_robots_and_files_are_left_out() {
        let place = tempfile::tempdir().expect("a temporary folder");
        assert!(Listing::of(place.path()).unwrap_err().to_string().contains("contains no folder"));
        for name in ["b", "a", ".git"] {
            fs::create_dir(place.path().join(name)).expect("a folder");
        }
        fs::write(place.path().join("notes.txt"), "").expect("a file");
        let expected = Listing { names: vec!["a".into(), "b".into()], left_out: vec!["notes.txt".into()] };
        assert_eq!(Listing::of(place.path()).unwrap(), expected);
    }
}
