//! The context that a caller gives to long work.

use std::fmt;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::cancel::{self, Cancel, Cancelled};
use crate::progress::{Progress, State};

type Listener = Arc<dyn Fn(&Progress) + Send + Sync>;

/// Context of long work: who hears of its progress, the wish that ends it, and the threads that it may use. A context
/// is also a step of the work; [`Context::step`] gives one for a part of it. Clones are of the same step.
#[derive(Clone)]
pub struct Context {
    cancel: Cancel,
    listener: Option<Listener>,
    /// All processors, unless it says otherwise.
    threads: Option<usize>,
    steps: Arc<AtomicU64>,
    step: Option<Arc<Step>>,
}

impl Context {
    /// A context that nobody listens to, which may use all processors.
    #[must_use]
    pub fn new() -> Self {
        Context { cancel: Cancel::default(), listener: None, threads: None, steps: Arc::default(), step: None }
    }

    /// The same with a listener, which hears of each step. Any thread may call it.
    #[must_use]
    pub fn with_listener(self, listener: impl Fn(&Progress) + Send + Sync + 'static) -> Self {
        Context { listener: Some(Arc::new(listener)), ..self }
    }

    /// The same with so many threads, at least one.
    #[must_use]
    pub fn with_threads(self, threads: usize) -> Self {
        Context { threads: Some(threads.max(1)), ..self }
    }

    /// The same with a wish of the caller's.
    #[must_use]
    pub fn with_cancel(self, cancel: Cancel) -> Self {
        Context { cancel, ..self }
    }

    /// The wish that ends the work.
    #[must_use]
    pub fn cancel(&self) -> Cancel {
        self.cancel.clone()
    }

    /// Threads that the work may use.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from))
    }

    /// Runs some work on the threads of this context. All parallel work in it uses them alone.
    ///
    /// # Errors
    /// The work was cancelled.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> Result<R, Cancelled> {
        match self.pool() {
            Some(pool) => cancel::caught(&self.cancel, || pool.install(work)),
            // The system has no threads to give: those of the caller do it.
            None => cancel::caught(&self.cancel, work),
        }
    }

    fn pool(&self) -> Option<ThreadPool> {
        let cancel = self.cancel.clone();
        let enter = move |_| {
            cancel.enter();
        };
        ThreadPoolBuilder::new().num_threads(self.threads()).start_handler(enter).build().ok()
    }

    /// Begins a part of the work, with so many parts of its own; 0 where these are not counted. It ends when it is
    /// dropped, and counts as one part of this step. Ends the work if it was cancelled.
    #[must_use]
    pub fn step(&self, what: impl Into<String>, parts: u64) -> Context {
        cancel::checkpoint();
        let step = Step {
            number: self.steps.fetch_add(1, Ordering::Relaxed) + 1,
            what: what.into(),
            done: AtomicU64::new(0),
            total: AtomicU64::new(parts),
            parent: self.step.clone(),
            listener: self.listener.clone(),
        };
        step.say(State::Begun);
        Context { step: Some(Arc::new(step)), ..self.clone() }
    }

    /// So many parts of this step are done. Ends the work if it was cancelled.
    pub fn advance(&self, parts: u64) {
        cancel::checkpoint();
        if let Some(step) = &self.step {
            step.done.fetch_add(parts, Ordering::Relaxed);
            step.say(State::Advanced);
        }
    }

    /// Of this step, `done` parts of `total` are done, where their number shows only on the way, as the bytes of a file
    /// that is opened. Ends the work if it was cancelled.
    pub fn reach(&self, done: u64, total: u64) {
        cancel::checkpoint();
        if let Some(step) = &self.step {
            step.done.store(done, Ordering::Relaxed);
            step.total.store(total, Ordering::Relaxed);
            step.say(State::Advanced);
        }
    }
}

impl Default for Context {
    fn default() -> Self {
        Self::new()
    }
}

impl fmt::Debug for Context {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let step = self.step.as_ref().map(|step| &step.what);
        f.debug_struct("Context").field("threads", &self.threads).field("step", &step).finish_non_exhaustive()
    }
}

/// A step under way.
struct Step {
    number: u64,
    what: String,
    done: AtomicU64,
    total: AtomicU64,
    parent: Option<Arc<Step>>,
    listener: Option<Listener>,
}

impl Step {
    fn say(&self, state: State) {
        let Some(listener) = &self.listener else { return };
        listener(&Progress {
            step: self.number,
            parent: self.parent.as_ref().map(|parent| parent.number),
            what: self.what.clone(),
            done: self.done.load(Ordering::Relaxed),
            total: self.total.load(Ordering::Relaxed),
            state,
        });
    }
}

impl Drop for Step {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.say(State::Abandoned);
            return;
        }
        if let Some(parent) = &self.parent {
            parent.done.fetch_add(1, Ordering::Relaxed);
        }
        self.say(State::Ended);
    }
}
