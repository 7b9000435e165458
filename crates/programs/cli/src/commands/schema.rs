//! `dynoid schema`: the form of each JSON output.

use dynoid::schemas::{SCHEMAS, named};

use crate::cli::schema::SchemaArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &SchemaArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    match arguments.name.as_deref().and_then(named) {
        Some(schema) => terminal.script(schema.text),
        None => SCHEMAS.iter().for_each(|schema| terminal.line(&format!("{}: {}", schema.name, schema.title()))),
    }
    Ok(Outcome::Done)
}
