//! A linear model for MATLAB and Octave.

use faer::MatRef;
use ident::{Label, ModelDocument};
use lti::StateSpace;

use super::level5::{Value, file};
use crate::levels::{self, Levels};
use crate::linear::Matrices;
use crate::names::Names;
use crate::{ExportError, ExportedFile};

const FUNCTION: &str = include_str!("linear.m");

/// `NAME.mat` with the model, and `NAME.m` that makes a system of it; `version` is that of the program.
///
/// # Errors
/// [`ExportError::Model`] where the model has no state space.
pub fn linear(document: &ModelDocument, names: &Names, version: &str) -> Result<Vec<ExportedFile>, ExportError> {
    let matrices = Matrices::of(document)?;
    let mut fields = vec![
        ("InputName", of_labels(&document.inputs, |label| &label.name)),
        ("InputUnit", of_labels(&document.inputs, |label| &label.unit)),
        ("OutputName", of_labels(&document.outputs, |label| &label.name)),
        ("OutputUnit", of_labels(&document.outputs, |label| &label.unit)),
    ];
    let discrete = &matrices.discrete;
    let mut on_the_clock = system(discrete.system());
    on_the_clock.push(("K", matrix(discrete.k())));
    on_the_clock.push(("NoiseVariance", matrix(discrete.noise_covariance())));
    fields.push(("discrete", Value::Struct(on_the_clock)));
    if let Some((continuous, delays)) = &matrices.continuous {
        let mut parts = system(continuous);
        parts.push(("IODelay", Value::of_rows(delays)));
        fields.push(("continuous", Value::Struct(parts)));
    }
    if let Some(estimate) = &document.estimate {
        fields.push((
            "estimate",
            Value::Struct(vec![
                ("parameter_names", Value::texts(&estimate.parameter_names)),
                ("parameters", Value::row(&estimate.parameters)),
                ("covariance", Value::of_rows(&estimate.covariance)),
                ("degrees_of_freedom", Value::number(estimate.degrees_of_freedom)),
            ]),
        ));
    }
    if let Some(levels) = Levels::of(document) {
        fields.push(("InputOffset", Value::row(&levels.inputs)));
        fields.push(("OutputOffset", Value::row(&levels.outputs)));
    }
    let function = FUNCTION
        .replace("@LEVELS@", &levels::sentence(document))
        .replace("@NAME@", &names.file)
        .replace("@UPPER@", &names.file.to_uppercase())
        .replace("@VERSION@", version);
    let content = file(&format!("dynoid {version}"), "model", &Value::Struct(fields));
    Ok(vec![
        ExportedFile { name: format!("{}.mat", names.file), content },
        ExportedFile::text(format!("{}.m", names.file), function),
    ])
}

fn of_labels(labels: &[Label], text: impl Fn(&Label) -> &String) -> Value {
    Value::texts(labels.iter().map(text))
}

fn matrix(m: MatRef<'_, f64>) -> Value {
    Value::matrix(m.nrows(), m.ncols(), |i, j| m[(i, j)])
}

fn system(of: &StateSpace) -> Vec<(&'static str, Value)> {
    vec![
        ("A", matrix(of.a())),
        ("B", matrix(of.b())),
        ("C", matrix(of.c())),
        ("D", matrix(of.d())),
        ("Ts", Value::number(of.sample_time_s().unwrap_or(0.0))),
    ]
}
