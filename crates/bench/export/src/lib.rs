#![doc = include_str!("../README.md")]
//!
//! A model as the files of other programs. [`ExportedFile`] is a name and bytes; whoever calls writes them. Each target
//! is a module: [`fmu`], [`matlab`], [`modelica`], [`python`], [`ssv`].
//!
//! This crate may know bench models and linear models. It may not know paths, pages, studies or the clock.

mod continuous;
mod draws;
mod error;
mod file;
pub mod fmu;
mod levels;
mod linear;
pub mod matlab;
pub mod modelica;
pub mod names;
pub mod numbers;
pub mod python;
pub mod ssv;
mod start;
mod xml;

pub use continuous::{Continuous, of as continuous};
pub use draws::draws;
pub use error::ExportError;
pub use file::ExportedFile;
pub use linear::toolbox_models;
