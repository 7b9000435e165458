//! Models: which there are, their dynamics, and how they meet recordings.

use std::num::NonZeroUsize;
use std::path::Path;

use axum::extract::{Query, State};
use dynoid::linear::{ResponseOptions, dynamics};
use dynoid::{Files, Kind, Meeting, MeetingFacts, ModelFacts, TwoBenches, encode_mdf4, replace_file, sha256_of_text};
use recording::Recording;
use serde::{Deserialize, Serialize};
use work::Context;

use crate::answer::{Answer, Fault, json};
use crate::blocking::blocking;
use crate::folder::{OWN, Which};
use crate::recordings::files_of;
use crate::shared::{Inner, Shared};

/// The largest file that may be a model or a study.
const LARGEST_MODEL: u64 = 64 << 20;
/// Confidence of the intervals, as the commands have it.
const LEVEL: f64 = 0.95;

/// A file with a model.
#[derive(Serialize)]
struct ListedModel {
    file: String,
    /// True of a study, which has its model beside it.
    is_study: bool,
    #[serde(flatten)]
    facts: ModelFacts,
}

/// The models and studies of the folder.
pub(crate) async fn list(State(shared): State<Shared>) -> Answer {
    blocking(move || {
        let listed = files_of(&shared.folder).filter_map(|(name, path)| {
            let is_json = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("json"));
            let is_small = || path.metadata().is_ok_and(|metadata| metadata.len() <= LARGEST_MODEL);
            (is_json && is_small()).then(|| listed(name, &path)).flatten()
        });
        json(&listed.collect::<Vec<_>>())
    })
    .await
}

fn listed(file: String, path: &Path) -> Option<ListedModel> {
    let is_study = match Kind::of(&std::fs::read_to_string(path).ok()?) {
        Kind::Other => return None,
        kind => kind == Kind::Study,
    };
    let facts = files().model(path).ok()?.facts();
    Some(ListedModel { file, is_study, facts })
}

/// Two models of benches.
#[derive(Deserialize)]
pub(crate) struct Pair {
    first: String,
    second: String,
}

/// Two studied benches beside each other.
pub(crate) async fn pair(State(shared): State<Shared>, Query(pair): Query<Pair>) -> Answer {
    blocking(move || {
        let [first, second] = [shared.folder.existing(&pair.first)?, shared.folder.existing(&pair.second)?];
        let found =
            TwoBenches::of(&first, &second, &files(), &Context::new()).map_err(|fault| refused(fault, &shared))?;
        json(&found.facts())
    })
    .await
}

/// Frequency and step response, poles and zeros of a model.
pub(crate) async fn dynamics_of(State(shared): State<Shared>, Query(which): Query<Which>) -> Answer {
    blocking(move || {
        let path = shared.folder.existing(&which.file)?;
        json(&dynamics(&path, LEVEL, &files()).map_err(|fault| refused(fault, &shared))?)
    })
    .await
}

/// A model and a recording.
#[derive(Deserialize)]
pub(crate) struct Wanted {
    model: String,
    recording: String,
    /// Samples that are predicted ahead; a simulation without it.
    horizon: Option<NonZeroUsize>,
}

/// A model on a recording.
#[derive(Serialize)]
struct Met<'a> {
    #[serde(flatten)]
    facts: &'a MeetingFacts,
    /// A recording with what was measured and modelled.
    beside: String,
    /// Of each signal its channels in it, plot by plot: the first has the courses, the second the residual.
    plots: Vec<[Vec<&'a str>; 2]>,
}

/// Why a model cannot meet a recording.
#[derive(Serialize)]
struct NotMet {
    failed: String,
}

/// How a model meets a recording.
pub(crate) async fn meet(State(shared): State<Shared>, Query(wanted): Query<Wanted>) -> Answer {
    blocking(move || {
        let [model, recording] = [shared.folder.existing(&wanted.model)?, shared.folder.existing(&wanted.recording)?];
        let response = ResponseOptions { horizon: wanted.horizon, from_rest: false };
        let met = Meeting::of(&model, &recording, response, &files(), &Context::new());
        let met = match met {
            Ok(met) => met,
            // Not every model has its channels in every recording.
            Err(fault) => return json(&NotMet { failed: said(&fault, &shared) }),
        };
        let key = format!("{}\n{}\n{:?}", wanted.model, wanted.recording, wanted.horizon);
        let beside = format!("{OWN}/met/{}.mf4", sha256_of_text(&key));
        keep(&shared, &beside, met.beside())?;
        json(&Met { facts: met.facts(), beside, plots: plots(&met) })
    })
    .await
}

/// Writes a recording of the app's own.
fn keep(shared: &Inner, name: &str, recording: &Recording) -> Result<(), Fault> {
    let path = shared.folder.root().join(name);
    let own = Files::new("app", true);
    std::fs::create_dir_all(path.with_file_name("")).map_err(Fault::refused)?;
    let bytes = encode_mdf4(recording, &own).map_err(Fault::refused)?;
    replace_file(&path, &bytes, &own).map_err(Fault::refused)
}

fn plots(met: &Meeting) -> Vec<[Vec<&str>; 2]> {
    let channels = || met.beside().channels.iter().map(|channel| channel.name.as_str());
    let of_signal = |signal: &str| {
        let own = channels().filter(|name| name.rsplit_once('_').is_some_and(|(of, _)| of == signal));
        let (residual, courses): (Vec<_>, Vec<_>) = own.partition(|name| name.ends_with("_residual"));
        [courses, residual]
    };
    met.facts().signals().map(of_signal).collect()
}

pub(crate) fn files() -> Files {
    Files::new("app", false)
}

/// A fault in words, with files as the page names them.
fn said(fault: &dynoid::Error, shared: &Inner) -> String {
    let root = format!("{}{}", shared.folder.root().display(), std::path::MAIN_SEPARATOR);
    fault.to_string().replace(&root, "")
}

/// A refusal in these words.
pub(crate) fn refused(fault: dynoid::Error, shared: &Inner) -> Fault {
    Fault::refused(said(&fault, shared))
}
