//! Errors between the files and the terminal, each with its remedy, and the program's exit codes.

use std::io;
use std::path::{Path, PathBuf};

use rig::bench_file::BenchFileError;

/// The command line is wrong.
const USAGE: u8 = 2;
/// An input cannot be read or understood.
const INPUT: u8 = 3;
/// An output cannot be written.
const OUTPUT: u8 = 4;
/// A fault in dynoid itself.
pub(crate) const INTERNAL: u8 = 5;

/// How a command ended that did its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All is well.
    Done,
    /// The study finds the data insufficient for a model.
    Insufficient,
    /// The check does not find the experiment safe, or the bench cannot run the test, or a run of it is not valid.
    NotSafe,
    /// The bench is not the same any more.
    Changed,
    /// The model explains next to nothing of an output.
    ExplainsLittle,
    /// Some inputs could not be read; each was named.
    SomeUnreadable,
    /// No recording gave a result; the reasons were named.
    NothingFound,
}

impl Outcome {
    /// The outcome of a command that handles recordings one by one: whether it found anything, and what it refused.
    pub(crate) fn of(found: bool, refused: &[String]) -> Self {
        match (found, refused) {
            (true, []) => Outcome::Done,
            (true, _) => Outcome::SomeUnreadable,
            (false, _) => Outcome::NothingFound,
        }
    }

    pub(crate) fn code(self) -> u8 {
        match self {
            Outcome::Done => 0,
            Outcome::Insufficient | Outcome::NotSafe | Outcome::Changed | Outcome::ExplainsLittle => 1,
            Outcome::SomeUnreadable | Outcome::NothingFound => INPUT,
        }
    }
}

/// Why a command cannot go on.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
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
    #[error("no recording can be read ({count} tried); the reasons are above")]
    NoneReadable { count: usize },
    /// No recording can be used for a study.
    #[error("no study: no recording of {} can be used ({count} tried):\n{}", .bench.display(), .reasons.join("\n"))]
    NothingUsable { bench: PathBuf, count: usize, reasons: Vec<String> },
    /// A file or folder that cannot be written.
    #[error("{}: {}", .path.display(), write_words(.path, .source))]
    Write { path: PathBuf, source: io::Error },
    /// A file or folder of another kind has the name of the output.
    #[error("{}: {what} of this name exists already; remove it, or choose another place with --out", .path.display())]
    InTheWay { path: PathBuf, what: &'static str },
    /// Something that is no bench file where one is to be written.
    #[error("{}: there is a file of this name, and it is no bench file; choose another name with --out, or replace it with --overwrite", .path.display())]
    NotABenchFile { path: PathBuf },
    /// A bench file that must not be overwritten.
    #[error("{}: the bench file exists already; write another with --out, add to it with --update, or replace it with --force", .path.display())]
    BenchFileExists { path: PathBuf },
    /// A file that must not be overwritten, and what shows who made it.
    #[error(
        "{}: there is a file of this name, and {}; choose another name, or replace it with --overwrite",
        .path.display(), made_by(.maker.as_deref())
    )]
    Occupied { path: PathBuf, maker: Option<String> },
    /// An input that a result would replace.
    #[error("{}: this file is read; give the result another name", .path.display())]
    IsRead { path: PathBuf },
    /// A result of an earlier run that is protected against writing.
    #[error("{}: this file is read-only; choose another name, or replace it with --overwrite", .path.display())]
    IsReadOnly { path: PathBuf },
    /// An FMU of another version of FMI, which must not be overwritten.
    #[error(
        "{}: this is an FMU of FMI {found}, and one of FMI {wanted} would replace it; choose another name with --out, or replace it with \
         --overwrite",
        .path.display()
    )]
    OtherFmi { path: PathBuf, found: &'static str, wanted: &'static str },
    /// A source in C that other models in the folder use.
    #[error(
        "{}: this source is another one than that of this dynoid, and other models in the folder may need it; choose another folder with \
         --out, or replace it with --overwrite",
        .path.display()
    )]
    OtherSource { path: PathBuf },
    /// A device where a folder is needed.
    #[error("{}: this is a device, and the results are files; choose a folder with --out", .path.display())]
    IsDevice { path: PathBuf },
    /// A result among the recordings of a bench.
    #[error(
        "{}: {} lists this place among its recordings, and a study would take the result for a measurement; write it to \
         another folder",
        .path.display(), .bench.display()
    )]
    AmongRecordings { path: PathBuf, bench: PathBuf },
    /// The demo's folder holds other things.
    #[error(
        "{}: the folder contains other files ({found}); choose another folder with --out",
        .path.display()
    )]
    NotADemoFolder { path: PathBuf, found: String },
    /// Standard output cannot be written.
    #[error("the standard output cannot be written: {source}; is the disk full?")]
    StandardOutput { source: io::Error },
    /// A recording that cannot be decoded.
    #[error("{source}{}", if *.untimed { "; if no column is time, give the time from row to row with --sample-time" } else { "" })]
    Recording { source: recording::RecordingError, untimed: bool },
    /// Nothing is left of a recording.
    #[error("{file}: nothing to convert: no numeric channel has a sample in this time{}", because(.reasons))]
    NothingToConvert { file: String, reasons: Vec<String> },
    /// A recording that a format cannot hold.
    #[error("{source}; choose another format, or leave the channel out with --channels")]
    Encode { source: recording::RecordingError },
    /// Channels that make no data set.
    #[error(transparent)]
    Dataset(#[from] dataset::DatasetError),
    /// A channel from which nothing can be computed.
    #[error("{data}: \"{channel}\": {fault}")]
    UnusableChannel { data: String, channel: String, fault: String },
    /// No output was named.
    #[error("{file}: name outputs with --output and inputs with --input; the channels are {channels}")]
    NoOutputNamed { file: String, channels: String },
    /// Friction that cannot be estimated.
    #[error(transparent)]
    Friction { source: part_friction::FrictionError },
    /// No recording from which PI and delay can be estimated.
    #[error(
        "{}: no recording has speed control with constant N_d*, which the PI controller and its delay need; run BS_T_NT, or name one",
        .path.display()
    )]
    NoHeldSpeed { path: PathBuf },
    /// No recording in speed control.
    #[error("{}: no recording has speed control (NT) with N_d and N_d*; name one, or omit the bench file to use a virtual bench", .path.display())]
    NoSpeedControl { path: PathBuf },
    /// The noise test of the controller is impossible.
    #[error("{source}")]
    NoiseTest { source: rig::estimation::EstimateError },
    /// Models of the torque control cannot be compared.
    #[error(transparent)]
    TorqueControl { source: part_torque::model_comparison::ModelComparisonError },
    /// No recording can be used.
    #[error("{}: none of the recordings can be used", .path.display())]
    NothingToLookAt { path: PathBuf },
    /// A wrong command line.
    #[error("{what}")]
    Usage { what: String },
    /// An estimate, or something computed from one, is impossible.
    #[error("{what} is not possible: {source}")]
    Identify { what: &'static str, source: ident::IdentError },
    /// An estimate is impossible.
    #[error("{data}: the estimate is not possible: {source}{remedy}")]
    Estimate { data: String, source: ident::IdentError, remedy: String },
    /// A model meets a channel in another unit.
    #[error(
        "{data}: \"{channel}\" has the unit {found}, but {expected} in the model; convert the recording, or fit the model again"
    )]
    UnitOfModel { data: String, channel: String, found: String, expected: String },
    /// Nothing is left between gaps.
    #[error(
        "{data}: {channels}: no {shortest} consecutive samples are without gaps; choose other channels, or a longer --sample-time"
    )]
    OnlyGaps { data: String, channels: String, shortest: usize },
    /// A logo that cannot be shown.
    #[error("{}: this logo cannot be shown: {reason}. Or remove `logo` from [report] in {}", .logo.display(), .bench.display())]
    Logo { logo: PathBuf, bench: PathBuf, reason: String },
    /// A plot file of an unknown kind.
    #[error("{}: a plot file ends in .html, .pdf, .svg or .png", .path.display())]
    PlotEnding { path: PathBuf },
    /// A model file with a fault.
    #[error("{}: {reason}; copy the file again, correct it, or let `dynoid fit … --out` write it again", .path.display())]
    ModelFile { path: PathBuf, reason: String },
    /// A file that is none of dynoid's.
    #[error("{}: this is not a model file ({reason}); give {wanted}", .path.display())]
    NoModel { path: PathBuf, reason: String, wanted: &'static str },
    /// A model file of another version.
    #[error("{}: {source}", .path.display())]
    ModelVersion { path: PathBuf, source: ident::IdentError },
    /// A model file where recordings are wanted.
    #[error("{}: this is a model file, not a recording; `dynoid model poles`, `bode`, `step` and `convert` use it", .path.display())]
    IsModel { path: PathBuf },
    /// A file that is not a structure of a grey-box model.
    #[error("{}: this is not a structure of a grey-box model: {reason}\n`dynoid fit greybox --help` shows the layout", .path.display())]
    StructureFile { path: PathBuf, reason: String },
    /// A file of demands that makes no experiment.
    #[error("{}: {source}", .path.display())]
    Demands { path: PathBuf, source: rig::experiment::free_form::FreeFormError },
    /// A file without a bench model.
    #[error("{}: {source}", .path.display())]
    BenchModel { path: PathBuf, source: report::BenchModelError },
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
    /// A bench whose recordings gave no bench model.
    #[error("{}: its recordings gave no bench model; `dynoid study` says what is missing", .path.display())]
    NoModelOfBench { path: PathBuf },
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
    /// An experiment that cannot be checked.
    #[error("{}: the experiment cannot be checked: {reason}", .path.display())]
    NotCheckable { path: PathBuf, reason: String },
    /// A table of an engine, a cycle or a vehicle.
    #[error("{}: {reason}", .path.display())]
    CycleTable { path: PathBuf, reason: String },
    /// A recording that is no run of the test.
    #[error("{}: the run cannot be judged: {reason}", .path.display())]
    NotAsTest { path: PathBuf, reason: String },
    /// A recording that a bench model cannot be run on.
    #[error("the recording cannot be replayed on a bench model: {reason}")]
    NotReplayed { reason: String },
    /// A bench that cannot be simulated.
    #[error("{}: {source}", .path.display())]
    VirtualBench { path: PathBuf, source: virtual_bench::VirtualBenchError },
    /// A fault of the program.
    #[error("a fault in dynoid itself: {what}; please report it with this message")]
    Internal { what: String },
}

impl CliError {
    pub(crate) fn read(path: &Path, source: io::Error) -> Self {
        CliError::Read { path: path.to_owned(), source }
    }

    pub(crate) fn write(path: &Path, source: io::Error) -> Self {
        CliError::Write { path: path.to_owned(), source }
    }

    pub(crate) fn identify(what: &'static str, source: ident::IdentError) -> Self {
        CliError::Identify { what, source }
    }

    pub(crate) fn internal(what: impl ToString) -> Self {
        CliError::Internal { what: what.to_string() }
    }

    /// Tells whether an input is the cause.
    pub(crate) fn is_of_input(&self) -> bool {
        self.code() == INPUT || matches!(self, CliError::Encode { .. })
    }

    pub(crate) fn code(&self) -> u8 {
        match self {
            CliError::Write { .. }
            | CliError::InTheWay { .. }
            | CliError::BenchFileExists { .. }
            | CliError::NotABenchFile { .. }
            | CliError::Occupied { .. }
            | CliError::IsReadOnly { .. }
            | CliError::OtherFmi { .. }
            | CliError::OtherSource { .. }
            | CliError::IsDevice { .. }
            | CliError::AmongRecordings { .. }
            | CliError::NotADemoFolder { .. }
            | CliError::Encode { .. }
            | CliError::StandardOutput { .. } => OUTPUT,
            CliError::Usage { .. }
            | CliError::IsRead { .. }
            | CliError::PlotEnding { .. }
            | CliError::NoOutputNamed { .. } => USAGE,
            CliError::Internal { .. } => INTERNAL,
            _ => INPUT,
        }
    }
}

/// Maker of a file, as far as the file shows it, in words.
fn made_by(maker: Option<&str>) -> String {
    maker.map_or("nothing shows that dynoid wrote it".to_owned(), |maker| format!("{maker} wrote it"))
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
    format!("{fault}{joint} choose another place with --out or --plot")
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
