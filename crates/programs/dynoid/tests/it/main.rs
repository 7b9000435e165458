//! The library as a program uses it.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]

mod can;
mod cancellation;
mod examples;
mod facts;
mod files;
mod meeting;
mod schemas;
mod session;
