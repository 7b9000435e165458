//! A short account of the method, the same in every report.

use page::markup::Markup;

/// The methods appendix.
pub(crate) fn section() -> Markup {
    Markup::raw(include_str!("../../assets/methods.html"))
}
