//! Arguments of `dynoid convert`.

use std::path::PathBuf;

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};

use super::identify::{Between, ResultArguments};
use super::number;
use crate::formats::FileFormat;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
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

/// What comes out: a recording in a format, or a model in a form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    Recording(FileFormat),
    Model(Representation),
}

impl ValueEnum for Form {
    fn value_variants<'a>() -> &'a [Self] {
        &[
            Form::Recording(FileFormat::Mf4),
            Form::Recording(FileFormat::Csv),
            Form::Recording(FileFormat::Tsv),
            Form::Recording(FileFormat::Mat),
            Form::Recording(FileFormat::Parquet),
            Form::Recording(FileFormat::Arrow),
            Form::Model(Representation::Tf),
            Form::Model(Representation::Zpk),
            Form::Model(Representation::Ss),
        ]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self {
            Form::Recording(FileFormat::Mf4) => PossibleValue::new("mf4").help("MDF 4.10"),
            Form::Recording(FileFormat::Csv) => PossibleValue::new("csv").help("Text, commas between the columns"),
            Form::Recording(FileFormat::Tsv) => PossibleValue::new("tsv").help("Text, tabs between the columns"),
            Form::Recording(FileFormat::Mat) => PossibleValue::new("mat").help("MATLAB -v7"),
            Form::Recording(FileFormat::Parquet) => PossibleValue::new("parquet").help("Parquet"),
            Form::Recording(FileFormat::Arrow) => PossibleValue::new("arrow").help("Arrow, Feather"),
            Form::Model(Representation::Tf) => PossibleValue::new("tf").help("Model: numerator and denominator"),
            Form::Model(Representation::Zpk) => PossibleValue::new("zpk").help("Model: zeros, poles and gain"),
            Form::Model(Representation::Ss) => PossibleValue::new("ss").help("Model: state space"),
        })
    }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Recordings:
  dynoid convert run.mf4 --out run.parquet
  dynoid convert run.mf4 --out part.csv --channels 'DynoSpeed,*Torque*' --start 1.5 --end 20
  dynoid convert run.dat --out run_100hz.csv --rate 100
  dynoid convert recordings/ --to mat --out converted/

Models:
  dynoid convert model.json --to zpk
  dynoid convert model.json --to tf --continuous --plot both.html
  dynoid convert tf.json --to ss --sample-time 0.001 --method tustin --out ss.json

Of a recording every raster keeps its own clock, names, units and values are kept bit for bit, and what a format has no place for is said. In text, rasters stand side by side, each with a column `time [s]`; in Parquet and Arrow they share one such column, with nulls between; a MAT-file has a vector of time for each, and lists names and units in `recording_info`.

With --sample-time or --rate all channels come onto one clock: faster ones through a low-pass filter without phase shift, which halves the amplitude (−6 dB) at 0.4 times the new rate, slower ones continued (--between), states such as gears held. What lies in a gap stays missing (NaN).

A continuous model is made discrete by --method, whatever the inputs of its data did between samples: no discrete model is exact for band-limited ones, and commands that meet a continuous model with such data go by the model itself.

With --to tf and --to ss a model stays one that every command takes. It keeps the delay; the noise model it keeps only as state space on its own clock. With --to zpk it is a list of numbers. With --plot both forms are drawn over frequency; of recordings what was written.")]
pub(crate) struct ConvertArguments {
    /// Recordings, folders of recordings, or one model file
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// What to write. For recordings --out is then a folder, in which each keeps its name; without --to, the ending of
    /// --out says it. For a model, tf unless said otherwise
    #[arg(long, value_enum, value_name = "FORM")]
    pub(crate) to: Option<Form>,
    /// The file to write, or with --to the folder for recordings, made if it is not there
    #[arg(long, short, value_name = "PATH")]
    pub(crate) out: Option<PathBuf>,
    /// A sample of every channel so often; for a model, makes it discrete, or discrete on another clock. Where no column
    /// is time, the time from row to row, which --rate may then change
    #[arg(long, value_name = "SECONDS", value_parser = number::positive, conflicts_with = "continuous")]
    pub(crate) sample_time: Option<f64>,
    /// Only channels of these names; `*` stands for any characters, `?` for one. Of several recordings one at least has to
    /// have each
    #[arg(long, value_name = "NAMES", value_delimiter = ',', help_heading = "Recordings")]
    pub(crate) channels: Vec<String>,
    /// Leaves out everything before this time of the recording
    #[arg(long, value_name = "SECONDS", value_parser = number::finite, help_heading = "Recordings")]
    pub(crate) start: Option<f64>,
    /// Leaves out everything after this time of the recording
    #[arg(long, value_name = "SECONDS", value_parser = number::finite, help_heading = "Recordings")]
    pub(crate) end: Option<f64>,
    /// So many samples of every channel a second, also where --sample-time says how far rows are apart
    #[arg(long, value_name = "HERTZ", value_parser = number::positive, help_heading = "Recordings")]
    pub(crate) rate: Option<f64>,
    /// What slower channels do between their samples, where they come onto another clock [default: held]
    #[arg(long, value_enum, value_name = "HOW", help_heading = "Recordings")]
    pub(crate) between: Option<Between>,
    /// Makes a discrete model continuous
    #[arg(long, help_heading = "Models")]
    pub(crate) continuous: bool,
    /// The rule between continuous and discrete [default: zoh]
    #[arg(long, value_enum, help_heading = "Models")]
    pub(crate) method: Option<Sampling>,
    /// The frequency at which Tustin's rule is to be exact; at rest unless it is given
    #[arg(long, value_name = "HERTZ", value_parser = number::positive, help_heading = "Models")]
    pub(crate) prewarp: Option<f64>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
