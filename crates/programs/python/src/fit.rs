//! An estimate: the model, how certain it is, and what follows from it.

use std::ffi::CString;
use std::path::PathBuf;

use dynoid::linear::ConvertedModel;
use dynoid::linear::operating_point::{self, MeetingTrend};
use dynoid::{Kind, Mark, check_replaceable, replace_file};
use faer::Mat;
use ident::prediction::{InitialState, Response, predict, residuals, simulate};
use ident::uncertainty::{Dynamics, UncertainRoot};
use ident::validate::{Independence, JointTest, ResidualTest, TestData, Whiteness};
use ident::{
    AnyModel, EstimateRecord, Experiment, Fit as Estimate, IdentError, Label, Line, LinearModel, ModelDocument, Origin,
    Parametric, Trend,
};
use lti::{Complex64, Discretisation, TimeGrid};
use numerics::linalg::Cholesky;
use numpy::{PyArray1, PyArray2};
use pyo3::exceptions::PyUserWarning;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde::{Deserialize, Serialize};
use signal::excitation::Random;
use toolbox_report::convert::{Conversion, Form};

use crate::arrays::{bounds, matrix, numbers, vector};
use crate::dataset::{Dataset, one_of};
use crate::errors::Fault;
use crate::interrupt;
use crate::made::files;
use crate::results::{fields, result, to_python};

/// Numerator and denominator, in falling powers.
type Ratio<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>);

/// An estimate of a linear model.
#[pyclass(frozen, module = "dynoid")]
pub(crate) struct Fit {
    pub(crate) estimate: Estimate<AnyModel>,
    document: ModelDocument,
}

/// A channel by its name, or by its place from zero.
#[derive(FromPyObject)]
enum Which {
    Place(usize),
    Name(String),
}

/// The part of an estimate that a model file leaves out.
#[derive(Serialize, Deserialize)]
struct Kept {
    document: ModelDocument,
    levels: Vec<Vec<f64>>,
    origin: Option<Origin>,
}

impl Fit {
    /// An estimate from data, with the method in words.
    pub(crate) fn new(estimate: Estimate<AnyModel>, method: String, data: &Dataset) -> Self {
        let (inputs, outputs) = (data.data.input_labels().to_vec(), data.data.output_labels().to_vec());
        let mut document = ModelDocument::new(estimate.model.clone(), inputs, outputs, data.data.sample_time_s());
        document.intersample = data.between;
        document.trend = trend_of(&estimate, data);
        document.estimate = Some(EstimateRecord::new(&estimate, method, data.sources()));
        Fit { estimate, document }
    }

    fn of_document(document: ModelDocument) -> Result<Self, Fault> {
        let document = document.checked()?;
        Ok(Fit { estimate: document.fit()?, document })
    }

    /// The method and its orders, in words.
    pub(crate) fn method(&self) -> &str {
        self.document.estimate.as_ref().map_or("", |record| record.method.as_str())
    }

    fn by_name<'py, T: IntoPyObject<'py>>(&self, py: Python<'py>, values: Vec<T>) -> PyResult<Bound<'py, PyDict>> {
        let named = PyDict::new(py);
        for (name, value) in self.estimate.model.parameter_names().into_iter().zip(values) {
            named.set_item(name, value)?;
        }
        Ok(named)
    }

    fn output(&self, given: Option<Which>) -> Result<usize, Fault> {
        place("output", &self.document.outputs, given)
    }

    fn input(&self, given: Option<Which>) -> Result<usize, Fault> {
        place("input", &self.document.inputs, given)
    }

    /// Output of a model, for data about its offset.
    fn respond(
        &self,
        data: &Bound<'_, Dataset>,
        initial: &str,
        response: impl FnOnce(&AnyModel, &ident::Dataset, &InitialState) -> Result<Response, IdentError> + Send,
    ) -> Result<Response, Fault> {
        let initial = initial_state(initial)?;
        let own = data.get();
        Ok(interrupt::quietly(data.py(), || response(&self.estimate.model, &self.about_its_offset(own)?, &initial))??)
    }

    /// The outputs of a model, with its offset, as data of their own.
    fn outputs_for(
        &self,
        data: &Bound<'_, Dataset>,
        initial: &str,
        response: impl FnOnce(&AnyModel, &ident::Dataset, &InitialState) -> Result<Response, IdentError> + Send,
    ) -> Result<Dataset, Fault> {
        let own = data.get();
        let found = with_outputs(&own.data, self.respond(data, initial, response)?)?;
        let offset = self.offset_for(own)?;
        Ok(own.with(offset.map_or(Ok(found.clone()), |offset| offset.restore(&found))?))
    }

    /// The operating point, where it is a constant of the model: outputs about a level with inputs about zero, as the
    /// option `offset` estimates.
    fn offset(&self) -> Option<&Trend> {
        let trend = self.document.trend.as_ref()?;
        let mut lines = (0..trend.count()).flat_map(|n| trend.inputs(n));
        (!self.document.inputs.is_empty() && lines.all(|line| *line == Line::level(0.0))).then_some(trend)
    }

    /// The offset in data from which nothing was taken: of the estimate's own recordings theirs, of others the mean.
    fn offset_for(&self, data: &Dataset) -> Result<Option<Trend>, IdentError> {
        if data.trend.is_some() || self.offset().is_none() {
            return Ok(None);
        }
        let sources = data.sources_of_all();
        operating_point::trend(&self.document, MeetingTrend::Model, &data.data, &sources)
    }

    /// The data less the model's offset.
    pub(crate) fn about_its_offset(&self, data: &Dataset) -> Result<ident::Dataset, IdentError> {
        self.offset_for(data)?.map_or_else(|| Ok(data.data.clone()), |offset| offset.remove(&data.data))
    }
}

/// Trend that was taken off the data of an estimate, and the levels that were estimated with it.
fn trend_of(estimate: &Estimate<AnyModel>, data: &Dataset) -> Option<Trend> {
    match estimate.levels.is_empty() {
        true => data.trend.clone(),
        false => operating_point::raised(data.trend.as_ref(), &estimate.levels, data.data.inputs()).ok(),
    }
}

fn with_outputs(data: &ident::Dataset, response: Response) -> Result<ident::Dataset, IdentError> {
    let mut outputs = response.outputs.into_iter();
    data.map_experiments(|e| {
        let outputs = outputs.next().ok_or(IdentError::NoOutput)?;
        Ok(Experiment { outputs, ..e.clone() })
    })
}

/// Samples of a prediction; infinitely many are a simulation.
#[derive(FromPyObject)]
pub(crate) enum Horizon {
    Samples(i64),
    Number(f64),
}

impl Horizon {
    /// The samples; none for a simulation.
    pub(crate) fn samples(self) -> Result<Option<usize>, Fault> {
        match self {
            Horizon::Number(number) if number == f64::INFINITY => Ok(None),
            Horizon::Number(number) => Err(wrong_horizon(number)),
            Horizon::Samples(samples) => match usize::try_from(samples) {
                Ok(samples) if samples > 0 => Ok(Some(samples)),
                _ => Err(wrong_horizon(samples)),
            },
        }
    }
}

fn wrong_horizon(given: impl std::fmt::Display) -> Fault {
    Fault::argument(format!("horizon={given}: give a number of samples from 1 on, or infinity for a simulation"))
}

/// The place of a channel, which may be left out where there is one alone.
fn place(what: &str, labels: &[Label], given: Option<Which>) -> Result<usize, Fault> {
    let names = || labels.iter().map(|label| label.name.as_str()).collect::<Vec<_>>().join(", ");
    let found = match &given {
        None => (labels.len() == 1).then_some(0),
        Some(Which::Place(place)) => (*place < labels.len()).then_some(*place),
        Some(Which::Name(name)) => labels.iter().position(|label| label.name == *name),
    };
    found.ok_or_else(|| match given {
        None if labels.is_empty() => Fault::argument(format!("the model has no {what}")),
        None => Fault::argument(format!("the model has several {what}s; name one of {}", names())),
        Some(_) => Fault::argument(format!("the model has no such {what}; name one of {}", names())),
    })
}

fn initial_state(initial: &str) -> Result<InitialState, Fault> {
    let at_rest = one_of("initial", initial, &[("estimated", false), ("zero", true)])?;
    Ok(if at_rest { InitialState::Zero } else { InitialState::Estimated })
}

#[pymethods]
impl Fit {
    /// The method and its orders.
    #[getter(method)]
    fn method_words(&self) -> &str {
        self.method()
    }

    /// Names of the inputs.
    #[getter]
    fn inputs(&self) -> Vec<&str> {
        self.document.inputs.iter().map(|label| label.name.as_str()).collect()
    }

    /// Names of the outputs.
    #[getter]
    fn outputs(&self) -> Vec<&str> {
        self.document.outputs.iter().map(|label| label.name.as_str()).collect()
    }

    /// Sample time of the data, s.
    #[getter]
    fn sample_time(&self) -> f64 {
        self.document.sample_time_s
    }

    /// The parameters by their names.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.by_name(py, self.estimate.parameters())
    }

    /// Standard error of each parameter; NaN at a bound.
    #[getter]
    fn standard_errors<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.by_name(py, self.estimate.standard_errors())
    }

    /// Covariance of the parameters, in their order.
    #[getter]
    fn covariance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.estimate.covariance.as_ref())
    }

    /// The interval that holds each parameter with this probability.
    #[pyo3(signature = (level=0.95))]
    fn intervals<'py>(&self, py: Python<'py>, level: f64) -> Result<Bound<'py, PyDict>, Fault> {
        check_level(level)?;
        Ok(self.by_name(py, self.estimate.intervals(level))?)
    }

    /// The parameters with standard errors and intervals, as columns.
    #[pyo3(signature = (level=0.95))]
    fn table<'py>(&self, py: Python<'py>, level: f64) -> Result<Bound<'py, PyAny>, Fault> {
        check_level(level)?;
        let (low, high) = bounds(self.estimate.intervals(level));
        let fields = fields!(py,
            name: self.estimate.model.parameter_names(),
            value: vector(py, self.estimate.parameters()),
            standard_error: vector(py, self.estimate.standard_errors()),
            low: vector(py, low), high: vector(py, high), level: level,
        );
        Ok(result(py, "ParameterTable", &fields)?)
    }

    /// Fit of the prediction one step ahead to the estimation data, percent, by output.
    #[getter]
    fn fit_percent(&self) -> Vec<f64> {
        self.estimate.fit_percent()
    }

    /// Covariance of the prediction errors one step ahead.
    #[getter]
    fn noise_covariance<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.estimate.noise_covariance.as_ref())
    }

    /// Information criteria by their names.
    #[getter]
    fn criteria<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.estimate.criteria())
    }

    /// End of the search, in words.
    #[getter]
    fn termination(&self) -> String {
        self.estimate.termination.to_string()
    }

    /// Reasons to doubt the estimate: each with its `kind` and its numbers.
    #[getter]
    fn doubts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        to_python(py, &self.estimate.doubts)
    }

    /// Level of each output that was estimated with the model (`offset=True`): the mean over its data, or nothing.
    #[getter]
    fn offsets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let named = PyDict::new(py);
        let Some(trend) = self.offset() else { return Ok(named) };
        for (place, name) in self.outputs().into_iter().enumerate() {
            let levels = (0..trend.count()).filter_map(|n| trend.outputs(n).get(place)).map(|line| line.level);
            named.set_item(name, levels.sum::<f64>() / trend.count() as f64)?;
        }
        Ok(named)
    }

    /// Prediction of the outputs so many samples ahead; an infinite horizon is a simulation.
    #[pyo3(
        signature = (data, horizon=Horizon::Samples(1), *, initial="estimated"),
        text_signature = "($self, data, horizon=1, *, initial=\"estimated\")"
    )]
    fn predict(&self, data: &Bound<'_, Dataset>, horizon: Horizon, initial: &str) -> Result<Dataset, Fault> {
        let horizon = horizon.samples()?;
        self.outputs_for(data, initial, move |model, data, initial| match horizon {
            Some(samples) => predict(model, data, samples, initial),
            None => simulate(model, data, initial),
        })
    }

    /// Simulation of the outputs from the inputs alone. With `noise_seed`, noise of the model is drawn with this seed
    /// and added.
    #[pyo3(signature = (data, *, initial="estimated", noise_seed=None))]
    fn simulate(&self, data: &Bound<'_, Dataset>, initial: &str, noise_seed: Option<u64>) -> Result<Dataset, Fault> {
        let simulated = self.outputs_for(data, initial, simulate)?;
        let Some(seed) = noise_seed else { return Ok(simulated) };
        let noisy = interrupt::quietly(data.py(), || self.with_noise(&simulated, seed))??;
        Ok(simulated.with(noisy))
    }

    /// Errors of the prediction one step ahead; NaN where an output is missing.
    #[pyo3(signature = (data, *, initial="estimated"))]
    fn residuals(&self, data: &Bound<'_, Dataset>, initial: &str) -> Result<Dataset, Fault> {
        let own = data.get();
        Ok(own.with(with_outputs(&own.data, self.respond(data, initial, residuals)?)?))
    }

    /// The state at the first sample of each experiment, experiments × states, in the coordinates of `innovations()`:
    /// the one that makes the errors of prediction smallest.
    fn initial_states<'py>(&self, data: &Bound<'py, Dataset>) -> Result<Bound<'py, PyArray2<f64>>, Fault> {
        let one_step =
            |model: &AnyModel, data: &ident::Dataset, initial: &InitialState| predict(model, data, 1, initial);
        let states = self.respond(data, "estimated", one_step)?.initial_states;
        PyArray2::from_vec2(data.py(), &states).map_err(|error| Fault::argument(error.to_string()))
    }

    /// The way from the noise `e` to the outputs as an estimate of its own, with the covariance that belongs to it:
    /// its poles, zeros, responses and bands are those of the noise model.
    fn noise(&self) -> Result<Self, Fault> {
        let noise = self.document.of_noise()?;
        let white =
            || Fault::argument("the model has no noise model: its noise is white, and the output has it as it is");
        Self::of_document(noise.ok_or_else(white)?)
    }

    /// So many models drawn from the distribution of the estimate.
    #[pyo3(signature = (count, *, seed=0))]
    fn sample(&self, py: Python<'_>, count: usize, seed: u64) -> Result<Vec<Self>, Fault> {
        let samples = interrupt::quietly(py, || self.estimate.sample(count, &mut Random::new(seed)))??;
        let (method, sources) = self.document.estimate.as_ref().map_or((String::new(), Vec::new()), |record| {
            (format!("{}, drawn", record.method), record.sources.clone())
        });
        let drawn = |model: AnyModel| {
            let estimate = self.estimate.clone().map(|_| model.clone());
            let mut document = self.document.clone();
            document.estimate = Some(EstimateRecord::new(&estimate, method.clone(), sources.clone()));
            document.model = model;
            Fit { estimate, document }
        };
        Ok(samples.models.into_iter().map(|sample| drawn(sample.model)).collect())
    }

    /// Tests of the residuals: are they white, and do they follow the inputs? `own` data are those of the estimate.
    #[pyo3(signature = (data, *, own=false, lags=25, level=0.99))]
    fn test_residuals<'py>(
        &self,
        data: &Bound<'py, Dataset>,
        own: bool,
        lags: usize,
        level: f64,
    ) -> Result<Bound<'py, PyAny>, Fault> {
        check_level(level)?;
        let py = data.py();
        let (which, given) = (if own { TestData::Own } else { TestData::Unseen }, data.get());
        let test = ResidualTest { lags, level, ..ResidualTest::default() };
        let report = interrupt::quietly(py, || {
            let about = match own && !self.estimate.levels.is_empty() {
                true => self.estimate.without_levels(&given.data),
                false => self.about_its_offset(given),
            };
            test.run(&self.estimate, &about?, which)
        })??;
        let whiteness = report.whiteness.iter().map(|found| white(py, found)).collect::<PyResult<Vec<_>>>()?;
        let row = |row: &Vec<Independence>| {
            PyList::new(py, row.iter().map(|found| independent(py, found)).collect::<PyResult<Vec<_>>>()?)
        };
        let fields = fields!(py,
            whiteness: whiteness,
            independence: report.independence.iter().map(row).collect::<PyResult<Vec<_>>>()?,
            joint_whiteness: joint(py, &report.joint_whiteness)?,
            samples: report.samples, text: report.text(&names(&self.document.inputs), &names(&self.document.outputs)),
        );
        Ok(result(py, "ResidualReport", &fields)?)
    }

    /// Frequency response of a channel at angular frequencies in rad/s, or at one, with bands that hold with this
    /// probability.
    #[pyo3(signature = (w=None, *, level=0.95, y=None, u=None))]
    fn bode<'py>(
        &self,
        py: Python<'py>,
        w: Option<Bound<'py, PyAny>>,
        level: f64,
        y: Option<Which>,
        u: Option<Which>,
    ) -> Result<Bound<'py, PyAny>, Fault> {
        check_level(level)?;
        let (output, input) = (self.output(y)?, self.input(u)?);
        let given = w.map(|w| numbers("w", &w)).transpose()?;
        warn_above_nyquist(py, self.estimate.model.system()?.sample_time_s(), given.as_deref().unwrap_or_default())?;
        let band = interrupt::quietly(py, || -> Result<_, IdentError> {
            let omega_rad_s = match given {
                Some(given) => given,
                None => self.estimate.model.system()?.frequency_grid(FREQUENCIES)?,
            };
            self.estimate.frequency_band(output, input, &omega_rad_s)
        })??;
        let ((low, high), (phase_low, phase_high)) = (bounds(band.magnitude(level)), bounds(band.phase_deg(level)));
        let magnitude: Vec<f64> = band.response.response.iter().map(|gain| gain.norm()).collect();
        let fields = fields!(py,
            w: vector(py, band.response.omega_rad_s.clone()),
            magnitude: vector(py, magnitude), low: vector(py, low), high: vector(py, high),
            phase: vector(py, band.response.phase_deg()),
            phase_low: vector(py, phase_low), phase_high: vector(py, phase_high),
            level: level, output: &self.document.outputs[output].name, input: &self.document.inputs[input].name,
        );
        Ok(result(py, "Bode", &fields)?)
    }

    /// Step response of a channel at equally spaced times from zero on, or up to one time, with bands that hold with
    /// this probability.
    #[pyo3(signature = (time=None, *, level=0.95, y=None, u=None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        time: Option<Bound<'py, PyAny>>,
        level: f64,
        y: Option<Which>,
        u: Option<Which>,
    ) -> Result<Bound<'py, PyAny>, Fault> {
        check_level(level)?;
        let (output, input) = (self.output(y)?, self.input(u)?);
        let sample_time_s = self.estimate.model.system()?.sample_time_s();
        let grid = time.map(|time| grid_of(&numbers("time", &time)?, sample_time_s)).transpose()?;
        let charts = interrupt::quietly(py, || match grid {
            Some(grid) => self.estimate.step_at(&grid, level),
            None => self.estimate.step(),
        })??;
        let is_it = |chart: &&ident::uncertainty::StepChart| chart.channel == ident::ChannelPair { output, input };
        let chart = charts.iter().find(is_it).ok_or(IdentError::NoOutput)?;
        let (low, high) = bounds(chart.band.clone());
        let fields = fields!(py,
            time: vector(py, chart.time_s.clone()), response: vector(py, chart.response.clone()),
            low: vector(py, low), high: vector(py, high), level: chart.level,
            output: &self.document.outputs[output].name, input: &self.document.inputs[input].name,
        );
        Ok(result(py, "Step", &fields)?)
    }

    /// Poles of a channel with frequency, damping and time constant, each with its interval.
    #[pyo3(signature = (*, level=0.95, y=None, u=None))]
    fn poles<'py>(
        &self,
        py: Python<'py>,
        level: f64,
        y: Option<Which>,
        u: Option<Which>,
    ) -> Result<Vec<Bound<'py, PyAny>>, Fault> {
        self.roots(py, Estimate::poles, level, (y, u))
    }

    /// Zeros of a channel, as its poles.
    #[pyo3(signature = (*, level=0.95, y=None, u=None))]
    fn zeros<'py>(
        &self,
        py: Python<'py>,
        level: f64,
        y: Option<Which>,
        u: Option<Which>,
    ) -> Result<Vec<Bound<'py, PyAny>>, Fault> {
        self.roots(py, Estimate::zeros, level, (y, u))
    }

    /// The system from inputs to outputs in state space: A, B, C, D, the sample time (none in continuous time), and the
    /// delays that the matrices leave out, outputs × inputs, s. It is in the model's own time, on another sample time,
    /// or continuous; inputs are held between samples.
    #[pyo3(signature = (*, sample_time=None, continuous=false))]
    fn state_space<'py>(
        &self,
        py: Python<'py>,
        sample_time: Option<f64>,
        continuous: bool,
    ) -> Result<Bound<'py, PyAny>, Fault> {
        let model = match sample_time.is_some() || continuous {
            true => interrupt::quietly(py, || self.converted(sample_time, continuous))??,
            false => self.estimate.model.clone(),
        };
        let system = model.system()?;
        let (outputs, inputs) = (system.outputs(), system.inputs());
        let mut delays = faer::Mat::zeros(outputs, inputs);
        for (output, input) in (0..outputs).flat_map(|output| (0..inputs).map(move |input| (output, input))) {
            delays[(output, input)] = model.delay_s(output, input)?;
        }
        let fields = fields!(py,
            A: matrix(py, system.a()), B: matrix(py, system.b()), C: matrix(py, system.c()), D: matrix(py, system.d()),
            sample_time: system.sample_time_s(), delays: matrix(py, delays.as_ref()),
            inputs: self.inputs(), outputs: self.outputs(),
        );
        Ok(result(py, "StateSpace", &fields)?)
    }

    /// The innovations form on the sample time of the data: A, B, C, D and the gain K.
    fn innovations<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Fault> {
        let form = self.estimate.model.innovations(self.document.sample_time_s, self.document.intersample)?;
        let system = form.system();
        let fields = fields!(py,
            A: matrix(py, system.a()), B: matrix(py, system.b()), C: matrix(py, system.c()), D: matrix(py, system.d()),
            K: matrix(py, form.k()), noise_covariance: matrix(py, form.noise_covariance()),
            sample_time: self.document.sample_time_s,
        );
        Ok(result(py, "Innovations", &fields)?)
    }

    /// Numerator and denominator of a channel, in falling powers of s or z.
    #[pyo3(signature = (*, y=None, u=None))]
    fn transfer_function<'py>(&self, py: Python<'py>, y: Option<Which>, u: Option<Which>) -> Result<Ratio<'py>, Fault> {
        let ratio = self.estimate.model.polynomials(self.output(y)?, self.input(u)?)?;
        let ratio = ratio.ok_or_else(|| {
            Fault::argument("this model is not written in polynomials; `state_space()` gives its matrices")
        })?;
        Ok((vector(py, ratio.numerator), vector(py, ratio.denominator)))
    }

    /// The same system for python-control. A delay in continuous time needs the order of its Padé approximation.
    #[pyo3(signature = (*, pade=None))]
    fn to_control<'py>(slf: &Bound<'py, Self>, pade: Option<usize>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("dynoid.interop")?.getattr("to_control")?.call1((slf, pade))
    }

    /// The same system for scipy.signal.
    fn to_scipy<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        slf.py().import("dynoid.interop")?.getattr("to_scipy")?.call1((slf,))
    }

    /// The model file, as the program writes and reads it.
    fn to_json(&self) -> Result<String, Fault> {
        serde_json::to_string_pretty(&self.document).map_err(|error| Fault::argument(error.to_string()))
    }

    /// Writes the model file. It replaces a model file, and another file only where `overwrite` allows it.
    #[pyo3(signature = (path, *, overwrite=false))]
    fn save(&self, path: PathBuf, overwrite: bool) -> Result<(), Fault> {
        let files = files(overwrite);
        check_replaceable(&path, Some(&Mark::Document(Kind::Linear)), &files)?;
        Ok(replace_file(&path, self.to_json()?.as_bytes(), &files)?)
    }

    /// The estimate of a model file.
    #[staticmethod]
    fn from_json(text: &str) -> Result<Self, Fault> {
        Self::of_document(serde_json::from_str(text).map_err(|error| Fault::argument(error.to_string()))?)
    }

    fn __repr__(&self) -> String {
        self.estimate.to_string()
    }

    fn _repr_html_(slf: &Bound<'_, Self>) -> PyResult<String> {
        slf.py().import("dynoid.interop")?.getattr("fit_to_html")?.call1((slf,))?.extract()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let Fit { estimate, document } = slf.get();
        let kept =
            Kept { document: document.clone(), levels: estimate.levels.clone(), origin: estimate.origin.clone() };
        let text = serde_json::to_string(&kept).map_err(|error| Fault::argument(error.to_string()))?;
        (slf.get_type().getattr("_restored")?, (text,)).into_pyobject(slf.py()).map(Bound::into_any)
    }

    #[staticmethod]
    fn _restored(text: &str) -> Result<Self, Fault> {
        let kept: Kept = serde_json::from_str(text).map_err(|error| Fault::argument(error.to_string()))?;
        let Fit { estimate, document } = Self::of_document(kept.document)?;
        Ok(Fit { estimate: Estimate { levels: kept.levels, origin: kept.origin, ..estimate }, document })
    }
}

/// Steps of a response in continuous time up to one time.
const STEPS: usize = 200;
/// Steps of a response at most.
const MOST_STEPS: f64 = 1e7;
/// Frequencies of a Bode plot.
const FREQUENCIES: usize = 200;

impl Fit {
    /// The model on another clock.
    fn converted(&self, sample_time: Option<f64>, continuous: bool) -> Result<AnyModel, Fault> {
        if sample_time.is_some() && continuous {
            return Err(Fault::argument("give either sample_time or continuous=True"));
        }
        let rule = Discretisation::ZeroOrderHold;
        let asked = Conversion { form: Form::StateSpace, sample_time_s: sample_time, continuous, rule };
        Ok(ConvertedModel::of(self.document.clone(), &asked)?.document()?.model)
    }

    /// Data whose outputs have a realisation of the model's noise besides.
    fn with_noise(&self, data: &Dataset, seed: u64) -> Result<ident::Dataset, IdentError> {
        let own = &data.data;
        let form = self.estimate.model.innovations(own.sample_time_s(), self.document.intersample)?;
        let deviations = Cholesky::new(form.noise_covariance())?;
        let (system, mut random) = (form.noise_system()?, Random::new(seed));
        let at_rest = vec![0.0; system.states()];
        own.map_experiments(|e| {
            let white = Mat::from_fn(e.len(), system.inputs(), |_, _| random.normal());
            let noise = system.simulate((white * deviations.lower().transpose()).as_ref(), &at_rest)?;
            Ok(Experiment { outputs: &e.outputs + &noise, ..e.clone() })
        })
    }

    /// Poles or zeros of a channel, as `find` finds them.
    fn roots<'py>(
        &self,
        py: Python<'py>,
        find: impl FnOnce(&Estimate<AnyModel>, usize, usize) -> Result<Vec<UncertainRoot>, IdentError> + Send,
        level: f64,
        (y, u): (Option<Which>, Option<Which>),
    ) -> Result<Vec<Bound<'py, PyAny>>, Fault> {
        check_level(level)?;
        let (output, input) = (self.output(y)?, self.input(u)?);
        let roots = interrupt::quietly(py, || find(&self.estimate, output, input))??;
        let sample_time_s = self.estimate.model.system()?.sample_time_s();
        let one = |root: &UncertainRoot| -> PyResult<Bound<'py, PyAny>> {
            let mode = root.mode(sample_time_s);
            let Complex64 { re, im } = root.value;
            let fields = fields!(py,
                value: pyo3::types::PyComplex::from_doubles(py, re, im),
                natural_frequency: mode.mode.natural_frequency_rad_s,
                natural_frequency_interval: mode.natural_frequency_rad_s(level),
                damping: mode.mode.damping,
                damping_interval: mode.damping(level),
                time_constant: mode.mode.time_constant_s(),
                time_constant_interval: mode.time_constant_s(level),
                covariance: PyArray2::from_vec2(py, &root.covariance.map(Vec::from))?,
                near_multiple: root.near_multiple,
            );
            result(py, "Root", &fields)
        };
        Ok(roots.iter().map(one).collect::<PyResult<_>>()?)
    }
}

fn check_level(level: f64) -> Result<(), Fault> {
    match level > 0.0 && level < 1.0 {
        true => Ok(()),
        false => Err(Fault::argument(format!("level={level}: give a probability between 0 and 1, such as 0.95"))),
    }
}

/// Warns of frequencies at which a sampled model only repeats its response.
fn warn_above_nyquist(py: Python<'_>, sample_time_s: Option<f64>, omega_rad_s: &[f64]) -> PyResult<()> {
    let Some(nyquist) = sample_time_s.map(|t| std::f64::consts::PI / t) else { return Ok(()) };
    if omega_rad_s.iter().all(|omega| *omega <= nyquist * (1.0 + 1e-9)) {
        return Ok(());
    }
    let words =
        format!("w goes beyond half the sampling rate, {nyquist:.6} rad/s, where the response only repeats itself");
    PyErr::warn(py, &py.get_type::<PyUserWarning>(), &CString::new(words)?, 2)
}

/// Names of channels.
fn names(labels: &[Label]) -> Vec<String> {
    labels.iter().map(|label| label.name.clone()).collect()
}

/// Equally spaced times from zero on, of a list or up to one time.
fn grid_of(time_s: &[f64], sample_time_s: Option<f64>) -> Result<TimeGrid, Fault> {
    let wrong = || Fault::argument("time: give equally spaced times from 0 on, or the last one");
    if let [last] = time_s {
        let step_s = sample_time_s.unwrap_or(last / STEPS as f64);
        // Half a sample of room, so that rounding does not cost the last one.
        let steps = (last / step_s + 1e-9).floor();
        let is_possible = *last > 0.0 && last.is_finite() && steps < MOST_STEPS;
        return is_possible.then_some(TimeGrid { step_s, points: steps as usize + 1 }).ok_or_else(wrong);
    }
    let [first, second, ..] = time_s else { return Err(wrong()) };
    let step_s = second - first;
    let is_even = |(k, time): (usize, &f64)| (time - k as f64 * step_s).abs() <= 1e-6 * step_s;
    match step_s > 0.0 && time_s.iter().enumerate().all(is_even) {
        true => Ok(TimeGrid { step_s, points: time_s.len() }),
        false => Err(wrong()),
    }
}

fn joint<'py>(py: Python<'py>, test: &JointTest) -> PyResult<Bound<'py, PyAny>> {
    let fields = fields!(py,
        statistic: test.statistic, degrees_of_freedom: test.degrees_of_freedom, p_value: test.p_value,
    );
    result(py, "JointTest", &fields)
}

fn white<'py>(py: Python<'py>, found: &Whiteness) -> PyResult<Bound<'py, PyAny>> {
    let fields = fields!(py,
        mean: found.mean, correlation: vector(py, found.auto.clone()), bounds: vector(py, found.bounds.clone()),
        joint: joint(py, &found.joint)?,
    );
    result(py, "Whiteness", &fields)
}

fn independent<'py>(py: Python<'py>, found: &Independence) -> PyResult<Bound<'py, PyAny>> {
    let fields = fields!(py,
        correlation: vector(py, found.cross.clone()), bounds: vector(py, found.bounds.clone()),
        dynamics: joint(py, &found.dynamics)?, past: joint(py, &found.past)?, feedback: joint(py, &found.feedback)?,
    );
    result(py, "Independence", &fields)
}
