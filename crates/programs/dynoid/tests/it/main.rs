//! The library as a program uses it.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod cancellation;
mod can;
mod examples;
mod files;
mod session;
