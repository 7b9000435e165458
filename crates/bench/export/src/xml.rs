//! Text inside XML and HTML.

use crate::names::is_refused;

/// A text in XML or HTML, without what XML refuses, and without control characters that it allows: no name needs them.
pub(crate) fn escaped(text: &str) -> String {
    let allowed: String = text.chars().filter(|c| !is_refused(*c)).collect();
    allowed.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
