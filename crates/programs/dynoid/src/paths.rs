//! Paths as text, and from one place to another.

use std::ffi::OsStr;
use std::path::{Component, Path, PathBuf};

/// A file's ending, as it is spelled.
pub fn ending(path: &Path) -> Option<&str> {
    path.extension().and_then(OsStr::to_str)
}

/// The absolute folder a file is in.
pub fn folder_of(file: &Path) -> PathBuf {
    let absolute = std::path::absolute(file).unwrap_or_else(|_| file.to_owned());
    absolute.parent().map(Path::to_owned).unwrap_or_default()
}

/// A path written with `/`, as bench files write them everywhere.
pub fn with_slashes(path: &Path) -> String {
    let text = path.to_string_lossy();
    if std::path::MAIN_SEPARATOR == '/' { text.into_owned() } else { text.replace(std::path::MAIN_SEPARATOR, "/") }
}

/// The name of a file for a bench in this folder: where the file is as seen from there, or its own path where it is
/// elsewhere.
pub fn name_in(path: &Path, folder: &Path) -> String {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    with_slashes(whole.strip_prefix(folder).unwrap_or(path))
}

/// A path as seen from a folder, with `..` where needed; the absolute path where there is no way (another drive). Both
/// must exist.
pub fn relative_to(path: &Path, folder: &Path) -> PathBuf {
    let (Ok(path), Ok(folder)) = (path.canonicalize(), folder.canonicalize()) else { return path.to_owned() };
    let common = path.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if common == 0 {
        return path;
    }
    let up = folder.components().skip(common).map(|_| Component::ParentDir);
    up.chain(path.components().skip(common)).collect()
}

/// Tells whether a path names a pipe or a device: neither a file nor a folder.
pub fn is_stream(path: &Path) -> bool {
    path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir())
}
