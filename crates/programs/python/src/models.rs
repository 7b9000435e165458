//! Bench models: exported to other programs, and compared.

use std::path::PathBuf;

use ::study::{compare_models, document};
use dynoid::{Error, Export, ExportTarget};
use pyo3::prelude::*;

use crate::dataset::one_of;
use crate::errors::Fault;
use crate::interrupt;
use crate::made::{Made, files};
use crate::tried::Model;

/// Writes a model as the files of another program, and returns their paths.
#[pyfunction]
pub(crate) fn export(
    py: Python<'_>,
    model: Model,
    to: &str,
    out: Option<PathBuf>,
    draws: usize,
    overwrite: bool,
) -> Result<Vec<PathBuf>, Fault> {
    let targets = [
        ("mat", ExportTarget::Mat),
        ("modelica", ExportTarget::Modelica),
        ("python", ExportTarget::Python),
        ("fmu2", ExportTarget::Fmu2),
        ("fmu3", ExportTarget::Fmu3),
        ("c", ExportTarget::C),
        ("ssp", ExportTarget::Ssp),
        ("ssv", ExportTarget::Ssv { draws }),
        ("linear", ExportTarget::Linear),
    ];
    let target = one_of("to", to, &targets)?;
    Ok(interrupt::quietly(py, || {
        let files = files(overwrite);
        let export = match &model.path {
            Some(path) => Export::of_file(path, target, out.as_deref(), &files)?,
            None => {
                let folder = out.unwrap_or_else(|| PathBuf::from("."));
                Export::of_bench(&model.document()?, target, &folder)?
            }
        };
        Ok::<_, Error>(export.write(&files)?.files)
    })??)
}

/// Two bench models, compared.
#[pyfunction]
pub(crate) fn difference(py: Python<'_>, old: Model, new: Model, names: (String, String)) -> Result<Made, Fault> {
    Ok(interrupt::quietly(py, || {
        let (old, new) = (old.document()?, new.document()?);
        let found = compare_models(&old, &new);
        let page = report::comparison::page(&found, [(&names.0, &old), (&names.1, &new)]);
        Ok::<_, Error>(Made::whole(&found, page, &document::MODEL_COMPARISON, &found)?.with_answer(found.has_changed()))
    })??)
}
