//! Integration tests of `page`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod drawing;
mod renderers;
