//! `cargo xtask deep`: the slow suites, and the page of their last results.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Instant, SystemTime};

use serde_json::Value;

use crate::skipped::Skipped;
use crate::steps::{cargo, cargo_command, output, step, surroundings};
use crate::{fmu, folder, fuzz, python, release, wheel};

/// The page that a person commits.
const PAGE: &str = "docs/deep-check.md";

/// Runs every ignored test, suite by suite, and writes the page after each of them, so that a run that is stopped
/// leaves what it found; of suites whose name contains `filter` alone, no page.
pub(crate) fn run(filter: Option<&str>) -> Result<(), String> {
    let heading = heading()?;
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
    let skipped = Skipped::start()?;
    let mut chosen = Vec::new();
    for program in &programs {
        let suites = program.suites()?.into_iter();
        chosen.extend(suites.filter(|s| filter.is_none_or(|f| s.name.contains(f))).map(|suite| (program, suite)));
    }
    if let (true, Some(filter)) = (chosen.is_empty(), filter) {
        return Err(format!("no suite's name contains {filter}"));
    }
    let (all, mut results, mut text) = (chosen.len(), Vec::new(), String::new());
    for (program, suite) in chosen {
        results.push(suite.run(program, python.as_deref(), &skipped)?);
        text = page(&heading, (&results, all), &skipped.summary());
        if filter.is_none() {
            write(&text)?;
        }
    }
    let failed: Vec<&str> =
        results.iter().filter(|result| !result.passed()).map(|result| result.suite.as_str()).collect();
    println!("{}", if filter.is_none() { format!("{PAGE} is written") } else { text });
    if failed.is_empty() { Ok(()) } else { Err(format!("these suites failed: {}", failed.join(", "))) }
}

/// Builds the library without features, and tests what the readers say of formats that are left out.
fn without_features() -> Result<(), String> {
    let less = ["--no-default-features", "--release", "--quiet"];
    cargo("library without features", &[&["check", "--package", "dynoid", "--lib"], &less[..]].concat())?;
    let tests = ["test", "--package", "dynoid-recording", "--test", "it"];
    cargo("readers without features", &[&tests, &less[..], &["features::"]].concat())
}

fn write(text: &str) -> Result<(), String> {
    let (file, new) = (folder::root().join(PAGE), folder::root().join(format!("{PAGE}.new")));
    let written = std::fs::write(&new, text).and_then(|()| std::fs::rename(&new, &file));
    written.map_err(|error| format!("{}: {error}", file.display()))
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

/// How a suite ended.
struct Outcome {
    suite: String,
    tests: usize,
    failed: usize,
    time_s: f64,
    /// Output of its tests.
    figures: String,
}

impl Outcome {
    fn passed(&self) -> bool {
        self.failed == 0
    }
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
    fn run(self, program: &Program, python: Option<&Path>, skipped: &Skipped) -> Result<Outcome, String> {
        println!("== {}, {} tests", self.name, self.tests.len());
        let mut command = program.command();
        command.args(["--ignored", "--exact", "--show-output"]).args(&self.tests);
        surroundings(&mut command, python);
        let start = Instant::now();
        let ended = skipped.gather(&mut command).output().map_err(|error| format!("{}: {error}", self.name))?;
        let time_s = start.elapsed().as_secs_f64();
        let printed = String::from_utf8_lossy(&ended.stdout);
        let failed = if ended.status.success() { 0 } else { failures(&printed).max(1) };
        println!("== {}: {} in {time_s:.0} s", self.name, if failed == 0 { "passed" } else { "FAILED" });
        if failed > 0 {
            println!("{printed}{}", String::from_utf8_lossy(&ended.stderr));
        }
        // The page is for every machine.
        let figures = figures(&printed).replace(&format!("{}/", folder::root().display()), "");
        Ok(Outcome { suite: self.name, tests: self.tests.len(), failed, time_s, figures })
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

/// Date, commit and machine of a run.
fn heading() -> Result<String, String> {
    let git = |arguments: &[&str]| output(Command::new("git").current_dir(folder::root()).args(arguments));
    let commit = git(&["rev-parse", "--short=12", "HEAD"])?;
    let changed =
        if git(&["status", "--porcelain"])?.is_empty() { "" } else { ", with changes that are not committed" };
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_err(|error| error.to_string())?;
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let (date, system) = (date(now.as_secs() / 86_400), std::env::consts::OS);
    Ok(format!("{date}, commit {}{changed}, {processors} processors, {system}", commit.trim()))
}

/// The date of a day after 1970-01-01, as `2026-11-24`.
fn date(mut days: u64) -> String {
    let leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let february = 28 + u64::from(leap(year));
    let mut month = 0;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        month += 1;
        if days < length {
            break;
        }
        days -= length;
    }
    format!("{year}-{month:02}-{:02}", days + 1)
}

fn page(heading: &str, (results, all): (&[Outcome], usize), skipped: &str) -> String {
    let stopped = match all - results.len() {
        0 => String::new(),
        missing => format!(" The run was stopped before {missing} of {all} suites."),
    };
    let mut text = format!(
        "# The deep check\n\n`cargo xtask deep` runs the slow statistical suites and writes this page. It is run before every \
         release. This is its last result.\n\nRun: {heading}.{stopped}\n\n\
         | suite | tests | failed | time, s |\n| --- | --- | --- | --- |\n"
    );
    for result in results {
        text += &format!("| {} | {} | {} | {:.0} |\n", result.suite, result.tests, result.failed, result.time_s);
    }
    let tests: usize = results.iter().map(|result| result.tests).sum();
    let failed: usize = results.iter().map(|result| result.failed).sum();
    let time_s: f64 = results.iter().map(|result| result.time_s).sum();
    text += &format!("| all | {tests} | {failed} | {time_s:.0} |\n\n```text\n{skipped}\n```\n");
    let printing: Vec<&Outcome> = results.iter().filter(|result| !result.figures.is_empty()).collect();
    if !printing.is_empty() {
        text += "\n## Figures that the tests print\n";
    }
    for result in printing {
        text += &format!("\n### {}\n\n```text\n{}```\n", result.suite, result.figures);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_dates() {
        for (day, text) in [(0, "1970-01-01"), (59, "1970-03-01"), (11_016, "2000-02-29"), (20_781, "2026-11-24")] {
            assert_eq!(date(day), text);
        }
    }

    #[test]
    fn exact_figures_are_what_tests_printed() {
        let printed = "\nrunning 2 tests\n.F\nsuccesses:\n\n---- a::t stdout ----\ncoverage 94.8 %\nn 200\n\n\nsuccesses:\n    a::t\n\n\
                       test result: FAILED. 1 passed; 1 failed; 0 ignored\n";
        assert_eq!(figures(printed), "a::t\n  coverage 94.8 %\n  n 200\n");
        assert_eq!(failures(printed), 1);
    }

    #[test]
    fn snap_the_page_has_a_row_for_each_suite() {
        let suite = |name: &str, failed| Outcome {
            suite: name.into(),
            tests: 2,
            failed,
            time_s: 1.6,
            figures: String::from("a::t\n  94.8 %\n"),
        };
        let text = page("2026-11-24, commit abc", (&[suite("x::a", 0), suite("x::b", 1)], 3), "skipped: no test");
        assert!(text.contains("stopped before 1 of 3 suites"), "{text}");
        assert!(text.contains("| x::a | 2 | 0 | 2 |\n| x::b | 2 | 1 | 2 |\n| all | 4 | 1 | 3 |\n"), "{text}");
        assert!(text.contains("### x::a\n\n```text\na::t\n  94.8 %\n```\n"), "{text}");
    }
}
