//! Tasks of the project: `cargo xtask check` runs everything a change must pass.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod app;
mod axe;
mod bench;
mod check;
mod deep;
mod dependencies;
mod fmu;
mod folder;
mod fuzz;
mod layers;
mod npm;
mod profile;
mod python;
mod release;
mod schemas;
mod skipped;
mod steps;
mod wheel;
mod wording;

use std::process::ExitCode;

const USAGE: &str = "usage: cargo xtask <task>

  check    what every change must pass: format, layers, wording, licences, lints, fast tests, docs
  deep     the slow statistical suites and the fuzz targets, before every release. It writes docs/deep-check.md.
           NAME runs the suites whose name contains it; the page keeps the last results of the others.
  release  archives, packages, wheels, sums and manifests in target/release-files, for all targets or the TARGETs named
           (with cargo-zigbuild, ziglang and maturin). --program FILE packs a finished program, without wheels.
           --sums builds nothing: it writes sums and manifests of the files that are there.
  wheel    the wheel of the module dynoid in target/wheels, installed alone, started and tested
  fmu      build the runtime of the FMUs for every platform into crates/bench/export/runtime/binaries
  schemas  write docs/schemas from the types of the results
  layers   check the crates against the table in ARCHITECTURE.md, and their modules for circles
           --graph counts modules, arrows and circles by crate; --graph CRATE lists its circles.
  wording  count the worst patterns of wording against the ceilings in xtask/wording.json
           PATTERN or PATH lists the places; --record lowers the ceilings.
  bench    time the estimators; --peers also times other packages on the same data (see benchmarks/README.md)
           [--peers] [--quick] [--samples N] [--write-data FOLDER] [--results FILE] [NAME].
           --commands [--quick] [--growth] [NAME] times whole commands, beside scripts that do the same.
           --mdf alone times the reading of MDF files of a gigabyte, and compares it with asammdf.
  profile  draw where the time of a command goes: profile study dynoid-demo/bench.toml writes target/profile.svg (perf, inferno)";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let task = arguments.next().unwrap_or_default();
    let result = match task.as_str() {
        "check" => check::all(),
        "deep" => deep::run(arguments.next().as_deref()),
        "wheel" => wheel::deep(),
        "fmu" => fmu::build(),
        "release" => release::make(&arguments.collect::<Vec<_>>()),
        "schemas" => schemas::write(),
        "layers" => match arguments.next().as_deref() {
            Some("--graph") => layers::graph(arguments.next().as_deref()),
            _ => layers::check(),
        },
        "wording" => match arguments.next().as_deref() {
            Some("--record") => wording::record(),
            Some(filter) => wording::list(filter),
            None => wording::check(),
        },
        "profile" => profile::make(&arguments.collect::<Vec<_>>()),
        "bench" => bench::run(&arguments.collect::<Vec<_>>()),
        _ => Err(USAGE.to_owned()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::FAILURE
        }
    }
}
