//! The one function that sees the whole chain, from decoded recordings to the study.

use rig::{BenchFile, Diagnostic, Experiment};

use crate::analyses::{Analyses, analyses};
use crate::findings::Findings;
use crate::gather::{Gathered, Source, gather};
use crate::{Provenance, Study, estimates};

/// Everything a study is made from.
#[derive(Debug)]
pub struct Campaign<'a> {
    /// The bench.
    pub bench: &'a BenchFile,
    /// The bench file's name and its text, word for word.
    pub bench_file: (&'a str, &'a str),
    /// The recordings.
    pub sources: Vec<Source>,
    /// Seed, when the recordings were simulated.
    pub seed: Option<u64>,
}

/// What is being worked on, for a progress display.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Progress {
    /// A recording is understood and checked.
    Preparing {
        /// File.
        file: String,
    },
    /// A part of the bench is estimated: `speed controller`, `feed-forward`, `torque control`, `timing`, `shaft`,
    /// `whole model`.
    Estimating {
        /// The part.
        part: &'static str,
    },
    /// A recording is replayed on the model.
    Replaying {
        /// File.
        file: String,
    },
    /// An analysis of all recordings is made: `lines`, `torque signals`, `speed controller`, `torque control`, `friction`,
    /// `shaft`, `engine torque`.
    Analysing {
        /// The analysis.
        what: &'static str,
    },
}

/// Why there can be no study at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StudyError {
    /// The bench file names no channels.
    #[error("the bench file names no channels")]
    NoChannels,
    /// No recording was given.
    #[error("there is no recording to study")]
    NoRecordings,
    /// None of the recordings can be used.
    #[error("none of the {count} recordings can be used")]
    NothingUsable {
        /// How many there are.
        count: usize,
        /// Why each cannot.
        diagnostics: Vec<Diagnostic>,
    },
}

/// Studies a campaign: prepares its recordings, estimates every part they allow, assembles the model, replays what it has
/// not seen.
///
/// A part whose recordings are missing is *not estimated* and says what it needs; that is no error.
///
/// # Errors
/// No channels, no recording, or none that can be used.
pub fn run(campaign: Campaign<'_>, progress: &mut dyn FnMut(Progress)) -> Result<Study, StudyError> {
    studied(campaign, progress).map(|(study, _)| study)
}

/// The same study, and beside it all analyses that the recordings allow.
///
/// # Errors
/// Those of [`run`]: what an analysis lacks is part of the result.
pub fn run_full(campaign: Campaign<'_>, progress: &mut dyn FnMut(Progress)) -> Result<(Study, Analyses), StudyError> {
    let bench = campaign.bench;
    let (study, experiments) = studied(campaign, progress)?;
    let analyses = analyses(&experiments, bench, progress);
    Ok((study, analyses))
}

/// Experiments from sources, at least one.
pub(super) fn usable(
    bench: &BenchFile,
    sources: Vec<Source>,
    progress: &mut dyn FnMut(Progress),
) -> Result<Gathered, StudyError> {
    if bench.channels.is_empty() {
        return Err(StudyError::NoChannels);
    }
    if sources.is_empty() {
        return Err(StudyError::NoRecordings);
    }
    let count = sources.len();
    let gathered = gather(bench, sources, progress);
    match gathered.experiments.is_empty() {
        true => Err(StudyError::NothingUsable { count, diagnostics: gathered.diagnostics }),
        false => Ok(gathered),
    }
}

/// The study, and the experiments it is made from.
fn studied(campaign: Campaign<'_>, progress: &mut dyn FnMut(Progress)) -> Result<(Study, Vec<Experiment>), StudyError> {
    let Gathered { experiments, mut recordings, diagnostics } = usable(campaign.bench, campaign.sources, progress)?;
    let mut findings = Findings::new(campaign.bench, &experiments, diagnostics, progress);
    let estimates = estimates::all(&mut findings);
    for recording in &mut recordings {
        recording.used_for = findings.uses_of(&recording.file);
    }
    let mut diagnostics = findings.diagnostics;
    diagnostics.sort_by_key(|d| std::cmp::Reverse(d.severity));
    let study = Study {
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            bench_file: campaign.bench_file.1.to_owned(),
            bench_file_name: campaign.bench_file.0.to_owned(),
            seed: campaign.seed,
        },
        bench: campaign.bench.facts(),
        recordings,
        timing: estimates.timing,
        speed_controller: estimates.speed_controller,
        feed_forward: estimates.feed_forward,
        torque_control: estimates.torque_control,
        shaft: estimates.shaft,
        whole: estimates.whole,
        model: estimates.model,
        replays: estimates.replays,
        diagnostics,
    };
    Ok((study, experiments))
}
