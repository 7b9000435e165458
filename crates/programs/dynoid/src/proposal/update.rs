//! Update of a bench file: what it lacks is added to its text, and every value, comment and line of a person stays
//! where it is.

use std::path::{Path, PathBuf};

use toml::Table;

use crate::error::Error;
use crate::find::listed;

/// The text of a bench file with the channels, recordings and labels of a proposal that it lacks; `files` are patterns
/// with the recordings that they stand for.
pub(super) fn updated(
    bench: &Path,
    text: &str,
    proposal: &str,
    files: &[(String, Vec<PathBuf>)],
) -> Result<String, Error> {
    let failed = |error: toml::de::Error| Error::NotToml { path: bench.to_owned(), reason: error.message().to_owned() };
    let stated: Table = text.parse().map_err(failed)?;
    let proposed: Table = proposal.parse().map_err(failed)?;
    let new = new_files(bench, &stated, files);
    let mut updated = with_channels(text, &stated, proposal);
    updated = with_files(updated, &new);
    updated = with_labels(updated, &stated, &proposed);
    // Whatever a person wrote, and however: nothing of it may change, and what is new must be where it is read.
    let is_whole = |now: Table| holds(&now, &stated) && has_new(&now, &proposed, &new);
    let is_right = updated.parse::<Table>().is_ok_and(is_whole);
    is_right.then_some(updated).ok_or_else(|| Error::NothingAdded { path: bench.to_owned() })
}

/// Tells whether a table holds all of another: lists may be longer.
fn holds(now: &Table, stated: &Table) -> bool {
    let is_in = |(key, value): (&String, &toml::Value)| match (now.get(key), value) {
        (Some(toml::Value::Table(now)), toml::Value::Table(stated)) => holds(now, stated),
        (Some(toml::Value::Array(now)), toml::Value::Array(stated)) => now.starts_with(stated),
        (now, stated) => now == Some(stated),
    };
    stated.iter().all(is_in)
}

/// Tells whether a table has the channels and labels that were proposed, and patterns of recordings.
fn has_new(now: &Table, proposed: &Table, patterns: &[&str]) -> bool {
    let channels = |table: &Table| -> Vec<String> {
        let channels = table.get("channels").and_then(toml::Value::as_table);
        channels.into_iter().flat_map(Table::keys).cloned().collect()
    };
    let files = now.get("recordings").and_then(|recordings| recordings.get("files")).and_then(toml::Value::as_array);
    let has_file = |pattern: &str| files.is_some_and(|files| files.iter().any(|file| file.as_str() == Some(pattern)));
    let (channels_now, labels_now) = (channels(now), labels(now));
    channels(proposed).iter().all(|role| channels_now.contains(role))
        && labels(proposed).iter().all(|file| labels_now.contains(file))
        && patterns.iter().all(|pattern| has_file(pattern))
}

/// The files that a table has labels for.
fn labels(table: &Table) -> Vec<String> {
    let list = table.get("recordings").and_then(|recordings| recordings.get("label")).and_then(toml::Value::as_array);
    list.into_iter().flatten().filter_map(|label| Some(label.get("file")?.as_str()?.to_owned())).collect()
}

/// The text with the lines of channels, and the comments above them, whose roles it does not have.
fn with_channels(text: &str, stated: &Table, proposal: &str) -> String {
    let has = |key: &str| stated.get("channels").and_then(|channels| channels.get(key)).is_some();
    let (mut added, mut comments) = (String::new(), String::new());
    for line in proposal[section(proposal, "channels")].lines().skip(1) {
        if line.starts_with('#') && !line.ends_with("= \"\"") {
            comments.push_str(&format!("{line}\n"));
            continue;
        }
        if line.split_once('=').is_some_and(|(key, _)| !key.starts_with('#') && !has(key.trim())) {
            added.push_str(&format!("{comments}{line}\n"));
        }
        // A role without a channel is a comment alone.
        comments.clear();
    }
    match stated.contains_key("channels") {
        _ if added.is_empty() => text.to_owned(),
        true => with_lines(text, section(text, "channels").end, &added),
        false => format!("{}\n\n[channels]\n{added}", text.trim_end()),
    }
}

/// Where a table is in a text: from its head to its last line, without what belongs to the next one.
fn section(text: &str, name: &str) -> std::ops::Range<usize> {
    let head = format!("[{name}]");
    let (mut place, mut at) = (text.len()..text.len(), 0);
    for line in text.split_inclusive('\n') {
        let words = line.trim();
        let is_head = words.starts_with('[');
        if is_head && place.start < at {
            return place;
        }
        if words.starts_with(&head) {
            place = at..at + line.len();
        } else if place.start < at && !words.is_empty() && !words.starts_with('#') {
            place.end = at + line.len();
        }
        at += line.len();
    }
    place
}

/// The text with lines at a place where a line ends.
fn with_lines(text: &str, at: usize, lines: &str) -> String {
    let (before, after) = text.split_at(at);
    let joint = if before.ends_with('\n') || before.is_empty() { "" } else { "\n" };
    format!("{before}{joint}{lines}{after}")
}

/// The patterns that stand for a recording which the bench file does not list.
fn new_files<'a>(bench: &Path, stated: &Table, files: &'a [(String, Vec<PathBuf>)]) -> Vec<&'a str> {
    let list = stated.get("recordings").and_then(|recordings| recordings.get("files")).and_then(toml::Value::as_array);
    let patterns: Vec<String> =
        list.into_iter().flatten().filter_map(|pattern| Some(pattern.as_str()?.to_owned())).collect();
    // A pattern that matches nothing any more says nothing of the others.
    let listed: Vec<_> = patterns
        .iter()
        .filter_map(|pattern| listed(bench, std::slice::from_ref(pattern)).ok())
        .flatten()
        .filter_map(|file| file.path.canonicalize().ok())
        .collect();
    let is_new = |path: &PathBuf| path.canonicalize().is_ok_and(|path| !listed.contains(&path));
    files.iter().filter(|(_, found)| found.iter().any(is_new)).map(|(pattern, _)| pattern.as_str()).collect()
}

/// The text with further entries in the list of recordings.
fn with_files(text: String, new: &[&str]) -> String {
    if new.is_empty() {
        return text;
    }
    let entries: Vec<String> = new.iter().map(|pattern| toml::Value::from(*pattern).to_string()).collect();
    let place = section(&text, "recordings");
    let Some(last) = last_entry(&text[place.clone()]).map(|end| place.start + end) else {
        let list = format!("files = [{}]\n", entries.join(", "));
        return match place.is_empty() {
            true => format!("{}\n\n[recordings]\n{list}", text.trim_end()),
            false => with_lines(&text, place.start + text[place.clone()].find('\n').map_or(0, |end| end + 1), &list),
        };
    };
    let (before, after) = text.split_at(last);
    let joint = if before.ends_with('[') { "" } else { ", " };
    format!("{}{joint}{}{after}", before.trim_end_matches(','), entries.join(", "))
}

/// Where the last entry of the list `files` in a table's text ends, with its comma.
fn last_entry(table: &str) -> Option<usize> {
    let begin = table.find("\nfiles").map(|at| at + 1)?;
    let (mut quote, mut is_comment, mut last) = (None, false, begin);
    for (at, c) in table[begin..].char_indices() {
        match (quote, c) {
            _ if is_comment => is_comment = c != '\n',
            (None, '#') => is_comment = true,
            (None, ']') => return Some(last),
            (None, '"' | '\'') => quote = Some(c),
            (Some(open), c) if open == c => quote = None,
            _ => {}
        }
        if !is_comment && !c.is_whitespace() {
            last = begin + at + c.len_utf8();
        }
    }
    None
}

/// The text with the places for labels that it does not have.
fn with_labels(text: String, stated: &Table, proposed: &Table) -> String {
    let known = labels(stated);
    let place = |file: &String| {
        let (file, placeholder) = (toml::Value::from(file.as_str()), rig::bench_file::PLACEHOLDER);
        format!("\n[[recordings.label]]\nfile = {file}\nlabel = \"{placeholder}\" # e.g. \"BS_T_NT\"\n")
    };
    let new: String = labels(proposed).iter().filter(|file| !known.contains(file)).map(place).collect();
    match new.is_empty() {
        true => text,
        false => with_lines(&text, text.len(), &new),
    }
}
