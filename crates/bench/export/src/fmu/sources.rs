//! The runtimes' sources, as they are in an FMU and as a program in C takes them.

use bench_model::document::BenchModelDocument;

use super::csv;
use super::numbers::BenchNumbers;
use super::platforms::Runtime;
use crate::ExportedFile;
use crate::names::Names;
use crate::numbers::{demand_lead_sentence, written_by};

macro_rules! runtime {
    ($($name:literal),* $(,)?) => { [$(($name, include_str!(concat!("../../runtime/", $name)))),*] };
}

/// Sources of a program in C: the bench without FMI.
const BENCH: [(&str, &str); 4] = runtime!["bench.c", "bench.h", "matrix.c", "matrix.h"];
/// Further sources of an FMU of a bench.
const BENCH_FMU: [(&str, &str); 8] = runtime![
    "derivatives.c",
    "exchange.c",
    "instance.c",
    "model_file.c",
    "states.c",
    "variables.c",
    "instance.h",
    "model_file.h",
];
/// Sources of a program in C for a linear model.
const LINEAR: [(&str, &str); 2] = runtime!["linear.c", "linear.h"];
/// Further sources of an FMU of a linear model.
const LINEAR_FMU: [(&str, &str); 3] = runtime!["linear_file.c", "linear_instance.c", "linear_file.h"];
/// Sources of both kinds of FMUs.
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

/// Tells whether a source or header is the same for all models.
pub(super) fn is_shared(name: &str) -> bool {
    BENCH.iter().chain(&LINEAR).any(|(shared, _)| *shared == name)
}

/// Names in C of the files and the numbers of one model, so that several models fit into one folder and one program.
pub(super) struct CNames {
    /// Name of the header.
    pub(super) header: String,
    /// Name of the example.
    pub(super) example: String,
    /// Name of the program that the example becomes.
    pub(super) program: String,
    /// Name of the numbers, in capitals.
    pub(super) numbers: String,
}

impl CNames {
    pub(super) fn of(names: &Names) -> Self {
        let is_taken = is_shared(&format!("{}.h", names.file.to_ascii_lowercase()));
        let file = if is_taken { format!("{}_model", names.file) } else { names.file.clone() };
        // As it is in C, whatever the file is called.
        let plain = Names::of(&names.file).file;
        CNames {
            header: format!("{file}.h"),
            example: format!("{file}_example.c"),
            program: format!("{file}_example"),
            numbers: format!("{}_MODEL", plain.to_ascii_uppercase()),
        }
    }
}

/// Sources, numbers and an example for a program in C.
pub(super) fn for_c(document: &BenchModelDocument, numbers: &BenchNumbers, names: &Names) -> Vec<ExportedFile> {
    let names = CNames::of(names);
    let sources = BENCH.into_iter().map(|(name, text)| ExportedFile::text(name, text.to_owned()));
    let own = [
        ExportedFile::text(names.header.clone(), model_header(document, numbers, &names.numbers)),
        ExportedFile::text(names.example.clone(), example(&names, numbers)),
    ];
    own.into_iter().chain(sources).collect()
}

fn model_header(document: &BenchModelDocument, numbers: &BenchNumbers, name: &str) -> String {
    let rows: String = numbers
        .parameters
        .iter()
        .map(|one| {
            format!("    {}, /* {}, {}: {} */\n", csv::number(one.value), one.name, one.unit.plain(), one.description)
        })
        .collect();
    let lead = demand_lead_sentence(&document.model).map_or_else(String::new, |words| format!("\n * {words}"));
    format!(
        "/* {}{lead} */\n#ifndef {name}_H\n#define {name}_H\n\n#include \"bench.h\"\n\n\
         /* The numbers of the model, in the order of bench.h; 0 stands for a part that the model lacks. */\n\
         static const double {name}[BENCH_PARAMETERS] = {{\n{rows}}};\n\n#endif\n",
        written_by(document).replace("*/", "")
    )
}

const VERSION: &str = env!("CARGO_PKG_VERSION");

fn example(names: &CNames, numbers: &BenchNumbers) -> String {
    let CNames { header, example, program, numbers: model } = names;
    let (speed, torque) = (csv::number(numbers.start_rad_s), csv::number(numbers.start_nm));
    let (mode, step) = if numbers.has_speed_control {
        ("BENCH_SPEED_CONTROL", "inputs.speed_demand_rad_s += 5.0;")
    } else {
        ("BENCH_TORQUE_CONTROL", "inputs.torque_demand_nm += 5.0;")
    };
    format!(
        "/* Written by dynoid {VERSION}. A step of the demand after 0.1 s. Compile: cc -std=c99 -O2 {example} bench.c matrix.c -lm -o {program} */\n\
         #include <stdio.h>\n\n#include \"{header}\"\n\n\
         int main(void) {{\n    \
         static bench model;\n    \
         const bench_initial start = {{.speed_rad_s = {speed}, .torque_nm = {torque}}};\n    \
         bench_inputs inputs = {{.speed_demand_rad_s = {speed}, .torque_demand_nm = {torque}, .engine_torque_nm = {torque}}};\n    \
         if (!bench_start(&model, {model}, {mode}, &start)) return 1;\n    \
         for (int k = 0; k < 1000; k++) {{\n        \
         if (k == 100) {step}\n        \
         if (!bench_step(&model, &inputs, 1e-3)) return 1;\n        \
         printf(\"%.3f %.17g %.17g\\n\", (k + 1) * 1e-3, model.state.reading[0], bench_shaft_torque_nm(&model.state));\n    \
         }}\n    return 0;\n}}\n"
    )
}
