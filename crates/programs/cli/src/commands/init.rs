//! `dynoid init`: from recordings to a proposed bench file.

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use dynoid::{Error, Files, InputFile, Mark, check_replaceable, paths};
use recording::{Recording, Selection};
use report::proposal::{reasons, unit};
use rig::bench_file::{Draft, PLACEHOLDER};
use rig::channels::{Choice, Guess, guess_roles};
use rig::{BenchFile, ExperimentLabel, Role};
use serde::Serialize;

use super::update;
use crate::cli::bench::InitArguments;
use crate::error::{CliError, Outcome};
use crate::summary::shown;
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &InitArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let out = &arguments.out;
    if out.is_dir() {
        return Err(Error::InTheWay { path: out.clone(), what: "a folder" }.into());
    }
    let replaced = check_place(out, arguments.force || arguments.update, &terminal.files())?;
    let named = terminal.files().named(&arguments.recordings)?;
    let recordings = decode_all(&named, terminal)?;
    let pairs: Vec<(&str, &Recording)> = recordings.iter().map(|(file, r)| (file.name.as_str(), r)).collect();
    let guess = guess_roles(&pairs);
    let folder = paths::folder_of(out);
    let unlabelled = unlabelled(&recordings, &folder);
    let files = patterns(&arguments.recordings, &folder)?;
    let names: Vec<String> = files.iter().map(|(pattern, _)| pattern.clone()).collect();
    let draft = Draft { name: &bench_name(&named), guess: &guess, files: &names, unlabelled: &unlabelled };
    let proposed = BenchFile::to_commented_toml(&draft);
    let text = match arguments.update && out.is_file() {
        true => {
            let text = std::fs::read_to_string(out).map_err(|source| Error::read(out, source))?;
            update::updated(out.as_path(), text.as_str(), &proposed, &files)?
        }
        false => proposed,
    };
    dynoid::replace_with(
        out,
        replaced.as_ref(),
        |file| file.write_all(text.as_bytes()).map_err(|source| Error::write(out, source)),
        &terminal.files(),
    )?;
    let gaps = gaps_in(&text);
    if arguments.json {
        terminal.json(&proposal(&guess, out, &gaps, &unlabelled))?;
    } else if !terminal.is_quiet() {
        terminal.page(&report::proposal::page(&guess, &shown(out), &gaps));
    }
    Ok(if recordings.len() < named.len() { Outcome::SomeUnreadable } else { Outcome::Done })
}

/// The mark of the bench file that is replaced, if there is one; any other file is refused, and without --force a bench
/// file too.
fn check_place(out: &Path, force: bool, files: &Files) -> Result<Option<Mark>, CliError> {
    if !out.is_file() {
        return Ok(None);
    }
    match dynoid::is_bench_file(out) {
        true if force => Ok(Mark::of_file(out)),
        true => Err(CliError::BenchFileExists { path: out.to_owned() }),
        false if files.overwrites() => Ok(check_replaceable(out, None, files).map(|()| None)?),
        false => Err(CliError::NotABenchFile { path: out.to_owned() }),
    }
}

/// Every recording that can be decoded; of the others a warning says why not.
fn decode_all(files: &[InputFile], terminal: &mut Terminal) -> Result<Vec<(InputFile, Recording)>, CliError> {
    let step = terminal.work().step("reading", files.len() as u64);
    let mut recordings = Vec::new();
    let mut faults = Vec::new();
    for file in files {
        let reading = step.step(format!("reading {}", file.name), 0);
        match terminal.files().decode(file, &Selection::All, &reading)? {
            Ok(recording) => recordings.push((file.clone(), recording)),
            Err(error) => faults.push(error.to_string()),
        }
    }
    drop(step);
    for fault in faults {
        terminal.warning(&fault);
    }
    if recordings.is_empty() { Err(CliError::NoneReadable { count: files.len() }) } else { Ok(recordings) }
}

fn unlabelled(recordings: &[(InputFile, Recording)], folder: &Path) -> Vec<String> {
    let has_no_label = |file: &InputFile| {
        let name = file.path.file_name().unwrap_or_default().to_string_lossy();
        name.parse::<ExperimentLabel>().is_err()
    };
    let files = recordings.iter().map(|(file, _)| file).filter(|file| has_no_label(file));
    files.map(|file| paths::with_slashes(&paths::relative_to(&file.path, folder))).collect()
}

/// The bench is called like the folder its recordings are in.
fn bench_name(files: &[InputFile]) -> String {
    let folder =
        files.first().and_then(|file| file.path.canonicalize().ok()).and_then(|path| path.parent().map(Path::to_owned));
    let named = folder.iter().flat_map(|folder| folder.ancestors()).find_map(|folder| {
        let name = folder.file_name()?.to_string_lossy().replace(char::is_control, "");
        let says_nothing = ["recordings", "measurements", "data"].contains(&name.to_lowercase().as_str());
        (!says_nothing).then_some(name)
    });
    named.unwrap_or_else(|| "My bench".to_owned())
}

/// Entries for the bench file, with the recordings that they stand for: for a folder a pattern of each kind of
/// recording in it, a file by its name.
fn patterns(arguments: &[PathBuf], folder: &Path) -> Result<Vec<(String, Vec<PathBuf>)>, CliError> {
    let mut patterns = Vec::new();
    for argument in arguments {
        let path = paths::with_slashes(&paths::relative_to(argument, folder));
        if !argument.is_dir() {
            patterns.push((path, vec![argument.clone()]));
            continue;
        }
        let files = dynoid::recordings_in(argument)?;
        let endings: BTreeSet<&str> = files.iter().filter_map(|file| paths::ending(file)).collect();
        let prefix = if path.is_empty() { String::new() } else { format!("{}/", glob::Pattern::escape(&path)) };
        let of = |ending: &&str| files.iter().filter(|file| paths::ending(file) == Some(*ending)).cloned().collect();
        patterns.extend(endings.iter().map(|ending| (format!("{prefix}*.{ending}"), of(ending))));
    }
    Ok(patterns)
}

/// The keys of the bench file that still have to be filled in, with their lines.
fn gaps_in(text: &str) -> Vec<(usize, String)> {
    let placeholder = format!("\"{PLACEHOLDER}\"");
    let gap = |(index, line): (usize, &str)| {
        let (key, value) = line.split_once('=')?;
        (!key.starts_with('#') && value.trim_start().starts_with(&placeholder))
            .then(|| (index + 1, key.trim().to_owned()))
    };
    text.lines().enumerate().filter_map(gap).collect()
}

#[derive(Serialize)]
struct Proposal<'a> {
    bench_file: &'a Path,
    channels: Vec<ProposedChannel<'a>>,
    ambiguous: Vec<Alternatives<'a>>,
    missing: &'a [Role],
    unlabelled: &'a [String],
    to_fill_in: Vec<&'a str>,
}

#[derive(Serialize)]
struct ProposedChannel<'a> {
    role: Role,
    symbol: &'static str,
    channel: &'a str,
    unit: &'a str,
    confidence: f64,
    reasons: Vec<String>,
}

#[derive(Serialize)]
struct Alternatives<'a> {
    role: Role,
    channels: &'a [String],
}

fn proposal<'a>(
    guess: &'a Guess,
    out: &'a Path,
    gaps: &'a [(usize, String)],
    unlabelled: &'a [String],
) -> Proposal<'a> {
    let channel = |(role, choice): (&Role, &'a Choice)| ProposedChannel {
        role: *role,
        symbol: role.symbol(),
        channel: &choice.channel,
        unit: unit(choice),
        confidence: choice.confidence,
        reasons: reasons(choice),
    };
    Proposal {
        bench_file: out,
        channels: guess.choices.iter().map(channel).collect(),
        ambiguous: guess.ambiguous.iter().map(|a| Alternatives { role: a.role, channels: &a.channels }).collect(),
        missing: &guess.missing,
        unlabelled,
        to_fill_in: gaps.iter().map(|(_, key)| key.as_str()).collect(),
    }
}
