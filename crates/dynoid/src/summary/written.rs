//! A study and its files.

use std::path::PathBuf;

use study::Study;

/// A study and the files it was written to.
pub(crate) struct Written {
    pub(crate) study: Study,
    pub(crate) report: PathBuf,
    /// The report with all analyses, where they were wanted.
    pub(crate) full_report: Option<PathBuf>,
    pub(crate) data: PathBuf,
    /// The measured and modelled series, where something was estimated.
    pub(crate) series: Option<PathBuf>,
    /// The bench model, where the study has one.
    pub(crate) model: Option<PathBuf>,
}
