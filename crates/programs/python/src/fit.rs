//! An estimate: the model, how certain it is, and what follows from it.

use std::path::PathBuf;

use dynoid::{Kind, Mark, check_replaceable, replace_file};
use ident::prediction::{InitialState, Response, predict, residuals, simulate};
use ident::uncertainty::{Dynamics, UncertainRoot};
use ident::validate::{Independence, JointTest, ResidualTest, TestData, Whiteness};
use ident::{
    AnyModel, EstimateRecord, Experiment, Fit as Estimate, IdentError, Label, LinearModel, ModelDocument, Origin,
    Parametric,
};
use lti::{Complex64, TimeGrid};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use serde::{Deserialize, Serialize};

use crate::arrays::{Floats, bounds, matrix, vector};
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
        document.trend = data.trend.clone();
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

    /// The outputs of a model as data of their own.
    fn respond(
        &self,
        data: &Bound<'_, Dataset>,
        initial: &str,
        response: impl FnOnce(&AnyModel, &ident::Dataset, &InitialState) -> Result<Response, IdentError> + Send,
    ) -> Result<Dataset, Fault> {
        let initial = initial_state(initial)?;
        let own = data.get();
        let found = interrupt::quietly(data.py(), || response(&self.estimate.model, &own.data, &initial))??;
        let mut outputs = found.outputs.into_iter();
        let replaced = own.data.map_experiments(|e| {
            let outputs = outputs.next().ok_or(IdentError::NoOutput)?;
            Ok(Experiment { outputs, ..e.clone() })
        })?;
        Ok(own.with(replaced))
    }
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

    /// Prediction of the outputs so many samples ahead.
    #[pyo3(signature = (data, horizon=1, *, initial="estimated"))]
    fn predict(&self, data: &Bound<'_, Dataset>, horizon: usize, initial: &str) -> Result<Dataset, Fault> {
        self.respond(data, initial, move |model, data, initial| predict(model, data, horizon, initial))
    }

    /// Simulation of the outputs from the inputs alone.
    #[pyo3(signature = (data, *, initial="estimated"))]
    fn simulate(&self, data: &Bound<'_, Dataset>, initial: &str) -> Result<Dataset, Fault> {
        self.respond(data, initial, simulate)
    }

    /// Errors of the prediction one step ahead; NaN where an output is missing.
    #[pyo3(signature = (data, *, initial="estimated"))]
    fn residuals(&self, data: &Bound<'_, Dataset>, initial: &str) -> Result<Dataset, Fault> {
        self.respond(data, initial, residuals)
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
        let report = interrupt::quietly(py, || test.run(&self.estimate, &given.data, which))??;
        let whiteness = report.whiteness.iter().map(|found| white(py, found)).collect::<PyResult<Vec<_>>>()?;
        let row = |row: &Vec<Independence>| {
            PyList::new(py, row.iter().map(|found| independent(py, found)).collect::<PyResult<Vec<_>>>()?)
        };
        let fields = fields!(py,
            whiteness: whiteness,
            independence: report.independence.iter().map(row).collect::<PyResult<Vec<_>>>()?,
            joint_whiteness: joint(py, &report.joint_whiteness)?,
            samples: report.samples, text: report.to_string(),
        );
        Ok(result(py, "ResidualReport", &fields)?)
    }

    /// Frequency response of a channel at angular frequencies in rad/s, with bands that hold with this probability.
    #[pyo3(signature = (w=None, *, level=0.95, y=None, u=None))]
    fn bode<'py>(
        &self,
        py: Python<'py>,
        w: Option<Floats<'py>>,
        level: f64,
        y: Option<Which>,
        u: Option<Which>,
    ) -> Result<Bound<'py, PyAny>, Fault> {
        check_level(level)?;
        let (output, input) = (self.output(y)?, self.input(u)?);
        let given = w.map(|w| w.as_array().to_vec());
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

    /// Step response of a channel at equally spaced times from zero on, with bands that hold with this probability.
    #[pyo3(signature = (time=None, *, level=0.95, y=None, u=None))]
    fn step<'py>(
        &self,
        py: Python<'py>,
        time: Option<Floats<'py>>,
        level: f64,
        y: Option<Which>,
        u: Option<Which>,
    ) -> Result<Bound<'py, PyAny>, Fault> {
        check_level(level)?;
        let (output, input) = (self.output(y)?, self.input(u)?);
        let grid = time.map(|time| grid_of(&time.as_array().to_vec())).transpose()?;
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

    /// The system from inputs to outputs in state space, in the model's own time: A, B, C, D, the sample time (none in
    /// continuous time), and the delays that the matrices leave out, outputs × inputs, s.
    fn state_space<'py>(&self, py: Python<'py>) -> Result<Bound<'py, PyAny>, Fault> {
        let system = self.estimate.model.system()?;
        let (outputs, inputs) = (system.outputs(), system.inputs());
        let mut delays = faer::Mat::zeros(outputs, inputs);
        for (output, input) in (0..outputs).flat_map(|output| (0..inputs).map(move |input| (output, input))) {
            delays[(output, input)] = self.estimate.model.delay_s(output, input)?;
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

/// Frequencies of a Bode plot.
const FREQUENCIES: usize = 200;

impl Fit {
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

/// Equally spaced times from zero on.
fn grid_of(time_s: &[f64]) -> Result<TimeGrid, Fault> {
    let wrong = || Fault::argument("time: give equally spaced times from 0 on");
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
