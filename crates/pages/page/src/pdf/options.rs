//! Options of a PDF, and the reasons why one cannot be made.

use std::fmt;

/// A size of paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Paper {
    /// 210 mm × 297 mm.
    #[default]
    A4,
    /// 8.5 in × 11 in.
    Letter,
}

/// How a page becomes a PDF, and what the file says of itself.
#[derive(Debug, Clone, Default)]
pub struct PdfOptions {
    /// The paper.
    pub paper: Paper,
    /// The program and its version; it is at the foot of each page.
    pub generator: String,
    /// Who wrote it; empty for none.
    pub author: String,
    /// When it was made.
    pub created: Option<Day>,
    /// True if all of it is to be on one page: it is then set smaller, down to half its size.
    pub on_one_page: bool,
}

/// A day of the calendar.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Day {
    /// The year.
    pub year: u16,
    /// The month, from 1.
    pub month: u8,
    /// The day of the month, from 1.
    pub day: u8,
}

impl Day {
    /// The day written as in 2026-05-03.
    pub fn parse(text: &str) -> Option<Self> {
        let mut parts = text.splitn(3, '-');
        let (year, month, day) =
            (parts.next()?.parse().ok()?, parts.next()?.parse().ok()?, parts.next()?.parse().ok()?);
        let is_valid = (1..=12).contains(&month) && (1..=31).contains(&day);
        is_valid.then_some(Day { year, month, day })
    }
}

impl fmt::Display for Day {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:04}-{:02}-{:02}", self.year, self.month, self.day)
    }
}

/// Why a page cannot become a PDF.
#[derive(Debug, thiserror::Error)]
pub enum PdfError {
    /// A drawing is no valid SVG.
    #[error("the drawing \"{what}\" cannot be read: {reason}")]
    Drawing {
        /// Subject of the drawing.
        what: String,
        /// Fault of the drawing.
        reason: String,
    },
    /// A font that is built in cannot be used.
    #[error("a font cannot be embedded: {0}")]
    Font(String),
    /// The feature `pdf` is off.
    #[error("this build of dynoid makes no PDF; build it with the feature `pdf`")]
    LeftOut,
}
