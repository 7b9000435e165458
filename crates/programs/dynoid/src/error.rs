//! Errors of the library, each with its remedy.

use std::io;
use std::path::{Path, PathBuf};

use report::wording;
use rig::bench_file::BenchFileError;
use study::{NextError, StudyError};

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
    /// A model file where recordings are wanted.
    #[error("{}: this is a model file, not a recording; `dynoid model poles`, `bode`, `step` and `convert` use it", .path.display())]
    IsModel { path: PathBuf },
    /// A logo that cannot be shown.
    #[error("{}: this logo cannot be shown: {reason}. Or remove `logo` from [report] in {}", .logo.display(), .bench.display())]
    Logo { logo: PathBuf, bench: PathBuf, reason: String },
    /// A bench whose recordings gave no bench model.
    #[error("{}: its recordings gave no bench model; `dynoid study` says what is missing", .path.display())]
    NoModelOfBench { path: PathBuf },
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

    /// A fault of dynoid.
    pub fn internal(what: impl ToString) -> Self {
        Error::Internal { what: what.to_string() }
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
