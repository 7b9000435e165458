//! Regular expressions that are written in this program.

use regex_lite::Regex;

/// An expression that is known to be right.
#[expect(clippy::expect_used)]
pub(super) fn compiled(expression: &str) -> Regex {
    Regex::new(expression).expect("a regular expression")
}
