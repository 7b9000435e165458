//! Results of the commands for linear models: a fit, a comparison, a spectrum and the like, each summed up as plain
//! data, as a page and as JSON.
//!
//! This crate may know the toolbox (`signal`, `lti`, `ident`, `dataset`), and nothing of benches, files and arguments.
//! It returns [`page::Page`]s, which have no say in how they are shown.

mod blocks;
pub mod compare;
pub mod convert;
pub mod data;
pub mod delay;
mod figures;
pub mod fit;
mod level;
pub mod models;
pub mod one_clock;
pub mod operating_point;
pub mod order;
pub mod residuals;
pub mod response;
pub mod spectrum;
pub mod words;
