//! The program `dynoid`, as the wheel has it.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs the program with these arguments, the first of which is its name, and returns its exit code. Wrong arguments
/// and calls for help end the process.
#[pyfunction]
pub(crate) fn program(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| dynoid_cli::main(arguments))
}
