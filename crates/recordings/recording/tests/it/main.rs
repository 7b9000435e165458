//! Tests of `recording`; the prefix of a name says what a test proves.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

mod bench_files;
mod csv;
mod csv_parts;
mod csv_reference;
mod damage;
mod features;
mod handle;
#[cfg(feature = "hdf5")]
mod hdf5_parts;
#[cfg(feature = "parquet")]
mod interop;
#[path = "../../../mdf/tests/it/made.rs"]
#[allow(dead_code)] // what other tests need
mod made;
mod mat;
mod mdf;
mod round_trip;
mod selection;
#[cfg(feature = "parquet")]
mod table_parts;
#[cfg(feature = "parquet")]
mod tables;
