//! Integration tests of `page`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod decimal;
mod drawing;
mod renderers;
