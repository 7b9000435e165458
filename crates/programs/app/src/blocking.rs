//! Work that takes its time, on a thread where it holds nobody up.

use serde::Serialize;
use tokio::task::spawn_blocking;
use work::{Cancel, Context};

use crate::answer::{Answer, Fault, json};

/// Does it there.
pub(crate) async fn blocking(work: impl FnOnce() -> Answer + Send + 'static) -> Answer {
    spawn_blocking(work).await.unwrap_or_else(|error| Err(Fault::refused(error)))
}

/// Does it there, and ends it when the page goes on to something else.
pub(crate) async fn cancellable<T: Serialize + Send + 'static>(
    work: impl FnOnce(&Context) -> Result<T, Fault> + Send + 'static,
) -> Answer {
    let context = Context::new();
    let _unwanted = Unwanted(context.cancel());
    let found = spawn_blocking(move || context.run(|| work(&context))).await;
    json(&found.map_err(Fault::refused)?.map_err(Fault::refused)??)
}

/// Cancels work whose answer nobody waits for any more.
struct Unwanted(Cancel);

impl Drop for Unwanted {
    fn drop(&mut self) {
        self.0.cancel();
    }
}
