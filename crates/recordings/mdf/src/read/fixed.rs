//! Groups that have their stream for themselves: records at a fixed distance, read by several workers.

use std::sync::{Mutex, PoisonError};

use super::column::{Block, Cells, Column, Invalid, Task, columns};
use super::shape::{Progress, Shape};
use crate::stream::{Loader, Packing, Stream, View};
use crate::{MdfError, Source};

/// Bytes of records that are read at once.
const PIECE: u64 = 1 << 19;
/// More workers would hold more memory than they win time.
const MOST_WORKERS: usize = 4;

/// Records that one worker reads at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Piece {
    first: u64,
    rows: usize,
}

/// The pieces of a stream of `rows` records: compressed fragments whole, plain ones as they come.
fn pieces(stream: &Stream, stride: u64, rows: u64) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut first = 0;
    let mut until = |end: u64| {
        let end = end.min(rows);
        if end > first {
            pieces.push(Piece { first, rows: (end - first) as usize });
            first = end;
        }
        first
    };
    let per_piece = (PIECE / stride).max(1);
    let mut done = 0;
    for fragment in &stream.fragments {
        // A record belongs to the fragment it begins in.
        let end = fragment.end().div_ceil(stride);
        if fragment.packing == Packing::Plain {
            while end - done.min(end) >= per_piece {
                done = until(done + per_piece);
                if done >= rows {
                    return pieces;
                }
            }
        } else if (end - done.min(end)) * stride >= PIECE / 2 {
            done = until(end);
        }
    }
    until(rows);
    pieces
}

struct Queue<'c> {
    pieces: std::vec::IntoIter<Piece>,
    rest: Vec<Cells<'c>>,
    failure: Option<MdfError>,
    done_bytes: u64,
}

/// Reads `rows` records into a column for each task.
pub(crate) fn read<S: Source + ?Sized>(
    source: &S,
    shape: &Shape<'_>,
    rows: u64,
    tasks: &[Task],
    progress: &Progress<'_>,
) -> Result<Vec<Column>, MdfError> {
    let count = usize::try_from(rows).map_err(|_| MdfError::TooLarge { numbers: rows })?;
    let mut columns = columns(tasks, count)?;
    let stride = shape.stride() as u64;
    let pieces = match stride {
        0 => vec![Piece { first: 0, rows: count }],
        _ => pieces(shape.stream, stride, rows),
    };
    let workers = rayon::current_num_threads().min(MOST_WORKERS).min(pieces.len());
    let rest = columns.iter_mut().map(Column::cells).collect();
    let queue = Mutex::new(Queue { pieces: pieces.into_iter(), rest, failure: None, done_bytes: 0 });
    rayon::scope(|scope| {
        for _ in 1..workers {
            scope.spawn(|_| work(source, shape, tasks, &queue, progress));
        }
        work(source, shape, tasks, &queue, progress);
    });
    match queue.into_inner().unwrap_or_else(PoisonError::into_inner).failure {
        Some(error) => Err(error),
        None => Ok(columns),
    }
}

fn work<S: Source + ?Sized>(
    source: &S,
    shape: &Shape<'_>,
    tasks: &[Task],
    queue: &Mutex<Queue<'_>>,
    progress: &Progress<'_>,
) {
    let lock = || queue.lock().unwrap_or_else(PoisonError::into_inner);
    let mut reader = PieceReader::new(source, shape);
    loop {
        let mut guard = lock();
        if guard.failure.is_some() {
            return;
        }
        let Some(piece) = guard.pieces.next() else { return };
        let mut cells: Vec<_> = guard.rest.iter_mut().map(|c| c.split(piece.rows)).collect();
        drop(guard);
        let result = reader.read(piece, tasks, &mut cells);
        let mut guard = lock();
        guard.done_bytes += piece.rows as u64 * shape.stride() as u64;
        progress.report(guard.done_bytes);
        if let Err(error) = result {
            guard.failure.get_or_insert(error);
            return;
        }
    }
}

struct PieceReader<'a, S: ?Sized> {
    shape: &'a Shape<'a>,
    data: Loader<'a, S>,
    invalid: Option<Loader<'a, S>>,
    invalid_bytes: Vec<u8>,
    scratch: Vec<u8>,
}

impl<'a, S: Source + ?Sized> PieceReader<'a, S> {
    fn new(source: &'a S, shape: &'a Shape<'a>) -> Self {
        Self {
            shape,
            data: Loader::new(source, shape.stream),
            invalid: shape.invalid.map(|stream| Loader::new(source, stream)),
            invalid_bytes: Vec::new(),
            scratch: Vec::new(),
        }
    }

    fn read(&mut self, piece: Piece, tasks: &[Task], cells: &mut [Cells<'_>]) -> Result<(), MdfError> {
        let shape = self.shape;
        let range = |stride: usize| {
            let stride = stride as u64;
            piece.first * stride..(piece.first + piece.rows as u64) * stride
        };
        self.invalid_bytes.clear();
        let invalid = match &mut self.invalid {
            Some(loader) => {
                loader.append(range(shape.invalid_bytes), &mut self.invalid_bytes)?;
                Invalid::Apart(&self.invalid_bytes, shape.invalid_bytes)
            }
            None => Invalid::After(shape.data_bytes),
        };
        let stride = shape.stride();
        let view = match stride {
            0 => View::Rows(&[]),
            _ => self.data.view(range(stride), stride)?,
        };
        let block = Block { view, stride, shift: shape.id_bytes, first: piece.first, invalid };
        shape.check_identifiers(&block)?;
        block.fill(piece.rows, tasks, cells, &mut self.scratch);
        Ok(())
    }
}
