//! From decoded files to labelled experiments.

use std::sync::Arc;

use numerics::parallel::map;
use recording::{Recording, RecordingError};
use rig::bench_file::names_same_file;
use rig::{
    BenchFile, Diagnostic, Experiment, Finding, Place, PrepareError, Role, SIMULATED, Severity, prepare,
    prepare_validation,
};
use work::Context;

use crate::RecordingSummary;

/// No recording is older: the first version of MDF is of this year.
const FIRST_DAY: &str = "1991-01-01";

/// One file as the program read it.
#[derive(Debug)]
pub struct Source {
    /// The file, as the user knows it.
    pub file: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// Its content, or why it cannot be read.
    pub recording: Result<Recording, RecordingError>,
}

/// Recordings that were checked and brought into SI: what a study is made from. Copies share the samples.
#[derive(Debug, Clone, Default)]
pub struct Prepared {
    pub(super) experiments: Arc<Vec<Experiment>>,
    /// Parts of recordings from which nothing may be estimated.
    pub(super) validation: Arc<Vec<Experiment>>,
    pub(super) recordings: Vec<RecordingSummary>,
    pub(super) diagnostics: Vec<Diagnostic>,
    readable: usize,
    /// Files from a virtual bench.
    simulated: Vec<String>,
}

impl Prepared {
    /// Of these sources.
    pub fn of(bench: &BenchFile, sources: Vec<Source>, context: &Context) -> Self {
        let mut prepared = Prepared::default();
        prepared.add(bench, sources, context);
        prepared
    }

    /// Prepares what can be used of further sources, and notes of the others why not. Of a source only the signals of
    /// the bench stay in memory.
    pub fn add(&mut self, bench: &BenchFile, sources: Vec<Source>, context: &Context) {
        let mut fresh = Vec::new();
        let first = self.recordings.len();
        for source in &sources {
            fresh.push((source, first_of_its_kind(source, &self.recordings)));
            self.recordings.push(RecordingSummary {
                file: source.file.clone(),
                sha256: source.sha256.clone(),
                label: None,
                recorded_on: recorded_on(source),
                duration_s: source.recording.as_ref().map_or(0.0, duration_s),
                mean_speed_rad_s: None,
                sample_times_s: Vec::new(),
                used_for: Vec::new(),
            });
        }
        let prepared = map(&fresh, |(source, is_fresh)| {
            let _step = context.step(format!("checking {}", source.file), 0);
            let experiment = is_fresh.clone().and_then(|()| experiment_of(bench, source));
            (experiment, is_fresh.is_ok().then(|| validation_of(bench, source)).flatten())
        });
        for (summary, (outcome, validation)) in self.recordings.iter_mut().skip(first).zip(prepared) {
            match validation {
                Some(Ok(experiment)) => Arc::make_mut(&mut self.validation).push(experiment),
                Some(Err(diagnostics)) => self.diagnostics.extend(diagnostics),
                None => {}
            }
            match outcome {
                Ok((experiment, diagnostics)) => {
                    summary.label = Some(experiment.label.clone());
                    summary.mean_speed_rad_s = experiment.signal(Role::DynoSpeed).and_then(signal::Signal::mean);
                    summary.sample_times_s = experiment.signals.iter().map(|(r, s)| (*r, s.sample_time_s)).collect();
                    self.diagnostics.extend(diagnostics);
                    Arc::make_mut(&mut self.experiments).push(experiment);
                }
                Err(diagnostics) => self.diagnostics.extend(diagnostics),
            }
        }
        self.readable += sources.iter().filter(|source| source.recording.is_ok()).count();
        self.simulated.extend(sources.iter().filter(|source| is_simulated(source)).map(|s| s.file.clone()));
    }

    /// The recordings that can be used.
    pub fn experiments(&self) -> &[Experiment] {
        &self.experiments
    }

    /// Doubts about the recordings, and why some cannot be used.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// That recordings are from a virtual bench: a warning where others are measured.
    fn doubt_of_simulated(&self) -> Option<Diagnostic> {
        let beside_measured = self.simulated.len() < self.readable;
        let severity = if beside_measured { Severity::Warning } else { Severity::Note };
        (!self.simulated.is_empty()).then(|| Diagnostic {
            severity,
            place: Place::default(),
            finding: Finding::Simulated { files: self.simulated.clone(), beside_measured },
        })
    }

    /// Stretches of recordings that are not there: a name may be misspelt.
    fn doubts_of_stretches(&self, bench: &BenchFile) -> Vec<Diagnostic> {
        let is_there = |file: &str| self.recordings.iter().any(|recording| names_same_file(&recording.file, file));
        let mut missing: Vec<&str> = bench.recordings.stretches.iter().map(|stretch| stretch.file.as_str()).collect();
        missing.retain(|file| !is_there(file));
        missing.dedup();
        let doubt = |file: &str| Diagnostic {
            severity: Severity::Warning,
            place: Place { file: Some(file.to_owned()), ..Place::default() },
            finding: Finding::StretchOfNoRecording,
        };
        missing.into_iter().map(doubt).collect()
    }

    /// These recordings, of which at least one can be used.
    pub(crate) fn usable(mut self, bench: &BenchFile) -> Result<Self, StudyError> {
        if bench.channels.is_empty() {
            return Err(StudyError::NoChannels);
        }
        if self.recordings.is_empty() {
            return Err(StudyError::NoRecordings);
        }
        let doubt = self.doubt_of_simulated();
        self.diagnostics.extend(doubt);
        let doubts = self.doubts_of_stretches(bench);
        self.diagnostics.extend(doubts);
        match self.experiments.is_empty() {
            true => Err(StudyError::NothingUsable { count: self.recordings.len(), diagnostics: self.diagnostics }),
            false => Ok(self),
        }
    }
}

fn is_simulated(source: &Source) -> bool {
    let comment = source.recording.as_ref().ok().and_then(|recording| recording.comment.as_deref());
    comment.is_some_and(|comment| comment.ends_with(SIMULATED))
}

/// The day of a recording; none where the logger's clock was not set, which then counts from 1970 or 1980.
fn recorded_on(source: &Source) -> Option<String> {
    let start = source.recording.as_ref().ok()?.start_time?;
    Some(start.day()).filter(|day| day.as_str() >= FIRST_DAY)
}

fn duration_s(recording: &Recording) -> f64 {
    let times = || recording.rasters.iter().flat_map(|r| r.time_s.iter().copied()).filter(|t| t.is_finite());
    let (first, last) = times().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
    (last - first).max(0.0)
}

fn refused(source: &Source, finding: Finding) -> Vec<Diagnostic> {
    let place = Place { file: Some(source.file.clone()), ..Place::default() };
    vec![Diagnostic { severity: Severity::Error, place, finding }]
}

fn first_of_its_kind(source: &Source, earlier: &[RecordingSummary]) -> Result<(), Vec<Diagnostic>> {
    // Files that cannot be read are often empty, and all of these are alike.
    let is_same = |e: &&RecordingSummary| source.recording.is_ok() && e.sha256 == source.sha256;
    match earlier.iter().find(|e| is_same(e) || e.file == source.file) {
        Some(twin) => Err(refused(source, Finding::DuplicateRecording { other: twin.file.clone() })),
        None => Ok(()),
    }
}

/// The experiment a source holds with the doubts about it.
///
/// # Errors
/// The reasons why it holds none.
pub fn experiment_of(bench: &BenchFile, source: &Source) -> Result<(Experiment, Vec<Diagnostic>), Vec<Diagnostic>> {
    let recording = match &source.recording {
        Ok(recording) => recording,
        Err(error) => return Err(refused(source, Finding::UnreadableRecording { error: error.clone().into() })),
    };
    let Some(label) = bench.label_of(&source.file) else {
        return Err(refused(source, Finding::NoLabel));
    };
    prepare(&source.file, recording, bench, label).map_err(reasons)
}

/// The part of a source that is kept for validation; the doubts about the recording are those of its other part.
fn validation_of(bench: &BenchFile, source: &Source) -> Option<Result<Experiment, Vec<Diagnostic>>> {
    let recording = source.recording.as_ref().ok()?;
    let label = bench.label_of(&source.file)?;
    let prepared = prepare_validation(&source.file, recording, bench, label)?;
    Some(prepared.map(|(experiment, _)| experiment).map_err(reasons))
}

fn reasons(error: PrepareError) -> Vec<Diagnostic> {
    match error {
        PrepareError::NothingUsable { diagnostics, .. }
        | PrepareError::NoCommonStretch { diagnostics, .. }
        | PrepareError::Mislabelled { diagnostics, .. } => diagnostics,
    }
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
    #[error("no recording can be used ({count} tried)")]
    NothingUsable {
        /// How many there are.
        count: usize,
        /// Why each cannot.
        diagnostics: Vec<Diagnostic>,
    },
}
