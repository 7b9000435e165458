//! Identification of linear models from any recording: the library `ident` at the command line.

mod data;
mod figures;
pub(crate) mod fit;
mod words;
