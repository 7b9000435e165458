//! `dynoid experiment simulate`: an experiment on the virtual bench of a bench file.

use std::path::{Path, PathBuf};
use std::time::Instant;

use dynoid::experiments::{SimulatedExperiment, SimulationFacts};
use dynoid::{FileFormat, Files, Mark, check_file, paths, write_recording};
use recording::Recording;
use rig::ExperimentLabel;
use serde::Serialize;

use super::planned::{self, WithDoubts};
use crate::cli::experiment::SimulateArguments;
use crate::commands::result::{Sorted, check_plot, show_with};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &SimulateArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check(arguments, &terminal.files())?;
    let bench = planned::known(&arguments.on, terminal)?;
    check_places(arguments, &terminal.files())?;
    let plan = planned::plan(&arguments.experiment, &arguments.on.plan, terminal)?.plan;
    let doubts = planned::doubts(&plan, &bench, terminal);
    let (since, seed) = (Instant::now(), arguments.on.plan.seed());
    let mut run = SimulatedExperiment::of(&bench, &plan, seed, arguments.truth.is_some(), terminal.work())?;
    if let Some(out) = &arguments.out {
        write(&mut run.recording, out, terminal)?;
        unlabelled(out, &plan.label).into_iter().for_each(|note| terminal.note(&note));
    }
    if let (Some(path), Some(truth)) = (&arguments.truth, &mut run.truth) {
        write(truth, path, terminal)?;
    }
    let json = || {
        let (out, truth) = (&arguments.out, &arguments.truth);
        let run = WithDoubts { facts: run.facts(), doubts: &doubts };
        Sorted(Facts { run, out, truth, computing_time_s: since.elapsed().as_secs_f64() })
    };
    show_with(&arguments.on.result, &[&arguments.out, &arguments.truth], || run.page(), json, terminal)?;
    Ok(Outcome::Done)
}

/// A simulated experiment in numbers, with its files.
#[derive(Serialize)]
struct Facts<'a> {
    #[serde(flatten)]
    run: WithDoubts<'a, SimulationFacts<'a>>,
    out: &'a Option<PathBuf>,
    truth: &'a Option<PathBuf>,
    computing_time_s: f64,
}

/// Refuses, before any work, outputs that cannot be written.
fn check(arguments: &SimulateArguments, files: &Files) -> Result<(), CliError> {
    let result = &arguments.on.result;
    if arguments.out.is_none() && arguments.truth.is_none() && result.plot.is_none() {
        let what = "name a file for the recording, as in --out run.mf4; --truth and --plot write others".to_owned();
        return Err(CliError::Usage { what });
    }
    for out in [&arguments.out, &arguments.truth].into_iter().flatten() {
        FileFormat::of_output(out)?;
    }
    let same = |a: &PathBuf, b: &PathBuf| paths::folder_of(a) == paths::folder_of(b) && a.file_name() == b.file_name();
    if let (Some(out), Some(truth)) = (&arguments.out, &arguments.truth)
        && same(out, truth)
    {
        let what = format!("{}: recording and truth need a file each", out.display());
        return Err(CliError::Usage { what });
    }
    check_places(arguments, files)?;
    check_plot(result, files)
}

/// Checks that the recordings can be written; among those of the bench, once its bench file is read.
fn check_places(arguments: &SimulateArguments, files: &Files) -> Result<(), CliError> {
    Ok([&arguments.out, &arguments.truth]
        .into_iter()
        .flatten()
        .try_for_each(|out| check_file(out, &Mark::of_run(files), files))?)
}

fn write(recording: &mut Recording, path: &Path, terminal: &mut Terminal) -> Result<(), CliError> {
    let renamed = write_recording(recording, path, &terminal.files())?;
    renamed.iter().for_each(|note| terminal.warning(note));
    Ok(())
}

/// A study knows a recording by its name.
fn unlabelled(out: &Path, label: &ExperimentLabel) -> Option<String> {
    let name = out.file_name()?.to_string_lossy();
    let found: Option<ExperimentLabel> = name.parse().ok();
    (found.as_ref() != Some(label)).then(|| {
        format!(
            "a study knows experiments by their files' names; it would take {name} for {label} if that were in the name"
        )
    })
}
