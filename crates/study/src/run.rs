//! The one function that sees the whole chain, from decoded recordings to the study.

use part_shaft::Parts;
use rig::{BenchFile, Experiment};

use super::gather::{StudyError, usable};
use super::progress::Progress;
use crate::analyses::{Analyses, analyses};
use crate::findings::Findings;
use crate::gather::{Gathered, Source};
use crate::{Provenance, Study, estimates, validity};

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
pub fn run(mut campaign: Campaign<'_>, progress: &mut dyn FnMut(Progress)) -> Result<Study, StudyError> {
    let gathered = usable(campaign.bench, std::mem::take(&mut campaign.sources), progress)?;
    let all: Vec<&Experiment> = gathered.experiments.iter().collect();
    Ok(studied(&campaign, &gathered, &Parts::of(&all, campaign.bench), progress))
}

/// The same study, and beside it all analyses that the recordings allow.
///
/// # Errors
/// Those of [`run`]: what an analysis lacks is part of the result.
pub fn run_full(
    mut campaign: Campaign<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Study, Analyses), StudyError> {
    let gathered = usable(campaign.bench, std::mem::take(&mut campaign.sources), progress)?;
    let all: Vec<&Experiment> = gathered.experiments.iter().collect();
    let parts = Parts::of(&all, campaign.bench);
    let study = studied(&campaign, &gathered, &parts, progress);
    Ok((study, analyses(&gathered.experiments, &parts, progress)))
}

/// The study of these experiments.
fn studied(
    campaign: &Campaign<'_>,
    gathered: &Gathered,
    parts: &Parts<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Study {
    let mut recordings = gathered.recordings.clone();
    let mut findings = Findings::new(campaign.bench, &gathered.experiments, gathered.diagnostics.clone(), progress);
    let estimates = estimates::all(&mut findings, parts);
    for recording in &mut recordings {
        recording.used_for = findings.uses_of(&recording.file);
    }
    let validity = validity::of(&gathered.experiments, &recordings, &estimates.shaft);
    let mut diagnostics = findings.diagnostics;
    diagnostics.sort_by_key(|d| std::cmp::Reverse(d.severity));
    Study {
        provenance: Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            bench_file: campaign.bench_file.1.to_owned(),
            bench_file_name: campaign.bench_file.0.to_owned(),
            seed: campaign.seed,
            report: campaign.bench.report.clone(),
        },
        bench: campaign.bench.facts(),
        recordings,
        choices: estimates.choices,
        timing: estimates.timing,
        speed_controller: estimates.speed_controller,
        feed_forward: estimates.feed_forward,
        torque_control: estimates.torque_control,
        shaft: estimates.shaft,
        whole: estimates.whole,
        model: estimates.model,
        validity,
        skews: estimates.skews,
        replays: estimates.replays,
        diagnostics,
    }
}
