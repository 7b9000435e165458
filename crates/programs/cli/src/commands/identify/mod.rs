//! Identification of linear models from any recording: the library `ident` at the command line.

pub(crate) mod convert;
mod data;
pub(crate) mod explore;
pub(crate) mod fit;
mod greybox;
pub(crate) mod judge;
pub(crate) mod model;
