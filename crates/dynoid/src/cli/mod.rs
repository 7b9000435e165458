//! The command line: commands, options, help.

pub(crate) mod controller;
pub(crate) mod convert;
pub(crate) mod engine;
pub(crate) mod experiment;
pub(crate) mod friction;
pub(crate) mod greybox;
pub(crate) mod identify;
pub(crate) mod inverter;
pub(crate) mod look;
mod number;
pub(crate) mod shaft;
pub(crate) mod torque;

use std::path::PathBuf;

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};

const EXIT_CODES: &str = "\
Exit codes:
  0  done
  1  done, but the verdict is bad: data insufficient for a model, or an experiment not safe
  2  the command line is wrong
  3  an input cannot be read or understood
  4  an output cannot be written
  5  a fault in dynoid itself

A new bench, in three steps:
  dynoid init recordings/        proposes bench.toml; fill in cylinders and inertias
  dynoid study run bench.toml    estimates, judges and writes study/report.html
  dynoid inspect FILE            looks into a recording that causes trouble
  dynoid look bench.toml         names every line in the spectra: firing, folding, ripple
  dynoid torque bench.toml       how late each torque signal is, and the real shaft torque
  dynoid shaft bench.toml        stiffness and damping by recording, band and route
  dynoid engine bench.toml       the engine's torque, by cycle and by cylinder
  dynoid controller bench.toml   the speed controller, and what may be hidden in it
  dynoid inverter bench.toml     what stands between T_d* and T_d, and what would show more
  dynoid friction bench.toml     friction and inertia, from recordings without shaft

An experiment, before it is run:
  dynoid experiment list         what there is, and what can be set
  dynoid experiment design bench.toml BS_T_NT
                                 writes its demands, and predicts what the bench will do
  dynoid experiment check bench.toml BS_T_NT
                                 how probably it exceeds a limit of the bench
  dynoid simulate bench.toml --experiment BS_T_NT --out run.mf4
                                 runs it on a virtual bench

To see what comes out, without recordings of your own: dynoid demo";

/// Turns the recordings of a dynamometer test bench into a validated simulation model of that bench
#[derive(Debug, Parser)]
#[command(name = "dynoid", version, after_help = EXIT_CODES, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: Global,
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Cli {
    /// The command line this program was started with; on a wrong one, and for help, the program ends here.
    pub(crate) fn read() -> Self {
        let matches = negative_numbers(Cli::command()).get_matches();
        Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
    }
}

/// Takes what looks like a negative number for a value, not for an option, so that what is said of it makes sense.
fn negative_numbers(command: clap::Command) -> clap::Command {
    let takes_values = |arg: &clap::Arg| arg.get_long().is_some() && arg.get_action().takes_values();
    let args = command.mut_args(|arg| if takes_values(&arg) { arg.allow_negative_numbers(true) } else { arg });
    args.mut_subcommands(negative_numbers)
}

#[derive(Debug, Args)]
pub(crate) struct Global {
    /// Shows no progress and no summary; warnings and errors stay
    #[arg(long, short, global = true, help_heading = "Global options")]
    pub(crate) quiet: bool,
    /// When to use colour; `auto`: on a terminal, unless NO_COLOR is set
    #[arg(long, global = true, value_enum, default_value_t = ColorWhen::Auto, value_name = "WHEN", help_heading = "Global options")]
    pub(crate) color: ColorWhen,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorWhen {
    Auto,
    Always,
    Never,
}

/// A bench file, and recordings of that bench.
#[derive(Debug, Args)]
pub(crate) struct GivenRecordings {
    /// The bench file: channels, cylinders, and where the recordings are
    #[arg(value_name = "BENCH.toml")]
    pub(crate) bench: PathBuf,
    /// Recordings, or folders of recordings [default: those of the bench file]
    #[arg(value_name = "RECORDING")]
    pub(crate) recordings: Vec<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Simulates a bench whose every parameter is known, studies its recordings, and compares
    Demo(DemoArguments),
    /// Studies a campaign of recordings
    Study {
        #[command(subcommand)]
        command: StudyCommand,
    },
    /// Experiments of the method: what there is, and demands with predictions before one is run
    Experiment {
        #[command(subcommand)]
        command: experiment::ExperimentCommand,
    },
    /// Proposes a bench file from recordings: which channel plays which role
    Init(InitArguments),
    /// Shows what recordings hold: channels, units, clocks, gaps, values
    Inspect(InspectArguments),
    /// Names the lines in the spectra of recordings: orders, folds, images of the demand, ripple, resonances
    Look(look::LookArguments),
    /// Holds the torque signals against each other: delays, filters, load cell; rebuilds the shaft torque
    Torque(torque::TorqueArguments),
    /// Estimates the shaft from every recording: by band, with both inertias, against backlash and its like, and from all together
    Shaft(shaft::ShaftArguments),
    /// Rebuilds the engine's torque with its uncertainty, by cycle and by cylinder
    Engine(engine::EngineArguments),
    /// Looks into the speed controller: PI, delay, hidden terms, limit, feed-forward; with `study` into what noise does to it
    Controller(controller::ControllerArguments),
    /// Holds models of the torque control against a delay of one sample: lag, ARX, output error of many orders
    Inverter(inverter::InverterArguments),
    /// Estimates friction and inertia of the dynamometer from recordings without shaft
    Friction(friction::FrictionArguments),
    /// Estimates a linear model from any channels of any recordings
    Fit {
        #[command(subcommand)]
        command: identify::FitCommand,
    },
    /// Holds models against recordings, side by side
    Compare(identify::CompareArguments),
    /// Tests whether a model's residuals are white and independent of the inputs
    Resid(identify::ResidArguments),
    /// Simulates a model on the inputs of a recording, or with --experiment a whole bench
    Simulate(experiment::SimulateArguments),
    /// Predicts the outputs of a recording some samples ahead
    Predict(identify::PredictArguments),
    /// Frequency responses of models, with bands
    Bode(identify::CurveArguments),
    /// Step responses of models, with bands
    Step(identify::CurveArguments),
    /// Poles and zeros of models, with regions
    Poles(identify::ModelArguments),
    /// Writes recordings in another format, cut and resampled on the way, or a model in another form
    Convert(convert::ConvertArguments),
    /// Spectra of channels, and frequency responses between them
    Spectrum(identify::SpectrumArguments),
    /// Delay from inputs to an output
    Delay(identify::DelayArguments),
    /// Order and delay of an ARX model, by several criteria
    Order(identify::OrderArguments),
}

#[derive(Debug, Subcommand)]
pub(crate) enum StudyCommand {
    /// Estimates every part of the bench that the recordings allow, judges it, and writes the report
    Run(StudyRunArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid demo
  dynoid demo --out /tmp/bench --seed 7
  dynoid demo --json | jq '.comparison[] | select(.contains_truth | not)'

The folder then holds recordings/*.mf4, bench.toml, report.html, effects.html and study.json; try things out in bench.toml: leave recordings away, change an inertia, and run `dynoid study run` on it.")]
pub(crate) struct DemoArguments {
    /// Folder to write to; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "dynoid-demo")]
    pub(crate) out: PathBuf,
    /// Seed of the simulation's randomness; the same seed gives the same recordings
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Prints the comparison as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid study run bench.toml
  dynoid study run cell4/bench.toml --out results/2026-05-03
  dynoid study run bench.toml --full
  dynoid study run bench.toml --json | jq .verdict.level

Writes report.html (one file, opens in any browser) and study.json (every number, for programs). Results already there are replaced only when the new ones are complete. A bench file is proposed by `dynoid init`.

With --full the report also holds what `dynoid look`, `torque`, `controller`, `controller study`, `inverter`, `friction`, `shaft`, `engine` and `experiment next` tell of the same recordings, each at its place. It takes minutes where the study takes seconds. What lacks its recording is named with the experiment that would give it.")]
pub(crate) struct StudyRunArguments {
    /// The bench file: what is known of the bench, its channels, and its recordings
    #[arg(value_name = "BENCH.toml")]
    pub(crate) bench: PathBuf,
    /// Folder for the results [default: study/ beside the bench file]
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,
    /// Makes all analyses of the recordings part of the report
    #[arg(long)]
    pub(crate) full: bool,
    /// Prints verdict, estimates and findings as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid init recordings/
  dynoid init monday/*.mf4 tuesday/*.mf4 --out cell4.toml

Nothing in a study rests on a guess: look the proposal over, and fill in what no recording can tell (cylinders and inertias).")]
pub(crate) struct InitArguments {
    /// Recordings, or folders of recordings (MDF, CSV, MAT, HDF5, Parquet, Arrow)
    #[arg(value_name = "RECORDINGS", required = true)]
    pub(crate) recordings: Vec<PathBuf>,
    /// The bench file to write
    #[arg(long, value_name = "FILE", default_value = "bench.toml")]
    pub(crate) out: PathBuf,
    /// Replaces a bench file that is already there
    #[arg(long)]
    pub(crate) force: bool,
    /// Prints the proposal as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dynoid inspect BS_T_NT_1200.mf4
  dynoid inspect recordings/ | less
  dynoid inspect huge.mf4 --list
  dynoid inspect huge.mf4 --channels 'DynoSpeed,*Torque*'
  dynoid inspect run.mf4 --json | jq '.[].rasters[].channels[].name'")]
pub(crate) struct InspectArguments {
    /// Recordings, or folders of recordings
    #[arg(value_name = "FILE", required = true)]
    pub(crate) files: Vec<PathBuf>,
    /// Lists channels and rasters alone, without reading samples
    #[arg(long)]
    pub(crate) list: bool,
    /// Only channels of these names; `*` stands for any characters, `?` for one
    #[arg(long, value_name = "NAMES", value_delimiter = ',', conflicts_with = "list")]
    pub(crate) channels: Vec<String>,
    /// Prints everything as JSON
    #[arg(long)]
    pub(crate) json: bool,
}
