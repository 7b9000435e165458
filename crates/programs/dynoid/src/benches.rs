//! Two studied benches beside each other.

use std::path::{Path, PathBuf};

use bench_model::document::BenchModelDocument;
use report::comparison::ComparisonFacts;
use serde::Serialize;
use study::{ModelComparison, compare_models};
use work::Context;

use crate::error::Error;
use crate::facts::VerdictFacts;
use crate::files::Files;
use crate::paths::with_slashes;
use crate::study_file::StudyFile;
use crate::written::DATA;

/// Two studied benches, compared by their models.
#[derive(Debug)]
pub struct TwoBenches {
    sides: [Side; 2],
    comparison: ModelComparison,
}

/// One of two benches.
#[derive(Debug)]
struct Side {
    file: PathBuf,
    model: BenchModelDocument,
    /// None of a model whose study is not beside it.
    study: Option<StudyFile>,
}

impl TwoBenches {
    /// Reads two models of benches, or two studies with their models beside them, and compares them.
    ///
    /// # Errors
    /// A file that cannot be read, or that has no model.
    pub fn of(first: &Path, second: &Path, files: &Files, context: &Context) -> Result<Self, Error> {
        let sides = [Side::read(first, files, context)?, Side::read(second, files, context)?];
        let comparison = compare_models(&sides[0].model, &sides[1].model);
        Ok(TwoBenches { sides, comparison })
    }

    /// Both in numbers and words: their verdicts, and how their parts differ.
    pub fn facts(&self) -> TwoBenchesFacts {
        let [first, second] = &self.sides;
        TwoBenchesFacts {
            first: first.facts(),
            second: second.facts(),
            comparison: ComparisonFacts::of(&self.comparison, [&first.model, &second.model]),
        }
    }
}

impl Side {
    fn read(file: &Path, files: &Files, context: &Context) -> Result<Self, Error> {
        let model = files.bench_model(file)?;
        let path = file.with_file_name(DATA);
        // The model compares what it is from; a study of other recordings beside it has another verdict.
        let is_beside = path.is_file() && files.bench_model(&path).is_ok_and(|own| own == model);
        let study = is_beside.then(|| StudyFile::load(&path, files, context)).transpose()?;
        Ok(Side { file: file.to_owned(), model, study })
    }

    fn facts(&self) -> SideFacts {
        SideFacts {
            file: with_slashes(&self.file),
            bench: self.model.bench.name.clone(),
            date: self.model.provenance.date.clone(),
            recordings: self.model.provenance.recordings.iter().map(|used| used.file.clone()).collect(),
            verdict: self.study.as_ref().map(|file| VerdictFacts::of(&file.study)),
        }
    }
}

/// Two studied benches in numbers and words.
#[derive(Debug, Clone, Serialize)]
pub struct TwoBenchesFacts {
    first: SideFacts,
    second: SideFacts,
    #[serde(flatten)]
    comparison: ComparisonFacts,
}

/// One of two benches.
#[derive(Debug, Clone, Serialize)]
struct SideFacts {
    file: String,
    bench: String,
    date: String,
    recordings: Vec<String>,
    /// None of a model whose study is not beside it.
    verdict: Option<VerdictFacts>,
}
