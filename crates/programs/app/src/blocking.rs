//! Work that takes its time, on a thread where it holds nobody up.

use crate::answer::{Answer, Fault};

/// Does it there.
pub(crate) async fn blocking(work: impl FnOnce() -> Answer + Send + 'static) -> Answer {
    tokio::task::spawn_blocking(work).await.unwrap_or_else(|error| Err(Fault::refused(error)))
}
