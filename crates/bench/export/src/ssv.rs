//! The numbers of a model as parameter sets of SSP 1.0 (SSV), which tools for SSP 2.0 read too.
//!
//! Source: Modelica Association, *System Structure and Parameterization* 1.0.1, chapter 6.

use std::fmt::Write as _;

use bench_model::document::BenchModelDocument;
use bench_model::model::BenchModel;
use ident::ModelDocument;

use crate::draws::SEED;
use crate::names::Names;
use crate::numbers::{self, Number, Unit, written_by};
use crate::xml::escaped;
use crate::{ExportError, ExportedFile, draws};

/// `NAME.ssv` with the estimates, `NAME_uncertainty.ssv` with their covariance, and so many sets `NAME_draw_K.ssv` that
/// are drawn from it.
///
/// # Errors
/// [`ExportError::NoDraws`] where hardly any draw is a bench that can be.
pub fn bench(document: &BenchModelDocument, names: &Names, count: usize) -> Result<Vec<ExportedFile>, ExportError> {
    let title = &document.bench.name;
    let set = |suffix: &str, title: &str, model: &BenchModel| {
        let text = parameter_set(&Origin::of(document), title, &values(model, document.model.demand_lead()));
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

/// A parameter by name, with what it is, its value and its unit.
struct Parameter {
    name: String,
    description: String,
    value: f64,
    unit: Option<Unit>,
}

/// `NAME.ssv` with the estimated parameters of a linear model, and `NAME_uncertainty.ssv` with their covariance;
/// `version` is that of the program. Parameters of linear models have the units of their channels, which SSP cannot
/// say.
///
/// # Errors
/// [`ExportError::NoEstimate`] where the model has no estimated parameters.
pub fn linear(document: &ModelDocument, names: &Names, version: &str) -> Result<Vec<ExportedFile>, ExportError> {
    let estimate = document.estimate.as_ref().ok_or(ExportError::NoEstimate { target: "ssv" })?;
    let of_one = |(name, value): (&String, &f64)| Parameter {
        name: name.clone(),
        description: "estimated parameter".to_owned(),
        value: *value,
        unit: None,
    };
    let values: Vec<Parameter> = estimate.parameter_names.iter().zip(&estimate.parameters).map(of_one).collect();
    let names_of: Vec<&str> = estimate.parameter_names.iter().map(String::as_str).collect();
    let uncertainty = covariance("", &names_of, &estimate.covariance, estimate.degrees_of_freedom);
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

/// Origin of a set.
struct Origin<'a> {
    written_by: String,
    /// Remark on the numbers.
    note: Option<String>,
    version: &'a str,
}

impl<'a> Origin<'a> {
    fn of(document: &'a BenchModelDocument) -> Self {
        let note = numbers::demand_lead_sentence(&document.model);
        Origin { written_by: written_by(document), note, version: &document.provenance.dynoid_version }
    }
}

/// The values of the FMU's parameters, which take the demand so many samples before recordings have it.
fn values(model: &BenchModel, lead: usize) -> Vec<Parameter> {
    let parameter = |number: Number| {
        Some(Parameter {
            name: number.name.to_owned(),
            description: number.description.to_owned(),
            value: number.value?,
            unit: Some(number.unit),
        })
    };
    numbers::all_with_lead(model, lead).into_iter().filter_map(parameter).collect()
}

/// The covariance of each part. Parts are independent of one another.
fn uncertainty(document: &BenchModelDocument) -> Vec<Parameter> {
    let parts = numbers::covariance(document).into_iter().enumerate();
    parts
        .flat_map(|(part, (names, rows, degrees_of_freedom))| {
            covariance(&format!("_{}", part + 1), &names, &rows, degrees_of_freedom)
        })
        .collect()
}

/// The variances and covariances of parameters, each once, since SSP 1.0 has no arrays; and the degrees of freedom
/// where they are finite, whose name gets an ending.
fn covariance(ending: &str, names: &[&str], rows: &[Vec<f64>], degrees_of_freedom: f64) -> Vec<Parameter> {
    let entry = |(i, j): (usize, usize)| Parameter {
        name: format!("cov({},{})", names[i], names[j]),
        description: match i == j {
            true => format!("variance of {}, in its unit squared", names[i]),
            false => format!("covariance of {} and {}, in the product of their units", names[i], names[j]),
        },
        value: rows[i][j],
        unit: None,
    };
    let degrees = degrees_of_freedom.is_finite().then(|| Parameter {
        name: format!("degrees_of_freedom{ending}"),
        description: format!("degrees of freedom of the covariance of {}", names.join(", ")),
        value: degrees_of_freedom,
        unit: None,
    });
    (0..names.len()).flat_map(|i| (i..names.len()).map(move |j| (i, j))).map(entry).chain(degrees).collect()
}

fn parameter_set(origin: &Origin<'_>, title: &str, parameters: &[Parameter]) -> String {
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!-- {} -->\n<ssv:ParameterSet \
         xmlns:ssv=\"http://ssp-standard.org/SSP1/SystemStructureParameterValues\" \
         xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\" version=\"1.0\" name=\"{}\" \
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
        let _ = writeln!(
            text,
            "    <ssv:Parameter name=\"{}\" description=\"{}\"><ssv:Real value=\"{:?}\"{unit}/></ssv:Parameter>",
            escaped(&one.name),
            escaped(&one.description),
            one.value
        );
    }
    text.push_str("  </ssv:Parameters>\n");
    let units = units(parameters.iter().filter_map(|one| one.unit));
    if !units.is_empty() {
        let _ = write!(text, "  <ssv:Units>\n{units}  </ssv:Units>\n");
    }
    text.push_str("</ssv:ParameterSet>\n");
    text
}

/// The definitions of units, each once, by its exponents.
pub(crate) fn units(all: impl Iterator<Item = Unit>) -> String {
    let mut used: Vec<Unit> = Vec::new();
    for unit in all {
        if !used.contains(&unit) {
            used.push(unit);
        }
    }
    let definition = |unit: Unit| {
        let named = ["kg", "m", "s", "rad"].into_iter().zip(unit.exponents()).filter(|(_, exponent)| *exponent != 0);
        let exponents: String = named.map(|(name, exponent)| format!(" {name}=\"{exponent}\"")).collect();
        format!("    <ssc:Unit name=\"{}\"><ssc:BaseUnit{exponents}/></ssc:Unit>\n", unit.modelica())
    };
    used.into_iter().map(definition).collect()
}
