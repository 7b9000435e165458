//! Samples that are left in the datasets of a file.

/// Samples that are not read yet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stored {
    /// The number of their dataset.
    pub(super) dataset: usize,
    pub(super) part: Numbers,
}

/// The numbers of a dataset that are a channel's.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Numbers {
    /// All of them.
    Vector,
    /// Those at an index of each row, which has so many.
    Across { index: usize, width: usize },
    /// Those of one row.
    Row(usize),
}
