#![doc = include_str!("../README.md")]
//!
//! A model as the files of other programs. [`ExportedFile`] is a name and bytes; whoever calls writes them.
//!
//! This crate may know bench models and linear models. It may not know paths, pages, studies or the clock.

mod draws;
mod file;
pub mod names;

pub use draws::draws;
pub use file::ExportedFile;
