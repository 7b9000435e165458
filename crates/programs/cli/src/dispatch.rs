//! A command line that is read, and the command that does its work.

use dynoid::Files;

use crate::cli::experiment::ExperimentCommand;
use crate::cli::identify::{DataCommand, ModelCommand};
use crate::cli::shell::ShellCommand;
use crate::cli::{Cli, Command};
use crate::commands::{self, experiment, identify};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// Runs a command, prints its error if it has one, and returns the exit code.
pub(crate) fn run(cli: &Cli, files: Files) -> u8 {
    let mut terminal = Terminal::new(&cli.global, files);
    let outcome = dispatch(&cli.command, &mut terminal).and_then(|outcome| terminal.finish().map(|()| outcome));
    match outcome {
        Ok(outcome) => outcome.code(),
        Err(error) => {
            terminal.error(&error.to_string());
            error.code()
        }
    }
}

fn dispatch(command: &Command, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    match command {
        Command::Init(arguments) => commands::init::run(arguments, terminal),
        Command::Study(arguments) => commands::study::run(arguments, terminal),
        Command::Demo(arguments) => commands::demo::run(arguments, terminal),
        Command::Lines(arguments) => commands::lines::run(arguments, terminal),
        Command::TorqueSignals(arguments) => commands::torque_signals::run(arguments, terminal),
        Command::TorqueControl(arguments) => commands::torque_control::run(arguments, terminal),
        Command::Controller(arguments) => commands::controller::run(arguments, terminal),
        Command::Shaft(arguments) => commands::shaft::run(arguments, terminal),
        Command::Engine(arguments) => commands::engine::run(arguments, terminal),
        Command::Friction(arguments) => commands::friction::run(arguments, terminal),
        Command::Can(arguments) => commands::can::run(arguments, terminal),
        Command::Experiment { command } => match command {
            ExperimentCommand::List(arguments) => experiment::list::run(arguments, terminal),
            ExperimentCommand::Design(arguments) => experiment::design::run(arguments, terminal),
            ExperimentCommand::Check(arguments) => experiment::check::run(arguments, terminal),
            ExperimentCommand::Simulate(arguments) => experiment::simulate::run(arguments, terminal),
            ExperimentCommand::Next(arguments) => experiment::next::run(arguments, terminal),
        },
        Command::Schema(arguments) => commands::schema::run(arguments, terminal),
        Command::Shell { command } => match command {
            ShellCommand::Completions(arguments) => commands::shell::completions(arguments, terminal),
            ShellCommand::Manual(arguments) => commands::shell::manual(arguments, terminal),
        },
        #[cfg(feature = "app")]
        Command::App(arguments) => commands::app::run(arguments, terminal),
        Command::Report(arguments) => commands::report::run(arguments, terminal),
        Command::Diff(arguments) => commands::diff::run(arguments, terminal),
        Command::Export(arguments) => commands::export::run(arguments, terminal),
        Command::Inspect(arguments) => commands::inspect::run(arguments, terminal),
        Command::Convert(arguments) => commands::convert::run(arguments, terminal),
        Command::Data { command } => match command {
            DataCommand::Spectrum(arguments) => identify::explore::spectrum(arguments, terminal),
            DataCommand::Delay(arguments) => identify::explore::delay(arguments, terminal),
            DataCommand::Order(arguments) => identify::explore::order(arguments, terminal),
        },
        Command::Fit { command } => identify::fit::run(command, terminal),
        Command::Model { command } => match command {
            ModelCommand::Bode(arguments) => identify::model::bode(arguments, terminal),
            ModelCommand::Step(arguments) => identify::model::step(arguments, terminal),
            ModelCommand::Poles(arguments) => identify::model::poles(arguments, terminal),
            ModelCommand::Compare(arguments) => identify::judge::compare(arguments, terminal),
            ModelCommand::Residuals(arguments) => identify::judge::residuals(arguments, terminal),
            ModelCommand::Predict(arguments) => identify::judge::predict(arguments, terminal),
            ModelCommand::Simulate(arguments) => identify::judge::simulate(arguments, terminal),
            ModelCommand::Convert(arguments) => identify::convert::convert(arguments, terminal),
        },
    }
}
