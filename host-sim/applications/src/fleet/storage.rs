//! Folders in object storage, by their addresses: `s3://`, `gs://`, `az://`, `https://`, and `file://`. Keys come from the
//! environment, by the names of each service's own tools.

use std::fs;
use std::future::Future;
use std::path::{Path, PathBuf};

use object_store::path::{Path as Key, PathPart};
use object_store::{ListResult, ObjectStore, ObjectStoreExt, PutPayload, parse_url_opts};
use tokio::runtime::{Builder, Runtime};
use url::Url;

use super::listing::Listing;
use mindgap_foundations::error::{Error, Result};

/// How the names of variables begin that hold keys and settings of a service.
const SERVICES: [&str; 3] = ["aws_", "google_", "azure_"];

/// A folder there.
pub struct Storage {
    address: PathBuf,
    store: Box<dyn ObjectStore>,
    folder: Key,
    runtime: Runtime,
}

impl Storage {
    /// The folder at an address.
    ///
    /// # Errors
    /// When it is none, or of a service that this program cannot reach.
    pub fn of(address: &Path) -> Result<Self> {
        let failed = |why: String| Error::in_file(address, why);
        let url = Url::parse(&address.to_string_lossy()).map_err(|e| failed(format!("is no address: {e}")))?;
        let is_of_a_service = |(name, _): &(String, String)| SERVICES.iter().any(|service| name.starts_with(service));
        let keys = std::env::vars_os()
            .filter_map(|(name, value)| {
                Some((name.into_string().ok()?.to_ascii_lowercase(), value.into_string().ok()?))
            })
            .filter(is_of_a_service);
        let (store, folder) = parse_url_opts(&url, keys).map_err(|e| failed(told(&e)))?;
        let runtime = Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|e| failed(format!("cannot be reached: {e}")))?;
        Ok(Storage { address: address.to_owned(), store, folder, runtime })
    }

    /// Its address.
    pub fn address(&self) -> &Path {
        &self.address
    }

    /// The folders in it.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn folders(&self) -> Result<Listing> {
        let ListResult { common_prefixes, objects, .. } = self.list(&self.folder)?;
        let name = |key: &Key| key.filename().map(String::from);
        Ok(Listing {
            names: common_prefixes.iter().filter_map(name).filter(|name| !name.starts_with('.')).collect(),
            left_out: objects.iter().filter_map(|object| name(&object.location)).collect(),
        })
    }

    /// What comes of one of its folders, fetched to disk for the time of the work.
    ///
    /// # Errors
    /// When it cannot be fetched, or what `work` returns; messages name the address.
    pub fn with_folder<T>(&self, name: &str, work: impl FnOnce(&Path) -> Result<T>) -> Result<T> {
        let here = tempfile::tempdir().map_err(|e| Error::new(format!("a temporary folder cannot be made: {e}")))?;
        // A name that was listed is written as keys are already.
        let name_as_listed = PathPart::parse(name).map_err(|e| Error::in_file(&self.address, e.to_string()))?;
        for object in self.list(&self.folder.clone().join(name_as_listed))?.objects {
            let Some(file) = object.location.filename() else { continue };
            let fetched = async { self.store.get(&object.location).await?.bytes().await };
            let bytes = self.wait(fetched)?;
            fs::write(here.path().join(file), bytes)
                .map_err(|e| Error::in_file(&self.address, format!("{file} cannot be kept on disk: {e}")))?;
        }
        let (on_disk, address) = (here.path().display().to_string(), self.address.join(name).display().to_string());
        work(here.path()).map_err(|error| Error::new(error.to_string().replace(&on_disk, &address)))
    }

    /// Checks that nothing is lost by writing here.
    ///
    /// # Errors
    /// When something is there, or the place cannot be read.
    pub fn expect_empty(&self) -> Result<()> {
        let ListResult { common_prefixes, objects, .. } = self.list(&self.folder)?;
        match common_prefixes.first().or(objects.first().map(|object| &object.location)) {
            None => Ok(()),
            Some(first) => {
                let name = first.filename().unwrap_or_default();
                Err(Error::in_file(&self.address, format!("holds {name:?} already: give an empty or new place")))
            }
        }
    }

    /// Puts a folder's files here, and those of the folders in it; the file of the name `last` after all others.
    ///
    /// # Errors
    /// When one cannot be read or put.
    pub fn put_folder(&self, from: &Path, last: &str) -> Result<()> {
        let mut files = Vec::new();
        collect(from, &self.folder, &mut files).map_err(|e| Error::in_file(from, format!("cannot be read: {e}")))?;
        files.sort_by_key(|(key, _)| (key.filename() == Some(last), key.clone()));
        files.into_iter().try_for_each(|(key, path)| {
            let bytes = fs::read(&path).map_err(|e| Error::in_file(&path, format!("cannot be read: {e}")))?;
            self.wait(self.store.put(&key, PutPayload::from(bytes))).map(|_| ())
        })
    }

    fn list(&self, folder: &Key) -> Result<ListResult> {
        self.wait(self.store.list_with_delimiter(Some(folder)))
    }

    fn wait<T>(&self, work: impl Future<Output = object_store::Result<T>>) -> Result<T> {
        self.runtime.block_on(work).map_err(|e| Error::in_file(&self.address, told(&e)))
    }
}

/// What a service says, in one line.
fn told(e: &object_store::Error) -> String {
    e.to_string().split_whitespace().collect::<Vec<&str>>().join(" ")
}

/// The files below a folder, with the keys that they get.
fn collect(folder: &Path, key: &Key, files: &mut Vec<(Key, PathBuf)>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let key = key.clone().join(entry.file_name().to_string_lossy().as_ref());
        match entry.path().is_dir() {
            true => collect(&entry.path(), &key, files)?,
            false => files.push((key, entry.path())),
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_are_fetched_and_put() {
        let place = tempfile::tempdir().expect("a temporary folder");
        let address = |folder: &str| PathBuf::from(format!("file://{}/{folder}", place.path().display()));
        fs::create_dir_all(place.path().join("robots/a b")).expect("a folder");
        fs::write(place.path().join("robots/a b/robot.toml"), "name").expect("a file");
        fs::write(place.path().join("robots/notes.txt"), "").expect("a file");
        let robots = Storage::of(&address("robots")).expect("an address");
        let expected = Listing { names: vec!["a b".into()], left_out: vec!["notes.txt".into()] };
        assert_eq!(robots.folders().expect("a listing"), expected);
        let mut fetched = PathBuf::new();
        let failed = robots.with_folder("a b", |folder| -> Result<()> {
            fetched = folder.to_owned();
            assert_eq!(fs::read_to_string(folder.join("robot.toml")).expect("a file"), "name");
            Err(Error::in_file(&folder.join("robot.toml"), "is nobody's"))
        });
        let reason = failed.expect_err("what the work says").to_string();
        assert_eq!(reason, format!("{}/a b/robot.toml: is nobody's", address("robots").display()));
        assert!(!fetched.exists(), "what was fetched is gone");

        assert!(robots.expect_empty().expect_err("robots").to_string().contains("already"));
        let answer = Storage::of(&address("answers/tonight")).expect("an address");
        answer.expect_empty().expect("nothing there");
        answer.put_folder(&place.path().join("robots"), "notes.txt").expect("sent");
        let sent = place.path().join("answers/tonight/a b/robot.toml");
        assert_eq!(fs::read_to_string(sent).expect("a file"), "name");
        assert!(Storage::of(Path::new("gopher://robots")).is_err());
    }
}
