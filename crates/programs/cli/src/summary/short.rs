//! A study in short, as JSON for programs.

use std::path::Path;

use dynoid::WrittenStudy;
use report::brief::key_numbers;
use report::wording;
use rig::results::{Parameter, Part, Reason};
use rig::{Diagnostic, ExperimentLabel};
use serde::Serialize;
use study::verdict::Rule;
use study::{ModelComparison, RecordingSummary, TorqueScale, torque_scale, verdict};

/// A study in short, for programs.
#[derive(Serialize)]
pub(crate) struct Short<'a> {
    bench: &'a str,
    verdict: ShortVerdict,
    estimates: Vec<ShortEstimate<'a>>,
    /// By which factor all torques may be wrong; none where nothing shows it.
    torque_scale: Option<TorqueScale>,
    not_estimated: Vec<ShortNeed>,
    findings: Vec<ShortFinding>,
    recordings: Vec<ShortRecording<'a>>,
    report: &'a Path,
    /// The report with all analyses; none where they were not wanted.
    full_report: Option<&'a Path>,
    data: &'a Path,
    /// The table of measured and modelled series; none where nothing was estimated.
    series: Option<&'a Path>,
    /// The bench model; none where the study has none.
    model: Option<&'a Path>,
    /// Changes since the study that was in the folder before; none where it had no model.
    earlier: Option<ShortEarlier<'a>>,
}

#[derive(Serialize)]
struct ShortEarlier<'a> {
    date: &'a str,
    changed: Option<bool>,
    comparison: Option<&'a ModelComparison>,
}

#[derive(Serialize)]
struct ShortVerdict {
    level: &'static str,
    headline: &'static str,
    rules: Vec<ShortRule>,
}

#[derive(Serialize)]
struct ShortRule {
    asks: String,
    found: String,
    outcome: &'static str,
}

#[derive(Serialize)]
struct ShortEstimate<'a> {
    part: &'static str,
    #[serde(flatten)]
    parameter: &'a Parameter,
}

#[derive(Serialize)]
struct ShortNeed {
    part: &'static str,
    needs: String,
}

#[derive(Serialize)]
struct ShortFinding {
    severity: &'static str,
    file: Option<String>,
    channel: Option<String>,
    time_s: Option<f64>,
    text: String,
    advice: &'static str,
}

#[derive(Serialize)]
struct ShortRecording<'a> {
    file: &'a str,
    sha256: &'a str,
    label: Option<&'a ExperimentLabel>,
    used_for: &'a [Part],
}

/// A study in short, for programs.
pub(crate) fn short(written: &WrittenStudy) -> Short<'_> {
    let study = &written.study;
    let verdict = verdict(study);
    let rule = |rule: &Rule| ShortRule {
        asks: wording::asks(rule),
        found: wording::found(rule),
        outcome: wording::outcome(rule.level),
    };
    let estimate = |(part, parameter)| ShortEstimate { part, parameter };
    let need = |(part, needs): (Part, &[Reason])| ShortNeed { part: wording::part(part), needs: wording::needs(needs) };
    Short {
        bench: &study.bench.name,
        verdict: ShortVerdict {
            level: verdict.level.key(),
            headline: wording::headline(verdict.level),
            rules: verdict.rules.iter().map(rule).collect(),
        },
        estimates: key_numbers(study).into_iter().map(estimate).collect(),
        torque_scale: torque_scale(study),
        not_estimated: study.not_estimated().into_iter().map(need).collect(),
        findings: study.diagnostics.iter().map(short_finding).collect(),
        recordings: study.recordings.iter().map(short_recording).collect(),
        report: &written.report,
        full_report: written.full_report.as_deref(),
        data: &written.data,
        series: written.series.as_deref(),
        model: written.model.as_deref(),
        earlier: written.earlier.as_ref().map(|earlier| ShortEarlier {
            date: &earlier.date,
            changed: earlier.comparison.as_ref().map(ModelComparison::has_changed),
            comparison: earlier.comparison.as_ref(),
        }),
    }
}

fn short_finding(found: &Diagnostic) -> ShortFinding {
    ShortFinding {
        severity: wording::severity(found.severity),
        file: found.place.file.clone(),
        channel: found.place.channel.clone(),
        time_s: found.place.time_s,
        text: wording::finding(&found.finding),
        advice: wording::advice(&found.finding),
    }
}

fn short_recording(recording: &RecordingSummary) -> ShortRecording<'_> {
    ShortRecording {
        file: &recording.file,
        sha256: &recording.sha256,
        label: recording.label.as_ref(),
        used_for: &recording.used_for,
    }
}
