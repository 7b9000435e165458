//! Work on all processors, with results that do not depend on how many there are.

use std::ops::Range;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

pub use rayon::{current_num_threads, join};

/// Hears from any thread how many of how many tasks are done.
pub type Progress<'a> = &'a (dyn Fn(u64, u64) + Sync);

/// The results of all tasks, in their order. Each thread takes the next task that nobody has taken.
///
/// # Example
/// ```
/// let squares = numerics::parallel::map(&[1, 2, 3], |x| x * x);
/// assert_eq!(squares, [1, 4, 9]);
/// ```
pub fn map<T: Sync, R: Send>(tasks: &[T], run: impl Fn(&T) -> R + Sync) -> Vec<R> {
    tasks.par_iter().with_max_len(1).map(&run).collect()
}

/// The results of all tasks, in their order, with a report after each.
pub fn map_with_progress<T: Sync, R: Send>(
    tasks: &[T],
    run: impl Fn(&T) -> R + Sync,
    progress: Progress<'_>,
) -> Vec<R> {
    let done = AtomicU64::new(0);
    map(tasks, |task| {
        let result = run(task);
        progress(done.fetch_add(1, Ordering::Relaxed) + 1, tasks.len() as u64);
        result
    })
}

/// Reduces `0..length` in chunks: `part` on each chunk in parallel, then `merge` in the order of the chunks; none of an
/// empty range. The chunks depend on `length` and `chunk` alone, so that rounding is the same on any number of threads.
///
/// # Example
/// ```
/// let sum = numerics::parallel::reduce(1000, 64, |range| range.sum::<usize>(), |a, b| a + b);
/// assert_eq!(sum, Some(499_500));
/// ```
pub fn reduce<A: Send>(
    length: usize,
    chunk: usize,
    part: impl Fn(Range<usize>) -> A + Sync,
    merge: impl Fn(A, A) -> A,
) -> Option<A> {
    let chunk = chunk.max(1);
    let starts: Vec<usize> = (0..length).step_by(chunk).collect();
    map(&starts, |start| part(*start..length.min(start + chunk))).into_iter().reduce(merge)
}

/// Runs some work, with all parallel work in it, on this many threads of its own; on those of the caller if the system
/// has no threads to give.
pub fn with_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    match rayon::ThreadPoolBuilder::new().num_threads(threads.max(1)).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}
