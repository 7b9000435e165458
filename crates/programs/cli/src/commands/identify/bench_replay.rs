//! `dynoid model compare` and `simulate` with bench models: recordings replayed on them.
//!
//! A bench model is not linear: it has a torque limit and a controller that samples. It runs on the recorded demand and
//! on the engine torque that the recording shows, as the replays of a study do.

use std::path::{Path, PathBuf};

use bench_model::document::BenchModelDocument;
use bench_model::replay::Replay;
use dynoid::{FileFormat, Files, Model, paths};
use recording::{Channel, Format, Raster, Recording};
use report::replayed::Replayed;
use report::wording;
use rig::bench_file::LabelOverride;
use rig::experiment::Test;
use rig::results::{Trace, Validation};
use rig::{BenchFile, ControlMode, Excitation, Experiment, ExperimentLabel, Severity};
use serde::Serialize;
use study::{ReplayModel, experiment_of, replayed_stretch};

use super::recorded::check_output;
use crate::cli::identify::{BenchArguments, CompareArguments, MeetArguments, MeetDetrend, Mode, RunArguments};
use crate::commands::result::{Sorted, check_plot, show, show_with};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// A bench model by the name of its file.
pub(super) struct Named {
    path: PathBuf,
    document: BenchModelDocument,
}

impl Named {
    /// The bench models in files; `None` if the files hold linear models.
    ///
    /// # Errors
    /// Files of both kinds, or one that cannot be read.
    pub(super) fn all(paths: &[PathBuf], files: &Files) -> Result<Option<Vec<Named>>, CliError> {
        let (mut found, mut linear) = (Vec::new(), None);
        for path in paths {
            match files.model(path)? {
                Model::Bench(document) => found.push(Named { path: path.clone(), document: *document }),
                Model::Linear(_) => linear = linear.or(Some(path)),
            }
        }
        match (found.first(), linear) {
            (Some(bench), Some(linear)) => Err(CliError::Usage {
                what: format!(
                    "{} is a bench model and {} a linear model; compare models of one kind. `dynoid export --to linear` makes linear models \
                     of a bench model",
                    bench.path.display(),
                    linear.display()
                ),
            }),
            (None, _) => Ok(None),
            (Some(_), None) => Ok(Some(found)),
        }
    }
}

/// `dynoid model compare` with bench models.
pub(super) fn compare(
    models: &[Named],
    arguments: &CompareArguments,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    if arguments.horizon.is_some() {
        return Err(of_linear_models("--horizon"));
    }
    let all = replays(models, &arguments.meet, &arguments.bench, Unasked::AsStudy, terminal)?;
    let page = || report::replayed::page("Bench models compared", &all);
    show(&arguments.result, page, || facts(&all), terminal)?;
    Ok(Outcome::Done)
}

/// `dynoid model simulate` with a bench model: its signals may be written to a recording.
pub(super) fn simulate(
    model: Named,
    arguments: &RunArguments,
    bench: &BenchArguments,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let RunArguments { meet, out, result, .. } = arguments;
    check_plot(result, &terminal.files())?;
    if arguments.from_rest {
        return Err(of_linear_models("--from-rest"));
    }
    if let Some(path) = out {
        check_output(path, meet.on.len(), &terminal.files())?;
    }
    let all = replays(&[model], meet, bench, Unasked::Whole, terminal)?;
    if let Some(path) = out {
        FileFormat::of_output(path)?.write(&recording(&all), path, &terminal.files())?;
    }
    let page = || report::replayed::page("Bench model simulated", &all);
    show_with(result, &[out], page, || facts(&all), terminal)?;
    Ok(Outcome::Done)
}

fn of_linear_models(option: &str) -> CliError {
    CliError::Usage { what: format!("{option} belongs to linear models; leave it out with a bench model") }
}

/// Every recording on every model.
fn replays(
    models: &[Named],
    meet: &MeetArguments,
    bench: &BenchArguments,
    unasked: Unasked,
    terminal: &mut Terminal,
) -> Result<Vec<Replayed>, CliError> {
    if meet.sample_time_s.is_some() {
        return Err(of_linear_models("--sample-time"));
    }
    if meet.detrend != MeetDetrend::Model {
        return Err(of_linear_models("--detrend"));
    }
    let path = bench_file(models, bench)?;
    let file = dynoid::Bench::load(&path, &terminal.files())?.into_file();
    let mut all = Vec::new();
    for input in terminal.files().named(&meet.on)? {
        dynoid::refuse_model(&input)?;
        let source =
            terminal.files().read_source(&input, &file, &terminal.work().step(format!("reading {}", input.name), 0))?;
        let bench_file = with_mode(&file, &source.file, bench.mode);
        if bench_file.label_of(&source.file).is_none() {
            let what = format!(
                "{}: its name has no label such as BS_T_NT; state how the dynamometer was controlled, with --mode nt or --mode tn",
                source.file
            );
            return Err(CliError::Usage { what });
        }
        let (experiment, doubts) = experiment_of(&bench_file, &source).map_err(|reasons| not_replayed(&reasons))?;
        let errors = doubts.iter().filter(|doubt| doubt.severity == Severity::Error);
        errors.for_each(|doubt| terminal.warning(&wording::remark(doubt)));
        for model in models {
            let is_seen = model.document.provenance.recordings.iter().any(|used| used.sha256 == source.sha256);
            let replay = replayed(&model.document, &experiment, stretch(&experiment, meet, unasked), is_seen)?;
            all.push(Replayed { model: paths::with_slashes(&model.path), replay });
        }
    }
    Ok(all)
}

fn not_replayed(reasons: &[rig::Diagnostic]) -> CliError {
    let worst = reasons.iter().find(|reason| reason.severity == Severity::Error).or(reasons.first());
    CliError::NotReplayed { reason: worst.map_or_else(|| "nothing in it can be used".to_owned(), wording::remark) }
}

fn replayed(
    document: &BenchModelDocument,
    experiment: &Experiment,
    stretch_s: Option<(f64, f64)>,
    seen_in_estimation: bool,
) -> Result<Replay, CliError> {
    let replays_on = ReplayModel {
        model: &document.model,
        skews: document.skews.unwrap_or_default(),
        recorded_torque: document.recorded_torque.as_ref(),
    };
    let replay = replays_on.replay(experiment, stretch_s, seen_in_estimation);
    replay.map_err(|error| CliError::NotReplayed { reason: error.to_string() })
}

/// Stretch that is replayed where none is asked for.
#[derive(Clone, Copy)]
enum Unasked {
    /// All of a recording.
    Whole,
    /// The stretch that a study replays of it, so that both give the same numbers.
    AsStudy,
}

/// The stretch that is replayed, s of the recording's clock; all of it where `None`.
fn stretch(experiment: &Experiment, meet: &MeetArguments, unasked: Unasked) -> Option<(f64, f64)> {
    let window = meet.window;
    if window.from_s.is_some() || window.to_s.is_some() {
        return Some((window.from_s.unwrap_or(f64::NEG_INFINITY), window.to_s.unwrap_or(f64::INFINITY)));
    }
    match unasked {
        Unasked::Whole => None,
        Unasked::AsStudy => replayed_stretch(experiment),
    }
}

/// The bench file, which names the channels: the one given, or that of the first model, which lies beside it or one
/// folder up.
fn bench_file(models: &[Named], given: &BenchArguments) -> Result<PathBuf, CliError> {
    if let Some(path) = &given.bench {
        return Ok(path.clone());
    }
    let Some(model) = models.first() else { return Err(CliError::internal("no model")) };
    let folder = paths::folder_of(&model.path);
    // The name alone: what a model file says must not lead elsewhere.
    let name = Path::new(&model.document.provenance.bench_file.name).file_name().unwrap_or_default();
    let beside = folder.ancestors().take(2).map(|folder| folder.join(name)).find(|path| path.is_file());
    beside.ok_or_else(|| CliError::Usage {
        what: format!(
            "{}: the bench file states which channel is which, and it is not beside the model; give it with --bench bench.toml",
            model.path.display()
        ),
    })
}

/// The bench file with a label of this control mode for the recording.
fn with_mode(file: &BenchFile, recording: &str, mode: Option<Mode>) -> BenchFile {
    let mut file = file.clone();
    let Some(mode) = mode else { return file };
    let mode = match mode {
        Mode::Nt => ControlMode::Nt,
        Mode::Tn => ControlMode::Tn,
    };
    let known = file.label_of(recording);
    let (test, excitation) =
        known.map_or((Test::from("Recording"), Excitation::Torque), |label| (label.test, label.excitation));
    let label = ExperimentLabel::new(test, excitation, mode);
    file.recordings.labels.insert(0, LabelOverride { file: recording.to_owned(), label });
    file
}

/// A replay without its traces.
#[derive(Serialize)]
struct ReplayFacts<'a> {
    model: &'a str,
    recording: &'a str,
    label: &'a ExperimentLabel,
    mode: ControlMode,
    seen_in_estimation: bool,
    signals: Vec<SignalFacts<'a>>,
}

#[derive(Serialize)]
struct SignalFacts<'a> {
    quantity: &'a str,
    unit: &'a str,
    fit_percent: f64,
    rms_error: f64,
}

fn facts(all: &[Replayed]) -> Sorted<Vec<ReplayFacts<'_>>> {
    Sorted(all.iter().map(ReplayFacts::of).collect())
}

impl<'a> ReplayFacts<'a> {
    fn of(one: &'a Replayed) -> Self {
        let replay = &one.replay;
        ReplayFacts {
            model: &one.model,
            recording: &replay.stretch.file,
            label: &replay.label,
            mode: replay.mode,
            seen_in_estimation: replay.seen_in_estimation,
            signals: replay.signals.iter().map(SignalFacts::of).collect(),
        }
    }
}

impl<'a> SignalFacts<'a> {
    fn of(signal: &'a Validation) -> Self {
        SignalFacts {
            quantity: &signal.quantity,
            unit: &signal.unit,
            fit_percent: signal.fit_percent,
            rms_error: signal.rms_error,
        }
    }
}

/// The modelled signals, each on its own clock.
fn recording(all: &[Replayed]) -> Recording {
    let (mut rasters, mut channels) = (Vec::new(), Vec::new());
    for one in all {
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

/// The raster of a trace, shared by those of one recording with the same clock.
fn raster(rasters: &mut Vec<Raster>, trace: &Trace, file: &str) -> usize {
    let time_s: Vec<f64> = (0..trace.values.len()).map(|k| trace.start_s + k as f64 * trace.sample_time_s).collect();
    let is_same = |raster: &Raster| raster.time_s == time_s && raster.name.as_deref() == Some(file);
    rasters.iter().position(is_same).unwrap_or_else(|| {
        rasters.push(Raster { time_s, name: Some(file.to_owned()) });
        rasters.len() - 1
    })
}
