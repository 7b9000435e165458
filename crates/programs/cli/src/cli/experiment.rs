//! Arguments of `dynoid experiment`.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use design::excitation_design::Goal;
use dynoid::Draws;
use dynoid::experiments::Given;

use super::identify::ResultArguments;
use super::number;
use crate::error::CliError;

pub(crate) const EXAMPLES: &str = "\
Examples:
  dynoid experiment list
  dynoid experiment design bench.toml BS_T_NT
  dynoid experiment check bench.toml BS_T_NT
  dynoid experiment simulate bench.toml BS_T_NT --out run.mf4

Names: {test}_{T|N}_{NT|TN}. T or N is what is excited, torque or speed. NT: the dynamometer controls speed, the engine torque; TN: the reverse.";

/// Steps with an experiment before it is run on the bench.
#[derive(Debug, Subcommand)]
pub(crate) enum ExperimentCommand {
    /// List the experiments of the method with their parameters
    List(ListArguments),
    /// Write the demands of an experiment, and predict speeds and torques
    Design(DesignArguments),
    /// Compute how probably an experiment exceeds a limit of the bench
    Check(CheckArguments),
    /// Simulate an experiment on a virtual bench, and record it
    Simulate(SimulateArguments),
    /// Find the experiment that improves the estimates most
    Next(NextArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid experiment list
  dynoid experiment list BS_T_NT
  dynoid experiment list sine-sweep
  dynoid experiment list --json | jq '.experiments[].label'

NAME is an experiment of the method, or a shape of `dynoid can`.")]
pub(crate) struct ListArguments {
    /// Only this experiment or shape, with its parameters
    #[arg(value_name = "NAME")]
    pub(crate) name: Option<String>,
    /// Print everything as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// The numbers of an experiment.
#[derive(Debug, Clone, Args)]
pub(crate) struct PlanArguments {
    /// Speed, rpm: the constant speed, or the first one
    #[arg(long, value_name = "RPM", value_parser = number::rpm, help_heading = "Experiment")]
    pub(crate) speed: Option<f64>,
    /// Length of the recording
    #[arg(long, value_name = "SECONDS", value_parser = number::positive_seconds, help_heading = "Experiment")]
    pub(crate) duration: Option<f64>,
    /// Another parameter, such as low=35 or low="35 Nm"; repeat it for more. `dynoid experiment list NAME` shows them
    #[arg(long = "set", value_name = "NAME=VALUE", help_heading = "Experiment")]
    pub(crate) set: Vec<String>,
    /// Seed of demands and bench; the same seed gives the same bytes [default: 1]
    #[arg(long, value_name = "N", value_parser = number::seed, help_heading = "Experiment")]
    pub(crate) seed: Option<u64>,
    /// Take inertias, shaft, speed controller, feed-forward and torque control from a model.json, a study.json or an
    /// FMU of dynoid instead of the bench file
    #[arg(long = "model", value_name = "MODEL.json", help_heading = "Experiment")]
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

    /// Names and values that were given, in either way.
    pub(crate) fn given(&self) -> Result<Vec<Given>, CliError> {
        let number = |name: &str, value: Option<f64>| {
            value.map(|value| Given { name: name.to_owned(), value: value.to_string() })
        };
        let named = |text: &String| match text.split_once('=') {
            Some((name, value)) => Ok(Given { name: name.to_owned(), value: value.to_owned() }),
            None => {
                let what = format!("--set {text}: write it as NAME=VALUE, such as --set low=35");
                Err(CliError::Usage { what })
            }
        };
        let numbers = [number("speed", self.speed), number("duration", self.duration)].into_iter().flatten();
        numbers.map(Ok).chain(self.set.iter().map(named)).collect()
    }
}

impl OnBenchArguments {
    /// So many benches.
    pub(crate) fn draws(&self, benches: u32) -> Draws {
        Draws { benches: benches as usize, seed: self.plan.seed() }
    }
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid experiment design bench.toml BS_T_NT --speed 1500 --set high=55
  dynoid experiment design bench.toml Multisine_T_TN --model study/model.json
  dynoid experiment design bench.toml cycle.csv --out cycle
  dynoid experiment design bench.toml --optimal K,B --speed 1500
  dynoid experiment design bench.toml --optimal PI,FF --form binary

Files written:
  NAME_SPEED.csv and .mf4   the demands: speeds every 1 ms, all others every 10 ms, in text
                            held every 1 ms
  NAME_SPEED.html           figures of demands, their spectrum, and the prediction
  NAME_SPEED_predicted.mf4  predicted speeds and torques

Your own demands are a recording with these columns:
  dyno_speed_demand (rpm), if the dynamometer controls speed
  engine_speed_demand (rpm) with dyno_torque_demand or shaft_torque_demand (Nm),
    if it controls torque
  engine_torque_demand (Nm) or throttle_demand (%), ignition_efficiency (1)

Speeds are linear between their time stamps; the others are held.

--optimal chooses the spectrum and phases of a multisine, or the edges of a binary demand, for the least variance of the named parameters. Without --model the resonance is known within ±15 %. The demand is scaled until the first limit is met. --speed, --duration, --set settling=… and --set torque=… (mean of T_d*, in speed control of the engine torque) give the operating point. The standard errors are those of the best estimator, compared with white noise of the same peak shaft torque.

The prediction uses the linear bench model of a study (--model), or the values of the bench file ([shaft] resonance or stiffness); assumptions are listed. It has no firing pulses; `dynoid experiment simulate` has them.")]
pub(crate) struct DesignArguments {
    #[command(flatten)]
    pub(crate) on: OnBenchArguments,
    /// An experiment of the method, such as BS_T_NT, or a file of demands
    #[arg(value_name = "NAME|FILE", required_unless_present = "optimal", conflicts_with = "optimal")]
    pub(crate) experiment: Option<String>,
    /// Folder to write to; created if it does not exist
    #[arg(long, value_name = "DIR", default_value = "experiments")]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) optimal: OptimalArguments,
}

/// The excitation that gives chosen parameters the least variance.
#[derive(Debug, Args)]
#[command(next_help_heading = "Optimal excitation")]
pub(crate) struct OptimalArguments {
    /// Instead of NAME: design the excitation for the least variance of these, out of K, B, J_d, J_e, PI (speed
    /// controller), FF (feed-forward), TC (torque control)
    #[arg(long, value_name = "WHAT,…", value_delimiter = ',')]
    pub(crate) optimal: Vec<Goal>,
    /// Form of the demand
    #[arg(long, value_enum, default_value_t = Form::Multisine, requires = "optimal")]
    pub(crate) form: Form,
    /// Excite T, the torque demand in torque control, or N, the speed demand in speed control
    /// [default: N for PI, FF or J_e]
    #[arg(long, value_enum, value_name = "T|N", ignore_case = true, requires = "optimal")]
    pub(crate) excite: Option<Excite>,
    /// Largest deviation of T_shaft from its mean
    /// [default: half of the range within the limits; the rest is for firing pulses]
    #[arg(long, value_name = "NM", value_parser = number::positive_nm, requires = "optimal")]
    pub(crate) peak_shaft_torque: Option<f64>,
    /// Largest deviation of T_d from its mean [default: 95 % of the range within the limits]
    #[arg(long, value_name = "NM", value_parser = number::positive_nm, requires = "optimal")]
    pub(crate) peak_torque: Option<f64>,
    /// Largest deviation of N_d from its mean
    #[arg(long, value_name = "RPM", value_parser = number::positive_rpm, default_value_t = 100.0, requires = "optimal")]
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
  dynoid experiment check bench.toml cycle.csv --samples 1000
  dynoid experiment check bench.toml BS_T_NT --quiet && echo safe

The command predicts the experiment on many random benches. With --model they follow the covariance of the study's estimates. Without it, they spread around the bench file (95 % ranges, log-normal): resonance ±20 %, damping ±50 %, engine inertia ±10 %. If [virtual_bench] does not describe the engine's speed control, its bandwidth is between a tenth of the usual value and that value. A slower one damps the resonance less.

A limit of [limits] is safe if at most 5 % of the benches reach it, and the 95 % interval of that share ends below 5 %. It is risky if only the interval ends above, and unsafe otherwise. The verdict counts the benches that reach any limit. Where a limit is not stated, the verdict says so. For a sine test of T_d* the command proposes the largest safe amplitude at each frequency.

The exit code is 0 if all limits are stated and safe, and 1 otherwise. With --allow-unchecked, limits that are not stated do not count. An engine that fires adds its pulses, with the harmonics and cylinders of [virtual_bench.engine] or those of the default virtual bench.")]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) on: OnBenchArguments,
    /// An experiment of the method, such as Sine_T_TN, or a file of demands
    #[arg(value_name = "NAME|FILE")]
    pub(crate) experiment: String,
    /// Number of random benches; fewer than 72 never suffice for `safe`
    #[arg(long, value_name = "N", default_value_t = 200, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub(crate) samples: u32,
    /// Exit with 0 although the bench file does not state every limit
    #[arg(long)]
    pub(crate) allow_unchecked: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid experiment next bench.toml
  dynoid experiment next bench.toml --speed 2000 --duration 120
  dynoid experiment next bench.toml --json | jq '.candidates[0].label'

The command simulates each experiment of the method on a virtual bench with the known parameters, rasters and speed noise of this bench. It studies each simulated recording together with the real ones, and compares the new intervals with the present ones. All experiments have the same speed and length. With a limit of shaft_torque in [limits], a multisine designed for the shaft is tried too.

An interval that shrinks by less than a fifth does not count, because repetitions of one experiment differ by as much. Without recordings the bench file needs [shaft].")]
pub(crate) struct NextArguments {
    /// The bench file
    #[arg(value_name = "BENCH.toml")]
    pub(crate) bench: PathBuf,
    /// Speed of the next experiment, rpm
    #[arg(long, value_name = "RPM", value_parser = number::positive_rpm, default_value_t = 1200.0)]
    pub(crate) speed: f64,
    /// Length of the recording
    #[arg(long, value_name = "SECONDS", value_parser = number::positive_seconds, default_value_t = 60.0)]
    pub(crate) duration: f64,
    /// A parameter is known well enough if its interval is within this many per cent
    #[arg(long, value_name = "PERCENT", value_parser = number::percent, default_value_t = 1.0)]
    pub(crate) enough: f64,
    /// Seed of the simulations
    #[arg(long, value_name = "N", value_parser = number::seed, default_value_t = 1)]
    pub(crate) seed: u64,
    /// Print everything as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid experiment simulate bench.toml BS_T_NT --out BS_T_NT_1200.mf4
  dynoid experiment simulate bench.toml Sine_T_TN --speed 2000 --out sine.csv
  dynoid experiment simulate bench.toml BS_T_NT --out a.mf4 --truth truth.mf4
  dynoid experiment simulate bench.toml cycle.csv --out cycle.mf4

The virtual bench has a firing engine, torque control and sensors. Its channels have the names of [channels], so that `dynoid study` reads the recording like one of the real bench. It is the default virtual bench with the values of the bench file. The table [virtual_bench] sets every other value, such as [virtual_bench.mechanics] shaft_backlash_rad = 0.002.

Only --truth writes the true signals.")]
pub(crate) struct SimulateArguments {
    #[command(flatten)]
    pub(crate) on: OnBenchArguments,
    /// An experiment of the method, such as BS_T_NT, or a file of demands
    #[arg(value_name = "NAME|FILE")]
    pub(crate) experiment: String,
    /// Write the recording; its ending gives the format: .mf4, .csv, .tsv, .mat, .parquet or .arrow
    #[arg(long, short, value_name = "FILE")]
    pub(crate) out: Option<PathBuf>,
    /// Write the true signals, without sensors, to a recording of their own
    #[arg(long, value_name = "FILE")]
    pub(crate) truth: Option<PathBuf>,
}
