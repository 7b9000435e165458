//! `dynoid inspect`: what recordings hold.

mod facts;
mod print;
mod start_time;

use crate::cli::InspectArguments;
use crate::error::{CliError, Outcome};
use crate::input;
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &InspectArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let files = input::named(&arguments.files)?;
    let mut all = Vec::new();
    let mut unreadable = 0;
    for (index, file) in files.iter().enumerate() {
        let source = input::read_source(file)?;
        match source.recording {
            Ok(recording) => {
                let facts = facts::File::of(&source.file, source.sha256, &recording);
                if arguments.json {
                    all.push(facts);
                } else {
                    if index > unreadable {
                        terminal.gap();
                    }
                    print::file(&facts, terminal);
                }
            }
            Err(error) => {
                unreadable += 1;
                terminal.error(&error.to_string());
            }
        }
    }
    if arguments.json {
        terminal.json(&all)?;
    }
    Ok(if unreadable > 0 { Outcome::SomeUnreadable } else { Outcome::Done })
}
