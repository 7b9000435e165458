//! A study in short.

use report::brief::key_numbers;
use report::wording;
use rig::results::{Parameter, Part, Reason};
use rig::{Diagnostic, ExperimentLabel};
use serde::Serialize;
use study::verdict::Rule;
use study::{RecordingSummary, Study, TorqueScale, torque_scale, verdict};

/// Verdict, key numbers, what is missing and why, and findings.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StudyFacts<'a> {
    bench: &'a str,
    verdict: VerdictFacts,
    estimates: Vec<EstimateFacts<'a>>,
    /// By which factor all torques may be wrong; none where nothing shows it.
    torque_scale: Option<TorqueScale>,
    not_estimated: Vec<NeedFacts>,
    findings: Vec<FindingFacts>,
    recordings: Vec<RecordingFacts<'a>>,
}

impl<'a> StudyFacts<'a> {
    /// Of a study.
    pub fn of(study: &'a Study) -> Self {
        StudyFacts {
            bench: &study.bench.name,
            verdict: VerdictFacts::of(study),
            estimates: key_numbers(study)
                .into_iter()
                .map(|(part, parameter)| EstimateFacts { part, parameter })
                .collect(),
            torque_scale: torque_scale(study),
            not_estimated: study.not_estimated().into_iter().map(NeedFacts::of).collect(),
            findings: study.diagnostics.iter().map(FindingFacts::of).collect(),
            recordings: study.recordings.iter().map(RecordingFacts::of).collect(),
        }
    }
}

/// The verdict on a study, in words.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct VerdictFacts {
    level: &'static str,
    headline: &'static str,
    rules: Vec<RuleFacts>,
}

impl VerdictFacts {
    /// Of a study.
    pub fn of(study: &Study) -> Self {
        let verdict = verdict(study);
        VerdictFacts {
            level: verdict.level.key(),
            headline: wording::headline(verdict.level),
            rules: verdict.rules.iter().map(RuleFacts::of).collect(),
        }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RuleFacts {
    asks: String,
    found: String,
    outcome: &'static str,
}

impl RuleFacts {
    fn of(rule: &Rule) -> Self {
        RuleFacts { asks: wording::asks(rule), found: wording::found(rule), outcome: wording::outcome(rule.level) }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct EstimateFacts<'a> {
    part: &'static str,
    #[serde(flatten)]
    parameter: &'a Parameter,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct NeedFacts {
    part: &'static str,
    needs: String,
}

impl NeedFacts {
    fn of((part, needs): (Part, &[Reason])) -> Self {
        NeedFacts { part: wording::part(part), needs: wording::needs(needs) }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct FindingFacts {
    severity: &'static str,
    file: Option<String>,
    channel: Option<String>,
    time_s: Option<f64>,
    text: String,
    advice: &'static str,
}

impl FindingFacts {
    fn of(found: &Diagnostic) -> Self {
        FindingFacts {
            severity: wording::severity(found.severity),
            file: found.place.file.clone(),
            channel: found.place.channel.clone(),
            time_s: found.place.time_s,
            text: wording::finding(&found.finding),
            advice: wording::advice(&found.finding),
        }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct RecordingFacts<'a> {
    file: &'a str,
    sha256: &'a str,
    label: Option<&'a ExperimentLabel>,
    used_for: &'a [Part],
}

impl<'a> RecordingFacts<'a> {
    fn of(recording: &'a RecordingSummary) -> Self {
        RecordingFacts {
            file: &recording.file,
            sha256: &recording.sha256,
            label: recording.label.as_ref(),
            used_for: &recording.used_for,
        }
    }
}
