//! `dynoid convert`: recordings in another format.

mod choice;
mod recordings;
mod targets;

pub(crate) use recordings::run;
