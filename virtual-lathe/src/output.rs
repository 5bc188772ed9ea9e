//! Output files: written beside their place and moved there when all are complete, so that there is a whole file or
//! none.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// A file being written.
pub struct Pending {
    path: PathBuf,
    file: BufWriter<NamedTempFile>,
}

impl Pending {
    /// Begins a file that will be at `path`; its folder is made if need be.
    ///
    /// # Errors
    /// Those of making the folder or the temporary file, with the path in the message.
    pub fn create(path: &Path) -> io::Result<Self> {
        let named = |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        let folder = match path.parent() {
            Some(folder) if !folder.as_os_str().is_empty() => folder,
            _ => Path::new("."),
        };
        std::fs::create_dir_all(folder).map_err(named)?;
        if path.is_dir() {
            return Err(named(io::Error::new(io::ErrorKind::IsADirectory, "is a folder")));
        }
        let file = NamedTempFile::new_in(folder).map_err(named)?;
        Ok(Self { path: path.into(), file: BufWriter::with_capacity(1 << 16, file) })
    }

    /// Writes to it.
    pub fn writer(&mut self) -> &mut impl Write {
        &mut self.file
    }

    /// Moves it to its place.
    ///
    /// # Errors
    /// Those of writing and moving, with the path in the message.
    pub fn keep(self) -> io::Result<PathBuf> {
        let Self { path, file } = self;
        let named = |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        let file = file.into_inner().map_err(|error| named(error.into_error()))?;
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // a temporary file is private; an output is readable as any other
            let open = std::fs::Permissions::from_mode(0o644);
            file.as_file().set_permissions(open).map_err(named)?;
        }
        file.persist(&path).map_err(|error| named(error.error))?;
        Ok(path)
    }
}
