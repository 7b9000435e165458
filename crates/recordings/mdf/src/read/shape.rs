//! The records of a group, and the report of how far they were read.

use work::Context;

use super::column::Block;
use crate::MdfError;
use crate::error::damaged;
use crate::field::Rows;
use crate::stream::{Stream, View};

/// Reports how far reading has come: bytes of samples done, and in all.
pub(crate) struct Progress<'a> {
    pub(crate) context: &'a Context,
    pub(crate) before: u64,
    pub(crate) total: u64,
}

impl Progress<'_> {
    pub(super) fn report(&self, done: u64) {
        self.context.reach(self.before + done, self.total);
    }
}

/// The records of a group that has its stream for itself.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Shape<'a> {
    pub(super) stream: &'a Stream,
    pub(super) invalid: Option<&'a Stream>,
    pub(super) id: u64,
    pub(super) id_bytes: usize,
    pub(super) trailing: usize,
    pub(super) data_bytes: usize,
    pub(super) invalid_bytes: usize,
}

impl Shape<'_> {
    pub(crate) fn stride(&self) -> usize {
        let invalid = if self.invalid.is_some() { 0 } else { self.invalid_bytes };
        self.id_bytes + self.data_bytes + invalid + self.trailing
    }

    /// Fails where a record does not begin with the identifier of the group.
    pub(super) fn check_identifiers(&self, block: &Block<'_>) -> Result<(), MdfError> {
        let id = &self.id.to_le_bytes()[..self.id_bytes.min(8)];
        let is_right = match block.view {
            _ if id.is_empty() => true,
            View::Rows(bytes) => {
                Rows { bytes, stride: block.stride, shift: 0 }.parts(0, id.len()).all(|part| part == id)
            }
            View::Columns { bytes, rows } => {
                bytes.chunks_exact(rows.max(1)).zip(id).all(|(column, id)| column.iter().all(|b| b == id))
            }
        };
        match is_right {
            true => Ok(()),
            false => {
                let offset = self.stream.fragments.first().map_or(0, |f| f.offset);
                Err(damaged(offset, "a record begins with an identifier that is not known"))
            }
        }
    }
}
