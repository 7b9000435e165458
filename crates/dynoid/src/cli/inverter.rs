//! Arguments of `dynoid inverter`.

use clap::Args;

use super::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid inverter bench.toml
  dynoid inverter bench.toml WhiteNoise_T_TN_1200.mf4 --plot inverter.html
  dynoid inverter bench.toml WhiteNoise_T_TN_1200.mf4 BS_T_NT_1200.mf4
  dynoid inverter bench.toml --highest-order 3 --longest-delay 2
  dynoid inverter bench.toml --json | jq '.judgements[] | select(.verdict == \"better\")'

What stands between T_d* and T_d: a delay, a delay and a lag, or a black box (ARX(na, nb, nk) and output error OE(nb, nf, nk) of many orders, on T_d* and on T_d* − T_d). Each is held against the bar that T_d is T_d* one sample of T_d,calc ago, on a recording that the dynamometer moved (WhiteNoise_T_TN, else Multisine_T_TN, Binary_T_TN, Step_T_TN) and on one that the engine moved (BS_T_NT), each estimated on one and judged on both. Delay and lag are told below a sample of T_d,calc, since it is known when the demand changed; what lies beyond them, and at which rate and demand it would be seen, is said.")]
pub(crate) struct InverterArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Tries up to this many poles and as many coefficients of B
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=12))]
    pub(crate) highest_order: usize,
    /// Tries delays up to this many samples of T_d,calc
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(0..=20))]
    pub(crate) longest_delay: usize,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
