//! Inputs and outputs on one clock: what estimators are given.

use ::dataset::{CommonClock, DatasetOptions};
use faer::Mat;
use ident::{Experiment, Intersample, Label, Source, Split, Trend, TrendScope, TrendShape};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use serde_json::json;
use toolbox_report::data::{Purpose, adjustment};

use crate::arrays::{Columns, matrix, vector};
use crate::content::ContentHash;
use crate::errors::Fault;
use crate::interrupt;
use crate::recording::Recording;

/// One name or several.
#[derive(FromPyObject)]
pub(crate) enum Names {
    One(String),
    Several(Vec<String>),
}

impl Names {
    fn list(self) -> Vec<String> {
        match self {
            Names::One(name) => vec![name],
            Names::Several(names) => names,
        }
    }
}

/// Inputs and outputs on one clock, of one experiment or several.
#[pyclass(frozen, module = "dynoid")]
#[derive(Clone)]
pub(crate) struct Dataset {
    pub(crate) data: ident::Dataset,
    /// Course of the inputs between the samples of their recordings.
    pub(crate) between: Intersample,
    pub(crate) trend: Option<Trend>,
    /// The recordings: the name of the experiment, and the hash of the file.
    files: Vec<(String, ContentHash)>,
    notes: Vec<String>,
}

/// Arguments of a dataset of recordings.
pub(crate) struct DatasetArguments<'a> {
    pub(crate) y: Names,
    pub(crate) u: Option<Names>,
    pub(crate) sample_time: Option<f64>,
    pub(crate) start: Option<f64>,
    pub(crate) end: Option<f64>,
    pub(crate) clock: &'a str,
    pub(crate) between: &'a str,
    pub(crate) detrend: Option<&'a str>,
}

/// Inputs and outputs of several recordings, one experiment a recording.
#[pyfunction]
#[pyo3(signature = (recordings, y, u=None, *, sample_time=None, start=None, end=None, clock="slowest", between="held", detrend=None))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn dataset(
    py: Python<'_>,
    recordings: Vec<Bound<'_, Recording>>,
    y: Names,
    u: Option<Names>,
    sample_time: Option<f64>,
    start: Option<f64>,
    end: Option<f64>,
    clock: &str,
    between: &str,
    detrend: Option<&str>,
) -> Result<Dataset, Fault> {
    Dataset::of(py, &recordings, DatasetArguments { y, u, sample_time, start, end, clock, between, detrend })
}

impl Dataset {
    /// Inputs and outputs of recordings.
    pub(crate) fn of(
        py: Python<'_>,
        recordings: &[Bound<'_, Recording>],
        arguments: DatasetArguments<'_>,
    ) -> Result<Self, Fault> {
        let usual =
            one_of("clock", arguments.clock, &[("slowest", CommonClock::Slowest), ("fastest", CommonClock::Fastest)])?;
        let between = intersample(arguments.between)?;
        let shape = arguments.detrend.map(trend_shape).transpose()?;
        let options = DatasetOptions {
            inputs: arguments.u.map_or_else(Vec::new, Names::list),
            outputs: arguments.y.list(),
            from_s: arguments.start,
            to_s: arguments.end,
            clock: arguments.sample_time.map_or(usual, CommonClock::Every),
            intersample: between,
        };
        let wanted: Vec<&str> = options.inputs.iter().chain(&options.outputs).map(String::as_str).collect();
        let decoded: Vec<_> = recordings.iter().map(|r| r.get().decoded(py, &wanted)).collect::<PyResult<_>>()?;
        let files: Vec<_> = recordings.iter().map(|recording| recording.get().source()).collect();
        let named: Vec<_> = files.iter().map(|(name, _)| name.as_str()).zip(&decoded).collect();
        let (data, adjustments) = interrupt::quietly(py, || ::dataset::dataset(&named, &options))??;
        let given = arguments.sample_time.is_some();
        let notes = adjustments.iter().map(|a| adjustment(a, Purpose::Estimate(shape), given)).collect();
        let whole = Dataset { data, between, trend: None, files, notes };
        shape.map_or(Ok(whole.clone()), |shape| whole.without_trend(shape))
    }

    fn without_trend(&self, shape: TrendShape) -> Result<Self, Fault> {
        if self.trend.is_some() {
            return Err(Fault::argument("the trend is taken off already; take it off once, before anything else"));
        }
        let trend = Trend::estimate(&self.data, shape, TrendScope::PerExperiment)?;
        Ok(Dataset { data: trend.remove(&self.data)?, trend: Some(trend), ..self.clone() })
    }

    /// The same channels with other data.
    pub(crate) fn with(&self, data: ident::Dataset) -> Self {
        Dataset { data, ..self.clone() }
    }

    /// Where each experiment comes from, if it is of a file.
    pub(crate) fn sources(&self) -> Vec<Source> {
        let source = |e: &Experiment| {
            let of_it = self.files.iter().filter(|(name, _)| *name == e.name);
            let (file, sha256) = of_it.map(|(name, hash)| (name, hash.known())).find(|(_, hash)| !hash.is_empty())?;
            let to_s = e.start_s + e.len().saturating_sub(1) as f64 * self.data.sample_time_s();
            Some(Source { file: file.clone(), sha256, from_s: e.start_s, to_s })
        };
        self.data.experiments().iter().filter_map(source).collect()
    }

    /// The recording of every experiment; without a hash where it is of no file.
    pub(crate) fn sources_of_all(&self) -> Vec<Source> {
        let known = self.sources();
        let of = |e: &Experiment| known.iter().find(|source| source.file == e.name).cloned();
        let none = || Source { file: String::new(), sha256: String::new(), from_s: 0.0, to_s: 0.0 };
        self.data.experiments().iter().map(|e| of(e).unwrap_or_else(none)).collect()
    }

    /// The rows of all experiments, one after the other.
    fn rows(&self, of: impl Fn(&Experiment) -> &Mat<f64>, columns: usize) -> Mat<f64> {
        let mut all = Mat::zeros(self.data.samples(), columns);
        let mut first = 0;
        for experiment in self.data.experiments() {
            for (k, t) in (0..columns).flat_map(|k| (0..experiment.len()).map(move |t| (k, t))) {
                all[(first + t, k)] = of(experiment)[(t, k)];
            }
            first += experiment.len();
        }
        all
    }

    fn parts(&self, split: Split) -> (Self, Self) {
        (self.with(split.estimation), self.with(split.validation))
    }
}

#[pymethods]
impl Dataset {
    /// Data of arrays: samples × channels, the samples of one channel, or a dictionary of channels by their names.
    #[new]
    #[pyo3(signature = (y, u=None, *, sample_time, start=0.0, between="held", name="1"))]
    fn new(
        y: &Bound<'_, PyAny>,
        u: Option<&Bound<'_, PyAny>>,
        sample_time: f64,
        start: f64,
        between: &str,
        name: &str,
    ) -> Result<Self, Fault> {
        let outputs = Columns::of("y", y)?;
        let inputs = match u {
            Some(u) => Columns::of("u", u)?,
            None => Columns { names: None, values: Mat::zeros(outputs.values.nrows(), 0) },
        };
        let between = intersample(between)?;
        let data = ident::Dataset::new(sample_time, inputs.values, outputs.values)?.with_intersample(between);
        let labels = |given: Option<Vec<Label>>, usual: &[Label]| given.unwrap_or_else(|| usual.to_vec());
        let inputs = labels(inputs.names, data.input_labels());
        let outputs = labels(outputs.names, data.output_labels());
        let data = data.with_labels(inputs, outputs)?;
        let data = data.map_experiments(|e| Ok(Experiment { name: name.to_owned(), start_s: start, ..e.clone() }))?;
        Ok(Dataset { data, between, trend: None, files: Vec::new(), notes: Vec::new() })
    }

    /// Sample time, s.
    #[getter]
    fn sample_time(&self) -> f64 {
        self.data.sample_time_s()
    }

    /// Samples, over all experiments.
    #[getter]
    fn samples(&self) -> usize {
        self.data.samples()
    }

    /// Names of the inputs.
    #[getter]
    fn inputs(&self) -> Vec<&str> {
        self.data.input_labels().iter().map(|label| label.name.as_str()).collect()
    }

    /// Names of the outputs.
    #[getter]
    fn outputs(&self) -> Vec<&str> {
        self.data.output_labels().iter().map(|label| label.name.as_str()).collect()
    }

    /// Units by the names of the channels; empty where unknown.
    #[getter]
    fn units(&self) -> std::collections::BTreeMap<&str, &str> {
        let labels = self.data.input_labels().iter().chain(self.data.output_labels());
        labels.map(|label| (label.name.as_str(), label.unit.as_str())).collect()
    }

    /// The experiments, each as data of its own.
    #[getter]
    fn experiments(&self) -> Result<Vec<Self>, Fault> {
        let one = |index| Ok(self.with(self.data.only_experiments(&[index])?));
        (0..self.data.experiments().len()).map(one).collect()
    }

    /// Names of the experiments.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.data.experiments().iter().map(|e| e.name.as_str()).collect()
    }

    /// Instants, s: those of one experiment after those of another.
    #[getter]
    fn time<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let step_s = self.data.sample_time_s();
        let times = |e: &Experiment| (0..e.len()).map(|t| e.start_s + t as f64 * step_s).collect::<Vec<_>>();
        vector(py, self.data.experiments().iter().flat_map(times).collect())
    }

    /// Inputs, samples × channels.
    #[getter]
    fn u<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.rows(|e| &e.inputs, self.data.inputs()).as_ref())
    }

    /// Outputs, samples × channels.
    #[getter]
    fn y<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.rows(|e| &e.outputs, self.data.outputs()).as_ref())
    }

    /// Notes on what was done to the channels on the way to one clock.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.notes.clone()
    }

    /// The first part of every experiment to estimate on, and the rest to judge on.
    fn split(&self, fraction: f64) -> Result<(Self, Self), Fault> {
        Ok(self.parts(self.data.split(fraction)?))
    }

    /// The data without the mean (`"mean"`) or the straight line (`"line"`) of every experiment.
    #[pyo3(signature = (shape="mean"))]
    fn detrend(&self, shape: &str) -> Result<Self, Fault> {
        self.without_trend(trend_shape(shape)?)
    }

    /// The data on a sample time that is `down` / `up` times as long.
    fn resample(&self, up: usize, down: usize) -> Result<Self, Fault> {
        Ok(self.with(self.data.resample(up, down)?))
    }

    /// The stretches without missing samples, each an experiment of at least this length.
    fn without_gaps(&self, shortest: usize) -> Result<Self, Fault> {
        Ok(self.with(self.data.without_gaps(shortest)?))
    }

    /// The data with gaps of up to this length filled on straight lines.
    fn fill_gaps(&self, longest: usize) -> Result<Self, Fault> {
        Ok(self.with(self.data.fill_gaps(longest)?))
    }

    /// The samples from one index to another of every experiment, the end left out.
    fn rows_between(&self, first: usize, end: usize) -> Result<Self, Fault> {
        Ok(self.with(self.data.rows(first..end)?))
    }

    /// The experiments of both.
    fn __add__(&self, other: &Bound<'_, Self>) -> Result<Self, Fault> {
        let other = other.get();
        if self.trend.is_some() || other.trend.is_some() {
            return Err(Fault::argument("data without their trend cannot be joined; join them first, then detrend"));
        }
        let mut joined = self.with(self.data.merge(&other.data)?);
        joined.files.extend(other.files.iter().cloned());
        joined.notes.extend(other.notes.iter().cloned());
        Ok(joined)
    }

    fn __len__(&self) -> usize {
        self.data.samples()
    }

    /// A pandas frame with the time in seconds as its index.
    fn to_pandas<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("dynoid.frames")?.getattr("dataset_to_pandas")?.call1((slf,))
    }

    fn __repr__(&self) -> String {
        let labels = |labels: &[Label]| {
            let written =
                |l: &Label| if l.unit.is_empty() { l.name.clone() } else { format!("{} [{}]", l.name, l.unit) };
            labels.iter().map(written).collect::<Vec<_>>().join(", ")
        };
        let inputs = match self.data.input_labels() {
            [] => "no input".to_owned(),
            inputs => format!("inputs {}", labels(inputs)),
        };
        let experiments = match self.data.experiments().len() {
            1 => String::new(),
            count => format!(" in {count} experiments"),
        };
        format!(
            "{} samples{experiments}, sample time {} s\n  outputs {}\n  {inputs}",
            self.data.samples(),
            self.data.sample_time_s(),
            labels(self.data.output_labels())
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, own) = (slf.py(), slf.get());
        let experiments = own.data.experiments();
        let state = json!({
            "sample_time_s": own.data.sample_time_s(),
            "intersample": own.data.intersample(),
            "inputs": own.data.input_labels(),
            "outputs": own.data.output_labels(),
            "between": own.between,
            "trend": own.trend,
            "files": own.files.iter().map(|(name, hash)| (name, hash.known())).collect::<Vec<_>>(),
            "notes": own.notes,
            "experiments": experiments.iter().map(|e| (&e.name, e.start_s)).collect::<Vec<_>>(),
        });
        let inputs: Vec<_> = experiments.iter().map(|e| matrix(py, e.inputs.as_ref())).collect();
        let outputs: Vec<_> = experiments.iter().map(|e| matrix(py, e.outputs.as_ref())).collect();
        let state = (state.to_string(), inputs, outputs);
        (slf.get_type().getattr("_restored")?, state).into_pyobject(py).map(Bound::into_any)
    }

    #[staticmethod]
    fn _restored(state: &str, inputs: Vec<Bound<'_, PyAny>>, outputs: Vec<Bound<'_, PyAny>>) -> Result<Self, Fault> {
        let state: State = serde_json::from_str(state).map_err(|error| Fault::argument(error.to_string()))?;
        let mut data: Option<ident::Dataset> = None;
        for ((name, start_s), (u, y)) in state.experiments.into_iter().zip(inputs.iter().zip(&outputs)) {
            let (inputs, outputs) = (Columns::of("u", u)?.values, Columns::of("y", y)?.values);
            data = Some(match data {
                None => ident::Dataset::new(state.sample_time_s, inputs, outputs)?
                    .map_experiments(|e| Ok(Experiment { name: name.clone(), start_s, ..e.clone() }))?,
                Some(data) => data.with_experiment(Experiment { name, start_s, inputs, outputs })?,
            });
        }
        let data = data.ok_or_else(|| Fault::argument("data without an experiment"))?;
        let data = data.with_intersample(state.intersample).with_labels(state.inputs, state.outputs)?;
        let files = state.files.into_iter().map(|(name, hash)| (name, ContentHash::known_as(hash))).collect();
        Ok(Dataset { data, between: state.between, trend: state.trend, files, notes: state.notes })
    }
}

/// Data without their samples.
#[derive(serde::Deserialize)]
struct State {
    sample_time_s: f64,
    intersample: Intersample,
    inputs: Vec<Label>,
    outputs: Vec<Label>,
    between: Intersample,
    trend: Option<Trend>,
    files: Vec<(String, String)>,
    notes: Vec<String>,
    experiments: Vec<(String, f64)>,
}

fn intersample(between: &str) -> Result<Intersample, Fault> {
    use Intersample::{BandLimited, FirstOrderHold, ZeroOrderHold};
    one_of("between", between, &[("held", ZeroOrderHold), ("straight", FirstOrderHold), ("band-limited", BandLimited)])
}

fn trend_shape(shape: &str) -> Result<TrendShape, Fault> {
    one_of("detrend", shape, &[("mean", TrendShape::Mean), ("line", TrendShape::Line)])
}

/// The choice of this name.
pub(crate) fn one_of<T: Copy>(argument: &str, given: &str, choices: &[(&str, T)]) -> Result<T, Fault> {
    let found = choices.iter().find(|(name, _)| *name == given);
    found.map(|(_, choice)| *choice).ok_or_else(|| {
        let names: Vec<String> = choices.iter().map(|(name, _)| format!("\"{name}\"")).collect();
        Fault::argument(format!("{argument}=\"{given}\": choose one of {}", names.join(", ")))
    })
}
