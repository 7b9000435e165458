//! The numbers of a model as parameter sets of SSP 2.0 (SSV).
//!
//! Source: Modelica Association, *System Structure and Parameterization* 2.0, chapter 6.

use std::fmt::Write as _;

use bench_model::document::BenchModelDocument;
use bench_model::model::BenchModel;
use ident::ModelDocument;

use crate::names::Names;
use crate::numbers::{self, Number, Unit, written_by};
use crate::xml::escaped;
use crate::{ExportError, ExportedFile, draws};

/// Seed of the draws: the same model gives the same files.
const SEED: u64 = 1;

/// `NAME.ssv` with the estimates, `NAME_uncertainty.ssv` with their covariance as an array, and so many sets `NAME_draw_K.ssv` that are
/// drawn from it.
///
/// # Errors
/// [`ExportError::NoDraws`] where hardly any draw is a bench that can be.
pub fn bench(document: &BenchModelDocument, names: &Names, count: usize) -> Result<Vec<ExportedFile>, ExportError> {
    let title = &document.bench.name;
    let set = |suffix: &str, title: &str, model: &BenchModel| {
        let text = parameter_set(&Origin::of(document), title, &values(model));
        ExportedFile::text(format!("{}{suffix}.ssv", names.file), text)
    };
    let mut files = vec![set("", title, &document.model)];
    if document.uncertainty.parameters().next().is_some() {
        let text = parameter_set(&Origin::of(document), &format!("{title}: uncertainty"), &uncertainty(document));
        files.push(ExportedFile::text(format!("{}_uncertainty.ssv", names.file), text));
    }
    let drawn = draws(document, count, SEED);
    if drawn.len() < count {
        return Err(ExportError::NoDraws);
    }
    for (number, model) in drawn.iter().enumerate() {
        let number = number + 1;
        files.push(set(&format!("_draw_{number}"), &format!("{title}: draw {number}"), model));
    }
    Ok(files)
}

/// A parameter by name, with what it is, its values row by row, and its unit.
struct Parameter {
    name: String,
    description: String,
    values: Vec<f64>,
    /// Rows and columns of a square matrix; none of a single value.
    size: Option<usize>,
    unit: Option<Unit>,
}

/// `NAME.ssv` with the estimated parameters of a linear model, and `NAME_uncertainty.ssv` with their covariance as an array; `version`
/// is that of the program. Parameters of linear models have the units of their channels, which SSP cannot say.
///
/// # Errors
/// [`ExportError::NoEstimate`] where the model has no estimated parameters.
pub fn linear(document: &ModelDocument, names: &Names, version: &str) -> Result<Vec<ExportedFile>, ExportError> {
    let estimate = document.estimate.as_ref().ok_or(ExportError::NoEstimate { target: "ssv" })?;
    let parameter = |name: &str, description: String, values: Vec<f64>, size: Option<usize>| Parameter {
        name: name.to_owned(),
        description,
        values,
        size,
        unit: None,
    };
    let of_one = |(name, value): (&String, &f64)| parameter(name, "estimated parameter".to_owned(), vec![*value], None);
    let values: Vec<Parameter> = estimate.parameter_names.iter().zip(&estimate.parameters).map(of_one).collect();
    let (order, size) = (estimate.parameter_names.join(", "), estimate.parameter_names.len());
    let mut uncertainty = vec![parameter(
        "covariance",
        format!("covariance of {order}, {size} x {size} in row-major order"),
        estimate.covariance.concat(),
        Some(size),
    )];
    if estimate.degrees_of_freedom.is_finite() {
        let degrees = vec![estimate.degrees_of_freedom];
        uncertainty.push(parameter("degrees_of_freedom", "of the covariance".to_owned(), degrees, None));
    }
    let origin = Origin { written_by: format!("Written by dynoid {version}"), note: None, version };
    let title = &names.file;
    Ok(vec![
        ExportedFile::text(format!("{title}.ssv"), parameter_set(&origin, title, &values)),
        ExportedFile::text(
            format!("{title}_uncertainty.ssv"),
            parameter_set(&origin, &format!("{title}: uncertainty"), &uncertainty),
        ),
    ])
}

/// What wrote a set.
struct Origin<'a> {
    written_by: String,
    /// What to know about the numbers.
    note: Option<String>,
    version: &'a str,
}

impl<'a> Origin<'a> {
    fn of(document: &'a BenchModelDocument) -> Self {
        let note = numbers::demand_lead_sentence(&document.model);
        Origin { written_by: written_by(document), note, version: &document.provenance.dynoid_version }
    }
}

/// The values of the FMU's parameters, which take the demand as the controller has it.
fn values(model: &BenchModel) -> Vec<Parameter> {
    let parameter = |number: Number| {
        Some(Parameter {
            name: number.name.to_owned(),
            description: number.description.to_owned(),
            values: vec![number.value?],
            size: None,
            unit: Some(number.unit),
        })
    };
    numbers::all(model).into_iter().filter_map(parameter).collect()
}

/// Of each part its covariance, in the order that the description states, and its degrees of freedom where they are finite.
fn uncertainty(document: &BenchModelDocument) -> Vec<Parameter> {
    let mut all = Vec::new();
    for (number, (names, rows, degrees_of_freedom)) in numbers::covariance(document).into_iter().enumerate() {
        let order = names.join(", ");
        all.push(Parameter {
            name: format!("covariance_{}", number + 1),
            description: format!("covariance of {order}, {0} x {0} in row-major order, SI", names.len()),
            values: rows.concat(),
            size: Some(names.len()),
            unit: None,
        });
        if degrees_of_freedom.is_finite() {
            all.push(Parameter {
                name: format!("degrees_of_freedom_{}", number + 1),
                description: format!("degrees of freedom of the covariance of {order}"),
                values: vec![degrees_of_freedom],
                size: None,
                unit: None,
            });
        }
    }
    all
}

fn parameter_set(origin: &Origin<'_>, title: &str, parameters: &[Parameter]) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- {} -->\n<ssv:ParameterSet \
         xmlns:ssv=\"http://ssp-standard.org/SSP1/SystemStructureParameterValues\" \
         xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\" version=\"2.0\" name=\"{}\" \
         generationTool=\"dynoid {}\">\n  <ssv:Parameters>\n",
        [Some(&origin.written_by), origin.note.as_ref()]
            .into_iter()
            .flatten()
            .map(|text| text.replace("--", "-"))
            .collect::<Vec<_>>()
            .join(" "),
        escaped(title),
        escaped(origin.version)
    );
    for one in parameters {
        let unit = one.unit.map(|unit| format!(" unit=\"{}\"", unit.modelica())).unwrap_or_default();
        let values: Vec<String> = one.values.iter().map(|value| format!("{value:?}")).collect();
        // Without dimensions the parameter would be a scalar.
        let dimensions = one.size.map(|size| format!("<ssc:Dimension size=\"{size}\"/>").repeat(2)).unwrap_or_default();
        let _ = writeln!(
            text,
            "    <ssv:Parameter name=\"{}\" description=\"{}\"><ssv:Float64 value=\"{}\"{unit}/>{dimensions}</ssv:Parameter>",
            escaped(&one.name),
            escaped(&one.description),
            values.join(" ")
        );
    }
    text.push_str("  </ssv:Parameters>\n");
    text.push_str(&units(parameters));
    text.push_str("</ssv:ParameterSet>\n");
    text
}

/// The units that are used, each by its exponents.
fn units(parameters: &[Parameter]) -> String {
    let mut used: Vec<Unit> = Vec::new();
    for unit in parameters.iter().filter_map(|one| one.unit) {
        if !used.contains(&unit) {
            used.push(unit);
        }
    }
    if used.is_empty() {
        return String::new();
    }
    let mut text = String::from("  <ssv:Units>\n");
    for unit in used {
        let named = ["kg", "m", "s", "rad"].into_iter().zip(unit.exponents()).filter(|(_, exponent)| *exponent != 0);
        let exponents: String = named.map(|(name, exponent)| format!(" {name}=\"{exponent}\"")).collect();
        let _ = writeln!(text, "    <ssc:Unit name=\"{}\"><ssc:BaseUnit{exponents}/></ssc:Unit>", unit.modelica());
    }
    text.push_str("  </ssv:Units>\n");
    text
}
