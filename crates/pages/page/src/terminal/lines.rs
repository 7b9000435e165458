//! Text in lines of a width.

use unicode_width::{UnicodeWidthChar, UnicodeWidthStr};

/// Characters after which a long word, such as a path, may go on in the next line.
const BREAKS: [char; 5] = ['/', '\\', ',', '_', '='];

/// The text broken at spaces into lines of at most `width` columns. A word that is longer is broken too. At least one
/// line.
pub(super) fn wrap(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let last = lines.len() - 1;
        let line = &mut lines[last];
        if line.is_empty() {
            line.push_str(word);
        } else if line.width() + 1 + word.width() <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines.iter().flat_map(|line| broken(line, width)).collect()
}

/// The text in pieces of at most `width` columns, broken behind a sign such as `/` where one is near the end. At least
/// one piece.
pub(super) fn broken(text: &str, width: usize) -> Vec<String> {
    let mut pieces = Vec::new();
    let mut rest = text;
    while let Some(end) = end_of_piece(rest, width.max(1)) {
        let (piece, behind) = rest.split_at(end);
        pieces.push(piece.to_owned());
        rest = behind;
    }
    pieces.push(rest.to_owned());
    pieces
}

/// Where the first piece of a text that is too long ends: at least one character, at most `width` columns. None where
/// all of it fits. No more of the text is looked at than that takes, so that a long text is broken in a time that grows
/// with its length.
fn end_of_piece(text: &str, width: usize) -> Option<usize> {
    let mut columns = 0;
    let mut end = 0;
    let mut behind_sign = 0;
    for (at, c) in text.char_indices() {
        columns += c.width().unwrap_or(0);
        if columns > width && end > 0 {
            let end = if 2 * behind_sign > end { behind_sign } else { end };
            return (!fits_joined(text, width)).then_some(end);
        }
        end = at + c.len_utf8();
        if BREAKS.contains(&c) {
            behind_sign = end;
        }
    }
    None
}

/// Tells whether a text fits since characters in it are joined, and take fewer columns than each by itself.
fn fits_joined(text: &str, width: usize) -> bool {
    /// More than joined characters have for a column.
    const MOST_BYTES: usize = 32;
    text.len() <= MOST_BYTES * width && text.width() <= width
}

/// Columns of the longest word.
pub(super) fn longest_word(text: &str) -> usize {
    text.split(' ').map(UnicodeWidthStr::width).max().unwrap_or(0)
}
