//! Changes of a bench file's text, key by key: comments, order and spacing of everything else stay.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use toml_edit::{DocumentMut, Formatted, InlineTable, Item, Table, TableLike, Value};

use crate::error::Error;

/// A key that gets another value, or none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// The key with its tables, such as `channels` and `dyno_speed`.
    pub key: Vec<String>,
    /// The value; null takes the key away.
    pub value: Json,
}

/// The text of a bench file with changes.
///
/// # Errors
/// A text that is not TOML, a key within a value, and a value that TOML has not.
pub fn changed(path: &Path, text: &str, changes: &[Change]) -> Result<String, Error> {
    let failed = |reason: String| Error::NotChanged { path: path.to_owned(), reason };
    let mut document: DocumentMut = text.parse().map_err(|error: toml_edit::TomlError| failed(error.to_string()))?;
    for change in changes {
        apply(document.as_table_mut(), change).map_err(failed)?;
    }
    Ok(document.to_string())
}

/// The values of a bench file's text, as JSON; none where it is not TOML.
pub fn values(text: &str) -> Option<Json> {
    toml::from_str(text).ok()
}

fn apply(root: &mut Table, change: &Change) -> Result<(), String> {
    let Some((last, tables)) = change.key.split_last() else { return Err("a change names no key".to_owned()) };
    let mut place: &mut dyn TableLike = root;
    for name in tables {
        if change.value.is_null() && !place.contains_key(name) {
            return Ok(());
        }
        let below = place.entry(name).or_insert_with(|| Item::Table(Table::new()));
        place = below.as_table_like_mut().ok_or_else(|| format!("`{name}` is a value, and holds no keys"))?;
    }
    if change.value.is_null() {
        place.remove(last);
        return Ok(());
    }
    let value = in_toml(&change.value)?;
    match place.get_mut(last).and_then(Item::as_value_mut) {
        // What stands around the value stays: spaces, and a remark behind it.
        Some(old) => {
            let around = old.decor().clone();
            *old = value;
            *old.decor_mut() = around;
        }
        None => {
            place.insert(last, Item::Value(value));
        }
    }
    Ok(())
}

fn in_toml(value: &Json) -> Result<Value, String> {
    Ok(match value {
        Json::Null => return Err("TOML has no empty value".to_owned()),
        Json::Bool(truth) => Value::Boolean(Formatted::new(*truth)),
        Json::Number(number) => match (number.as_i64(), number.as_f64()) {
            (Some(integer), _) => Value::Integer(Formatted::new(integer)),
            (None, Some(float)) => Value::Float(Formatted::new(float)),
            (None, None) => return Err(format!("{number} is too large")),
        },
        Json::String(text) => Value::from(text.as_str()),
        Json::Array(elements) => Value::Array(elements.iter().map(in_toml).collect::<Result<_, _>>()?),
        Json::Object(fields) => {
            let mut table = InlineTable::new();
            for (name, field) in fields.iter().filter(|(_, field)| !field.is_null()) {
                table.insert(name, in_toml(field)?);
            }
            Value::InlineTable(table)
        }
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use serde_json::json;

    use super::*;

    const TEXT: &str = "# Cell 4\n[bench]\nname = \"Cell 4\" # as on the door\ncylinders = 4\n\n[channels]\n# From the drive.\ndyno_speed = \"N\"\n";

    fn with(changes: &[(&[&str], Json)]) -> String {
        let change = |(key, value): &(&[&str], Json)| Change {
            key: key.iter().map(|part| (*part).to_owned()).collect(),
            value: value.clone(),
        };
        changed("bench.toml".as_ref(), TEXT, &changes.iter().map(change).collect::<Vec<_>>()).unwrap()
    }

    #[test]
    fn exact_remarks_and_order_stay() {
        let text = with(&[
            (&["bench", "name"], json!("Cell 5")),
            (&["channels", "dyno_speed"], json!({"name": "N2", "unit": "rpm"})),
        ]);
        let wanted = TEXT.replace("\"Cell 4\"", "\"Cell 5\"").replace("\"N\"", "{ name = \"N2\", unit = \"rpm\" }");
        assert_eq!(text, wanted);
    }

    #[test]
    fn exact_keys_come_and_go() {
        let text = with(&[
            (&["limits", "torque"], json!("360 Nm")),
            (&["bench", "cylinders"], Json::Null),
            (&["shaft", "damping"], Json::Null),
        ]);
        assert!(
            text.contains("[limits]\ntorque = \"360 Nm\"\n") && !text.contains("cylinders") && !text.contains("shaft"),
            "{text}"
        );
        assert!(text.contains("# as on the door") && text.contains("# From the drive."));
    }

    #[test]
    fn exact_a_key_within_a_value_is_refused() {
        let change = Change { key: vec!["bench".into(), "name".into(), "first".into()], value: json!(1) };
        assert!(changed("bench.toml".as_ref(), TEXT, &[change]).unwrap_err().to_string().contains("`name`"));
        assert!(changed("bench.toml".as_ref(), "[bench", &[]).is_err());
    }
}
