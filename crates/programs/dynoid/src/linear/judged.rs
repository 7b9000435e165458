//! Linear models on recordings: compared, tested, simulated and predicted.

use std::num::NonZeroUsize;

use ident::uncertainty::Dynamics;
use ident::validate::{Judgement, ResidualReport, ResidualTest, TestData, judge};
use ident::{Dataset, IdentError, InitialState, ModelDocument};
use page::Page;
use recording::Recording;
use toolbox_report::compare::{self, Met, MetFacts};
use toolbox_report::operating_point::hint;
use toolbox_report::residuals::{self, REGION, ResidualFacts};
use toolbox_report::response::{Responded, ResponseFacts};
use toolbox_report::words::growing_pole;
use work::Context;

use super::loaded::Loaded;
use super::meet::{MeetOptions, NamedModel};
use super::note::Note;
use super::operating_point::taken_off;
use super::recorded::RecordedFiles;
use super::response::{beside_measured, recording_of};
use super::sources::which_data;
use crate::error::Error;
use crate::files::Files;

/// Adds what was not noted before.
fn note(new: impl IntoIterator<Item = Note>, notes: &mut Vec<Note>) {
    for one in new {
        if !notes.contains(&one) {
            notes.push(one);
        }
    }
}

/// That a horizon reaches beyond every recording.
fn beyond(horizon: Option<usize>, data: &Dataset) -> Option<Note> {
    let longest = data.experiments().iter().map(|e| e.len()).max().unwrap_or(0);
    let horizon = horizon.filter(|horizon| *horizon >= longest)?;
    let text = format!("no recording has more than {longest} samples: {horizon} samples ahead is a simulation");
    Some(Note::Warning(text))
}

/// Linear models, compared on the same recordings.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedModels {
    all: Vec<Met>,
}

impl ComparedModels {
    /// Compares models by their predictions so many samples ahead, or by their simulations where there is no `horizon`.
    /// The recordings are read once. `notes` gets notes on the data, those before an error too.
    ///
    /// # Errors
    /// Recordings that cannot be read, or that do not have a model's channels.
    pub fn of(
        models: &[NamedModel],
        options: &MeetOptions,
        horizon: Option<NonZeroUsize>,
        files: &Files,
        context: &Context,
        notes: &mut Vec<Note>,
    ) -> Result<Self, Error> {
        let horizon = horizon.map(NonZeroUsize::get);
        let documents: Vec<&ModelDocument> = models.iter().map(|model| &model.document).collect();
        let (mut read, mut all): (Option<RecordedFiles>, _) = (None, Vec::new());
        for NamedModel { name, document } in models {
            let recorded = match read.take() {
                Some(recorded) if recorded.serves(options.row_time_s(document)) => recorded,
                _ => options.read(&documents, document, files, context)?,
            };
            let Loaded { data, notes: of_data, .. } = options.meet(document, &recorded)?;
            read = Some(recorded);
            note(of_data.into_iter().chain(beyond(horizon, &data)), notes);
            let judged = judge(&document.model, &data, horizon, &InitialState::Estimated);
            note(doubt(name, document, &data, &judged, options, horizon), notes);
            all.push(Met { model: name.clone(), data, judged });
        }
        Ok(ComparedModels { all })
    }

    /// The models on the recordings.
    pub fn all(&self) -> &[Met] {
        &self.all
    }

    /// Models that cannot be compared, with the reasons. One leaves the others their comparison.
    pub fn failures(&self) -> impl Iterator<Item = (&str, &IdentError)> {
        self.all.iter().filter_map(|met| Some((met.model.as_str(), met.judged.as_ref().err()?)))
    }

    /// The comparison as a page.
    pub fn page(&self) -> Page {
        compare::page(&self.all)
    }

    /// The comparison in numbers, one entry a model.
    pub fn facts(&self) -> Vec<MetFacts> {
        self.all.iter().map(Met::facts).collect()
    }
}

/// That a simulation runs away, or that the recordings rest elsewhere than the model.
fn doubt(
    name: &str,
    document: &ModelDocument,
    data: &Dataset,
    judged: &Result<Judgement, IdentError>,
    options: &MeetOptions,
    horizon: Option<usize>,
) -> Option<Note> {
    let growing = || document.model.system().and_then(|system| system.growing_mode()).ok().flatten();
    if let Some(mode) = horizon.is_none().then(growing).flatten() {
        let pole = growing_pole(&mode);
        return Some(Note::RunsAway(format!("{name} is not stable ({pole}): its simulation runs away")));
    }
    let hint = hint(document, data, &judged.as_ref().ok()?.response, taken_off(options.trend))?;
    Some(Note::Warning(format!("{name}: {hint}")))
}

/// Residuals of a linear model on recordings, tested.
#[derive(Debug, Clone, PartialEq)]
pub struct TestedResiduals {
    report: ResidualReport,
    data: Dataset,
}

impl TestedResiduals {
    /// Tests the residuals of a model up to so many lags. `notes` gets notes on the data, those before an error too.
    ///
    /// # Errors
    /// Recordings that cannot be read, or that do not have the model's channels, and lags for which they are too short.
    pub fn of(
        document: &ModelDocument,
        options: &MeetOptions,
        lags: usize,
        files: &Files,
        context: &Context,
        notes: &mut Vec<Note>,
    ) -> Result<Self, Error> {
        let recorded = options.read(&[document], document, files, context)?;
        let Loaded { data, notes: of_data, sources, .. } = options.meet(document, &recorded)?;
        note(of_data, notes);
        if lags == 0 || lags > data.samples() / 4 {
            return Err(Error::LagsOfTest { lags, samples: data.samples() });
        }
        let failed = |source| Error::identify("the residual test", source);
        let predicted = judge(&document.model, &data, Some(1), &InitialState::Estimated).map_err(failed)?;
        let hint = hint(document, &data, &predicted.response, taken_off(options.trend));
        note(hint.map(Note::Warning), notes);
        let test = ResidualTest { lags, level: REGION, ..ResidualTest::default() };
        let report = match &document.estimate {
            Some(estimate) => {
                document.fit().and_then(|fit| test.run(&fit, &data, which_data(&sources, &estimate.sources)))
            }
            None => test.run_known(&document.model, &data),
        };
        Ok(TestedResiduals { report: report.map_err(failed)?, data })
    }

    /// The tests.
    pub fn report(&self) -> &ResidualReport {
        &self.report
    }

    /// The tests as a page.
    pub fn page(&self) -> Page {
        residuals::page(&self.report, &self.data)
    }

    /// The tests in numbers.
    pub fn facts(&self) -> ResidualFacts {
        ResidualFacts::of(&self.report, &self.data)
    }
}

/// Way in which a model responds to recordings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ResponseOptions {
    /// Number of samples that are predicted ahead; a simulation without it.
    pub horizon: Option<NonZeroUsize>,
    /// True where the model starts from rest; its initial state is fitted to the recorded outputs otherwise.
    pub from_rest: bool,
}

impl ResponseOptions {
    /// Word for the response.
    fn word(self) -> &'static str {
        if self.horizon.is_some() { "predicted" } else { "simulated" }
    }
}

/// Response of a linear model to recordings.
#[derive(Debug, Clone)]
pub struct ModelResponse {
    model: NamedModel,
    loaded: Loaded,
    judged: Judgement,
    what: &'static str,
}

impl ModelResponse {
    /// Predicts or simulates a model on recordings. A simulation needs recordings of the inputs alone. `notes` gets
    /// notes on the data, those before an error too.
    ///
    /// # Errors
    /// Recordings that cannot be read, or that do not have the model's channels.
    pub fn of(
        model: NamedModel,
        options: &MeetOptions,
        response: ResponseOptions,
        files: &Files,
        context: &Context,
        notes: &mut Vec<Note>,
    ) -> Result<Self, Error> {
        let (document, horizon) = (&model.document, response.horizon.map(NonZeroUsize::get));
        let recorded = options.read(&[document], document, files, context)?;
        let loaded = match horizon {
            Some(_) => options.meet(document, &recorded)?,
            None => options.meet_inputs(document, &recorded)?,
        };
        note(loaded.notes.iter().cloned().chain(beyond(horizon, &loaded.data)), notes);
        let initial = if response.from_rest { InitialState::Zero } else { InitialState::Estimated };
        let judged = judge(&document.model, &loaded.data, horizon, &initial);
        let judged = judged.map_err(|source| Error::identify("the response", source))?;
        let hint = hint(document, &loaded.data, &judged.response, taken_off(options.trend));
        note(hint.map(Note::Warning), notes);
        Ok(ModelResponse { what: response.word(), model, loaded, judged })
    }

    /// How well the response fits the recordings.
    pub fn judged(&self) -> &Judgement {
        &self.judged
    }

    /// The outputs of the model as a recording, with the levels put back.
    ///
    /// # Errors
    /// Levels that do not belong to the data.
    pub fn recording(&self) -> Result<Recording, Error> {
        recording_of(&self.model.document, &self.loaded, &self.judged.response.outputs, self.what)
            .map_err(|source| Error::identify("the response", source))
    }

    /// The recorded outputs, the response, and the first less the second as channels, with the levels put back.
    ///
    /// # Errors
    /// Levels that do not belong to the data.
    pub fn beside_measured(&self) -> Result<Recording, Error> {
        beside_measured(&self.model.document, &self.loaded, &self.judged.response.outputs, self.what)
            .map_err(|source| Error::identify("the response", source))
    }

    /// Tells whether the model was estimated from any part of these recordings.
    pub fn is_seen(&self) -> bool {
        let estimate = self.model.document.estimate.as_ref();
        estimate.is_some_and(|estimate| which_data(&self.loaded.sources, &estimate.sources) == TestData::Own)
    }

    /// The response as a page.
    pub fn page(&self) -> Page {
        self.responded().page()
    }

    /// The response in numbers, one entry a recording and output.
    pub fn facts(&self) -> Vec<ResponseFacts> {
        self.responded().facts()
    }

    fn responded(&self) -> Responded<'_> {
        Responded {
            model: &self.model.name,
            what: self.what,
            outputs: &self.model.document.outputs,
            data: &self.loaded.data,
            judged: &self.judged,
        }
    }
}
