//! The command line: commands, options, help.

#[cfg(feature = "app")]
pub(crate) mod app;
pub(crate) mod bench;
pub(crate) mod can;
pub(crate) mod controller;
pub(crate) mod convert;
#[cfg(feature = "app")]
mod described;
pub(crate) mod diff;
pub(crate) mod engine;
pub(crate) mod experiment;
pub(crate) mod export;
mod files;
pub(crate) mod friction;
mod given;
pub(crate) mod identify;
pub(crate) mod inspect;
pub(crate) mod lines;
mod number;
mod overview;
pub(crate) mod report;
pub(crate) mod schema;
pub(crate) mod shaft;
pub(crate) mod shell;
mod suggest;
pub(crate) mod torque_control;
pub(crate) mod torque_signals;

use std::ffi::{OsStr, OsString};

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};
use dynoid::Files;

pub(crate) use given::GivenRecordings;

/// Turn recordings of a dynamometer test bench into a validated simulation model
#[derive(Debug, Parser)]
#[command(name = "dynoid", version, arg_required_else_help = true)]
pub(crate) struct Cli {
    #[command(flatten)]
    pub(crate) global: Global,
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Cli {
    /// The command line that these arguments are, and the files of this run; on a wrong one, and for help, the program
    /// ends here.
    pub(crate) fn read(arguments: Vec<OsString>) -> (Self, Files) {
        let command = overview::grouped(negative_numbers(Cli::command()));
        let arguments = json_last(arguments);
        let matches = command
            .clone()
            .try_get_matches_from(arguments)
            .unwrap_or_else(|error| suggest::improved(error, &command).exit());
        let cli = Cli::from_arg_matches(&matches).unwrap_or_else(|error| error.exit());
        let (words, inputs) = files::given(&command, &matches);
        let run = Files::new(&words, cli.global.overwrite);
        inputs.iter().for_each(|path| run.reads(path));
        (cli, run)
    }

    /// The commands as data.
    #[cfg(feature = "app")]
    pub(crate) fn described() -> Vec<described::Described> {
        described::described(&Cli::command())
    }

    /// Tells whether a word is the name of a command.
    pub(crate) fn is_command(word: &OsStr) -> bool {
        Cli::command().find_subcommand(word).is_some() || word == "help"
    }
}

/// The arguments with `--json` behind all options, so that it may stand anywhere: the command that it belongs to comes
/// first.
fn json_last(arguments: Vec<OsString>) -> Vec<OsString> {
    let end = arguments.iter().position(|word| word == "--").unwrap_or(arguments.len());
    let (options, rest) = arguments.split_at(end);
    let (json, others): (Vec<&OsString>, Vec<&OsString>) = options.iter().partition(|word| *word == "--json");
    others.into_iter().chain(json).chain(rest).cloned().collect()
}

/// Takes what looks like a negative number for a value, not for an option, so that what is said of it makes sense.
fn negative_numbers(command: clap::Command) -> clap::Command {
    let takes_values = |arg: &clap::Arg| arg.get_long().is_some() && arg.get_action().takes_values();
    let args = command.mut_args(|arg| if takes_values(&arg) { arg.allow_negative_numbers(true) } else { arg });
    args.mut_subcommands(negative_numbers)
}

#[derive(Debug, Default, Args)]
pub(crate) struct Global {
    /// Show no progress and no summary; warnings and errors stay
    #[arg(long, short, global = true, help_heading = "Global options")]
    pub(crate) quiet: bool,
    /// Show every line of a result on a terminal, not the first 40
    #[arg(long, global = true, help_heading = "Global options")]
    pub(crate) all: bool,
    /// Replace files that are there, whoever wrote them; never a file that the command reads
    #[arg(long, global = true, help_heading = "Global options")]
    pub(crate) overwrite: bool,
    /// Use colour; `auto`: on a terminal, unless NO_COLOR is set
    #[arg(
        long,
        global = true,
        value_enum,
        default_value_t = ColorWhen::Auto,
        value_name = "WHEN",
        help_heading = "Global options"
    )]
    pub(crate) color: ColorWhen,
    /// How progress is shown on standard error: `auto`, a bar on a terminal; `json`, lines for programs
    #[arg(
        long,
        global = true,
        value_enum,
        default_value_t = ProgressForm::Auto,
        value_name = "FORM",
        help_heading = "Global options"
    )]
    pub(crate) progress: ProgressForm,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ProgressForm {
    #[default]
    Auto,
    Json,
}

#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColorWhen {
    #[default]
    Auto,
    Always,
    Never,
}

/// The commands. [`overview`] has their order and headings in the help.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Propose a bench file from recordings
    Init(bench::InitArguments),
    /// Estimate and judge the whole bench, and write the report
    Study(bench::StudyArguments),
    /// Open the app: recordings, studies and reports in the browser
    #[cfg(feature = "app")]
    App(app::AppArguments),
    /// Write the report of a study.json again, without recordings
    Report(report::ReportArguments),
    /// Study a simulated bench and compare with its known parameters
    Demo(bench::DemoArguments),
    /// Name the lines in the spectra: orders, aliases, ripple
    Lines(lines::LinesArguments),
    /// Find delays and filters of the torque signals
    TorqueSignals(torque_signals::TorqueSignalsArguments),
    /// Compare models of the torque control, T_d* to T_d
    TorqueControl(torque_control::TorqueControlArguments),
    /// Examine the speed controller and its feed-forward
    Controller(controller::ControllerArguments),
    /// Estimate stiffness and damping of the shaft, and both inertias
    Shaft(shaft::ShaftArguments),
    /// Reconstruct the engine torque, by cycle and by cylinder
    Engine(engine::EngineArguments),
    /// Estimate friction and inertia of the dynamometer
    Friction(friction::FrictionArguments),
    /// Can this bench run this test? Was this run of it valid?
    Can(can::CanArguments),
    /// Plan experiments: list, design, check, simulate, next
    #[command(after_help = experiment::EXAMPLES)]
    Experiment {
        #[command(subcommand)]
        command: experiment::ExperimentCommand,
    },
    /// Test whether a bench has changed: two bench models
    Diff(diff::DiffArguments),
    /// Export a model: FMU, MATLAB, Modelica, Python, C or SSP
    Export(export::ExportArguments),
    /// Show what recordings hold: channels, units, clocks, gaps
    Inspect(inspect::InspectArguments),
    /// Write recordings in another format, cut or resampled
    Convert(convert::ConvertArguments),
    /// Explore data before a fit: spectrum, delay, order
    #[command(after_help = identify::DATA_EXAMPLES)]
    Data {
        #[command(subcommand)]
        command: identify::DataCommand,
    },
    /// Fit models: arx, armax, oe, bj, poly, tf, process, ss, greybox
    #[command(after_help = identify::FIT_EXAMPLES)]
    Fit {
        #[command(subcommand)]
        command: identify::FitCommand,
    },
    /// Use fitted models: bode, step, poles, compare, residuals, …
    #[command(after_help = identify::MODEL_EXAMPLES)]
    Model {
        #[command(subcommand)]
        command: identify::ModelCommand,
    },
    /// Print the JSON schema of an output, or list the schemas
    Schema(schema::SchemaArguments),
    /// Set up your shell: completions, manual
    #[command(after_help = shell::EXAMPLES)]
    Shell {
        #[command(subcommand)]
        command: shell::ShellCommand,
    },
}
