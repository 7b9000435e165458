//! A linear model in Modelica.

use std::fmt::Write as _;

use faer::MatRef;
use ident::{Label, ModelDocument};

use super::{number, text, units};
use crate::levels;
use crate::linear::Matrices;
use crate::names::Names;
use crate::{ExportError, ExportedFile};

/// The file `NAME.mo` with a model of inputs `u` and outputs `y`: continuous with its delays, or discrete on the clock
/// of its data.
///
/// # Errors
/// [`ExportError::Model`] where the model has no state space.
pub fn linear(document: &ModelDocument, names: &Names, version: &str) -> Result<ExportedFile, ExportError> {
    let matrices = Matrices::of(document)?;
    let class = &names.class;
    let levels = levels::sentence(document);
    let mut out = format!("// Written by dynoid {version}. {levels}\nwithin ;\nmodel {class} \"Linear model\"\n");
    channels(&mut out, "input", "u", &document.inputs);
    channels(&mut out, "output", "y", &document.outputs);
    match &matrices.continuous {
        Some((system, delays)) => {
            let delays = of_inputs(delays)?;
            continuous(&mut out, [system.a(), system.b(), system.c(), system.d()], &delays);
        }
        None => {
            let system = matrices.discrete.system();
            discrete(&mut out, [system.a(), system.b(), system.c(), system.d()], document.sample_time_s);
        }
    }
    let _ = writeln!(out, "end {class};");
    Ok(ExportedFile::text(format!("{class}.mo"), out))
}

fn channels(out: &mut String, kind: &str, letter: &str, labels: &[Label]) {
    for (i, label) in labels.iter().enumerate() {
        let unit = units::of_modelica(&label.unit).map(|unit| format!("(unit = \"{unit}\")")).unwrap_or_default();
        let _ =
            writeln!(out, "  {kind} Real {letter}{}{unit} \"{}, {}\";", i + 1, text(&label.name), text(&label.unit));
    }
}

/// The delay of each input, s, where all ways from it have the same one.
fn of_inputs(delays: &[Vec<f64>]) -> Result<Vec<f64>, ExportError> {
    let first = delays.first().cloned().unwrap_or_default();
    match delays.iter().all(|row| *row == first) {
        true => Ok(first),
        false => Err(ExportError::DelaysDiffer { target: "Modelica" }),
    }
}

fn continuous(out: &mut String, [a, b, c, d]: [MatRef<'_, f64>; 4], delays_s: &[f64]) {
    declare(out, "  Real x", a.nrows(), "(start = 0.0, fixed = true);\n");
    let input = |j: usize| {
        if delays_s[j] > 0.0 { format!("delay(u{}, {})", j + 1, number(delays_s[j])) } else { format!("u{}", j + 1) }
    };
    out.push_str("equation\n");
    for i in 0..a.nrows() {
        let _ = writeln!(out, "  der(x{}) = {};", i + 1, sum(a, b, i, |j| format!("x{}", j + 1), input));
    }
    for i in 0..c.nrows() {
        let _ = writeln!(out, "  y{} = {};", i + 1, sum(c, d, i, |j| format!("x{}", j + 1), input));
    }
}

fn discrete(out: &mut String, [a, b, c, d]: [MatRef<'_, f64>; 4], sample_time_s: f64) {
    declare(out, "  discrete Real x", a.nrows(), "(start = 0.0, fixed = true);\n");
    declare(out, "  discrete Real next", a.nrows(), "(start = 0.0, fixed = true);\n");
    let _ = writeln!(out, "equation\n  when sample(0.0, {}) then", number(sample_time_s));
    let (state, input) = (|j: usize| format!("x{}", j + 1), |j: usize| format!("u{}", j + 1));
    for i in 0..a.nrows() {
        let _ = writeln!(out, "    x{0} = pre(next{0});", i + 1);
        let _ = writeln!(out, "    next{} = {};", i + 1, sum(a, b, i, state, input));
    }
    for i in 0..c.nrows() {
        let _ = writeln!(out, "    y{} = {};", i + 1, sum(c, d, i, state, input));
    }
    out.push_str("  end when;\n");
}

fn declare(out: &mut String, name: &str, count: usize, end: &str) {
    for i in 1..=count {
        let _ = write!(out, "{name}{i}{end}");
    }
}

/// Row `i` of A x + B u, or C x + D u.
fn sum(
    of_states: MatRef<'_, f64>,
    of_inputs: MatRef<'_, f64>,
    i: usize,
    state: impl Fn(usize) -> String,
    input: impl Fn(usize) -> String,
) -> String {
    let states = (0..of_states.ncols()).map(|j| (of_states[(i, j)], state(j)));
    let inputs = (0..of_inputs.ncols()).map(|j| (of_inputs[(i, j)], input(j)));
    let terms = states.chain(inputs).filter(|(factor, _)| *factor != 0.0);
    let written: Vec<String> = terms.map(|(factor, name)| format!("({}) * {name}", number(factor))).collect();
    if written.is_empty() { "0.0".to_owned() } else { written.join(" + ") }
}
