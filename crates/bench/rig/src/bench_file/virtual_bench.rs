//! The table `[virtual_bench]`: fields of the virtual bench's parameters, which are its schema.

use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, Deserializer};

use super::fault::FaultKind;
use super::sections::{Faults, Section};
use crate::bench_parameters::BenchParameters;

/// Reads the table; every key that no virtual bench has, and every value of the wrong type, is a fault.
pub(super) fn read(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> toml::Table {
    let Some(table) = section.table() else { return toml::Table::new() };
    if has_unknown_keys(section, &schema(), faults) {
        return toml::Table::new();
    }
    // What is left are values: the fields' own types judge them.
    let parameters = BenchParameters::deserialize(deserializer(table));
    match parameters.and_then(|_| toml::Table::deserialize(deserializer(table))) {
        Ok(values) => values,
        Err(error) => {
            let offset = error.span().map_or(section.offset(), |span| span.start);
            let message = error.message().trim().to_owned();
            faults.add(offset, section.path_of("").trim_end_matches('.'), FaultKind::VirtualBench { message });
            toml::Table::new()
        }
    }
}

fn deserializer<'i>(table: &DeTable<'i>) -> Deserializer<'i> {
    Deserializer::from(Spanned::new(0..0, table.clone()))
}

/// Every table and key there is.
fn schema() -> toml::Table {
    toml::Table::try_from(BenchParameters::with_every_option()).unwrap_or_default()
}

/// Notes unknown keys, here and in the tables below.
fn has_unknown_keys(section: &Section<'_, '_>, schema: &toml::Table, faults: &mut Faults<'_>) -> bool {
    let known: Vec<&str> = schema.keys().map(String::as_str).collect();
    let mut found = section.only(&known, faults);
    for (key, below) in schema {
        let Some((place, below)) = section.get(key).zip(below.as_table()) else { continue };
        if let Some(table) = Section::of(place, section.path_of(key)) {
            found |= has_unknown_keys(&table, below, faults);
        }
    }
    found
}
