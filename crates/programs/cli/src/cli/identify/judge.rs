//! Arguments of `dynoid model compare`, `residuals`, `predict` and `simulate`: models on recordings.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use dynoid::linear::MeetOptions;
use dynoid::linear::operating_point::MeetingTrend;
use dynoid::replay::{ReplayOptions, ReplayedStretch};
use ident::TrendShape;
use rig::ControlMode;

use super::data::{ResultArguments, Window};
use crate::cli::number;

/// Recordings that a model is used on; channels and clock are those of the model.
#[derive(Debug, Clone, Args)]
pub(crate) struct MeetArguments {
    /// A recording with the model's channels; repeat it for more
    #[arg(long = "on", value_name = "RECORDING", required = true, help_heading = "Data")]
    pub(crate) on: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) window: Window,
    /// Sample time for a continuous model. In text without a time column: the time from row to row
    /// [default: the model's sample time]
    #[arg(long = "sample-time", value_name = "SECONDS", value_parser = number::positive_seconds, help_heading = "Data")]
    pub(crate) sample_time_s: Option<f64>,
    /// What to subtract from every channel first, and to add to the results again
    #[arg(long, value_enum, default_value_t = MeetDetrend::Model, value_name = "WHAT", help_heading = "Data")]
    pub(crate) detrend: MeetDetrend,
}

impl MeetArguments {
    /// The same for the library.
    pub(crate) fn options(&self) -> MeetOptions {
        MeetOptions {
            recordings: self.on.clone(),
            from_s: self.window.from_s,
            to_s: self.window.to_s,
            sample_time_s: self.sample_time_s,
            trend: self.detrend.off(),
        }
    }

    /// Tells whether the operating point of the model is subtracted.
    pub(crate) fn is_at_operating_point(&self) -> bool {
        self.detrend == MeetDetrend::Model
    }

    /// The same for replays on bench models, of the `unasked` stretch where none is asked for.
    pub(crate) fn replay_options(&self, bench: &BenchArguments, unasked: ReplayedStretch) -> ReplayOptions {
        let Window { from_s, to_s } = self.window;
        let asked = (from_s.is_some() || to_s.is_some())
            .then(|| ReplayedStretch::Between(from_s.unwrap_or(f64::NEG_INFINITY), to_s.unwrap_or(f64::INFINITY)));
        ReplayOptions {
            recordings: self.on.clone(),
            stretch: asked.unwrap_or(unasked),
            bench: bench.bench.clone(),
            mode: bench.mode.map(|mode| match mode {
                Mode::Nt => ControlMode::Nt,
                Mode::Tn => ControlMode::Tn,
            }),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MeetDetrend {
    /// The levels subtracted before the fit, so that levels are judged too: those of the same recording if the model
    /// was estimated from it, otherwise their mean
    Model,
    /// The mean of each recording: judges the dynamics alone
    Mean,
    /// The straight line of each recording
    Line,
    /// Nothing
    None,
}

impl MeetDetrend {
    /// The same for the library.
    fn off(self) -> MeetingTrend {
        match self {
            MeetDetrend::Model => MeetingTrend::Model,
            MeetDetrend::Mean => MeetingTrend::Own(TrendShape::Mean),
            MeetDetrend::Line => MeetingTrend::Own(TrendShape::Line),
            MeetDetrend::None => MeetingTrend::Nothing,
        }
    }
}

/// Arguments about the recordings for a bench model.
#[derive(Debug, Clone, Args)]
pub(crate) struct BenchArguments {
    /// With a bench model: the bench file, which names the channels
    /// [default: that of the study, if it is beside the model or one folder up]
    #[arg(long, value_name = "BENCH.toml", help_heading = "Bench model")]
    pub(crate) bench: Option<PathBuf>,
    /// With a bench model: how the dynamometer was controlled [default: by the label in the recording's name, such as
    /// BS_T_NT]
    #[arg(long, value_enum, value_name = "MODE", help_heading = "Bench model")]
    pub(crate) mode: Option<Mode>,
}

/// Control mode of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Mode {
    /// The dynamometer controls speed
    Nt,
    /// The dynamometer controls torque
    Tn,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid model compare arx.json ss.json --on unseen.mf4 --plot compare.html
  dynoid model compare model.json --on unseen.mf4 --horizon 10
  dynoid model compare study/model.json --on BS_T_NT_1200.mf4 --plot compare.html

A bench model runs on the recorded demand, and on the engine torque that N_e and T_shaft show.
N_d, N_e, T_d, T_shaft and, in speed control, T_d* are compared. The ripple of the drive is no
part of the model.")]
pub(crate) struct CompareArguments {
    /// Model files
    #[arg(value_name = "MODEL.json", required = true)]
    pub(crate) models: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) meet: MeetArguments,
    #[command(flatten)]
    pub(crate) bench: BenchArguments,
    /// Compare predictions this many samples ahead instead of simulations
    #[arg(long, value_name = "SAMPLES", value_parser = number::count)]
    pub(crate) horizon: Option<usize>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid model residuals model.json --on unseen.mf4 --plot residuals.html")]
pub(crate) struct ResidualsArguments {
    /// The model file
    #[arg(value_name = "MODEL.json")]
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) meet: MeetArguments,
    /// Largest lag of the correlations, in samples
    #[arg(long, default_value_t = 25, value_parser = number::count)]
    pub(crate) lags: usize,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid model simulate model.json --on demand.mf4 --out simulated.csv
  dynoid model simulate model.json --on run.mf4 --from-rest --plot sim.html
  dynoid model simulate study/model.json --on BS_T_NT_1200.mf4 --out simulated.mf4

A bench model runs on the recorded demand, and on the engine torque that N_e and T_shaft show.
`dynoid experiment simulate` simulates an experiment that was not recorded.")]
pub(crate) struct SimulateModelArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    #[command(flatten)]
    pub(crate) bench: BenchArguments,
}

#[derive(Debug, Args)]
pub(crate) struct RunArguments {
    /// The model file
    #[arg(value_name = "MODEL.json")]
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) meet: MeetArguments,
    /// Start from rest; otherwise the initial state is fitted to the measured outputs
    #[arg(long)]
    pub(crate) from_rest: bool,
    /// Write the outputs to a recording; its ending gives the format: .mf4, .csv, .tsv, .mat, .parquet or .arrow
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid model predict model.json --on run.mf4 --horizon 10 --out predicted.mf4")]
pub(crate) struct PredictArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// How many samples ahead
    #[arg(long, default_value_t = 1, value_name = "SAMPLES", value_parser = number::count)]
    pub(crate) horizon: usize,
}
