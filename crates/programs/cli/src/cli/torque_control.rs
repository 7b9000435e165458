//! Arguments of `dynoid torque-control`.

use clap::Args;

use super::given::GivenRecordings;
use super::identify::ResultArguments;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid torque-control bench.toml
  dynoid torque-control bench.toml WhiteNoise_T_TN_1200.mf4 --plot t.html
  dynoid torque-control bench.toml WhiteNoise_T_TN_1200.mf4 BS_T_NT_1200.mf4
  dynoid torque-control bench.toml --highest-order 3 --longest-delay 2
  dynoid torque-control bench.toml --json | jq '.judgements[].verdict'

The command compares models from T_d* to T_d: a delay, a delay with a lag, ARX(na, nb, nk) and output error OE(nb, nf, nk) of many orders, on T_d* and on T_d* − T_d. The reference is T_d = T_d* one sample of T_d,calc ago.

Two recordings are used: one that the dynamometer excites (WhiteNoise_T_TN, or else Multisine_T_TN, Binary_T_TN or Step_T_TN) and one that the engine excites (BS_T_NT). Each model is estimated on one and judged on both. Delay and lag are found below one sample of T_d,calc, because the instants of the demand are known. The result says which sample rate and demand would show more.")]
pub(crate) struct TorqueControlArguments {
    #[command(flatten)]
    pub(crate) given: GivenRecordings,
    /// Try up to this many poles and as many coefficients of B
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(1..=12))]
    pub(crate) highest_order: usize,
    /// Try delays up to this many samples of T_d,calc
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::builder::RangedU64ValueParser::<usize>::new().range(0..=20))]
    pub(crate) longest_delay: usize,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
