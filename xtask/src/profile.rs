//! `cargo xtask profile`: where the time of a command of the program goes, as a flame graph.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::folder;
use crate::steps::run;

/// Samples a second: not a divisor of a second's hundredths, so that nothing periodic falls in step.
const RATE_HZ: &str = "97";
/// Stack of each sample, bytes.
const STACK: &str = "dwarf,16384";
const TOOLS: [(&str, &str); 3] = [
    ("perf", "install it with your system's packages (Debian: linux-perf)"),
    ("inferno-collapse-perf", "cargo install inferno --locked"),
    ("inferno-flamegraph", "cargo install inferno --locked"),
];

/// Runs the program with these arguments and writes target/profile.svg.
pub(crate) fn make(arguments: &[String]) -> Result<(), String> {
    if arguments.is_empty() {
        return Err("name a command of the program: cargo xtask profile study dynoid-demo/bench.toml".to_owned());
    }
    for (tool, remedy) in TOOLS {
        let found = Command::new(tool).arg("--help").stdout(Stdio::null()).stderr(Stdio::null()).status();
        found.map_err(|_| format!("{tool} is missing: {remedy}"))?;
    }
    let mut build = Command::new(env!("CARGO"));
    run("the build", build.args(["build", "--release", "--quiet"]).env("DYNOID_SYMBOLS", "1"))?;
    let target = folder::target()?;
    let [recorded, stacks, folded, drawn] =
        ["profile.data", "profile.stacks", "profile.folded", "profile.svg"].map(|name| target.join(name));
    let mut perf = Command::new("perf");
    perf.args(["record", "--quiet", "--call-graph", STACK, "--freq", RATE_HZ, "--output"]).arg(&recorded).arg("--");
    // The program may end with a code of its own, such as that of a bad verdict.
    let ended = perf.arg(target.join("release/dynoid")).args(arguments).status();
    ended.map_err(|error| format!("perf could not be started: {error}"))?;
    into_file(Command::new("perf").args(["script", "--input"]).arg(&recorded), &stacks)?;
    into_file(Command::new("inferno-collapse-perf").arg(&stacks), &folded)?;
    into_file(Command::new("inferno-flamegraph").arg(&folded), &drawn)?;
    for file in [&recorded, &stacks, &folded] {
        fs::remove_file(file).map_err(|error| format!("{}: {error}", file.display()))?;
    }
    println!("{}", drawn.display());
    Ok(())
}

/// Runs a command whose output becomes a file.
fn into_file(command: &mut Command, path: &Path) -> Result<(), String> {
    let file = File::create(path).map_err(|error| format!("{}: {error}", path.display()))?;
    run("the flame graph", command.stdout(file).stderr(Stdio::null()))
}
