//! The robots of a fleet: the folders in a folder.

use std::fs;
use std::path::Path;

use mindgap_foundations::error::{Error, Result};

/// The robots of a fleet by the names of their folders, in order.
#[derive(Debug, Default, PartialEq)]
pub struct Listing {
    /// The robots.
    pub names: Vec<String>,
    /// Files beside them, which belong to no robot.
    pub left_out: Vec<String>,
}

impl Listing {
    /// Lists the robots whose logs lie in a folder, each in a folder of its own.
    ///
    /// # Errors
    /// When the folder cannot be read, or has no folder in it.
    pub fn of(folder: &Path) -> Result<Self> {
        let failed = |e: std::io::Error| Error::in_file(folder, format!("cannot be read: {e}"));
        let mut listing = Listing::default();
        for entry in fs::read_dir(folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            match entry.file_name().into_string() {
                Ok(name) if name.starts_with('.') => (),
                // Behind a link as well.
                Ok(name) if entry.path().is_dir() => listing.names.push(name),
                Ok(name) => listing.left_out.push(name),
                Err(name) => listing.left_out.push(name.to_string_lossy().into_owned()),
            }
        }
        if listing.names.is_empty() {
            return Err(Error::in_file(
                folder,
                "has no folder in it: a fleet is a folder with a folder of logs for each robot",
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
    fn listing_holds_folders_as_robots_and_files_as_left_out() {
        let place = tempfile::tempdir().expect("a temporary folder");
        assert!(Listing::of(place.path()).unwrap_err().to_string().contains("has no folder in it"));
        for name in ["b", "a", ".git"] {
            fs::create_dir(place.path().join(name)).expect("a folder");
        }
        fs::write(place.path().join("notes.txt"), "").expect("a file");
        let expected = Listing { names: vec!["a".into(), "b".into()], left_out: vec!["notes.txt".into()] };
        assert_eq!(Listing::of(place.path()).unwrap(), expected);
    }
}
