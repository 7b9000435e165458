//! Errors between the files and the terminal, each with its remedy, and the program's exit codes.

use std::io;
use std::path::PathBuf;

use dynoid::experiments::OPTIMAL;
use dynoid::{Error, NotDesigned, NotPredicted};

/// The command line is wrong.
const USAGE: u8 = 2;
/// An input cannot be read or understood.
const INPUT: u8 = 3;
/// An output cannot be written.
const OUTPUT: u8 = 4;
/// A fault in dynoid itself.
pub(crate) const INTERNAL: u8 = 5;

/// The option that gives the model of a study, behind a text that asks for one.
pub(crate) const WITH_MODEL: &str = " with --model";

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
    /// An error of the library.
    #[error("{}", in_options(.source))]
    Door {
        #[from]
        source: Error,
    },
    /// Something that is no bench file where one is to be written.
    #[error("{}: there is a file of this name, and it is no bench file; choose another name with --out, or replace it with --overwrite", .path.display())]
    NotABenchFile { path: PathBuf },
    /// A bench file that must not be overwritten.
    #[error("{}: the bench file exists already; write another with --out, add to it with --update, or replace it with --force", .path.display())]
    BenchFileExists { path: PathBuf },
    /// The demo's folder holds other things.
    #[error(
        "{}: the folder contains other files ({found}); choose another folder with --out",
        .path.display()
    )]
    NotADemoFolder { path: PathBuf, found: String },
    /// Standard output cannot be written.
    #[error("the standard output cannot be written: {source}; is the disk full?")]
    StandardOutput { source: io::Error },
    /// Nothing is left of a recording.
    #[error("{file}: nothing to convert: no numeric channel has a sample in this time{}", because(.reasons))]
    NothingToConvert { file: String, reasons: Vec<String> },
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
    /// No recording can be used.
    #[error("{}: none of the recordings can be used", .path.display())]
    NothingToLookAt { path: PathBuf },
    /// A wrong command line.
    #[error("{what}")]
    Usage { what: String },
    /// An estimate is impossible.
    #[error("{data}: the estimate is not possible: {source}{remedy}")]
    Estimate { data: String, source: ident::IdentError, remedy: String },
    /// A model meets a channel in another unit.
    #[error(
        "{data}: \"{channel}\" has the unit {found}, but {expected} in the model; convert the recording, or fit the model again"
    )]
    UnitOfModel { data: String, channel: String, found: String, expected: String },
    /// A file that is not a structure of a grey-box model.
    #[error("{}: this is not a structure of a grey-box model: {reason}\n`dynoid fit greybox --help` shows the layout", .path.display())]
    StructureFile { path: PathBuf, reason: String },
    /// A recording that a bench model cannot be run on.
    #[error("the recording cannot be replayed on a bench model: {reason}")]
    NotReplayed { reason: String },
}

impl CliError {
    pub(crate) fn identify(what: &'static str, source: ident::IdentError) -> Self {
        Error::identify(what, source).into()
    }

    pub(crate) fn internal(what: impl ToString) -> Self {
        Error::internal(what).into()
    }

    /// Tells whether an input is the cause.
    pub(crate) fn is_of_input(&self) -> bool {
        self.code() == INPUT || matches!(self, CliError::Door { source: Error::Encode { .. } })
    }

    pub(crate) fn code(&self) -> u8 {
        match self {
            CliError::Door { source } => code_of(source),
            CliError::BenchFileExists { .. }
            | CliError::NotABenchFile { .. }
            | CliError::NotADemoFolder { .. }
            | CliError::StandardOutput { .. } => OUTPUT,
            CliError::Usage { .. } => USAGE,
            _ => INPUT,
        }
    }
}

fn code_of(error: &Error) -> u8 {
    match error {
        Error::Write { .. }
        | Error::InTheWay { .. }
        | Error::Occupied { .. }
        | Error::IsReadOnly { .. }
        | Error::IsDevice { .. }
        | Error::AmongRecordings { .. }
        | Error::OtherFmi { .. }
        | Error::OtherSource { .. }
        | Error::Encode { .. } => OUTPUT,
        Error::IsRead { .. }
        | Error::OutputEnding { .. }
        | Error::ModelEnding { .. }
        | Error::PageEnding { .. }
        | Error::NotABench { .. }
        | Error::ManyFiles { .. }
        | Error::NotToml { .. }
        | Error::NothingAdded { .. }
        | Error::ChannelTwice { .. }
        | Error::RecordingTwice { .. }
        | Error::EmptyWindow { .. }
        | Error::NoOutputNamed { .. }
        | Error::OtherEnding { .. }
        | Error::FileOfLinear { .. }
        | Error::NameInside { .. }
        | Error::Catalogue { .. }
        | Error::NotDesigned { .. }
        | Error::UnknownTest { .. }
        | Error::NeedsVehicle { .. }
        | Error::NeedsEngineMap { .. }
        | Error::Cycle { .. }
        | Error::Requirement { .. }
        | Error::NoRegressions { .. }
        | Error::NothingToJudgeBy { .. }
        | Error::SpeedOfMap { .. } => USAGE,
        Error::Internal { .. } => INTERNAL,
        _ => INPUT,
    }
}

/// The text of an error, with the options that are its remedy.
fn in_options(error: &Error) -> String {
    match error {
        Error::NoRegressions { .. } => format!("--by {error}"),
        Error::NothingToJudgeBy { test } => format!(
            "{test}: nothing to judge the recording by. This test has no requirement set of its own: name one with --by, or give a \
             requirement with --require"
        ),
        Error::FileOfLinear { path } => {
            format!("{}: --to linear writes a file for each control mode; give a folder", path.display())
        }
        Error::PageEnding { path } => format!("{}: a plot file ends in .html, .pdf, .svg or .png", path.display()),
        Error::ChannelTwice { channel } => {
            format!("the channel \"{channel}\" is named twice among --input and --output; name it once")
        }
        Error::EmptyWindow { from_s, to_s } => {
            format!("--from {from_s} lies at or after --to {to_s}; give the earlier time first")
        }
        Error::NoOutputNamed { file, channels } => {
            format!("{file}: name outputs with --output and inputs with --input; the channels are {channels}")
        }
        Error::OnlyGaps { data, channels, shortest } => format!(
            "{data}: {channels}: some are missing in any {shortest} consecutive samples; choose other channels, or a longer --sample-time"
        ),
        Error::NoneReadable { reasons } => {
            format!("no recording can be read ({} tried); the reasons are above", reasons.len())
        }
        Error::SpeedOfMap { rpm } => {
            format!("--speed {rpm}: a map needs a speed above 0 rpm, since an engine turns forwards")
        }
        Error::Catalogue { experiment, source } if experiment == OPTIMAL => format!("--optimal: {source}"),
        Error::NotDesigned { reason } => format!("--optimal: {}", designed_with(reason)),
        _ => format!("{error}{}", hint(error)),
    }
}

/// Why no excitation is designed, with the options that are the remedy.
fn designed_with(reason: &NotDesigned) -> String {
    match reason {
        NotDesigned::UnknownShaft => format!("{reason}{WITH_MODEL}"),
        NotDesigned::NoShaftLimit => {
            "say how far the shaft's torque may swing, as with --peak-shaft-torque 60, or state shaft_torque in [limits]"
                .to_owned()
        }
        NotDesigned::NothingLeft { .. } => format!("{reason} with --set torque=…"),
        NotDesigned::Design(_) => reason.to_string(),
    }
}

/// The options that are the remedy of an error, behind its text.
fn hint(error: &Error) -> &'static str {
    match error {
        Error::Write { .. } => " with --out or --plot",
        Error::InTheWay { .. } | Error::IsDevice { .. } => " with --out",
        Error::Occupied { .. } | Error::IsReadOnly { .. } => ", or replace it with --overwrite",
        Error::OtherFmi { .. } | Error::OtherSource { .. } => " with --out, or replace it with --overwrite",
        Error::Recording { untimed: true, .. } => {
            "; if no column is time, give the time from row to row with --sample-time"
        }
        Error::Encode { .. } => " with --channels",
        Error::NotABench { .. } => "; give it with --model",
        Error::NotPredicted { reason: NotPredicted::UnknownShaft, .. } => WITH_MODEL,
        Error::NeedsVehicle { .. } => " with --vehicle FILE",
        Error::NeedsEngineMap { .. } => " with --engine-map FILE",
        Error::NeedsMap { .. } => " with --engine-map",
        Error::StillChannel { .. } => " with --from and --to",
        _ => "",
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
