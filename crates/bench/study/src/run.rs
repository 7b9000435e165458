//! The one function that sees the whole chain, from decoded recordings to the study.

use bench_model::model::AssembledModel;
use part_engine::engine_pulses;
use part_friction::{Friction, FrictionError};
use part_shaft::Parts;
use rig::{BenchFile, Experiment};
use work::Context;

use super::gather::StudyError;
use crate::analyses::{Analyses, analyses};
use crate::disturbances::disturbances;
use crate::findings::Findings;
use crate::gather::Prepared;
use crate::{Provenance, Study, estimates, run_outs, struck, validity};

/// Steps of a study: the parts, comparing, the timing, the whole model, the replays, the friction of the dynamometer,
/// the pulses of the engine.
const STEPS: u64 = 7;

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
pub fn run(mut campaign: Campaign<'_>, context: &Context) -> Result<Study, StudyError> {
    campaign.recordings = campaign.recordings.usable(campaign.bench)?;
    let all: Vec<&Experiment> = campaign.recordings.experiments.iter().collect();
    Ok(studied(&campaign, &Parts::of(&all, campaign.bench), context).0)
}

/// The same study, and beside it all analyses that the recordings allow.
///
/// # Errors
/// Those of [`run`]: what an analysis lacks is part of the result.
pub fn run_full(mut campaign: Campaign<'_>, context: &Context) -> Result<(Study, Analyses), StudyError> {
    campaign.recordings = campaign.recordings.usable(campaign.bench)?;
    let all: Vec<&Experiment> = campaign.recordings.experiments.iter().collect();
    let parts = Parts::of(&all, campaign.bench);
    let (study, friction) = studied(&campaign, &parts, context);
    Ok((study, analyses(&campaign.recordings.experiments, &parts, friction, context)))
}

/// The study of these experiments, and the friction that its model rests on.
fn studied(campaign: &Campaign<'_>, parts: &Parts<'_>, context: &Context) -> (Study, Result<Friction, FrictionError>) {
    let prepared = &campaign.recordings;
    let mut recordings = prepared.recordings.clone();
    let step = context.step("studying", STEPS);
    let mut findings = Findings::new(campaign.bench, prepared, &step);
    let estimates = estimates::all(&mut findings, parts);
    for recording in &mut recordings {
        recording.used_for = findings.uses_of(&recording.file);
    }
    let is_sound = |one: &Experiment| struck::is_sound(&findings, one);
    let friction = {
        let _part = step.step("estimating: friction of the dynamometer", 0);
        let sound: Vec<&Experiment> = parts.experiments.iter().copied().filter(|one| is_sound(one)).collect();
        run_outs::friction_of(&sound, campaign.bench)
    };
    let model = estimates.model.map(|model| {
        let _part = step.step("estimating: pulses of the engine", 0);
        let dyno_friction = run_outs::of_model(&friction, campaign.bench);
        let engine_pulses = engine_pulses(parts, dyno_friction.as_ref(), &is_sound).ok();
        AssembledModel { engine_pulses, dyno_friction, disturbances: Some(disturbances(parts)), ..model }
    });
    let validity = validity::of(&prepared.experiments, &recordings, &estimates.shaft);
    let mut diagnostics = findings.diagnostics;
    diagnostics.sort_by_key(|d| std::cmp::Reverse(d.severity));
    let study = Study {
        provenance: Provenance {
            studied_on: None,
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
    };
    (study, friction)
}
