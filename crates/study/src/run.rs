//! The one function that sees the whole chain, from decoded recordings to the study.

use bench_model::model::AssembledModel;
use part_engine::engine_pulses;
use part_shaft::Parts;
use rig::{BenchFile, Experiment};

use super::gather::StudyError;
use super::progress::Progress;
use crate::analyses::{Analyses, analyses};
use crate::findings::Findings;
use crate::gather::Prepared;
use crate::{Provenance, Study, estimates, run_outs, struck, validity};

/// Everything a study is made from.
#[derive(Debug)]
pub struct Campaign<'a> {
    /// The bench.
    pub bench: &'a BenchFile,
    /// The bench file's name and its text, word for word.
    pub bench_file: (&'a str, &'a str),
    /// The recordings.
    pub recordings: Prepared,
    /// Seed, when the recordings were simulated.
    pub seed: Option<u64>,
}

/// Studies a campaign: estimates every part its recordings allow, assembles the model, replays what it has not seen.
///
/// A part whose recordings are missing is *not estimated* and says what it needs; that is no error.
///
/// # Errors
/// No channels, no recording, or none that can be used.
pub fn run(mut campaign: Campaign<'_>, progress: &mut dyn FnMut(Progress)) -> Result<Study, StudyError> {
    campaign.recordings = campaign.recordings.usable(campaign.bench)?;
    let all: Vec<&Experiment> = campaign.recordings.experiments.iter().collect();
    Ok(studied(&campaign, &Parts::of(&all, campaign.bench), progress))
}

/// The same study, and beside it all analyses that the recordings allow.
///
/// # Errors
/// Those of [`run`]: what an analysis lacks is part of the result.
pub fn run_full(
    mut campaign: Campaign<'_>,
    progress: &mut dyn FnMut(Progress),
) -> Result<(Study, Analyses), StudyError> {
    campaign.recordings = campaign.recordings.usable(campaign.bench)?;
    let all: Vec<&Experiment> = campaign.recordings.experiments.iter().collect();
    let parts = Parts::of(&all, campaign.bench);
    let study = studied(&campaign, &parts, progress);
    Ok((study, analyses(&campaign.recordings.experiments, &parts, progress)))
}

/// The study of these experiments.
fn studied(campaign: &Campaign<'_>, parts: &Parts<'_>, progress: &mut dyn FnMut(Progress)) -> Study {
    let prepared = &campaign.recordings;
    let mut recordings = prepared.recordings.clone();
    let mut findings = Findings::new(campaign.bench, &prepared.experiments, prepared.diagnostics.clone(), progress);
    let estimates = estimates::all(&mut findings, parts);
    for recording in &mut recordings {
        recording.used_for = findings.uses_of(&recording.file);
    }
    let is_sound = |one: &Experiment| struck::is_sound(&findings, one);
    let sound: Vec<&Experiment> = parts.experiments.iter().copied().filter(|one| is_sound(one)).collect();
    let model = estimates.model.map(|model| {
        let friction = run_outs::of_model(&sound, campaign.bench);
        let engine_pulses = engine_pulses(parts, friction.as_ref(), &is_sound).ok();
        AssembledModel { engine_pulses, dyno_friction: friction, ..model }
    });
    let validity = validity::of(&prepared.experiments, &recordings, &estimates.shaft);
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
        model,
        validity,
        skews: estimates.skews,
        recorded_torque: estimates.recorded_torque,
        replays: estimates.replays,
        diagnostics,
    }
}
