//! A study in short, as JSON for programs.

use std::path::Path;

use dynoid::WrittenStudy;
use dynoid::facts::StudyFacts;
use serde::Serialize;
use study::ModelComparison;

/// A study in short, for programs.
#[derive(Serialize)]
pub(crate) struct Short<'a> {
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
    earlier: Option<ShortEarlier<'a>>,
}

#[derive(Serialize)]
struct ShortEarlier<'a> {
    date: &'a str,
    changed: Option<bool>,
    comparison: Option<&'a ModelComparison>,
}

/// A study in short, for programs.
pub(crate) fn short(written: &WrittenStudy) -> Short<'_> {
    Short {
        study: StudyFacts::of(&written.study),
        report: &written.report,
        full_report: written.full_report.as_deref(),
        data: &written.data,
        series: written.series.as_deref(),
        model: written.model.as_deref(),
        earlier: written.earlier.as_ref().map(|earlier| ShortEarlier {
            date: &earlier.date,
            changed: earlier.comparison.as_ref().map(ModelComparison::has_changed),
            comparison: earlier.comparison.as_ref(),
        }),
    }
}
