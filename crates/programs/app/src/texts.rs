//! Files as text: read with their state, and written only over the state that was read.

use std::path::PathBuf;

use axum::Json;
use axum::extract::{Query, State};
use axum::http::header::{CONTENT_SECURITY_POLICY, IF_MATCH};
use axum::http::{HeaderMap, HeaderValue};
use dynoid::{Bench, Change, Error, Files, KEYS, changed, replace_file, values};
use serde::{Deserialize, Serialize};

use crate::answer::{Answer, Fault, json, of_type};
use crate::folder::{OWN, Which};
use crate::guard::REPORT_POLICY;
use crate::session::{self, Act};
use crate::shared::Shared;

/// A text and its state.
#[derive(Serialize)]
struct Text {
    text: String,
    /// SHA-256 of the bytes; none of a file that is not there.
    state: Option<String>,
}

/// The text of a file, with its state.
pub(crate) async fn read(State(shared): State<Shared>, Query(which): Query<Which>) -> Answer {
    let path = shared.folder.writable(&which.file)?;
    let text = match path.is_file() {
        true => Some(std::fs::read_to_string(&path).map_err(Fault::refused)?),
        false => None,
    };
    let state = text.as_deref().map(dynoid::sha256_of_text);
    json(&Text { text: text.unwrap_or_default(), state })
}

/// Writes a file whole, if it is still in the state that the page read.
pub(crate) async fn write(
    State(shared): State<Shared>,
    Query(which): Query<Which>,
    headers: HeaderMap,
    text: String,
) -> Answer {
    let path = shared.folder.writable(&which.file)?;
    let known = state_in(&headers);
    let now = path.is_file().then(|| std::fs::read_to_string(&path)).transpose().map_err(Fault::refused)?;
    if now.as_deref().map(dynoid::sha256_of_text) != known {
        return Err(Fault::changed(&which.file));
    }
    replace_file(&path, text.as_bytes(), &Files::new("app", true)).map_err(Fault::refused)?;
    session::note(&shared, Act::Saved { file: which.file.clone(), text: text.clone() }).map_err(Fault::refused)?;
    forget_draft(&shared, &which.file)?;
    json(&Text { state: Some(dynoid::sha256_of_text(&text)), text })
}

/// A report or a page, for a frame in which it can do nothing but show itself.
pub(crate) async fn report(State(shared): State<Shared>, Query(which): Query<Which>) -> Answer {
    let path = shared.folder.existing(&which.file)?;
    let bytes = std::fs::read(&path).map_err(Fault::refused)?;
    let mut response = of_type("text/html; charset=utf-8", bytes);
    response.headers_mut().insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(REPORT_POLICY));
    Ok(response)
}

/// A fault of a bench file.
#[derive(Serialize)]
struct Faulty {
    /// Line, counted from 1.
    line: usize,
    text: String,
}

/// A text that is to be a bench file.
#[derive(Serialize)]
struct Checked {
    faults: Vec<Faulty>,
    /// Its values by tables; none where it is not TOML.
    values: Option<serde_json::Value>,
}

/// The faults of a text that is to be a bench file, and its values.
pub(crate) async fn check(State(shared): State<Shared>, Query(which): Query<Which>, text: String) -> Answer {
    let path = shared.folder.writable(&which.file)?;
    let faults = match Bench::parse(&path, &text) {
        Ok(_) => Vec::new(),
        Err(Error::BenchFile { source, .. }) => source.faults,
        Err(other) => return Err(Fault::refused(other)),
    };
    let faulty = faults.iter().map(|fault| Faulty { line: fault.line, text: format!("{}: {}", fault.key, fault.kind) });
    json(&Checked { faults: faulty.collect(), values: values(&text) })
}

/// A text with changes that a form makes.
#[derive(Deserialize)]
pub(crate) struct Changes {
    text: String,
    changes: Vec<Change>,
}

/// Makes changes in a text, and leaves all else of it as it is. Nothing is saved.
pub(crate) async fn change(
    State(shared): State<Shared>,
    Query(which): Query<Which>,
    Json(Changes { text, changes }): Json<Changes>,
) -> Answer {
    let path = shared.folder.writable(&which.file)?;
    json(&changed(&path, &text, &changes).map_err(Fault::refused)?)
}

/// The roles that a channel can play.
pub(crate) async fn roles() -> Answer {
    json(&dynoid::roles())
}

/// The keys of a bench file in words.
pub(crate) async fn keys() -> Answer {
    json(&KEYS.as_slice())
}

/// A text that was typed over a file and not saved.
#[derive(Default, Serialize, Deserialize)]
struct Draft {
    text: Option<String>,
    /// State of the file over which it was typed.
    of: Option<String>,
}

/// Place of what was typed over a file, which may have any name.
fn draft_of(shared: &Shared, file: &str) -> Result<PathBuf, Fault> {
    shared.folder.writable(file)?;
    let drafts = shared.folder.root().join(OWN).join("drafts");
    std::fs::create_dir_all(&drafts).map_err(Fault::refused)?;
    Ok(drafts.join(format!("{}.json", dynoid::sha256_of_text(file))))
}

/// The text that was typed over a file and not saved, if there is one.
pub(crate) async fn draft(State(shared): State<Shared>, Query(which): Query<Which>) -> Answer {
    let kept = std::fs::read_to_string(draft_of(&shared, &which.file)?).unwrap_or_default();
    json(&serde_json::from_str::<Draft>(&kept).unwrap_or_default())
}

/// Keeps what was typed, so that neither a closed page nor a program that is killed loses it.
pub(crate) async fn keep_draft(
    State(shared): State<Shared>,
    Query(which): Query<Which>,
    headers: HeaderMap,
    text: String,
) -> Answer {
    let draft = Draft { text: Some(text), of: state_in(&headers) };
    let bytes = serde_json::to_vec(&draft).map_err(Fault::refused)?;
    replace_file(&draft_of(&shared, &which.file)?, &bytes, &Files::new("app", true)).map_err(Fault::refused)?;
    json(&draft.of)
}

/// Forgets what was typed.
pub(crate) async fn drop_draft(State(shared): State<Shared>, Query(which): Query<Which>) -> Answer {
    forget_draft(&shared, &which.file)?;
    json(&())
}

fn forget_draft(shared: &Shared, file: &str) -> Result<(), Fault> {
    match std::fs::remove_file(draft_of(shared, file)?) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Fault::refused(error)),
        _ => Ok(()),
    }
}

fn state_in(headers: &HeaderMap) -> Option<String> {
    headers.get(IF_MATCH).and_then(|state| state.to_str().ok()).map(str::to_owned)
}
