//! Acts of somebody at a page.

use serde::{Deserialize, Serialize};

/// Option by which a page gets numbers in place of text.
const FOR_PAGES: &str = "--json";
/// Option by which a page draws a result for itself.
const DRAWN_FOR_PAGES: &str = "--plot=.dynoid/";

/// An act of somebody at a page.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Act {
    /// A command was started; its words, without what the page needs for itself.
    Command(Vec<String>),
    /// A text was saved.
    Saved {
        /// Name of the file in the folder.
        file: String,
        text: String,
    },
}

impl Act {
    /// The act of starting a command.
    pub(crate) fn of_command(words: &[String]) -> Self {
        let is_own = |word: &&String| word.as_str() != FOR_PAGES && !word.starts_with(DRAWN_FOR_PAGES);
        Act::Command(words.iter().filter(is_own).cloned().collect())
    }
}
