//! Errors of the library, each with its remedy.

use std::io;
use std::path::{Path, PathBuf};

use bench_model::prediction::PredictionError;
use capability::CapabilityError;
use cycle::CycleError;
use design::excitation_design::DesignError;
use design::safety::SafetyError;
use ident::IdentError;
use report::wording;
use rig::bench_file::BenchFileError;
use rig::experiment::catalogue::CatalogueError;
use study::{NextError, StudyError};
use toolbox_report::convert::ConvertError;

/// Why the work cannot go on. A text that ends in a remedy can be followed by how a program offers it.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the texts of the variants name their fields")]
pub enum Error {
    /// A file or folder that cannot be read.
    #[error("{}: {}", .path.display(), read_words(.source))]
    Read { path: PathBuf, source: io::Error },
    /// A folder where a file is needed.
    #[error("{}: this is a folder, not a file; {remedy}", .path.display())]
    IsFolder { path: PathBuf, remedy: String },
    /// A pipe or a device where a file is needed.
    #[error("{}: this is a pipe or a device, not a file; save it to a file first", .path.display())]
    IsStream { path: PathBuf },
    /// A file that is not text.
    #[error("{}: this is not text in UTF-8; give {wanted}, saved as UTF-8", .path.display())]
    NotText { path: PathBuf, wanted: &'static str },
    /// A bench file that cannot be changed.
    #[error("{}: it cannot be changed: {reason}; edit its text", .path.display())]
    NotChanged { path: PathBuf, reason: String },
    /// A bench file with faults.
    #[error("{}: {}", .path.display(), bench_file_words(.source))]
    BenchFile { path: PathBuf, source: BenchFileError },
    /// The bench file names no channels.
    #[error(
        "{}: the bench file names no channels; add [channels], or let `dynoid init FOLDER` propose it",
        .path.display()
    )]
    NoChannelsNamed { path: PathBuf },
    /// The bench file lists no recordings.
    #[error("{}: the bench file lists no recordings; add [recordings] with files = [\"recordings/*.mf4\"]", .path.display())]
    NoRecordingsListed { path: PathBuf },
    /// An invalid pattern.
    #[error("{}: `{pattern}` in [recordings] is not a valid pattern: {reason}; write it like \"recordings/*.mf4\"", .bench.display())]
    BadPattern { bench: PathBuf, pattern: String, reason: &'static str },
    /// A pattern, or a file name, of the bench file that matches nothing.
    #[error(
        "{}: `{pattern}` in [recordings] matches no file in {}; correct it, or copy the recordings there",
        .bench.display(), .folder.display()
    )]
    NothingMatches { bench: PathBuf, pattern: String, folder: PathBuf },
    /// A folder without recordings.
    #[error("{}: this folder has no recordings (endings: {}); name files or another folder", .path.display(), .endings)]
    EmptyFolder { path: PathBuf, endings: String },
    /// None of the recordings given can be decoded.
    #[error("no recording can be read ({} tried):\n  {}", .reasons.len(), .reasons.join("\n  "))]
    NoneReadable { reasons: Vec<String> },
    /// A bench file to be updated that is not TOML.
    #[error("{}: this is not TOML: {reason}; correct it first", .path.display())]
    NotToml { path: PathBuf, reason: String },
    /// A bench file of a layout to which nothing can be added.
    #[error("{}: nothing can be added to this layout; add the recordings by hand", .path.display())]
    NothingAdded { path: PathBuf },
    /// No recording can be used for a study.
    #[error("no study: no recording of {} can be used ({count} tried):\n{}", .bench.display(), .reasons.join("\n"))]
    NothingUsable { bench: PathBuf, count: usize, reasons: Vec<String> },
    /// A file or folder that cannot be written.
    #[error("{}: {}", .path.display(), write_words(.path, .source))]
    Write { path: PathBuf, source: io::Error },
    /// A file or folder of another kind has the name of the output.
    #[error("{}: {what} of this name exists already; remove it, or choose another place", .path.display())]
    InTheWay { path: PathBuf, what: &'static str },
    /// A file that must not be overwritten, and what shows who made it.
    #[error("{}: there is a file of this name, and {}; choose another name", .path.display(), made_by(.maker.as_deref()))]
    Occupied { path: PathBuf, maker: Option<String> },
    /// An input that a result would replace.
    #[error("{}: this file is read; give the result another name", .path.display())]
    IsRead { path: PathBuf },
    /// A result of an earlier run that is protected against writing.
    #[error("{}: this file is read-only; choose another name", .path.display())]
    IsReadOnly { path: PathBuf },
    /// A device where a folder is needed.
    #[error("{}: this is a device, and the results are files; choose a folder", .path.display())]
    IsDevice { path: PathBuf },
    /// A result among the recordings of a bench.
    #[error(
        "{}: {} lists this place among its recordings, and a study would take the result for a measurement; write it to \
         another folder",
        .path.display(), .bench.display()
    )]
    AmongRecordings { path: PathBuf, bench: PathBuf },
    /// A recording that cannot be decoded.
    #[error("{source}")]
    Recording {
        source: recording::RecordingError,
        /// True where only the time from row to row is missing.
        untimed: bool,
    },
    /// A recording that a format cannot hold.
    #[error("{source}; choose another format, or leave the channel out")]
    Encode { source: recording::RecordingError },
    /// A result whose ending names no format.
    #[error("{}: the ending of the output says what it is: {endings}", .path.display())]
    OutputEnding { path: PathBuf, endings: &'static str },
    /// A file of a format that this build leaves out.
    #[error("{}: this build of dynoid writes no {format}; build it with the feature `{feature}`, or choose another format", .path.display())]
    LeftOut { path: PathBuf, format: &'static str, feature: &'static str },
    /// A page whose ending names no kind.
    #[error("{}: a page ends in .html, .pdf, .svg or .png", .path.display())]
    PageEnding { path: PathBuf },
    /// A model file where recordings are wanted.
    #[error("{}: this is a model file, not a recording; `dynoid model poles`, `bode`, `step` and `convert` use it", .path.display())]
    IsModel { path: PathBuf },
    /// A logo that cannot be shown.
    #[error("{}: this logo cannot be shown: {reason}. Or remove `logo` from [report] in {}", .logo.display(), .bench.display())]
    Logo { logo: PathBuf, bench: PathBuf, reason: String },
    /// A bench whose recordings gave no bench model.
    #[error("{}: its recordings gave no bench model; `dynoid study` says what is missing", .path.display())]
    NoModelOfBench { path: PathBuf },
    /// A model file with a fault.
    #[error("{}: {reason}; copy the file again, correct it, or let `dynoid fit … --out` write it again", .path.display())]
    ModelFile { path: PathBuf, reason: String },
    /// A file that is none of dynoid's.
    #[error("{}: this is not a model file ({reason}); give {wanted}", .path.display())]
    NoModel { path: PathBuf, reason: String, wanted: &'static str },
    /// A model file of another version.
    #[error("{}: {source}", .path.display())]
    ModelVersion { path: PathBuf, source: IdentError },
    /// A place for a linear model whose ending is not that of model files.
    #[error("{}: a model file ends in .json", .path.display())]
    ModelEnding { path: PathBuf },
    /// A file without a bench model.
    #[error("{}: {source}", .path.display())]
    BenchModel { path: PathBuf, source: study::BenchModelError },
    /// A study where a bench model is wanted.
    #[error(
        "{}: this is a study; its bench model is the file model.json beside it. If there is none, `dynoid study bench.toml` writes it",
        .path.display()
    )]
    IsStudy { path: PathBuf },
    /// A study and a bench model side by side that are of different studies.
    #[error(
        "{}: this study is another one than that of {}; run `dynoid study bench.toml` again, or name the model file itself",
        .study.display(), .model.display()
    )]
    OfTwoStudies { study: PathBuf, model: PathBuf },
    /// An FMU that holds no model file of dynoid.
    #[error(
        "{}: this is no FMU with a model of dynoid; take one that `dynoid export` of this version made, or its model.json",
        .path.display()
    )]
    NoModelInside { path: PathBuf },
    /// A linear model where a bench model is wanted.
    #[error(
        "{}: this is a linear model of `dynoid fit`, and a bench model is needed; give the model.json of `dynoid study`, or an FMU of it",
        .path.display()
    )]
    IsLinearModel { path: PathBuf },
    /// A bench model where a linear model is wanted.
    #[error(
        "{}: this is a bench model, and a linear model is needed; `dynoid export --to linear` makes linear models of it. \
         `dynoid model bode`, `step`, `poles`, `compare` and `simulate` take it as it is",
        .path.display()
    )]
    IsBenchModel { path: PathBuf },
    /// A model that cannot be exported.
    #[error("{}: {source}", .path.display())]
    Export { path: PathBuf, source: export::ExportError },
    /// Several files for a pipe or a device.
    #[error("{}: this target writes {count} files; give a folder", .path.display())]
    ManyFiles { path: PathBuf, count: usize },
    /// A file whose ending is that of another target.
    #[error("{}: this target writes .{wanted}, not .{found}", .path.display())]
    OtherEnding { path: PathBuf, wanted: &'static str, found: String },
    /// One file for the linear models of a bench.
    #[error("{}: linear models are written to a file for each control mode; give a folder", .path.display())]
    FileOfLinear { path: PathBuf },
    /// A name that the content of a file cannot have.
    #[error("{asked}: the file names what is in it, which cannot have this name; {possible} can")]
    NameInside { asked: String, possible: String },
    /// An FMU of another version of FMI, which must not be overwritten.
    #[error(
        "{}: this is an FMU of FMI {found}, and one of FMI {wanted} would replace it; choose another name",
        .path.display()
    )]
    OtherFmi { path: PathBuf, found: &'static str, wanted: &'static str },
    /// A source in C that other models in the folder use.
    #[error(
        "{}: this source is another one than that of this dynoid, and other models in the folder may need it; choose another folder",
        .path.display()
    )]
    OtherSource { path: PathBuf },
    /// A model where a bench file is needed.
    #[error("{}: this is a model file, not a bench file", .path.display())]
    NotABench { path: PathBuf },
    /// A bench that cannot be simulated.
    #[error("{}: {source}", .path.display())]
    VirtualBench { path: PathBuf, source: virtual_bench::VirtualBenchError },
    /// An experiment that is not known, or a number that it does not take.
    #[error("{experiment}: {source}{}", experiment_remedy(.source))]
    Catalogue { experiment: String, source: CatalogueError },
    /// A file of demands that makes no experiment.
    #[error("{}: {source}", .path.display())]
    Demands { path: PathBuf, source: rig::experiment::free_form::FreeFormError },
    /// An experiment or a test that cannot be predicted on a bench.
    #[error("{}: the experiment cannot be checked: {reason}", .path.display())]
    NotPredicted { path: PathBuf, reason: NotPredicted },
    /// An excitation that cannot be designed.
    #[error("{reason}")]
    NotDesigned { reason: NotDesigned },
    /// Channels that make no data set.
    #[error(transparent)]
    Dataset {
        #[from]
        source: dataset::DatasetError,
    },
    /// A channel that is named twice.
    #[error("the channel \"{channel}\" is named twice among inputs and outputs; name it once")]
    ChannelTwice { channel: String },
    /// A recording that is named twice.
    #[error("{name}: this recording is given twice; name it once")]
    RecordingTwice { name: String },
    /// A time that ends before it begins.
    #[error("the time from {from_s} s to {to_s} s is empty; give the earlier time first")]
    EmptyWindow { from_s: f64, to_s: f64 },
    /// No output was named.
    #[error("{file}: name outputs and inputs; the channels are {channels}")]
    NoOutputNamed { file: String, channels: String },
    /// A channel from which nothing can be computed.
    #[error("{data}: \"{channel}\": {fault}")]
    UnusableChannel { data: String, channel: String, fault: String },
    /// A channel that does not move.
    #[error(
        "{data}: \"{channel}\": it does not vary, so nothing can be learnt from it; choose another channel, or another time"
    )]
    StillChannel { data: String, channel: String },
    /// Nothing is left between gaps.
    #[error(
        "{data}: {channels}: some are missing in any {shortest} consecutive samples; choose other channels, or a longer sample time"
    )]
    OnlyGaps { data: String, channels: String, shortest: usize },
    /// Something computed from data or models is impossible.
    #[error("{what} is not possible: {source}")]
    Identify { what: &'static str, source: IdentError },
    /// An estimate is impossible.
    #[error("{data}: the estimate is not possible: {source}")]
    NotEstimated { data: String, source: IdentError },
    /// A test that is not known.
    #[error(
        "no test has the name `{name}`{}. Cycles and shapes: {}; experiments: `dynoid experiment list`; or a file",
        .meant.as_ref().map_or_else(String::new, |meant| format!("; `{meant}` may be meant")),
        .known.join(", ")
    )]
    UnknownTest { name: String, meant: Option<String>, known: Vec<&'static str> },
    /// A cycle of a vehicle without one.
    #[error("{cycle}: this is the speed of a vehicle; describe it")]
    NeedsVehicle { cycle: String },
    /// A cycle of an engine without its map.
    #[error("{cycle}: this cycle is in % of an engine; give its full-load curve")]
    NeedsEngineMap { cycle: String },
    /// A cycle that engine or vehicle cannot run.
    #[error("{cycle}: {source}")]
    Cycle { cycle: String, source: CycleError },
    /// A table of an engine, a cycle or a vehicle.
    #[error("{}: {reason}", .path.display())]
    CycleTable { path: PathBuf, reason: String },
    /// A table of a cycle that needs the engine's map.
    #[error("{}: {what}; give the engine's map", .path.display())]
    NeedsMap { path: PathBuf, what: &'static str },
    /// A requirement that is not known.
    #[error("{source}")]
    Requirement { source: CycleError },
    /// A requirement set that judges no test.
    #[error("{set}: this set has no regressions; give one of 1065.514, 1036.545, whtc, nrtc, whsc")]
    NoRegressions { set: String },
    /// A recorded run without a requirement.
    #[error(
        "{test}: nothing to judge the recording by. This test has no requirement set of its own: name one, or give a requirement"
    )]
    NothingToJudgeBy { test: String },
    /// A recording that is no run of the test.
    #[error("{}: the run cannot be judged: {reason}", .path.display())]
    NotAsTest { path: PathBuf, reason: String },
    /// A speed at which a bench has no map.
    #[error("{rpm} rpm: a map needs a speed above 0 rpm, since an engine turns forwards")]
    SpeedOfMap { rpm: f64 },
    /// Several recordings for one file.
    #[error("{}: for a folder of recordings say their format", .path.display())]
    SeveralIntoOne { path: PathBuf },
    /// A file where recordings of a stated format are to be written.
    #[error("{}: recordings of a stated format go to a folder; name a folder", .path.display())]
    FileForSeveral { path: PathBuf },
    /// Two recordings of one name.
    #[error("{one} and {other} would both become {}; convert them into different folders", .path.display())]
    OneTarget { one: String, other: String, path: PathBuf },
    /// A channel that no recording has.
    #[error("{pattern}: no recording has such a channel{}", closest_words(.closest))]
    NoSuchChannel { pattern: String, closest: Vec<String> },
    /// Nothing is left of a recording.
    #[error("{file}: nothing to convert: no numeric channel has a sample in this time{}", because(.reasons))]
    NothingToConvert { file: String, reasons: Vec<String> },
    /// A recording that is to have two clocks.
    #[error("{file}: it has time stamps, so give a sample time or a rate, not both")]
    TwoClocks { file: String },
    /// A file that is not a structure of a grey-box model.
    #[error("{}: this is not a structure of a grey-box model: {reason}", .path.display())]
    StructureFile { path: PathBuf, reason: String },
    /// A model that cannot be converted.
    #[error("the conversion is not possible: {source}")]
    NotConverted { source: ConvertError },
    /// A model that meets a channel in another unit.
    #[error(
        "{data}: \"{channel}\" has the unit {found}, but {expected} in the model; convert the recording, or fit the model again"
    )]
    UnitOfModel { data: String, channel: String, found: String, expected: String },
    /// A discrete model that is to meet data on another clock.
    #[error(
        "the model is discrete, with a sample every {own_s} s, and keeps to that; leave out the sample time of {given_s} s, or \
         convert the model"
    )]
    ClockOfModel { given_s: f64, own_s: f64 },
    /// A simulation of a model without inputs.
    #[error("a model without inputs has nothing to be simulated on")]
    NothingToSimulateOn,
    /// A trend of the outputs that cannot be taken off, because one was not recorded.
    #[error(
        "a trend that the outputs show is to be taken off, and \"{channel}\" is not in the recording; take off the operating \
         point of the model"
    )]
    TrendOfMissing { channel: String },
    /// A test of residuals with lags for which data are too short.
    #[error("{lags} lags: give at least 1, and at most a quarter of the {samples} samples")]
    LagsOfTest { lags: usize, samples: usize },
    /// Several recordings in a file that has room for one.
    #[error("{}: .{ending} holds one recording, and {count} are given; write .mf4, or one after the other", .path.display())]
    OneRecordingFile { path: PathBuf, ending: &'static str, count: usize },
    /// Models of both kinds, which cannot be compared.
    #[error(
        "{} is a bench model and {} a linear model; compare models of one kind",
        .bench.display(), .linear.display()
    )]
    TwoKinds { bench: PathBuf, linear: PathBuf },
    /// A bench file that is not beside a bench model.
    #[error(
        "{}: the bench file states which channel is which, and it is not beside the model; give it",
        .path.display()
    )]
    NoBenchBeside { path: PathBuf },
    /// A recording whose name does not say how the dynamometer was controlled.
    #[error("{file}: its name has no label such as BS_T_NT; state how the dynamometer was controlled")]
    NoLabel { file: String },
    /// A recording that a bench model cannot be run on.
    #[error("the recording cannot be replayed on a bench model: {reason}")]
    NotReplayed { reason: String },
    /// The folder of a demonstration holds other things.
    #[error("{}: the folder contains other files ({}); choose another folder", .path.display(), .found.display())]
    NotADemoFolder { path: PathBuf, found: PathBuf },
    /// Recordings none of which can be used.
    #[error("{}: none of the recordings can be used", .path.display())]
    NothingToLookAt { path: PathBuf },
    /// A torque of several recordings, of which one can be written.
    #[error(
        "{}: {what} of one recording is written, and {count} are given; name the one that is meant",
        .path.display()
    )]
    TorqueOfSeveral { path: PathBuf, what: &'static str, count: usize },
    /// A torque that was not rebuilt.
    #[error("{file}: {reason}")]
    NotRebuilt { file: String, reason: String },
    /// A study's file that cannot be used.
    #[error("{}: {source}", .path.display())]
    Study { path: PathBuf, source: study::document::DocumentError },
    /// Friction that cannot be estimated.
    #[error(transparent)]
    Friction {
        #[from]
        source: part_friction::FrictionError,
    },
    /// Models of the torque control cannot be compared.
    #[error(transparent)]
    TorqueControl {
        #[from]
        source: part_torque::model_comparison::ModelComparisonError,
    },
    /// Further experiments that cannot be tried.
    #[error("{}: {source}", .path.display())]
    Next { path: PathBuf, source: NextError },
    /// A fault of dynoid.
    #[error("a fault in dynoid itself: {what}; please report it with this message")]
    Internal { what: String },
}

impl Error {
    /// A file or folder that cannot be read.
    pub fn read(path: &Path, source: io::Error) -> Self {
        Error::Read { path: path.to_owned(), source }
    }

    /// A file or folder that cannot be written.
    pub fn write(path: &Path, source: io::Error) -> Self {
        Error::Write { path: path.to_owned(), source }
    }

    /// No study of a bench with this file.
    pub fn of_study(bench: &Path, error: StudyError) -> Self {
        let path = bench.to_owned();
        match error {
            StudyError::NoChannels => Error::NoChannelsNamed { path },
            StudyError::NoRecordings => Error::NoRecordingsListed { path },
            StudyError::NothingUsable { count, diagnostics } => Error::NothingUsable {
                bench: path,
                count,
                reasons: diagnostics.iter().map(|found| format!("  {}", wording::diagnostic(found))).collect(),
            },
        }
    }

    /// No further experiments for a bench with this file.
    pub(crate) fn of_next(bench: &Path, error: NextError) -> Self {
        match error {
            NextError::Study(error) => Self::of_study(bench, error),
            source => Error::Next { path: bench.to_owned(), source },
        }
    }

    /// Something computed from data or models that is impossible.
    pub fn identify(what: &'static str, source: IdentError) -> Self {
        Error::Identify { what, source }
    }

    /// A fault of dynoid.
    pub fn internal(what: impl ToString) -> Self {
        Error::Internal { what: what.to_string() }
    }
}

/// Why an experiment or a test cannot be predicted on a bench.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NotPredicted {
    /// The shaft is not known.
    #[error(
        "the shaft is not known; add [shaft] with resonance = \"18 Hz\" (or stiffness) to the bench file, or give a study"
    )]
    UnknownShaft,
    /// A limit that is no positive number.
    #[error("{name}: the limit must be a number above zero; clear it to judge without it")]
    NoLimit {
        /// Name of what it limits.
        name: &'static str,
    },
    /// Many benches cannot be drawn, or run the test.
    #[error(transparent)]
    Capability(#[from] CapabilityError),
    /// Many benches cannot be drawn, or run the experiment.
    #[error(transparent)]
    Safety(#[from] SafetyError),
    /// The bench cannot be predicted.
    #[error(transparent)]
    Prediction(#[from] PredictionError),
}

/// Why no excitation can be designed for a bench.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NotDesigned {
    /// The shaft is not known.
    #[error("{}", NotPredicted::UnknownShaft)]
    UnknownShaft,
    /// Nobody says how far the torque of the shaft may swing.
    #[error("say how far the shaft's torque may swing, or state shaft_torque in [limits]")]
    NoShaftLimit,
    /// The mean torque takes all that the limits allow.
    #[error("[limits] leaves nothing to excite with at {torque_nm} Nm; lower it")]
    NothingLeft {
        /// The mean torque.
        torque_nm: f64,
    },
    /// The task has no solution.
    #[error(transparent)]
    Design(#[from] DesignError),
}

/// The names that are closest to one that is missing.
fn closest_words(names: &[String]) -> String {
    let names: Vec<String> = names.iter().map(|name| format!("\"{name}\"")).collect();
    if names.is_empty() { String::new() } else { format!("; the closest are {}", names.join(", ")) }
}

/// The first reasons, one a line.
fn because(reasons: &[String]) -> String {
    const MOST: usize = 5;
    let mut lines: Vec<String> = reasons.iter().take(MOST).map(|reason| format!("\n  {reason}")).collect();
    if reasons.len() > MOST {
        lines.push(format!("\n  and {} more", reasons.len() - MOST));
    }
    lines.concat()
}

fn experiment_remedy(error: &CatalogueError) -> &'static str {
    match error {
        CatalogueError::UnknownExperiment { .. } => {
            "; `dynoid experiment list` shows all, and a file of demands will do too"
        }
        _ => "",
    }
}

/// Maker of a file, as far as the file shows it, in words.
fn made_by(maker: Option<&str>) -> String {
    maker.map_or("nothing shows that dynoid wrote it".to_owned(), |maker| format!("{maker} wrote it"))
}

fn read_words(error: &io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "no such file or folder; check the name and the current folder".into(),
        io::ErrorKind::PermissionDenied => {
            "no permission to read this; ask for read access, or copy it to your own folder".into()
        }
        _ => format!("reading failed: {error}; check the disk or the network drive, or copy the file to a local disk"),
    }
}

fn write_words(path: &Path, error: &io::Error) -> String {
    let fault = match error.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "no permission to write here",
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "the disk is full; free some space, or",
        io::ErrorKind::FileTooLarge => {
            "the file would be larger than the system or the shell (`ulimit -f`) allows; raise the limit, or"
        }
        io::ErrorKind::TimedOut => "no program reads from this pipe; start the one that reads it first, or",
        io::ErrorKind::BrokenPipe => "the program that reads from this pipe has ended; start it again, or",
        io::ErrorKind::NotADirectory => "part of this path is a file, not a folder",
        io::ErrorKind::NotFound if crate::paths::folder_of(path).is_dir() => "this folder takes no new file",
        io::ErrorKind::NotFound => "the folder does not exist; create it, or",
        _ => &format!("writing failed: {error}"),
    };
    let joint = if fault.ends_with("or") { "" } else { ";" };
    format!("{fault}{joint} choose another place")
}

/// Faults of a bench file that a person reads at once.
const MOST_FAULTS: usize = 30;

fn bench_file_words(error: &BenchFileError) -> String {
    let count = error.faults.len();
    let head = if count == 1 { "one error".into() } else { format!("{count} errors") };
    let mut lines: Vec<String> = error.faults.iter().take(MOST_FAULTS).map(|fault| format!("  {fault}")).collect();
    if count > MOST_FAULTS {
        lines.push(format!("  and {} more", count - MOST_FAULTS));
    }
    format!("{head}:\n{}", lines.join("\n"))
}
