//! `dynoid simulate`: a model on the inputs of a recording, or a bench in an experiment.

use std::path::{Path, PathBuf};
use std::time::Instant;

use bench::ExperimentLabel;
use bench::virtual_bench::{Numerics, VirtualRun, rename, simulate_told};
use recording::Recording;
use serde_json::json;

use crate::cli::experiment::SimulateArguments;
use crate::commands::convert::figures::figures;
use crate::commands::experiment::design::say_assumed;
use crate::commands::experiment::planned::{self, Planned};
use crate::commands::experiment::stated::Bench;
use crate::commands::identify::data::{check_plot, check_targets};
use crate::commands::identify::judge::{picture, simulate_model, written};
use crate::error::{CliError, Outcome};
use crate::formats::FileFormat;
use crate::input;
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &SimulateArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let first = &arguments.run.model;
    let usage = |what: &str| Err(CliError::Usage { what: format!("{}: {what}", first.display()) });
    let is_bench = input::ending(first).is_some_and(|ending| ending.eq_ignore_ascii_case("toml"));
    match &arguments.experiment {
        Some(_) if input::is_json(first) => usage(
            "this is a model file, and --experiment runs on a bench file; the model of a study comes with --model",
        ),
        Some(experiment) => rehearse(experiment, arguments, terminal),
        None if is_bench => usage(
            "a bench file is simulated in an experiment: add --experiment BS_T_NT, or another that \
             `dynoid experiment list` shows",
        ),
        None if arguments.run.meet.on.is_empty() => usage(
            "name the recording whose inputs the model gets with --on; a bench file is simulated with --experiment",
        ),
        None => match of_experiments(arguments) {
            Some(option) => usage(&format!("{option} belongs to an experiment; give --experiment and a bench file")),
            None => simulate_model(&arguments.run, terminal),
        },
    }
}

/// An option that makes no sense without an experiment.
fn of_experiments(arguments: &SimulateArguments) -> Option<&'static str> {
    let plan = &arguments.plan;
    let given = [
        ("--speed", plan.speed.is_some()),
        ("--duration", plan.duration.is_some()),
        ("--set", !plan.set.is_empty()),
        ("--seed", plan.seed.is_some()),
        ("--model", plan.study.is_some()),
        ("--truth", arguments.truth.is_some()),
    ];
    given.iter().find(|(_, is_given)| *is_given).map(|(option, _)| *option)
}

/// Runs an experiment on the virtual bench of a bench file.
fn rehearse(experiment: &str, arguments: &SimulateArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let run = &arguments.run;
    check(experiment, arguments)?;
    let bench = Bench::read(&run.model, arguments.plan.study.as_deref(), terminal)?;
    let Planned { plan, .. } = planned::plan(experiment, &arguments.plan, terminal)?;
    let doubts = planned::doubts(&plan, &bench.file);
    doubts.iter().for_each(|doubt| terminal.warning(doubt));
    let since = Instant::now();
    let progress = terminal.long(&format!("simulating {}", plan.label));
    let seed = arguments.plan.seed();
    let told = &mut |done, all| progress.told(done, all);
    let simulated = simulate_told(&bench.stated.parameters, &plan, seed, Numerics::default(), told);
    drop(progress);
    let VirtualRun { mut recording, hidden } =
        simulated.map_err(|source| CliError::VirtualBench { path: run.model.clone(), source })?;
    rename(&mut recording, &bench.file.channels);
    picture(&run.result, &format!("{}, simulated", plan.label), || figures(&plan.label.to_string(), &recording))?;
    if let Some(out) = &run.out {
        write(&mut recording, out, terminal)?;
        unlabelled(out, &plan.label).into_iter().for_each(|note| terminal.note(&note));
    }
    if let Some(truth) = &arguments.truth {
        write(&mut hidden.recording(), truth, terminal)?;
    }
    if run.result.json {
        terminal.json(&json!({
            "label": plan.label.to_string(),
            "duration_s": plan.duration_s,
            "seed": seed,
            "channels": channels(&recording),
            "assumptions": bench.stated.assumed_for(&plan),
            "doubts": doubts,
            "out": run.out,
            "truth": arguments.truth,
            "seconds_taken": since.elapsed().as_secs_f64(),
        }))?;
    } else if !terminal.is_quiet() {
        say_assumed(&bench, &plan, terminal);
        [&run.out, &arguments.truth, &run.result.plot].into_iter().for_each(|path| written(path, terminal));
    }
    Ok(Outcome::Done)
}

/// Refuses, before any work, outputs that cannot be written.
fn check(experiment: &str, arguments: &SimulateArguments) -> Result<(), CliError> {
    let run = &arguments.run;
    if run.out.is_none() && arguments.truth.is_none() && run.result.plot.is_none() {
        let what = "name a file for the recording, as in --out run.mf4; --truth and --plot write others".to_owned();
        return Err(CliError::Usage { what });
    }
    let mut read = vec![run.model.clone()];
    read.extend(arguments.plan.study.clone());
    read.extend(planned::file(experiment));
    for out in [&run.out, &arguments.truth].into_iter().flatten() {
        FileFormat::of_output(out)?;
    }
    let same = |a: &PathBuf, b: &PathBuf| input::folder_of(a) == input::folder_of(b) && a.file_name() == b.file_name();
    if let (Some(out), Some(truth)) = (&run.out, &arguments.truth)
        && same(out, truth)
    {
        let what = format!("{}: recording and truth need a file each", out.display());
        return Err(CliError::Usage { what });
    }
    check_targets(&[&run.out, &arguments.truth], &[&read])?;
    check_plot(&run.result, &[&read])
}

fn write(recording: &mut Recording, path: &Path, terminal: &mut Terminal) -> Result<(), CliError> {
    let format = FileFormat::of_output(path)?;
    // Of what text has no place for, the comment alone is there, and it says nothing that the file's name does not.
    let renamed = format.fit(recording).into_iter().filter(|note| !note.starts_with("text has no place"));
    renamed.for_each(|note| terminal.warning(&note));
    format.write(recording, path)
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
