//! Arguments of `dynoid fit`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::{DataArguments, ResultArguments};
use crate::cli::greybox::GreyBoxArguments;
use crate::cli::number;

/// Where a model goes, and what it is held against.
#[derive(Debug, Clone, Args)]
pub(crate) struct FitArguments {
    #[command(flatten)]
    pub(crate) data: DataArguments,
    /// The model file to write
    #[arg(long, short, value_name = "MODEL.json")]
    pub(crate) out: Option<PathBuf>,
    /// Estimates from the first part of each recording, this share of it, and judges on the rest
    #[arg(long, value_name = "SHARE", conflicts_with = "validate", value_parser = number::share)]
    pub(crate) split: Option<f64>,
    /// Judges on another recording, about the operating point of the data of the estimate; its dynamics alone are judged by
    /// `dynoid compare --detrend mean`
    #[arg(long, value_name = "RECORDING")]
    pub(crate) validate: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

/// How a transfer function is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TransferFunctionBy {
    /// By the smallest error of the simulated output, searched for
    Oe,
    /// By refined instrumental variables, without a search: one input, a known delay
    Srivc,
}

/// The initial state of each recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Initial {
    /// Estimated
    Estimated,
    /// At rest
    Zero,
}

#[derive(Debug, Subcommand)]
pub(crate) enum FitCommand {
    /// Least squares: A y = B u + e
    Arx(ArxArguments),
    /// A y = B u + C e, by the prediction-error method
    Armax(PolynomialArguments),
    /// Output error: y = B/F u + e
    Oe(PolynomialArguments),
    /// Box–Jenkins: y = B/F u + C/D e
    Bj(PolynomialArguments),
    /// The general polynomial model: A y = B/F u + C/D e
    Poly(PolynomialArguments),
    /// A continuous transfer function with delay
    Tf(TransferFunctionArguments),
    /// A process model: gain, lags, zero, delay
    Process(ProcessArguments),
    /// State space: subspace start, then the prediction-error method
    Ss(StateSpaceArguments),
    /// Grey box: physical parameters of a structure that you write down
    Greybox(GreyBoxArguments),
}

impl FitCommand {
    pub(crate) fn common(&self) -> &FitArguments {
        match self {
            FitCommand::Arx(a) => &a.fit,
            FitCommand::Armax(a) | FitCommand::Oe(a) | FitCommand::Bj(a) | FitCommand::Poly(a) => &a.fit,
            FitCommand::Tf(a) => &a.fit,
            FitCommand::Process(a) => &a.fit,
            FitCommand::Ss(a) => &a.fit,
            FitCommand::Greybox(a) => &a.fit,
        }
    }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit arx run.mf4 -u T_demand -y N_dyno --na 2 --nb 2 --nk 3
  dynoid fit arx dryer.csv -u u -y y --sample-time 0.08 --to 24 --na 2 --nb 2 --nk 3 --plot dryer.html
  dynoid fit arx a.mf4 b.mf4 -u u1 -u u2 -y y --nb 2,1 --nk 1,3 --iv")]
pub(crate) struct ArxArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Order of A
    #[arg(long, default_value_t = 2, value_parser = number::count)]
    pub(crate) na: usize,
    /// Coefficients of B; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "2", value_parser = number::count)]
    pub(crate) nb: Vec<usize>,
    /// Delay in samples; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "1", value_parser = number::count)]
    pub(crate) nk: Vec<usize>,
    /// Estimates by four-step instrumental variables: right for any colour of the noise
    #[arg(long)]
    pub(crate) iv: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit armax run.mf4 -u T_demand -y N_dyno --na 2 --nb 2 --nc 2 --nk 1 --out model.json
  dynoid fit oe run.mf4 -u u -y y --nb 2 --nf 2 --nk 3 --split 0.5
  dynoid fit bj furnace.csv -u u -y y --sample-time 9 --nb 3 --nf 2 --nk 3 --nd 2

Orders that the structure does not have are ignored only where they keep their default.")]
pub(crate) struct PolynomialArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Order of A
    #[arg(long, value_parser = number::count)]
    pub(crate) na: Option<usize>,
    /// Coefficients of B; one number, or one an input [default: 2]
    #[arg(long, value_delimiter = ',', value_parser = number::count)]
    pub(crate) nb: Vec<usize>,
    /// Order of C
    #[arg(long, value_parser = number::count)]
    pub(crate) nc: Option<usize>,
    /// Order of D
    #[arg(long, value_parser = number::count)]
    pub(crate) nd: Option<usize>,
    /// Order of F; one number, or one an input
    #[arg(long, value_delimiter = ',', value_parser = number::count)]
    pub(crate) nf: Vec<usize>,
    /// Delay in samples; one number, or one an input [default: 1]
    #[arg(long, value_delimiter = ',', value_parser = number::count)]
    pub(crate) nk: Vec<usize>,
    /// What is taken for the initial state
    #[arg(long, value_enum, default_value_t = Initial::Estimated)]
    pub(crate) initial: Initial,
    /// Makes the errors of the simulation small, not those of the prediction
    #[arg(long)]
    pub(crate) simulation: bool,
    /// Finds the dynamics in this band alone, in Hz; the noise is that of all frequencies
    #[arg(long, value_name = "LOW,HIGH", value_delimiter = ',', value_parser = number::finite)]
    pub(crate) band: Vec<f64>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit tf run.mf4 -u T_demand -y T_calc --zeros 0 --poles 1 --delay 0:0.01
  dynoid fit tf run.mf4 -u u -y y --zeros 1 --poles 2 --out model.json --plot fit.html
  dynoid fit tf run.mf4 -u u -y y --poles 2 --delay 0.004 --method srivc
  dynoid fit tf run.mf4 -u T_d -y N_d --poles 2 --integrators 1 --offset --detrend none")]
pub(crate) struct TransferFunctionArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Degree of the numerator; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "0", value_parser = number::count)]
    pub(crate) zeros: Vec<usize>,
    /// Degree of the denominator; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "1", value_parser = number::count)]
    pub(crate) poles: Vec<usize>,
    /// Delay in seconds: a number to keep it there, or a range LOW:HIGH to look in; one, or one an input [default: none]
    #[arg(long, value_delimiter = ',', value_name = "SECONDS")]
    pub(crate) delay: Vec<String>,
    /// How
    #[arg(long, value_enum, default_value_t = TransferFunctionBy::Oe)]
    pub(crate) method: TransferFunctionBy,
    /// Of the poles from each input, so many are known to be at zero; with `--detrend none`
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = number::count)]
    pub(crate) integrators: usize,
    /// Estimates a constant on the output of each recording besides
    #[arg(long)]
    pub(crate) offset: bool,
    /// Lets poles be unstable
    #[arg(long)]
    pub(crate) unstable: bool,
    /// What is taken for the initial state
    #[arg(long, value_enum, default_value_t = Initial::Estimated)]
    pub(crate) initial: Initial,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit process run.mf4 -u valve -y temperature --structure P1D
  dynoid fit process run.mf4 -u u -y y --structure P2DU --delay 0:2
  dynoid fit process run.mf4 -u u -y y --structure P1D --hold K=2

The structure is P, the number of lags (0 to 3), and letters: Z a zero, D a delay, I an integrator, U a pair of poles that may be complex.")]
pub(crate) struct ProcessArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// The structure, such as P1D or P2DZ
    #[arg(long, default_value = "P1D")]
    pub(crate) structure: String,
    /// Range in which the delay is looked for, in seconds
    #[arg(long, value_name = "LOW:HIGH")]
    pub(crate) delay: Option<String>,
    /// Holds a parameter at a value, such as K=2 for a gain that is known; give it again for more. The names are those of
    /// the result: K, Tp1, Tz, Td …, with several inputs `K[1]`, `K[2]` …
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) hold: Vec<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit ss run.mf4 -u T_d -y w_d -y w_e --order 4 --out model.json
  dynoid fit ss run.mf4 -u u -y y --order auto --subspace")]
pub(crate) struct StateSpaceArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Number of states; `auto` lets the singular values decide
    #[arg(long, default_value = "auto")]
    pub(crate) order: String,
    /// Stops after the subspace method
    #[arg(long)]
    pub(crate) subspace: bool,
    /// The weighting of the subspace method
    #[arg(long, value_enum, default_value_t = SubspaceWeighting::Cva)]
    pub(crate) weighting: SubspaceWeighting,
    /// The output may answer within the same sample
    #[arg(long)]
    pub(crate) feedthrough: bool,
    /// Makes the errors of the simulation small, not those of the prediction
    #[arg(long)]
    pub(crate) simulation: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SubspaceWeighting {
    /// Canonical variates
    Cva,
    /// As Van Overschee and De Moor
    N4sid,
    /// As Verhaegen
    Moesp,
}
