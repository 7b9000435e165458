//! The files beside the program: the same for all machines.

use std::fs;
use std::path::Path;
use std::process::Command;

use super::archive::{self, Entry};
use super::files::{VERSION, read};
use super::licences;
use super::linked::Linked;
use super::targets::Target;
use crate::folder;
use crate::steps::output;

/// Files of the repository that every archive has.
const FILES: [&str; 4] = ["README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT"];
/// Shells, and what their completions are called.
const SHELLS: [(&str, &str); 4] =
    [("bash", "dynoid.bash"), ("zsh", "_dynoid"), ("fish", "dynoid.fish"), ("powershell", "_dynoid.ps1")];

/// The files beside the program, and their time.
pub(super) struct Content {
    /// Time of the commit, from 1970.
    pub(super) time_s: u64,
    pub(super) files: Vec<Entry>,
}

impl Content {
    /// Gathers the files; `program` runs on this machine and writes completions and manual.
    pub(super) fn gather(program: &Path, linked: &Linked, time_s: u64) -> Result<Self, String> {
        let root = folder::root();
        let mut files = Vec::new();
        for file in FILES {
            files.push(Entry::text(file, read(&root.join(file))?));
        }
        files.push(Entry::text(licences::FILE, licences::text(linked)?));
        files.extend(completions(program)?);
        files.extend(manual(program)?);
        Ok(Content { time_s, files })
    }

    /// The bytes of a file.
    pub(super) fn file(&self, path: &str) -> Result<&[u8], String> {
        let found = self.files.iter().find(|file| file.path == path);
        found.map(|file| file.bytes.as_slice()).ok_or_else(|| format!("{path} is not among the files of a release"))
    }

    /// The archive for a target, with one folder, and its name.
    pub(super) fn archive(&self, target: &Target, program: Vec<u8>) -> Result<(String, Vec<u8>), String> {
        let folder = format!("dynoid-{VERSION}-{}", target.triple);
        let below = |file: &Entry| Entry { path: format!("{folder}/{}", file.path), ..file.clone() };
        let mut entries: Vec<Entry> = self.files.iter().map(below).collect();
        entries.push(Entry::program(format!("{folder}/{}", target.program()), program));
        if target.is_windows() {
            Ok((format!("{folder}.zip"), archive::zip(&entries, self.time_s)?))
        } else {
            Ok((format!("{folder}.tar.gz"), archive::gzip(&archive::tar(&entries, self.time_s)?)?))
        }
    }
}

fn completions(program: &Path) -> Result<Vec<Entry>, String> {
    let script = |(shell, name): (&str, &str)| {
        let script = output(Command::new(program).args(["shell", "completions", shell]))?;
        Ok(Entry::text(format!("completions/{name}"), script))
    };
    SHELLS.into_iter().map(script).collect()
}

fn manual(program: &Path) -> Result<Vec<Entry>, String> {
    let out = folder::target()?.join("release-manual");
    if out.exists() {
        fs::remove_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    }
    output(Command::new(program).args(["shell", "manual"]).arg(&out))?;
    let pages = fs::read_dir(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let page = |page: std::io::Result<fs::DirEntry>| {
        let path = page.map_err(|error| format!("{}: {error}", out.display()))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Entry::text(format!("man/man1/{name}"), read(&path)?))
    };
    pages.map(page).collect()
}
