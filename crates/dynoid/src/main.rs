//! The program: recordings of a dynamometer test bench in, a validated bench model out.
//!
//! This crate opens and writes files, talks to the person at the terminal, and calls the other crates; it holds no
//! formulas. One module a command; [`terminal`] alone prints, [`output`] alone writes files, [`input`] alone finds and
//! reads them.

#![warn(missing_docs)]

mod cli;
mod commands;
mod error;
mod formats;
mod input;
mod output;
mod summary;
mod table;
mod terminal;

use std::process::ExitCode;

use crate::cli::experiment::ExperimentCommand;
use crate::cli::{Cli, Command, StudyCommand};
use crate::commands::identify;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

fn main() -> ExitCode {
    let outcome = std::panic::catch_unwind(|| run(Cli::read()));
    outcome.unwrap_or(ExitCode::from(error::INTERNAL))
}

fn run(cli: Cli) -> ExitCode {
    let mut terminal = Terminal::new(&cli.global);
    let outcome = dispatch(&cli.command, &mut terminal).and_then(|outcome| terminal.finish().map(|()| outcome));
    match outcome {
        Ok(outcome) => ExitCode::from(outcome.code()),
        Err(error) => {
            terminal.error(&error.to_string());
            ExitCode::from(error.code())
        }
    }
}

fn dispatch(command: &Command, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    match command {
        Command::Demo(arguments) => commands::demo::run(arguments, terminal),
        Command::Study { command: StudyCommand::Run(arguments) } => commands::study::run(arguments, terminal),
        Command::Experiment { command: ExperimentCommand::List(arguments) } => {
            commands::experiment::list::run(arguments, terminal)
        }
        Command::Experiment { command: ExperimentCommand::Design(arguments) } => {
            commands::experiment::design::run(arguments, terminal)
        }
        Command::Experiment { command: ExperimentCommand::Check(arguments) } => {
            commands::experiment::check::run(arguments, terminal)
        }
        Command::Experiment { command: ExperimentCommand::Next(arguments) } => {
            commands::experiment::next::run(arguments, terminal)
        }
        Command::Init(arguments) => commands::init::run(arguments, terminal),
        Command::Look(arguments) => commands::look::run(arguments, terminal),
        Command::Shaft(arguments) => commands::shaft::run(arguments, terminal),
        Command::Torque(arguments) => commands::torque::run(arguments, terminal),
        Command::Engine(arguments) => commands::engine::run(arguments, terminal),
        Command::Controller(arguments) => commands::controller::run(arguments, terminal),
        Command::Inverter(arguments) => commands::inverter::run(arguments, terminal),
        Command::Friction(arguments) => commands::friction::run(arguments, terminal),
        Command::Inspect(arguments) => commands::inspect::run(arguments, terminal),
        Command::Fit { command } => identify::fit::run(command, terminal),
        Command::Compare(arguments) => identify::judge::compare(arguments, terminal),
        Command::Resid(arguments) => identify::judge::resid(arguments, terminal),
        Command::Simulate(arguments) => commands::simulate::run(arguments, terminal),
        Command::Predict(arguments) => identify::judge::predict_model(arguments, terminal),
        Command::Bode(arguments) => identify::look::bode(arguments, terminal),
        Command::Step(arguments) => identify::look::step(arguments, terminal),
        Command::Poles(arguments) => identify::look::poles(arguments, terminal),
        Command::Convert(arguments) => commands::convert::run(arguments, terminal),
        Command::Spectrum(arguments) => identify::explore::spectrum(arguments, terminal),
        Command::Delay(arguments) => identify::explore::delay(arguments, terminal),
        Command::Order(arguments) => identify::explore::order(arguments, terminal),
    }
}
