//! The recordings of a bench as labelled experiments, for the commands that look at them one by one.

use dynoid::Error;
use report::wording;
use rig::{BenchFile, Experiment, Severity};
use serde::Serialize;
use study::experiment_of;

use super::result::{Sorted, check_plot};
use crate::cli::GivenRecordings;
use crate::cli::identify::ResultArguments;
use crate::error::CliError;
use crate::terminal::Terminal;

/// A bench with the recordings that can be used.
pub(super) struct Campaign {
    /// The bench.
    pub(super) bench: BenchFile,
    /// Its recordings, at least one.
    pub(super) experiments: Vec<Experiment>,
    /// Recordings that cannot be used, each with the reason.
    pub(super) refused: Vec<String>,
}

/// All recordings at once; see [`each`].
pub(super) fn all(
    given: &GivenRecordings,
    result: &ResultArguments,
    terminal: &mut Terminal,
) -> Result<Campaign, CliError> {
    let mut found: Option<(BenchFile, Vec<Experiment>)> = None;
    let refused = each(given, result, "reading", terminal, |bench, experiment| {
        found.get_or_insert_with(|| (bench.clone(), Vec::new())).1.push(experiment);
    })?;
    let (bench, experiments) = found.ok_or_else(|| CliError::NothingToLookAt { path: given.bench.clone() })?;
    Ok(Campaign { bench, experiments, refused })
}

/// Reads the recordings that are named, or else those of the bench file, and hands each to `work`; returns, and warns
/// of, those that cannot be used. What is wrong in the others is warned of too.
pub(super) fn each(
    given: &GivenRecordings,
    result: &ResultArguments,
    doing: &str,
    terminal: &mut Terminal,
    mut work: impl FnMut(&BenchFile, Experiment),
) -> Result<Vec<String>, CliError> {
    let bench = dynoid::Bench::load(&given.bench, &terminal.files())?.into_file();
    if bench.channels.is_empty() {
        return Err(Error::NoChannelsNamed { path: given.bench.clone() }.into());
    }
    let files = match given.recordings.is_empty() {
        true => dynoid::listed(&given.bench, &bench.recordings.files)?,
        false => terminal.files().named(&given.recordings)?,
    };
    check_plot(result, &terminal.files())?;
    let step = terminal.work().step(doing, files.len() as u64);
    let (mut refused, mut doubts) = (Vec::new(), Vec::new());
    for file in &files {
        let part = step.step(format!("{doing} {}", file.name), 0);
        match experiment_of(&bench, &terminal.files().read_source(file, &bench, &part)?) {
            Ok((experiment, diagnostics)) => {
                let worth_knowing = diagnostics.iter().filter(|d| d.severity >= Severity::Warning);
                doubts.extend(worth_knowing.map(wording::remark));
                work(&bench, experiment);
            }
            Err(diagnostics) => {
                let worst = diagnostics.iter().find(|d| d.severity == Severity::Error).or(diagnostics.first());
                let nothing = || format!("{}: nothing in it can be used", file.name);
                refused.push(worst.map_or_else(nothing, wording::remark));
            }
        }
    }
    drop(step);
    refused.iter().chain(&doubts).for_each(|reason| terminal.warning(reason));
    Ok(refused)
}

/// A result in numbers, with the recordings that could not be used.
#[derive(Serialize)]
pub(super) struct WithRefused<'a, F> {
    #[serde(flatten)]
    facts: F,
    refused: &'a [String],
}

impl<'a, F> WithRefused<'a, F> {
    /// As it is printed.
    pub(super) fn sorted(facts: F, refused: &'a [String]) -> Sorted<Self> {
        Sorted(WithRefused { facts, refused })
    }
}
