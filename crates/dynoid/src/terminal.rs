//! All that is printed: results on standard output, warnings, errors and progress on standard error.

use std::io::{self, BufWriter, IsTerminal, Stdout, Write};
use std::sync::{Once, OnceLock};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use page::{Page, Screen, Tone, safe};
use serde::Serialize;

use crate::cli::{ColorWhen, Global};
use crate::error::CliError;

/// Line length where the terminal's is not known.
const USUAL_WIDTH: usize = 100;
/// Lines longer than this are hard to read.
const WIDEST: usize = 120;
const NARROWEST: usize = 40;
/// Lines of a result on a terminal; `--all` shows the rest.
const MOST_LINES: usize = 40;
/// From frame to frame of a display of progress.
const TICK: Duration = Duration::from_millis(100);
/// Duration below which work needs no display.
const SHORT: Duration = Duration::from_secs(1);

/// Where a command prints. Texts may come from anywhere: escape codes in them are taken out.
pub(crate) struct Terminal {
    out: BufWriter<Stdout>,
    /// Why standard output takes no more. Of a reader that has gone away nothing is said.
    failure: Option<io::Error>,
    quiet: bool,
    /// True where results are shown to the last line.
    all: bool,
    colour_out: bool,
    colour_err: bool,
    width: usize,
    /// Columns of a line on standard error; none where messages stay in one line.
    width_err: Option<usize>,
}

impl Terminal {
    pub(crate) fn new(global: &Global) -> Self {
        let colour = |is_terminal: bool| match global.color {
            ColorWhen::Always => true,
            ColorWhen::Never => false,
            ColorWhen::Auto => is_terminal && colour_is_welcome(),
        };
        let columns = columns();
        let width = columns.map_or(USUAL_WIDTH, |columns| columns.clamp(NARROWEST, WIDEST));
        Terminal {
            out: BufWriter::new(io::stdout()),
            failure: None,
            quiet: global.quiet,
            colour_out: colour(io::stdout().is_terminal()),
            colour_err: colour(io::stderr().is_terminal()),
            all: global.all || !io::stdout().is_terminal(),
            width,
            width_err: columns.map(|_| width),
        }
    }

    /// Tells whether nothing but warnings and errors is to be shown.
    pub(crate) fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// A line.
    pub(crate) fn line(&mut self, text: &str) {
        self.put(&page::folded(text, self.width));
    }

    /// An empty line.
    pub(crate) fn gap(&mut self) {
        self.put("");
    }

    /// A page, but for its figures.
    pub(crate) fn page(&mut self, page: &Page) {
        let text = page::terminal(page, self.screen());
        if text.is_empty() {
            return;
        }
        match beginning(&text, MOST_LINES).filter(|_| !self.all) {
            None => self.put(&text),
            Some((shown, left)) => {
                self.put(shown);
                self.put(&format!("\n{left} more lines: add --all"));
            }
        }
    }

    fn screen(&self) -> Screen {
        Screen { width: self.width, colour: self.colour_out, is_narrow: self.width_err.is_some() }
    }

    /// A value as JSON.
    pub(crate) fn json(&mut self, value: &impl Serialize) -> Result<(), CliError> {
        let text = serde_json::to_string_pretty(value).map_err(CliError::internal)?;
        self.put(&text);
        Ok(())
    }

    /// Text for another program, as it is.
    pub(crate) fn script(&mut self, text: &str) {
        self.put(text.trim_end());
    }

    /// Prints a note on a step along the way, on standard error.
    pub(crate) fn note(&mut self, text: &str) {
        if !self.quiet {
            self.complain("note:", Tone::Faint, text);
        }
    }

    /// A warning, on standard error.
    pub(crate) fn warning(&mut self, text: &str) {
        self.complain("warning:", Tone::Caution, text);
    }

    /// An error, on standard error.
    pub(crate) fn error(&mut self, text: &str) {
        self.complain("error:", Tone::Bad, text);
    }

    /// A display of progress over a number of steps, on standard error; nothing where that is no terminal.
    pub(crate) fn progress(&self, steps: u64) -> Progress {
        if self.quiet || !io::stderr().is_terminal() {
            return Progress { bar: None, before_last: OnceLock::new() };
        }
        let bar = self.bar(steps);
        bar.enable_steady_tick(TICK);
        Progress { bar: Some(bar), before_last: OnceLock::new() }
    }

    fn bar(&self, steps: u64) -> ProgressBar {
        let bar = ProgressBar::new(steps);
        let colour = if self.colour_err { ".cyan" } else { "" };
        let times = "{elapsed} gone, {eta} to go";
        let template = format!("{{spinner{colour}}} [{{bar:18{colour}}}] {times}  {{wide_msg}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar
    }

    /// A display of the progress of something that may take long, on standard error; nothing where that is no terminal.
    pub(crate) fn long(&self, what: &str) -> Long {
        let bar = (!self.quiet && io::stderr().is_terminal()).then(|| self.bar(0));
        if let Some(bar) = &bar {
            bar.set_draw_target(ProgressDrawTarget::hidden());
            bar.set_message(safe(what));
        }
        Long { bar, since: Instant::now(), shown: Once::new() }
    }

    /// Writes out what is left, and says whether all could be written.
    pub(crate) fn finish(&mut self) -> Result<(), CliError> {
        self.flush();
        match self.failure.take() {
            Some(source) if source.kind() != io::ErrorKind::BrokenPipe => Err(CliError::StandardOutput { source }),
            _ => Ok(()),
        }
    }

    fn put(&mut self, line: &str) {
        if self.failure.is_none() {
            self.failure = writeln!(self.out, "{line}").err();
        }
    }

    fn flush(&mut self) {
        if self.failure.is_none() {
            self.failure = self.out.flush().err();
        }
    }

    fn complain(&mut self, mark: &str, style: Tone, text: &str) {
        self.flush();
        // The mark counts as a word of the first line.
        let text = match self.width_err {
            Some(width) => page::folded(&format!("{mark} {text}"), width).replacen(mark, "", 1),
            None => format!(" {}", text.lines().map(safe).collect::<Vec<_>>().join("\n")),
        };
        let mark = if self.colour_err { style.paint(mark) } else { mark.to_owned() };
        // Nobody is left to read it if standard error is gone.
        let _ = writeln!(io::stderr(), "{mark}{text}");
    }
}

/// Columns of the terminal; where there is none, those that the variable COLUMNS states.
fn columns() -> Option<usize> {
    let terminal = terminal_size::terminal_size().map(|(width, _)| usize::from(width.0));
    terminal.or_else(|| std::env::var("COLUMNS").ok()?.trim().parse().ok().filter(|columns| *columns > 0))
}

/// The first lines of a text and how many more there are; `None` where they are all of it, or nearly.
fn beginning(text: &str, most: usize) -> Option<(&str, usize)> {
    let count = text.lines().count();
    let end = text.match_indices('\n').nth(most.checked_sub(1)?)?.0;
    (count > most + 2).then(|| (text[..end].trim_end(), count - most))
}

/// NO_COLOR (no-color.org) and terminals that know no colour.
fn colour_is_welcome() -> bool {
    let is_unset_or_empty = |value: Option<std::ffi::OsString>| value.is_none_or(|value| value.is_empty());
    is_unset_or_empty(std::env::var_os("NO_COLOR")) && std::env::var_os("TERM").is_none_or(|term| term != "dumb")
}

/// A display of progress, gone when dropped.
pub(crate) struct Progress {
    bar: Option<ProgressBar>,
    /// Steps before its last part, where that counts by itself.
    before_last: OnceLock<u64>,
}

impl Progress {
    /// Says what is being done.
    pub(crate) fn say(&self, what: &str) {
        if let Some(bar) = &self.bar {
            bar.set_message(safe(what));
        }
    }

    /// There are more steps than was known at first.
    pub(crate) fn more(&self, steps: u64) {
        if let Some(bar) = &self.bar {
            bar.inc_length(steps);
        }
    }

    /// Of the last part, `done` of `all` is done. Any thread may call it.
    pub(crate) fn of_last(&self, done: u64, all: u64) {
        if let Some(bar) = &self.bar {
            let before = *self.before_last.get_or_init(|| bar.position());
            bar.set_length(before + all);
            bar.set_position(before + done);
        }
    }

    /// One step is done.
    pub(crate) fn step(&self) {
        if let Some(bar) = &self.bar {
            bar.inc(1);
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// A display of progress that appears where something takes more than a second, gone when dropped.
pub(crate) struct Long {
    bar: Option<ProgressBar>,
    since: Instant,
    shown: Once,
}

impl Long {
    /// `done` of `all` is done. Any thread may call it.
    pub(crate) fn at(&self, done: u64, all: u64) {
        let Some(bar) = self.bar.as_ref().filter(|_| self.since.elapsed() > SHORT) else { return };
        bar.set_length(all);
        bar.set_position(done);
        self.shown.call_once(|| {
            bar.set_draw_target(ProgressDrawTarget::stderr());
            bar.enable_steady_tick(TICK);
        });
    }
}

impl Drop for Long {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::beginning;

    #[test]
    fn exact_a_long_result_is_cut_and_the_rest_counted() {
        let text = (0..50).map(|n| n.to_string()).collect::<Vec<_>>().join("\n");
        let (shown, left) = beginning(&text, 40).unwrap();
        assert_eq!((shown.lines().count(), shown.lines().last(), left), (40, Some("39"), 10));
        assert!(
            beginning(&text, 48).is_none() && beginning("", 40).is_none(),
            "two more lines cost less than a remark"
        );
    }
}
