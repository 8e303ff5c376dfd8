//! Where the logs of a fleet lie: a folder with a folder for each robot, or the same in object storage.

use std::fs;
use std::path::{Path, PathBuf};

use super::listing::Listing;
#[cfg(feature = "cloud")]
use super::storage::Storage;
use mindgap_foundations::error::{Error, Result};

/// Where logs lie.
pub enum Source {
    /// On disk.
    Folder(PathBuf),
    /// In object storage.
    #[cfg(feature = "cloud")]
    Storage(Storage),
}

/// Whether a path is the address of a place in object storage, as `s3://robots/tonight`.
pub fn is_address(path: &Path) -> bool {
    path.to_str().is_some_and(|text| text.contains("://"))
}

impl Source {
    /// The place that a path names.
    ///
    /// # Errors
    /// When it is an address that this program cannot reach.
    pub fn of(path: &Path) -> Result<Self> {
        if !is_address(path) {
            return Ok(Source::Folder(path.to_owned()));
        }
        #[cfg(feature = "cloud")]
        return Storage::of(path).map(Source::Storage);
        #[cfg(not(feature = "cloud"))]
        Err(Error::in_file(path, "is an address, which needs a mindgap that was built with --features cloud"))
    }

    /// The robots.
    ///
    /// # Errors
    /// When the place cannot be read, or has no folder in it.
    pub fn listing(&self) -> Result<Listing> {
        let (place, mut listing) = match self {
            Source::Folder(folder) => (folder.as_path(), folders(folder)?),
            #[cfg(feature = "cloud")]
            Source::Storage(storage) => (storage.address(), storage.folders()?),
        };
        if listing.names.is_empty() {
            return Err(Error::in_file(
                place,
                "has no folder in it: a fleet is a folder with a folder of logs for each robot",
            ));
        }
        listing.names.sort();
        listing.left_out.sort();
        Ok(listing)
    }

    /// What comes of one robot's logs, which are given as a folder.
    ///
    /// # Errors
    /// When they cannot be fetched, or what `work` returns; messages name the place, not the folder.
    pub fn with_logs<T>(&self, name: &str, work: impl FnOnce(&Path) -> Result<T>) -> Result<T> {
        match self {
            Source::Folder(folder) => work(&folder.join(name)),
            #[cfg(feature = "cloud")]
            Source::Storage(storage) => storage.with_folder(name, work),
        }
    }
}

fn folders(folder: &Path) -> Result<Listing> {
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
    Ok(listing)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fleet_is_its_folders_and_what_else_is_there_is_told() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let source = Source::of(place.path()).expect("a folder");
        assert!(source.listing().unwrap_err().to_string().contains("has no folder in it"));
        for name in ["b", "a", ".git"] {
            fs::create_dir(place.path().join(name)).expect("a folder");
        }
        fs::write(place.path().join("notes.txt"), "").expect("a file");
        let expected = Listing { names: vec!["a".into(), "b".into()], left_out: vec!["notes.txt".into()] };
        assert_eq!(source.listing().unwrap(), expected);
    }
}
