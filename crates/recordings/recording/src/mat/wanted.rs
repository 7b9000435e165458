//! Which variables have to be read for the channels that are selected.

use std::collections::HashSet;

use super::labels::clock_unit;
use crate::{Selection, names};

/// Arrays with fewer numbers are read whatever their name: they may say something about others.
const SMALL: usize = 1 << 12;
/// A path that no selection has, since what is in cells is read.
pub(super) const IN_CELL: &str = "{}";
/// Names of arrays whose channels may be called otherwise.
const RENAMED: [&str; 5] = ["values", "u", "y", "inputdata", "outputdata"];

/// How much of an array is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Need {
    Values,
    /// Its dimensions, to list it.
    Shape,
    /// Its dimensions, and where it is, to read parts of it.
    Place,
    Nothing,
}

/// Purpose of a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    /// Channels are read.
    Read,
    /// Channels are listed.
    List,
    /// Channels are found, of which parts are read later.
    Find,
}

/// Request to the reader.
pub(super) struct Wanted<'a> {
    pub(super) selection: &'a Selection,
    purpose: Purpose,
    /// The variables that the file's own list gives for the selected channels, and all that it gives.
    pub(super) listed: Option<(HashSet<String>, HashSet<String>)>,
}

impl<'a> Wanted<'a> {
    pub(super) fn new(selection: &'a Selection) -> Self {
        Self { selection, purpose: Purpose::Read, listed: None }
    }

    /// Request for the places of channels, as far as parts of them can be read.
    pub(super) fn places(selection: &'a Selection) -> Self {
        Self { purpose: Purpose::Find, ..Self::new(selection) }
    }

    /// Everything, whatever is selected.
    pub(super) const ALL: Wanted<'static> = Wanted { selection: &Selection::All, purpose: Purpose::Read, listed: None };

    /// Request for a list of all channels.
    pub(super) const LIST: Wanted<'static> =
        Wanted { selection: &Selection::All, purpose: Purpose::List, listed: None };

    /// The same of all channels.
    #[cfg(feature = "hdf5")]
    pub(super) fn of_all(self) -> Wanted<'static> {
        Wanted { selection: &Selection::All, purpose: self.purpose, listed: None }
    }

    /// How much is asked for of an array, whose place in the file is `path`: all of selected channels, of clocks, and
    /// of what is small.
    pub(super) fn need(&self, path: &str, dimensions: &[usize]) -> Need {
        let numbers = dimensions.iter().fold(1_usize, |product, &d| product.saturating_mul(d));
        let name = path.rsplit('.').next().unwrap_or(path);
        if numbers < SMALL || clock_unit(name).is_some() || path.starts_with(IN_CELL) {
            return Need::Values;
        }
        let is_vector = dimensions.iter().filter(|&&d| d != 1).count() <= 1;
        let is_wanted = match &self.listed {
            Some((wanted, all)) if all.contains(path) => wanted.contains(path),
            _ => RENAMED.contains(&name.to_lowercase().as_str()) || self.asks_for(path, is_vector),
        };
        match (is_wanted, self.purpose) {
            (false, _) => Need::Nothing,
            (true, Purpose::Read) => Need::Values,
            (true, Purpose::List) => Need::Shape,
            (true, Purpose::Find) => Need::Place,
        }
    }

    /// Returns true if anything in the struct or object at `path` may be selected.
    pub(super) fn reaches_into(&self, path: &str) -> bool {
        let is_within = |name: &String| name.strip_prefix(path).is_some_and(|rest| rest.starts_with('.'));
        match self.selection {
            Selection::All => true,
            Selection::Names(names) => names.iter().any(is_within),
            Selection::Patterns(patterns) => patterns.iter().any(|p| p.contains(['*', '?']) || is_within(p)),
        }
    }

    /// Returns true if an array, or a row or column of it, is selected.
    fn asks_for(&self, path: &str, is_vector: bool) -> bool {
        let is_part = |name: &String| name.strip_prefix(path).is_some_and(|rest| rest.starts_with('('));
        match self.selection {
            Selection::All => true,
            Selection::Names(names) => names.iter().any(|name| name == path || is_part(name)),
            Selection::Patterns(patterns) => patterns.iter().any(|pattern| {
                let is_wild = pattern.contains(['*', '?']);
                pattern == path || is_part(pattern) || names::matches(pattern, path) || (is_wild && !is_vector)
            }),
        }
    }
}
