//! Which channels are taken from which of several recordings.

use recording::{Catalogue, Finding, Selection, names};

use super::targets::Target;
use crate::error::Error;
use crate::files::Files;
use crate::read;

/// The channels that are taken from a recording.
pub(super) struct Choice {
    /// None where it has nothing of what was asked for.
    pub(super) selection: Option<Selection>,
    /// Part that was asked for and is not in this one of several.
    pub(super) without: Option<String>,
}

/// The channels to be taken from each recording: every pattern has to fit in one at least.
pub(super) fn choices(targets: &[Target], patterns: &[String], files: &Files) -> Result<Vec<Choice>, Error> {
    let whole = || Choice { selection: Some(read::selection(patterns)), without: None };
    if patterns.is_empty() || targets.len() < 2 {
        return Ok(targets.iter().map(|_| whole()).collect());
    }
    // One that cannot be listed says why when it is read.
    let listed: Vec<Option<Vec<String>>> =
        targets.iter().map(|target| files.catalogue(&target.input).ok().map(named)).collect();
    let known = || listed.iter().flatten().flatten().map(String::as_str);
    let fits = |pattern: &str, names: &[String]| {
        let selection = read::selection(&[pattern.to_owned()]);
        names.iter().any(|name| selection.takes(name))
    };
    let is_anywhere = |pattern: &&String| listed.iter().any(|names| names.as_ref().is_none_or(|n| fits(pattern, n)));
    if let Some(nowhere) = patterns.iter().find(|pattern| !is_anywhere(pattern)) {
        let closest = names::closest(nowhere, known(), 3);
        return Err(Error::NoSuchChannel { pattern: nowhere.clone(), closest });
    }
    let choice = |names: &Option<Vec<String>>| {
        let Some(names) = names else { return whole() };
        let (here, missing): (Vec<String>, Vec<String>) = patterns.iter().cloned().partition(|p| fits(p, names));
        Choice {
            selection: (!here.is_empty()).then(|| read::selection(&here)),
            without: (!missing.is_empty()).then(|| format!("it has no channel {}", missing.join(", "))),
        }
    };
    Ok(listed.iter().map(choice).collect())
}

/// The names of a recording's channels, those that are no numbers over time included.
fn named(catalogue: Catalogue) -> Vec<String> {
    let skipped = catalogue.findings.into_iter().filter_map(|finding| match finding {
        Finding::SkippedChannel { channel, .. } => Some(channel),
        _ => None,
    });
    catalogue.channels.into_iter().map(|channel| channel.name).chain(skipped).collect()
}
