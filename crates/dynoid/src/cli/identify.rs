//! Arguments of the commands that identify, judge and use linear models.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::greybox::GreyBoxArguments;

/// Channels, time and clock of the data.
#[derive(Debug, Clone, Args)]
pub(crate) struct DataArguments {
    /// Recordings, one experiment each (MDF 2 to 4, MAT, CSV; text without a time column with --sample-time)
    #[arg(value_name = "RECORDING", required = true)]
    pub(crate) recordings: Vec<PathBuf>,
    /// A channel that acts on the system; give it again for each input
    #[arg(long = "input", short = 'u', value_name = "CHANNEL", help_heading = "Data")]
    pub(crate) inputs: Vec<String>,
    /// A channel that answers; give it again for each output
    #[arg(long = "output", short = 'y', value_name = "CHANNEL", help_heading = "Data")]
    pub(crate) outputs: Vec<String>,
    /// Leaves out everything before this time of the recording
    #[arg(long = "from", value_name = "SECONDS", allow_negative_numbers = true, help_heading = "Data")]
    pub(crate) from_s: Option<f64>,
    /// Leaves out everything after this time of the recording
    #[arg(long = "to", value_name = "SECONDS", allow_negative_numbers = true, help_heading = "Data")]
    pub(crate) to_s: Option<f64>,
    /// Sample time of the data [default: that of the slowest channel; for fits to the simulated output (oe, tf, process,
    /// greybox) that of the fastest]. For text without a time column, the time from row to row
    #[arg(long = "sample-time", value_name = "SECONDS", help_heading = "Data")]
    pub(crate) sample_time_s: Option<f64>,
    /// What is taken off every channel first
    #[arg(long, value_enum, default_value_t = Detrend::Mean, value_name = "WHAT", help_heading = "Data")]
    pub(crate) detrend: Detrend,
    /// What the inputs do between samples
    #[arg(long, value_enum, default_value_t = Between::Held, value_name = "HOW", help_heading = "Data")]
    pub(crate) between: Between,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Detrend {
    /// The mean of each recording
    Mean,
    /// The straight line of each recording
    Line,
    /// Nothing
    None,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Between {
    /// They stay, as the outputs of a computer do
    Held,
    /// They run straight to the next sample
    Straight,
    /// They hold nothing above half the sample rate
    BandLimited,
}

/// What comes out besides the text on the terminal.
#[derive(Debug, Clone, Args)]
pub(crate) struct ResultArguments {
    /// Draws the result into a file, its kind by the ending: .html (interactive), .svg or .png
    #[arg(long, value_name = "FILE")]
    pub(crate) plot: Option<PathBuf>,
    /// Prints the result as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// Where a model goes, and what it is held against.
#[derive(Debug, Clone, Args)]
pub(crate) struct FitArguments {
    #[command(flatten)]
    pub(crate) data: DataArguments,
    /// The model file to write
    #[arg(long, short, value_name = "MODEL.json")]
    pub(crate) out: Option<PathBuf>,
    /// Estimates from the first part of each recording, this share of it, and judges on the rest
    #[arg(long, value_name = "SHARE", conflicts_with = "validate")]
    pub(crate) split: Option<f64>,
    /// Judges on another recording
    #[arg(long, value_name = "RECORDING")]
    pub(crate) validate: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

/// The initial state of each recording.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Initial {
    /// Estimated
    Estimated,
    /// At rest
    Zero,
}

#[derive(Debug, Subcommand)]
pub(crate) enum FitCommand {
    /// Least squares: A y = B u + e
    Arx(ArxArguments),
    /// A y = B u + C e, by the prediction-error method
    Armax(PolynomialArguments),
    /// Output error: y = B/F u + e
    Oe(PolynomialArguments),
    /// Box–Jenkins: y = B/F u + C/D e
    Bj(PolynomialArguments),
    /// The general polynomial model: A y = B/F u + C/D e
    Poly(PolynomialArguments),
    /// A continuous transfer function with delay
    Tf(TransferFunctionArguments),
    /// A process model: gain, lags, zero, delay
    Process(ProcessArguments),
    /// State space: subspace start, then the prediction-error method
    Ss(StateSpaceArguments),
    /// Grey box: physical parameters of a structure that you write down
    Greybox(GreyBoxArguments),
}

impl FitCommand {
    pub(crate) fn common(&self) -> &FitArguments {
        match self {
            FitCommand::Arx(a) => &a.fit,
            FitCommand::Armax(a) | FitCommand::Oe(a) | FitCommand::Bj(a) | FitCommand::Poly(a) => &a.fit,
            FitCommand::Tf(a) => &a.fit,
            FitCommand::Process(a) => &a.fit,
            FitCommand::Ss(a) => &a.fit,
            FitCommand::Greybox(a) => &a.fit,
        }
    }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit arx run.mf4 -u T_demand -y N_dyno --na 2 --nb 2 --nk 3
  dynoid fit arx dryer.csv -u u -y y --sample-time 0.08 --to 24 --na 2 --nb 2 --nk 3 --plot dryer.html
  dynoid fit arx a.mf4 b.mf4 -u u1 -u u2 -y y --nb 2,1 --nk 1,3 --iv")]
pub(crate) struct ArxArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Order of A
    #[arg(long, default_value_t = 2)]
    pub(crate) na: usize,
    /// Coefficients of B; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "2")]
    pub(crate) nb: Vec<usize>,
    /// Delay in samples; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "1")]
    pub(crate) nk: Vec<usize>,
    /// Estimates by four-step instrumental variables: right for any colour of the noise
    #[arg(long)]
    pub(crate) iv: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit armax run.mf4 -u T_demand -y N_dyno --na 2 --nb 2 --nc 2 --nk 1 --out model.json
  dynoid fit oe run.mf4 -u u -y y --nb 2 --nf 2 --nk 3 --split 0.5
  dynoid fit bj furnace.csv -u u -y y --sample-time 9 --nb 3 --nf 2 --nk 3 --nd 2

Orders that the structure does not have are ignored only where they keep their default.")]
pub(crate) struct PolynomialArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Order of A
    #[arg(long)]
    pub(crate) na: Option<usize>,
    /// Coefficients of B; one number, or one an input [default: 2]
    #[arg(long, value_delimiter = ',')]
    pub(crate) nb: Vec<usize>,
    /// Order of C
    #[arg(long)]
    pub(crate) nc: Option<usize>,
    /// Order of D
    #[arg(long)]
    pub(crate) nd: Option<usize>,
    /// Order of F; one number, or one an input
    #[arg(long, value_delimiter = ',')]
    pub(crate) nf: Vec<usize>,
    /// Delay in samples; one number, or one an input [default: 1]
    #[arg(long, value_delimiter = ',')]
    pub(crate) nk: Vec<usize>,
    /// What is taken for the initial state
    #[arg(long, value_enum, default_value_t = Initial::Estimated)]
    pub(crate) initial: Initial,
    /// Makes the errors of the simulation small, not those of the prediction
    #[arg(long)]
    pub(crate) simulation: bool,
    /// Makes the errors small in this band alone, in Hz
    #[arg(long, value_name = "LOW,HIGH", value_delimiter = ',')]
    pub(crate) band: Vec<f64>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit tf run.mf4 -u T_demand -y T_calc --zeros 0 --poles 1 --delay 0:0.01
  dynoid fit tf run.mf4 -u u -y y --zeros 1 --poles 2 --out model.json --plot fit.html")]
pub(crate) struct TransferFunctionArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Degree of the numerator; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "0")]
    pub(crate) zeros: Vec<usize>,
    /// Degree of the denominator; one number, or one an input
    #[arg(long, value_delimiter = ',', default_value = "1")]
    pub(crate) poles: Vec<usize>,
    /// Delay in seconds: a number to keep it there, or a range LOW:HIGH to look in; one, or one an input [default: none]
    #[arg(long, value_delimiter = ',', value_name = "SECONDS")]
    pub(crate) delay: Vec<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit process run.mf4 -u valve -y temperature --structure P1D
  dynoid fit process run.mf4 -u u -y y --structure P2DU --delay 0:2

The structure is P, the number of lags (0 to 3), and letters: Z a zero, D a delay, I an integrator, U a pair of poles that may be complex.")]
pub(crate) struct ProcessArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// The structure, such as P1D or P2DZ
    #[arg(long, default_value = "P1D")]
    pub(crate) structure: String,
    /// Range in which the delay is looked for, in seconds
    #[arg(long, value_name = "LOW:HIGH")]
    pub(crate) delay: Option<String>,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid fit ss run.mf4 -u T_d -y w_d -y w_e --order 4 --out model.json
  dynoid fit ss run.mf4 -u u -y y --order auto --subspace")]
pub(crate) struct StateSpaceArguments {
    #[command(flatten)]
    pub(crate) fit: FitArguments,
    /// Number of states; `auto` lets the singular values decide
    #[arg(long, default_value = "auto")]
    pub(crate) order: String,
    /// Stops after the subspace method
    #[arg(long)]
    pub(crate) subspace: bool,
    /// The weighting of the subspace method
    #[arg(long, value_enum, default_value_t = SubspaceWeighting::Cva)]
    pub(crate) weighting: SubspaceWeighting,
    /// The output may answer within the same sample
    #[arg(long)]
    pub(crate) feedthrough: bool,
    /// Makes the errors of the simulation small, not those of the prediction
    #[arg(long)]
    pub(crate) simulation: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SubspaceWeighting {
    /// Canonical variates
    Cva,
    /// As Van Overschee and De Moor
    N4sid,
    /// As Verhaegen
    Moesp,
}

/// Recordings that a model meets; channels and clock are those of the model.
#[derive(Debug, Clone, Args)]
pub(crate) struct MeetArguments {
    /// A recording with the model's channels; give it again for more
    #[arg(long = "on", value_name = "RECORDING", required = true, help_heading = "Data")]
    pub(crate) on: Vec<PathBuf>,
    /// Leaves out everything before this time of the recording
    #[arg(long = "from", value_name = "SECONDS", allow_negative_numbers = true, help_heading = "Data")]
    pub(crate) from_s: Option<f64>,
    /// Leaves out everything after this time of the recording
    #[arg(long = "to", value_name = "SECONDS", allow_negative_numbers = true, help_heading = "Data")]
    pub(crate) to_s: Option<f64>,
    /// Clock that a continuous model is sampled on, and, for text without a time column, the time from row to row
    /// [default: the model's sample time]
    #[arg(long = "sample-time", value_name = "SECONDS", help_heading = "Data")]
    pub(crate) sample_time_s: Option<f64>,
    /// What is taken off every channel first
    #[arg(long, value_enum, default_value_t = Detrend::Mean, value_name = "WHAT", help_heading = "Data")]
    pub(crate) detrend: Detrend,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid compare arx.json armax.json ss.json --on unseen.mf4 --plot compare.html
  dynoid compare model.json --on unseen.mf4 --horizon 10")]
pub(crate) struct CompareArguments {
    /// Model files
    #[arg(value_name = "MODEL.json", required = true)]
    pub(crate) models: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) meet: MeetArguments,
    /// Compares predictions so many samples ahead, not simulations
    #[arg(long, value_name = "SAMPLES")]
    pub(crate) horizon: Option<usize>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid resid model.json --on unseen.mf4 --plot residuals.html")]
pub(crate) struct ResidArguments {
    /// The model file
    #[arg(value_name = "MODEL.json")]
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) meet: MeetArguments,
    /// Correlations up to this lag, in samples
    #[arg(long, default_value_t = 25)]
    pub(crate) lags: usize,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid simulate model.json --on demand.mf4 --out simulated.csv
  dynoid predict model.json --on run.mf4 --horizon 10 --out predicted.mf4 --plot predicted.html")]
pub(crate) struct RunArguments {
    /// The model file
    #[arg(value_name = "MODEL.json")]
    pub(crate) model: PathBuf,
    #[command(flatten)]
    pub(crate) meet: MeetArguments,
    /// Starts from rest; otherwise the initial state is fitted to the measured outputs
    #[arg(long)]
    pub(crate) from_rest: bool,
    /// Writes the outputs to a recording, its format by the ending: .mf4, .csv, .tsv, .mat, .parquet or .arrow
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
pub(crate) struct PredictArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// How many samples ahead
    #[arg(long, default_value_t = 1, value_name = "SAMPLES")]
    pub(crate) horizon: usize,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid poles model.json --plot poles.png
  dynoid poles arx.json ss.json --level 0.99")]
pub(crate) struct ModelArguments {
    /// Model files
    #[arg(value_name = "MODEL.json", required = true)]
    pub(crate) models: Vec<PathBuf>,
    /// Confidence of bands and regions
    #[arg(long, default_value_t = 0.95, value_name = "SHARE")]
    pub(crate) level: f64,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid bode model.json --plot bode.html
  dynoid bode arx.json ss.json --plot bode.svg
  dynoid step model.json --table
  dynoid step model.json --json | jq '.[0].summary'")]
pub(crate) struct CurveArguments {
    #[command(flatten)]
    pub(crate) models: ModelArguments,
    /// Prints every point of the curves, not their summary
    #[arg(long, conflicts_with = "json")]
    pub(crate) table: bool,
}

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

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SpectrumMethod {
    /// Averaged periodograms (Welch)
    Welch,
    /// Blackman and Tukey's windowed correlations
    BlackmanTukey,
    /// The local polynomial method
    Lpm,
    /// The local rational method, for light damping
    Lrm,
    /// The quotient of Fourier transforms
    Etfe,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid spectrum run.mf4 -y N_dyno --plot spectrum.html
  dynoid spectrum run.mf4 -u T_demand -y N_dyno --method lpm --plot response.html")]
pub(crate) struct SpectrumArguments {
    #[command(flatten)]
    pub(crate) data: DataArguments,
    /// How; without an input the power spectrum is Welch's
    #[arg(long, value_enum, default_value_t = SpectrumMethod::Lpm)]
    pub(crate) method: SpectrumMethod,
    /// Length of Welch's segments or of the lag window, in samples: longer ones tell nearer peaks apart, shorter ones vary
    /// less [default: an eighth of the record, 1024 at most]
    #[arg(long, value_name = "SAMPLES")]
    pub(crate) window: Option<usize>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid delay run.mf4 -u T_demand -y N_dyno")]
pub(crate) struct DelayArguments {
    #[command(flatten)]
    pub(crate) data: DataArguments,
    /// Longest delay looked for, in samples
    #[arg(long, default_value_t = 30)]
    pub(crate) longest: usize,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid order run.mf4 -u T_demand -y N_dyno --na 1:10 --nb 1:10 --nk 1:5 --split 0.5")]
pub(crate) struct OrderArguments {
    #[command(flatten)]
    pub(crate) data: DataArguments,
    /// Orders of A, FIRST:LAST
    #[arg(long, default_value = "1:6", value_name = "RANGE")]
    pub(crate) na: String,
    /// Coefficients of B, FIRST:LAST
    #[arg(long, default_value = "1:6", value_name = "RANGE")]
    pub(crate) nb: String,
    /// Delays in samples, FIRST:LAST
    #[arg(long, default_value = "1:3", value_name = "RANGE")]
    pub(crate) nk: String,
    /// Fits on this share of the data and ranks by the rest too
    #[arg(long, value_name = "SHARE")]
    pub(crate) split: Option<f64>,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}
