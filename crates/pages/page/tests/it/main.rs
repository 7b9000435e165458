//! Integration tests of `page`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod colours;
mod decimal;
mod drawing;
mod pdf;
mod renderers;
mod samples;
