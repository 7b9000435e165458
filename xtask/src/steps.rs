//! Steps of a task, each with its name and time, most of them calls of cargo.

use std::path::Path;
use std::process::Command;
use std::time::Instant;

use crate::python;

/// Does one step, and prints its name and how long it took.
pub(crate) fn step<T>(name: &str, action: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    println!("== {name}");
    let start = Instant::now();
    let outcome = action()?;
    println!("== {name}: passed in {:.1} s", start.elapsed().as_secs_f64());
    Ok(outcome)
}

/// One step that is a call of cargo.
pub(crate) fn cargo(name: &str, arguments: &[&str]) -> Result<(), String> {
    step(name, || run(name, &mut cargo_command(arguments, None)))
}

/// A call of cargo with the surroundings of a check; `python` is the interpreter to compare with.
pub(crate) fn cargo_command(arguments: &[&str], python: Option<&Path>) -> Command {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(arguments).env("RUSTDOCFLAGS", "-D warnings");
    surroundings(&mut cargo, python);
    cargo
}

/// Sets the environment of tests.
pub(crate) fn surroundings(command: &mut Command, python: Option<&Path>) {
    command
        .envs(python.map(|path| (python::VARIABLE, path)))
        // The same cases every time: a check that passed passes again. `cargo test` alone draws new ones.
        .env("PROPTEST_RNG_SEED", "1");
}

/// Runs a command that has to succeed.
pub(crate) fn run(name: &str, command: &mut Command) -> Result<(), String> {
    let status = command.status().map_err(|error| format!("{name} could not be started: {error}"))?;
    if status.success() { Ok(()) } else { Err(format!("{name} failed: {}", written(command))) }
}

/// The output of a command that has to succeed.
pub(crate) fn output(command: &mut Command) -> Result<String, String> {
    let what = written(command);
    let output = command.output().map_err(|error| format!("{what} could not be started: {error}"))?;
    if !output.status.success() {
        return Err(format!("{what} failed:\n{}", String::from_utf8_lossy(&output.stderr)));
    }
    String::from_utf8(output.stdout).map_err(|error| format!("{what}: {error}"))
}

fn written(command: &Command) -> String {
    let program = Path::new(command.get_program()).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let arguments = command.get_args().map(|argument| argument.to_string_lossy().into_owned());
    std::iter::once(program).chain(arguments).collect::<Vec<_>>().join(" ")
}
