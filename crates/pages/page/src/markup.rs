//! Text that is safe to put into the page.
//!
//! [`markup!`](crate::markup!) works like `format!`, but escapes every argument unless its type is [`Markup`] already.
//! So a file name cannot become part of the page's structure by being forgotten: only this module and the page's own
//! literals do.

use std::borrow::Cow;
use std::fmt;

/// A piece of HTML.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Markup(String);

impl Markup {
    /// HTML of the page's own.
    pub fn raw(html: impl Into<String>) -> Self {
        Markup(html.into())
    }

    /// The HTML as text.
    pub fn into_string(self) -> String {
        self.0
    }

    /// The HTML.
    pub(crate) fn as_str(&self) -> &str {
        &self.0
    }

    /// Returns true if there is nothing in it.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Puts another piece behind this one.
    pub fn push(&mut self, other: Markup) {
        self.0.push_str(&other.0);
    }
}

impl FromIterator<Markup> for Markup {
    fn from_iter<I: IntoIterator<Item = Markup>>(pieces: I) -> Self {
        let mut all = Markup::default();
        pieces.into_iter().for_each(|piece| all.push(piece));
        all
    }
}

impl fmt::Display for Markup {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Something [`markup!`](crate::markup!) can place.
pub trait Place {
    /// The HTML of it.
    fn place(&self) -> Cow<'_, str>;
}

impl Place for Markup {
    fn place(&self) -> Cow<'_, str> {
        Cow::Borrowed(&self.0)
    }
}

impl Place for str {
    fn place(&self) -> Cow<'_, str> {
        escape(self)
    }
}

impl Place for String {
    fn place(&self) -> Cow<'_, str> {
        escape(self)
    }
}

impl Place for usize {
    fn place(&self) -> Cow<'_, str> {
        Cow::Owned(self.to_string())
    }
}

impl<T: Place + ?Sized> Place for &T {
    fn place(&self) -> Cow<'_, str> {
        (**self).place()
    }
}

/// `format!` for HTML: arguments are escaped unless they are [`Markup`].
#[macro_export]
macro_rules! markup {
    ($template:literal $(, $argument:expr)* $(,)?) => {
        $crate::markup::Markup::raw(format!(
            $template
            $(, $crate::markup::Place::place(&$argument))*
        ))
    };
}

/// The text with HTML's special characters escaped, fit for content and for quoted attributes. Control characters that
/// HTML does not allow become the replacement character, and so do the ones that turn the direction of writing, with
/// which a file name could pretend to be another.
pub fn escape(text: &str) -> Cow<'_, str> {
    let harmless = |c: char| !matches!(c, '&' | '<' | '>' | '"' | '\'') && !is_hidden(c);
    if text.chars().all(harmless) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            hidden if is_hidden(hidden) => escaped.push('\u{fffd}'),
            plain => escaped.push(plain),
        }
    }
    Cow::Owned(escaped)
}

fn is_hidden(c: char) -> bool {
    (c.is_control() && !matches!(c, '\n' | '\t' | '\r'))
        || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// JSON fit for a `<script>` element: no `<`, so neither `</script>` nor `<!--` can occur in it, and none of the
/// characters [`escape`] hides.
pub fn script_json(value: &impl serde::Serialize) -> Markup {
    let json = serde_json::to_string(value).unwrap_or_else(|_| "null".to_owned());
    Markup::raw(json.replace('<', "\\u003c").replace(is_hidden, "\u{fffd}"))
}
