//! The recordings of a bench as labelled experiments, for the commands that look at them one by one.

use dynoid::BenchRecordings;
use rig::{BenchFile, Experiment};
use serde::Serialize;

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
    let recordings = find(given, result, terminal)?;
    let mut experiments = Vec::new();
    let refused = each(&recordings, "reading", terminal, |experiment| experiments.push(experiment))?;
    match experiments.is_empty() {
        true => Err(recordings.nothing().into()),
        false => Ok(Campaign { bench: recordings.bench().clone(), experiments, refused }),
    }
}

/// The recordings that are named, or else those of the bench file, once it is clear that the result can be written.
pub(super) fn find(
    given: &GivenRecordings,
    result: &ResultArguments,
    terminal: &Terminal,
) -> Result<BenchRecordings, CliError> {
    let recordings = BenchRecordings::find(&given.bench, &given.recordings, &terminal.files())?;
    check_plot(result, &terminal.files())?;
    Ok(recordings)
}

/// Reads the recordings, and hands each to `work`; returns, and warns of, those that cannot be used. It warns of faults
/// in the others too.
pub(super) fn each(
    recordings: &BenchRecordings,
    doing: &str,
    terminal: &mut Terminal,
    work: impl FnMut(Experiment),
) -> Result<Vec<String>, CliError> {
    let remarks = recordings.each(doing, &terminal.files(), terminal.work(), work)?;
    remarks.all().for_each(|remark| terminal.warning(remark));
    Ok(remarks.refused)
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
