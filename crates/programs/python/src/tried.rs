//! Tests and experiments that are tried on a bench as far as it is known.

use std::collections::BTreeMap;
use std::path::PathBuf;

use ::capability::document::VERDICT;
use ::capability::wanted::Wanted as Wish;
use ::design::excitation_design::Goal;
use ::design::safety::SafetyCheck;
use bench_model::document::BenchModelDocument;
use dynoid::can::{Capability, CapabilityOptions, JudgedRun, Predicted, Requirements, Test, TestOptions};
use dynoid::experiments::{
    CheckedExperiment, DemandForm, DesignedExperiment, Given, OptimalOptions, PlanDoubt, Planned, SimulatedExperiment,
};
use dynoid::{Draws, Error, KnownBench};
use pyo3::prelude::*;
use work::Context;

use crate::bench::Bench;
use crate::errors::Fault;
use crate::made::{Made, files};
use crate::recording::Recording;

/// The model that a bench is known by: a file, or the text of one.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Model {
    pub(crate) path: Option<PathBuf>,
    text: Option<String>,
}

/// Benches that are drawn, and the numbers of an experiment.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Tried {
    name: String,
    numbers: BTreeMap<String, String>,
    benches: usize,
    seed: u64,
}

/// Files of a test, and its requirements.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Wanted {
    engine_map: Option<PathBuf>,
    idle: Option<f64>,
    vehicle: Option<PathBuf>,
    by: Vec<String>,
    require: Vec<String>,
}

/// Choices of an optimal excitation.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Optimal {
    goals: Vec<String>,
    form: String,
    peak_shaft_torque: Option<f64>,
    peak_torque: Option<f64>,
    peak_speed: Option<f64>,
}

impl Model {
    fn known(&self, bench: &dynoid::Bench) -> Result<KnownBench, Error> {
        match (&self.path, &self.text) {
            (None, None) => KnownBench::stated(bench),
            (None, Some(_)) => KnownBench::of(bench, self.document()?),
            (Some(path), _) => KnownBench::load(bench.path(), Some(path), &files(false)),
        }
    }

    /// The bench model.
    ///
    /// # Errors
    /// A file that cannot be read, and a text that is none.
    pub(crate) fn document(&self) -> Result<BenchModelDocument, Error> {
        if let Some(path) = &self.path {
            return files(false).bench_model(path);
        }
        let path = PathBuf::from("model");
        let wrong = |source| Error::BenchModel { path, source: ::study::BenchModelError::Document { source } };
        BenchModelDocument::from_json(self.text.as_deref().unwrap_or_default()).map_err(wrong)
    }
}

impl Tried {
    fn draws(&self) -> Draws {
        Draws { benches: self.benches, seed: self.seed }
    }

    fn given(&self) -> Vec<Given> {
        self.numbers.iter().map(|(name, value)| Given { name: name.clone(), value: value.clone() }).collect()
    }

    fn planned(&self, context: &Context) -> Result<Planned, Error> {
        Planned::find(&self.name, &self.given(), &files(false), context)
    }

    fn test(&self, wanted: &Wanted, context: &Context) -> Result<(Test, Requirements), Error> {
        let options = TestOptions {
            engine_map: wanted.engine_map.clone(),
            idle_rpm: wanted.idle,
            vehicle: wanted.vehicle.clone(),
            given: self.given(),
            seed: self.seed,
        };
        let test = Test::find(&self.name, &options, &files(false), context)?;
        let requirements = Requirements::of(&test, &wanted.by, &wanted.require)?;
        Ok((test, requirements))
    }
}

impl Optimal {
    fn options(&self) -> Result<OptimalOptions, Fault> {
        let goal = |text: &String| text.parse::<Goal>().map_err(|error| Fault::argument(format!("optimal: {error}")));
        let usual = OptimalOptions::of(self.goals.iter().map(goal).collect::<Result<_, _>>()?);
        let forms = [("multisine", DemandForm::Multisine), ("binary", DemandForm::Binary)];
        Ok(OptimalOptions {
            form: crate::dataset::one_of("form", &self.form, &forms)?,
            peak_shaft_torque_nm: self.peak_shaft_torque,
            peak_torque_nm: self.peak_torque,
            peak_speed_rpm: self.peak_speed.unwrap_or(usual.peak_speed_rpm),
            ..usual
        })
    }
}

/// Doubts about a plan and about the bench, in words.
fn doubts(planned: &Planned, name: &str, bench: &KnownBench) -> Vec<String> {
    let doubts = PlanDoubt::of(&planned.plan, bench.file()).into_iter().map(|doubt| match doubt.remedy() {
        Some(given) => format!("{doubt}, as with {}={}", given.name, given.value),
        None => doubt.to_string(),
    });
    doubts.chain(planned.remark(name)).chain(bench.doubt()).collect()
}

/// Predicts a test on benches drawn from what is known of this one.
#[pyfunction]
pub(crate) fn can(
    bench: &Bound<'_, Bench>,
    test: Tried,
    wanted: Wanted,
    model: Model,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> Result<Made, Fault> {
    bench.get().attempt(bench.py(), progress, threads, |bench, context| {
        let known = model.known(bench)?;
        let (found, requirements) = test.test(&wanted, context)?;
        let answer = Predicted::of(&known, &found, &requirements, test.draws(), context)?;
        let notes = found.remarks().iter().cloned().chain(known.doubt());
        let is_yes = answer.is_yes() && answer.unchecked().is_empty();
        let made = Made::whole(&answer.facts(), known.on_page(answer.page()), &VERDICT, answer.verdict())?;
        Ok(made.with_notes(notes).with_answer(is_yes))
    })
}

/// Judges a recorded run of a test.
#[pyfunction]
pub(crate) fn judge(
    bench: &Bound<'_, Bench>,
    recording: PathBuf,
    test: Tried,
    wanted: Wanted,
    start: Option<f64>,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> Result<Made, Fault> {
    bench.get().attempt(bench.py(), progress, threads, |bench, context| {
        let (found, requirements) = test.test(&wanted, context)?;
        let files = files(false);
        let run = JudgedRun::read(bench.path(), &recording, &found, &requirements, start, &files, context)?;
        let made = Made::new(&run.facts(), run.page())?;
        Ok(made.with_notes(found.remarks().iter().cloned()).with_answer(run.passes()))
    })
}

/// The largest sines and gradients that the bench can do.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn capability(
    bench: &Bound<'_, Bench>,
    speed: Option<f64>,
    torque: Option<f64>,
    want: Vec<String>,
    draws: (usize, u64),
    model: Model,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> Result<Made, Fault> {
    let mut options = CapabilityOptions::of(Draws { benches: draws.0, seed: draws.1 });
    options.speed_rpm = speed;
    options.torque_nm = torque.unwrap_or(options.torque_nm);
    let wanted = |text: &String| text.parse::<Wish>().map_err(|error| Fault::argument(format!("want: {error}")));
    options.wanted = want.iter().map(wanted).collect::<Result<_, _>>()?;
    bench.get().attempt(bench.py(), progress, threads, |bench, _| {
        let known = model.known(bench)?;
        let map = Capability::of(&known, options)?;
        let made = Made::new(&map.facts(), known.on_page(map.page()))?;
        Ok(made.with_notes(known.doubt()).with_answer(map.is_yes(false)))
    })
}

/// A result, the recording that belongs to it, and, where there is one, a second.
type WithRecordings<'py> = (Made, Bound<'py, Recording>, Option<Bound<'py, Recording>>);

/// The demands of an experiment, and the prediction of what the bench will do.
#[pyfunction]
pub(crate) fn design<'py>(
    bench: &Bound<'py, Bench>,
    experiment: Tried,
    optimal: Option<Optimal>,
    model: Model,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> Result<WithRecordings<'py>, Fault> {
    let optimal = optimal.map(|optimal| optimal.options()).transpose()?;
    let (made, demands, response) = bench.get().attempt(bench.py(), progress, threads, |bench, context| {
        let known = model.known(bench)?;
        let planned = match &optimal {
            Some(options) => Planned::optimal(&known, options, &experiment.given(), context)?,
            None => experiment.planned(context)?,
        };
        let notes = doubts(&planned, &experiment.name, &known);
        let designed = DesignedExperiment::of(&known, planned, experiment.seed, context);
        let unpredicted = designed.predicted().err().map(|reason| format!("nothing is predicted: {reason}"));
        let made = Made::new(&designed.facts(), known.on_page(designed.page()))?;
        let made = made.with_notes(notes.into_iter().chain(unpredicted));
        Ok((made, designed.recording(), designed.responses()))
    })?;
    let demands = Recording::made(bench.py(), demands, "demands")?;
    let response = response.map(|one| Recording::made(bench.py(), one, "predicted"));
    Ok((made, demands, response.transpose()?))
}

/// The probability that an experiment reaches each limit of the bench.
#[pyfunction]
pub(crate) fn check(
    bench: &Bound<'_, Bench>,
    experiment: Tried,
    model: Model,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> Result<Made, Fault> {
    bench.get().attempt(bench.py(), progress, threads, |bench, context| {
        let known = model.known(bench)?;
        let planned = experiment.planned(context)?;
        let notes = doubts(&planned, &experiment.name, &known);
        let found = CheckedExperiment::of(&known, planned.plan, experiment.draws(), context)?;
        let page = known.on_page(found.page());
        let made = Made::whole(&found.facts(), page, &SafetyCheck::DOCUMENT, found.check())?;
        Ok(made.with_notes(notes).with_answer(found.is_safe(false)))
    })
}

/// An experiment on the virtual bench of the bench file.
#[pyfunction]
pub(crate) fn simulate<'py>(
    bench: &Bound<'py, Bench>,
    experiment: Tried,
    truth: bool,
    model: Model,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> Result<WithRecordings<'py>, Fault> {
    let (made, run) = bench.get().attempt(bench.py(), progress, threads, |bench, context| {
        let known = model.known(bench)?;
        let planned = experiment.planned(context)?;
        let notes = doubts(&planned, &experiment.name, &known);
        let run = SimulatedExperiment::of(&known, &planned.plan, experiment.seed, truth, context)?;
        Ok((Made::new(&run.facts(), run.page())?.with_notes(notes), run))
    })?;
    let name = run.label().to_string();
    let recording = Recording::made(bench.py(), run.recording, &name)?;
    let truth = run.truth.map(|truth| Recording::made(bench.py(), truth, "truth"));
    Ok((made, recording, truth.transpose()?))
}
