//! JSON documents against the committed schemas, with the Python package jsonschema.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::{Value, json};

/// Long lists are cut to so many items before they are judged: the items of a list have one form.
const JUDGED_ITEMS: usize = 50;

/// Holds a document to the schema of this name: it is valid, and not valid any more with a field renamed.
#[track_caller]
pub fn assert_valid(name: &str, document: &Value) {
    assert_meets(&read(&folder().join(format!("{name}.json"))), document);
}

/// The same with the schema of the `format` that the document states.
#[track_caller]
pub fn assert_valid_by_format(document: &Value) {
    let files = fs::read_dir(folder()).expect("a folder of schemas").map(|entry| entry.expect("a file").path());
    let is_of_format = |schema: &Value| schema["properties"]["format"]["const"] == document["format"];
    let schema = files.map(|path| read(&path)).find(is_of_format);
    assert_meets(&schema.unwrap_or_else(|| panic!("no schema has the format {}", document["format"])), document);
}

/// The folder of the schemas.
fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs/schemas")
}

fn read(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

#[track_caller]
fn assert_meets(schema: &Value, document: &Value) {
    let name = &schema["$id"];
    let document = shortened(document);
    let mut other = document.clone();
    let is_renamed = required_field(schema, schema).is_some_and(|field| rename(&mut other, field));
    let Some(faults) = faults(schema, &[document, other]) else { return };
    assert!(faults[0].is_empty(), "{name}: {:#?}", &faults[0][..faults[0].len().min(5)]);
    assert!(!is_renamed || !faults[1].is_empty(), "{name}: a field was renamed, and the document is still valid");
}

/// Faults of each document by a schema; none where there is no Python to find them.
fn faults(schema: &Value, documents: &[Value]) -> Option<Vec<Vec<String>>> {
    let mut command = Command::new(testdata::python()?);
    command.args(["-c", include_str!("validate.py")]).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut python = command.spawn().expect("Python starts");
    let given = json!({"schema": schema, "documents": documents}).to_string();
    python.stdin.take().expect("an input").write_all(given.as_bytes()).expect("Python reads");
    let output = python.wait_with_output().expect("Python ends");
    assert!(output.status.success(), "the validator failed");
    Some(serde_json::from_slice(&output.stdout).expect("lists of faults"))
}

/// The document with the beginnings of its lists.
fn shortened(value: &Value) -> Value {
    match value {
        Value::Array(items) => items.iter().take(JUDGED_ITEMS).map(shortened).collect(),
        Value::Object(fields) => fields.iter().map(|(name, inner)| (name.clone(), shortened(inner))).collect(),
        other => other.clone(),
    }
}

/// A field that the results in a document must have.
fn required_field<'a>(schema: &'a Value, whole: &'a Value) -> Option<&'a str> {
    let named = schema["$ref"].as_str().and_then(|path| whole.pointer(path.trim_start_matches('#')));
    let schema = named.unwrap_or(schema);
    match schema.get("items").or(schema.pointer("/properties/result")) {
        Some(inner) => required_field(inner, whole),
        None => schema["required"][0].as_str(),
    }
}

/// Renames this field where it is first found; false where it is nowhere.
fn rename(value: &mut Value, field: &str) -> bool {
    match value {
        Value::Object(fields) => match fields.remove(field) {
            Some(moved) => fields.insert(format!("{field}_renamed"), moved).is_none(),
            None => fields.get_mut("result").is_some_and(|result| rename(result, field)),
        },
        Value::Array(items) => items.iter_mut().any(|item| rename(item, field)),
        _ => false,
    }
}
