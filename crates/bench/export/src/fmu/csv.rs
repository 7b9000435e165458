//! Tables of numbers as text.

/// A table with a row of names; numbers read back exactly.
pub(super) fn table(names: &[&str], rows: impl IntoIterator<Item = Vec<f64>>) -> String {
    let mut text = names.join(",");
    text.push('\n');
    for row in rows {
        let cells: Vec<String> = row.iter().map(|value| number(*value)).collect();
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    text
}

/// The shortest text that reads back as the same number.
pub(super) fn number(value: f64) -> String {
    let size = value.abs();
    if size == 0.0 || (1e-5..1e15).contains(&size) { format!("{value}") } else { format!("{value:e}") }
}
