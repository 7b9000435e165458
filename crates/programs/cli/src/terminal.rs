//! All that is printed: results on standard output, warnings, errors and progress on standard error.

use std::io::{self, BufWriter, IsTerminal, Stdout, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use dynoid::Files;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use page::{Page, Screen, Tone, safe};
use serde::Serialize;
use work::{Context, Progress, State, Tree};

use crate::cli::{ColorWhen, Global, ProgressForm};
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
/// Parts of a display that is full.
const PARTS: u64 = 1000;

/// Where a command prints. Texts may come from anywhere: escape codes in them are taken out.
pub(crate) struct Terminal {
    out: BufWriter<Stdout>,
    /// Why standard output takes no more. Of a reader that has gone away nothing is said.
    failure: Option<io::Error>,
    /// The context of all long work, whose progress is shown on standard error where that is a terminal.
    work: Context,
    files: Files,
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
    pub(crate) fn new(global: &Global, files: Files) -> Self {
        let colour = |is_terminal: bool| match global.color {
            ColorWhen::Always => true,
            ColorWhen::Never => false,
            ColorWhen::Auto => is_terminal && colour_is_welcome(),
        };
        let columns = columns();
        let width = columns.map_or(USUAL_WIDTH, |columns| columns.clamp(NARROWEST, WIDEST));
        let colour_err = colour(io::stderr().is_terminal());
        Terminal {
            out: BufWriter::new(io::stdout()),
            failure: None,
            work: match global.progress {
                _ if global.quiet => Context::new(),
                ProgressForm::Json => shown(Lines::default()),
                ProgressForm::Auto if io::stderr().is_terminal() => shown(Bar::new(colour_err)),
                ProgressForm::Auto => Context::new(),
            },
            files,
            quiet: global.quiet,
            colour_out: colour(io::stdout().is_terminal()),
            colour_err,
            all: global.all || !io::stdout().is_terminal(),
            width,
            width_err: columns.map(|_| width),
        }
    }

    /// A terminal for messages beside those of a command.
    pub(crate) fn plain() -> Self {
        Terminal::new(&Global { quiet: true, ..Global::default() }, Files::new("", false))
    }

    /// Waits for Enter where the window closes as soon as the program ends: on Windows, if no shell started it. Only
    /// the shell sets PROMPT.
    pub(crate) fn wait_if_it_closes() {
        if cfg!(windows) && io::stdin().is_terminal() && std::env::var_os("PROMPT").is_none() {
            let _ = writeln!(io::stderr(), "\nPress Enter to close this window.");
            let _ = io::stdin().read_line(&mut String::new());
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

    /// The context of long work: its progress is shown.
    pub(crate) fn work(&self) -> &Context {
        &self.work
    }

    /// The files of this run: a copy, which shares its memory.
    pub(crate) fn files(&self) -> Files {
        self.files.clone()
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

/// A display of progress on standard error.
trait Display: Send + 'static {
    fn hear(&mut self, heard: &Progress);

    /// Shows where the work stands.
    fn tick(&mut self);
}

/// A display that is whole even if a thread failed.
fn locked<D>(display: &Mutex<D>) -> MutexGuard<'_, D> {
    display.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A context whose progress is shown on standard error.
fn shown(display: impl Display) -> Context {
    let display = Arc::new(Mutex::new(display));
    let shown = Arc::downgrade(&display);
    std::thread::spawn(move || {
        while let Some(display) = shown.upgrade() {
            locked(&display).tick();
            drop(display);
            std::thread::sleep(TICK);
        }
    });
    Context::new().with_listener(move |heard| locked(&display).hear(heard))
}

/// Lines for programs: each says which part is done, and what is being done.
#[derive(Default)]
struct Lines {
    tree: Tree,
    /// The line that was printed last.
    last: String,
}

impl Display for Lines {
    fn hear(&mut self, heard: &Progress) {
        self.tree.hear(heard);
    }

    fn tick(&mut self) {
        let Some(doing) = self.tree.current() else { return };
        let done = (self.tree.fraction() * PARTS as f64).round() / PARTS as f64;
        let Ok(line) = serde_json::to_string(&Stand { fraction: done, doing }) else { return };
        if line != self.last {
            let _ = writeln!(io::stderr(), "{line}");
            self.last = line;
        }
    }
}

/// Where work stands, as programs read it.
#[derive(Serialize)]
struct Stand<'a> {
    /// Part that is done, from 0 to 1.
    fraction: f64,
    /// The step that it is at, in words.
    doing: &'a str,
}

/// A display of progress that appears where something takes more than a second, and is gone when that ends.
struct Bar {
    bar: ProgressBar,
    since: Instant,
    is_shown: bool,
    tree: Tree,
}

impl Bar {
    fn new(in_colour: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(PARTS), ProgressDrawTarget::hidden());
        let colour = if in_colour { ".cyan" } else { "" };
        let times = "{elapsed} gone, {eta} to go";
        let template = format!("{{spinner{colour}}} [{{bar:18{colour}}}] {times}  {{wide_msg}}");
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style.progress_chars("=> "));
        }
        Bar { bar, since: Instant::now(), is_shown: false, tree: Tree::default() }
    }

    fn hide(&mut self) {
        self.bar.finish_and_clear();
        self.bar.set_draw_target(ProgressDrawTarget::hidden());
        self.is_shown = false;
    }
}

impl Display for Bar {
    fn hear(&mut self, heard: &Progress) {
        let is_outermost = heard.parent.is_none();
        if is_outermost && heard.state == State::Begun && !self.is_shown {
            self.since = Instant::now();
            self.bar.reset();
        }
        self.tree.hear(heard);
        if self.tree.current().is_none() && self.is_shown {
            self.hide();
        }
    }

    /// Shows where the work stands, if it is long.
    fn tick(&mut self) {
        let Some(current) = self.tree.current().filter(|_| self.since.elapsed() > SHORT) else { return };
        if !self.is_shown {
            self.is_shown = true;
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_message(safe(current));
        self.bar.set_position((self.tree.fraction() * PARTS as f64) as u64);
        self.bar.tick();
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.hide();
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
