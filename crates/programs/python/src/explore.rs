//! Looks at data before a model is chosen: spectra, delays and orders.

use ident::{IdentError, OrderScan};
use pyo3::prelude::*;
use serde::Serialize;
use toolbox_report::delay::{Delays, Known, spacing};
use toolbox_report::order::Orders;
use toolbox_report::spectrum::{self, Periods, SpectrumFacts, SpectrumMethod, SpectrumOptions};

use crate::dataset::{Dataset, one_of};
use crate::errors::Fault;
use crate::interrupt;
use crate::made::Made;

/// The spectra under the name of the list.
#[derive(Serialize)]
struct SpectraFacts {
    spectra: Vec<SpectrumFacts>,
}

/// Of each experiment the power spectra of the outputs, or their responses to the inputs.
#[pyfunction]
pub(crate) fn spectra(
    data: &Bound<'_, Dataset>,
    method: Option<&str>,
    period: Option<f64>,
    window: Option<usize>,
) -> Result<Made, Fault> {
    let methods = [
        ("welch", SpectrumMethod::Welch),
        ("blackman-tukey", SpectrumMethod::BlackmanTukey),
        ("lpm", SpectrumMethod::Lpm),
        ("lrm", SpectrumMethod::Lrm),
        ("etfe", SpectrumMethod::Etfe),
    ];
    let method = method.map(|method| one_of("method", method, &methods)).transpose()?;
    let own = complete(data)?;
    if matches!(method, Some(SpectrumMethod::Welch | SpectrumMethod::Etfe)) && own.inputs() > 1 {
        let message = "method: welch and etfe take one input; lpm, lrm and blackman-tukey take several";
        return Err(Fault::argument(message));
    }
    let periods = period.map_or(Periods::Found, Periods::Given);
    let options = SpectrumOptions { method, periods, window };
    let found = interrupt::quietly(data.py(), || spectrum::spectra(own, &options))?.map_err(IdentError::from)?;
    Ok(Made::new(&SpectraFacts { spectra: spectrum::facts(&found) }, spectrum::page(&found))?)
}

/// Dead times beside dynamics, and what other methods say.
#[pyfunction]
pub(crate) fn delays(
    data: &Bound<'_, Dataset>,
    longest: usize,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> Result<Made, Fault> {
    let own = &data.get().data;
    let known = Known { adjustments: &[], spacing: spacing(own), clock_is_given: false, between_is_given: false };
    let found =
        interrupt::run(data.py(), progress, threads, |context| Delays::of(own.clone(), &known, longest, context))??;
    let facts = found.facts();
    Ok(Made::new(&facts, found.page())?.with_notes(facts.notes))
}

/// ARX structures, ranked by several criteria; on data that none was fitted to, where there are such.
#[pyfunction]
pub(crate) fn orders(
    data: &Bound<'_, Dataset>,
    na: (usize, usize),
    nb: (usize, usize),
    nk: (usize, usize),
    validation: Option<&Bound<'_, Dataset>>,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> Result<Made, Fault> {
    let ranges = [na.0..=na.1, nb.0..=nb.1, nk.0..=nk.1];
    let [na, nb, nk] = ranges.clone();
    let scan = OrderScan::new(na, nb, nk);
    let (own, unseen) = (complete(data)?, validation.map(complete).transpose()?);
    let table = interrupt::run(data.py(), progress, threads, |context| scan.run_as_step(context, own, unseen))??;
    let found = Orders { table, ranges, is_validated: unseen.is_some() };
    Ok(Made::new(&found.facts(), found.page())?)
}

/// Data in which nothing is missing.
fn complete<'a>(data: &'a Bound<'_, Dataset>) -> Result<&'a ident::Dataset, Fault> {
    let own = &data.get().data;
    if own.gaps().is_empty() {
        return Ok(own);
    }
    Err(Fault::argument("samples are missing; cut the data there with without_gaps, or fill the gaps with fill_gaps"))
}
