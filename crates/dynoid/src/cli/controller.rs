//! Arguments of `dynoid controller`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::identify::ResultArguments;
use super::{GivenRecordings, number};

#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "\
Examples:
  dynoid controller bench.toml
  dynoid controller bench.toml BS_T_NT_1200.mf4 --plot controller.html
  dynoid controller bench.toml --json | jq '.controllers[].found.found.with_delay.parameters[] | {symbol, value, interval}'
  dynoid controller study

Recordings in speed control tell the speed controller. With constant N_d* (BS_T_NT): PI without and with delay side by side, the discrete form, and whether a filter, a derivative, a second integrator or an offset stands beside it. Where N_d* moves (Levels_N_NT, Ramp_N_NT): the feed-forward k N_d* + k_a dN_d*/dt, and whether its static map bends, has hysteresis or compensates friction. Where T_d* rests at its limit: the limit, and what becomes of the integrator there. Tests are made at the 1 % level for all terms of a recording together (Holm)."
)]
pub(crate) struct ControllerArguments {
    #[command(subcommand)]
    pub(crate) command: Option<ControllerCommand>,
    #[command(flatten)]
    pub(crate) given: Option<GivenRecordings>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Subcommand)]
pub(crate) enum ControllerCommand {
    /// Simulates a known PI with noise on the speed it sees, estimates it again, many times over
    Study(ControllerStudyArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid controller study
  dynoid controller study bench.toml BS_T_NT_1200.mf4 --draws 1000 --plot study.html
  dynoid controller study --low-pass 0.5 --low-pass-snr 20 --json | jq '.cases[].summaries[] | {symbol, bias, coverage}'

The study of the thesis, §7.1: could noise be why a PI does not explain a recording? A known PI with delay runs on recorded speeds, noise is added to the speed that it sees, and it is estimated again from T_d* and the speeds without that noise. Without a recording, BS_T_NT on a virtual bench serves. The SNR is the variance of the speed error over that of the noise. The thesis gives neither its bands nor its definition of SNR.")]
pub(crate) struct ControllerStudyArguments {
    /// The bench file whose channels the recording has [default: a virtual bench]
    #[arg(value_name = "BENCH.toml")]
    pub(crate) bench: Option<PathBuf>,
    /// A recording in speed control [default: the longest BS_T_NT of the bench file]
    #[arg(value_name = "RECORDING", requires = "bench")]
    pub(crate) recording: Option<PathBuf>,
    /// K_p of the controller, Nm/rpm
    #[arg(long, value_name = "GAIN", value_parser = number::positive, default_value_t = 0.9385)]
    pub(crate) k_p: f64,
    /// K_i of the controller, Nm/(rpm s)
    #[arg(long, value_name = "GAIN", value_parser = number::positive, default_value_t = 1.8650)]
    pub(crate) k_i: f64,
    /// Delay of the controller
    #[arg(long, value_name = "SECONDS", value_parser = number::not_negative, default_value_t = 0.001)]
    pub(crate) delay: f64,
    /// Corner of the low-pass noise (Butterworth, fourth order)
    #[arg(long, value_name = "HZ", value_parser = number::positive, default_value_t = 1.0)]
    pub(crate) low_pass: f64,
    /// SNR with low-pass noise
    #[arg(long, value_name = "RATIO", value_parser = number::positive, default_value_t = 13.0)]
    pub(crate) low_pass_snr: f64,
    /// Corners of the band-pass noise
    #[arg(long, value_name = "LOW,HIGH", value_delimiter = ',', num_args = 1, value_parser = number::positive, default_value = "100,200")]
    pub(crate) band_pass: Vec<f64>,
    /// SNR with band-pass noise
    #[arg(long, value_name = "RATIO", value_parser = number::positive, default_value_t = 8.0)]
    pub(crate) band_pass_snr: f64,
    /// Draws of each noise
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub(crate) draws: u32,
    /// Seed of all draws
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
