#![doc = include_str!("../README.md")]
//!
//! Pages as data, and their shapes: one HTML file, a PDF, lines of a terminal, Markdown, JSON; figures as SVG and PNG.
//!
//! A [`Page`] is headings, text, tables, figures and findings as plain data. Whoever has something to say builds one,
//! and the renderers here show it: all number formatting and typesetting is theirs. This crate may know nothing of
//! benches, models or files: it gets text and numbers, and returns text and bytes. It reads no font of the machine, so
//! that pictures look alike everywhere.

pub mod decimal;
#[cfg(feature = "pdf")]
mod drawing;
mod empty_figures;
mod figure;
mod formula;
mod html;
mod logo;
mod markdown;
pub mod markup;
mod model;
pub mod number;
#[cfg(feature = "pdf")]
mod pdf;
#[cfg(not(feature = "pdf"))]
#[path = "pdf/absent.rs"]
mod pdf;
mod png;
mod prose;
mod quantity;
mod svg;
mod table;
mod terminal;
mod thinned;
mod tone;

pub use figure::{Abscissa, Axis, Figure, Layer, Marker, Panel, Rounded, Scale, Style, rounded};
pub use html::html;
pub use logo::{Logo, LogoError};
pub use markdown::markdown;
pub use model::{Block, Blocks, Card, Finding, Page, Weight};
pub use pdf::{Day, Paper, PdfError, PdfOptions, pdf, without_glyph};
pub use png::{PngError, png};
pub use prose::{Inline, Prose, Symbol};
pub use quantity::{Digits, Quantity, Uncertainty, Unit};
pub use svg::svg;
pub use table::{Align, Cell, Column, Content, Row, Table};
pub use terminal::{Screen, folded, safe, terminal};
pub use tone::Tone;

/// The page as JSON: its data, as they are.
///
/// # Errors
/// Where a number or text cannot be written as JSON.
pub fn json(page: &Page) -> Result<String, serde_json::Error> {
    serde_json::to_string_pretty(page)
}
