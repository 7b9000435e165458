//! Estimates of linear models, judged on data.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use dataset::CommonClock;
use ident::uncertainty::Dynamics;
use ident::validate::TestData;
use ident::{
    AnyModel, Arx, ContinuousTransferFunction, Dataset, EstimateRecord, Fit, Focus, FormulaStructure, GreyBox,
    IdentError, Iv4, ModelDocument, Polynomial, ProcessFit, Source, StateSpacePem, Subspace,
};
use page::Page;
use toolbox_report::data::Purpose;
use toolbox_report::fit::{EstimateFacts, Estimated, Verdict};
use toolbox_report::operating_point::{TakenOff, hint};
use work::Context;

use super::data::DataOptions;
use super::faults::check_variation;
use super::gaps::Gaps;
use super::loaded::{Loaded, named};
use super::note::Note;
use super::operating_point;
use super::recorded::RecordedFiles;
use super::sources::which_data;
use crate::error::Error;
use crate::files::Files;
use crate::output::replace_file;

/// A method with its orders.
#[derive(Debug, Clone)]
pub enum Method {
    /// Least squares.
    Arx(Arx),
    /// Instrumental variables in four steps.
    InstrumentalVariables(Iv4),
    /// A polynomial model by the prediction-error method.
    Polynomial(Box<Polynomial>),
    /// A continuous transfer function.
    TransferFunction(Box<ContinuousTransferFunction>),
    /// A process model.
    Process(Box<ProcessFit>),
    /// State space, from a subspace method.
    StateSpace {
        /// The subspace method.
        subspace: Subspace,
        /// How the search goes on from there.
        search: Search,
    },
    /// A structure of formulas.
    GreyBox(Box<GreyBox<FormulaStructure>>),
}

/// A search that follows a subspace method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Search {
    /// None: the model of the subspace method is the result.
    None,
    /// For the smallest prediction error.
    Prediction,
    /// For the smallest simulation error.
    Simulation,
}

impl Method {
    /// The estimate from data.
    ///
    /// # Errors
    /// Data that allow none.
    fn fit(&self, data: &Dataset, context: &Context) -> Result<Fit<AnyModel>, IdentError> {
        match self {
            Method::Arx(arx) => arx.fit(data).map(|fit| fit.map(AnyModel::from)),
            Method::InstrumentalVariables(iv4) => iv4.fit(data).map(|fit| fit.map(AnyModel::from)),
            Method::Polynomial(polynomial) => polynomial.fit(data).map(|fit| fit.map(AnyModel::from)),
            Method::TransferFunction(options) => options.fit(data).map(|fit| fit.map(AnyModel::from)),
            Method::Process(options) => options.fit(data).map(|fit| fit.map(AnyModel::from)),
            Method::GreyBox(options) => options.fit(data).map(|fit| fit.map(AnyModel::from)),
            Method::StateSpace { subspace, search: Search::None } => {
                subspace.fit(data).map(|fit| fit.map(AnyModel::from))
            }
            Method::StateSpace { subspace, search } => {
                let _step = context.step("searching from a subspace model", 0);
                let pem = StateSpacePem::from_subspace(*subspace);
                let pem = if *search == Search::Simulation { pem.with_focus(Focus::Simulation) } else { pem };
                pem.fit(data).map(|fit| fit.map(AnyModel::from))
            }
        }
    }
}

/// Needs of a method, by which its data are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FitNeeds {
    /// True where the method looks at the simulated output alone, so that outputs may be slower than the inputs.
    pub sees_through: bool,
    /// Channels in which nothing may be missing.
    pub gaps: Gaps,
}

impl FitNeeds {
    /// Of a method that predicts.
    pub const PREDICTION: FitNeeds = FitNeeds { sees_through: false, gaps: Gaps::OfInputs };
    /// Of a method that simulates.
    pub const SIMULATION: FitNeeds = FitNeeds { sees_through: true, gaps: Gaps::OfInputs };

    /// The clock of its data where none is asked for.
    pub fn clock(self) -> CommonClock {
        if self.sees_through { CommonClock::Fastest } else { CommonClock::Slowest }
    }
}

/// Data that judge an estimate.
#[derive(Debug, Clone, PartialEq)]
pub enum Judging {
    /// Its own.
    Own,
    /// The rest of each recording, of which the estimate gets this first share.
    Split(f64),
    /// Other recordings.
    On(Vec<PathBuf>),
}

/// Data that an estimate rests on, and those that judge it besides.
#[derive(Debug, Clone)]
pub struct FitData {
    estimation: Loaded,
    unseen: Option<Loaded>,
}

impl FitData {
    /// Reads data; both kinds are cut where a method with these needs cannot go on.
    ///
    /// # Errors
    /// Files that cannot be read, and channels that make no data.
    pub fn read(
        options: &DataOptions,
        judging: &Judging,
        needs: FitNeeds,
        files: &Files,
        context: &Context,
    ) -> Result<Self, Error> {
        let whole = Loaded::take(&options.read(files, context)?, needs.clock(), options)?;
        Self::of(whole, options, judging, needs, files, context)
    }

    /// As [`FitData::read`], of data that were read with these options on [`FitNeeds::clock`]. Their notes are known
    /// even where those that judge cannot be read.
    ///
    /// # Errors
    /// Those of [`FitData::read`].
    pub fn of(
        whole: Loaded,
        options: &DataOptions,
        judging: &Judging,
        needs: FitNeeds,
        files: &Files,
        context: &Context,
    ) -> Result<Self, Error> {
        let (estimation, unseen) = match judging {
            Judging::Own => (whole, None),
            Judging::Split(share) => whole.split(*share).map(|(first, rest)| (first, Some(rest)))?,
            Judging::On(recordings) => {
                let unseen = unseen(&whole, options, recordings, files, context)?;
                (whole, Some(unseen))
            }
        };
        let mut estimation = estimation.cut_at(needs.gaps)?;
        // A prediction gets over a gap in the outputs.
        let unseen = unseen.map(|unseen| unseen.cut_at(Gaps::OfInputs)).transpose()?;
        let mut notes: Vec<Note> = Vec::new();
        let of_unseen = unseen.as_ref().map(|unseen| unseen.notes.as_slice()).unwrap_or_default();
        for note in estimation.notes.iter().chain(of_unseen) {
            if !notes.contains(note) {
                notes.push(note.clone());
            }
        }
        estimation.notes = notes;
        Ok(FitData { estimation, unseen })
    }

    /// The data that the estimate rests on.
    pub fn estimation(&self) -> &Dataset {
        &self.estimation.data
    }

    /// Notes on the data.
    pub fn notes(&self) -> &[Note] {
        &self.estimation.notes
    }
}

/// Recordings that judge an estimate, at the operating point of its own data.
fn unseen(
    whole: &Loaded,
    options: &DataOptions,
    recordings: &[PathBuf],
    files: &Files,
    context: &Context,
) -> Result<Loaded, Error> {
    // The window belongs to the recordings of the estimate, the clock to both.
    let clock_s = whole.data.sample_time_s();
    let row_time_s = options.sample_time_s.unwrap_or(clock_s);
    let options = DataOptions { from_s: None, to_s: None, sample_time_s: Some(clock_s), ..options.clone() };
    let names: Vec<&str> = options.inputs.iter().chain(&options.outputs).map(String::as_str).collect();
    let read = RecordedFiles::read(recordings, &names, Some(row_time_s), files, context)?;
    let about = |_: &_, sources: &_| operating_point::of_data(whole.trend.as_ref(), &whole.sources, sources);
    let mut unseen = Loaded::take_about(&read, CommonClock::Slowest, &options, Purpose::Judgement, about)?;
    let is_used = |source: &&Source| whole.sources.iter().any(|used| used.sha256 == source.sha256);
    for source in unseen.sources.iter().filter(is_used) {
        let text = format!("{}: the estimate rests on this recording too, so it is no unseen one", source.file);
        unseen.notes.push(Note::Warning(text));
    }
    Ok(unseen)
}

/// An estimate of a linear model, with its judgement.
pub struct LinearFit {
    estimated: Estimated,
    notes: Vec<Note>,
    /// Data on which the model is shown.
    shown: Dataset,
    hint: Option<String>,
}

impl LinearFit {
    /// Estimates a model by a method with this name, such as `ARX na 2 nb 2 nk 1`, and judges it.
    ///
    /// # Errors
    /// Data that allow no estimate.
    pub fn of(data: FitData, method: &Method, name: &str, context: &Context) -> Result<Self, Error> {
        let FitData { estimation, unseen } = data;
        check_variation(&estimation)?;
        let step = context.step("identifying", 2);
        let estimating = step.step(format!("estimating {name}"), 0);
        let fit = method.fit(&estimation.data, &estimating);
        drop(estimating);
        let mut fit = fit.map_err(|source| {
            let data = named(&estimation.data, &estimation.sources);
            Error::NotEstimated { data, source }
        })?;
        let (estimation, unseen) = operating_point::with_levels(&fit, estimation, unseen)?;
        let judging = step.step("judging the model", 0);
        let others: Option<(&Dataset, TestData)> =
            unseen.as_ref().map(|unseen| (&unseen.data, which_data(&unseen.sources, &estimation.sources)));
        let verdict = Verdict::new(&fit, &estimation.data, others);
        drop((judging, step));
        fit.doubts.extend(verdict.doubts());
        let document = document(&fit, fitted(name, &fit.model), &estimation);
        let estimated = Estimated { document, fit, verdict, experiments: estimation.data.experiments().len() };
        let hint = unseen.as_ref().and_then(|unseen| {
            hint(&estimated.document, &unseen.data, estimated.verdict.simulated()?, TakenOff::OfModel)
        });
        let shown = unseen.map_or(estimation.data, |unseen| unseen.data);
        Ok(LinearFit { estimated, notes: estimation.notes, shown, hint })
    }

    /// The model as a model file holds it.
    pub fn document(&self) -> &ModelDocument {
        &self.estimated.document
    }

    /// The estimate, with covariance and doubts.
    pub fn fit(&self) -> &Fit<AnyModel> {
        &self.estimated.fit
    }

    /// The judgement.
    pub fn verdict(&self) -> &Verdict {
        &self.estimated.verdict
    }

    /// Hint where unseen data rest elsewhere than those of the estimate.
    pub fn hint(&self) -> Option<&str> {
        self.hint.as_deref()
    }

    /// Natural frequencies of the poles of a continuous model, Hz, the slowest first.
    ///
    /// # Errors
    /// A model without poles that can be computed.
    pub fn natural_frequencies_hz(&self) -> Result<Vec<f64>, Error> {
        let poles = self.fit().model.system().and_then(|system| system.poles());
        let poles = poles.map_err(|source| Error::identify("the response", source.into()))?;
        let mut all: Vec<f64> = poles.iter().map(|pole| pole.norm() / TAU).collect();
        all.sort_by(f64::total_cmp);
        Ok(all)
    }

    /// Tells whether a pole is where an integrator has it.
    pub fn integrates(&self) -> bool {
        let Ok(system) = self.fit().model.system() else { return false };
        let Ok(poles) = system.poles() else { return false };
        let largest = poles.iter().map(|p| p.norm()).fold(0.0, f64::max);
        let place = if system.sample_time_s().is_some() { 1.0 } else { 0.0 };
        poles.iter().any(|p| (p - place).norm() <= 1e-9 * largest)
    }

    /// The text of the model's file.
    ///
    /// # Errors
    /// A fault of dynoid.
    pub fn model_file(&self) -> Result<String, Error> {
        serde_json::to_string_pretty(self.document()).map_err(Error::internal)
    }

    /// The estimate as a page.
    pub fn page(&self) -> Page {
        self.estimated.page(&self.shown)
    }

    /// The estimate in numbers.
    pub fn facts(&self) -> EstimateFacts {
        self.estimated.facts(self.notes.iter().map(|note| note.text().to_owned()).collect())
    }

    /// Writes the model's file, which [`crate::check_model_file`] has checked before the work.
    ///
    /// # Errors
    /// A file that must stay, and a place where nothing can be written.
    pub fn write(&self, path: &Path, files: &Files) -> Result<(), Error> {
        replace_file(path, self.model_file()?.as_bytes(), files)
    }
}

fn document(fit: &Fit<AnyModel>, method: String, data: &Loaded) -> ModelDocument {
    let (inputs, outputs) = (data.data.input_labels().to_vec(), data.data.output_labels().to_vec());
    let mut document = ModelDocument::new(fit.model.clone(), inputs, outputs, data.data.sample_time_s());
    document.intersample = data.between;
    document.trend = data.trend.clone();
    document.estimate = Some(EstimateRecord::new(fit, method, data.sources.clone()));
    document
}

/// The method with the orders that the model came to have, the usual ones included.
fn fitted(name: &str, model: &AnyModel) -> String {
    let list = |values: Vec<usize>| values.iter().map(ToString::to_string).collect::<Vec<_>>().join(" ");
    match model {
        AnyModel::Polynomial(model) => {
            let Some(e) = model.equations().first() else { return name.to_owned() };
            let method = match name.split(" n").next().unwrap_or(name) {
                // Without inputs the X goes.
                "ARX" if model.inputs() == 0 => "AR",
                "ARMAX" if model.inputs() == 0 => "ARMA",
                name => name,
            };
            let lengths = |lists: &[Vec<f64>]| list(lists.iter().map(Vec::len).collect());
            let orders = [
                ("na", lengths(&e.a)),
                ("nb", lengths(&e.b)),
                ("nc", e.c.len().to_string()),
                ("nd", e.d.len().to_string()),
                ("nf", lengths(&e.f)),
                ("nk", list(e.nk.clone())),
            ];
            let is_there = |text: &str| text.split(' ').any(|n| n != "0" && !n.is_empty());
            let orders = orders.iter().filter(|(name, text)| (*name == "nk" && !text.is_empty()) || is_there(text));
            orders.fold(method.to_owned(), |text, (name, order)| format!("{text} {name} {order}"))
        }
        AnyModel::StateSpace(model) => {
            let method = name.split(", order").next().unwrap_or(name);
            format!("{method}, order {}", model.system().states())
        }
        _ => name.to_owned(),
    }
}

impl Loaded {
    /// The first part of each recording, and the rest.
    fn split(self, share: f64) -> Result<(Loaded, Loaded), Error> {
        let split = self.data.split(share).map_err(|source| Error::identify("splitting the data", source))?;
        let part = |data: Dataset| {
            // A recording too short to give a part has no experiment there.
            let is_there = |index: &usize| {
                let name = &self.data.experiments()[*index].name;
                data.experiments().iter().any(|e| e.name == *name)
            };
            let recording: Vec<usize> = self.recording.iter().copied().filter(is_there).collect();
            let mut sources = self.sources.clone();
            for (experiment, of) in data.experiments().iter().zip(&recording) {
                sources[*of].from_s = experiment.start_s;
                sources[*of].to_s =
                    experiment.start_s + experiment.len().saturating_sub(1) as f64 * data.sample_time_s();
            }
            let (trend, adjustments, notes) = (self.trend.clone(), self.adjustments.clone(), self.notes.clone());
            Loaded { data, between: self.between, trend, sources, recording, adjustments, notes }.without_unused()
        };
        Ok((part(split.estimation)?, part(split.validation)?))
    }
}
