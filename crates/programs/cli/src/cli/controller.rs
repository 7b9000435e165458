//! Arguments of `dynoid controller`.

use std::path::PathBuf;

use clap::{Args, Subcommand};

use super::given::GivenRecordings;
use super::identify::ResultArguments;
use super::number;

#[derive(Debug, Args)]
#[command(
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true,
    after_help = "\
Examples:
  dynoid controller bench.toml
  dynoid controller bench.toml BS_T_NT_1200.mf4 --plot controller.html
  dynoid controller bench.toml --json > controller.json
  dynoid controller noise-test

The command uses recordings in speed control:
  N_d* constant (BS_T_NT): PI without and with delay, the discrete form; tests
    for a filter, a derivative, a second integrator and an offset
  N_d* changing (Levels_N_NT, Ramp_N_NT): feed-forward k N_d* + k_a dN_d*/dt;
    tests for a bent static map, hysteresis and friction compensation
  T_d* at its limit: the limit, and the anti-windup of the integrator

All tests of one recording together have the level 1 % (Holm)."
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
    /// Show what noise on the speed does to the estimate of a known PI
    NoiseTest(NoiseTestArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid controller noise-test
  dynoid controller noise-test bench.toml BS_T_NT_1200.mf4 --draws 1000
  dynoid controller noise-test --low-pass 0.5 --low-pass-snr 20 --plot noise.html

Could noise explain why a PI does not fit a recording (thesis, §7.1)? A known PI with delay runs on recorded speeds, with noise added to the speed that it sees. It is then estimated from T_d* and the speeds without that noise, many times. Without a recording the test simulates BS_T_NT.

SNR is the variance of the speed error divided by that of the noise. The thesis gives neither its bands nor its definition of SNR.")]
pub(crate) struct NoiseTestArguments {
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
    #[arg(long, value_name = "SECONDS", value_parser = number::seconds_from_zero, default_value_t = 0.001)]
    pub(crate) delay: f64,
    /// Corner of the low-pass noise (Butterworth, fourth order)
    #[arg(long, value_name = "HZ", value_parser = number::positive_hertz, default_value_t = 1.0)]
    pub(crate) low_pass: f64,
    /// SNR with low-pass noise
    #[arg(long, value_name = "RATIO", value_parser = number::positive, default_value_t = 13.0)]
    pub(crate) low_pass_snr: f64,
    /// Corners of the band-pass noise
    #[arg(long, value_name = "LOW,HIGH", value_delimiter = ',', num_args = 1, value_parser = number::positive_hertz, default_value = "100,200")]
    pub(crate) band_pass: Vec<f64>,
    /// SNR with band-pass noise
    #[arg(long, value_name = "RATIO", value_parser = number::positive, default_value_t = 8.0)]
    pub(crate) band_pass_snr: f64,
    /// Draws of each noise
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub(crate) draws: u32,
    /// Seed of all draws
    #[arg(long, value_name = "N", value_parser = number::seed, default_value_t = 1)]
    pub(crate) seed: u64,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
