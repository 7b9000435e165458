//! The runtimes' sources, as they are in an FMU and as a program in C takes them.

use bench_model::document::BenchModelDocument;

use super::csv;
use super::numbers::BenchNumbers;
use super::platforms::Runtime;
use crate::ExportedFile;
use crate::names::Names;
use crate::numbers::written_by;

macro_rules! runtime {
    ($($name:literal),* $(,)?) => { [$(($name, include_str!(concat!("../../runtime/", $name)))),*] };
}

/// What a program in C needs: the bench without FMI.
const BENCH: [(&str, &str); 4] = runtime!["bench.c", "bench.h", "matrix.c", "matrix.h"];
/// What an FMU of a bench needs beyond it.
const BENCH_FMU: [(&str, &str); 7] =
    runtime!["exchange.c", "instance.c", "model_file.c", "states.c", "variables.c", "instance.h", "model_file.h"];
/// What a program in C needs of a linear model.
const LINEAR: [(&str, &str); 2] = runtime!["linear.c", "linear.h"];
/// What an FMU of a linear model needs beyond it.
const LINEAR_FMU: [(&str, &str); 3] = runtime!["linear_file.c", "linear_instance.c", "linear_file.h"];
/// What both kinds of FMUs need.
const FMI: [(&str, &str); 11] = runtime![
    "fmi2.c",
    "fmi3.c",
    "fmi3_absent.c",
    "life.c",
    "text_file.c",
    "export.h",
    "fmi2.h",
    "fmi3.h",
    "fmi3_component.h",
    "interface.h",
    "text_file.h",
];

/// All sources of a runtime by name.
pub(super) fn all(runtime: Runtime) -> impl Iterator<Item = (&'static str, &'static str)> {
    let (core, own): (&[_], &[_]) = match runtime {
        Runtime::Bench => (&BENCH, &BENCH_FMU),
        Runtime::Linear => (&LINEAR, &LINEAR_FMU),
    };
    core.iter().chain(own).copied().chain(FMI)
}

/// Names of the sources that a compiler is called on.
pub(super) fn compiled(runtime: Runtime) -> impl Iterator<Item = &'static str> {
    all(runtime).map(|(name, _)| name).filter(|name| name.ends_with(".c"))
}

/// A linear model without FMI.
pub(super) fn of_linear() -> impl Iterator<Item = ExportedFile> {
    LINEAR.into_iter().map(|(name, text)| ExportedFile::text(name, text.to_owned()))
}

/// Sources, numbers and an example for a program in C.
pub(super) fn for_c(document: &BenchModelDocument, numbers: &BenchNumbers, names: &Names) -> Vec<ExportedFile> {
    let header = format!("{}.h", header_name(names));
    let example = example(&header, numbers);
    let sources = BENCH.into_iter().map(|(name, text)| ExportedFile::text(name, text.to_owned()));
    let own = [ExportedFile::text(header, model_header(document, numbers)), ExportedFile::text("example.c", example)];
    own.into_iter().chain(sources).collect()
}

/// The header's name, where a bench has that of a source.
fn header_name(names: &Names) -> String {
    let is_taken = ["bench", "matrix", "example"].contains(&names.file.as_str());
    if is_taken { format!("{}_model", names.file) } else { names.file.clone() }
}

fn model_header(document: &BenchModelDocument, numbers: &BenchNumbers) -> String {
    let rows: String = numbers
        .parameters
        .iter()
        .map(|one| {
            format!("    {}, /* {}, {}: {} */\n", csv::number(one.value), one.name, one.unit.plain(), one.description)
        })
        .collect();
    format!(
        "/* {} */\n#ifndef BENCH_MODEL_H\n#define BENCH_MODEL_H\n\n#include \"bench.h\"\n\n\
         /* The numbers of the model, in the order of bench.h; 0 stands for a part that the model lacks. */\n\
         static const double BENCH_MODEL[BENCH_PARAMETERS] = {{\n{rows}}};\n\n#endif\n",
        written_by(document).replace("*/", "")
    )
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

fn example(header: &str, numbers: &BenchNumbers) -> String {
    let speed = csv::number(numbers.start_rad_s);
    let (mode, step) = if numbers.has_speed_control {
        ("BENCH_SPEED_CONTROL", "inputs.speed_demand_rad_s += 5.0;")
    } else {
        ("BENCH_TORQUE_CONTROL", "inputs.torque_demand_nm += 5.0;")
    };
    format!(
        "/* Written by dynoid {VERSION}. A step of the demand after 0.1 s. Compile: cc -std=c99 -O2 example.c bench.c matrix.c -lm -o example */\n\
         #include <stdio.h>\n\n#include \"{header}\"\n\n\
         int main(void) {{\n    \
         static bench model;\n    \
         const bench_initial start = {{.speed_rad_s = {speed}}};\n    \
         bench_inputs inputs = {{.speed_demand_rad_s = {speed}}};\n    \
         if (!bench_start(&model, BENCH_MODEL, {mode}, &start)) return 1;\n    \
         for (int k = 0; k < 1000; k++) {{\n        \
         if (k == 100) {step}\n        \
         if (!bench_step(&model, &inputs, 1e-3)) return 1;\n        \
         printf(\"%.3f %.17g %.17g\\n\", (k + 1) * 1e-3, model.state.reading[0], bench_shaft_torque_nm(&model.state));\n    \
         }}\n    return 0;\n}}\n"
    )
}
