//! A study that was written, in short.

use std::path::Path;

use serde::Serialize;
use study::ModelComparison;

use super::StudyFacts;
use crate::WrittenStudy;

/// A study in short, with its files and with what has changed since the study that was in the folder before.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct WrittenFacts<'a> {
    #[serde(flatten)]
    study: StudyFacts<'a>,
    report: &'a Path,
    /// The report with all analyses; none where they were not wanted.
    full_report: Option<&'a Path>,
    data: &'a Path,
    /// The table of measured and modelled series; none where nothing was estimated.
    series: Option<&'a Path>,
    /// The bench model; none where the study has none.
    model: Option<&'a Path>,
    /// Changes since the study that was in the folder before; none where it had no model.
    earlier: Option<EarlierFacts<'a>>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct EarlierFacts<'a> {
    date: &'a str,
    changed: Option<bool>,
    comparison: Option<&'a ModelComparison>,
}

impl<'a> WrittenFacts<'a> {
    /// Of a study and its files.
    pub fn of(written: &'a WrittenStudy) -> Self {
        WrittenFacts {
            study: StudyFacts::of(&written.study),
            report: &written.report,
            full_report: written.full_report.as_deref(),
            data: &written.data,
            series: written.series.as_deref(),
            model: written.model.as_deref(),
            earlier: written.earlier.as_ref().map(|earlier| EarlierFacts {
                date: &earlier.date,
                changed: earlier.comparison.as_ref().map(ModelComparison::has_changed),
                comparison: earlier.comparison.as_ref(),
            }),
        }
    }
}
