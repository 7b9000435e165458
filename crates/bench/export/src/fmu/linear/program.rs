//! A linear model for programs in C.

use ident::{Label, ModelDocument};

use super::super::csv;
use super::super::sources::{self, CNames};
use super::model::rows;
use crate::levels;
use crate::linear::Matrices;
use crate::names::Names;
use crate::{ExportError, ExportedFile};

/// `NAME.h` with the matrices, `NAME_example.c`, `linear.c` and `linear.h`.
pub(super) fn files(document: &ModelDocument, names: &Names, version: &str) -> Result<Vec<ExportedFile>, ExportError> {
    let names = CNames::of(names);
    let own = [
        ExportedFile::text(names.header.clone(), header(document, version, &names.numbers)?),
        ExportedFile::text(names.example.clone(), example(&names, version)),
    ];
    Ok(own.into_iter().chain(sources::of_linear()).collect())
}

fn header(document: &ModelDocument, version: &str, name: &str) -> Result<String, ExportError> {
    let matrices = Matrices::of(document)?;
    let system = matrices.discrete.system();
    let (n, m, p) = (system.states(), system.inputs(), system.outputs());
    let array = |letter: &str, numbers: Vec<f64>| {
        let written: Vec<String> = numbers.into_iter().map(csv::number).collect();
        // C has no empty array.
        let written = if written.is_empty() { "0".to_owned() } else { written.join(", ") };
        format!("static const double {name}_{letter}[] = {{{written}}};\n")
    };
    let arrays = array("A", rows(system.a()))
        + &array("B", rows(system.b()))
        + &array("C", rows(system.c()))
        + &array("D", rows(system.d()));
    let step = csv::number(document.sample_time_s);
    Ok(format!(
        "/* Written by dynoid {version}. A linear model: x(k + 1) = A x(k) + B u(k), y(k) = C x(k) + D u(k), every {step} s.\n * {}\n\
         {}{} */\n#ifndef {name}_H\n#define {name}_H\n\n#include \"linear.h\"\n\n\
         enum {{ {name}_STATES = {n}, {name}_INPUTS = {m}, {name}_OUTPUTS = {p} }};\n\n{arrays}\n\
         static const linear_model {name} = {{{n}, {m}, {p}, {step}, {name}_A, {name}_B, {name}_C, {name}_D}};\n\n#endif\n",
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

fn example(names: &CNames, version: &str) -> String {
    let CNames { header, example, program, numbers: model } = names;
    format!(
        "/* Written by dynoid {version}. A step of the first input after 10 samples. Compile: cc -std=c99 -O2 {example} linear.c -o {program} */\n\
         #include <stdio.h>\n#include <string.h>\n\n#include \"{header}\"\n\n\
         int main(void) {{\n    \
         double x[{model}_STATES + 1] = {{0}}, next[{model}_STATES + 1] = {{0}}, u[{model}_INPUTS + 1] = {{0}}, y[{model}_OUTPUTS];\n    \
         for (int k = 0; k < 200; k++) {{\n        \
         if (k == 10) u[0] = 1.0;\n        \
         linear_output(&{model}, x, u, y);\n        \
         linear_advance(&{model}, x, u, next);\n        \
         memcpy(x, next, sizeof x);\n        \
         printf(\"%g\", k * {model}.sample_time_s);\n        \
         for (int i = 0; i < {model}_OUTPUTS; i++) printf(\" %.17g\", y[i]);\n        \
         printf(\"\\n\");\n    \
         }}\n    return 0;\n}}\n"
    )
}
