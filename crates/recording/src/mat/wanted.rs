//! Which variables have to be read for the channels that are selected.

use std::collections::HashSet;

use super::labels::clock_unit;
use crate::{Selection, names};

/// Arrays with fewer numbers are read whatever their name: they may say something about others.
const SMALL: usize = 1 << 12;
/// Names of arrays whose channels may be called otherwise.
const RENAMED: [&str; 5] = ["values", "u", "y", "inputdata", "outputdata"];

/// What is asked for.
pub(super) struct Wanted<'a> {
    selection: &'a Selection,
    /// The variables that the file's own list gives for the selected channels, and all that it gives.
    pub(super) listed: Option<(HashSet<String>, HashSet<String>)>,
}

impl<'a> Wanted<'a> {
    pub(super) fn new(selection: &'a Selection) -> Self {
        Self { selection, listed: None }
    }

    /// Everything, whatever is selected.
    pub(super) const ALL: Wanted<'static> = Wanted { selection: &Selection::All, listed: None };

    /// Whether an array is neither a selected channel nor a clock; `path` is its place in the file.
    pub(super) fn skips(&self, path: &str, dimensions: &[usize]) -> bool {
        let numbers = dimensions.iter().fold(1_usize, |product, &d| product.saturating_mul(d));
        let name = path.rsplit('.').next().unwrap_or(path);
        if numbers < SMALL || clock_unit(name).is_some() {
            return false;
        }
        if let Some((wanted, all)) = &self.listed
            && all.contains(path)
        {
            return !wanted.contains(path);
        }
        let is_vector = dimensions.iter().filter(|&&d| d != 1).count() <= 1;
        !RENAMED.contains(&name.to_lowercase().as_str()) && !self.asks_for(path, is_vector)
    }

    /// Whether an array, or a row or column of it, is selected.
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
