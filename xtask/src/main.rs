//! Tasks of the project: `cargo xtask check` runs everything a change must pass.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod bench;
mod folder;
mod layers;
mod python;
mod wording;

use std::path::Path;
use std::process::{Command, ExitCode};
use std::time::Instant;

const USAGE: &str = "usage: cargo xtask <task>

  check    format, clippy with warnings as errors, layers, tests, slow tests, comparisons with other packages, docs
  layers   check the crates' dependencies against the table in ARCHITECTURE.md, and their modules for circles;
           --graph counts modules, arrows and circles by crate, --graph CRATE lists the circles of one
  wording  count the worst patterns of wording against the ceilings in xtask/wording.json; PATTERN or PATH lists the places,
           --record lowers the ceilings
  bench    time the estimators; with --peers other packages on the same data too (see benchmarks/README.md)
           [--peers] [--quick] [--samples N] [--write-data FOLDER] [--results FILE] [NAME]
           or, with --mdf alone, the reading of MDF files of a gigabyte beside asammdf";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let task = arguments.next().unwrap_or_default();
    let result = match task.as_str() {
        "check" => check(),
        "layers" => match arguments.next().as_deref() {
            Some("--graph") => layers::graph(arguments.next().as_deref()),
            _ => layers::check(),
        },
        "wording" => match arguments.next().as_deref() {
            Some("--record") => wording::record(),
            Some(filter) => wording::list(filter),
            None => wording::check(),
        },
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

fn check() -> Result<(), String> {
    cargo("format", &["fmt", "--all", "--check"])?;
    step("layers", layers::check)?;
    let python = step("packages to compare with", python::interpreter)?;
    // In release, which the program is built in anyway: what is compiled for one of these is there for the next.
    cargo("clippy", &["clippy", "--workspace", "--release", "--all-targets", "--quiet", "--", "-D", "warnings"])?;
    // With the slow statistical suites.
    let tests = ["test", "--workspace", "--release", "--quiet", "--", "--include-ignored"];
    cargo_with("tests", &tests, python.as_deref())?;
    cargo("docs", &["doc", "--workspace", "--release", "--no-deps", "--quiet"])?;
    println!("all checks passed");
    if python.is_none() {
        python::warn();
    }
    Ok(())
}

fn step<T>(name: &str, action: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    println!("== {name}");
    let start = Instant::now();
    let outcome = action()?;
    println!("== {name}: passed in {:.1} s", start.elapsed().as_secs_f64());
    Ok(outcome)
}

fn cargo(name: &str, arguments: &[&str]) -> Result<(), String> {
    cargo_with(name, arguments, None)
}

/// Runs cargo; `python` is the interpreter of the comparisons.
fn cargo_with(name: &str, arguments: &[&str], python: Option<&Path>) -> Result<(), String> {
    step(name, || {
        let status = Command::new(env!("CARGO"))
            .args(arguments)
            .envs(python.map(|path| (python::VARIABLE, path)))
            .env("RUSTDOCFLAGS", "-D warnings")
            // The same cases every time: a check that passed passes again. `cargo test` alone draws new ones.
            .env("PROPTEST_RNG_SEED", "1")
            .status()
            .map_err(|error| format!("cargo could not be started: {error}"))?;
        if status.success() { Ok(()) } else { Err(format!("{name} failed: cargo {}", arguments.join(" "))) }
    })
}
