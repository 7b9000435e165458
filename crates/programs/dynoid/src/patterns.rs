//! Files by the patterns of a bench file.
//!
//! Names are compared as they are shown, so that one that is not UTF-8 is found like any other.

use std::collections::BTreeSet;
use std::io;
use std::path::{Component, Path, PathBuf};

use glob::{Pattern, PatternError};

/// Why a pattern gives no files.
pub(crate) enum PatternFault {
    Pattern(PatternError),
    Unreadable { path: PathBuf, source: io::Error },
}

/// A part of a pattern, between slashes.
enum Part<'p> {
    /// A component that stands for itself.
    Fixed(Component<'p>),
    /// Names that fit, in one folder.
    Names(Pattern),
    /// `**`: a folder and all below it.
    Below,
}

/// The files that a pattern stands for, seen from a folder, in order.
pub(crate) fn files(folder: &Path, pattern: &str) -> Result<Vec<PathBuf>, PatternFault> {
    let parts: Vec<Part<'_>> =
        Path::new(pattern).components().map(part).collect::<Result<_, _>>().map_err(PatternFault::Pattern)?;
    let mut places = vec![folder.to_owned()];
    for part in &parts {
        let mut next = Vec::new();
        for place in &places {
            next.extend(match part {
                Part::Fixed(component) => vec![place.join(component)],
                Part::Names(names) => named(place, names)?,
                Part::Below => below(place)?,
            });
        }
        places = next;
    }
    places.retain(|place| place.is_file());
    Ok(places)
}

fn part(component: Component<'_>) -> Result<Part<'_>, PatternError> {
    let Component::Normal(name) = component else { return Ok(Part::Fixed(component)) };
    match name.to_string_lossy().as_ref() {
        "**" => Ok(Part::Below),
        // What is shown for a byte that is no UTF-8 may be written into a pattern too.
        name if name.contains(['*', '?', '[', char::REPLACEMENT_CHARACTER]) => Pattern::new(name).map(Part::Names),
        _ => Ok(Part::Fixed(component)),
    }
}

/// The entries of a folder, sorted; none of what is no folder.
fn entries(folder: &Path) -> Result<Vec<PathBuf>, PatternFault> {
    let failed = |source| PatternFault::Unreadable { path: folder.to_owned(), source };
    if !folder.is_dir() {
        return Ok(Vec::new());
    }
    let found = std::fs::read_dir(folder).map_err(failed)?;
    let mut paths =
        found.map(|entry| entry.map(|entry| entry.path())).collect::<Result<Vec<_>, _>>().map_err(failed)?;
    paths.sort();
    Ok(paths)
}

fn named(folder: &Path, names: &Pattern) -> Result<Vec<PathBuf>, PatternFault> {
    let fits = |path: &PathBuf| path.file_name().is_some_and(|name| names.matches(&name.to_string_lossy()));
    Ok(entries(folder)?.into_iter().filter(fits).collect())
}

/// A folder and all below it, each once, whatever links lead back to one.
fn below(folder: &Path) -> Result<Vec<PathBuf>, PatternFault> {
    let (mut found, mut seen, mut open) = (Vec::new(), BTreeSet::new(), vec![folder.to_owned()]);
    while let Some(folder) = open.pop() {
        let is_new = folder.canonicalize().is_ok_and(|path| path.is_dir() && seen.insert(path));
        if is_new {
            open.extend(entries(&folder)?.into_iter().filter(|path| path.is_dir()).rev());
            found.push(folder);
        }
    }
    Ok(found)
}
