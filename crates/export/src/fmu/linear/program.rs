//! A linear model for programs in C.

use ident::{Label, ModelDocument};

use super::super::csv;
use super::super::sources;
use super::model::rows;
use crate::levels;
use crate::linear::Matrices;
use crate::names::Names;
use crate::{ExportError, ExportedFile};

/// `NAME.h` with the matrices, `linear.c`, `linear.h` and `example.c`.
pub(super) fn files(document: &ModelDocument, names: &Names, version: &str) -> Result<Vec<ExportedFile>, ExportError> {
    let is_taken = ["linear", "example"].contains(&names.file.as_str());
    let name = if is_taken { format!("{}_model.h", names.file) } else { format!("{}.h", names.file) };
    let own = [
        ExportedFile::text(name.clone(), header(document, version)?),
        ExportedFile::text("example.c", example(&name, version)),
    ];
    Ok(own.into_iter().chain(sources::of_linear()).collect())
}

fn header(document: &ModelDocument, version: &str) -> Result<String, ExportError> {
    let matrices = Matrices::of(document)?;
    let system = matrices.discrete.system();
    let (n, m, p) = (system.states(), system.inputs(), system.outputs());
    let array = |name: &str, numbers: Vec<f64>| {
        let written: Vec<String> = numbers.into_iter().map(csv::number).collect();
        // C has no empty array.
        let written = if written.is_empty() { "0".to_owned() } else { written.join(", ") };
        format!("static const double {name}[] = {{{written}}};\n")
    };
    let arrays = array("MODEL_A", rows(system.a()))
        + &array("MODEL_B", rows(system.b()))
        + &array("MODEL_C", rows(system.c()))
        + &array("MODEL_D", rows(system.d()));
    let step = csv::number(document.sample_time_s);
    Ok(format!(
        "/* Written by dynoid {version}. A linear model: x(k + 1) = A x(k) + B u(k), y(k) = C x(k) + D u(k), every {step} s.\n * {}\n\
         {}{} */\n#ifndef LINEAR_MODEL_H\n#define LINEAR_MODEL_H\n\n#include \"linear.h\"\n\n\
         enum {{ MODEL_STATES = {n}, MODEL_INPUTS = {m}, MODEL_OUTPUTS = {p} }};\n\n{arrays}\n\
         static const linear_model MODEL = {{{n}, {m}, {p}, {step}, MODEL_A, MODEL_B, MODEL_C, MODEL_D}};\n\n#endif\n",
        levels::sentence(document),
        channels("u", &document.inputs),
        channels("y", &document.outputs),
    ))
}

/// A line a channel, for a comment.
fn channels(letter: &str, labels: &[Label]) -> String {
    let line = |(number, label): (usize, &Label)| {
        let text = format!("{}, {}", label.name, label.unit);
        let text: String = text.chars().filter(|c| !c.is_control()).collect();
        format!(" * {letter}[{number}]: {}\n", text.replace("*/", "").replace('\\', "/"))
    };
    labels.iter().enumerate().map(line).collect()
}

fn example(header: &str, version: &str) -> String {
    format!(
        "/* Written by dynoid {version}. A step of the first input after 10 samples. Compile: cc -std=c99 -O2 example.c linear.c -o example */\n\
         #include <stdio.h>\n#include <string.h>\n\n#include \"{header}\"\n\n\
         int main(void) {{\n    \
         double x[MODEL_STATES + 1] = {{0}}, next[MODEL_STATES + 1] = {{0}}, u[MODEL_INPUTS + 1] = {{0}}, y[MODEL_OUTPUTS];\n    \
         for (int k = 0; k < 200; k++) {{\n        \
         if (k == 10) u[0] = 1.0;\n        \
         linear_output(&MODEL, x, u, y);\n        \
         linear_advance(&MODEL, x, u, next);\n        \
         memcpy(x, next, sizeof x);\n        \
         printf(\"%g\", k * MODEL.sample_time_s);\n        \
         for (int i = 0; i < MODEL_OUTPUTS; i++) printf(\" %.17g\", y[i]);\n        \
         printf(\"\\n\");\n    \
         }}\n    return 0;\n}}\n"
    )
}
