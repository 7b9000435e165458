//! `cargo xtask deep`: the slow suites, and the page of their last results.

mod results;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Instant, SystemTime};

use jiff::ToSpan;
use serde_json::Value;

use self::results::{Outcome, Results};
use crate::skipped::Skipped;
use crate::steps::{cargo, cargo_command, output, step, surroundings};
use crate::{fmu, folder, fuzz, python, release, wheel};

/// Runs every ignored test, suite by suite, or those of suites whose name contains `filter`. The page is written after
/// each suite, so that a run that is stopped leaves what it found.
pub(crate) fn run(filter: Option<&str>) -> Result<(), String> {
    let run = described()?;
    if filter.is_none() && !step("binaries of the FMUs", fmu::check)? {
        return Err("the FMUs' binaries cannot be compared with their sources".to_owned());
    }
    if filter.is_none() {
        step("fuzz targets", fuzz::check)?;
        without_features()?;
        step("wheel", wheel::deep)?;
        step("release", release::deep)?;
    }
    let python = step("packages to compare with", python::interpreter)?;
    let programs = step("build of the tests", programs)?;
    let mut suites = Vec::new();
    for program in &programs {
        suites.extend(program.suites()?.into_iter().map(|suite| (program, suite)));
    }
    let mut results = Results::read(suites.iter().map(|(_, suite)| suite.name.as_str()))?;
    suites.retain(|(_, suite)| filter.is_none_or(|filter| suite.name.contains(filter)));
    if let (true, Some(filter)) = (suites.is_empty(), filter) {
        return Err(format!("no suite's name contains {filter}"));
    }
    let mut failed = Vec::new();
    for (program, suite) in suites {
        let outcome = suite.run(program, python.as_deref(), &run)?;
        if !outcome.passed() {
            failed.push(suite.name.clone());
        }
        results.put(suite.name, outcome)?;
    }
    println!("{} is written", results::PAGE);
    if failed.is_empty() { Ok(()) } else { Err(format!("these suites failed: {}", failed.join(", "))) }
}

/// Builds the library without features, and tests what the readers say of formats that are left out.
fn without_features() -> Result<(), String> {
    let less = ["--no-default-features", "--release", "--quiet"];
    cargo("library without features", &[&["check", "--package", "dynoid", "--lib"], &less[..]].concat())?;
    let tests = ["test", "--package", "dynoid-recording", "--test", "it"];
    cargo("readers without features", &[&tests, &less[..], &["features::"]].concat())
}

/// A program of tests, and the folder of its crate, in which it runs.
struct Program {
    krate: String,
    executable: PathBuf,
    folder: PathBuf,
}

/// Ignored tests of one module.
struct Suite {
    name: String,
    tests: Vec<String>,
}

/// Builds all tests in release, and lists their programs.
fn programs() -> Result<Vec<Program>, String> {
    let arguments = ["test", "--workspace", "--release", "--no-run", "--message-format", "json-render-diagnostics"];
    let messages = output(&mut cargo_command(&arguments, None))?;
    let mut programs = Vec::new();
    for line in messages.lines() {
        let Ok(message) = serde_json::from_str::<Value>(line) else { continue };
        let Some(executable) = message["executable"].as_str() else { continue };
        if message["profile"]["test"] != true {
            continue;
        }
        let manifest = Path::new(message["manifest_path"].as_str().unwrap_or_default());
        let folder = manifest.parent().unwrap_or(Path::new("")).to_path_buf();
        let krate = folder.file_name().unwrap_or_default().to_string_lossy().into_owned();
        programs.push(Program { krate, executable: executable.into(), folder });
    }
    programs.sort_by(|a, b| a.krate.cmp(&b.krate));
    Ok(programs)
}

impl Program {
    fn command(&self) -> Command {
        let mut command = Command::new(&self.executable);
        command.current_dir(&self.folder);
        command
    }

    /// Its ignored tests by module.
    fn suites(&self) -> Result<Vec<Suite>, String> {
        let listed = output(self.command().args(["--list", "--ignored", "--format", "terse"]))?;
        let mut modules: BTreeMap<&str, Vec<String>> = BTreeMap::new();
        for test in listed.lines().filter_map(|line| line.strip_suffix(": test")) {
            let module = test.rsplit_once("::").map_or("", |(module, _)| module);
            modules.entry(module).or_default().push(test.to_owned());
        }
        let named = |(module, tests)| Suite { name: format!("{}::{module}", self.krate), tests };
        Ok(modules.into_iter().map(named).collect())
    }
}

impl Suite {
    fn run(&self, program: &Program, python: Option<&Path>, run: &str) -> Result<Outcome, String> {
        println!("== {}, {} tests", self.name, self.tests.len());
        let mut command = program.command();
        command.args(["--ignored", "--exact", "--show-output"]).args(&self.tests);
        surroundings(&mut command, python);
        let skipped = Skipped::start()?;
        let start = Instant::now();
        let ended = skipped.gather(&mut command).output().map_err(|error| format!("{}: {error}", self.name))?;
        let time_s = start.elapsed().as_secs_f64();
        let printed = String::from_utf8_lossy(&ended.stdout);
        let failed = if ended.status.success() { 0 } else { failures(&printed).max(1) };
        println!("== {}: {} in {time_s:.0} s", self.name, if failed == 0 { "passed" } else { "FAILED" });
        if failed > 0 {
            println!("{printed}{}", String::from_utf8_lossy(&ended.stderr));
        }
        Ok(Outcome {
            run: run.to_owned(),
            tests: self.tests.len(),
            failed,
            time_s,
            skipped: skipped.summary(),
            // The page is for every machine.
            figures: figures(&printed).replace(&format!("{}/", folder::root().display()), ""),
        })
    }
}

/// The number before `failed;` in the last line of a run.
fn failures(printed: &str) -> usize {
    let words: Vec<&str> = printed.split_whitespace().collect();
    let number = words.windows(2).rev().find(|pair| pair[1] == "failed;").map(|pair| pair[0].parse());
    number.and_then(Result::ok).unwrap_or(0)
}

/// Output of the tests: the sections `---- name stdout ----`, with the name alone as their heading.
fn figures(printed: &str) -> String {
    let mut text = String::new();
    let mut inside = false;
    for line in printed.lines() {
        if let Some(name) = line.strip_prefix("---- ").and_then(|rest| rest.strip_suffix(" stdout ----")) {
            text += &format!("{name}\n");
            inside = true;
        } else if line.is_empty() || line == "successes:" || line == "failures:" {
            inside &= !line.is_empty();
        } else if inside {
            text += &format!("  {line}\n");
        }
    }
    text
}

/// Date and commit of a run.
fn described() -> Result<String, String> {
    let git = |arguments: &[&str]| output(Command::new("git").current_dir(folder::root()).args(arguments));
    let commit = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changed =
        if git(&["status", "--porcelain", "--", ".", ":!docs/deep-check.md", ":!xtask/deep-check.json"])?.is_empty() {
            ""
        } else {
            " and changes"
        };
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_err(|error| error.to_string())?;
    let days = i64::try_from(now.as_secs() / 86_400).map_err(|error| error.to_string())?;
    let date = jiff::civil::date(1970, 1, 1).checked_add(days.days()).map_err(|error| error.to_string())?;
    Ok(format!("{date}, {}{changed}", commit.trim()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_figures_are_what_tests_printed() {
        let printed = "\nrunning 2 tests\n.F\nsuccesses:\n\n---- a::t stdout ----\ncoverage 94.8 %\nn 200\n\n\nsuccesses:\n    a::t\n\n\
                       test result: FAILED. 1 passed; 1 failed; 0 ignored\n";
        assert_eq!(figures(printed), "a::t\n  coverage 94.8 %\n  n 200\n");
        assert_eq!(failures(printed), 1);
    }
}
