//! Models as Python modules that need numpy alone.

mod linear;

use std::fmt::Write as _;

use bench_model::document::{BenchModelDocument, Range};

use crate::ExportedFile;
use crate::names::{Names, one_line};
use crate::numbers::{self, written_by};
use crate::start::{start_nm, start_rad_s};
pub use linear::linear;

/// The module without the numbers of the model.
const MODULE: &str = include_str!("bench.py");
const BEGIN: &str = "# begin of the model\n";

/// The module `NAME.py`: the model's numbers, and the simulation as [`bench_model::simulate`] has it.
#[must_use]
pub fn bench(document: &BenchModelDocument, names: &Names) -> ExportedFile {
    let model = &document.model;
    let (speed, torque) = (start_rad_s(&document.validity), start_nm(&document.validity));
    let example = match model.speed_controller.and(model.torque_control) {
        Some(_) => format!("speed_demand=np.full(2000, {})", number(speed)),
        None if model.torque_control.is_some() => format!("torque_demand=np.full(2000, {})", number(torque)),
        None => format!("air_gap_torque=np.full(2000, {})", number(torque)),
    };
    let title = format!("{} {}", sentence(&document.bench.name), written_by(document));
    let text = MODULE
        .replace("@TITLE@", &format!("Bench model {title}"))
        .replace("@MODULE@", &names.file)
        .replace("@SPEED@", &number(speed))
        .replace("@TORQUE@", &number(torque))
        .replace("@MORE@", &number(torque + 20.0))
        .replace("@EXAMPLE@", &example)
        .replace(BEGIN, &format!("{BEGIN}{}", data(document)));
    ExportedFile::text(format!("{}.py", names.file), text)
}

/// The numbers of the model as Python.
fn data(document: &BenchModelDocument) -> String {
    let mut text = String::from("PARAMETERS = {\n");
    for number in numbers::all(&document.model) {
        let (value, unit) = (optional(number.value), number.unit.plain());
        let _ = writeln!(text, "    \"{}\": {value},  # {unit}: {}", number.name, number.description);
    }
    text.push_str("}\n");
    if document.model.speed_controller.is_some() {
        let words = numbers::demand_lead_sentence(&document.model);
        let words = words.unwrap_or_else(|| "Recordings have the speed demand as the controller does.".to_owned());
        let _ = writeln!(text, "# Ticks by which a recorded speed demand is to be advanced. {words}");
        let _ = writeln!(text, "DEMAND_LEAD = {}", document.model.demand_lead());
    }
    text.push_str("# Covariance of independent parts: names, matrix, degrees of freedom.\nCOVARIANCE = [\n");
    for (names, covariance, degrees_of_freedom) in numbers::covariance(document) {
        let rows: Vec<String> = covariance.iter().map(|row| list(row)).collect();
        let degrees = number(degrees_of_freedom);
        let _ = writeln!(text, "    ({names:?}, [{}], {degrees}),", rows.join(", "));
    }
    let validity = &document.validity;
    let _ = write!(
        text,
        "]\n# Range of the recordings that the model was estimated from: lowest and highest value.\n\
         VALIDITY = {{\"w_d\": {}, \"T_d\": {}, \"frequency_hz\": {}}}\n",
        range(validity.dyno_speed_rad_s),
        range(validity.air_gap_torque_nm),
        range(validity.frequency_hz)
    );
    text
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(|| "None".to_owned(), number)
}

/// A number that Python reads back bit for bit.
fn number(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { format!("float(\"{value}\")") }
}

fn list(values: &[f64]) -> String {
    format!("[{}]", values.iter().map(|value| number(*value)).collect::<Vec<_>>().join(", "))
}

fn range(range: Option<Range>) -> String {
    range.map_or_else(|| "None".to_owned(), |(low, high)| format!("({}, {})", number(low), number(high)))
}

/// A text for a comment, or for a string between three quotes.
fn sentence(text: &str) -> String {
    format!("“{}”.", one_line(text).replace(['\\', '"'], "'"))
}
