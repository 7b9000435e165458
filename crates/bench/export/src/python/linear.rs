//! A linear model as a Python module.

use std::fmt::Write as _;

use faer::MatRef;
use ident::{Label, ModelDocument};

use super::{BEGIN, list, number};
use crate::levels::{self, Levels};
use crate::linear::Matrices;
use crate::names::Names;
use crate::{ExportError, ExportedFile};

const MODULE: &str = include_str!("linear.py");

/// The module `NAME.py` with the model on the clock of its data; `version` is that of the program.
///
/// # Errors
/// [`ExportError::Model`] where the model has no state space.
pub fn linear(document: &ModelDocument, names: &Names, version: &str) -> Result<ExportedFile, ExportError> {
    let matrices = Matrices::of(document)?;
    let (discrete, system) = (&matrices.discrete, matrices.discrete.system());
    let mut data = format!("SAMPLE_TIME = {}\n", number(document.sample_time_s));
    let _ = write!(data, "INPUTS = {}\nOUTPUTS = {}\n", labels(&document.inputs), labels(&document.outputs));
    let levels = Levels::of(document);
    let written = |of: fn(&Levels) -> &Vec<f64>| levels.as_ref().map_or("None".to_owned(), |levels| list(of(levels)));
    let _ = write!(data, "INPUT_LEVELS = {}\nOUTPUT_LEVELS = {}\n", written(|l| &l.inputs), written(|l| &l.outputs));
    for (name, value) in
        [("A", system.a()), ("B", system.b()), ("C", system.c()), ("D", system.d()), ("K", discrete.k())]
    {
        let _ = writeln!(data, "{name} = {}", matrix(value));
    }
    let _ = writeln!(data, "NOISE_COVARIANCE = {}", matrix(discrete.noise_covariance()));
    let text = MODULE
        .replace("@LEVELS@", &levels::sentence(document))
        .replace("@VERSION@", version)
        .replace("@MODULE@", &names.file)
        .replace(BEGIN, &format!("{BEGIN}{data}"));
    Ok(ExportedFile::text(format!("{}.py", names.file), text))
}

/// Names with units. JSON's strings are strings of Python.
fn labels(labels: &[Label]) -> String {
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let pairs: Vec<String> = labels.iter().map(|l| format!("({}, {})", quoted(&l.name), quoted(&l.unit))).collect();
    format!("[{}]", pairs.join(", "))
}

/// An array of numpy that keeps its shape where it is empty.
fn matrix(m: MatRef<'_, f64>) -> String {
    let rows: Vec<String> =
        (0..m.nrows()).map(|i| list(&(0..m.ncols()).map(|j| m[(i, j)]).collect::<Vec<f64>>())).collect();
    format!("np.array([{}], dtype=float).reshape({}, {})", rows.join(", "), m.nrows(), m.ncols())
}
