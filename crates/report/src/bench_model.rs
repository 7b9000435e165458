//! The bench model of a study as a file of its own.

use bench_model::document::{
    BenchFileOrigin, BenchModelDocument, DescribedParameter, NotEstimated, Provenance, StudyVerdict, UsedRecording,
};
use bench_model::model::ModelParameter;
use rig::results::Part;
use study::{RecordingSummary, Study};

use crate::verdict::{Level, part_states, verdict};
use crate::wording;

/// What a study does not know of itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// The day, UTC, as in 2026-05-03.
    pub date: String,
    /// SHA-256 of the bench file, hexadecimal.
    pub bench_file_sha256: String,
}

/// The bench model of a study; `None` where the study has none.
pub fn bench_model(study: &Study, origin: Origin) -> Option<BenchModelDocument> {
    let provenance = Provenance {
        dynoid_version: study.provenance.version.clone(),
        date: origin.date,
        bench_file: BenchFileOrigin {
            name: study.provenance.bench_file_name.clone(),
            sha256: origin.bench_file_sha256,
        },
        recordings: study.recordings.iter().filter(|one| !one.used_for.is_empty()).map(used).collect(),
        seed: study.provenance.seed,
        verdict: Some(judged(study)),
    };
    let document = BenchModelDocument::new(study.model.clone()?, study.bench.clone(), provenance);
    let mut document = document.with_intervals(|parameter| interval(study, parameter));
    document.skews = study.skews;
    document.validity = study.validity;
    document.not_estimated = not_estimated(study);
    Some(document)
}

/// The interval of an estimate that the model takes as it is.
fn interval(study: &Study, of: &DescribedParameter) -> Option<(f64, f64)> {
    let estimate = match of.parameter {
        ModelParameter::DynoInertia | ModelParameter::Stiffness | ModelParameter::Damping => {
            &study.shaft.estimated()?.estimate
        }
        ModelParameter::Proportional | ModelParameter::Integral | ModelParameter::ControllerDelay => {
            &study.speed_controller.estimated()?.estimate
        }
        ModelParameter::SpeedFeedForward | ModelParameter::AccelerationFeedForward => {
            &study.feed_forward.estimated()?.estimate
        }
        ModelParameter::TorqueControlDelay | ModelParameter::TorqueControlBandwidth => {
            &study.torque_control.estimated()?.delay_and_lag
        }
        // J_e is what the bench file and the recordings give together.
        ModelParameter::EngineInertia => return None,
    };
    let found = estimate.parameter(of.parameter.quantity())?;
    (found.value == of.value).then_some(found.interval)
}

fn used(recording: &RecordingSummary) -> UsedRecording {
    UsedRecording {
        file: recording.file.clone(),
        sha256: recording.sha256.clone(),
        label: recording.label.as_ref().map(ToString::to_string),
        used_for: recording.used_for.clone(),
    }
}

fn judged(study: &Study) -> StudyVerdict {
    let verdict = verdict(study);
    let unmet = verdict.rules.iter().filter(|rule| rule.level != Level::Good);
    StudyVerdict {
        level: verdict.level.key().to_owned(),
        headline: verdict.level.headline().to_owned(),
        reservations: unmet.map(|rule| wording::capitalised(&rule.found)).collect(),
    }
}

fn not_estimated(study: &Study) -> Vec<NotEstimated> {
    let needs = |part: Part| match part {
        Part::Timing => study.timing.needs(),
        Part::SpeedController => study.speed_controller.needs(),
        Part::FeedForward => study.feed_forward.needs(),
        Part::TorqueControl => study.torque_control.needs(),
        Part::Shaft => study.shaft.needs(),
        Part::Whole => study.whole.needs(),
    };
    let missing = part_states(study).into_iter().filter(|(_, there)| !there);
    missing.map(|(part, _)| NotEstimated { part, needs: wording::needs(needs(part)) }).collect()
}
