//! The app: pages on this computer that show recordings, and in which everything is done that the commands do.
//!
//! [`App::serve`] answers a browser on this computer, and nobody else (`guard`). A page gets what it shows through the
//! library `dynoid`: recordings as open handles (`recordings`), spectra and the like of a stretch of one (`stretches`),
//! files as text (`texts`), studies (`studies`), models on recordings (`models`), lines over the speed (`campbell`).
//! Longer work is a command of the program, run as a process of its own (`jobs`): it outlives the page and this
//! program. Each act can be repeated without the app (`session`).
//! Nothing here has a formula or a rule about benches.

#![warn(missing_docs)]

mod answer;
mod blocking;
mod campbell;
mod can;
mod folder;
mod guard;
mod handles;
mod jobs;
mod labels;
mod models;
mod next;
mod recordings;
mod server;
mod session;
mod shared;
mod site;
mod stretches;
mod studies;
mod texts;
mod tries;

pub use jobs::run_job;
pub use server::{App, AppError};
pub use shared::Program;
