//! A recording: channels, each on one of its clocks.

use std::path::PathBuf;

use dynoid::{FileFormat, selection};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use recording::{Catalogue, ChannelInfo, Format, RasterInfo, StartTime};

use crate::arrays::{Floats, vector};
use crate::content::ContentHash;
use crate::dataset::{Dataset, DatasetArguments};
use crate::errors::Fault;
use crate::interrupt;
use crate::made::files;
use crate::results::{fields, result};

/// A decoded recording. Its arrays are those that the decoder filled, and cannot be written to.
#[pyclass(frozen, module = "dynoid", mapping)]
pub(crate) struct Recording {
    name: String,
    content: ContentHash,
    catalogue: Catalogue,
    times: Vec<Py<PyArray1<f64>>>,
    samples: Vec<Py<PyArray1<f64>>>,
}

/// Reads a recording: MDF, CSV, MATLAB, HDF5, Parquet or Arrow.
#[pyfunction]
#[pyo3(signature = (path, channels=None, row_time=None, progress=None))]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    channels: Option<Vec<String>>,
    row_time: Option<f64>,
    progress: Option<Py<PyAny>>,
) -> Result<Recording, Fault> {
    let read = move |context: &work::Context| -> Result<(recording::Recording, String, ContentHash), dynoid::Error> {
        let files = files(false);
        let mut named = files.named(std::slice::from_ref(&path))?;
        let Some(file) = named.pop().filter(|_| named.is_empty()) else {
            return Err(dynoid::Error::IsFolder { path, remedy: "name a file in it".to_owned() });
        };
        let wanted = selection(&channels.unwrap_or_default());
        let step = context.step(format!("reading {}", file.name), 0);
        let content = ContentHash::of_file(&file);
        let read = files.read_recording(&file, &wanted, row_time, &step)?;
        Ok((read.recording, file.name.clone(), content))
    };
    let (recording, name, content) = interrupt::run(py, progress, None, read)??;
    Ok(Recording::of(py, recording, &name, content))
}

#[pymethods]
impl Recording {
    /// A recording of arrays on one clock: time stamps in seconds, and channels by their names.
    #[staticmethod]
    #[pyo3(signature = (time, channels, units=None, name="arrays"))]
    fn from_arrays(
        time: Floats<'_>,
        channels: &Bound<'_, PyDict>,
        units: Option<&Bound<'_, PyDict>>,
        name: &str,
    ) -> Result<Self, Fault> {
        let py = channels.py();
        let (mut infos, mut samples) = (Vec::new(), Vec::new());
        for (name, values) in channels {
            let name: String = name.extract()?;
            let values: Floats<'_> = values.extract()?;
            if values.len()? != time.len()? {
                let (found, expected) = (values.len()?, time.len()?);
                let message = format!("\"{name}\" has {found} samples for {expected} time stamps; give one for each");
                return Err(Fault::argument(message));
            }
            let unit = units.and_then(|units| units.get_item(&name).transpose()).transpose()?;
            let unit = unit.map(|unit| unit.extract()).transpose()?.unwrap_or_default();
            infos.push(ChannelInfo { name, unit, comment: String::new(), raster: 0 });
            samples.push(vector(py, values.as_array().to_vec()).unbind());
        }
        let time_s = time.as_array().to_vec();
        let catalogue = Catalogue {
            format: Format::Arrow,
            comment: None,
            start_time: None,
            rasters: vec![RasterInfo { name: None, samples: Some(time_s.len()) }],
            channels: infos,
            findings: Vec::new(),
        };
        let times = vec![vector(py, time_s).unbind()];
        let content = ContentHash::known_as(String::new());
        Ok(Recording { name: name.to_owned(), content, catalogue, times, samples })
    }

    /// Name of the file.
    #[getter]
    fn file(&self) -> &str {
        &self.name
    }

    /// SHA-256 of the file, which is read for it; empty for a recording of arrays.
    #[getter]
    fn sha256(&self, py: Python<'_>) -> Result<String, Fault> {
        interrupt::quietly(py, || self.content.read().map(str::to_owned))?
    }

    /// Format of the file, such as `MDF 4.10`.
    #[getter]
    fn format(&self) -> String {
        if self.content.is_of_no_file() { "arrays".to_owned() } else { self.catalogue.format.to_string() }
    }

    /// Comment of the file.
    #[getter]
    fn comment(&self) -> Option<&str> {
        self.catalogue.comment.as_deref()
    }

    /// Start of the measurement: with the zone UTC, or without one where the file has the clock of the bench.
    #[getter]
    fn start_time<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let Some(StartTime { nanoseconds, is_local, .. }) = self.catalogue.start_time else { return Ok(None) };
        let datetime = py.import("datetime")?;
        let zone = if is_local { py.None().into_bound(py) } else { datetime.getattr("timezone")?.getattr("utc")? };
        let zero = datetime.getattr("datetime")?.call1((1970, 1, 1, 0, 0, 0, 0, zone))?;
        let since = datetime.getattr("timedelta")?.call1((0, 0, nanoseconds.div_euclid(1000)))?;
        zero.call_method1("__add__", (since,)).map(Some)
    }

    /// Losses of the reader, and facts to know about the file.
    #[getter]
    fn findings(&self) -> Vec<String> {
        self.catalogue.findings.iter().map(ToString::to_string).collect()
    }

    /// Names of the channels, in the order of the file.
    #[getter]
    fn names(&self) -> Vec<&str> {
        self.catalogue.channels.iter().map(|channel| channel.name.as_str()).collect()
    }

    /// The channels, in the order of the file.
    #[getter]
    fn channels<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyAny>>> {
        (0..self.samples.len()).map(|index| self.channel(py, index)).collect()
    }

    /// Time stamps of each clock, s.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyArray1<f64>>> {
        self.times.iter().map(|time| time.bind(py).clone()).collect()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        match self.catalogue.channels.iter().position(|channel| channel.name == name) {
            Some(index) => self.channel(py, index),
            None => {
                let names = self.catalogue.channels.iter().map(|channel| channel.name.as_str());
                let closest = recording::names::closest(name, names, 3).join(", ");
                let message = format!("{}: there is no channel \"{name}\"; the closest names are {closest}", self.name);
                Err(PyKeyError::new_err(message))
            }
        }
    }

    fn __contains__(&self, name: &str) -> bool {
        self.catalogue.channels.iter().any(|channel| channel.name == name)
    }

    fn __len__(&self) -> usize {
        self.samples.len()
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.names().into_pyobject(py)?.call_method0("__iter__")
    }

    /// Inputs and outputs on one clock.
    #[pyo3(signature = (y, u=None, *, sample_time=None, start=None, end=None, clock="slowest", between="held", detrend=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn dataset(
        slf: &Bound<'_, Self>,
        y: crate::dataset::Names,
        u: Option<crate::dataset::Names>,
        sample_time: Option<f64>,
        start: Option<f64>,
        end: Option<f64>,
        clock: &str,
        between: &str,
        detrend: Option<&str>,
    ) -> Result<Dataset, Fault> {
        let arguments = DatasetArguments { y, u, sample_time, start, end, clock, between, detrend };
        Dataset::of(slf.py(), std::slice::from_ref(slf), arguments)
    }

    /// Writes the recording; the ending gives the format. Returns what the format has no place for, in words.
    #[pyo3(signature = (path, *, overwrite=false))]
    fn save(&self, py: Python<'_>, path: PathBuf, overwrite: bool) -> Result<Vec<String>, Fault> {
        let format = FileFormat::of_output(&path)?;
        let mut recording = self.whole(py)?;
        Ok(interrupt::quietly(py, move || {
            let notes = format.fit(&mut recording);
            format.write(&recording, &path, &files(overwrite)).map(|()| notes)
        })??)
    }

    /// A pandas frame of channels that share a clock, with the time in seconds as its index.
    #[pyo3(signature = (*names))]
    fn to_pandas<'py>(slf: &Bound<'py, Self>, names: Vec<String>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, "to_pandas", names)
    }

    /// A polars frame of channels that share a clock, with the column `time`.
    #[pyo3(signature = (*names))]
    fn to_polars<'py>(slf: &Bound<'py, Self>, names: Vec<String>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, "to_polars", names)
    }

    /// An Arrow table of channels that share a clock, with the column `time`, and units as metadata.
    #[pyo3(signature = (*names))]
    fn to_arrow<'py>(slf: &Bound<'py, Self>, names: Vec<String>) -> PyResult<Bound<'py, PyAny>> {
        frame(slf, "to_arrow", names)
    }

    fn __repr__(&self) -> String {
        let head = format!("{}: {}, {} channels", self.name, self.format(), self.samples.len());
        let lines = self.catalogue.rasters.iter().enumerate().map(|(index, raster)| {
            let on_it = self.catalogue.channels.iter().filter(|channel| channel.raster == index);
            let written = |c: &ChannelInfo| match c.unit.as_str() {
                "" => c.name.clone(),
                unit => format!("{} [{unit}]", c.name),
            };
            let names: Vec<String> = on_it.map(written).collect();
            let samples = raster.samples.map_or_else(String::new, |count| format!("{count} samples: "));
            format!("\n  clock {}, {samples}{}", index + 1, names.join(", "))
        });
        let lines: String = lines.collect();
        head + &lines
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let py = slf.py();
        let own = slf.get();
        let catalogue = serde_json::to_string(&own.catalogue).map_err(|error| Fault::argument(error.to_string()))?;
        let samples: Vec<_> = own.samples.iter().map(|samples| samples.bind(py).clone()).collect();
        let state = (own.name.as_str(), own.content.known(), catalogue, own.times(py), samples);
        (slf.get_type().getattr("_restored")?, state).into_pyobject(py).map(Bound::into_any)
    }

    #[staticmethod]
    fn _restored(
        name: String,
        sha256: String,
        catalogue: &str,
        times: Vec<Py<PyArray1<f64>>>,
        samples: Vec<Py<PyArray1<f64>>>,
    ) -> Result<Self, Fault> {
        let catalogue = serde_json::from_str(catalogue).map_err(|error| Fault::argument(error.to_string()))?;
        Ok(Recording { name, content: ContentHash::known_as(sha256), catalogue, times, samples })
    }
}

fn frame<'py>(recording: &Bound<'py, Recording>, to: &str, names: Vec<String>) -> PyResult<Bound<'py, PyAny>> {
    recording.py().import("dynoid.frames")?.getattr(to)?.call1((recording, names))
}

impl Recording {
    fn channel<'py>(&self, py: Python<'py>, index: usize) -> PyResult<Bound<'py, PyAny>> {
        let ChannelInfo { name, unit, comment, raster } = &self.catalogue.channels[index];
        let fields = fields!(py,
            name: name, unit: unit, comment: comment, clock: raster,
            time: self.times[*raster].bind(py), values: self.samples[index].bind(py),
        );
        result(py, "Channel", &fields)
    }

    /// A recording that the library has made or read.
    pub(crate) fn of(py: Python<'_>, recording: recording::Recording, name: &str, content: ContentHash) -> Self {
        Recording {
            name: name.to_owned(),
            content,
            catalogue: recording.catalogue(),
            times: recording.rasters.into_iter().map(|raster| vector(py, raster.time_s).unbind()).collect(),
            samples: recording.channels.into_iter().map(|channel| vector(py, channel.samples).unbind()).collect(),
        }
    }

    /// A recording of no file, as Python gets it.
    pub(crate) fn made<'py>(
        py: Python<'py>,
        recording: recording::Recording,
        name: &str,
    ) -> PyResult<Bound<'py, Self>> {
        Bound::new(py, Self::of(py, recording, name, ContentHash::known_as(String::new())))
    }

    /// The recording with the samples of all channels.
    pub(crate) fn whole(&self, py: Python<'_>) -> PyResult<recording::Recording> {
        self.decoded(py, &self.names())
    }

    /// Name of the recording, and the hash of its file.
    pub(crate) fn source(&self) -> (String, ContentHash) {
        (self.name.clone(), self.content.clone())
    }

    /// The recording with the samples of the channels that are wanted.
    pub(crate) fn decoded(&self, py: Python<'_>, wanted: &[&str]) -> PyResult<recording::Recording> {
        let copied = |array: &Py<PyArray1<f64>>| -> PyResult<Vec<f64>> { Ok(array.bind(py).readonly().to_vec()?) };
        let raster = |(info, time): (&RasterInfo, &Py<PyArray1<f64>>)| -> PyResult<recording::Raster> {
            Ok(recording::Raster { name: info.name.clone(), time_s: copied(time)? })
        };
        let channel = |(info, samples): (&ChannelInfo, &Py<PyArray1<f64>>)| -> PyResult<recording::Channel> {
            let is_wanted = wanted.contains(&info.name.as_str());
            Ok(recording::Channel {
                name: info.name.clone(),
                unit: info.unit.clone(),
                comment: info.comment.clone(),
                raster: info.raster,
                samples: if is_wanted { copied(samples)? } else { Vec::new() },
            })
        };
        Ok(recording::Recording {
            format: self.catalogue.format,
            comment: self.catalogue.comment.clone(),
            start_time: self.catalogue.start_time,
            rasters: self.catalogue.rasters.iter().zip(&self.times).map(raster).collect::<PyResult<_>>()?,
            channels: self.catalogue.channels.iter().zip(&self.samples).map(channel).collect::<PyResult<_>>()?,
            findings: self.catalogue.findings.clone(),
        })
    }
}
