//! Output files: written beside their place and moved there when all are complete, so that there is a whole file or
//! none. A link is written through; what is no file (a device, a socket, a folder) is never replaced.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// The places of outputs, checked together before anything is written.
#[derive(Clone, Debug, Default)]
pub struct Places {
    /// Inputs and outputs so far, links followed.
    taken: Vec<PathBuf>,
}

impl Places {
    /// Notes a file that is read, so that no output may land on it.
    pub fn input(&mut self, path: &Path) {
        self.taken.extend(path.canonicalize());
    }

    /// Checks an output's place.
    ///
    /// # Errors
    /// What is there is no file, or is an input or another output of this call.
    pub fn output(&mut self, path: &Path) -> io::Result<()> {
        let refuse = |why: &str| Err(io::Error::other(format!("{}: {why}", path.display())));
        let place = resolved(path);
        if place.exists() && !place.is_file() {
            return refuse(if place.is_dir() { "is a folder" } else { "is no file" });
        }
        if self.taken.contains(&place) {
            return refuse("is read or written by this call already");
        }
        self.taken.push(place);
        Ok(())
    }
}

/// A path with its links followed, also where its last part does not exist yet.
fn resolved(path: &Path) -> PathBuf {
    if let Ok(place) = path.canonicalize() {
        return place;
    }
    match (path.parent(), path.file_name()) {
        (Some(folder), Some(name)) => {
            let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
            folder.canonicalize().map_or_else(|_| path.into(), |folder| folder.join(name))
        }
        _ => path.into(),
    }
}

/// A file being written.
pub struct Pending {
    path: PathBuf,
    file: BufWriter<NamedTempFile>,
}

impl Pending {
    /// Begins a file that will be at `path`; the folders that it needs are made when it is kept.
    ///
    /// # Errors
    /// Those of making the temporary file, with the path in the message.
    pub fn create(path: &Path) -> io::Result<Self> {
        let named = |error: io::Error| io::Error::new(error.kind(), format!("{}: {error}", path.display()));
        let place = resolved(path);
        // the nearest folder that exists is on the same disk as those to be made
        let folder = place.ancestors().skip(1).find(|folder| folder.exists()).unwrap_or(Path::new("."));
        let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
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
        let place = resolved(&path);
        if let Some(folder) = place.parent() {
            std::fs::create_dir_all(folder).map_err(named)?;
        }
        file.persist(&place).map_err(|error| named(error.error))?;
        Ok(path)
    }
}
