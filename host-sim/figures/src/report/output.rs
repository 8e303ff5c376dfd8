//! Figures as files.

use std::path::Path;

use super::Figure;
use mindgap_files as files;
use mindgap_foundations::error::Result;

impl Figure {
    /// Writes `name.svg` and `name.png` into a folder, each atomically.
    ///
    /// # Errors
    /// When the folder is missing or not writable.
    pub fn write(&self, folder: &Path, name: &str) -> Result<()> {
        files::write(&folder.join(format!("{name}.svg")), self.svg())?;
        #[cfg(not(target_family = "wasm"))]
        files::write(&folder.join(format!("{name}.png")), self.png())?;
        Ok(())
    }
}
