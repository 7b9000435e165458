//! Experiments to record next as pages ask for them: their gains beside their safety.

use std::path::{Path, PathBuf};

use axum::Json;
use axum::extract::{Path as InPath, State};
use dynoid::OtherLimits;
use dynoid::experiments::{Given, NextOptions, RatedExperiments};
use dynoid::{Bench, Session, listed};
use serde::{Deserialize, Serialize};
use work::Context;

use crate::answer::{Answer, Fault, json};
use crate::blocking::blocking;
use crate::models::files;
use crate::shared::Shared;
use crate::tries::key_of;

/// A question of a page: the experiments of the method, or one with numbers of its own.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Asked {
    bench: String,
    speed_rpm: f64,
    duration_s: f64,
    /// Other limits than those of the bench file.
    #[serde(default)]
    limits: OtherLimits,
    /// The label of one experiment, with its numbers.
    one: Option<String>,
    given: Vec<(String, String)>,
}

impl Asked {
    fn rated(&self, path: PathBuf, context: &Context) -> Result<RatedExperiments, dynoid::Error> {
        let files = files();
        let step = context.step("looking for the next experiment", 3);
        let bench = Bench::load(&path, &files)?;
        let session = match Session::open(bench.clone(), &files, &step) {
            Err(dynoid::Error::NothingMatches { .. } | dynoid::Error::NoRecordingsListed { .. }) => {
                Session::without_recordings(bench)
            }
            read => read?,
        };
        let usual = NextOptions::default();
        let options = NextOptions { speed_rpm: self.speed_rpm, duration_s: self.duration_s, ..usual };
        let given = |(name, value): &(String, String)| Given { name: name.clone(), value: value.clone() };
        let given: Vec<Given> = self.given.iter().map(given).collect();
        match &self.one {
            Some(label) => RatedExperiments::of_one(&session, &self.limits, label, &given, &files, &step),
            None => RatedExperiments::of_the_method(&session, &self.limits, options, &step),
        }
    }

    /// A name of the question, and of the recordings as they are now.
    fn key(&self, path: &Path) -> Result<String, Fault> {
        let bench = Bench::load(path, &files()).map_err(Fault::refused)?;
        let found = listed(path, &bench.file().recordings.files).unwrap_or_default();
        let stamp = |path: &PathBuf| path.metadata().ok().map(|file| (file.len(), file.modified().ok()));
        let stamps: Vec<_> = found.iter().map(|file| (&file.name, stamp(&file.path))).collect();
        key_of(&(self, stamps), &[Some(path.to_owned())])
    }
}

/// Looks for experiments, or finds the search of the same question.
pub(crate) async fn start(State(shared): State<Shared>, Json(asked): Json<Asked>) -> Answer {
    // A file of demands may be anywhere.
    if asked.one.as_deref().is_some_and(|label| !dynoid::can::Test::is_name(label)) {
        return Err(Fault::refused("name an experiment of the method"));
    }
    let path = shared.folder.existing(&asked.bench)?;
    let key = asked.key(&path)?;
    shared.proposals.start(key, move |context| asked.rated(path, context)).stand()
}

/// Where a search stands.
pub(crate) async fn show(State(shared): State<Shared>, InPath(key): InPath<String>) -> Answer {
    shared.proposals.of(&key)?.stand()
}

/// Ends a search, and forgets it.
pub(crate) async fn forget(State(shared): State<Shared>, InPath(key): InPath<String>) -> Answer {
    shared.proposals.forget(&key);
    json(&())
}

/// The experiments that were found.
pub(crate) async fn answer(State(shared): State<Shared>, InPath(key): InPath<String>) -> Answer {
    blocking(move || json(&shared.proposals.of(&key)?.result()?.facts())).await
}
