//! `dynoid inspect`: what recordings hold.

mod apart;
mod facts;
mod print;
mod start_time;

use serde::Serialize;

use crate::cli::inspect::InspectArguments;
use crate::error::{CliError, Outcome};
use crate::input::{self, InputFile, Read};
use crate::terminal::Terminal;
use facts::{File, Listing};

/// What is shown of a file.
#[derive(Serialize)]
#[serde(untagged)]
enum Shown {
    File(File),
    Listing(Listing),
}

pub(crate) fn run(arguments: &InspectArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let files = input::named(&arguments.files)?;
    let mut all = Vec::new();
    let mut unreadable = 0;
    for (index, file) in files.iter().enumerate() {
        match look(file, arguments, terminal) {
            Ok(shown) if arguments.json => all.push(shown),
            Ok(shown) => {
                if index > unreadable {
                    terminal.gap();
                }
                match shown {
                    Shown::File(facts) => print::file(&facts, terminal),
                    Shown::Listing(listing) => print::listing(&listing, terminal),
                }
            }
            Err(error @ CliError::Recording { .. }) => {
                unreadable += 1;
                terminal.error(&error.to_string());
            }
            Err(error) => return Err(error),
        }
    }
    if arguments.json {
        terminal.json(&all)?;
    }
    Ok(if unreadable > 0 { Outcome::SomeUnreadable } else { Outcome::Done })
}

fn look(file: &InputFile, arguments: &InspectArguments, terminal: &Terminal) -> Result<Shown, CliError> {
    if arguments.list {
        let catalogue = input::catalogue(file)?;
        return Ok(Shown::Listing(Listing::of(&file.name, &catalogue, &input::extras(file)?)));
    }
    let progress = terminal.long(&format!("reading {}", file.name));
    let told = |done: u64, all: u64| progress.told(done, all);
    let read = input::read_recording(file, &input::selection(&arguments.channels), None, &told);
    let Read { recording, .. } = read.map_err(|error| match error {
        // There is no option for it here.
        CliError::Recording { source, .. } => CliError::Recording { source, untimed: false },
        other => other,
    })?;
    let sha256 = arguments.json.then(|| input::sha256(file)).transpose()?;
    Ok(Shown::File(File::of(&file.name, sha256, &recording, &input::extras(file)?)))
}
