//! Integration tests of bench files, channels, preparation and experiments.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout)]
#![allow(clippy::disallowed_methods)] // recordings outside the project are read from a folder

mod align;
mod bench_file;
mod channels;
mod damaged;
mod dyno_friction;
mod engine_pulses;
mod experiment;
mod prepare;
mod recorded;
mod results;
mod stretch;
mod written;
