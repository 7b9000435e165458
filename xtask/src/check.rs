//! `cargo xtask check`: what every change must pass, in minutes.

use std::path::Path;
use std::time::Instant;

use crate::skipped::Skipped;
use crate::steps::{cargo, cargo_command, run, step};
use crate::{app, axe, dependencies, fmu, layers, python, wheel, wording};

/// Format, rules of the source, lints, all fast tests, and docs. The slow tests and the fuzz targets are in
/// `cargo xtask deep`.
pub(crate) fn all() -> Result<(), String> {
    let start = Instant::now();
    cargo("format", &["fmt", "--all", "--check"])?;
    step("layers", layers::check)?;
    step("wording", wording::check)?;
    let advisories = step("dependencies", dependencies::check)?;
    let binaries = step("binary of the FMUs", fmu::check_one)?;
    let python = step("packages to compare with", python::interpreter)?;
    let axe = step("checker of accessibility", axe::script)?;
    // In release, which the program is built in anyway: what is compiled for one of these is there for the next.
    cargo("clippy", &["clippy", "--workspace", "--release", "--all-targets", "--quiet", "--", "-D", "warnings"])?;
    let skipped = step("tests", || tests(python.as_deref(), axe.as_deref()))?;
    let app = step("app", || app::check(python.as_deref(), axe.as_deref()))?;
    let wheel = step("wheel", || wheel::check(python.as_deref()))?;
    cargo("docs", &["doc", "--workspace", "--release", "--no-deps", "--quiet"])?;
    println!("all checks passed in {:.0} s", start.elapsed().as_secs_f64());
    skipped.print();
    println!("not run: the slow tests and the fuzz targets, which `cargo xtask deep` runs");
    if !wheel {
        println!(
            "not run: the wheel and the tests of the module dynoid, since Python has not the packages of xtask/python.txt"
        );
    }
    for left in app {
        println!("not run: {left}");
    }
    if !binaries {
        println!("not run: the comparison of the FMUs' binary with its sources, since Zig cannot be installed");
    }
    if !advisories {
        println!("not run: security advisories of dependencies, since cargo-deny is not installed");
    }
    Ok(())
}

/// The variable from which proptest takes its seed.
const RANDOM_CASES: &str = "PROPTEST_RNG_SEED";

/// All tests but the ignored ones, and the examples in the documentation.
fn tests(python: Option<&Path>, axe: Option<&Path>) -> Result<Skipped, String> {
    let skipped = Skipped::start()?;
    let mut cargo = cargo_command(&["test", "--workspace", "--release", "--quiet"], python);
    cargo.envs(axe.map(|script| (axe::VARIABLE, script)));
    // A change must not fail by cases that were drawn for it alone; `cargo test` draws new ones each time.
    if std::env::var_os(RANDOM_CASES).is_none() {
        cargo.env(RANDOM_CASES, "1");
    }
    run("the tests", skipped.gather(&mut cargo))?;
    Ok(skipped)
}
