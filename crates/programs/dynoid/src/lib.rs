//! Recordings of a dynamometer test bench in, a validated bench model out: the library that programs call.
//!
//! [`Files`] are the files of one run: what it reads, and what it may write. A [`Bench`] is a bench file. A [`Session`]
//! is a bench with its recordings, and gives what they show; a [`StudyFolder`] takes the report. A [`KnownBench`] is a
//! bench on which tests ([`can`]) and [`experiments`] are tried. [`linear`] has models of any channels, and [`Export`]
//! makes files of other programs from models. [`convert`] brings recordings into another format. [`replay`] runs bench
//! models on recordings, and [`linear`] compares, tests and simulates linear ones on them. [`BenchRecordings`] are
//! looked at one by one. [`stretches`] has spectra and the like of parts of one. A [`Demonstration`] is a bench whose
//! every parameter is known. Long work takes a [`work::Context`], by which a program follows and ends it.
//!
//! ```no_run
//! use dynoid::{Bench, Files, Session, StudyFolder, StudyOptions};
//! use work::Context;
//!
//! # fn main() -> Result<(), dynoid::Error> {
//! let (files, context) = (Files::new("fleet report", false), Context::new());
//! let bench = Bench::load("cell4/bench.toml".as_ref(), &files)?;
//! let folder = StudyFolder::check(&bench, "cell4/study".as_ref(), StudyOptions::default(), &files)?;
//! let written = folder.write(&Session::open(bench, &files, &context)?, &context)?;
//! println!("{}", written.report.display());
//! # Ok(())
//! # }
//! ```
//!
//! The examples of this crate run on a virtual bench, so that they run anywhere.
//!
//! # A study
//!
//! ```ignore
#![doc = include_str!("../examples/study.rs")]
//! ```
//!
//! # Can this bench run this test?
//!
//! ```ignore
#![doc = include_str!("../examples/verdict.rs")]
//! ```
//!
//! # A linear model of two channels
//!
//! ```ignore
#![doc = include_str!("../examples/fit.rs")]
//! ```
//!
//! # The model in another program
//!
//! ```ignore
#![doc = include_str!("../examples/export.rs")]
//! ```
//!
//! # Recordings in another format
//!
//! ```ignore
#![doc = include_str!("../examples/convert.rs")]
//! ```

#![warn(missing_docs)]

pub mod analyses;
mod bench;
mod benches;
mod campbell;
pub mod can;
mod changed;
pub mod convert;
pub mod date;
mod demonstration;
mod error;
pub mod experiments;
mod exports;
pub mod facts;
mod fault;
mod features;
mod files;
mod find;
mod formats;
mod inspect;
mod known;
mod labels;
mod limits;
pub mod linear;
mod mark;
mod meeting;
mod models;
mod output;
pub mod pages;
pub mod paths;
mod patterns;
mod proposal;
mod read;
mod rebuilt;
mod recordings;
pub mod replay;
mod roles;
pub mod schemas;
mod session;
mod several;
pub mod stretches;
mod study_file;
mod written;

pub use bench::{Bench, bench_text};
pub use benches::{TwoBenches, TwoBenchesFacts};
pub use campbell::{campbell, folded_hz};
pub use changed::{Change, changed, values};
pub use demonstration::{Demonstration, EFFECTS};
pub use error::{Error, NotDesigned, NotPredicted};
pub use exports::{Export, ExportTarget, WrittenExport};
pub use fault::Fault;
pub use files::Files;
pub use find::{InputFile, is_recording, listed, recordings_in};
pub use formats::{FileFormat, encode_mdf4, encode_table};
pub use known::{Draws, KnownBench, PulsesFrom};
pub use labels::{PlacedStretch, RecordingUse, SeenLabel, seen_label, uses};
pub use limits::OtherLimits;
pub use mark::{Kind, Mark, is_bench_file};
pub use meeting::{Meeting, MeetingFacts};
pub use models::{MODEL, Model, ModelFacts, check_model_file, model_name};
pub use output::{OutputFolder, Staging, check_file, check_replaceable, remove_when_ended, replace_file, replace_with};
pub use proposal::{Proposal, ProposalFacts};
pub use read::{Read, is_json, refuse_model, selection, sha256_of_text};
pub use rebuilt::{check_recording, write_engine_torque, write_recording, write_shaft_torque};
pub use recordings::{BenchRecordings, ReadRemarks};
pub use rig::bench_file::{KEYS, Key};
pub use roles::{RoleFacts, roles};
pub use session::Session;
pub use several::Models;
pub use study_file::StudyFile;
pub use written::{
    DATA, EarlierStudy, FULL_REPORT, FULL_REPORT_PDF, REPORT, REPORT_PDF, SERIES, SUMMARY_PDF, StudyFolder,
    StudyOptions, WrittenStudy,
};
