//! Text broken into lines by the widths of its glyphs.

use std::collections::BTreeSet;
use std::rc::Rc;

use super::font::{Face, Fonts};
use crate::prose::{Inline, Prose};
use crate::tone::Tone;

/// A colour: red, green and blue from 0 to 1.
pub(super) type Colour = [f32; 3];

pub(super) const INK: Colour = rgb(0x1d232a);
pub(super) const SOFT: Colour = rgb(0x56616d);
pub(super) const LINE: Colour = rgb(0xdce1e6);
pub(super) const WASH: Colour = rgb(0xf5f7f9);
const LINK: Colour = rgb(0x14568c);

const fn rgb(hex: u32) -> Colour {
    let [_, red, green, blue] = hex.to_be_bytes();
    [red as f32 / 255.0, green as f32 / 255.0, blue as f32 / 255.0]
}

/// The colour of a tone, dark enough to be read in grey.
pub(super) fn colour(tone: Tone) -> Colour {
    match tone {
        Tone::Plain | Tone::Strong => INK,
        Tone::Faint => SOFT,
        Tone::Good => rgb(0x1b7a55),
        Tone::Caution => rgb(0x9a5b00),
        Tone::Bad => rgb(0xb02a20),
    }
}

/// Height of a line per size of the font.
const LEADING: f32 = 1.42;
/// From the top of a line to its base, per size of the font.
const BASE: f32 = 1.06;
/// Size of an index or power, and of a tag, per size of the text around it.
const SMALL: f32 = 0.72;
const TAG: f32 = 0.84;
/// An index's shift below the base, per size of the text around it.
const BELOW: f32 = -0.18;
/// From a tag's text to its frame, and behind the frame.
pub(super) const TAG_PADDING: f32 = 3.0;
pub(super) const TAG_MARGIN: f32 = 1.6;
/// Signs after which a long word, such as a path, may go on in the next line.
const BREAKS: &str = "/\\,_=-·\u{a0}";

/// How a piece of text looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Style {
    pub(super) face: Face,
    pub(super) size: f32,
    /// Height above the base of the line.
    pub(super) rise: f32,
    pub(super) colour: Colour,
    pub(super) is_slanted: bool,
    /// True if it has a frame.
    pub(super) is_tag: bool,
}

impl Style {
    pub(super) fn new(face: Face, size: f32, colour: Colour) -> Self {
        Style { face, size, rise: 0.0, colour, is_slanted: false, is_tag: false }
    }

    /// An index or a power, `shift` sizes above the base.
    pub(super) fn small(self, shift: f32) -> Self {
        Style { size: SMALL * self.size, rise: self.rise + shift * self.size, ..self }
    }

    pub(super) fn line_height(self) -> f32 {
        LEADING * self.size
    }

    /// From the top of a line to its base.
    pub(super) fn base(self) -> f32 {
        BASE * self.size
    }
}

/// Where words lead, and which of the links of a text they belong to.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Link {
    pub(super) number: usize,
    pub(super) target: Rc<str>,
}

/// Text of one look.
#[derive(Debug, Clone)]
pub(super) struct Fragment {
    pub(super) text: String,
    pub(super) style: Style,
    pub(super) width: f32,
    pub(super) link: Option<Link>,
}

/// A line: its fragments, each with its place from the left.
#[derive(Debug, Clone, Default)]
pub(super) struct Line {
    pub(super) fragments: Vec<(f32, Fragment)>,
    pub(super) width: f32,
}

impl Line {
    fn push(&mut self, fragment: Fragment) {
        let width = fragment.width;
        match self.fragments.last_mut() {
            Some((_, last)) if last.style == fragment.style && last.link == fragment.link && !last.style.is_tag => {
                last.text.push_str(&fragment.text);
                last.width += width;
            }
            _ => self.fragments.push((self.width, fragment)),
        }
        self.width += width;
    }
}

/// Words without a space between them, and the space before them.
struct Word {
    space: Option<Fragment>,
    fragments: Vec<Fragment>,
}

impl Word {
    fn width(&self) -> f32 {
        self.fragments.iter().map(|fragment| fragment.width).sum()
    }
}

/// Sets text in lines.
pub(super) struct Setter<'a> {
    fonts: &'a Fonts,
    /// The sections that links may point to.
    sections: &'a BTreeSet<String>,
}

impl<'a> Setter<'a> {
    pub(super) fn new(fonts: &'a Fonts, sections: &'a BTreeSet<String>) -> Self {
        Setter { fonts, sections }
    }

    /// The text in lines of at most `room`; none where there is no text.
    pub(super) fn lines(&self, text: &Prose, style: Style, room: f32) -> Vec<Line> {
        let mut lines: Vec<Line> = Vec::new();
        for word in self.words(text, style) {
            let width = word.width();
            let space = word.space.as_ref().map_or(0.0, |space| space.width);
            match lines.last_mut() {
                Some(line) if line.width + space + width <= room => {
                    word.space.into_iter().chain(word.fragments).for_each(|fragment| line.push(fragment));
                }
                _ if width <= room => lines.push(self.line(word.fragments)),
                _ => lines.extend(self.broken(&word.fragments, room)),
            }
        }
        lines
    }

    /// The width of a text that is not broken.
    pub(super) fn width(&self, text: &Prose, style: Style) -> f32 {
        self.lines(text, style, f32::INFINITY).iter().map(|line| line.width).fold(0.0, f32::max)
    }

    /// The width of the longest word of a text.
    pub(super) fn longest_word(&self, text: &Prose, style: Style) -> f32 {
        self.words(text, style).iter().map(Word::width).fold(0.0, f32::max)
    }

    /// A line of text that is cut where there is no room for more.
    pub(super) fn cut(&self, text: &str, style: Style, room: f32) -> Line {
        let whole = self.fragment(text.to_owned(), style, None);
        if whole.width <= room {
            return self.line(vec![whole]);
        }
        let mut width = self.fonts.width(style.face, '…', style.size);
        let fits = |c: &char| {
            width += self.fonts.width(style.face, *c, style.size);
            width <= room
        };
        let shown: String = text.chars().take_while(fits).chain(['…']).collect();
        self.line(vec![self.fragment(shown, style, None)])
    }

    /// A text of one look.
    pub(super) fn fragment(&self, text: String, style: Style, link: Option<Link>) -> Fragment {
        let of_text: f32 = text.chars().map(|c| self.fonts.width(style.face, c, style.size)).sum();
        let width = if style.is_tag { of_text + 2.0 * TAG_PADDING + TAG_MARGIN } else { of_text };
        Fragment { text, style, width, link }
    }

    fn line(&self, fragments: Vec<Fragment>) -> Line {
        let mut line = Line::default();
        fragments.into_iter().for_each(|fragment| line.push(fragment));
        line
    }

    fn words(&self, text: &Prose, style: Style) -> Vec<Word> {
        let mut words = Words { setter: self, all: Vec::new(), space: None };
        for (number, piece) in text.0.iter().enumerate() {
            words.inline(piece, style, number);
        }
        words.all
    }

    /// A word that is wider than the room, in pieces that are not.
    fn broken(&self, word: &[Fragment], room: f32) -> Vec<Line> {
        let characters: Vec<Fragment> = word
            .iter()
            .flat_map(|Fragment { text, style, link, .. }| {
                let style = Style { is_tag: false, ..*style };
                text.chars().map(move |c| self.fragment(c.to_string(), style, link.clone()))
            })
            .collect();
        let mut lines = Vec::new();
        let mut rest = characters.as_slice();
        while !rest.is_empty() {
            let (piece, behind) = rest.split_at(end_of_piece(rest, room));
            lines.push(self.line(piece.to_vec()));
            rest = behind;
        }
        lines
    }
}

/// How many characters fit into the room, at least one; behind a sign such as `/` where one is near the end.
fn end_of_piece(characters: &[Fragment], room: f32) -> usize {
    let mut width = 0.0;
    let fits = |c: &&Fragment| {
        width += c.width;
        width <= room
    };
    let end = characters.iter().take_while(fits).count().max(1);
    if end == characters.len() {
        return end;
    }
    let sign = characters[..end].iter().rposition(|c| BREAKS.contains(c.text.as_str())).map_or(0, |at| at + 1);
    if 2 * sign > end { sign } else { end }
}

/// Gathers the words of a text.
struct Words<'s> {
    setter: &'s Setter<'s>,
    all: Vec<Word>,
    space: Option<Fragment>,
}

impl Words<'_> {
    fn inline(&mut self, piece: &Inline, style: Style, number: usize) {
        match piece {
            Inline::Text(text) => self.text(text, style, None),
            Inline::Strong(text) => {
                let bold = Style { face: Face::Bold, ..style };
                Prose::from(text).0.iter().for_each(|inner| self.inline(inner, bold, number));
            }
            Inline::Symbol(symbol) => {
                for (piece, is_below) in symbol.pieces() {
                    self.text(piece, if is_below { style.small(BELOW) } else { style }, None);
                }
            }
            Inline::Quantity(quantity) => self.text(&unbroken(&quantity.text()), style, None),
            Inline::Code(text) => self.text(text, style, None),
            Inline::Tag(tone, text) => {
                let colour = if *tone == Tone::Plain { SOFT } else { colour(*tone) };
                let size = TAG * style.size;
                let tag = Style { face: Face::Bold, size, rise: 0.05 * style.size, colour, is_tag: true, ..style };
                self.text(&unbroken(text), tag, None);
            }
            Inline::Link { text, target } => match self.link(target, number) {
                Some(link) => self.text(text, Style { colour: LINK, ..style }, Some(&link)),
                None => self.text(text, style, None),
            },
        }
    }

    /// A link that can be followed from paper's file: to a section, or to an address.
    fn link(&self, target: &str, number: usize) -> Option<Link> {
        let is_known = match target.strip_prefix('#') {
            Some(section) => self.setter.sections.contains(section),
            None => ["https://", "http://", "mailto:"].iter().any(|scheme| target.starts_with(scheme)),
        };
        is_known.then(|| Link { number, target: target.into() })
    }

    /// Adds text; a per cent sign stays with its number.
    fn text(&mut self, text: &str, style: Style, link: Option<&Link>) {
        let text: String = text.replace(" %", "\u{a0}%").replace(['\u{ad}', '\u{200b}', '\u{feff}'], "");
        let is_space = |c: char| c.is_whitespace() && c != '\u{a0}' && c != '\u{202f}';
        let mut rest = text.as_str();
        while let Some(first) = rest.chars().next() {
            let is_blank = is_space(first);
            let end = rest.find(|c| is_space(c) != is_blank).unwrap_or(rest.len());
            let (piece, behind) = rest.split_at(end);
            if is_blank {
                self.space = Some(self.setter.fragment(" ".to_owned(), style, link.cloned()));
            } else {
                self.word(self.setter.fragment(piece.to_owned(), style, link.cloned()));
            }
            rest = behind;
        }
    }

    fn word(&mut self, fragment: Fragment) {
        match (self.space.take(), self.all.last_mut()) {
            (None, Some(last)) => last.fragments.push(fragment),
            (space, _) => self.all.push(Word { space, fragments: vec![fragment] }),
        }
    }
}

/// The text with spaces at which no line ends.
fn unbroken(text: &str) -> String {
    text.replace(' ', "\u{a0}")
}
