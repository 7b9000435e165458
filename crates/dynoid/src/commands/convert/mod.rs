//! `dynoid convert`: recordings in another format, or a model in another form.

mod choice;
pub(in crate::commands) mod figures;
mod notes;
mod recordings;
mod targets;

use std::path::Path;

use crate::cli::convert::{ConvertArguments, Form};
use crate::cli::convert::{Representation, Sampling};
use crate::commands::identify;
use crate::error::{CliError, Outcome};
use crate::input;
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &ConvertArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    match arguments.files.iter().find(|file| input::is_json(file)) {
        Some(model) => identify::convert::convert(&of_model(arguments, model)?, terminal),
        None => recordings::convert(arguments, terminal),
    }
}

fn of_model(arguments: &ConvertArguments, model: &Path) -> Result<identify::convert::ConvertArguments, CliError> {
    let usage = |what: String| CliError::Usage { what: format!("{}: this is a model file; {what}", model.display()) };
    if arguments.files.len() > 1 {
        return Err(usage("give it alone".into()));
    }
    let of_recordings = [
        ("--channels", !arguments.channels.is_empty()),
        ("--start", arguments.start.is_some()),
        ("--end", arguments.end.is_some()),
        ("--rate", arguments.rate.is_some()),
        ("--between", arguments.between.is_some()),
    ];
    if let Some((option, _)) = of_recordings.iter().find(|(_, is_given)| *is_given) {
        return Err(usage(format!("{option} is for recordings")));
    }
    let to = match arguments.to {
        None => Representation::Tf,
        Some(Form::Model(to)) => to,
        Some(Form::Recording(_)) => return Err(usage("give --to tf, --to zpk or --to ss".into())),
    };
    Ok(identify::convert::ConvertArguments {
        model: model.to_owned(),
        to,
        sample_time: arguments.sample_time,
        continuous: arguments.continuous,
        method: arguments.method.unwrap_or(Sampling::Zoh),
        out: arguments.out.clone(),
        prewarp_hz: arguments.prewarp,
        result: arguments.result.clone(),
    })
}
