//! Tries: long work on threads of the server, whose result stays in memory for further questions.
//!
//! A judgement by other limits needs the runs of all benches, so it is no job of its own. The latest tries are kept;
//! the same question finds the try that is there.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use serde::Serialize;
use work::{Cancel, Context, Tree};

use crate::answer::{Answer, Fault, json};

/// Tries that are kept; an older one is ended and dropped.
const MOST_KEPT: usize = 6;
/// Digits of a hash that name a try.
const KEY_DIGITS: usize = 20;

/// Tries, the latest last.
#[derive(Debug)]
pub(crate) struct Tries<T> {
    kept: Mutex<VecDeque<Arc<Try<T>>>>,
}

/// Work that is under way, or was done.
#[derive(Debug)]
pub(crate) struct Try<T> {
    key: String,
    cancel: Cancel,
    heard: Mutex<Tree>,
    result: OnceLock<Result<T, String>>,
}

/// Where a try stands.
#[derive(Serialize)]
struct Stand<'a> {
    key: &'a str,
    is_done: bool,
    /// Why it has no result, where it ended without one.
    reason: Option<&'a String>,
    /// Part that is done, from 0 to 1.
    fraction: f64,
    /// The step that it is at, in words.
    doing: Option<&'a str>,
}

impl<T> Default for Tries<T> {
    fn default() -> Self {
        Tries { kept: Mutex::default() }
    }
}

impl<T: Send + Sync + 'static> Tries<T> {
    /// The try of a key.
    pub(crate) fn of(&self, key: &str) -> Result<Arc<Try<T>>, Fault> {
        let kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let found = kept.iter().find(|one| one.key == key).cloned();
        found.ok_or_else(|| Fault::refused("this result is not kept any more; calculate it again"))
    }

    /// Begins work, or finds the try of the same question.
    pub(crate) fn start(
        &self,
        key: String,
        work: impl FnOnce(&Context) -> Result<T, dynoid::Error> + Send + 'static,
    ) -> Arc<Try<T>> {
        let (one, is_new) = self.take(key);
        if is_new {
            let run = one.clone();
            std::thread::spawn(move || run.run(work));
        }
        one
    }

    /// The try of a key, and true where it is a new one, which nobody runs yet.
    fn take(&self, key: String) -> (Arc<Try<T>>, bool) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = kept.iter().find(|one| one.key == key) {
            return (found.clone(), false);
        }
        while kept.len() >= MOST_KEPT {
            kept.pop_front().iter().for_each(|oldest| oldest.cancel.cancel());
        }
        let (cancel, heard) = (Cancel::default(), Mutex::default());
        let new = Arc::new(Try { key, cancel, heard, result: OnceLock::new() });
        kept.push_back(new.clone());
        (new, true)
    }

    /// Ends a try, and forgets it.
    pub(crate) fn forget(&self, key: &str) {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        kept.iter().filter(|one| one.key == key).for_each(|one| one.cancel.cancel());
        kept.retain(|one| one.key != key);
    }
}

impl<T: Send + Sync + 'static> Try<T> {
    fn run(self: Arc<Self>, work: impl FnOnce(&Context) -> Result<T, dynoid::Error> + Send) {
        let heard = self.clone();
        let context = Context::new().with_cancel(self.cancel.clone()).with_listener(move |progress| {
            heard.heard.lock().unwrap_or_else(PoisonError::into_inner).hear(progress);
        });
        let found = context.run(|| work(&context));
        let result = match found {
            Ok(done) => done.map_err(|error| error.to_string()),
            Err(cancelled) => Err(cancelled.to_string()),
        };
        let _ = self.result.set(result);
    }

    /// Where it stands.
    pub(crate) fn stand(&self) -> Answer {
        let heard = self.heard.lock().unwrap_or_else(PoisonError::into_inner);
        let result = self.result.get();
        json(&Stand {
            key: &self.key,
            is_done: result.is_some(),
            reason: result.and_then(|result| result.as_ref().err()),
            fraction: heard.fraction(),
            doing: heard.current(),
        })
    }

    /// Its result.
    pub(crate) fn result(&self) -> Result<&T, Fault> {
        match self.result.get() {
            Some(Ok(done)) => Ok(done),
            Some(Err(reason)) => Err(Fault::refused(reason)),
            None => Err(Fault::refused("it is not ready")),
        }
    }
}

/// A name of a question and of the content of all files that it names, as they are now.
pub(crate) fn key_of(question: &impl Serialize, files: &[Option<PathBuf>]) -> Result<String, Fault> {
    let mut all = serde_json::to_string(question).map_err(Fault::refused)?;
    for file in files.iter().flatten().filter(|file| file.is_file()) {
        all += &String::from_utf8_lossy(&std::fs::read(file).map_err(Fault::refused)?);
    }
    Ok(dynoid::sha256_of_text(&all).chars().take(KEY_DIGITS).collect())
}
