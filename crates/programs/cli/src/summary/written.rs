//! A study and its files.

use std::path::PathBuf;

use bench_model::document::BenchModelDocument;
use study::{ModelComparison, Study, compare_models};

/// A study and the files it was written to.
pub(crate) struct Written {
    pub(crate) study: Study,
    pub(crate) report: PathBuf,
    /// The report with all analyses, where they were wanted.
    pub(crate) full_report: Option<PathBuf>,
    /// Files for paper.
    pub(crate) paper: Vec<PathBuf>,
    pub(crate) data: PathBuf,
    /// The measured and modelled series, where something was estimated.
    pub(crate) series: Option<PathBuf>,
    /// The bench model, where the study has one.
    pub(crate) model: Option<PathBuf>,
    /// Reports of an earlier study that stay in the folder.
    pub(crate) of_earlier: Vec<PathBuf>,
    /// The study that was in the folder before, where it had a model.
    pub(crate) earlier: Option<Earlier>,
}

/// An earlier study, and what has changed since.
pub(crate) struct Earlier {
    /// Its day.
    pub(crate) date: String,
    /// Its model against that of the new study; none where the new study has none.
    pub(crate) comparison: Option<ModelComparison>,
}

impl Earlier {
    pub(crate) fn new(earlier: &BenchModelDocument, now: Option<&BenchModelDocument>) -> Self {
        Earlier { date: earlier.provenance.date.clone(), comparison: now.map(|now| compare_models(earlier, now)) }
    }
}
