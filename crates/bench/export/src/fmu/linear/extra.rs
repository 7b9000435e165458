//! Files about a linear model in an FMU's folder `extra`.

use faer::Mat;
use ident::{EstimateRecord, IdentError, ModelDocument};

use super::super::csv;
use super::super::extra::{Related, packed};
use super::description::{Description, Role};
use crate::ExportError;

/// Samples of the reference run.
const SAMPLES: usize = 201;
/// Samples from one input's step to the next.
const APART: usize = 10;

/// The files by their paths below `extra`.
pub(super) fn files(
    document: &ModelDocument,
    description: &Description<'_>,
) -> Result<Vec<(String, Vec<u8>)>, ExportError> {
    let (inputs, outputs) = reference(description)?;
    let mut related = vec![
        Related::csv("reference_in.csv", inputs, "experiment/smoke-test", "A step of each input after another"),
        Related::csv("reference_out.csv", outputs, "result", "What dynoid's own simulation has for that run"),
    ];
    if let Some(estimate) = &document.estimate {
        let text = covariance(estimate);
        related.push(Related::csv("covariance.csv", text, "parameter", "Covariance of the parameters"));
    }
    let model =
        serde_json::to_string_pretty(document).map_err(|error| ExportError::Text { reason: error.to_string() })?;
    related.push(Related::model(model));
    Ok(packed(related))
}

/// Inputs and outputs of a run from rest as tables.
fn reference(description: &Description<'_>) -> Result<(String, String), ExportError> {
    let system = &description.numbers.system;
    let count = system.inputs();
    let u = Mat::from_fn(SAMPLES, count, |k, j| if k >= APART * (j + 1) { 1.0 } else { 0.0 });
    let y = system.simulate(u.as_ref(), &vec![0.0; system.states()]).map_err(IdentError::from)?;
    let table = |role: Role, values: &Mat<f64>| {
        let names = description.of_role(role).map(|(_, variable)| quoted(&variable.name));
        let names: Vec<String> = std::iter::once("time".to_owned()).chain(names).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let row = |k: usize| {
            let time_s = k as f64 * description.numbers.sample_time_s;
            std::iter::once(time_s).chain((0..values.ncols()).map(|j| values[(k, j)])).collect()
        };
        csv::table(&names, (0..SAMPLES).map(row).collect::<Vec<Vec<f64>>>())
    };
    Ok((table(Role::Input, &u), table(Role::Output, &y)))
}

/// One row a parameter: its name, and its covariances with all of them.
fn covariance(estimate: &EstimateRecord) -> String {
    let names: Vec<String> = estimate.parameter_names.iter().map(|name| quoted(name)).collect();
    let mut text = format!("parameter,{}\n", names.join(","));
    for (name, row) in names.iter().zip(&estimate.covariance) {
        let cells: Vec<String> = row.iter().map(|value| csv::number(*value)).collect();
        text.push_str(&format!("{name},{}\n", cells.join(",")));
    }
    text
}

/// A name as a cell.
fn quoted(name: &str) -> String {
    let is_plain = !name.contains([',', '"', '\n', '\r']);
    if is_plain { name.to_owned() } else { format!("\"{}\"", name.replace('"', "\"\"")) }
}
