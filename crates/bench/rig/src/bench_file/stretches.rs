//! Stretches of recordings in a bench file.

use super::fault::FaultKind;
use super::sections::{Faults, Place, Section};
use super::stated::{StatedStretch, StretchUse, names_same_file};

const HEAD: &str = "[[recordings.stretch]]";
const FILE: &str = "\"run_17.mf4\"";
const EXAMPLE: &str = "leave_out = [12.5, 14.0]";

/// The stretches of the section on recordings; those that have faults are noted and left away.
pub(super) fn read(recordings: &Section<'_, '_>, faults: &mut Faults<'_>) -> Vec<StatedStretch> {
    let Some(place) = recordings.get("stretch") else { return Vec::new() };
    let Some(elements) = place.elements() else {
        faults.add(place.offset, recordings.path_of("stretch"), place.wrong_type("an array of tables", HEAD));
        return Vec::new();
    };
    let mut stretches: Vec<StatedStretch> = Vec::new();
    for element in elements {
        let Some((stretch, offset)) = read_one(recordings, element, faults) else { continue };
        // A file may be named with its folders or without.
        let shares_time = |other: &&StatedStretch| {
            names_same_file(&stretch.file, &other.file) && stretch.from_s < other.to_s && other.from_s < stretch.to_s
        };
        match stretches.iter().find(shares_time) {
            Some(other) => {
                let kind = FaultKind::StretchesOverlap { from_s: other.from_s, to_s: other.to_s };
                faults.add(offset, format!("{}.{}", recordings.path_of("stretch"), stretch.usage.key()), kind);
            }
            None => stretches.push(stretch),
        }
    }
    stretches
}

/// A stretch, and where its times stand.
fn read_one(
    recordings: &Section<'_, '_>,
    place: Place<'_, '_>,
    faults: &mut Faults<'_>,
) -> Option<(StatedStretch, usize)> {
    let path = recordings.path_of("stretch");
    let Some(section) = Section::of(place, path.clone()) else {
        faults.add(place.offset, path, place.wrong_type("a table", HEAD));
        return None;
    };
    let keys: Vec<&str> = std::iter::once("file").chain(StretchUse::ALL.map(StretchUse::key)).collect();
    let has_unknown = section.only(&keys, faults);
    let file = section.require("file", FILE, faults).and_then(|place| section.text("file", place, FILE, faults));
    let mut stated = StretchUse::ALL.into_iter().filter_map(|usage| Some((usage, section.get(usage.key())?)));
    let Some((usage, times)) = stated.next() else {
        // A misspelt key is a fault of its own.
        if !has_unknown {
            faults.add(section.offset(), path, FaultKind::Missing { example: EXAMPLE.to_owned() });
        }
        return None;
    };
    if let Some((_, second)) = stated.next() {
        faults.add(second.offset, path, FaultKind::TwoUses { first: usage.key() });
        return None;
    }
    let (from_s, to_s) = read_times(&section, usage.key(), times, faults)?;
    Some((StatedStretch { file: file?, from_s, to_s, usage }, times.offset))
}

/// The beginning and the end of a stretch, s.
fn read_times(
    section: &Section<'_, '_>,
    key: &'static str,
    place: Place<'_, '_>,
    faults: &mut Faults<'_>,
) -> Option<(f64, f64)> {
    let numbers: Option<Vec<f64>> =
        place.elements().and_then(|elements| elements.into_iter().map(Place::number).collect());
    let Some([from_s, to_s]) = numbers.as_deref().filter(|numbers| numbers.iter().all(|s| s.is_finite())) else {
        let kind = place.wrong_type("a list of its beginning and its end in s", &format!("{key} = [12.5, 14.0]"));
        faults.add(place.offset, section.path_of(key), kind);
        return None;
    };
    let (from_s, to_s) = (*from_s, *to_s);
    if from_s < to_s {
        return Some((from_s, to_s));
    }
    faults.add(place.offset, section.path_of(key), FaultKind::EmptyStretch { from_s, to_s });
    None
}
