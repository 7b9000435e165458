//! Recordings beside a bench file: which it uses, and the experiment of each.

use axum::extract::{Query, State};
use dynoid::InputFile;
use serde::Serialize;

use crate::answer::{Answer, Fault, json};
use crate::blocking::{blocking, cancellable};
use crate::folder::Which;
use crate::models::files;
use crate::recordings::recordings_of;
use crate::shared::Shared;

/// A recording of the folder, as the bench file uses it.
#[derive(Serialize)]
struct Used {
    file: String,
    #[serde(flatten)]
    as_used: dynoid::RecordingUse,
}

/// All recordings of the folder, as the text of a bench file uses them.
pub(crate) async fn uses(State(shared): State<Shared>, Query(which): Query<Which>, text: String) -> Answer {
    blocking(move || {
        let bench = shared.folder.writable(&which.file)?;
        let files = recordings_of(&shared.folder);
        let paths: Vec<_> = files.iter().map(|file| shared.folder.root().join(file)).collect();
        let uses = dynoid::uses(&bench, &text, &paths);
        let used: Vec<Used> = files.into_iter().zip(uses).map(|(file, as_used)| Used { file, as_used }).collect();
        json(&used)
    })
    .await
}

/// The experiment that a recording shows by itself, with the channels that the text of a bench file names.
pub(crate) async fn seen(State(shared): State<Shared>, Query(which): Query<Which>, text: String) -> Answer {
    cancellable(move |context| {
        let file = InputFile { path: shared.folder.existing(&which.file)?, name: which.file };
        dynoid::seen_label(&text, &file, &files(), context).map_err(Fault::refused)
    })
    .await
}
