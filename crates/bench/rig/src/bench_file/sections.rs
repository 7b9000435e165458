//! Walking a TOML document key by key, so that every fault knows its line.

use recording::names::likely_meant;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::fault::{BenchFileError, Fault, FaultKind};
use crate::bench_file::stated::PLACEHOLDER;

/// The text and the faults found in it so far.
pub(super) struct Faults<'t> {
    text: &'t str,
    /// Where lines end.
    ends: Vec<usize>,
    found: Vec<(usize, Fault)>,
}

impl<'t> Faults<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Faults { text, ends: text.match_indices('\n').map(|(at, _)| at).collect(), found: Vec::new() }
    }

    /// Notes a fault at a byte of the text.
    pub(super) fn add(&mut self, offset: usize, key: impl Into<String>, kind: FaultKind) {
        let offset = offset.min(self.text.len());
        let line = 1 + self.ends.partition_point(|end| *end < offset);
        self.found.push((offset, Fault { line, key: key.into(), kind }));
    }

    /// The faults in the order of the text.
    pub(super) fn into_error(mut self) -> BenchFileError {
        self.found.sort_by_key(|(offset, _)| *offset);
        BenchFileError { faults: self.found.into_iter().map(|(_, fault)| fault).collect() }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.found.is_empty()
    }
}

/// A value with its place.
#[derive(Clone, Copy)]
pub(super) struct Place<'v, 'i> {
    pub(super) value: &'v DeValue<'i>,
    pub(super) offset: usize,
}

impl<'v, 'i> Place<'v, 'i> {
    fn of(value: &'v Spanned<DeValue<'i>>) -> Self {
        Place { value: value.get_ref(), offset: value.span().start }
    }

    /// Tells whether `init` left the value to be filled in.
    pub(super) fn is_placeholder(self) -> bool {
        self.value.as_str().is_some_and(|text| text.trim().eq_ignore_ascii_case(PLACEHOLDER))
    }

    /// The number, if the value is one.
    pub(super) fn number(self) -> Option<f64> {
        match self.value {
            DeValue::Float(number) => number.as_str().parse().ok(),
            DeValue::Integer(number) => i64::from_str_radix(number.as_str(), number.radix()).ok().map(|n| n as f64),
            _ => None,
        }
    }

    /// The elements, if the value is an array.
    pub(super) fn elements(self) -> Option<Vec<Place<'v, 'i>>> {
        Some(self.value.as_array()?.iter().map(Place::of).collect())
    }

    /// The fault of a value of the wrong type.
    pub(super) fn wrong_type(self, expected: &'static str, example: &str) -> FaultKind {
        if self.is_placeholder() {
            return FaultKind::Placeholder { example: example.to_owned() };
        }
        FaultKind::WrongType { found: self.value.type_str(), expected, example: example.to_owned() }
    }
}

/// One table of the document.
#[derive(Clone)]
pub(super) struct Section<'v, 'i> {
    table: Option<&'v DeTable<'i>>,
    path: String,
    offset: usize,
}

impl<'v, 'i> Section<'v, 'i> {
    /// The document itself.
    pub(super) fn root(table: &'v DeTable<'i>) -> Self {
        Section { table: Some(table), path: String::new(), offset: 0 }
    }

    /// The table a value holds.
    pub(super) fn of(place: Place<'v, 'i>, path: String) -> Option<Self> {
        Some(Section { table: Some(place.value.as_table()?), path, offset: place.offset })
    }

    /// The table itself, if there is one.
    pub(super) fn table(&self) -> Option<&'v DeTable<'i>> {
        self.table
    }

    /// Where it stands.
    pub(super) fn offset(&self) -> usize {
        self.offset
    }

    /// The table of a key; an absent one is an empty table at the end of this one's head.
    pub(super) fn section(&self, key: &str, faults: &mut Faults<'_>) -> Self {
        let empty = Section { table: None, path: self.path_of(key), offset: self.offset };
        let Some(place) = self.get(key) else { return empty };
        Section::of(place, self.path_of(key)).unwrap_or_else(|| {
            faults.add(place.offset, self.path_of(key), place.wrong_type("a table", &format!("[{key}]")));
            empty
        })
    }

    /// The value of a key.
    pub(super) fn get(&self, key: &str) -> Option<Place<'v, 'i>> {
        self.table?.iter().find(|(name, _)| name.get_ref() == key).map(|(_, value)| Place::of(value))
    }

    /// The key with its tables.
    pub(super) fn path_of(&self, key: &str) -> String {
        if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) }
    }

    /// The value of a key that must be there.
    pub(super) fn require(&self, key: &str, example: &str, faults: &mut Faults<'_>) -> Option<Place<'v, 'i>> {
        let place = self.get(key);
        match place {
            None => self.missing(key, example, faults),
            Some(place) if place.is_placeholder() => {
                faults.add(place.offset, self.path_of(key), FaultKind::Placeholder { example: example.to_owned() });
                return None;
            }
            Some(_) => {}
        }
        place
    }

    /// Notes that a key is missing.
    pub(super) fn missing(&self, key: &str, example: &str, faults: &mut Faults<'_>) {
        faults.add(self.offset, self.path_of(key), FaultKind::Missing { example: format!("{key} = {example}") });
    }

    /// The text of a value.
    pub(super) fn text(
        &self,
        key: &str,
        place: Place<'v, 'i>,
        example: &str,
        faults: &mut Faults<'_>,
    ) -> Option<String> {
        let text = place.value.as_str().map(str::to_owned);
        if text.is_none() {
            faults.add(place.offset, self.path_of(key), place.wrong_type("a text", example));
        }
        text
    }

    /// A text in one line of characters that people can read.
    pub(super) fn line(
        &self,
        key: &str,
        place: Place<'v, 'i>,
        example: &str,
        faults: &mut Faults<'_>,
    ) -> Option<String> {
        let text = self.text(key, place, example, faults)?;
        let Some(found) = text.chars().find(|c| c.is_control()) else { return Some(text) };
        let code = format!("U+{:04X}", u32::from(found));
        faults.add(place.offset, self.path_of(key), FaultKind::ControlCharacter { code });
        None
    }

    /// A number between two others, if the key is there.
    pub(super) fn number_between(
        &self,
        key: &str,
        (low, high): (f64, f64),
        remedy: &str,
        faults: &mut Faults<'_>,
    ) -> Option<f64> {
        let place = self.get(key)?;
        let Some(value) = place.number() else {
            faults.add(place.offset, self.path_of(key), place.wrong_type("a number", &format!("{key} = {low}")));
            return None;
        };
        if (low..=high).contains(&value) {
            return Some(value);
        }
        let kind = FaultKind::OutOfRange { value, low, high, remedy: remedy.to_owned() };
        faults.add(place.offset, self.path_of(key), kind);
        None
    }

    /// Notes every key that is not one of `known`; says whether there is one.
    pub(super) fn only(&self, known: &[&str], faults: &mut Faults<'_>) -> bool {
        let mut found = false;
        for (name, _) in self.table.into_iter().flatten() {
            let key: &str = name.get_ref();
            if !known.contains(&key) {
                let kind = FaultKind::UnknownKey {
                    closest: likely_meant(key, known.iter().copied()),
                    known: known.iter().map(|&key| key.to_owned()).collect(),
                };
                faults.add(name.span().start, self.path_of(key), kind);
                found = true;
            }
        }
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines were counted from the beginning for each fault, which took hours.
    #[test]
    fn regress_many_faults_are_noted_in_a_time_that_grows_with_their_number() {
        let text = "[t]\n".repeat(200_000);
        let mut faults = Faults::new(&text);
        (0..200_000).rev().for_each(|line| faults.add(4 * line + 1, "t", FaultKind::Excludes { other: "t" }));
        let found = faults.into_error().faults;
        assert!(found.iter().enumerate().all(|(index, fault)| fault.line == index + 1));
    }
}
