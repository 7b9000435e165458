//! A folder of recordings as the only argument, such as one dropped on the program: bench file, study, report on the
//! screen. The steps are those of `dynoid init` and `dynoid study`.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

use crate::cli::Cli;
use crate::dispatch::run;
use crate::error;
use crate::path::shown;
use crate::terminal::Terminal;

/// The folder that the arguments are, unless they name a command.
pub(crate) fn folder(arguments: &[OsString]) -> Option<PathBuf> {
    let [_, only] = arguments else { return None };
    let folder = PathBuf::from(only);
    (folder.is_dir() && !Cli::is_command(only)).then_some(folder)
}

/// Proposes a bench file where there is none, studies the bench, and opens the report. Returns the exit code.
pub(crate) fn study(folder: &Path) -> u8 {
    let (bench, out) = (folder.join("bench.toml"), folder.join("study"));
    if !bench.is_file() {
        let code = command("init", &bench, folder);
        if !bench.is_file() {
            return code;
        }
    }
    let code = command("study", &out, &bench);
    if error::has_results(code) {
        open(&out.join("report.html"));
    }
    code
}

/// Runs a command on an input.
fn command(name: &str, out: &Path, input: &Path) -> u8 {
    let mut place = OsString::from("--out=");
    place.push(out);
    let words = [OsStr::new("dynoid"), OsStr::new(name), &place, OsStr::new("--"), input.as_os_str()];
    let (cli, files) = Cli::read(words.map(OsStr::to_owned).to_vec());
    run(&cli, files)
}

/// Opens a page in the browser, which goes on after the program has ended.
fn open(page: &Path) {
    if let Err(error) = open::that_detached(page) {
        Terminal::plain().warning(&format!("{}: no browser opens the report ({error}); open this file", shown(page)));
    }
}
