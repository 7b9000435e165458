//! Long work: Python runs on meanwhile, hears of its progress, and Ctrl-C ends it.

use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;
use work::{Context, Progress, Tree};

use crate::errors::Fault;

/// Ctrl-C is looked for so often.
const PATIENCE: Duration = Duration::from_millis(40);

enum News {
    Progress(Progress),
    Ended,
}

/// Says that the work has ended, however it did.
struct Ending(Sender<News>);

impl Drop for Ending {
    fn drop(&mut self) {
        let _ = self.0.send(News::Ended);
    }
}

/// Runs some work without holding the interpreter, on a thread of its own. `progress` is called on this one, with the
/// part that is done and the step under way. An exception that it raises ends the work, and so does Ctrl-C.
pub(crate) fn run<R: Send>(
    py: Python<'_>,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
    work: impl FnOnce(&Context) -> R + Send,
) -> Result<R, Fault> {
    let (news, heard) = mpsc::channel();
    let mut context = Context::new();
    if let Some(threads) = threads {
        context = context.with_threads(threads);
    }
    if progress.is_some() {
        let news = news.clone();
        context = context.with_listener(move |step| {
            let _ = news.send(News::Progress(step.clone()));
        });
    }
    py.detach(move || {
        thread::scope(|scope| {
            let worker = scope.spawn(|| {
                let _ending = Ending(news);
                context.run(|| work(&context))
            });
            let mut tree = Tree::default();
            let mut raised = None;
            loop {
                let news = heard.recv_timeout(PATIENCE);
                if let Ok(News::Progress(step)) = &news {
                    tree.hear(step);
                }
                if matches!(news, Ok(News::Ended) | Err(RecvTimeoutError::Disconnected)) {
                    break;
                }
                let callback = progress.as_ref().filter(|_| news.is_ok() && raised.is_none());
                let attended = Python::attach(|py| attend(py, callback, &tree));
                if let Err(error) = attended {
                    context.cancel().cancel();
                    raised.get_or_insert(error);
                }
            }
            let ended = worker.join().unwrap_or_else(|cause| std::panic::resume_unwind(cause));
            match (raised, ended) {
                (Some(error), _) => Err(Fault::Raised(error)),
                (None, Ok(done)) => Ok(done),
                (None, Err(cancelled)) => Err(Fault::argument(cancelled.to_string())),
            }
        })
    })
}

/// Runs some work that nobody follows.
pub(crate) fn quietly<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> Result<R, Fault> {
    run(py, None, None, |_| work())
}

fn attend(py: Python<'_>, callback: Option<&Py<PyAny>>, tree: &Tree) -> PyResult<()> {
    py.check_signals()?;
    match callback {
        Some(callback) => callback.call1(py, (tree.fraction(), tree.current().unwrap_or_default())).map(|_| ()),
        None => Ok(()),
    }
}
