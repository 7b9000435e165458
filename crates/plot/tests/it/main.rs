//! Integration tests of `plot`.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod drawing;
