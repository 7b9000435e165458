//! Tests of the shared numerical tools from outside.

mod parallel;
mod random;
