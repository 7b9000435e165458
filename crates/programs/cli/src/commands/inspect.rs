//! `dynoid inspect`: what recordings hold.

use dataset::inspection::{File, Listing};
use dynoid::{Error, InputFile, Read};
use report::inspection;
use rig::ExperimentLabel;
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
    if arguments.list {
        let catalogue = terminal.files().catalogue(file)?;
        return Ok(Shown::Listing(Listing::of(
            &file.name,
            label(&file.name),
            &catalogue,
            &terminal.files().extras(file)?,
        )));
    }
    let step = terminal.work().step(format!("reading {}", file.name), 0);
    let read = terminal.files().read_recording(file, &dynoid::selection(&arguments.channels), None, &step);
    let Read { recording, .. } = read.map_err(|error| match error {
        // There is no option for it here.
        Error::Recording { source, .. } => Error::Recording { source, untimed: false },
        other => other,
    })?;
    let sha256 = arguments.json.then(|| terminal.files().sha256(file)).transpose()?;
    let facts = File::of(&file.name, label(&file.name), &recording, &terminal.files().extras(file)?);
    Ok(Shown::File(File { sha256, ..facts }))
}

/// The experiment's label in a file's name.
fn label(name: &str) -> Option<String> {
    let file_name = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file_name.parse().ok().map(|label: ExperimentLabel| label.to_string())
}
