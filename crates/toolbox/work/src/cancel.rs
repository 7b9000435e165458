//! Cancellation. Work that is no longer wanted ends by unwinding to the context that runs it, so that a search deep
//! inside needs no error for it, and every guard on the way (a file that is half written, say) is dropped.

use std::cell::RefCell;
use std::fmt;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The wish that some work ends. Clones are of the same wish, and any thread may hold one.
#[derive(Debug, Clone, Default)]
pub struct Cancel {
    is_wished: Arc<AtomicBool>,
}

/// Work ended because it was cancelled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Cancelled;

impl fmt::Display for Cancelled {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "the work was cancelled")
    }
}

impl std::error::Error for Cancelled {}

thread_local! {
    /// The wish that ends the work of this thread, while a context runs it.
    static OF_THREAD: RefCell<Option<Cancel>> = const { RefCell::new(None) };
}

impl Cancel {
    /// Ends the work at its next checkpoint. Once wished, it stays so.
    pub fn cancel(&self) {
        self.is_wished.store(true, Ordering::Relaxed);
    }

    /// Tells whether the work is to end.
    pub fn is_cancelled(&self) -> bool {
        self.is_wished.load(Ordering::Relaxed)
    }

    /// Ends the work here if it was cancelled. It must be work that a context runs.
    pub(crate) fn check(&self) {
        if self.is_cancelled() {
            // Unlike a panic, this calls no hook: nothing is printed.
            panic::resume_unwind(Box::new(Cancelled));
        }
    }

    /// Has this thread end its work at checkpoints from now on, and gives back what held before.
    pub(crate) fn enter(&self) -> Option<Cancel> {
        OF_THREAD.replace(Some(self.clone()))
    }
}

/// Gives a thread back what held before.
struct Restore(Option<Cancel>);

impl Drop for Restore {
    fn drop(&mut self) {
        OF_THREAD.set(self.0.take());
    }
}

/// Runs `work` on this thread. A cancellation ends here, as an error.
pub(crate) fn caught<R>(cancel: &Cancel, work: impl FnOnce() -> R) -> Result<R, Cancelled> {
    if cancel.is_cancelled() {
        return Err(Cancelled);
    }
    let _restore = Restore(cancel.enter());
    // What the work leaves behind is dropped with it, so nobody sees it half done.
    panic::catch_unwind(AssertUnwindSafe(work)).map_err(|cause| match cause.downcast::<Cancelled>() {
        Ok(cancelled) => *cancelled,
        Err(cause) => panic::resume_unwind(cause),
    })
}

/// Runs some work of a library that may panic, and gives its panic as `None`; a cancellation goes on to the context.
pub fn guarded<R>(work: impl FnOnce() -> R) -> Option<R> {
    match panic::catch_unwind(AssertUnwindSafe(work)) {
        Ok(done) => Some(done),
        Err(cause) if cause.is::<Cancelled>() => panic::resume_unwind(cause),
        Err(_) => None,
    }
}

/// Rounds of a loop between two checkpoints of [`checked`]: some microseconds where each is short.
const ROUNDS: usize = 256;

/// The same items, with a [`checkpoint`] before the first and every 256th: for loops of many short rounds, such as
/// those over samples.
///
/// # Example
/// ```
/// let sum: u64 = work::checked(0..1_000_000_u64).sum();
/// assert_eq!(sum, 499_999_500_000);
/// ```
pub fn checked<I: IntoIterator>(items: I) -> impl Iterator<Item = I::Item> {
    items.into_iter().enumerate().map(|(round, item)| {
        if round.is_multiple_of(ROUNDS) {
            checkpoint();
        }
        item
    })
}

/// Ends the work of this thread if its context was cancelled. It costs a few nanoseconds: call it in every loop that
/// may take longer than some milliseconds. Outside of a context it does nothing.
pub fn checkpoint() {
    OF_THREAD.with_borrow(|cancel| {
        if let Some(cancel) = cancel {
            cancel.check();
        }
    });
}
