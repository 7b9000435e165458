//! Changes of a bench file's text, key by key: comments, order and spacing of everything else stay.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value as Json;
use toml_edit::{Array, ArrayOfTables, DocumentMut, Formatted, InlineTable, Item, Table, TableLike, Value};

use crate::error::Error;

/// The place behind the last element of a list.
const BEHIND: &str = "+";

/// A key that gets another value, or none.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// The key with its tables, such as `channels` and `dyno_speed`. Of a list the place counts from zero, and `+`
    /// adds an element behind the last.
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
    let Some((first, rest)) = change.key.split_first() else { return Err("a change names no key".to_owned()) };
    in_table(root, first, rest, &change.value)
}

/// Changes a key of a table, or what is below it.
fn in_table(table: &mut dyn TableLike, name: &str, rest: &[String], value: &Json) -> Result<(), String> {
    let Some((next, below)) = rest.split_first() else { return set(table, name, value) };
    if value.is_null() && !table.contains_key(name) {
        return Ok(());
    }
    let item = table.entry(name).or_insert_with(|| match next == BEHIND {
        true if value.is_object() || !below.is_empty() => Item::ArrayOfTables(ArrayOfTables::new()),
        true => Item::Value(Value::Array(Array::new())),
        false => Item::Table(Table::new()),
    });
    match item {
        Item::ArrayOfTables(tables) => in_tables(tables, next, below, value),
        Item::Value(Value::Array(array)) => in_array(array, next, below, value),
        item => {
            let table = item.as_table_like_mut().ok_or_else(|| format!("`{name}` is a value, and holds no keys"))?;
            in_table(table, next, below, value)
        }
    }
}

/// Changes a table of a list of tables, or what is below it.
fn in_tables(tables: &mut ArrayOfTables, place: &str, rest: &[String], value: &Json) -> Result<(), String> {
    let place = place_in(place, tables.len())?;
    if place < tables.len() && value.is_null() && rest.is_empty() {
        tables.remove(place);
        return Ok(());
    }
    if place == tables.len() {
        tables.push(Table::new());
    }
    let table = tables.get_mut(place).ok_or("the list is empty")?;
    match (rest.split_first(), value) {
        (Some((name, rest)), value) => in_table(table, name, rest, value),
        (None, Json::Object(fields)) => {
            table.retain(|name, _| fields.contains_key(name));
            fields.iter().try_for_each(|(name, field)| set(table, name, field))
        }
        (None, _) => Err("a list of tables holds tables alone".to_owned()),
    }
}

/// Changes an element of a list, or what is below it.
fn in_array(array: &mut Array, place: &str, rest: &[String], value: &Json) -> Result<(), String> {
    let place = place_in(place, array.len())?;
    if place < array.len() && value.is_null() && rest.is_empty() {
        array.remove(place);
        return Ok(());
    }
    if place == array.len() {
        array.push(if rest.is_empty() { in_toml(value)? } else { Value::InlineTable(InlineTable::new()) });
    }
    let element = array.get_mut(place).ok_or("the list is empty")?;
    match (rest.split_first(), element) {
        (Some((name, rest)), Value::InlineTable(table)) => in_table(table, name, rest, value),
        (Some(_), _) => Err(format!("element {place} of the list is a value, and holds no keys")),
        (None, element) => {
            replace(element, in_toml(value)?);
            Ok(())
        }
    }
}

fn place_in(place: &str, count: usize) -> Result<usize, String> {
    match place.parse() {
        _ if place == BEHIND => Ok(count),
        Ok(place) if place < count => Ok(place),
        _ => Err(format!("the list has no place {place}")),
    }
}

fn set(table: &mut dyn TableLike, name: &str, value: &Json) -> Result<(), String> {
    if value.is_null() {
        table.remove(name);
        return Ok(());
    }
    let value = in_toml(value)?;
    match table.get_mut(name).and_then(Item::as_value_mut) {
        Some(old) => replace(old, value),
        None => {
            table.insert(name, Item::Value(value));
        }
    }
    Ok(())
}

/// Spaces around the value stay, and a remark behind it.
fn replace(old: &mut Value, value: Value) {
    let around = old.decor().clone();
    *old = value;
    *old.decor_mut() = around;
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

    const LISTS: &str = "[recordings]\nfiles = [\n  \"a.mf4\", # first\n]\n\n# The valve stuck.\n[[recordings.label]]\nfile = \"a.mf4\"\nlabel = \"FILL IN\" # e.g. BS\n\n[report]\n";

    fn changed_lists(key: &[&str], value: Json) -> String {
        let key = key.iter().map(|part| (*part).to_owned()).collect();
        changed("bench.toml".as_ref(), LISTS, &[Change { key, value }]).unwrap()
    }

    #[test]
    fn exact_tables_of_a_list_change_come_and_go() {
        let text = changed_lists(&["recordings", "label", "0", "label"], json!("BS_T_NT"));
        assert_eq!(text, LISTS.replace("FILL IN", "BS_T_NT"));
        let text = changed_lists(&["recordings", "label", "+"], json!({"file": "b.mf4", "label": "BS_T_NT"}));
        let added = "[[recordings.label]]\nfile = \"b.mf4\"\nlabel = \"BS_T_NT\"\n\n[report]";
        assert_eq!(text, LISTS.replace("[report]", added));
        let text = changed_lists(&["recordings", "label", "0"], Json::Null);
        assert!(!text.contains("label") && text.contains("# first") && text.ends_with("[report]\n"), "{text}");
        let text = changed_lists(&["recordings", "stretch", "+"], json!({"file": "a.mf4", "leave_out": [1.5, 2]}));
        assert!(text.contains("[[recordings.stretch]]\nfile = \"a.mf4\"\nleave_out = [1.5, 2]\n"), "{text}");
    }

    #[test]
    fn exact_elements_of_a_list_change_come_and_go() {
        let text = changed_lists(&["recordings", "files", "+"], json!("b.mf4"));
        assert!(text.contains("# first") && text.contains("\"b.mf4\""), "{text}");
        assert_eq!(values(&text).unwrap()["recordings"]["files"], json!(["a.mf4", "b.mf4"]));
        let text = changed_lists(&["recordings", "files", "0"], Json::Null);
        assert_eq!(values(&text).unwrap()["recordings"]["files"], json!([]));
    }

    #[test]
    fn exact_a_place_beyond_a_list_is_refused() {
        let key = ["recordings", "label", "7", "label"].map(str::to_owned).to_vec();
        let refused = changed("bench.toml".as_ref(), LISTS, &[Change { key, value: json!("BS_T_NT") }]);
        assert!(refused.unwrap_err().to_string().contains("no place 7"));
    }
}
