//! The program: recordings of a dynamometer test bench in, a validated bench model out.
//!
//! This crate reads arguments, talks to the person at the terminal, and calls the library `dynoid` and the crates below
//! it; it holds no formulas. One module a command. `terminal` alone prints, and the library alone reads and writes
//! files.

#![warn(missing_docs)]

mod cli;
mod commands;
mod dispatch;
mod dropped;
mod error;
#[cfg(feature = "app")]
mod job;
mod path;
mod summary;
mod terminal;

use std::ffi::OsString;

use crate::cli::Cli;
use crate::terminal::Terminal;

/// Runs the program with these arguments, of which the first is its name, and returns its exit code. Wrong arguments
/// and calls for help end the process.
pub fn main(arguments: Vec<OsString>) -> u8 {
    #[cfg(feature = "app")]
    if let Some(folder) = job::folder(&arguments) {
        return job::run(&folder, main);
    }
    dynoid::remove_when_ended();
    let dropped = dropped::folder(&arguments);
    let outcome = std::panic::catch_unwind(|| match &dropped {
        Some(folder) => dropped::study(folder),
        None => {
            let (cli, files) = Cli::read(arguments);
            dispatch::run(&cli, files)
        }
    });
    if dropped.is_some() {
        Terminal::wait_if_it_closes();
    }
    outcome.unwrap_or(error::INTERNAL)
}
