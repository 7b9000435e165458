//! Arguments of `dynoid fit greybox`.

use std::path::PathBuf;

use clap::Args;

use super::data::FitArguments;
use crate::cli::number;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit greybox two_mass.toml run.mf4 -u T_d -y w_d -y w_e --detrend none
  dynoid fit greybox lag.toml a.mf4 b.mf4 -u u -y y --starts 20 --out model.json

The structure is a TOML file. This one has two inertias J_d and J_e on a shaft of stiffness K and damping B. The torque acts on the first inertia, and both speeds are measured. The states are the two speeds and the twist:

  [parameters]
  J_d = { value = 0.6, fixed = true }
  J_e = { value = 0.3, min = 0.01, max = 10 }
  K = { value = 2000, min = 0 }
  B = { value = 5, min = 0, prior = { mean = 4, sd = 2 } }

  [matrices]
  A = [[\"-B/J_d\", \"B/J_d\", \"-K/J_d\"],
       [\"B/J_e\", \"-B/J_e\", \"K/J_e\"],
       [1, -1, 0]]
  B = [[\"1/J_d\"], [0], [0]]
  C = [[1, 0, 0], [0, 1, 0]]

  [derived]
  resonance_hz = \"sqrt(K*(1/J_d + 1/J_e))/(2*pi)\"

Rows of A are states, columns of B inputs in the order of -u, rows of C outputs in the order of -y. D is zero by default. K, the gain of the sampled predictor (states by outputs), is absent by default. Entries are numbers or formulas in quotes, with parameters, numbers, pi, + - * / ^, parentheses, sqrt and exp.

The search starts at `value` and stays between `min` and `max`; `fixed` parameters do not change. Derived quantities are reported with standard errors.

The model is continuous: x' = A x + B u, y = C x + D u. Above the tables, `sample_time_s = 0.01` makes it discrete, and `input_delays_s = [\"T\"]`, one an input, delays the inputs of a continuous model.

By default the mean of every channel is subtracted, which suits a model at an operating point. A structure that integrates, as this one does, needs `--detrend none`.")]
pub(crate) struct GreyBoxArguments {
    /// The structure: parameters, and matrices of formulas
    #[arg(value_name = "STRUCTURE.toml")]
    pub(crate) structure: PathBuf,
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Further starting points against local minima: within the bounds, or from a tenth to ten times the value
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = number::count)]
    pub(crate) starts: usize,
    /// Assume rest at the first sample; use it with `--detrend none`
    #[arg(long)]
    pub(crate) from_rest: bool,
}
