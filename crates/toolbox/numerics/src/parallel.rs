//! Work on all processors, with results that do not depend on how many there are.

use rayon::prelude::*;
use std::ops::Range;
use work::Context;

pub use rayon::current_num_threads;

/// The results of all tasks, in their order. Each thread takes the next task that nobody has taken.
///
/// # Example
/// ```
/// let squares = numerics::parallel::map(&[1, 2, 3], |x| x * x);
/// assert_eq!(squares, [1, 4, 9]);
/// ```
pub fn map<T: Sync, R: Send>(tasks: &[T], run: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let run = |task| {
        work::checkpoint();
        run(task)
    };
    tasks.par_iter().with_max_len(1).map(run).collect()
}

/// The results of all tasks, in their order. They are a step of the work, such as `simulating`, of which each task is a
/// part.
pub fn map_as_step<T: Sync, R: Send>(
    context: &Context,
    what: &str,
    tasks: &[T],
    run: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let step = context.step(what, tasks.len() as u64);
    map(tasks, |task| {
        let result = run(task);
        step.advance(1);
        result
    })
}

/// Runs both, in parallel where a thread is free.
pub fn join<A: Send, B: Send>(one: impl FnOnce() -> A + Send, other: impl FnOnce() -> B + Send) -> (A, B) {
    work::checkpoint();
    rayon::join(one, other)
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
