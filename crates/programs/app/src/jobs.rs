//! Jobs: commands of the program, each run as a process of its own.
//!
//! A job has a folder with its command, what it prints, and its exit code. So it outlives the page and the server, and
//! any server of the folder shows it. Its process holds a lock while it runs: a free lock without an exit code is a
//! process that was ended.

use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use axum::Json;
use axum::extract::{Path as InPath, State};
use serde::{Deserialize, Serialize};

use crate::answer::{Answer, Fault, json, of_type};
use crate::folder::OWN;
use crate::session::{self, Act};
use crate::shared::Shared;

/// Files of a job.
const COMMAND: &str = "command.json";
const PRINTED: &str = "printed";
const SAID: &str = "said";
const EXIT: &str = "exit";
const LOCK: &str = "lock";
const CANCEL: &str = "cancel";

/// Jobs that are kept; older ones are removed when they have ended.
const KEPT: usize = 200;
/// The most bytes of what a job printed that a page gets.
const MOST_PRINTED: u64 = 32 << 20;
/// Time in which the process of a job has begun.
const BEGINNING: Duration = Duration::from_secs(5);
/// From look to look for a wish to cancel.
const LOOK: Duration = Duration::from_millis(50);

/// A command, word by word, without the program's name.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(crate) struct Asked {
    arguments: Vec<String>,
}

/// Where a job stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
enum Stand {
    Running,
    Ended,
    Cancelled,
    /// Its process ended without a word: it was killed, or the computer stopped.
    Killed,
}

/// A job as a page sees it.
#[derive(Debug, Serialize)]
struct Job {
    id: String,
    arguments: Vec<String>,
    stand: Stand,
    exit_code: Option<u8>,
    /// Part that is done, from 0 to 1.
    fraction: Option<f64>,
    /// The step that it is at, in words.
    doing: Option<String>,
    /// Warnings and errors.
    said: String,
}

/// A line of progress, as the program prints it.
#[derive(Deserialize)]
struct Progress {
    fraction: f64,
    doing: String,
}

/// Starts a job.
pub(crate) async fn start(State(shared): State<Shared>, Json(asked): Json<Asked>) -> Answer {
    check(&shared, &asked.arguments)?;
    let id = begin(&shared, &asked).map_err(Fault::refused)?;
    session::note(&shared, Act::of_command(&asked.arguments)).map_err(Fault::refused)?;
    json(&job(&folder_of(&shared, &id)?, &id).map_err(Fault::refused)?)
}

/// Fails for what is no command of a page, and for words that lead out of the folder.
fn check(shared: &Shared, arguments: &[String]) -> Result<(), Fault> {
    let command = arguments.first().map_or("", String::as_str);
    if !shared.program.has(command) {
        return Err(Fault::refused(format!("\"{command}\" is no command of the app")));
    }
    for word in &arguments[1..] {
        let is_short = word.starts_with('-') && word.chars().nth(1).is_some_and(|letter| letter.is_ascii_alphabetic());
        if is_short && word.len() > 2 {
            return Err(Fault::refused(format!("\"{word}\": give an option and its value as two words")));
        }
        let value = word.split_once('=').filter(|_| word.starts_with("--")).map_or(word.as_str(), |(_, value)| value);
        shared.folder.permits(value)?;
    }
    Ok(())
}

/// Makes the folder of a job and starts its process.
fn begin(shared: &Shared, asked: &Asked) -> io::Result<String> {
    let all = jobs_folder(shared);
    fs::create_dir_all(&all)?;
    // Pages that a command draws for the app.
    fs::create_dir_all(shared.folder.root().join(OWN).join("pages"))?;
    forget_old(&all);
    let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
    // In the order of their beginning; a second one of the same instant gets the next name.
    let mut number = now.as_millis();
    let (id, folder) = loop {
        let id = format!("{number:015}");
        let folder = all.join(&id);
        match fs::create_dir(&folder) {
            Ok(()) => break (id, folder),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
            Err(error) => return Err(error),
        }
    };
    fs::write(folder.join(COMMAND), serde_json::to_string(asked)?)?;
    let mut command = Command::new(&shared.program.path);
    command.args(&shared.program.before);
    command.args([OsString::from("app"), "--job".into(), folder.clone().into()]);
    command.current_dir(shared.folder.root()).stdin(Stdio::null());
    command.stdout(File::create(folder.join(PRINTED))?).stderr(File::create(folder.join(SAID))?);
    // The terminal's Ctrl-C ends the server, not what it started.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = command.spawn()?;
    std::thread::spawn(move || child.wait());
    Ok(id)
}

/// Runs the command of a job, in the process that was started for it: `main` takes its words, the program's name first,
/// and gives its exit code.
///
/// # Errors
/// A folder that is not that of a job.
pub fn run_job(folder: &Path, main: impl FnOnce(Vec<OsString>) -> u8) -> io::Result<u8> {
    let asked: Asked = serde_json::from_str(&fs::read_to_string(folder.join(COMMAND))?)?;
    let lock = File::create(folder.join(LOCK))?;
    // The server may hold it for an instant, to see whether this process does.
    lock.lock()?;
    let cancel = folder.join(CANCEL);
    std::thread::spawn(move || {
        loop {
            if cancel.exists() {
                // As Ctrl-C does it: no file is left half written.
                let _ = signal_hook::low_level::raise(signal_hook::consts::SIGINT);
            }
            std::thread::sleep(LOOK);
        }
    });
    let words = ["dynoid", "--progress=json"].map(str::to_owned).into_iter().chain(asked.arguments);
    let code = main(words.map(OsString::from).collect());
    fs::write(folder.join(EXIT), code.to_string())?;
    Ok(code)
}

/// All jobs, the newest first.
pub(crate) async fn list(State(shared): State<Shared>) -> Answer {
    let all = jobs_folder(&shared);
    let jobs = ids(&all).into_iter().rev().filter_map(|id| job(&all.join(&id), &id).ok());
    json(&jobs.collect::<Vec<_>>())
}

/// One job.
pub(crate) async fn show(State(shared): State<Shared>, InPath(id): InPath<String>) -> Answer {
    json(&job(&folder_of(&shared, &id)?, &id).map_err(Fault::refused)?)
}

/// The output of a job: its result as JSON, where it was asked for that.
pub(crate) async fn printed(State(shared): State<Shared>, InPath(id): InPath<String>) -> Answer {
    let file = File::open(folder_of(&shared, &id)?.join(PRINTED)).map_err(Fault::refused)?;
    let mut bytes = Vec::new();
    file.take(MOST_PRINTED).read_to_end(&mut bytes).map_err(Fault::refused)?;
    Ok(of_type("application/json", bytes))
}

/// Cancels a job.
pub(crate) async fn cancel(State(shared): State<Shared>, InPath(id): InPath<String>) -> Answer {
    let folder = folder_of(&shared, &id)?;
    fs::write(folder.join(CANCEL), "").map_err(Fault::refused)?;
    json(&job(&folder, &id).map_err(Fault::refused)?)
}

fn jobs_folder(shared: &Shared) -> PathBuf {
    shared.folder.root().join(OWN).join("jobs")
}

/// The folder of a job, whose name is a number.
fn folder_of(shared: &Shared, id: &str) -> Result<PathBuf, Fault> {
    let folder = jobs_folder(shared).join(id);
    match id.bytes().all(|byte| byte.is_ascii_digit()) && !id.is_empty() && folder.is_dir() {
        true => Ok(folder),
        false => Err(Fault::missing(id)),
    }
}

/// Names of the jobs, the oldest first.
fn ids(all: &Path) -> Vec<String> {
    let entries = fs::read_dir(all).into_iter().flatten().flatten();
    let mut ids: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    ids.sort_unstable();
    ids
}

fn forget_old(all: &Path) {
    let ids = ids(all);
    for id in ids.iter().take(ids.len().saturating_sub(KEPT)) {
        let folder = all.join(id);
        if !is_running(&folder) {
            let _ = fs::remove_dir_all(folder);
        }
    }
}

fn job(folder: &Path, id: &str) -> io::Result<Job> {
    let asked: Asked = serde_json::from_str(&fs::read_to_string(folder.join(COMMAND))?)?;
    let exit_code = fs::read_to_string(folder.join(EXIT)).ok().and_then(|code| code.trim().parse().ok());
    let stand = match exit_code {
        Some(_) => Stand::Ended,
        None if is_running(folder) => Stand::Running,
        None if folder.join(CANCEL).exists() => Stand::Cancelled,
        None => Stand::Killed,
    };
    let (progress, said) = heard(&tail(&folder.join(SAID))?);
    let progress = progress.filter(|_| stand == Stand::Running);
    let (fraction, doing) = progress.map_or((None, None), |p| (Some(p.fraction), Some(p.doing)));
    Ok(Job { id: id.to_owned(), arguments: asked.arguments, stand, exit_code, fraction, doing, said })
}

/// Tells whether the process of a job runs, or is about to.
fn is_running(folder: &Path) -> bool {
    match File::open(folder.join(LOCK)) {
        Ok(lock) => lock.try_lock().is_err(),
        // Its process has not begun.
        Err(_) => folder
            .metadata()
            .and_then(|m| m.modified())
            .is_ok_and(|at| at.elapsed().is_ok_and(|since| since < BEGINNING)),
    }
}

/// The last progress, and everything else that was said.
fn heard(said: &str) -> (Option<Progress>, String) {
    let (mut progress, mut words) = (None, String::new());
    for line in said.lines() {
        match serde_json::from_str(line) {
            Ok(heard) => progress = Some(heard),
            Err(_) => {
                words += line;
                words.push('\n');
            }
        }
    }
    (progress, words)
}

/// The end of a file, which may be long.
fn tail(path: &Path) -> io::Result<String> {
    const MOST: u64 = 64 << 10;
    let mut file = File::open(path)?;
    let length = file.metadata()?.len();
    file.seek(SeekFrom::Start(length.saturating_sub(MOST)))?;
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
