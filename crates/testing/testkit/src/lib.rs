#![doc = include_str!("../README.md")]
//!
//! Systems with known truth, and the conformance suites that every reader and every estimator must pass.

pub mod estimator;
pub mod reader;
pub mod system;
