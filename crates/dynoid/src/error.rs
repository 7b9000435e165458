//! What can go wrong between the files and the terminal, each with its remedy, and the program's exit codes.

use std::io;
use std::path::{Path, PathBuf};

use bench::bench_file::BenchFileError;

/// The command line is wrong.
const USAGE: u8 = 2;
/// An input cannot be read or understood.
const INPUT: u8 = 3;
/// An output cannot be written.
const OUTPUT: u8 = 4;
/// A fault in dynoid itself.
pub(crate) const INTERNAL: u8 = 5;

/// How a command ended that did what it was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Outcome {
    /// All is well.
    Done,
    /// The study is there, and says that the data are insufficient for a model.
    Insufficient,
    /// An experiment was checked, and is not known to be safe.
    NotSafe,
    /// The command went on past inputs that cannot be read; each was named.
    SomeUnreadable,
    /// No recording tells anything; why was said of each.
    NothingTold,
}

impl Outcome {
    /// That of a command that looks at recordings one by one.
    pub(crate) fn of(tells: bool, refused: &[String]) -> Self {
        match (tells, refused) {
            (true, []) => Outcome::Done,
            (true, _) => Outcome::SomeUnreadable,
            (false, _) => Outcome::NothingTold,
        }
    }

    pub(crate) fn code(self) -> u8 {
        match self {
            Outcome::Done => 0,
            Outcome::Insufficient | Outcome::NotSafe => 1,
            Outcome::SomeUnreadable | Outcome::NothingTold => INPUT,
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
    #[error("{}: this is a pipe or a device, not a file, and recordings are read from any place of theirs; save it to a file first", .path.display())]
    IsStream { path: PathBuf },
    /// A file that is not text.
    #[error("{}: this is not text in UTF-8; give {wanted}, saved as UTF-8", .path.display())]
    NotText { path: PathBuf, wanted: &'static str },
    /// A bench file with faults.
    #[error("{}: {}", .path.display(), bench_file_words(.source))]
    BenchFile { path: PathBuf, source: BenchFileError },
    /// The bench file names no channels.
    #[error(
        "{}: no channels are named, and without them nothing can be identified; add [channels], or have it proposed with \
         `dynoid init FOLDER`",
        .path.display()
    )]
    NoChannelsNamed { path: PathBuf },
    /// The bench file lists no recordings.
    #[error("{}: no recordings are listed; add [recordings] with files = [\"recordings/*.mf4\"]", .path.display())]
    NoRecordingsListed { path: PathBuf },
    /// A pattern that is none.
    #[error("{}: `{pattern}` in [recordings] is no valid pattern: {reason}; write it like \"recordings/*.mf4\"", .bench.display())]
    BadPattern { bench: PathBuf, pattern: String, reason: &'static str },
    /// A pattern, or a file name, of the bench file that matches nothing.
    #[error(
        "{}: `{pattern}` in [recordings] matches no file in {}; correct it, or put the recordings there",
        .bench.display(), .folder.display()
    )]
    NothingMatches { bench: PathBuf, pattern: String, folder: PathBuf },
    /// A folder without recordings.
    #[error("{}: there are no recordings in this folder (looked for {}); name the files, or another folder", .path.display(), .endings)]
    EmptyFolder { path: PathBuf, endings: String },
    /// None of the recordings given can be decoded.
    #[error("none of the {count} recordings can be read; see above what is wrong with each")]
    NoneReadable { count: usize },
    /// No recording can be used for a study.
    #[error("none of the {count} recordings of {} can be used, so there is no study:\n{}", .bench.display(), .reasons.join("\n"))]
    NothingUsable { bench: PathBuf, count: usize, reasons: Vec<String> },
    /// A file or folder that cannot be written.
    #[error("{}: {}", .path.display(), write_words(.path, .source))]
    Write { path: PathBuf, source: io::Error },
    /// Something else stands where a file or folder is to be written.
    #[error("{}: {what} of this name is already there; remove it, or choose another place with --out", .path.display())]
    InTheWay { path: PathBuf, what: &'static str },
    /// A bench file that must not be overwritten.
    #[error("{}: the bench file is already there and was left as it is; write another with --out, or replace it with --force", .path.display())]
    BenchFileExists { path: PathBuf },
    /// The demo's folder holds other things.
    #[error(
        "{}: the folder holds something that is not the demo's ({found}), and the demo would mix with it; choose another folder with --out",
        .path.display()
    )]
    NotADemoFolder { path: PathBuf, found: String },
    /// Standard output cannot be written.
    #[error("the standard output cannot be written: {source}; is the disk full?")]
    StandardOutput { source: io::Error },
    /// A recording that cannot be decoded.
    #[error("{source}{}", if *.untimed { "; where no column is time, give the time from row to row with --sample-time" } else { "" })]
    Recording { source: recording::RecordingError, untimed: bool },
    /// A recording of which nothing is left.
    #[error("{file}: there is nothing to convert: no numeric channel over time has a sample here{}", because(.reasons))]
    NothingToConvert { file: String, reasons: Vec<String> },
    /// A recording that a format cannot hold.
    #[error("{source}; choose another format, or leave the channel out with --channels")]
    Encode { source: recording::RecordingError },
    /// Channels that are no data.
    #[error(transparent)]
    Dataset(#[from] bench::dataset::DatasetError),
    /// A channel from which nothing can be computed.
    #[error("{data}: \"{channel}\": {fault}")]
    UnusableChannel { data: String, channel: String, fault: String },
    /// No output was named.
    #[error("{file}: name the outputs with --output, and the inputs with --input; the channels are {channels}")]
    NoOutputNamed { file: String, channels: String },
    /// Friction that cannot be estimated.
    #[error(transparent)]
    Friction { source: bench::friction::FrictionError },
    /// No recording from which PI and delay can be estimated.
    #[error(
        "{}: no recording is in speed control with constant N_d*, and PI and delay come from such ones; run BS_T_NT, or name one",
        .path.display()
    )]
    NoHeldSpeed { path: PathBuf },
    /// No recording in speed control.
    #[error("{}: no recording is in speed control (NT) with N_d and N_d*; name one, or leave the bench file out for a virtual bench", .path.display())]
    NoSpeedControl { path: PathBuf },
    /// The study of the controller cannot be made.
    #[error("{source}")]
    ControllerStudy { source: bench::estimate::EstimateError },
    /// A torque control that cannot be studied.
    #[error(transparent)]
    TorqueControl { source: bench::torque_control_study::TorqueControlStudyError },
    /// No recording can be looked at.
    #[error("{}: none of the recordings can be used", .path.display())]
    NothingToLookAt { path: PathBuf },
    /// An argument that makes no sense.
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
        "{data}: \"{channel}\" is recorded in {found}, the model has it in {expected}; bring the recording to the model's unit, or fit the model again"
    )]
    UnitOfModel { data: String, channel: String, found: String, expected: String },
    /// Nothing is left between gaps.
    #[error(
        "{data}: {channels}: samples are missing so often that no {shortest} follow each other; choose other channels, or a longer --sample-time"
    )]
    OnlyGaps { data: String, channels: String, shortest: usize },
    /// A plot file of an unknown kind.
    #[error("{}: the ending of a plot file says what it is: .html, .svg or .png", .path.display())]
    PlotEnding { path: PathBuf },
    /// A file that is no model.
    #[error("{}: this is no model file ({reason}); model files are written by `dynoid fit … --out model.json`", .path.display())]
    ModelFile { path: PathBuf, reason: String },
    /// A model file of another version.
    #[error("{}: {source}", .path.display())]
    ModelVersion { path: PathBuf, source: ident::IdentError },
    /// A model file where recordings are wanted.
    #[error("{}: this is a model file, not a recording; `dynoid model poles`, `bode`, `step` and `convert` show what it holds", .path.display())]
    IsModel { path: PathBuf },
    /// A file that is no structure of a grey-box model.
    #[error("{}: this is no structure of a grey-box model: {reason}\nthe layout is shown by `dynoid fit greybox --help`", .path.display())]
    StructureFile { path: PathBuf, reason: String },
    /// A file of demands that gives no experiment.
    #[error("{}: {source}", .path.display())]
    Demands { path: PathBuf, source: bench::experiment::free_form::FreeFormError },
    /// A file that holds no bench model.
    #[error("{}: {source}", .path.display())]
    StudyModel { path: PathBuf, source: report::StudyModelError },
    /// An experiment that cannot be checked.
    #[error("{}: the experiment cannot be checked: {reason}", .path.display())]
    NotCheckable { path: PathBuf, reason: String },
    /// A bench that cannot be simulated.
    #[error("{}: {source}", .path.display())]
    VirtualBench { path: PathBuf, source: bench::virtual_bench::VirtualBenchError },
    /// Something that cannot happen did.
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

    /// Whether an input is to blame.
    pub(crate) fn is_of_input(&self) -> bool {
        self.code() == INPUT || matches!(self, CliError::Encode { .. })
    }

    pub(crate) fn code(&self) -> u8 {
        match self {
            CliError::Write { .. }
            | CliError::InTheWay { .. }
            | CliError::BenchFileExists { .. }
            | CliError::NotADemoFolder { .. }
            | CliError::Encode { .. }
            | CliError::StandardOutput { .. } => OUTPUT,
            CliError::Usage { .. } | CliError::PlotEnding { .. } | CliError::NoOutputNamed { .. } => USAGE,
            CliError::Internal { .. } => INTERNAL,
            _ => INPUT,
        }
    }
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
        io::ErrorKind::NotFound => {
            "there is no such file or folder; check the name, and the folder it is relative to".into()
        }
        io::ErrorKind::PermissionDenied => {
            "you may not read this; ask for read access, or copy it to a place of your own".into()
        }
        _ => format!(
            "this cannot be read: {error}; check the disk or the network drive, or copy the file to a local disk"
        ),
    }
}

fn write_words(path: &Path, error: &io::Error) -> String {
    let fault = match error.kind() {
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "you may not write here",
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "the disk is full; free some space, or",
        io::ErrorKind::NotADirectory => "part of this path is a file, not a folder",
        io::ErrorKind::NotFound if crate::input::folder_of(path).is_dir() => "no file can be made in this folder",
        io::ErrorKind::NotFound => "the folder to write to is not there; make it, or",
        _ => &format!("this cannot be written: {error}"),
    };
    let joint = if fault.ends_with("or") { "" } else { ";" };
    format!("{fault}{joint} choose another place with --out or --plot")
}

fn bench_file_words(error: &BenchFileError) -> String {
    let count = error.faults.len();
    let head = if count == 1 {
        "one thing has to be corrected".into()
    } else {
        format!("{count} things have to be corrected")
    };
    let lines: Vec<String> = error.faults.iter().map(|fault| format!("  {fault}")).collect();
    format!("{head}:\n{}", lines.join("\n"))
}
