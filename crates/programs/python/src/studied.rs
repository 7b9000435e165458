//! Studies, as Python gets them.

use std::path::PathBuf;

use ::recording::Recording as Decoded;
use ::study::{Origin, Study, document};
use dynoid::facts::StudyFacts;
use dynoid::{Error, StudyFile};
use pyo3::prelude::*;
use report::wording;

use crate::errors::Fault;
use crate::interrupt;
use crate::made::{Made, files};
use crate::recording::Recording;

/// A study, its model as the text of a file, and the series of its traces.
pub(crate) type Studied<'py> = (Bound<'py, Made>, Option<String>, Option<Bound<'py, Recording>>);

/// A study that was made or read.
pub(crate) struct FoundStudy {
    made: Made,
    model: Option<String>,
    series: Option<Decoded>,
}

impl FoundStudy {
    /// Of a study, with its day.
    pub(crate) fn of(study: &Study, origin: &Origin) -> Result<Self, Error> {
        let model = ::study::bench_model(study, origin.clone(), &wording::MODEL_WORDS);
        let made = Made::new(&StudyFacts::of(study), report::study(study, origin))?;
        Ok(FoundStudy {
            made: made.with_document(document::json(study, None)),
            model: model.map(|model| model.to_json().map_err(Error::internal)).transpose()?,
            series: ::study::series(study),
        })
    }

    pub(crate) fn into_python(self, py: Python<'_>) -> PyResult<Studied<'_>> {
        let series = self.series.map(|series| Recording::made(py, series, "series"));
        Ok((Bound::new(py, self.made)?, self.model, series.transpose()?))
    }
}

/// The study of a study.json, with the table of series beside it.
#[pyfunction]
pub(crate) fn read_study(py: Python<'_>, path: PathBuf) -> Result<Studied<'_>, Fault> {
    let found = interrupt::run(py, None, None, |context| {
        let StudyFile { study, origin, unread } = StudyFile::load(&path, &files(false), context)?;
        let found = FoundStudy::of(&study, &origin)?;
        let note = unread.map(|(table, why)| format!("{}: {why}; the curves are left out", table.display()));
        Ok::<_, Error>(FoundStudy { made: found.made.with_notes(note), ..found })
    })??;
    Ok(found.into_python(py)?)
}
