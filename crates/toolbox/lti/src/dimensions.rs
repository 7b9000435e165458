//! [`Dimensions`]: rows and columns.

use std::fmt;

/// How many rows and columns a matrix or table has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Dimensions {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
}

impl From<(usize, usize)> for Dimensions {
    /// Rows, then columns, as a matrix gives its shape.
    fn from((rows, columns): (usize, usize)) -> Self {
        Dimensions { rows, columns }
    }
}

impl fmt::Display for Dimensions {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} × {}", self.rows, self.columns)
    }
}
