//! The content of a recording's file, by its hash.

use std::fs;
use std::sync::{Arc, OnceLock};
use std::time::SystemTime;

use dynoid::InputFile;
use serde_json::json;

use crate::errors::Fault;
use crate::made::files;

/// SHA-256 of the content of a file, computed when it is first asked for: a few channels of a large file are read
/// without the rest of it.
#[derive(Clone)]
pub(crate) struct ContentHash(Arc<Origin>);

enum Origin {
    Known(String),
    File { file: InputFile, as_read: Stamp, hash: OnceLock<String> },
}

/// Length and time of the last change.
#[derive(PartialEq)]
struct Stamp(u64, Option<SystemTime>);

impl Stamp {
    fn of(file: &InputFile) -> Option<Self> {
        let found = fs::metadata(&file.path).ok()?;
        Some(Stamp(found.len(), found.modified().ok()))
    }
}

impl ContentHash {
    /// Of a file that is about to be read.
    pub(crate) fn of_file(file: &InputFile) -> Self {
        let Some(as_read) = Stamp::of(file) else { return ContentHash::known_as(String::new()) };
        ContentHash(Arc::new(Origin::File { file: file.clone(), as_read, hash: OnceLock::new() }))
    }

    /// A hash that is known; empty for what is of no file.
    pub(crate) fn known_as(hash: String) -> Self {
        ContentHash(Arc::new(Origin::Known(hash)))
    }

    /// Returns true if the recording is of no file.
    pub(crate) fn is_of_no_file(&self) -> bool {
        matches!(&*self.0, Origin::Known(hash) if hash.is_empty())
    }

    /// The hash, hexadecimal.
    pub(crate) fn read(&self) -> Result<&str, Fault> {
        match &*self.0 {
            Origin::Known(hash) => Ok(hash),
            Origin::File { file, as_read, hash } => {
                if let Some(known) = hash.get() {
                    return Ok(known);
                }
                if Stamp::of(file).as_ref() != Some(as_read) {
                    return Err(changed(file));
                }
                let found = files(false).sha256(file)?;
                Ok(hash.get_or_init(|| found))
            }
        }
    }

    /// The hash; empty where the file is no longer as it was read.
    pub(crate) fn known(&self) -> String {
        self.read().map_or_else(|_| String::new(), str::to_owned)
    }
}

fn changed(file: &InputFile) -> Fault {
    let message = format!("{}: the file has changed since it was read; read it again", file.path.display());
    let fields = json!({ "kind": "Changed", "file": file.path.display().to_string() });
    Fault::Own { class: "FileError", message, fields }
}
