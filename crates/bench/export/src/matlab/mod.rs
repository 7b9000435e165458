//! Models for MATLAB and Octave: a MAT-file with matrices, names, units and covariance, and a function that makes
//! systems of it.

mod level5;
mod linear;

use bench_model::document::{BenchModelDocument, Range};
use bench_model::simulate::{LoopMode, linear_form};

use crate::continuous::{self, Continuous};
use crate::error::MOST_STATES;
use crate::linear::TICK_S;
use crate::names::{Names, one_line};
use crate::numbers::{self, Number, Unit, written_by};
use crate::{ExportError, ExportedFile};
use level5::{Value, file};
pub use linear::linear;

const FUNCTION: &str = include_str!("bench.m");

/// `NAME.mat` with the bench, and `NAME.m` that makes systems of it and draws them.
///
/// # Errors
/// [`ExportError::Simulation`] where the model has no linear form.
pub fn bench(document: &BenchModelDocument, names: &Names) -> Result<Vec<ExportedFile>, ExportError> {
    let writer = format!("dynoid {}", document.provenance.dynoid_version);
    let function = FUNCTION
        .replace("@NAME@", &names.file)
        .replace("@UPPER@", &names.file.to_uppercase())
        .replace("@BENCH@", &one_line(&document.bench.name))
        .replace("@WRITTEN@", &written_by(document));
    Ok(vec![
        ExportedFile { name: format!("{}.mat", names.file), content: file(&writer, "bench", &value(document)?) },
        ExportedFile::text(format!("{}.m", names.file), function),
    ])
}

/// Everything about the bench as one struct.
fn value(document: &BenchModelDocument) -> Result<Value, ExportError> {
    let model = &document.model;
    let all = numbers::all(model);
    let mut fields = vec![
        ("name", Value::Text(document.bench.name.clone())),
        ("written", Value::Text(written_by(document))),
        ("parameters", parameters(&all, |number| Value::row(number.value.as_slice()))),
        ("units", parameters(&all, |number| Value::Text(number.unit.plain().to_owned()))),
        ("descriptions", parameters(&all, |number| Value::Text(number.description.to_owned()))),
        ("covariance", Value::Cells(numbers::covariance(document).into_iter().map(covariance).collect())),
        ("valid", validity(document)),
        ("plant", continuous_system(&continuous::of(model))),
    ];
    if model.torque_control.is_some() {
        let tick = model.speed_controller.map_or(TICK_S, |pi| pi.sample_time_s);
        fields.push(("tn", discrete(document, LoopMode::Torque, tick)?));
        if model.speed_controller.is_some() {
            fields.push(("nt", discrete(document, LoopMode::Speed, tick)?));
            fields.push(("demand_lead", Value::number(model.demand_lead() as f64)));
        }
    }
    Ok(Value::Struct(fields))
}

/// A struct with a field for each number of the model.
fn parameters(all: &[Number], field: impl Fn(&Number) -> Value) -> Value {
    Value::Struct(all.iter().map(|number| (number.name, field(number))).collect())
}

fn covariance((names, rows, degrees_of_freedom): numbers::NamedCovariance) -> Value {
    Value::Struct(vec![
        ("names", Value::texts(names)),
        ("matrix", Value::of_rows(&rows)),
        ("degrees_of_freedom", Value::number(degrees_of_freedom)),
    ])
}

fn validity(document: &BenchModelDocument) -> Value {
    let range = |range: Option<Range>| range.map_or_else(|| Value::row(&[]), |(low, high)| Value::row(&[low, high]));
    let validity = &document.validity;
    Value::Struct(vec![
        ("w_d", range(validity.dyno_speed_rad_s)),
        ("T_d", range(validity.air_gap_torque_nm)),
        ("frequency_hz", range(validity.frequency_hz)),
    ])
}

/// The mechanics and the lag of the torque control; its delay is that of an input.
fn continuous_system(system: &Continuous) -> Value {
    let rows = |rows: &[Vec<f64>]| Value::of_rows(rows);
    Value::Struct(vec![
        ("A", rows(&system.a)),
        ("B", rows(&system.b)),
        ("C", rows(&system.c)),
        ("D", rows(&system.d)),
        ("Ts", Value::number(0.0)),
        ("InputDelay", Value::row(&system.input_delays_s)),
        ("StateName", Value::texts(system.states.iter().map(|(name, _)| name))),
        ("StateUnit", Value::texts(system.states.iter().map(|(_, unit)| unit.plain()))),
        ("InputName", Value::texts(system.inputs.iter().map(|(name, _)| name))),
        ("InputUnit", Value::texts(system.inputs.iter().map(|(_, unit)| unit.plain()))),
        ("OutputName", Value::texts(system.outputs.iter().map(|(name, _)| name))),
        ("OutputUnit", Value::texts(system.outputs.iter().map(|(_, unit)| unit.plain()))),
    ])
}

/// The bench in a control mode on the tick of its controller, exact below the torque limit.
fn discrete(document: &BenchModelDocument, mode: LoopMode, tick_s: f64) -> Result<Value, ExportError> {
    let form = linear_form(&document.model, mode, tick_s)?;
    let (system, states) = (&form.system, form.state_names());
    if states.len() > MOST_STATES {
        return Err(ExportError::TooLarge { target: "mat", states: states.len(), others: "python or modelica" });
    }
    let matrix = |m: faer::MatRef<'_, f64>| Value::matrix(m.nrows(), m.ncols(), |i, j| m[(i, j)]);
    let inputs = match mode {
        LoopMode::Speed => [("w_d_demand", Unit::Speed), ("T_e", Unit::Torque)],
        LoopMode::Torque => [("T_d_demand", Unit::Torque), ("T_e", Unit::Torque)],
    };
    let outputs = [
        ("w_d", Unit::Speed),
        ("w_e", Unit::Speed),
        ("T_d", Unit::Torque),
        ("T_shaft", Unit::Torque),
        ("T_d_demand", Unit::Torque),
    ];
    Ok(Value::Struct(vec![
        ("A", matrix(system.a())),
        ("B", matrix(system.b())),
        ("C", matrix(system.c())),
        ("D", matrix(system.d())),
        ("Ts", Value::number(tick_s)),
        ("StateName", Value::texts(states)),
        ("InputName", Value::texts(inputs.iter().map(|(name, _)| name))),
        ("InputUnit", Value::texts(inputs.iter().map(|(_, unit)| unit.plain()))),
        ("OutputName", Value::texts(outputs.iter().map(|(name, _)| name))),
        ("OutputUnit", Value::texts(outputs.iter().map(|(_, unit)| unit.plain()))),
    ]))
}
