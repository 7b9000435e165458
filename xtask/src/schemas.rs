//! `cargo xtask schemas`: the JSON schemas in docs/schemas, from the types of the results.

use crate::steps::{cargo_command, run};

/// Has the test that compares the schemas write them.
pub(crate) fn write() -> Result<(), String> {
    let arguments = ["test", "--release", "--quiet", "-p", "dynoid", "--test", "it", "snap_schemas"];
    run("the schemas", cargo_command(&arguments, None).env("DYNOID_WRITE_SCHEMAS", "1"))
}
