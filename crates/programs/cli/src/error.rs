//! Errors between the files and the terminal, each with its remedy, and the program's exit codes.

use std::io;
use std::path::PathBuf;

use dynoid::experiments::OPTIMAL;
use dynoid::{Error, Fault, NotDesigned, NotPredicted};
use ident::IdentError;
use lti::{Complex64, LtiError};
use page::decimal::significant;
use toolbox_report::convert::ConvertError;
use toolbox_report::words::pair;

use crate::path::shown;

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

/// Tells whether a command of this exit code has written its results.
pub(crate) fn has_results(code: u8) -> bool {
    code < USAGE
}

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
    /// The app does not start, or stopped.
    #[cfg(feature = "app")]
    #[error("{source}")]
    App {
        #[from]
        source: dynoid_app::AppError,
    },
    /// The system does not say where the program is, which the app starts for its work.
    #[cfg(feature = "app")]
    #[error("the system does not say where this program is: {source}; start it by its full path")]
    NoProgram { source: io::Error },
    /// Standard output cannot be written.
    #[error("the standard output cannot be written: {source}; is the disk full?")]
    StandardOutput { source: io::Error },
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
    /// A wrong command line.
    #[error("{what}")]
    Usage { what: String },
    /// An estimate is impossible.
    #[error("{data}: the estimate is not possible: {source}{remedy}")]
    Estimate { data: String, source: ident::IdentError, remedy: String },
}

impl CliError {
    pub(crate) fn identify(what: &'static str, source: ident::IdentError) -> Self {
        Error::identify(what, source).into()
    }

    pub(crate) fn internal(what: impl ToString) -> Self {
        Error::internal(what).into()
    }

    pub(crate) fn code(&self) -> u8 {
        match self {
            CliError::Door { source } => code_of(source),
            CliError::BenchFileExists { .. } | CliError::NotABenchFile { .. } | CliError::StandardOutput { .. } => {
                OUTPUT
            }
            CliError::Usage { .. } => USAGE,
            _ => INPUT,
        }
    }
}

fn code_of(error: &Error) -> u8 {
    match error.fault() {
        Fault::Request => USAGE,
        Fault::Input => INPUT,
        Fault::Output => OUTPUT,
        Fault::Internal => INTERNAL,
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
        Error::SeveralIntoOne { path } => format!(
            "{}: for a folder of recordings say their format with --to, as in --to mf4 --out FOLDER",
            path.display()
        ),
        Error::FileForSeveral { path } => {
            format!("{}: with --to, --out is a folder; leave --to out to write this file", path.display())
        }
        Error::NotADemoFolder { path, found } => format!(
            "{}: the folder contains other files ({}); choose another folder with --out",
            path.display(),
            shown(found)
        ),
        Error::NoSuchChannel { .. } => format!("--channels {error}"),
        Error::ClockOfModel { given_s, own_s } => format!(
            "--sample-time {given_s}: the model is discrete, with a sample every {own_s} s, and keeps to that; leave the option out, or convert the model"
        ),
        Error::TrendOfMissing { channel } => format!(
            "--detrend takes off what the outputs show, and \"{channel}\" is not in the recording; leave the option out, and the operating point of the model is taken"
        ),
        Error::LagsOfTest { lags, samples } => {
            format!("--lags {lags}: give at least 1, and at most a quarter of the {samples} samples")
        }
        Error::TwoClocks { file } => {
            format!("{file}: it has time stamps, so give --sample-time or --rate, not both")
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
        Error::NotConverted { source } => converted_with(source).unwrap_or_else(|| error.to_string()),
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

/// Why a model is not converted, with the options that are the remedy.
fn converted_with(error: &ConvertError) -> Option<String> {
    Some(match error {
        ConvertError::DelaysDiffer => {
            format!("{error}, which a state space with delayed inputs cannot hold; give --to tf, or --sample-time")
        }
        ConvertError::WhiteNoise => format!("{error}: there is nothing to convert"),
        ConvertError::Model(IdentError::Lti(LtiError::FractionalDelay { delay_s, sample_time_s })) => format!(
            "the delay of {} s is no whole number of samples of {sample_time_s} s, which this --method needs; --method zoh is exact for any delay (with --to ss foh is too), or choose a --sample-time that divides it",
            significant(*delay_s)
        ),
        ConvertError::Model(IdentError::Lti(LtiError::NoLogarithm { re, im })) => format!(
            "the model has a pole (or with --method matched a zero) at {}, which no continuous model of the same order has under this --method: one at 0 is that of numerator coefficients beyond the order of the denominator, a negative one turns at half the sample rate; --method tustin gives an approximation, a fit of another order or of a continuous model (tf) avoids it",
            pair(Complex64::new(*re, *im))
        ),
        ConvertError::Model(_) => return None,
    })
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
        Error::StructureFile { .. } => "\n`dynoid fit greybox --help` shows the layout",
        Error::TwoKinds { .. } => ". `dynoid export --to linear` makes linear models of a bench model",
        Error::NoBenchBeside { .. } => " with --bench bench.toml",
        Error::NoLabel { .. } => ", with --mode nt or --mode tn",
        _ => "",
    }
}
