#![doc = include_str!("../README.md")]
//!
//! Figures as data, and their three shapes: an interactive page, an SVG, a PNG.
//!
//! One [`Figure`] type is drawn by everyone. This crate may know nothing of benches, models or files: it gets numbers and
//! labels, and returns text and bytes. It reads no font of the machine: pictures look alike everywhere.

mod figure;
mod html;
pub mod markup;
mod png;
mod svg;

pub use figure::{Abscissa, Axis, Figure, Layer, Marker, Panel, Rounded, Scale, Style, drawn_of, rounded};
pub use html::{SCRIPT, STYLE, figure as figure_element, page};
pub use png::{PngError, png};
pub use svg::svg;
