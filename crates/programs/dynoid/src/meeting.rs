//! One model on one recording: its fit, its residuals, and both courses beside each other.

use std::path::Path;

use ident::Label;
use recording::Recording;
use serde::Serialize;
use toolbox_report::residuals::ResidualFacts;
use work::Context;

use crate::error::Error;
use crate::files::Files;
use crate::linear::{MeetOptions, ModelResponse, NamedModel, Note, ResponseOptions, TestedResiduals};
use crate::models::{Model, model_name};
use crate::replay::{BenchModelFile, BenchReplays, ReplayOptions, ReplayedSignalFacts, ReplayedStretch};

/// Lags of the residual tests, as in `dynoid model residuals`.
const LAGS: usize = 25;
const UNTESTED: &str = "residual tests are of linear models";

/// A model on a recording.
#[derive(Debug, Clone)]
pub struct Meeting {
    facts: MeetingFacts,
    beside: Recording,
}

/// A model on a recording, in numbers.
#[derive(Debug, Clone, Serialize)]
pub struct MeetingFacts {
    model: String,
    /// True where the model was estimated from this recording too.
    seen_in_estimation: bool,
    /// The signals that are compared.
    signals: Vec<SignalFacts>,
    /// Tests of the residuals of a prediction by one sample; none where they cannot be tested.
    residuals: Option<ResidualFacts>,
    /// Reason why they are not tested.
    untested: Option<String>,
    /// Remarks on the data.
    notes: Vec<String>,
}

/// Fit of a signal.
#[derive(Debug, Clone, PartialEq, Serialize)]
struct SignalFacts {
    name: String,
    unit: String,
    /// Number of the part, from zero on, where gaps divide the recording.
    part: usize,
    fit_percent: f64,
    rms_error: f64,
}

impl MeetingFacts {
    /// Names of the signals that are compared.
    pub fn signals(&self) -> impl Iterator<Item = &str> {
        self.signals.iter().filter(|signal| signal.part == 0).map(|signal| signal.name.as_str())
    }
}

impl Meeting {
    /// Brings a recording to a model of either kind. A linear model responds as the options say; a bench model is
    /// simulated over the stretch that a study replays.
    ///
    /// # Errors
    /// Files that cannot be read, a recording without the channels of the model, and a model that does not respond.
    pub fn of(
        model: &Path,
        recording: &Path,
        response: ResponseOptions,
        files: &Files,
        context: &Context,
    ) -> Result<Self, Error> {
        match files.model(model)? {
            Model::Linear(document) => {
                let named = NamedModel { name: model_name(model), document: *document };
                of_linear(named, recording, response, files, context)
            }
            Model::Bench(document) => {
                let file = BenchModelFile { path: model.to_owned(), document: *document };
                of_bench(file, recording, files, context)
            }
        }
    }

    /// The meeting in numbers.
    pub fn facts(&self) -> &MeetingFacts {
        &self.facts
    }

    /// Of each signal three channels: measured, modelled, and the first less the second.
    pub fn beside(&self) -> &Recording {
        &self.beside
    }
}

fn of_linear(
    named: NamedModel,
    recording: &Path,
    response: ResponseOptions,
    files: &Files,
    context: &Context,
) -> Result<Meeting, Error> {
    let (options, mut notes) = (MeetOptions::of(&[recording.to_owned()]), Vec::new());
    let tests = TestedResiduals::of(&named.document, &options, LAGS, files, context, &mut Vec::new());
    let (model, outputs) = (named.name.clone(), named.document.outputs.clone());
    let found = ModelResponse::of(named, &options, response, files, context, &mut notes)?;
    let judged = found.judged();
    let parts = judged.fit_percent.iter().zip(&judged.rms_error).enumerate();
    let signals = parts.flat_map(|(part, (fits, errors))| {
        let of_output = move |((label, fit), error): ((&Label, &f64), &f64)| SignalFacts {
            name: label.name.clone(),
            unit: label.unit.clone(),
            part,
            fit_percent: *fit,
            rms_error: *error,
        };
        outputs.iter().zip(fits).zip(errors).map(of_output)
    });
    let (residuals, untested) = match tests {
        Ok(tests) => (Some(tests.facts()), None),
        Err(reason) => (None, Some(reason.to_string())),
    };
    let facts = MeetingFacts {
        model,
        seen_in_estimation: found.is_seen(),
        signals: signals.collect(),
        residuals,
        untested,
        notes: texts(&notes),
    };
    Ok(Meeting { facts, beside: found.beside_measured()? })
}

fn of_bench(model: BenchModelFile, recording: &Path, files: &Files, context: &Context) -> Result<Meeting, Error> {
    let recordings = vec![recording.to_owned()];
    let options = ReplayOptions { recordings, stretch: ReplayedStretch::AsStudy, bench: None, mode: None };
    let (models, mut notes) = ([model], Vec::new());
    let found = BenchReplays::of(&models, &options, files, context, &mut notes)?;
    let replay = found.facts().into_iter().next().ok_or(Error::NothingToSimulateOn)?;
    let signal = |signal: ReplayedSignalFacts| SignalFacts {
        name: signal.quantity,
        unit: signal.unit,
        part: 0,
        fit_percent: signal.fit_percent,
        rms_error: signal.rms_error,
    };
    let facts = MeetingFacts {
        model: model_name(&models[0].path),
        seen_in_estimation: replay.seen_in_estimation,
        signals: replay.signals.into_iter().map(signal).collect(),
        residuals: None,
        untested: Some(UNTESTED.to_owned()),
        notes: texts(&notes),
    };
    Ok(Meeting { facts, beside: found.beside_measured() })
}

fn texts(notes: &[Note]) -> Vec<String> {
    notes.iter().map(|note| note.text().to_owned()).collect()
}
