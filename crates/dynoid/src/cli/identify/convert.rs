//! Arguments of `dynoid convert`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Representation {
    /// Numerator and denominator
    Tf,
    /// Zeros, poles and gain
    Zpk,
    /// State space
    Ss,
}

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
  dynoid convert model.json --to zpk
  dynoid convert model.json --to tf --continuous
  dynoid convert tf.json --to ss --sample-time 0.001 --method tustin --out ss.json

With --to tf and --to ss the result is a model that every command takes. It keeps the delay; the noise model it keeps only as state space on its own clock. With --to zpk it is a list of numbers.")]
pub(crate) struct ConvertArguments {
    /// The model file
    #[arg(value_name = "MODEL.json")]
    pub(crate) model: PathBuf,
    /// The representation wanted
    #[arg(long, value_enum, default_value_t = Representation::Tf)]
    pub(crate) to: Representation,
    /// Makes it discrete, or discrete on another clock
    #[arg(long, value_name = "SECONDS", conflicts_with = "continuous")]
    pub(crate) sample_time: Option<f64>,
    /// Makes a discrete model continuous
    #[arg(long)]
    pub(crate) continuous: bool,
    /// The rule between continuous and discrete
    #[arg(long, value_enum, default_value_t = Sampling::Zoh)]
    pub(crate) method: Sampling,
    /// The model file to write; for --to tf and --to ss
    #[arg(long, short, value_name = "MODEL.json")]
    pub(crate) out: Option<PathBuf>,
    /// Prints the result as JSON: a model file for --to tf and --to ss
    #[arg(long)]
    pub(crate) json: bool,
}
