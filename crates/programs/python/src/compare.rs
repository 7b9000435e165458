//! Comparison of models on the same data.

use ident::IdentError;
use ident::prediction::InitialState;
use ident::validate::{Comparison, Judgement, judge};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::dataset::Dataset;
use crate::errors::Fault;
use crate::fit::{Fit, Horizon};
use crate::interrupt;
use crate::results::{fields, result};

/// Models, and their names where they have such.
type WithNames<'py> = (Vec<Bound<'py, Fit>>, Option<Vec<String>>);

/// One model, several, or several by their names.
#[derive(FromPyObject)]
pub(crate) enum Compared<'py> {
    One(Bound<'py, Fit>),
    Named(Bound<'py, PyDict>),
    Several(Vec<Bound<'py, Fit>>),
}

impl<'py> Compared<'py> {
    /// The models, and their names where they have such.
    fn with_names(self) -> Result<WithNames<'py>, Fault> {
        let named = match self {
            Compared::One(one) => return Ok((vec![one], None)),
            Compared::Several(models) => return Ok((models, None)),
            Compared::Named(named) => named,
        };
        let pair = |(name, model): (Bound<'py, PyAny>, Bound<'py, PyAny>)| {
            Ok::<_, PyErr>((model.cast_into::<Fit>()?, name.extract::<String>()?))
        };
        let (models, names) = named.iter().map(pair).collect::<PyResult<Vec<_>>>()?.into_iter().unzip();
        Ok((models, Some(names)))
    }
}

/// Compares models by their simulation, or by their prediction over a horizon of samples.
#[pyfunction]
#[pyo3(signature = (models, data, horizon=None, names=None))]
pub(crate) fn compare<'py>(
    models: Compared<'py>,
    data: &Bound<'py, Dataset>,
    horizon: Option<Horizon>,
    names: Option<Vec<String>>,
) -> Result<Bound<'py, PyAny>, Fault> {
    let (py, given) = (data.py(), data.get());
    let (models, own_names) = models.with_names()?;
    let horizon = horizon.map_or(Ok(None), Horizon::samples)?;
    let fits: Vec<&Fit> = models.iter().map(Bound::get).collect();
    let names = names.or(own_names).unwrap_or_else(|| fits.iter().map(|fit| fit.method().to_owned()).collect());
    let comparison = interrupt::quietly(py, || {
        let judged = |fit: &&Fit| {
            let about = fit.about_its_offset(given)?;
            judge(&fit.estimate, &about, horizon, &InitialState::Estimated)
        };
        Comparison { names, judgements: fits.iter().map(judged).collect() }
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
