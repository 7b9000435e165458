//! The session: every act that computes or writes, as commands that repeat it without the app.

mod act;
mod python;
mod shell;

use std::fs::{self, OpenOptions};
use std::io::{self, Write as _};
use std::path::PathBuf;
use std::time::{SystemTime, UNIX_EPOCH};

use axum::extract::{Path, State};
use serde::{Deserialize, Serialize};

pub(crate) use self::act::Act;
use crate::answer::{Answer, Fault, json, of_type};
use crate::folder::OWN;
use crate::shared::{Inner, Shared};

/// File of the acts, one a line.
const FILE: &str = "session.jsonl";
/// An act with its time.
#[derive(Debug, Serialize, Deserialize)]
struct Noted {
    /// Milliseconds since 1970.
    at_ms: u64,
    act: Act,
}

/// An act as a page shows it.
#[derive(Serialize)]
struct Shown {
    at_ms: u64,
    /// The command, or the first line of several.
    command: String,
    python: String,
}

/// Adds an act to the session.
pub(crate) fn note(shared: &Inner, act: Act) -> io::Result<()> {
    let at_ms = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_millis() as u64;
    let path = file_of(shared);
    fs::create_dir_all(path.with_file_name(""))?;
    let line = format!("{}\n", serde_json::to_string(&Noted { at_ms, act })?);
    // In one write, so that two pages at once do not mix their lines.
    OpenOptions::new().create(true).append(true).open(path)?.write_all(line.as_bytes())
}

/// The acts of the session with their commands and their lines of Python.
pub(crate) async fn list(State(shared): State<Shared>) -> Answer {
    let shown = |Noted { at_ms, act }: &Noted| Shown {
        at_ms: *at_ms,
        command: shell::in_short(act),
        python: python::in_short(act),
    };
    json(&acts(&shared)?.iter().map(shown).collect::<Vec<_>>())
}

/// The session as a file: `commands` for a shell, or `python`.
pub(crate) async fn file(State(shared): State<Shared>, Path(kind): Path<String>) -> Answer {
    let acts: Vec<Act> = acts(&shared)?.into_iter().map(|noted| noted.act).collect();
    let text = match kind.as_str() {
        "commands" => shell::script(&acts),
        "python" => python::script(&acts),
        other => return Err(Fault::missing(other)),
    };
    Ok(of_type("text/plain; charset=utf-8", text))
}

/// Begins a new session. The acts until now stay in a file beside it.
pub(crate) async fn begin(State(shared): State<Shared>) -> Answer {
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_millis();
    let path = file_of(&shared);
    match fs::rename(&path, path.with_file_name(format!("session-{now}.jsonl"))) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(Fault::refused(error)),
        _ => json(&()),
    }
}

fn file_of(shared: &Inner) -> PathBuf {
    shared.folder.root().join(OWN).join(FILE)
}

/// The acts, the oldest first. A line that was cut by a full disk is left out.
fn acts(shared: &Inner) -> Result<Vec<Noted>, Fault> {
    match fs::read_to_string(file_of(shared)) {
        Ok(text) => Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect()),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        Err(error) => Err(Fault::refused(error)),
    }
}
