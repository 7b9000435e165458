//! Bench files that recordings propose.

mod update;

use std::collections::BTreeSet;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use page::Page;
use recording::{Recording, Selection};
use report::proposal::{reasons, unit};
use rig::bench_file::{Draft, PLACEHOLDER};
use rig::channels::{Choice, Guess, guess_roles};
use rig::{BenchFile, ExperimentLabel, Role};
use serde::Serialize;
use work::Context;

use crate::error::Error;
use crate::files::Files;
use crate::find::{InputFile, recordings_in};
use crate::mark::Mark;
use crate::output::replace_with;
use crate::paths;

/// A bench file that recordings propose, or additions to one that is there.
#[derive(Debug, Clone)]
pub struct Proposal {
    path: PathBuf,
    text: String,
    guess: Guess,
    unlabelled: Vec<String>,
    unreadable: Vec<String>,
    gaps: Vec<(usize, String)>,
}

impl Proposal {
    /// The bench file at `path` that recordings, or folders of recordings, propose. With `update` it has all that is
    /// there already, word for word.
    ///
    /// # Errors
    /// No recording that can be read, and a file to which nothing can be added.
    pub fn of(
        recordings: &[PathBuf],
        path: &Path,
        update: bool,
        files: &Files,
        context: &Context,
    ) -> Result<Self, Error> {
        let named = files.named(recordings)?;
        let (read, unreadable) = decode_all(&named, files, context)?;
        let pairs: Vec<(&str, &Recording)> = read.iter().map(|(file, r)| (file.name.as_str(), r)).collect();
        let guess = guess_roles(&pairs);
        let folder = paths::folder_of(path);
        let unlabelled = unlabelled(&read, &folder);
        let patterns = patterns(recordings, &folder)?;
        let names: Vec<String> = patterns.iter().map(|(pattern, _)| pattern.clone()).collect();
        let draft = Draft { name: &bench_name(&named), guess: &guess, files: &names, unlabelled: &unlabelled };
        let proposed = BenchFile::to_commented_toml(&draft);
        let text = match update && path.is_file() {
            true => {
                let text = std::fs::read_to_string(path).map_err(|source| Error::read(path, source))?;
                update::updated(path, &text, &proposed, &patterns)?
            }
            false => proposed,
        };
        let gaps = gaps_in(&text);
        Ok(Proposal { path: path.to_owned(), text, guess, unlabelled, unreadable, gaps })
    }

    /// The text of the bench file.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Roles of the channels.
    pub fn guess(&self) -> &Guess {
        &self.guess
    }

    /// Recordings that cannot be read, each with the reason.
    pub fn unreadable(&self) -> &[String] {
        &self.unreadable
    }

    /// Writes the bench file, over one of this mark where there is one.
    ///
    /// # Errors
    /// A file that must stay, or cannot be written.
    pub fn write(&self, replaced: Option<&Mark>, files: &Files) -> Result<(), Error> {
        let failed = |source| Error::write(&self.path, source);
        replace_with(&self.path, replaced, |file| file.write_all(self.text.as_bytes()).map_err(failed), files)
    }

    /// The proposal as a page, which calls the bench file by this name.
    pub fn page(&self, name: &str) -> Page {
        report::proposal::page(&self.guess, name, &self.gaps)
    }

    /// The proposal as programs read it.
    pub fn facts(&self) -> ProposalFacts<'_> {
        let guess = &self.guess;
        ProposalFacts {
            bench_file: &self.path,
            channels: guess.choices.iter().map(ProposedChannel::of).collect(),
            ambiguous: guess.ambiguous.iter().map(|a| Alternatives { role: a.role, channels: &a.channels }).collect(),
            missing: &guess.missing,
            unlabelled: &self.unlabelled,
            to_fill_in: self.gaps.iter().map(|(_, key)| key.as_str()).collect(),
        }
    }
}

/// A recording with its file.
type Named = (InputFile, Recording);

/// Every recording that can be decoded, and why the others cannot.
fn decode_all(files: &[InputFile], run: &Files, context: &Context) -> Result<(Vec<Named>, Vec<String>), Error> {
    let step = context.step("reading", files.len() as u64);
    let (mut recordings, mut faults) = (Vec::new(), Vec::new());
    for file in files {
        let reading = step.step(format!("reading {}", file.name), 0);
        match run.decode(file, &Selection::All, &reading)? {
            Ok(recording) => recordings.push((file.clone(), recording)),
            Err(error) => faults.push(error.to_string()),
        }
    }
    if recordings.is_empty() { Err(Error::NoneReadable { reasons: faults }) } else { Ok((recordings, faults)) }
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
fn patterns(arguments: &[PathBuf], folder: &Path) -> Result<Vec<(String, Vec<PathBuf>)>, Error> {
    let mut patterns = Vec::new();
    for argument in arguments {
        let path = paths::with_slashes(&paths::relative_to(argument, folder));
        if !argument.is_dir() {
            patterns.push((path, vec![argument.clone()]));
            continue;
        }
        let files = recordings_in(argument)?;
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

/// A proposal as programs read it.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ProposalFacts<'a> {
    bench_file: &'a Path,
    channels: Vec<ProposedChannel<'a>>,
    ambiguous: Vec<Alternatives<'a>>,
    missing: &'a [Role],
    unlabelled: &'a [String],
    to_fill_in: Vec<&'a str>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ProposedChannel<'a> {
    role: Role,
    symbol: &'static str,
    channel: &'a str,
    unit: &'a str,
    confidence: f64,
    reasons: Vec<String>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Alternatives<'a> {
    role: Role,
    channels: &'a [String],
}

impl<'a> ProposedChannel<'a> {
    fn of((role, choice): (&Role, &'a Choice)) -> Self {
        ProposedChannel {
            role: *role,
            symbol: role.symbol(),
            channel: &choice.channel,
            unit: unit(choice),
            confidence: choice.confidence,
            reasons: reasons(choice),
        }
    }
}
