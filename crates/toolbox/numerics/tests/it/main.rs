//! Tests of the shared numerical tools from outside.
#![allow(clippy::unwrap_used, clippy::expect_used)]

mod parallel;
mod random;
