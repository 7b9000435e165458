//! Estimates that follow the data sample by sample.

use ident::recursive::{Adaptation, Recursive, RecursiveStructure, Trajectory};
use pyo3::prelude::*;

use crate::arrays::{matrix, vector};
use crate::dataset::Dataset;
use crate::errors::Fault;
use crate::estimators::PerInput;
use crate::interrupt;
use crate::results::{fields, result};

/// Follows the parameters of ARX, ARMAX or output error: by forgetting, as random walks, or along the gradient.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the orders of all polynomials")]
pub(crate) fn recursive<'py>(
    data: &Bound<'py, Dataset>,
    na: usize,
    nb: PerInput,
    nc: usize,
    nf: PerInput,
    nk: PerInput,
    forgetting: f64,
    drift: Option<(Vec<f64>, f64)>,
    gradient: Option<f64>,
) -> Result<Bound<'py, PyAny>, Fault> {
    let (py, own) = (data.py(), &data.get().data);
    let inputs = own.inputs();
    let (nb, nf, nk) = (nb.spread("nb", inputs)?, nf.spread("nf", inputs)?, nk.spread("nk", inputs)?);
    let structure = structure(na, nb, nc, nf, nk)?;
    let adaptation = match (drift, gradient) {
        (Some(_), Some(_)) => return Err(Fault::argument("give either drift or gradient")),
        (Some((drift, noise_variance)), None) => Adaptation::RandomWalk { drift, noise_variance },
        (None, Some(step)) => Adaptation::NormalisedGradient(step),
        (None, None) => Adaptation::Forgetting(forgetting),
    };
    let found = interrupt::quietly(py, || Recursive::new(structure, adaptation)?.run(own))??;
    Ok(trajectory(py, &found)?)
}

fn structure(
    na: usize,
    nb: Vec<usize>,
    nc: usize,
    nf: Vec<usize>,
    nk: Vec<usize>,
) -> Result<RecursiveStructure, Fault> {
    let has_poles = nf.iter().any(|order| *order > 0);
    match (has_poles, na + nc > 0) {
        (true, true) => Err(Fault::argument("nf is for output error; give it without na and nc")),
        (true, false) => Ok(RecursiveStructure::OutputError { nb, nf, nk }),
        (false, _) if nc > 0 => Ok(RecursiveStructure::Armax { na, nb, nc, nk }),
        (false, _) => Ok(RecursiveStructure::Arx { na, nb, nk }),
    }
}

fn trajectory<'py>(py: Python<'py>, found: &Trajectory) -> PyResult<Bound<'py, PyAny>> {
    let column = |of: fn(&ident::recursive::Update) -> f64| vector(py, found.updates.iter().map(of).collect());
    let fields = fields!(py,
        names: found.names.clone(),
        parameters: matrix(py, found.parameters.as_ref()),
        standard_errors: matrix(py, found.standard_errors.as_ref()),
        prediction: column(|update| update.prediction),
        error: column(|update| update.error),
    );
    result(py, "Trajectory", &fields)
}
