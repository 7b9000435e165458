//! Arguments of `dynoid fit`.

use clap::{Args, Subcommand, ValueEnum};

use super::data::{Detrend, FitArguments};
use super::greybox::GreyBoxArguments;
use crate::cli::number;

/// How a transfer function is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum TransferFunctionBy {
    /// Output error: search for the smallest error of the simulated output
    Oe,
    /// Refined instrumental variables: one input, a known delay
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

/// Choice to estimate the level of the output with the model, or not.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Offset {
    /// A constant of the output of each recording is estimated too
    Estimated,
    /// The output is zero where the input is
    None,
}

/// The level of the output.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct OffsetArgument {
    /// The level of the output. A mean is not the level at which the system rests: `--offset` alone estimates it with
    /// the model [default: estimated, and none with --detrend none]
    #[arg(
        long,
        value_enum,
        value_name = "WHICH",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "estimated"
    )]
    offset: Option<Offset>,
}

impl OffsetArgument {
    /// Tells whether it is estimated.
    pub(crate) fn is_estimated(self, detrend: Detrend) -> bool {
        self.offset.map_or(detrend != Detrend::None, |offset| offset == Offset::Estimated)
    }
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
    /// Grey box: physical parameters of your own equations
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
  dynoid fit arx dryer.csv -u u -y y --sample-time 0.08 --to 24 --nk 3
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
    /// Use four-step instrumental variables: consistent for any colour of the noise
    #[arg(long)]
    pub(crate) iv: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit armax run.mf4 -u T_demand -y N_dyno --na 2 --nb 2 --nc 2 --nk 1
  dynoid fit oe run.mf4 -u u -y y --nb 2 --nf 2 --nk 3 --split 0.5
  dynoid fit bj run.mf4 -u u -y y --nb 3 --nf 2 --nk 3 --nd 2 --out model.json
  dynoid fit poly run.mf4 -u u -y y --na 1 --nb 2 --nf 1 --nc 1

An order that the structure does not have is an error.")]
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
    /// The initial state of each recording
    #[arg(long, value_enum, default_value_t = Initial::Estimated)]
    pub(crate) initial: Initial,
    /// Minimise the simulation error instead of the prediction error
    #[arg(long)]
    pub(crate) simulation: bool,
    /// Estimate the dynamics in this band only, in Hz; the noise model covers all frequencies
    #[arg(long, value_name = "LOW,HIGH", value_delimiter = ',', value_parser = number::finite)]
    pub(crate) band: Vec<f64>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit tf run.mf4 -u T_demand -y T_calc --zeros 0 --poles 1 --delay 0:0.01
  dynoid fit tf run.mf4 -u u -y y --zeros 1 --poles 2 --plot fit.html
  dynoid fit tf run.mf4 -u u -y y --poles 2 --delay 0.004 --method srivc
  dynoid fit tf run.mf4 -u T_d -y N_d --poles 2 --integrators 1 --detrend none")]
pub(crate) struct TransferFunctionArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Degree of the numerator; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "0", value_parser = number::count)]
    pub(crate) zeros: Vec<usize>,
    /// Degree of the denominator; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "1", value_parser = number::count)]
    pub(crate) poles: Vec<usize>,
    /// Delay in seconds: a fixed number, or a range LOW:HIGH to search; one, or one an input [default: none]
    #[arg(long, value_delimiter = ',', value_name = "SECONDS")]
    pub(crate) delay: Vec<String>,
    /// The method
    #[arg(long, value_enum, default_value_t = TransferFunctionBy::Oe)]
    pub(crate) method: TransferFunctionBy,
    /// Number of poles at zero from each input; with `--detrend none`
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = number::count)]
    pub(crate) integrators: usize,
    #[command(flatten)]
    pub(crate) offset: OffsetArgument,
    /// Allow unstable poles
    #[arg(long)]
    pub(crate) unstable: bool,
    /// The initial state of each recording
    #[arg(long, value_enum, default_value_t = Initial::Estimated)]
    pub(crate) initial: Initial,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit process run.mf4 -u valve -y temperature --structure P1D
  dynoid fit process run.mf4 -u u -y y --structure P2DU --delay 0:2
  dynoid fit process run.mf4 -u u -y y --structure P1D --hold K=2

The structure is P, the number of lags (0 to 3), and letters: Z a zero, D a delay, I an integrator, U a pole pair that may be complex.")]
pub(crate) struct ProcessArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// The structure, such as P1D or P2DZ
    #[arg(long, default_value = "P1D")]
    pub(crate) structure: String,
    /// Range in which the delay is searched, in seconds
    /// [default: 0 to 30 samples; up to a third of the record where it ends there]
    #[arg(long, value_name = "LOW:HIGH")]
    pub(crate) delay: Option<String>,
    /// Fix a parameter, such as K=2 for a known gain; repeat it for more. Names as in the result: K, Tp1, Tz, Td …,
    /// with several inputs `K[1]`, `K[2]` …
    #[arg(long, value_name = "NAME=VALUE")]
    pub(crate) hold: Vec<String>,
    /// Search a parameter in a range, such as zeta=0:1; repeat it for more
    /// [default: lags from 0.01 samples to 10 times the record, zeta from 0 to 10]
    #[arg(long, value_name = "NAME=LOW:HIGH")]
    pub(crate) bound: Vec<String>,
    #[command(flatten)]
    pub(crate) offset: OffsetArgument,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit ss run.mf4 -u T_d -y w_d -y w_e --order 4 --out model.json
  dynoid fit ss run.mf4 -u u -y y --order auto --subspace")]
pub(crate) struct StateSpaceArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Number of states; `auto` chooses by the singular values
    #[arg(long, default_value = "auto")]
    pub(crate) order: String,
    /// Stop after the subspace method
    #[arg(long)]
    pub(crate) subspace: bool,
    /// The weighting of the subspace method
    #[arg(long, value_enum, default_value_t = SubspaceWeighting::Auto)]
    pub(crate) weighting: SubspaceWeighting,
    /// Allow a response within the same sample
    #[arg(long)]
    pub(crate) feedthrough: bool,
    /// Minimise the simulation error instead of the prediction error
    #[arg(long)]
    pub(crate) simulation: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SubspaceWeighting {
    /// Canonical variates; SSARX where the residuals show feedback
    Auto,
    /// Canonical variates
    Cva,
    /// Van Overschee and De Moor
    N4sid,
    /// Verhaegen
    Moesp,
    /// Jansson: from a long autoregression; for data under feedback
    Ssarx,
}
