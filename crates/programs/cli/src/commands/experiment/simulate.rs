//! `dynoid experiment simulate`: an experiment on the virtual bench of a bench file.

use std::path::{Path, PathBuf};
use std::time::Instant;

use dynoid::{FileFormat, Files, Mark, check_file, paths};
use recording::Recording;
use rig::ExperimentLabel;
use serde_json::json;
use virtual_bench::{Numerics, VirtualRun, rename, simulate_as_step};

use super::planned::{self, Planned};
use super::stated::Bench;
use crate::cli::experiment::{OnBenchArguments, SimulateArguments};
use crate::commands::result::{check_plot, show_with};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &SimulateArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check(arguments, &terminal.files())?;
    let OnBenchArguments { bench: path, plan: settings, result } = &arguments.on;
    let bench = Bench::read(path, settings.study.as_deref(), terminal)?;
    check_places(arguments, &terminal.files())?;
    let Planned { plan, .. } = planned::plan(&arguments.experiment, settings, terminal)?;
    let doubts = planned::doubts(&plan, &bench.file);
    doubts.iter().for_each(|doubt| terminal.warning(doubt));
    let since = Instant::now();
    let seed = settings.seed();
    let numerics = if arguments.truth.is_some() { Numerics::default() } else { Numerics::WITHOUT_TRUTH };
    let simulated = simulate_as_step(terminal.work(), &bench.stated.parameters, &plan, seed, numerics);
    let VirtualRun { mut recording, hidden } =
        simulated.map_err(|source| CliError::VirtualBench { path: path.clone(), source })?;
    rename(&mut recording, &bench.file.channels);
    if let Some(out) = &arguments.out {
        write(&mut recording, out, terminal)?;
        unlabelled(out, &plan.label).into_iter().for_each(|note| terminal.note(&note));
    }
    if let Some(truth) = &arguments.truth {
        write(&mut hidden.recording(), truth, terminal)?;
    }
    let assumptions = bench.stated.assumed_for(&plan);
    let json = || {
        json!({
            "label": plan.label.to_string(),
            "duration_s": plan.duration_s,
            "seed": seed,
            "channels": channels(&recording),
            "assumptions": assumptions,
            "doubts": doubts,
            "out": arguments.out,
            "truth": arguments.truth,
            "computing_time_s": since.elapsed().as_secs_f64(),
        })
    };
    let page = || report::recording::simulated(&plan.label, &recording, &assumptions);
    show_with(result, &[&arguments.out, &arguments.truth], page, json, terminal)?;
    Ok(Outcome::Done)
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
    let format = FileFormat::of_output(path)?;
    // Of what text has no place for, the comment alone is there, and it says nothing that the file's name does not.
    let renamed = format.fit(recording).into_iter().filter(|note| !note.starts_with("text has no place"));
    renamed.for_each(|note| terminal.warning(&note));
    Ok(format.write(recording, path, &terminal.files())?)
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

fn channels(recording: &Recording) -> Vec<serde_json::Value> {
    let channel = |channel: &recording::Channel| {
        let peak =
            channel.samples.iter().copied().fold(0.0, |most: f64, v| if v.abs() > most.abs() { v } else { most });
        json!({"name": channel.name, "unit": channel.unit, "samples": channel.samples.len(), "peak": peak})
    };
    recording.channels.iter().map(channel).collect()
}
