//! `dynoid convert`: recordings in another format.

use dynoid::Error;
use dynoid::convert::{Conversion, ConvertOptions, Converted, ConvertedFacts, WrittenFacts};
use page::Page;
use toolbox_report::words::counted;

use crate::cli::convert::ConvertArguments;
use crate::cli::identify::Between;
use crate::commands::result::{Sorted, check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// Most notes that are shown of one file; all are in the JSON.
const MOST_NOTES: usize = 12;

/// `dynoid convert`
pub(crate) fn run(arguments: &ConvertArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let conversion = conversion(arguments, terminal)?;
    check_plot(&arguments.result, &terminal.files())?;
    let (files, work, is_json) = (terminal.files(), terminal.work().clone(), arguments.result.json);
    let (mut rows, mut drawn, mut unreadable) = (Vec::new(), Vec::new(), 0);
    conversion.run(&files, &work, |converted| {
        let mut facts = converted.facts();
        match converted {
            Converted::Written(written) => {
                if arguments.result.plot.is_some() {
                    drawn.extend(written.figures());
                }
                if !is_json {
                    say(written.facts(), conversion.count() > 1, terminal);
                }
            }
            Converted::Left { file, note } if !is_json => terminal.warning(&format!("{file}: {note}")),
            Converted::Left { .. } => {}
            Converted::Failed { file, error } => {
                unreadable += 1;
                let error = CliError::from(error).to_string();
                terminal.error(&error);
                facts = ConvertedFacts::Failed { file, error };
            }
        }
        rows.push(facts);
    })?;
    show(&arguments.result, || Page::of_figures("Converted", drawn), || Sorted(rows), terminal)?;
    Ok(if unreadable > 0 { Outcome::SomeUnreadable } else { Outcome::Done })
}

/// The recordings and the files that they become.
fn conversion(arguments: &ConvertArguments, terminal: &Terminal) -> Result<Conversion, CliError> {
    let usage = |what: String| Err(CliError::Usage { what });
    let window = |error| match error {
        Error::EmptyWindow { from_s, to_s } => {
            CliError::Usage { what: format!("--start {from_s} lies after --end {to_s}; give the earlier time first") }
        }
        other => other.into(),
    };
    let options = ConvertOptions {
        channels: arguments.channels.clone(),
        start_s: arguments.start,
        end_s: arguments.end,
        sample_time_s: arguments.sample_time,
        rate_hz: arguments.rate,
        between: arguments.between.map(Between::intersample),
        with_hashes: arguments.result.json,
    };
    options.check().map_err(window)?;
    if arguments.between.is_some() && arguments.sample_time.is_none() && arguments.rate.is_none() {
        return usage(
            "--between says how channels come onto another clock; give one with --sample-time or --rate".into(),
        );
    }
    let files = terminal.files();
    let recordings = files.named(&arguments.files)?;
    let Some(out) = &arguments.out else {
        return usage("give the file to write with --out, or a folder with --out and a format with --to".into());
    };
    Ok(match arguments.to {
        Some(format) => Conversion::into_folder(recordings, out, format.into(), options, &files),
        None => Conversion::into_file(recordings, out, options, &files),
    }?)
}

fn say(written: &WrittenFacts, is_one_of_many: bool, terminal: &mut Terminal) {
    let prefix = if is_one_of_many { format!("{}: ", written.file) } else { String::new() };
    for note in written.notes.iter().take(MOST_NOTES) {
        terminal.warning(&format!("{prefix}{note}"));
    }
    if written.notes.len() > MOST_NOTES {
        terminal.warning(&format!("{prefix}and {} more; see --json", written.notes.len() - MOST_NOTES));
    }
    if !terminal.is_quiet() {
        let (channels, rasters) = (written.channels.len(), written.rasters.len());
        terminal.line(&format!(
            "written: {} ({}, {})",
            written.out,
            counted(channels, "channel"),
            counted(rasters, "raster")
        ));
    }
}
