//! Lists of parameters and matrices as text.

use faer::MatRef;

use super::number::{digits_of_both, number};

/// One parameter a line, `name = value ± error`, with names and values aligned.
///
/// # Example
/// ```
/// let names = ["J".to_owned(), "gain".to_owned()];
/// let text = lti::text::parameter_list(&names, &[0.5, 12.0], Some(&[0.01, 0.0]));
/// assert_eq!(text, "J    = 0.500 ± 0.010\ngain = 12 (fixed)");
/// ```
#[must_use]
pub fn parameter_list(names: &[String], values: &[f64], errors: Option<&[f64]>) -> String {
    let widest = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    let line = |(k, (name, value)): (usize, (&String, &f64))| {
        let padding = " ".repeat(widest - name.chars().count());
        let written = match errors.and_then(|errors| errors.get(k)) {
            None => number(*value),
            Some(error) => match digits_of_both(*value, *error) {
                (value, None) => format!("{value} (fixed)"),
                (value, Some(error)) => format!("{value} ± {error}"),
            },
        };
        format!("{name}{padding} = {written}")
    };
    names.iter().zip(values).enumerate().map(line).collect::<Vec<_>>().join("\n")
}

/// A matrix to be written, with the letters that its rows and columns are numbered by.
#[derive(Debug, Clone, Copy)]
pub struct Table<'a> {
    /// Its name.
    pub name: &'a str,
    /// The letter of its rows, such as `x`.
    pub rows: char,
    /// The letter of its columns.
    pub columns: char,
    /// The numbers.
    pub values: MatRef<'a, f64>,
}

/// Matrices one below the other, each with numbered rows and columns. Matrices without entries are left out.
#[must_use]
pub fn matrices(tables: &[Table<'_>]) -> String {
    let there = tables.iter().filter(|table| table.values.nrows() * table.values.ncols() > 0);
    there.map(table).collect::<Vec<_>>().join("\n")
}

fn table(table: &Table<'_>) -> String {
    let Table { name, rows, columns, values } = *table;
    let cells: Vec<Vec<String>> =
        (0..values.nrows()).map(|i| (0..values.ncols()).map(|j| number(values[(i, j)])).collect()).collect();
    let headers: Vec<String> = (1..=values.ncols()).map(|j| format!("{columns}{j}")).collect();
    let length = |text: &String| text.chars().count();
    let width = |j: usize| cells.iter().map(|row| length(&row[j])).max().unwrap_or(0).max(length(&headers[j]));
    let widths: Vec<usize> = (0..values.ncols()).map(width).collect();
    let left = format!("{rows}{}", values.nrows()).chars().count();
    let line = |head: &str, label: &str, cells: &[String]| {
        let row: String = cells.iter().zip(&widths).map(|(cell, width)| format!("  {cell:>width$}")).collect();
        format!("{head}{label:<left$}{row}")
    };
    let head = format!("{name} = ");
    let indent = " ".repeat(head.chars().count());
    let mut lines = vec![line(&head, "", &headers)];
    lines.extend(cells.iter().enumerate().map(|(i, row)| line(&indent, &format!("{rows}{}", i + 1), row)));
    lines.join("\n")
}

/// Every line two columns to the right; empty ones stay empty.
#[must_use]
pub fn indented(text: &str) -> String {
    let line = |line: &str| if line.is_empty() { String::new() } else { format!("  {line}") };
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}
