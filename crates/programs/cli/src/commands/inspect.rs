//! `dynoid inspect`: what recordings hold.

use dataset::inspection::{File, Listing};
use dynoid::{Error, InputFile};
use report::inspection;
use serde::Serialize;

use crate::cli::inspect::InspectArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// Content of a file that is shown.
#[derive(Serialize)]
#[serde(untagged)]
enum Shown {
    File(File),
    Listing(Listing),
}

pub(crate) fn run(arguments: &InspectArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let files = terminal.files().named(&arguments.files)?;
    let mut all = Vec::new();
    let mut unreadable = 0;
    for (index, file) in files.iter().enumerate() {
        match look(file, arguments, terminal) {
            Ok(shown) if arguments.json => all.push(shown),
            Ok(shown) => {
                if index > unreadable {
                    terminal.gap();
                }
                terminal.page(&match shown {
                    Shown::File(facts) => inspection::file(&facts),
                    Shown::Listing(listing) => inspection::listing(&listing),
                });
            }
            Err(error @ CliError::Door { source: Error::Recording { .. } }) => {
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
    let files = terminal.files();
    if arguments.list {
        return Ok(Shown::Listing(files.list(file)?));
    }
    let read = files.inspect(file, &dynoid::selection(&arguments.channels), terminal.work());
    let facts = read.map_err(|error| match error {
        // There is no option for it here.
        Error::Recording { source, .. } => Error::Recording { source, untimed: false },
        other => other,
    })?;
    let sha256 = arguments.json.then(|| files.sha256(file)).transpose()?;
    Ok(Shown::File(File { sha256, ..facts }))
}
