//! Models as one Modelica file each. All but the models with a flange go without the Modelica Standard Library.

mod bench;
mod linear;
mod units;

pub use bench::bench;
pub use linear::linear;

use crate::names::one_line;

/// A number that Modelica reads back bit for bit.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// A text inside a string of Modelica.
fn text(text: &str) -> String {
    one_line(text).replace('\\', "\\\\").replace('"', "\\\"")
}

/// A text inside HTML inside a string of Modelica.
fn html(content: &str) -> String {
    text(&content.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;"))
}
