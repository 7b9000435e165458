//! The one function that sees the whole chain, from decoded recordings to the study.

use rig::{BenchFile, Experiment};

use super::gather::{StudyError, usable};
use super::progress::Progress;
use crate::analyses::{Analyses, analyses};
use crate::findings::Findings;
use crate::gather::{Gathered, Source};
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
