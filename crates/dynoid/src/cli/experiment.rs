//! Arguments of `dynoid experiment`, and of `dynoid simulate`, which has two uses.

use std::path::PathBuf;

use bench::excitation_design::Goal;
use clap::{Args, Subcommand, ValueEnum};

use super::identify::{ResultArguments, RunArguments};
use super::number;

#[derive(Debug, Subcommand)]
pub(crate) enum ExperimentCommand {
    /// Lists the experiments of the method with their parameters
    List(ListArguments),
    /// Writes the demands of an experiment, draws them, and predicts what the bench will do
    Design(DesignArguments),
    /// Checks whether an experiment is safe on a bench that is not known exactly
    Check(CheckArguments),
    /// Says what to record next: what each experiment would make narrower of what is known
    Next(NextArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid experiment list
  dynoid experiment list BS_T_NT
  dynoid experiment list --json | jq '.experiments[].label'")]
pub(crate) struct ListArguments {
    /// Only this experiment, with its parameters
    #[arg(value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// Prints everything as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// The numbers of an experiment.
#[derive(Debug, Clone, Args)]
pub(crate) struct PlanArguments {
    /// Speed, rpm: constant, or the one from which it changes
    #[arg(long, value_name = "RPM", value_parser = number::finite, help_heading = "Experiment")]
    pub(crate) speed: Option<f64>,
    /// Length of the recording
    #[arg(long, value_name = "SECONDS", value_parser = number::positive, help_heading = "Experiment")]
    pub(crate) duration: Option<f64>,
    /// Another parameter, such as low=35 or low="35 Nm"; give it again for more. `dynoid experiment list NAME` shows them
    #[arg(long = "set", value_name = "NAME=VALUE", help_heading = "Experiment")]
    pub(crate) set: Vec<String>,
    /// Seed of what is random in demands and bench; the same seed gives the same bytes [default: 1]
    #[arg(long, value_name = "N", help_heading = "Experiment")]
    pub(crate) seed: Option<u64>,
    /// Takes shaft, speed controller, feed-forward and torque control from a study, in place of what the bench file states
    #[arg(long = "model", value_name = "STUDY.json", help_heading = "Experiment")]
    pub(crate) study: Option<PathBuf>,
}

/// A bench file, the numbers of an experiment on that bench, and what is shown of it.
#[derive(Debug, Args)]
pub(crate) struct OnBenchArguments {
    /// The bench file
    #[arg(value_name = "BENCH.toml")]
    pub(crate) bench: PathBuf,
    #[command(flatten)]
    pub(crate) plan: PlanArguments,
    #[command(flatten)]
    pub(crate) result: ResultArguments,
}

impl PlanArguments {
    /// The seed, or the usual one.
    pub(crate) fn seed(&self) -> u64 {
        self.seed.unwrap_or(1)
    }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid experiment design bench.toml BS_T_NT --speed 1500 --duration 60 --set low=35 --set high=55
  dynoid experiment design bench.toml Multisine_T_TN --model study/study.json
  dynoid experiment design bench.toml cycle.csv --out cycle
  dynoid experiment design bench.toml --optimal K,B --speed 1500 --duration 20 --peak-shaft-torque 60
  dynoid experiment design bench.toml --optimal PI,FF --form binary --set torque=40

Writes NAME_SPEED.csv and NAME_SPEED.mf4 (the demands: speeds every 1 ms, all others every 10 ms, as the automation system takes them), NAME_SPEED.html (demands, their spectrum with resonance and firing, predicted speeds and torques) and NAME_SPEED_predicted.mf4.

Demands of one's own are a recording with columns named dyno_speed_demand (rpm; dynamometer controls speed) or engine_speed_demand (rpm) with dyno_torque_demand or shaft_torque_demand (Nm; it controls torque), engine_torque_demand (Nm) or throttle_demand (%), and ignition_efficiency (1). Speeds run straight between their stamps, the others are held.

With --optimal, spectrum and phases of a multisine, or the edges of a binary demand, are chosen for the least variance of what is named, on a bench whose resonance is known within ±15 % (with --model: as the study found it), and scaled until the first peak is met. --speed, --duration, --set settling=… and --set torque=… (mean of T_d*, in speed control the engine's torque) say where. Standard errors are those of the best estimator; beside them stand those after white noise with the same peak of the shaft torque. `dynoid experiment check` and `dynoid simulate --experiment` take the file that is written.

The prediction is the linear bench model, of a study with --model, otherwise of what the bench file states ([shaft] resonance or stiffness); what had to be assumed is said. Firing pulses are no part of it; `dynoid simulate bench.toml --experiment NAME` has them.")]
pub(crate) struct DesignArguments {
    #[command(flatten)]
    pub(crate) on: OnBenchArguments,
    /// An experiment of the method, such as BS_T_NT, or a file of demands
    #[arg(value_name = "NAME|FILE", required_unless_present = "optimal", conflicts_with = "optimal")]
    pub(crate) experiment: Option<String>,
    #[command(flatten)]
    pub(crate) optimal: OptimalArguments,
    /// Folder to write to; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "experiments")]
    pub(crate) out: PathBuf,
}

/// The excitation from which chosen parameters are learnt best.
#[derive(Debug, Args)]
#[command(next_help_heading = "Optimal excitation")]
pub(crate) struct OptimalArguments {
    /// In place of NAME: designs the excitation after which these have the least variance, out of K, B, J_d, J_e, PI (speed controller), FF (feed-forward), FOC (torque control)
    #[arg(long, value_name = "WHAT,…", value_delimiter = ',')]
    pub(crate) optimal: Vec<Goal>,
    /// Form of the demand
    #[arg(long, value_enum, default_value_t = Form::Multisine, requires = "optimal")]
    pub(crate) form: Form,
    /// What is excited: T, the torque demand in torque control, or N, the speed demand in speed control [default: N where PI, FF or J_e are asked for]
    #[arg(long, value_enum, value_name = "T|N", ignore_case = true, requires = "optimal")]
    pub(crate) excite: Option<Excite>,
    /// Largest deviation of T_shaft from its mean [default: half of what the limits of the bench file leave; the rest is for firing pulses]
    #[arg(long, value_name = "NM", value_parser = number::positive, requires = "optimal")]
    pub(crate) peak_shaft_torque: Option<f64>,
    /// Largest deviation of T_d from its mean [default: 95 % of what the limits of the bench file leave]
    #[arg(long, value_name = "NM", value_parser = number::positive, requires = "optimal")]
    pub(crate) peak_torque: Option<f64>,
    /// Largest deviation of N_d from its mean
    #[arg(long, value_name = "RPM", value_parser = number::positive, default_value_t = 100.0, requires = "optimal")]
    pub(crate) peak_speed: f64,
}

/// The form of a designed demand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Form {
    Multisine,
    Binary,
}

/// The demand that is excited.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Excite {
    #[value(name = "T")]
    Torque,
    #[value(name = "N")]
    Speed,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid experiment check bench.toml Sine_T_TN --set amplitude=20
  dynoid experiment check bench.toml cycle.csv --model study/study.json --samples 1000
  dynoid experiment check bench.toml BS_T_NT --quiet && echo safe

Many benches are drawn that could be this one, and the experiment is predicted on each. With --model they follow the covariance of the study's estimates; without, the resonance is known within ±20 %, the damping within ±50 % and the engine's inertia within ±10 % of what the bench file states (95 % ranges of log-normal distributions). The speed control of an engine of which [virtual_bench] says nothing has between a tenth of the assumed bandwidth and all of it: the slower it is, the less it damps the resonance.

A limit of [limits] is safe where at most 5 % of the benches reach it and the 95 % interval of that probability ends below 5 % too; risky where only the interval reaches beyond; unsafe otherwise. What is not stated is not checked. For a sine test of T_d* the largest safe amplitude at each frequency is proposed.

The exit code is 0 where all limits stated are safe, and 1 otherwise, also where none is stated. Firing pulses are no part of the prediction: leave room for them.")]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) on: OnBenchArguments,
    /// An experiment of the method, such as Sine_T_TN, or a file of demands
    #[arg(value_name = "NAME|FILE")]
    pub(crate) experiment: String,
    /// Benches drawn; fewer than 72 are never enough for `safe`
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) samples: u32,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid experiment next bench.toml
  dynoid experiment next bench.toml --speed 2000 --duration 120
  dynoid experiment next bench.toml --json | jq '.candidates[0].label'

Each experiment of the method is run on a virtual bench as this one is known to be, with its rasters and the noise of its speeds, and studied beside the recordings there are; the intervals that the study then states are set beside those of now. Where [limits] states shaft_torque, a multisine designed for the shaft within it is tried too. All run at the same speed for the same time.

An interval that gets narrower by less than a fifth counts for nothing: realisations of one experiment differ by as much. Without any recording it needs [shaft] in the bench file.")]
pub(crate) struct NextArguments {
    /// The bench file
    #[arg(value_name = "BENCH.toml")]
    pub(crate) bench: PathBuf,
    /// Speed at which the next experiment would run, rpm
    #[arg(long, value_name = "RPM", value_parser = number::positive, default_value_t = 1200.0)]
    pub(crate) speed: f64,
    /// Its length
    #[arg(long, value_name = "SECONDS", value_parser = number::positive, default_value_t = 60.0)]
    pub(crate) duration: f64,
    /// Per cent of its value within which a number is known well enough: narrowing it further buys nothing
    #[arg(long, value_name = "PERCENT", value_parser = number::positive, default_value_t = 1.0)]
    pub(crate) enough: f64,
    /// Seed of what is random in it
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Prints everything as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(
    mut_arg("model", |arg| arg.value_name("MODEL.json|BENCH.toml").help("A model file, or with --experiment a bench file")),
    mut_arg("on", |arg| arg.required(false)),
    override_usage = "dynoid simulate [OPTIONS] MODEL.json --on RECORDING\n       dynoid simulate [OPTIONS] BENCH.toml --experiment NAME --out FILE",
    after_help = "\
A model, on the inputs of a recording:
  dynoid simulate model.json --on demand.mf4 --out simulated.csv

A bench, in an experiment:
  dynoid simulate bench.toml --experiment BS_T_NT --out recordings/BS_T_NT_1200.mf4
  dynoid simulate bench.toml --experiment Sine_T_TN --speed 2000 --set amplitude=12 --out sine.parquet --truth truth.mf4
  dynoid simulate bench.toml --experiment experiments/Step_T_TN_1200.csv --model study/study.json --out run.mf4

A bench is simulated with firing engine, inverter and sensors, and recorded under the names of [channels], so that `dynoid study run` reads it as the bench's own. It is the default virtual bench with what the bench file states; [virtual_bench] in it sets any other field, as [virtual_bench.mechanics] shaft_backlash_rad = 0.002 does. What really happened is written with --truth alone."
)]
pub(crate) struct SimulateArguments {
    #[command(flatten)]
    pub(crate) run: RunArguments,
    /// Runs an experiment on the bench of a bench file: one of the method, such as BS_T_NT, or a file of demands
    #[arg(
        long,
        value_name = "NAME|FILE",
        conflicts_with_all = ["on", "from_s", "to_s", "sample_time_s", "detrend", "from_rest"],
        help_heading = "Experiment"
    )]
    pub(crate) experiment: Option<String>,
    #[command(flatten)]
    pub(crate) plan: PlanArguments,
    /// Writes what really happened, without sensors, to a recording of its own
    #[arg(long, value_name = "FILE", requires = "experiment", help_heading = "Experiment")]
    pub(crate) truth: Option<PathBuf>,
}
