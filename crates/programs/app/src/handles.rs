//! Recordings that are open, so that no answer opens them again.

use std::collections::HashMap;
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use dynoid::{Files, InputFile};
use recording::Handle;
use work::Context;

use crate::answer::Fault;

/// Handles that stay open.
const MOST_OPEN: usize = 32;

/// Open recordings, by name, with the state of the file that they were opened in.
#[derive(Debug, Default)]
pub(crate) struct Handles {
    open: Mutex<HashMap<String, (Stamp, Handle)>>,
}

/// Length and time of a file: another one is another content.
type Stamp = (u64, Option<SystemTime>);

impl Handles {
    /// The handle of a file, which is opened where it is not open yet, or has changed.
    pub(crate) fn of(&self, name: &str, path: &Path) -> Result<Handle, Fault> {
        let metadata = path.metadata().map_err(Fault::refused)?;
        let stamp = (metadata.len(), metadata.modified().ok());
        let open = || self.open.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, handle)) = open().get(name).filter(|(opened, _)| *opened == stamp) {
            return Ok(handle.clone());
        }
        let file = InputFile { path: path.to_owned(), name: name.to_owned() };
        let handle = Files::new("app", false).open(&file, &Context::new()).map_err(Fault::refused)?;
        let mut open = open();
        if open.len() >= MOST_OPEN {
            open.clear();
        }
        open.insert(name.to_owned(), (stamp, handle.clone()));
        Ok(handle)
    }
}
