//! Data as the commands ask for them, and what is said of them.

use dataset::CommonClock;
use dynoid::linear::{DataOptions, Gaps, Loaded, Note, RecordedFiles};

use crate::cli::identify::DataArguments;
use crate::error::CliError;
use crate::terminal::Terminal;

/// Reads the recordings, takes the channels out of them and their trend off, and says what was done on the way; on a
/// clock of its own unless one is asked for.
pub(super) fn load_on(
    usual: CommonClock,
    arguments: &DataArguments,
    terminal: &mut Terminal,
) -> Result<Loaded, CliError> {
    let options = arguments.options();
    let loaded = Loaded::take(&read(&options, terminal)?, usual, &options)?;
    say(&loaded.notes, &mut Vec::new(), terminal);
    Ok(loaded)
}

/// Reads the recordings named.
pub(super) fn read(options: &DataOptions, terminal: &Terminal) -> Result<RecordedFiles, CliError> {
    Ok(options.read(&terminal.files(), terminal.work())?)
}

/// As [`load_on`], cut at gaps, which is said too.
pub(super) fn load_between_gaps(
    usual: CommonClock,
    gaps: Gaps,
    arguments: &DataArguments,
    terminal: &mut Terminal,
) -> Result<Loaded, CliError> {
    let whole = load_on(usual, arguments, terminal)?;
    let mut said = whole.notes.clone();
    let cut = whole.cut_at(gaps)?;
    say(&cut.notes, &mut said, terminal);
    Ok(cut)
}

/// Says what was not said before.
pub(super) fn say(notes: &[Note], said: &mut Vec<Note>, terminal: &mut Terminal) {
    for note in notes {
        if !said.contains(note) {
            say_one(note, terminal);
            said.push(note.clone());
        }
    }
}

/// Says a note.
pub(super) fn say_one(note: &Note, terminal: &mut Terminal) {
    match note {
        Note::Done(text) => terminal.note(text),
        Note::Warning(text) => terminal.warning(text),
        Note::RunsAway(text) => terminal.warning(&format!("{text}; --horizon compares predictions")),
    }
}
