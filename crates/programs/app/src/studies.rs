//! Studies that were written, in numbers and words.

use axum::extract::{Query, State};
use dynoid::StudyFile;
use dynoid::facts::StudyFacts;
use work::Context;

use crate::answer::{Answer, json};
use crate::blocking::blocking;
use crate::folder::Which;
use crate::models::{files, refused};
use crate::shared::Shared;

/// The study of a file: its verdict, key numbers and findings.
pub(crate) async fn read(State(shared): State<Shared>, Query(which): Query<Which>) -> Answer {
    blocking(move || {
        let path = shared.folder.existing(&which.file)?;
        let read = StudyFile::load(&path, &files(), &Context::new()).map_err(|fault| refused(fault, &shared))?;
        json(&StudyFacts::of(&read.study))
    })
    .await
}
