//! Text inside XML and HTML.

/// A text in XML or HTML. Control characters, of which XML allows none that a name needs, are left out.
///
/// # Source
/// Extensible Markup Language (XML) 1.0, 5th ed., production 2.
pub(crate) fn escaped(text: &str) -> String {
    let allowed: String = text.chars().filter(|c| !c.is_control() && !['\u{fffe}', '\u{ffff}'].contains(c)).collect();
    allowed.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
