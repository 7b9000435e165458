//! The list of all parts of the program, in the form CycloneDX 1.5.

use serde_json::{Map, Value, json};

use super::linked::{Crate, Id, Linked};

/// The list as JSON. It has no serial number, since the same commit has to give the same bytes.
pub(super) fn text(linked: &Linked, repository: &str, day_and_time: &str) -> Result<String, String> {
    let is_program = |id: &&Id| id.0 == "dynoid-cli";
    let id = linked.crates.keys().find(is_program).ok_or("cargo tree does not name dynoid-cli")?;
    let component = |(id, one): (&Id, &Crate)| component(id, one, "library", repository);
    let others: Vec<Value> = linked.crates.iter().filter(|(id, _)| !is_program(id)).map(component).collect();
    let dependency = |(id, one): (&Id, &Crate)| {
        let purl = |id: &Id| purl(id, &linked.crates[id], repository);
        json!({"ref": purl(id), "dependsOn": one.uses.iter().map(purl).collect::<Vec<_>>()})
    };
    let list = json!({
        "$schema": "http://cyclonedx.org/schema/bom-1.5.schema.json",
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "timestamp": day_and_time,
            "component": component_of_program(id, &linked.crates[id], repository),
        },
        "components": others,
        "dependencies": linked.crates.iter().map(dependency).collect::<Vec<_>>(),
    });
    serde_json::to_string_pretty(&list).map(|text| text + "\n").map_err(|error| format!("the list of parts: {error}"))
}

fn component_of_program(id: &Id, program: &Crate, repository: &str) -> Value {
    let mut component = component(id, program, "application", repository);
    component["name"] = "dynoid".into();
    component
}

fn component(id: &Id, one: &Crate, kind: &str, repository: &str) -> Value {
    let (name, version) = id;
    let purl = purl(id, one, repository);
    let mut component = Map::new();
    component.insert("type".to_owned(), kind.into());
    component.insert("bom-ref".to_owned(), purl.as_str().into());
    component.insert("name".to_owned(), name.as_str().into());
    component.insert("version".to_owned(), version.as_str().into());
    component.insert("scope".to_owned(), "required".into());
    if let Some(sum) = &one.checksum {
        component.insert("hashes".to_owned(), json!([{"alg": "SHA-256", "content": sum}]));
    }
    component.insert("licenses".to_owned(), json!([{"expression": one.licence}]));
    component.insert("purl".to_owned(), purl.into());
    if let Some(url) = &one.repository {
        component.insert("externalReferences".to_owned(), json!([{"type": "vcs", "url": url}]));
    }
    component.into()
}

/// The name of a crate among all packages; our own crates are at the tag of the version.
fn purl((name, version): &Id, one: &Crate, repository: &str) -> String {
    let place = format!("git+{repository}@v{version}");
    let place = place.replace('+', "%2B").replace(':', "%3A").replace('/', "%2F").replace('@', "%40");
    match one.checksum {
        Some(_) => format!("pkg:cargo/{name}@{version}"),
        None => format!("pkg:cargo/{name}@{version}?vcs_url={place}"),
    }
}

#[cfg(test)]
mod tests {
    use std::collections::{BTreeMap, BTreeSet};
    use std::path::PathBuf;

    use super::*;

    #[test]
    fn exact_every_part_has_its_licence_and_sum_and_every_reference_is_a_part() {
        let id = |name: &str| (name.to_owned(), "1.0.0".to_owned());
        let one = |checksum: Option<&str>, uses: &[&str]| Crate {
            licence: "MIT".to_owned(),
            repository: None,
            folder: PathBuf::new(),
            checksum: checksum.map(str::to_owned),
            uses: uses.iter().map(|name| id(name)).collect::<BTreeSet<_>>(),
        };
        let crates = BTreeMap::from([(id("dynoid-cli"), one(None, &["a"])), (id("a"), one(Some("12ab"), &[]))]);
        let text = text(&Linked { crates }, "https://example.org/d", "2026-01-01T00:00:00Z").unwrap();
        let list: Value = serde_json::from_str(&text).unwrap();
        let own = "pkg:cargo/dynoid-cli@1.0.0?vcs_url=git%2Bhttps%3A%2F%2Fexample.org%2Fd%40v1.0.0";
        assert_eq!(list["metadata"]["component"]["bom-ref"], own);
        assert_eq!(list["components"][0]["hashes"][0]["content"], "12ab");
        assert_eq!(list["components"][0]["licenses"][0]["expression"], "MIT");
        assert_eq!(list["dependencies"][1], json!({"ref": own, "dependsOn": ["pkg:cargo/a@1.0.0"]}));
    }
}
