//! Comparison of models on the same data.

use ident::prediction::InitialState;
use ident::validate::{Judgement, compare_with};
use ident::{IdentError, LinearModel};
use pyo3::prelude::*;

use crate::dataset::Dataset;
use crate::errors::Fault;
use crate::fit::Fit;
use crate::interrupt;
use crate::results::{fields, result};

/// Compares models by their simulation, or by their prediction over a horizon of samples.
#[pyfunction]
#[pyo3(signature = (models, data, horizon=None, names=None))]
pub(crate) fn compare<'py>(
    models: Vec<Bound<'py, Fit>>,
    data: &Bound<'py, Dataset>,
    horizon: Option<usize>,
    names: Option<Vec<String>>,
) -> Result<Bound<'py, PyAny>, Fault> {
    let (py, given) = (data.py(), data.get());
    let fits: Vec<&Fit> = models.iter().map(Bound::get).collect();
    let names = names.unwrap_or_else(|| fits.iter().map(|fit| fit.method().to_owned()).collect());
    let comparison = interrupt::quietly(py, || {
        let models: Vec<&dyn LinearModel> = fits.iter().map(|fit| &fit.estimate as &dyn LinearModel).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        compare_with(&models, &given.data, horizon, &InitialState::Estimated).named(&names)
    })?;
    let of = |found: &dyn Fn(&Judgement) -> Vec<Vec<f64>>| -> Vec<Option<Vec<Vec<f64>>>> {
        comparison
            .judgements
            .iter()
            .map(|judged: &Result<Judgement, IdentError>| judged.as_ref().ok().map(found))
            .collect()
    };
    let reasons = comparison.judgements.iter().map(|judged| judged.as_ref().err().map(ToString::to_string));
    let fields = fields!(py,
        names: comparison.names.clone(),
        fit_percent: of(&|judged| judged.fit_percent.clone()),
        rms_error: of(&|judged| judged.rms_error.clone()),
        reasons: reasons.collect::<Vec<_>>(),
        best: comparison.best(),
        text: comparison.to_string(),
    );
    Ok(result(py, "Comparison", &fields)?)
}
