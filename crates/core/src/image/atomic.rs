use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// Why a file was not written. Whatever stood under its name before is untouched.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The folder to write into is missing, or is something else than a folder.
    #[error("cannot write `{path}`: there is no folder `{folder}`; create it first", path = path.display(), folder = folder.display())]
    MissingFolder {
        /// The file to write.
        path: PathBuf,
        /// The folder of that file.
        folder: PathBuf,
    },
    /// A folder has that name.
    #[error("cannot write `{}`: it is a folder; name a file in it", path.display())]
    IsFolder {
        /// The file to write.
        path: PathBuf,
    },
    /// A device, pipe or socket has that name; a file must not take its place.
    #[error("cannot write `{}`: it is a device or pipe; name an ordinary file", path.display())]
    NotAFile {
        /// The file to write.
        path: PathBuf,
    },
    /// A file has that name and nobody may write to it.
    #[error("cannot write `{}`: that file is write-protected; choose another name or make it writable", path.display())]
    WriteProtected {
        /// The file to write.
        path: PathBuf,
    },
    /// The operating system refused.
    #[error("cannot write `{}`{}", path.display(), cure(source))]
    Io {
        /// The file to write.
        path: PathBuf,
        /// What the operating system says.
        source: io::Error,
    },
}

fn cure(error: &io::Error) -> &'static str {
    match error.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => {
            ": the disk is full; free some space or choose another folder"
        }
        ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => {
            ": its folder is read-only; choose another one"
        }
        _ => "",
    }
}

/// Writes a whole file or none: the bytes go to a temporary file in the same folder, reach the
/// disk, and take the name `path` only then. A reader sees the old file or the new one, never a
/// part, and after an error the old one is intact and nothing is left over.
///
/// A new file gets the usual permissions (read and write, less the process's umask); a file that
/// is replaced keeps its own. A link is followed, also to a file that is not there yet.
///
/// # Errors
/// See [`WriteError`]; every message names the file.
pub fn write_atomically(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), WriteError> {
    let path = path.as_ref();
    let io_error = |source| WriteError::Io { path: path.to_owned(), source };
    let Prepared { mut temporary, target, old } = prepare(path)?;
    temporary.write_all(bytes).map_err(io_error)?;
    temporary.flush().map_err(io_error)?;
    if let Some(old) = old {
        temporary.as_file().set_permissions(old.permissions()).map_err(io_error)?;
    }
    temporary.as_file().sync_all().map_err(io_error)?;
    temporary.persist(&target).map_err(|error| io_error(error.error))?;
    Ok(())
}

/// Refuses what [`write_atomically`] would refuse, before the work of making the bytes; only a disk
/// that fills up in the meantime goes unnoticed.
///
/// # Errors
/// See [`WriteError`].
pub fn check_writable(path: impl AsRef<Path>) -> Result<(), WriteError> {
    prepare(path.as_ref()).map(drop)
}

/// A temporary file that is about to take the place of another one.
struct Prepared {
    temporary: NamedTempFile,
    target: PathBuf,
    old: Option<fs::Metadata>,
}

fn prepare(path: &Path) -> Result<Prepared, WriteError> {
    let io_error = |source| WriteError::Io { path: path.to_owned(), source };
    let old = fs::metadata(path).ok();
    if let Some(old) = &old {
        let path = path.to_owned();
        if old.is_dir() {
            return Err(WriteError::IsFolder { path });
        }
        if !old.is_file() {
            return Err(WriteError::NotAFile { path });
        }
        // Renaming would replace it regardless.
        if old.permissions().readonly() {
            return Err(WriteError::WriteProtected { path });
        }
    }
    let target = followed(path).map_err(io_error)?;
    let folder = match target.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    };
    if !is_folder(folder).map_err(io_error)? {
        return Err(WriteError::MissingFolder { path: path.into(), folder: folder.into() });
    }

    let mut builder = tempfile::Builder::new();
    builder.prefix(".lancer-").suffix(".tmp");
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let temporary = builder.tempfile_in(folder).map_err(io_error)?;
    Ok(Prepared { temporary, target, old })
}

/// The file that a name stands for: what its link, or a chain of them, leads to, whether it is there or
/// not.
fn followed(path: &Path) -> io::Result<PathBuf> {
    /// As many as Linux follows.
    const MOST_LINKS: usize = 40;
    let mut target = path.to_owned();
    for _ in 0..=MOST_LINKS {
        let Ok(next) = fs::read_link(&target) else { return Ok(target) };
        // Relative to the folder that the link is in; an absolute one replaces it.
        target = target.parent().unwrap_or(Path::new("")).join(next);
    }
    Err(io::Error::other("its links lead in a circle; name a file"))
}

fn is_folder(path: &Path) -> io::Result<bool> {
    match fs::metadata(path) {
        Ok(found) => Ok(found.is_dir()),
        Err(error) if matches!(error.kind(), ErrorKind::NotFound | ErrorKind::NotADirectory) => {
            Ok(false)
        }
        Err(error) => Err(error),
    }
}
