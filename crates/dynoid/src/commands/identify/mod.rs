//! Identification of linear models from any recording: the library `ident` at the command line.

pub(crate) mod convert;
pub(in crate::commands) mod data;
pub(crate) mod explore;
mod figures;
pub(crate) mod fit;
mod greybox;
pub(crate) mod judge;
mod model_file;
mod operating_point;
mod recorded;
pub(crate) mod show;
pub(in crate::commands) mod words;
