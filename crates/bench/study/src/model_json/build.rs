//! The bench model of a study as a file of its own.

use bench_model::document::{
    BenchFileOrigin, BenchModelDocument, DescribedParameter, NotEstimated, Provenance, StudyVerdict, UsedRecording,
};
use bench_model::model::ModelParameter;
use rig::results::{Parameter, Reason};

use crate::verdict::{Level, Rule, verdict};
use crate::{RecordingSummary, Study};

/// Facts about a study that are not in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// The day, UTC, as in 2026-05-03.
    pub date: String,
    /// SHA-256 of the bench file, hexadecimal.
    pub bench_file_sha256: String,
}

/// Sentences of the file, for which a study has numbers and structure only.
#[derive(Debug, Clone, Copy)]
pub struct Words {
    /// The level of a verdict as a headline.
    pub headline: fn(Level) -> &'static str,
    /// A rule that is not met, as a sentence without its full stop.
    pub reservation: fn(&Rule) -> String,
    /// Needs of a part that is not estimated.
    pub needs: fn(&[Reason]) -> String,
}

/// The bench model of a study; `None` where the study has none.
pub fn bench_model(study: &Study, origin: Origin, words: &Words) -> Option<BenchModelDocument> {
    let provenance = Provenance {
        dynoid_version: study.provenance.version.clone(),
        date: origin.date,
        bench_file: BenchFileOrigin {
            name: study.provenance.bench_file_name.clone(),
            sha256: origin.bench_file_sha256,
        },
        recordings: study.recordings.iter().filter(|one| !one.used_for.is_empty()).map(used).collect(),
        seed: study.provenance.seed,
        verdict: Some(judged(study, words)),
    };
    let document = BenchModelDocument::new(study.model.clone()?, study.bench.clone(), provenance);
    let mut document = document.with_intervals(|parameter| interval(study, parameter));
    document.skews = study.skews;
    document.recorded_torque = study.recorded_torque.clone();
    document.validity = study.validity;
    document.not_estimated = not_estimated(study, words);
    Some(document)
}

/// The numbers of a document with their 95 % intervals, as a part shows its own.
pub fn parameters(document: &BenchModelDocument) -> Vec<Parameter> {
    let shown = |one: &DescribedParameter| {
        let own = by_standard_error(one);
        Parameter { interval: one.interval_95.unwrap_or(own.interval), ..own }
    };
    document.parameters().iter().map(shown).collect()
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
        ModelParameter::EngineInertia => return of.standard_error.map(|_| by_standard_error(of).interval),
    };
    let found = estimate.parameter(of.parameter.quantity())?;
    (found.value == of.value).then_some(found.interval)
}

/// A number with the interval that its standard error gives.
fn by_standard_error(of: &DescribedParameter) -> Parameter {
    let degrees_of_freedom = of.degrees_of_freedom.unwrap_or(f64::INFINITY);
    Parameter::new(of.parameter.quantity(), of.value, of.standard_error.unwrap_or(0.0), degrees_of_freedom)
}

fn used(recording: &RecordingSummary) -> UsedRecording {
    UsedRecording {
        file: recording.file.clone(),
        sha256: recording.sha256.clone(),
        label: recording.label.as_ref().map(ToString::to_string),
        used_for: recording.used_for.clone(),
    }
}

fn judged(study: &Study, words: &Words) -> StudyVerdict {
    let verdict = verdict(study);
    let unmet = verdict.rules.iter().filter(|rule| rule.level != Level::Good);
    StudyVerdict {
        level: verdict.level.key().to_owned(),
        headline: (words.headline)(verdict.level).to_owned(),
        reservations: unmet.map(words.reservation).collect(),
    }
}

fn not_estimated(study: &Study, words: &Words) -> Vec<NotEstimated> {
    let of = |(part, needs)| NotEstimated { part, needs: (words.needs)(needs) };
    study.not_estimated().into_iter().map(of).collect()
}
