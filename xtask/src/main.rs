//! Tasks of the project: `cargo xtask check` runs everything a change must pass.
#![allow(clippy::print_stdout, clippy::print_stderr)]

mod bench;
mod layers;

use std::process::{Command, ExitCode};
use std::time::Instant;

const USAGE: &str = "usage: cargo xtask <task>

  check    format, clippy with warnings as errors, layers, tests, slow tests, docs
  layers   hold the crates' dependencies to the table in ARCHITECTURE.md
  bench    time the estimators; with --peers other packages on the same data too (see benchmarks/README.md)
           [--peers] [--quick] [--samples N] [--write-data FOLDER] [--results FILE] [NAME]";

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let task = arguments.next().unwrap_or_default();
    let result = match task.as_str() {
        "check" => check(),
        "layers" => layers::check(),
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
    cargo("clippy", &["clippy", "--workspace", "--all-targets", "--quiet", "--", "-D", "warnings"])?;
    // In release, which the program is built in anyway; with the slow statistical suites.
    cargo("tests", &["test", "--workspace", "--release", "--quiet", "--", "--include-ignored"])?;
    cargo("docs", &["doc", "--workspace", "--no-deps", "--quiet"])?;
    println!("all checks passed");
    Ok(())
}

fn step(name: &str, action: impl FnOnce() -> Result<(), String>) -> Result<(), String> {
    println!("== {name}");
    let start = Instant::now();
    action()?;
    println!("== {name}: passed in {:.1} s", start.elapsed().as_secs_f64());
    Ok(())
}

fn cargo(name: &str, arguments: &[&str]) -> Result<(), String> {
    step(name, || {
        let status = Command::new(env!("CARGO"))
            .args(arguments)
            .env("RUSTDOCFLAGS", "-D warnings")
            // The same cases every time: a check that passed passes again. `cargo test` alone draws new ones.
            .env("PROPTEST_RNG_SEED", "1")
            .status()
            .map_err(|error| format!("cargo could not be started: {error}"))?;
        if status.success() { Ok(()) } else { Err(format!("{name} failed: cargo {}", arguments.join(" "))) }
    })
}
