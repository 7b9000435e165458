//! Independent tasks on all processors.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The results of all tasks, in their order, however many threads work; `told` hears from any thread how many of how many are done.
pub(crate) fn on_all_processors<T: Sync, R: Send>(
    tasks: &[T],
    run: impl Fn(&T) -> R + Sync,
    told: &(dyn Fn(u64, u64) + Sync),
) -> Vec<R> {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    // Each thread takes the next task that nobody has taken.
    let work = || {
        let mine = std::iter::from_fn(|| {
            let place = next.fetch_add(1, Ordering::Relaxed);
            let result = run(tasks.get(place)?);
            told(done.fetch_add(1, Ordering::Relaxed) as u64 + 1, tasks.len() as u64);
            Some((place, result))
        });
        mine.collect::<Vec<_>>()
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut all: Vec<(usize, R)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mine = work();
        let others = workers.into_iter().flat_map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)));
        mine.into_iter().chain(others).collect()
    });
    all.sort_by_key(|(place, _)| *place);
    all.into_iter().map(|(_, result)| result).collect()
}
