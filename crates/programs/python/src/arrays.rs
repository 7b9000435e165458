//! Arrays of numpy: columns and matrices, in and out.

use faer::{Mat, MatRef};
use ident::Label;
use numpy::ndarray::{Array2, Ix1, Ix2};
use numpy::{AllowTypeChange, IntoPyArray, PyArray1, PyArray2, PyArrayLike1, PyArrayLikeDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::errors::Fault;

/// Numbers of any type that numpy makes floats of.
pub(crate) type Floats<'py> = PyArrayLike1<'py, f64, AllowTypeChange>;

/// Numbers of an array, or one number alone.
pub(crate) fn numbers(what: &str, given: &Bound<'_, PyAny>) -> Result<Vec<f64>, Fault> {
    let array: PyArrayLikeDyn<'_, f64, AllowTypeChange> = given.extract()?;
    let view = array.as_array();
    match view.ndim() {
        0 | 1 => Ok(view.iter().copied().collect()),
        dimensions => {
            Err(Fault::argument(format!("{what}: an array of {dimensions} dimensions; give a list of numbers")))
        }
    }
}

/// A vector, whose memory numpy takes over; it cannot be written to.
pub(crate) fn vector(py: Python<'_>, values: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    let array = values.into_pyarray(py);
    array.readwrite().make_nonwriteable();
    array
}

/// A matrix, rows by columns.
pub(crate) fn matrix<'py>(py: Python<'py>, m: MatRef<'_, f64>) -> Bound<'py, PyArray2<f64>> {
    Array2::from_shape_fn((m.nrows(), m.ncols()), |at| m[at]).into_pyarray(py)
}

/// Lower ends and upper ends of intervals.
pub(crate) fn bounds(intervals: Vec<(f64, f64)>) -> (Vec<f64>, Vec<f64>) {
    intervals.into_iter().unzip()
}

/// Columns with their names, where these are given.
pub(crate) struct Columns {
    pub(crate) names: Option<Vec<Label>>,
    pub(crate) values: Mat<f64>,
}

impl Columns {
    /// Columns of a dictionary of names, of an array of samples × channels, or of the samples of one channel.
    pub(crate) fn of(what: &str, given: &Bound<'_, PyAny>) -> Result<Self, Fault> {
        match given.cast::<PyDict>() {
            Ok(named) => Self::named(what, named),
            Err(_) => Ok(Columns { names: None, values: table(what, given)? }),
        }
    }

    fn named(what: &str, named: &Bound<'_, PyDict>) -> Result<Self, Fault> {
        let mut names = Vec::new();
        let mut columns: Vec<Vec<f64>> = Vec::new();
        for (name, values) in named {
            let name: String = name.extract()?;
            let values: Floats<'_> = values.extract()?;
            let values: Vec<f64> = values.as_array().to_vec();
            if columns.first().is_some_and(|first| first.len() != values.len()) {
                let (expected, found) = (columns[0].len(), values.len());
                return Err(Fault::argument(format!(
                    "{what}: \"{name}\" has {found} samples, and \"{}\" has {expected}; give channels of one length",
                    names.first().map_or("", |label: &Label| label.name.as_str())
                )));
            }
            names.push(Label::new(name, ""));
            columns.push(values);
        }
        let rows = columns.first().map_or(0, Vec::len);
        let values = Mat::from_fn(rows, columns.len(), |t, k| columns[k][t]);
        Ok(Columns { names: Some(names), values })
    }
}

fn table(what: &str, given: &Bound<'_, PyAny>) -> Result<Mat<f64>, Fault> {
    let array: PyArrayLikeDyn<'_, f64, AllowTypeChange> = given.extract()?;
    let view = array.as_array();
    if let Ok(one) = view.clone().into_dimensionality::<Ix1>() {
        return Ok(Mat::from_fn(one.len(), 1, |t, _| one[t]));
    }
    if let Ok(several) = view.clone().into_dimensionality::<Ix2>() {
        return Ok(Mat::from_fn(several.nrows(), several.ncols(), |t, k| several[[t, k]]));
    }
    Err(Fault::argument(format!(
        "{what}: an array of {} dimensions; give the samples of one channel, or samples × channels",
        view.ndim()
    )))
}
