//! Arguments of `dynoid model convert`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::data::ResultArguments;
use crate::cli::number;

/// The form of a model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Representation {
    /// Numerator and denominator
    Tf,
    /// Zeros, poles and gain
    Zpk,
    /// State space
    Ss,
}

/// The rule between continuous and discrete models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Sampling {
    /// Zero-order hold
    Zoh,
    /// First-order hold
    Foh,
    /// Tustin's bilinear rule
    Tustin,
    /// Impulse invariance
    Impulse,
    /// Matched poles and zeros
    Matched,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid model convert model.json --to zpk
  dynoid model convert model.json --to tf --continuous --plot both.html
  dynoid model convert tf.json --to ss --sample-time 0.001 --out ss.json

With --to tf and --to ss the result is a model file for every command. It keeps the delay. Only a state space on the model's own clock keeps the noise model. With --to zpk the result is a list of numbers. With --plot both forms are drawn over frequency.

A continuous model becomes discrete by --method, whatever its inputs did between their samples. No discrete model is exact for band-limited inputs; for such data the commands use the continuous model itself.

`dynoid convert` converts recordings.")]
pub(crate) struct ModelConvertArguments {
    /// The model file
    #[arg(value_name = "MODEL.json")]
    pub(crate) model: PathBuf,
    /// The form to convert to
    #[arg(long, value_enum, value_name = "FORM", default_value_t = Representation::Tf)]
    pub(crate) to: Representation,
    /// Make the model discrete, or discrete on another clock
    #[arg(long, value_name = "SECONDS", value_parser = number::positive_seconds, conflicts_with = "continuous")]
    pub(crate) sample_time: Option<f64>,
    /// Make a discrete model continuous
    #[arg(long)]
    pub(crate) continuous: bool,
    /// The rule between continuous and discrete
    #[arg(long, value_enum, default_value_t = Sampling::Zoh)]
    pub(crate) method: Sampling,
    /// The model file to write
    #[arg(long, short, value_name = "MODEL.json")]
    pub(crate) out: Option<PathBuf>,
    /// The frequency at which Tustin's rule is exact [default: 0]
    #[arg(long = "prewarp", value_name = "HERTZ", value_parser = number::positive_hertz)]
    pub(crate) prewarp_hz: Option<f64>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
