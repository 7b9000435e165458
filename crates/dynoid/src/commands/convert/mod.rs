//! `dynoid convert`: recordings in another format.

mod choice;
pub(in crate::commands) mod figures;
mod notes;
mod recordings;
mod targets;

pub(crate) use recordings::run;
