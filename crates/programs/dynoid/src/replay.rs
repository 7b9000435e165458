//! Recordings replayed on bench models.
//!
//! A bench model is not linear: it has a torque limit and a controller that samples. It runs on the recorded demand and
//! on the engine torque that the recording shows, as the replays of a study do.

use std::path::{Path, PathBuf};

use bench_model::document::BenchModelDocument;
use bench_model::replay::Replay;
use page::Page;
use recording::{Channel, Format, Raster, Recording};
use report::replayed::Replayed;
use report::wording;
use rig::bench_file::LabelOverride;
use rig::experiment::Test;
use rig::results::{Trace, Validation};
use rig::{BenchFile, ControlMode, Diagnostic, Excitation, Experiment, ExperimentLabel, Severity};
use serde::{Deserialize, Serialize};
use study::{ReplayModel, experiment_of, replayed_stretch};
use work::Context;

use crate::bench::Bench;
use crate::error::Error;
use crate::files::Files;
use crate::linear::{MEASURED, Note, RESIDUAL};
use crate::recordings::{NOTHING_USABLE, worst};
use crate::{paths, read};

/// A bench model of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct BenchModelFile {
    /// Place of the file.
    pub path: PathBuf,
    /// The model.
    pub document: BenchModelDocument,
}

/// Stretch of a recording that is replayed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ReplayedStretch {
    /// All of it.
    Whole,
    /// The stretch that a study replays, so that both give the same numbers.
    AsStudy,
    /// The time from the first to the second, s.
    Between(f64, f64),
}

/// Recordings that bench models meet.
#[derive(Debug, Clone, PartialEq)]
pub struct ReplayOptions {
    /// Recordings, or folders of recordings.
    pub recordings: Vec<PathBuf>,
    /// Stretch of each.
    pub stretch: ReplayedStretch,
    /// The bench file, which names the channels; without it that of the first model, which lies beside the model or one
    /// folder up.
    pub bench: Option<PathBuf>,
    /// Control mode of the dynamometer; without it that of the label in the recording's name.
    pub mode: Option<ControlMode>,
}

/// Recordings on bench models.
#[derive(Debug, Clone, PartialEq)]
pub struct BenchReplays {
    all: Vec<Replayed>,
}

impl BenchReplays {
    /// Runs every recording on every model. `notes` gets notes on the recordings, those before an error too.
    ///
    /// # Errors
    /// No bench file, and a recording that cannot be read or replayed.
    pub fn of(
        models: &[BenchModelFile],
        options: &ReplayOptions,
        files: &Files,
        context: &Context,
        notes: &mut Vec<Note>,
    ) -> Result<Self, Error> {
        let path = options.bench_file(models)?;
        let bench = Bench::load(&path, files)?.into_file();
        let mut all = Vec::new();
        for input in files.named(&options.recordings)? {
            read::refuse_model(&input)?;
            let source = files.read_source(&input, &bench, &context.step(format!("reading {}", input.name), 0))?;
            let bench = with_mode(&bench, &source.file, options.mode);
            if bench.label_of(&source.file).is_none() {
                return Err(Error::NoLabel { file: source.file });
            }
            let (experiment, doubts) = experiment_of(&bench, &source).map_err(|reasons| not_replayed(&reasons))?;
            let errors = doubts.iter().filter(|doubt| doubt.severity == Severity::Error);
            notes.extend(errors.map(|doubt| Note::Warning(wording::remark(doubt))));
            for model in models {
                let recordings = &model.document.provenance.recordings;
                let is_seen = recordings.iter().any(|used| used.sha256 == source.sha256);
                let replay = replayed(&model.document, &experiment, options.stretch, is_seen)?;
                all.push(Replayed { model: paths::with_slashes(&model.path), replay });
            }
        }
        Ok(BenchReplays { all })
    }

    /// Each recording on each model.
    pub fn all(&self) -> &[Replayed] {
        &self.all
    }

    /// The replays as a page with this title.
    pub fn page(&self, title: &str) -> Page {
        report::replayed::page(title, &self.all)
    }

    /// The replays in numbers, without their traces.
    pub fn facts(&self) -> Vec<ReplayFacts> {
        self.all.iter().map(ReplayFacts::of).collect()
    }

    /// Of each signal what was measured, what was modelled, and the first less the second where both have a sample.
    pub fn beside_measured(&self) -> Recording {
        let (mut rasters, mut channels) = (Vec::new(), Vec::new());
        for signal in self.all.iter().flat_map(|one| &one.replay.signals) {
            let Validation { measured, modelled, stretch, .. } = signal;
            let residual = measured.values.iter().zip(&modelled.values).map(|(one, other)| one - other).collect();
            let residual = Trace { values: residual, ..measured.clone() };
            for (what, trace) in [(MEASURED, measured), ("simulated", modelled), (RESIDUAL, &residual)] {
                channels.push(Channel {
                    name: format!("{}_{what}", signal.quantity),
                    unit: signal.unit.clone(),
                    comment: String::new(),
                    raster: raster(&mut rasters, trace, &stretch.file),
                    samples: trace.values.clone(),
                });
            }
        }
        let format = Format::Csv { delimiter: ',', decimal_comma: false };
        Recording { format, comment: None, start_time: None, rasters, channels, findings: Vec::new() }
    }

    /// The modelled signals, each on its own clock.
    pub fn recording(&self) -> Recording {
        let (mut rasters, mut channels) = (Vec::new(), Vec::new());
        for one in &self.all {
            for signal in &one.replay.signals {
                channels.push(Channel {
                    name: format!("{}_simulated", signal.quantity),
                    unit: signal.unit.clone(),
                    comment: format!("{}: bench model {}", signal.stretch.file, one.model),
                    raster: raster(&mut rasters, &signal.modelled, &signal.stretch.file),
                    samples: signal.modelled.values.clone(),
                });
            }
        }
        let format = Format::Csv { delimiter: ',', decimal_comma: false };
        Recording { format, comment: None, start_time: None, rasters, channels, findings: Vec::new() }
    }
}

impl ReplayOptions {
    /// The bench file: the one given, or that of the first model.
    fn bench_file(&self, models: &[BenchModelFile]) -> Result<PathBuf, Error> {
        if let Some(path) = &self.bench {
            return Ok(path.clone());
        }
        let Some(model) = models.first() else { return Err(Error::internal("no model")) };
        let folder = paths::folder_of(&model.path);
        // The name alone: what a model file says must not lead elsewhere.
        let name = Path::new(&model.document.provenance.bench_file.name).file_name().unwrap_or_default();
        let beside = folder.ancestors().take(2).map(|folder| folder.join(name)).find(|path| path.is_file());
        beside.ok_or_else(|| Error::NoBenchBeside { path: model.path.clone() })
    }
}

impl ReplayedStretch {
    /// From when to when, s of the recording's clock; all of it where `None`.
    fn of(self, experiment: &Experiment) -> Option<(f64, f64)> {
        match self {
            ReplayedStretch::Whole => None,
            ReplayedStretch::AsStudy => replayed_stretch(experiment),
            ReplayedStretch::Between(from_s, to_s) => Some((from_s, to_s)),
        }
    }
}

fn not_replayed(reasons: &[Diagnostic]) -> Error {
    Error::NotReplayed { reason: worst(reasons).unwrap_or_else(|| NOTHING_USABLE.to_owned()) }
}

fn replayed(
    document: &BenchModelDocument,
    experiment: &Experiment,
    stretch: ReplayedStretch,
    seen_in_estimation: bool,
) -> Result<Replay, Error> {
    let replays_on = ReplayModel {
        model: &document.model,
        skews: document.skews.unwrap_or_default(),
        recorded_torque: document.recorded_torque.as_ref(),
    };
    let replay = replays_on.replay(experiment, stretch.of(experiment), seen_in_estimation);
    replay.map_err(|error| Error::NotReplayed { reason: error.to_string() })
}

/// The bench file with a label of this control mode for the recording.
fn with_mode(file: &BenchFile, recording: &str, mode: Option<ControlMode>) -> BenchFile {
    let mut file = file.clone();
    let Some(mode) = mode else { return file };
    let known = file.label_of(recording);
    let (test, excitation) =
        known.map_or((Test::from("Recording"), Excitation::Torque), |label| (label.test, label.excitation));
    let label = ExperimentLabel::new(test, excitation, mode);
    file.recordings.labels.insert(0, LabelOverride { file: recording.to_owned(), label });
    file
}

/// The raster of a trace, shared by those of one recording with the same clock.
fn raster(rasters: &mut Vec<Raster>, trace: &Trace, file: &str) -> usize {
    let time_s: Vec<f64> = (0..trace.values.len()).map(|k| trace.start_s + k as f64 * trace.sample_time_s).collect();
    let is_same = |raster: &Raster| raster.time_s == time_s && raster.name.as_deref() == Some(file);
    rasters.iter().position(is_same).unwrap_or_else(|| {
        rasters.push(Raster { time_s, name: Some(file.to_owned()) });
        rasters.len() - 1
    })
}

/// A replay without its traces.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReplayFacts {
    /// Name of the model.
    pub model: String,
    /// Name of the recording.
    pub recording: String,
    /// Label of the experiment.
    pub label: ExperimentLabel,
    /// Control mode of the dynamometer.
    pub mode: ControlMode,
    /// True where the model was estimated from this recording too.
    pub seen_in_estimation: bool,
    /// The signals that are compared.
    pub signals: Vec<ReplayedSignalFacts>,
}

/// A signal of a replay, compared with the recorded one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ReplayedSignalFacts {
    /// Its symbol.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Fit, %.
    #[serde(deserialize_with = "numerics::null::nan_if_null")]
    pub fit_percent: f64,
    /// Root mean square of the error.
    #[serde(deserialize_with = "numerics::null::nan_if_null")]
    pub rms_error: f64,
}

impl ReplayFacts {
    fn of(one: &Replayed) -> Self {
        let replay = &one.replay;
        ReplayFacts {
            model: one.model.clone(),
            recording: replay.stretch.file.clone(),
            label: replay.label.clone(),
            mode: replay.mode,
            seen_in_estimation: replay.seen_in_estimation,
            signals: replay.signals.iter().map(ReplayedSignalFacts::of).collect(),
        }
    }
}

impl ReplayedSignalFacts {
    fn of(signal: &Validation) -> Self {
        ReplayedSignalFacts {
            quantity: signal.quantity.clone(),
            unit: signal.unit.clone(),
            fit_percent: signal.fit_percent,
            rms_error: signal.rms_error,
        }
    }
}
