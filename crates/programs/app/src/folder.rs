//! The folder that is open: files below it, and nothing else.

use std::fs;
use std::path::{Component, Path, PathBuf};

use serde::Deserialize;

use crate::answer::Fault;

/// Name of the folder in which the app keeps its own files.
pub(crate) const OWN: &str = ".dynoid";

/// A file that a page names, as seen from the folder.
#[derive(Debug, Deserialize)]
pub(crate) struct Which {
    pub(crate) file: String,
}

/// A folder whose files the app may read and write.
#[derive(Debug, Clone)]
pub(crate) struct Folder {
    root: PathBuf,
}

impl Folder {
    /// Opens a folder.
    pub(crate) fn open(path: &Path) -> std::io::Result<Self> {
        let root = path.canonicalize()?;
        match root.is_dir() {
            true => Ok(Folder { root }),
            false => Err(std::io::ErrorKind::NotADirectory.into()),
        }
    }

    /// Its path, without links.
    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// A file or folder that is there.
    ///
    /// # Errors
    /// A name that leads out of the folder, by itself or by a link, and one of a file that is not there.
    pub(crate) fn existing(&self, name: &str) -> Result<PathBuf, Fault> {
        let path = self.root.join(plain(name)?);
        let path = path.canonicalize().map_err(|_| Fault::missing(name))?;
        self.within(name, path)
    }

    /// A file that is there, or may be made in a folder that is there.
    ///
    /// # Errors
    /// Those of [`Self::existing`], of its folder.
    pub(crate) fn writable(&self, name: &str) -> Result<PathBuf, Fault> {
        let path = self.root.join(plain(name)?);
        if fs::symlink_metadata(&path).is_ok() {
            return self.existing(name);
        }
        let (Some(parent), Some(file)) = (path.parent(), path.file_name()) else { return Err(Fault::outside(name)) };
        let parent = parent.canonicalize().map_err(|_| Fault::missing(name))?;
        self.within(name, parent.join(file))
    }

    /// Fails for a word of a command that leads out of the folder.
    pub(crate) fn permits(&self, word: &str) -> Result<(), Fault> {
        let path = Path::new(word);
        // Paths of Windows, wherever the app runs; a colon alone stands in ranges.
        if !goes_down(path) || word.starts_with('\\') || word.get(1..3) == Some(":\\") {
            return Err(Fault::outside(word));
        }
        // A link in it must not lead out either, whether what is behind it is there or not.
        let path = self.root.join(path);
        let real = path.ancestors().find_map(|ancestor| ancestor.canonicalize().ok()).unwrap_or_default();
        self.within(word, real).map(|_| ())
    }

    fn within(&self, name: &str, path: PathBuf) -> Result<PathBuf, Fault> {
        match path.starts_with(&self.root) {
            true => Ok(path),
            false => Err(Fault::outside(name)),
        }
    }
}

/// A name that goes down from a folder, step by step.
fn plain(name: &str) -> Result<PathBuf, Fault> {
    let path = Path::new(name);
    // A drive or a stream of Windows, wherever the app runs.
    match goes_down(path) && !name.contains(['\0', ':', '\\']) {
        true => Ok(path.to_owned()),
        false => Err(Fault::outside(name)),
    }
}

fn goes_down(path: &Path) -> bool {
    path.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir))
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn exact_names_lead_nowhere_else() {
        let place = tempfile::tempdir().unwrap();
        let (open, beside) = (place.path().join("open"), place.path().join("beside"));
        fs::create_dir_all(open.join("inner")).unwrap();
        fs::create_dir_all(&beside).unwrap();
        fs::write(beside.join("secret"), "").unwrap();
        fs::write(open.join("inner/run.csv"), "").unwrap();
        let folder = Folder::open(&open).unwrap();
        assert!(folder.existing("inner/run.csv").is_ok() && folder.existing("").is_ok());
        assert!(folder.writable("inner/new.toml").is_ok());
        for name in ["../beside/secret", "/etc/passwd", "inner/../../beside/secret", "C:\\x", "..\\beside", "a\0b"] {
            assert!(folder.existing(name).is_err() && folder.writable(name).is_err(), "{name}");
        }
        assert!(folder.existing("inner/missing").is_err() && folder.writable("missing/new").is_err());
    }

    #[cfg(unix)]
    #[test]
    fn exact_links_lead_nowhere_else() {
        use std::os::unix::fs::symlink;
        let place = tempfile::tempdir().unwrap();
        let (open, beside) = (place.path().join("open"), place.path().join("beside"));
        fs::create_dir_all(&open).unwrap();
        fs::create_dir_all(&beside).unwrap();
        fs::write(beside.join("secret"), "").unwrap();
        symlink(beside.join("secret"), open.join("file")).unwrap();
        symlink(&beside, open.join("folder")).unwrap();
        symlink(beside.join("not-there"), open.join("dangling")).unwrap();
        let folder = Folder::open(&open).unwrap();
        for name in ["file", "folder/secret", "folder", "dangling"] {
            assert!(folder.existing(name).is_err() && folder.writable(name).is_err(), "{name}");
        }
        assert!(folder.writable("folder/new").is_err());
        assert!(folder.permits("folder/new.html").is_err() && folder.permits("file").is_err());
        assert!(folder.permits("new/new.html").is_ok() && folder.permits("0.01:0.02").is_ok());
    }
}
