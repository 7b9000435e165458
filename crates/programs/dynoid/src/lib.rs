//! Recordings of a dynamometer test bench in, a validated bench model out: the library that programs call.
//!
//! [`Files`] are the files of one run: what it reads, and what it may write. A [`Bench`] is a bench file. A [`Session`]
//! is a bench with its recordings, and gives what they show. Long work takes a [`work::Context`], by which a program
//! follows and ends it.
//!
//! ```no_run
//! use dynoid::{Bench, Files, Session};
//! use work::Context;
//!
//! # fn main() -> Result<(), dynoid::Error> {
//! let (files, context) = (Files::new("fleet report", false), Context::new());
//! let bench = Bench::load("cell4/bench.toml".as_ref(), &files)?;
//! let session = Session::open(bench, &files, &context)?;
//! let study = session.study(&context)?;
//! assert!(study.model.is_some());
//! # Ok(())
//! # }
//! ```

#![warn(missing_docs)]

pub mod analyses;
mod bench;
pub mod date;
mod error;
mod files;
mod find;
mod formats;
mod mark;
mod output;
pub mod paths;
mod patterns;
mod read;
mod session;
mod study_file;

pub use bench::{Bench, bench_text};
pub use error::Error;
pub use files::Files;
pub use find::{InputFile, is_recording, listed, recordings_in};
pub use formats::{FileFormat, encode_mdf4, encode_table};
pub use mark::{Kind, Mark, in_png, in_svg, is_bench_file};
pub use output::{OutputFolder, Staging, check_file, check_replaceable, remove_when_ended, replace_file, replace_with};
pub use read::{Read, is_json, refuse_model, selection, sha256_of_text};
pub use session::Session;
pub use study_file::StudyFile;
