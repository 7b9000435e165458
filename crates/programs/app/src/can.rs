//! Tests on a bench as pages ask for them: a try, its answer, and what other limits would make of it.

use std::path::PathBuf;

use axum::Json;
use axum::extract::{Path as InPath, Query, State};
use dynoid::OtherLimits;
use dynoid::can::{KnownTests, LimitOf, Requirements, Test, TestOptions, Tried};
use dynoid::experiments::Given;
use dynoid::{Draws, KnownBench};
use serde::{Deserialize, Serialize};
use work::Context;

use crate::answer::{Answer, Fault, json};
use crate::blocking::blocking;
use crate::folder::Folder;
use crate::models::files;
use crate::shared::Shared;
use crate::tries::key_of;

/// The most benches of a prediction: their courses are kept in memory.
const MOST_BENCHES: usize = 5000;

/// A question of a page.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Asked {
    bench: String,
    model: Option<String>,
    /// A name, or a file of demands or of a cycle.
    test: String,
    /// Numbers of the test.
    given: Vec<(String, String)>,
    engine_map: Option<String>,
    vehicle: Option<String>,
    /// Requirement sets.
    by: Vec<String>,
    /// Requirements of one's own.
    require: Vec<String>,
    benches: usize,
    seed: u64,
}

/// A question with the paths of its files.
struct Question {
    asked: Asked,
    bench: PathBuf,
    model: Option<PathBuf>,
    test: String,
    options: TestOptions,
}

impl Question {
    fn of(folder: &Folder, asked: Asked) -> Result<Self, Fault> {
        if asked.benches > MOST_BENCHES {
            return Err(Fault::refused(format!(
                "the app draws at most {MOST_BENCHES} benches; `dynoid can` draws more"
            )));
        }
        let existing = |name: &Option<String>| name.as_deref().map(|name| folder.existing(name)).transpose();
        let test = match Test::is_name(&asked.test) {
            true => asked.test.clone(),
            false => folder.existing(&asked.test)?.display().to_string(),
        };
        let given = asked.given.iter().map(|(name, value)| Given { name: name.clone(), value: value.clone() });
        let options = TestOptions {
            engine_map: existing(&asked.engine_map)?,
            idle_rpm: None,
            vehicle: existing(&asked.vehicle)?,
            given: given.collect(),
            seed: asked.seed,
        };
        Ok(Question { bench: folder.existing(&asked.bench)?, model: existing(&asked.model)?, test, options, asked })
    }

    fn key(&self) -> Result<String, Fault> {
        let options = &self.options;
        let files = [Some(self.bench.clone()), self.model.clone(), options.engine_map.clone(), options.vehicle.clone()];
        let test = [Some(PathBuf::from(&self.test))];
        key_of(&self.asked, &[files.as_slice(), &test].concat())
    }

    fn tried(&self, context: &Context) -> Result<Tried, dynoid::Error> {
        let (asked, files) = (&self.asked, files());
        let bench = KnownBench::load(&self.bench, self.model.as_deref(), &files)?;
        let test = Test::find(&self.test, &self.options, &files, context)?;
        let wanted = Requirements::of(&test, &asked.by, &asked.require)?;
        let draws = Draws { benches: asked.benches, seed: asked.seed };
        Tried::of(&bench, &test, &wanted, draws, context)
    }
}

/// Tests that have a name.
pub(crate) async fn tests() -> Answer {
    json(&KnownTests::all())
}

/// Tries a test, or finds the try of the same question.
pub(crate) async fn start(State(shared): State<Shared>, Json(asked): Json<Asked>) -> Answer {
    let question = Question::of(&shared.folder, asked)?;
    shared.predictions.start(question.key()?, move |context| question.tried(context)).stand()
}

/// Where a try stands.
pub(crate) async fn show(State(shared): State<Shared>, InPath(key): InPath<String>) -> Answer {
    shared.predictions.of(&key)?.stand()
}

/// Ends a try, and forgets it.
pub(crate) async fn forget(State(shared): State<Shared>, InPath(key): InPath<String>) -> Answer {
    shared.predictions.forget(&key);
    json(&())
}

/// The answer by the limits of the bench file, with what it rests on.
pub(crate) async fn answer(State(shared): State<Shared>, InPath(key): InPath<String>) -> Answer {
    blocking(move || json(&shared.predictions.of(&key)?.result()?.facts())).await
}

/// Other limits, as an object in JSON; and a course that is to be seen.
#[derive(Deserialize)]
pub(crate) struct Judge {
    limits: String,
    of: Option<LimitOf>,
    /// One bench of those drawn, counted from 0.
    bench: Option<usize>,
}

impl Judge {
    fn limits(&self) -> Result<OtherLimits, Fault> {
        serde_json::from_str(&self.limits).map_err(Fault::refused)
    }
}

/// The answer by other limits.
pub(crate) async fn judged(
    State(shared): State<Shared>,
    InPath(key): InPath<String>,
    Query(judge): Query<Judge>,
) -> Answer {
    blocking(move || {
        let judged = shared.predictions.of(&key)?.result()?.judged(&judge.limits()?).map_err(Fault::refused)?;
        json(&judged.facts())
    })
    .await
}

/// The course of a quantity that has a limit.
pub(crate) async fn course(
    State(shared): State<Shared>,
    InPath(key): InPath<String>,
    Query(judge): Query<Judge>,
) -> Answer {
    blocking(move || {
        let of = judge.of.ok_or_else(|| Fault::refused("no quantity is named"))?;
        let one = shared.predictions.of(&key)?;
        json(&one.result()?.course(of, judge.bench, &judge.limits()?).map_err(Fault::refused)?)
    })
    .await
}
