//! The study as one JSON document.

use bench::Study;
use serde::Serialize;

/// Version of the JSON document's shape. It grows by one when a field changes its meaning or disappears.
pub const FORMAT_VERSION: u32 = 1;

#[derive(Serialize)]
struct Document<'a> {
    format: &'static str,
    format_version: u32,
    study: &'a Study,
}

/// The study as compact JSON: `{"format": "dynoid-study", "format_version": 1, "study": {…}}`.
///
/// Numbers keep their full precision; one that is NaN or infinite is `null`. Should serialisation ever fail, the
/// document holds an `error` text in place of `study`, so that a reader of the file sees why.
pub fn json(study: &Study) -> String {
    let document = Document { format: "dynoid-study", format_version: FORMAT_VERSION, study };
    serde_json::to_string(&document).unwrap_or_else(|error| {
        let reason = serde_json::Value::String(error.to_string());
        format!(r#"{{"format":"dynoid-study","format_version":{FORMAT_VERSION},"error":{reason}}}"#)
    })
}
