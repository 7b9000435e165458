//! Groups that have their stream for themselves: records at a fixed distance, read by several workers.

use std::ops::Range;
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

/// The pieces of some records of a stream: compressed fragments whole, plain ones as they come.
fn pieces(stream: &Stream, stride: u64, rows: Range<u64>) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut first = rows.start;
    let mut until = |end: u64| {
        let end = end.min(rows.end);
        if end > first {
            pieces.push(Piece { first, rows: (end - first) as usize });
            first = end;
        }
        first
    };
    let per_piece = (PIECE / stride).max(1);
    let mut done = rows.start;
    let begin = stream.at(rows.start.saturating_mul(stride)).unwrap_or(stream.fragments.len());
    for fragment in &stream.fragments[begin..] {
        // A record belongs to the fragment it begins in.
        let end = fragment.end().div_ceil(stride);
        if fragment.packing == Packing::Plain {
            while end - done.min(end) >= per_piece {
                done = until(done + per_piece);
                if done >= rows.end {
                    return pieces;
                }
            }
        } else if (end - done.min(end)) * stride >= PIECE / 2 {
            done = until(end);
        }
        if done >= rows.end {
            return pieces;
        }
    }
    until(rows.end);
    pieces
}

struct Queue<'c> {
    pieces: std::vec::IntoIter<Piece>,
    rest: Vec<Cells<'c>>,
    failure: Option<MdfError>,
    done_bytes: u64,
}

/// Receives numbers of a task: its place, the number of the first record, and the numbers from there on.
pub(crate) type Each<'a> = &'a (dyn Fn(usize, u64, &[f64]) + Sync);

/// Records of a group that are read, and what is taken from them.
#[derive(Clone, Copy)]
pub(crate) struct Job<'a, S: ?Sized> {
    pub source: &'a S,
    pub shape: Shape<'a>,
    pub tasks: &'a [Task],
    pub progress: &'a Progress<'a>,
    /// Receiver of the numbers, where they are not gathered.
    pub each: Option<Each<'a>>,
}

impl<S: Source + ?Sized> Job<'_, S> {
    /// Reads records into a column for each task.
    pub(crate) fn read(&self, rows: Range<u64>) -> Result<Vec<Column>, MdfError> {
        let mut columns = columns(self.tasks, count(&rows)?)?;
        let rest = columns.iter_mut().map(Column::cells).collect();
        self.run(rows, rest)?;
        Ok(columns)
    }

    /// Hands on the numbers of records, piece by piece in any order.
    pub(crate) fn visit(&self, rows: Range<u64>) -> Result<(), MdfError> {
        self.run(rows, Vec::new())
    }

    fn run(&self, rows: Range<u64>, rest: Vec<Cells<'_>>) -> Result<(), MdfError> {
        let pieces = match self.shape.stride() as u64 {
            0 => vec![Piece { first: rows.start, rows: count(&rows)? }],
            stride => pieces(self.shape.stream, stride, rows),
        };
        let workers = rayon::current_num_threads().min(MOST_WORKERS).min(pieces.len());
        let queue = Mutex::new(Queue { pieces: pieces.into_iter(), rest, failure: None, done_bytes: 0 });
        rayon::scope(|scope| {
            for _ in 1..workers {
                scope.spawn(|_| work(self, &queue));
            }
            work(self, &queue);
        });
        queue.into_inner().unwrap_or_else(PoisonError::into_inner).failure.map_or(Ok(()), Err)
    }
}

fn count(rows: &Range<u64>) -> Result<usize, MdfError> {
    let numbers = rows.end.saturating_sub(rows.start);
    usize::try_from(numbers).map_err(|_| MdfError::TooLarge { numbers })
}

fn work<S: Source + ?Sized>(job: &Job<'_, S>, queue: &Mutex<Queue<'_>>) {
    let Job { shape, tasks, progress, .. } = job;
    let lock = || queue.lock().unwrap_or_else(PoisonError::into_inner);
    let mut reader = PieceReader::new(job.source, shape);
    let mut columns = Vec::new();
    loop {
        let mut guard = lock();
        if guard.failure.is_some() {
            return;
        }
        let Some(piece) = guard.pieces.next() else { return };
        let mut cells: Vec<_> = guard.rest.iter_mut().map(|c| c.split(piece.rows)).collect();
        drop(guard);
        let result = match job.each {
            None => reader.read(piece, tasks, &mut cells),
            Some(each) => reader.visit(piece, tasks, &mut columns, each),
        };
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

    /// Reads a piece into columns that are used again, and hands on its numbers.
    fn visit(
        &mut self,
        piece: Piece,
        tasks: &[Task],
        columns: &mut Vec<Column>,
        each: Each<'_>,
    ) -> Result<(), MdfError> {
        if columns.is_empty() {
            *columns = super::column::columns(tasks, piece.rows)?;
        }
        columns.iter_mut().for_each(|column| column.resize(piece.rows));
        let mut cells: Vec<_> = columns.iter_mut().map(Column::cells).collect();
        self.read(piece, tasks, &mut cells)?;
        for (task, column) in columns.iter().enumerate() {
            if let Column::Numbers(numbers) = column {
                each(task, piece.first, numbers);
            }
        }
        Ok(())
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
