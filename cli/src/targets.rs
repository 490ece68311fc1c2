//! Files that a run would write: no two are one, none is an input, and none takes the place of a file that this program has not
//! written, unless `--force` is given.

use crate::arguments::Kind;
use crate::picture;
use intrinsym::io;
use serde_json::Value;
use std::collections::{HashMap, HashSet};
use std::fs::{self, File};
use std::io::Read;
use std::path::{Path, PathBuf};

/// Bytes at the start of a file that hold its mark.
const MARKED: u64 = 1 << 16;
/// Largest report that is read, in bytes.
const LARGEST_REPORT: u64 = 1 << 26;
/// How an archive of `eigen` begins, after 30 bytes of the ZIP format.
const FIRST_ARRAY: &[u8] = b"eigenvalues.npy";

/// Who reads or writes which file.
pub struct Claims {
    /// What each file is to this run, as it stands in messages.
    uses: HashMap<PathBuf, String>,
    /// Folders as the system names them.
    folders: HashMap<PathBuf, PathBuf>,
}

impl Claims {
    /// Of files that are read and must stay, as the buffers beside a glTF.
    pub fn of_inputs<'a>(inputs: impl IntoIterator<Item = &'a PathBuf>) -> Claims {
        let mut claims = Claims { uses: HashMap::new(), folders: HashMap::new() };
        for input in inputs.into_iter().filter(|input| !is_stream(input)) {
            let key = claims.identity(input);
            claims.uses.insert(key, format!("the input {}", input.display()));
            for buffer in io::buffer_files(input) {
                let key = claims.identity(&buffer);
                claims.uses.insert(key, format!("the input {} of {}", buffer.display(), input.display()));
            }
        }
        claims
    }

    /// Claims a file for a result, described as "the map of a.off". Pipes and devices take any number of results.
    ///
    /// # Errors
    /// A sentence for the user if the file has a use already, or is a folder.
    pub fn claim(&mut self, path: &Path, result: String) -> Result<(), String> {
        if path == Path::new("-") {
            return Err(format!("{result} would be a file called -; for standard output give /dev/stdout"));
        }
        if path.is_dir() {
            return Err(format!("{} is a folder: it cannot hold {result}; name a file", path.display()));
        }
        if is_stream(path) {
            return Ok(());
        }
        let key = self.identity(path);
        match self.uses.insert(key, result.clone()) {
            None => Ok(()),
            Some(other) => Err(format!(
                "{} would be both {other} and {result}: name another file or folder",
                path.display()
            )),
        }
    }

    /// The same for all paths to one file.
    fn identity(&mut self, path: &Path) -> PathBuf {
        let whole = fs::canonicalize(path).unwrap_or_else(|_| {
            let folder = path.parent().filter(|parent| !parent.as_os_str().is_empty());
            let folder = folder.unwrap_or(Path::new("."));
            let real = || fs::canonicalize(folder).or_else(|_| std::path::absolute(folder));
            let known = self.folders.entry(folder.to_path_buf());
            known.or_insert_with(|| real().unwrap_or_default()).join(path.file_name().unwrap_or_default())
        });
        // Names that differ in case alone are one file there.
        let folds_case = cfg!(any(windows, target_os = "macos"));
        if folds_case { whole.to_string_lossy().to_lowercase().into() } else { whole }
    }
}

/// Whether a path is a pipe or a device.
fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|metadata| !metadata.is_file() && !metadata.is_dir())
}

/// What shows that this program wrote a file.
pub struct Evidence {
    /// The files of an earlier run, and those that it saw left by others, by its report.
    listed: HashSet<PathBuf>,
}

impl Evidence {
    /// That of the report of an earlier run, if there is one. It speaks of the files where that run wrote them: a copy of it says nothing
    /// of those beside it.
    pub fn of_report(path: Option<&Path>) -> Evidence {
        let report = path.and_then(report).unwrap_or_default();
        let folder = Path::new(report["folder"].as_str().unwrap_or_default());
        let lists = [&report["files"], &report["left_over"]].into_iter().filter_map(Value::as_array);
        let files = lists.flatten().filter_map(Value::as_str).map(|file| folder.join(file));
        Evidence { listed: files.filter_map(|file| fs::canonicalize(file).ok()).collect() }
    }

    /// Whether an existing file is a result of an earlier run: a PLY, GLB or PNG that says so, a report, or a file that the report lists,
    /// as maps must be, which hold nothing but numbers. Nothing is lost with an empty file or a pipe.
    pub fn is_ours(&self, kind: Kind, path: &Path) -> bool {
        let is_listed = || fs::canonicalize(path).is_ok_and(|path| self.listed.contains(&path));
        let by_content = || match kind {
            Kind::Map => false,
            Kind::Ply => starts_with(path, io::PLY_MARK),
            Kind::Glb => starts_with(path, io::GLB_MARK),
            Kind::Png => starts_with(path, picture::PNG_MARK),
            Kind::Json => is_report(path),
        };
        may_be_replaced(path) || is_listed() || by_content()
    }
}

/// Whether a file is an archive that `eigen` wrote, or nothing is lost with it.
pub fn is_our_archive(path: &Path) -> bool {
    may_be_replaced(path)
        || head(path).is_some_and(|bytes| bytes.get(30..).is_some_and(|b| b.starts_with(FIRST_ARRAY)))
}

/// The sentence for a file that must not be replaced.
pub fn exists(path: &Path) -> String {
    format!(
        "{} exists, and nothing shows that an earlier run wrote it; name another file, or give --force to replace it",
        path.display()
    )
}

/// Whether a file is a report of an earlier run.
pub fn is_report(path: &Path) -> bool {
    report(path).is_some()
}

fn may_be_replaced(path: &Path) -> bool {
    is_stream(path) || fs::metadata(path).is_ok_and(|metadata| metadata.len() == 0)
}

fn head(path: &Path) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    if is_stream(path) {
        // To read from one's own end of a pipe is to wait for ever.
        return None;
    }
    File::open(path).ok()?.take(MARKED).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

fn starts_with(path: &Path, mark: &str) -> bool {
    head(path).is_some_and(|bytes| bytes.windows(mark.len()).any(|window| window == mark.as_bytes()))
}

/// A report of an earlier run.
fn report(path: &Path) -> Option<Value> {
    let is_small = fs::metadata(path).is_ok_and(|data| data.is_file() && data.len() <= LARGEST_REPORT);
    let text = if is_small { fs::read(path).ok()? } else { return None };
    let report: Value = serde_json::from_slice(&text).ok()?;
    let is_ours = ["version", "outcome", "symmetries", "files"].iter().all(|key| report.get(key).is_some());
    is_ours.then_some(report)
}
