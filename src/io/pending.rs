//! Files appear whole or not at all: written beside their place, then renamed.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::error::IoError;

/// The temporary files of this process that are not yet in their places. Signals come to the process, and so does this list.
static UNDER_WAY: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn under_way() -> MutexGuard<'static, Vec<PathBuf>> {
    // A thread that panicked with it in hand left a whole list.
    UNDER_WAY.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of all writes under way, and calls `end` before another can begin or take its place.
///
/// For programs that are told to stop, by a signal or otherwise: `end` should end the process. After it, a file that was under way
/// is missing, and its [`PendingFile::commit`] is an error; what was in its place is as it was. The library never calls this itself.
///
/// # Cost
/// O(k) for k files under way. Waits for a rename that has begun.
pub fn remove_pending_files<T>(end: impl FnOnce() -> T) -> T {
    let mut files = under_way();
    for file in files.drain(..) {
        // It may not be there yet, and nothing can be done about a failure here.
        let _ = fs::remove_file(file);
    }
    end()
}

/// A file that is written, but not yet in its place.
///
/// Dropped without [`PendingFile::commit`], it is removed and the place is as it was.
#[derive(Debug)]
pub struct PendingFile {
    temporary: PathBuf,
    target: PathBuf,
    committed: bool,
}

impl PendingFile {
    /// Creates a file beside `target` and fills it.
    ///
    /// # Errors
    /// [`IoError::Write`] if the folder takes no file, or if `target` is a folder or write-protected.
    pub(super) fn create(target: &Path, fill: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>) -> Result<Self, IoError> {
        static COUNTER: AtomicU32 = AtomicU32::new(0);
        let failed = |source| IoError::Write { path: target.to_owned(), source };
        // Through a link, so that it is its file that is replaced.
        let real = fs::canonicalize(target).unwrap_or_else(|_| target.to_owned());
        if let Ok(metadata) = fs::metadata(&real) {
            if metadata.is_dir() {
                return Err(failed(io::Error::new(io::ErrorKind::IsADirectory, "it is a folder")));
            }
            if metadata.permissions().readonly() {
                return Err(failed(io::Error::new(io::ErrorKind::PermissionDenied, "it is write-protected")));
            }
        }
        let Some(name) = real.file_name() else {
            return Err(failed(io::Error::new(io::ErrorKind::InvalidInput, "it has no file name")));
        };
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{}.part", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed)));
        // Mesh formats are told by their extension, and what was written is read back under this name.
        if let Some(extension) = real.extension() {
            hidden.push(".");
            hidden.push(extension);
        }
        let temporary = real.with_file_name(hidden);
        let file = {
            let mut files = under_way();
            let file = OpenOptions::new().write(true).create_new(true).open(&temporary).map_err(failed)?;
            files.push(temporary.clone());
            file
        };
        let pending = Self { temporary, target: real, committed: false };
        let mut buffered = BufWriter::with_capacity(1 << 18, file);
        fill(&mut buffered).and_then(|()| buffered.flush()).map_err(failed)?;
        Ok(pending)
    }

    /// The file as it is now, under its temporary name, complete and readable.
    pub fn path(&self) -> &Path {
        &self.temporary
    }

    /// The place that the file will take.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Puts the file in its place, replacing what is there in one step.
    ///
    /// # Errors
    /// [`IoError::Write`] if the rename fails; the temporary file is removed then.
    pub fn commit(mut self) -> Result<(), IoError> {
        let mut files = under_way();
        let renamed = fs::rename(&self.temporary, &self.target);
        if renamed.is_ok() {
            self.committed = true;
            files.retain(|file| *file != self.temporary);
        }
        // The list is needed again where the temporary file is removed.
        drop(files);
        renamed.map_err(|source| IoError::Write { path: self.target.clone(), source })
    }
}

impl Drop for PendingFile {
    fn drop(&mut self) {
        if !self.committed {
            // Nothing can be done about a failure here, and the user's own file is untouched.
            let _ = fs::remove_file(&self.temporary);
            under_way().retain(|file| *file != self.temporary);
        }
    }
}

/// Whether two paths lead to the same file, through links too. A file that does not exist is the same as none.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    #[cfg(unix)]
    {
        use std::os::unix::fs::MetadataExt;
        match (fs::metadata(a), fs::metadata(b)) {
            (Ok(a), Ok(b)) => (a.dev(), a.ino()) == (b.dev(), b.ino()),
            _ => false,
        }
    }
    #[cfg(not(unix))]
    {
        matches!((fs::canonicalize(a), fs::canonicalize(b)), (Ok(a), Ok(b)) if a == b)
    }
}
