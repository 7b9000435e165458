//! Files about the model in an FMU's folder `extra`, with the manifest of FMI-LS-REF (Layered Standard References,
//! 1.0.0-alpha.1).

use bench_model::document::BenchModelDocument;

use super::description::attribute;
use super::numbers::BenchNumbers;
use super::{csv, reference};
use crate::numbers::covariance;
use crate::{ExportError, ssv};

/// The folder below `extra`.
pub(super) const FOLDER: &str = "org.fmi-standard.fmi-ls-ref";
/// The model file there.
pub(super) const MODEL: &str = "model.json";

/// A file with its type, its role in FMI-LS-REF, and a sentence.
pub(super) struct Related {
    name: &'static str,
    content: Vec<u8>,
    media_type: &'static str,
    role: &'static str,
    description: &'static str,
}

impl Related {
    pub(super) fn csv(name: &'static str, text: String, role: &'static str, description: &'static str) -> Self {
        Related { name, content: text.into_bytes(), media_type: "text/csv", role, description }
    }

    /// The model file, from which the commands of dynoid read the model.
    pub(super) fn model(text: String) -> Self {
        let (media_type, role) = ("application/json", "model");
        let description = "Model file of dynoid";
        Related { name: MODEL, content: text.into_bytes(), media_type, role, description }
    }
}

/// The files by their paths below `extra`.
///
/// # Errors
/// [`ExportError::Simulation`] where the reference trajectory cannot be made.
pub(super) fn files(
    document: &BenchModelDocument,
    numbers: &BenchNumbers,
    report: Option<&[u8]>,
) -> Result<Vec<(String, Vec<u8>)>, ExportError> {
    let run = reference::run(&document.model.with_demand_of_controller(), numbers)?;
    let mut related = vec![
        Related::csv("reference_in.csv", run.inputs, "experiment/smoke-test", "Inputs of a run of 1001 samples"),
        Related::csv("reference_out.csv", run.outputs, "result", "What dynoid's own simulation has for that run"),
        Related::csv("covariance.csv", covariances(document), "parameter", "Covariance of the parameters, SI units"),
    ];
    if !numbers.draws.is_empty() {
        let draws = csv::table(&numbers.drawn, numbers.draws.iter().cloned());
        let description = "Draws of the parameters from their covariance; row k is the parameter draw = k";
        related.push(Related::csv("draws.csv", draws, "experiment/uncertainty-analysis", description));
        related.push(draws_ssv(document, numbers));
    }
    if let Some(report) = report {
        let (content, description) = (report.to_vec(), "Report of the study");
        related.push(Related { name: "report.html", content, media_type: "text/html", role: "report", description });
    }
    let model = document.to_json().map_err(|error| ExportError::Text { reason: error.to_string() })?;
    related.push(Related::model(model));
    Ok(packed(related))
}

/// Files with their manifest, by their paths below `extra`.
pub(super) fn packed(related: Vec<Related>) -> Vec<(String, Vec<u8>)> {
    let manifest = ("fmi-ls-manifest.xml".to_owned(), manifest(&related).into_bytes());
    let all = related.into_iter().map(|file| (file.name.to_owned(), file.content));
    let below = |(name, content)| (format!("{FOLDER}/{name}"), content);
    std::iter::once(manifest).chain(all).map(below).collect()
}

/// One row a parameter: its name, and its covariances with all the others. Parts of the model are independent.
fn covariances(document: &BenchModelDocument) -> String {
    let parts = covariance(document);
    let names: Vec<&str> = parts.iter().flat_map(|(names, ..)| names.iter().copied()).collect();
    let mut text = format!("parameter,{}\n", names.join(","));
    let mut before = 0;
    for (own, rows, _) in &parts {
        for (name, row) in own.iter().zip(rows) {
            let cells = (0..names.len()).map(|column| {
                let entry = column.checked_sub(before).and_then(|column| row.get(column));
                csv::number(entry.copied().unwrap_or(0.0))
            });
            let cells: Vec<String> = cells.collect();
            text.push_str(&format!("{name},{}\n", cells.join(",")));
        }
        before += own.len();
    }
    text
}

fn manifest(related: &[Related]) -> String {
    let entries: String = related
        .iter()
        .map(|file| {
            let mut head = attribute("type", file.media_type);
            head += &attribute("source", file.name);
            head += &attribute("role", file.role);
            head += &attribute("description", file.description);
            format!("  <Related{head}/>\n")
        })
        .collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiReferences xmlns:fmi-ls=\"http://fmi-standard.org/fmi-ls-manifest\" \
         fmi-ls:fmi-ls-name=\"org.fmi-standard.fmi-ls-ref\" fmi-ls:fmi-ls-version=\"1.0.0-alpha.1\" \
         fmi-ls:fmi-ls-description=\"Layered Standard providing information on related files included in an FMU.\">\n\
         {entries}</fmiReferences>\n"
    )
}

/// The draws as a parameter set of SSP 2.0, which has arrays: for each parameter one number a draw.
fn draws_ssv(document: &BenchModelDocument, numbers: &BenchNumbers) -> Related {
    let unit_of = |name: &str| numbers.parameters.iter().find(|one| one.name == name).map(|one| one.unit);
    let dimension = format!("<ssc:Dimension{}/>", attribute("size", &numbers.draws.len().to_string()));
    let parameter = |(column, name): (usize, &&str)| {
        let values: Vec<String> = numbers.draws.iter().map(|row| csv::number(row[column])).collect();
        let unit = unit_of(name).map_or_else(String::new, |unit| attribute("unit", unit.modelica()));
        let (name, values) = (attribute("name", name), attribute("value", &values.join(" ")));
        format!("    <ssv:Parameter{name}><ssv:Float64{values}{unit}/>{dimension}</ssv:Parameter>\n")
    };
    let parameters: String = numbers.drawn.iter().enumerate().map(parameter).collect();
    let units = ssv::units(numbers.drawn.iter().filter_map(|name| unit_of(name)));
    let name = attribute("name", &format!("{}: draws", document.bench.name));
    let text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <ssv:ParameterSet xmlns:ssv=\"http://ssp-standard.org/SSP1/SystemStructureParameterValues\" \
         xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\" version=\"2.0\"{name}>\n  \
         <ssv:Parameters>\n{parameters}  </ssv:Parameters>\n  <ssv:Units>\n{units}  </ssv:Units>\n</ssv:ParameterSet>\n"
    );
    Related {
        name: "draws.ssv",
        content: text.into_bytes(),
        media_type: "application/x-ssp-parameter-set",
        role: "parameter",
        description: "The draws as arrays, one number a draw",
    }
}
