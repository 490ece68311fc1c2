//! Files that appear whole or not at all: written beside the target under another name, then renamed.

use crate::base::error::{Error, Result};
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Writes `path` with what `write` puts out. A file that stood there is replaced only once the new one is
/// complete; on an error it stays as it was and the temporary file is removed. A target that is not a
/// regular file (a pipe, a device) is written directly.
///
/// # Errors
/// [`Error::File`] saying what the system answered.
pub fn write_atomically(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let result = match fs::metadata(path) {
        Ok(metadata) if !metadata.is_file() => write_directly(path, write),
        _ => write_and_rename(path, write),
    };
    result.map_err(|error| Error::File {
        path: path.to_path_buf(),
        message: format!("cannot be written: {error}; check the folder, its permissions and the free space"),
    })
}

fn write_directly(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut writer = BufWriter::new(OpenOptions::new().write(true).open(path)?);
    write(&mut writer)?;
    writer.flush()
}

fn write_and_rename(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    // A link stays a link: the file it points to is replaced.
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_path_buf());
    let (file, temporary) = create_beside(&target)?;
    let mut writer = BufWriter::with_capacity(1 << 16, file);
    write(&mut writer)?;
    let file = writer.into_inner().map_err(io::IntoInnerError::into_error)?;
    if let Ok(metadata) = fs::metadata(&target) {
        file.set_permissions(metadata.permissions())?;
    }
    file.sync_all()?;
    drop(file);
    temporary.rename(&target)
}

fn create_beside(target: &Path) -> io::Result<(File, Temporary)> {
    static COUNTER: AtomicU32 = AtomicU32::new(0);
    let name = target
        .file_name()
        .ok_or_else(|| io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"))?;
    loop {
        let mut hidden = OsString::from(".");
        hidden.push(name);
        let number = COUNTER.fetch_add(1, Ordering::Relaxed);
        hidden.push(format!(".{}-{number}.part", std::process::id()));
        let path = target.with_file_name(hidden);
        match OpenOptions::new().write(true).create_new(true).open(&path) {
            Ok(file) => return Ok((file, Temporary(Some(path)))),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// A temporary file, removed on drop unless it was renamed.
struct Temporary(Option<PathBuf>);

impl Temporary {
    fn rename(mut self, target: &Path) -> io::Result<()> {
        if let Some(path) = &self.0 {
            fs::rename(path, target)?;
        }
        self.0 = None;
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if let Some(path) = &self.0 {
            // Nothing can be done about a failure here; the error that led here is the one to report.
            let _ = fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("intrinsym-atomic-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn names(folder: &Path) -> Vec<OsString> {
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect()
    }

    #[test]
    fn a_failed_write_leaves_the_old_file_and_nothing_else() {
        let folder = folder("fail");
        let target = folder.join("map");
        fs::write(&target, "old").unwrap();
        let error = write_atomically(&target, |out| {
            out.write_all(b"half")?;
            Err(io::Error::other("stop"))
        });
        assert!(error.unwrap_err().to_string().contains("cannot be written: stop"));
        assert_eq!(fs::read(&target).unwrap(), b"old");
        assert_eq!(names(&folder), ["map"]);
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_written_file_replaces_the_old_one() {
        let folder = folder("replace");
        let target = folder.join("map");
        for text in ["first", "second"] {
            write_atomically(&target, |out| out.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read(&target).unwrap(), text.as_bytes());
        }
        assert_eq!(names(&folder), ["map"]);
        fs::remove_dir_all(folder).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_replaced_file_keeps_its_permissions_and_a_new_one_gets_the_usual() {
        use std::os::unix::fs::PermissionsExt;
        let folder = folder("permissions");
        let mode = |name: &str| fs::metadata(folder.join(name)).unwrap().permissions().mode() & 0o777;
        fs::write(folder.join("usual"), "").unwrap();
        write_atomically(&folder.join("new"), |out| out.write_all(b"new")).unwrap();
        assert_eq!(mode("new"), mode("usual"));
        for wanted in [0o600, 0o640, 0o444] {
            let target = folder.join("kept");
            fs::write(&target, "old").unwrap();
            fs::set_permissions(&target, fs::Permissions::from_mode(wanted)).unwrap();
            write_atomically(&target, |out| out.write_all(b"new")).unwrap();
            assert_eq!((mode("kept"), fs::read(&target).unwrap()), (wanted, b"new".to_vec()));
            fs::remove_file(target).unwrap();
        }
        fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn a_missing_folder_is_named() {
        let error = write_atomically(Path::new("no/such/folder/map"), |_| Ok(())).unwrap_err();
        assert!(error.to_string().starts_with("no/such/folder/map: cannot be written"));
    }
}
