//! A file that is read, and what is wanted of it.

use arrow_schema::Schema;
use work::Context;

use super::plan::Plan;
use crate::error::{IMPLAUSIBLE, of_content};
use crate::source::Shared;
use crate::{RecordingError, Selection};

/// The most numbers of a file, and of each byte of a larger file.
const MAX_NUMBERS: u64 = 1 << 26;
const MAX_PER_BYTE: u64 = 129;

pub(super) struct Reader<'a> {
    pub(super) file: &'a str,
    pub(super) source: &'a Shared,
    pub(super) size: u64,
    pub(super) selection: &'a Selection,
    pub(super) row_distance_s: Option<f64>,
    pub(super) context: &'a Context,
}

impl Reader<'_> {
    pub(super) fn plan(&self, schema: &Schema) -> Result<Plan, RecordingError> {
        Plan::new(self.file, schema, self.selection, self.row_distance_s)
    }

    /// The most bytes that a compressed buffer may become.
    pub(super) fn most_bytes(&self) -> i64 {
        let most = MAX_NUMBERS.max(self.size.saturating_mul(MAX_PER_BYTE)).saturating_mul(8);
        i64::try_from(most).unwrap_or(i64::MAX)
    }

    pub(super) fn check_size(&self, rows: u64, columns: usize) -> Result<(), RecordingError> {
        let most = MAX_NUMBERS.max(self.size.saturating_mul(MAX_PER_BYTE));
        // Rows that nothing is kept of are gone through all the same.
        if rows.saturating_mul(columns.max(1) as u64) <= most {
            return Ok(());
        }
        let what = format!("{columns} columns of {rows} rows in {} bytes, {IMPLAUSIBLE}", self.size);
        Err(RecordingError::Implausible { file: self.file.to_owned(), what })
    }

    pub(super) fn damaged(&self, detail: String) -> RecordingError {
        of_content(self.file, None, detail)
    }
}
