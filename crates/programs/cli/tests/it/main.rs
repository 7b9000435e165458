//! The program as its users meet it: run on files, looked at from outside.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod bad_input;
mod can;
mod controller;
mod convert;
mod convert_recordings;
mod datasets;
mod demo;
mod diff;
#[cfg(target_os = "linux")]
mod dropped;
#[cfg(unix)]
mod ended;
mod engine;
mod every_command;
mod experiment;
mod export;
mod figures;
mod friction;
mod full_report;
mod greybox;
mod help;
mod identify;
mod init;
mod inspect;
mod levels;
mod lines;
mod look;
mod model_file;
mod numbers;
mod odd_recordings;
mod operating_point;
#[cfg(unix)]
mod places;
mod published;
mod report;
mod schema;
mod shaft;
mod study;
mod support;
mod terminal;
mod torque_control;
mod torque_signals;
mod tutorials;
mod unusual;
mod width;
mod writers;
