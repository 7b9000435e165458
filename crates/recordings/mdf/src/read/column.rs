//! Columns, and the work of filling them from records.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::MdfError;
use crate::conversion::Conversion;
use crate::field::{Field, Planes, Records, Rows};
use crate::stream::View;

/// Part that is taken from each record.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Take {
    Number(Field),
    Bytes { byte: usize, width: usize },
    Index,
}

/// The work for one column.
#[derive(Debug, Clone)]
pub(crate) struct Task {
    pub take: Take,
    /// Applied to numbers as they are read.
    pub conversion: Option<Arc<Conversion>>,
    /// Bit of the invalidation bytes.
    pub invalid_bit: Option<u32>,
    /// Takes down that there was an integer that is not exact as a number.
    pub rounds: Option<Arc<AtomicBool>>,
}

/// A column under construction.
#[derive(Debug)]
pub(crate) enum Column {
    Numbers(Vec<f64>),
    Bytes { width: usize, bytes: Vec<u8> },
}

/// A part of a column.
pub(crate) enum Cells<'c> {
    Numbers(&'c mut [f64]),
    Bytes { width: usize, bytes: &'c mut [u8] },
}

/// Records in memory.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Block<'a> {
    pub view: View<'a>,
    /// Distance of records; identifiers included.
    pub stride: usize,
    /// Bytes before the first sample of a record.
    pub shift: usize,
    /// The number of the first record.
    pub first: u64,
    /// The records' invalidation bytes.
    pub invalid: Invalid<'a>,
}

/// Where invalidation bytes are.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Invalid<'a> {
    /// In the records, after so many bytes of samples.
    After(usize),
    /// By themselves, so many for each record.
    Apart(&'a [u8], usize),
}

/// 2^53: integers below it are exact as numbers.
const EXACT: f64 = 9_007_199_254_740_992.0;
/// Bytes of records that are worked on at once, so that they stay in the cache while one column after another is read.
const BLOCK: usize = 1 << 17;
/// The same for transposed records, of which only the bytes of one column are brought together.
const TRANSPOSED_ROWS: usize = 1 << 12;

impl Task {
    /// A column of zeros for so many rows.
    fn column(&self, rows: usize) -> Column {
        match self.take {
            Take::Bytes { width, .. } => Column::Bytes { width, bytes: vec![0; rows * width] },
            _ => Column::Numbers(vec![0.0; rows]),
        }
    }

    /// Bytes of a row of its column.
    fn row_bytes(&self) -> usize {
        match self.take {
            Take::Bytes { width, .. } => width,
            _ => size_of::<f64>(),
        }
    }

    fn place(&self) -> (usize, usize) {
        match self.take {
            Take::Number(field) => (field.byte, field.width()),
            Take::Bytes { byte, width } => (byte, width),
            Take::Index => (0, 0),
        }
    }

    /// Fills `cells` from records; `scratch` is working memory.
    fn run(&self, block: &Block<'_>, part: Part, scratch: &mut Vec<u8>, mut cells: Cells<'_>) {
        match (&mut cells, self.take) {
            (Cells::Numbers(out), Take::Number(field)) => block.numbers(part, field, scratch, out),
            (Cells::Numbers(out), Take::Index) => {
                let first = block.first + part.first as u64;
                out.iter_mut().enumerate().for_each(|(i, out)| *out = (first + i as u64) as f64);
            }
            (Cells::Bytes { width, bytes }, _) => {
                let (rows, byte) = block.rows(part, self.place().0, *width, scratch);
                for (out, part) in bytes.chunks_exact_mut((*width).max(1)).zip(rows.parts(byte, *width)) {
                    out[..part.len()].copy_from_slice(part);
                }
            }
            (Cells::Numbers(_), Take::Bytes { .. }) => {}
        }
        if let (Cells::Numbers(out), Some(rounds)) = (&cells, &self.rounds)
            && out.iter().any(|number| number.abs() >= EXACT)
        {
            rounds.store(true, Ordering::Relaxed);
        }
        if let (Cells::Numbers(out), Some(conversion)) = (&mut cells, &self.conversion) {
            conversion.numbers(out);
        }
        if let Some(bit) = self.invalid_bit {
            invalidate(block, part, bit, scratch, cells);
        }
    }
}

/// Columns of zeros for the tasks.
pub(crate) fn columns(tasks: &[Task], rows: usize) -> Result<Vec<Column>, MdfError> {
    let too_large = || MdfError::TooLarge { numbers: rows as u64 };
    let row = tasks.iter().try_fold(0_usize, |sum, task| sum.checked_add(task.row_bytes()));
    let bytes = row.and_then(|row| row.checked_mul(rows)).ok_or_else(too_large)?;
    // Asks first, for all of them at once: a vector of zeros that does not fit ends the program, and one that is made
    // of memory just given back has to be filled with them.
    Vec::<u8>::new().try_reserve_exact(bytes).map_err(|_| too_large())?;
    Ok(tasks.iter().map(|task| task.column(rows)).collect())
}

/// Some of the records of a block.
#[derive(Debug, Clone, Copy)]
struct Part {
    first: usize,
    count: usize,
}

impl<'a> Block<'a> {
    /// Reads a number of each of the records.
    fn numbers(&self, part: Part, field: Field, scratch: &mut Vec<u8>, out: &mut [f64]) {
        match self.view {
            View::Rows(_) => {
                let (rows, byte) = self.rows(part, field.byte, 0, scratch);
                Field { byte, ..field }.read(Records::Rows(rows), out);
            }
            View::Columns { bytes, rows } => {
                let planes = Planes { bytes, total: rows, first: part.first };
                Field { byte: self.shift + field.byte, ..field }.read(Records::Planes(planes), out);
            }
        }
    }

    /// Rows of which `width` bytes at the returned place are those that are `byte` bytes into the records.
    fn rows<'s>(&self, part: Part, byte: usize, width: usize, scratch: &'s mut Vec<u8>) -> (Rows<'s>, usize)
    where
        'a: 's,
    {
        let (bytes, total) = match self.view {
            View::Rows(bytes) => {
                let bytes = bytes.get(part.first * self.stride..(part.first + part.count) * self.stride);
                let bytes = bytes.unwrap_or_default();
                return (Rows { bytes, stride: self.stride, shift: self.shift }, byte);
            }
            View::Columns { bytes, rows } => (bytes, rows),
        };
        scratch.clear();
        scratch.resize(part.count * width, 0);
        for within in 0..width {
            let start = (self.shift + byte + within) * total + part.first;
            let column = bytes.get(start..start + part.count).unwrap_or_default();
            let out = scratch.iter_mut().skip(within).step_by(width);
            out.zip(column).for_each(|(out, byte)| *out = *byte);
        }
        (Rows { bytes: scratch, stride: width, shift: 0 }, 0)
    }

    /// Fills the cells of all tasks with the first `count` records.
    pub(crate) fn fill(&self, count: usize, tasks: &[Task], cells: &mut [Cells<'_>], scratch: &mut Vec<u8>) {
        let step = match self.view {
            View::Rows(_) => (BLOCK / self.stride.max(1)).max(16),
            View::Columns { .. } => TRANSPOSED_ROWS,
        };
        for first in (0..count).step_by(step) {
            let part = Part { first, count: step.min(count - first) };
            for (task, cells) in tasks.iter().zip(cells.iter_mut()) {
                task.run(self, part, scratch, cells.part(part));
            }
        }
    }
}

fn invalidate(block: &Block<'_>, part: Part, bit: u32, scratch: &mut Vec<u8>, cells: Cells<'_>) {
    let byte = (bit / 8) as usize;
    let (rows, byte) = match block.invalid {
        Invalid::After(data_bytes) => block.rows(part, data_bytes + byte, 1, scratch),
        Invalid::Apart(bytes, stride) => {
            let bytes = bytes.get(part.first * stride..).unwrap_or_default();
            (Rows { bytes, stride, shift: 0 }, byte)
        }
    };
    let is_invalid = rows.parts(byte, 1).map(|b| b.first().is_some_and(|b| b >> (bit % 8) & 1 != 0));
    match cells {
        Cells::Numbers(out) => {
            out.iter_mut().zip(is_invalid).filter(|(_, invalid)| *invalid).for_each(|(out, _)| *out = f64::NAN);
        }
        Cells::Bytes { width, bytes } => {
            let cells = bytes.chunks_exact_mut(width.max(1)).zip(is_invalid);
            cells.filter(|(_, invalid)| *invalid).for_each(|(cell, _)| cell.fill(0));
        }
    }
}

impl Column {
    pub(crate) fn cells(&mut self) -> Cells<'_> {
        match self {
            Self::Numbers(numbers) => Cells::Numbers(numbers),
            Self::Bytes { width, bytes } => Cells::Bytes { width: *width, bytes },
        }
    }

    /// Makes it so many rows long; their cells hold anything.
    pub(crate) fn resize(&mut self, rows: usize) {
        match self {
            Self::Numbers(numbers) => numbers.resize(rows, 0.0),
            Self::Bytes { width, bytes } => bytes.resize(rows * *width, 0),
        }
    }

    /// Removes all rows, and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.resize(0);
    }

    /// Appends `rows` cells of zeros and returns them.
    pub(crate) fn grow(&mut self, rows: usize) -> Cells<'_> {
        match self {
            Self::Numbers(numbers) => {
                let begin = numbers.len();
                numbers.resize(begin + rows, 0.0);
                Cells::Numbers(&mut numbers[begin..])
            }
            Self::Bytes { width, bytes } => {
                let begin = bytes.len();
                bytes.resize(begin + rows * *width, 0);
                Cells::Bytes { width: *width, bytes: &mut bytes[begin..] }
            }
        }
    }
}

impl<'c> Cells<'c> {
    fn part(&mut self, part: Part) -> Cells<'_> {
        match self {
            Self::Numbers(numbers) => Cells::Numbers(&mut numbers[part.first..part.first + part.count]),
            Self::Bytes { width, bytes } => Cells::Bytes {
                width: *width,
                bytes: &mut bytes[part.first * *width..(part.first + part.count) * *width],
            },
        }
    }

    /// Takes the first `rows` cells off.
    pub(crate) fn split(&mut self, rows: usize) -> Cells<'c> {
        match self {
            Self::Numbers(numbers) => {
                let (head, tail) = std::mem::take(numbers).split_at_mut(rows);
                *numbers = tail;
                Cells::Numbers(head)
            }
            Self::Bytes { width, bytes } => {
                let (head, tail) = std::mem::take(bytes).split_at_mut(rows * *width);
                *bytes = tail;
                Cells::Bytes { width: *width, bytes: head }
            }
        }
    }
}
