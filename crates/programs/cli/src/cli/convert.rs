//! Arguments of `dynoid convert`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use dynoid::FileFormat;

use super::identify::{Between, ResultArguments};
use super::number;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid convert run.mf4 --out run.parquet
  dynoid convert run.mf4 --out part.csv --channels '*Torque*' --end 20
  dynoid convert run.dat --out run_100hz.csv --rate 100
  dynoid convert recordings/ --to mat --out converted/

Every raster keeps its own clock. Names, units and values stay as they are, bit for bit; the command names everything that the new format cannot hold. In text, each raster has its own column `time [s]`. Parquet and Arrow have one such column, with nulls. A MAT-file has one time vector a raster, and lists names and units in `recording_info`.

With --sample-time or --rate all channels get one clock. Faster channels pass a low-pass filter without phase shift, −6 dB at 0.4 times the new rate; slower channels are continued (--between). States such as gears are held. Samples in gaps stay missing (NaN).

`dynoid model convert` converts model files.")]
pub(crate) struct ConvertArguments {
    /// Recordings, or folders of recordings
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Format to write; --out is then a folder, in which each recording keeps its name
    /// [default: by the ending of --out]
    #[arg(long, value_enum, value_name = "FORMAT")]
    pub(crate) to: Option<WrittenFormat>,
    /// The file to write, or with --to the folder; created if it does not exist
    #[arg(long, short, value_name = "PATH")]
    pub(crate) out: Option<PathBuf>,
    /// Only channels of these names; `*` stands for any characters, `?` for one. Each must be in at least one recording
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) channels: Vec<String>,
    /// Leave out everything before this time
    #[arg(long, value_name = "SECONDS", value_parser = number::seconds)]
    pub(crate) start: Option<f64>,
    /// Leave out everything after this time
    #[arg(long, value_name = "SECONDS", value_parser = number::seconds)]
    pub(crate) end: Option<f64>,
    /// Put all channels on one clock with this sample time. In text without a time column: the time from row to row
    #[arg(long, value_name = "SECONDS", value_parser = number::positive_seconds)]
    pub(crate) sample_time: Option<f64>,
    /// Put all channels on one clock with this sample rate, also where --sample-time gives the time from row to row
    #[arg(long, value_name = "HERTZ", value_parser = number::positive_hertz)]
    pub(crate) rate: Option<f64>,
    /// How slower channels run between their samples, on another clock [default: held]
    #[arg(long, value_enum, value_name = "HOW")]
    pub(crate) between: Option<Between>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

/// Formats of files that recordings are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum WrittenFormat {
    /// MDF 4.10
    Mf4,
    /// Text, commas between the columns
    Csv,
    /// Text, tabs between the columns
    Tsv,
    /// MATLAB -v7
    Mat,
    /// Parquet
    Parquet,
    /// Arrow, Feather
    Arrow,
}

impl From<WrittenFormat> for FileFormat {
    fn from(target: WrittenFormat) -> Self {
        match target {
            WrittenFormat::Mf4 => FileFormat::Mf4,
            WrittenFormat::Csv => FileFormat::Csv,
            WrittenFormat::Tsv => FileFormat::Tsv,
            WrittenFormat::Mat => FileFormat::Mat,
            WrittenFormat::Parquet => FileFormat::Parquet,
            WrittenFormat::Arrow => FileFormat::Arrow,
        }
    }
}
