//! The rule of rooms: which of our crates each crate may use. The tables of ARCHITECTURE.md say it; `cargo metadata`
//! has the crates.

use std::path::Path;

use serde_json::Value;

/// Crates that write files, print, or serve, and who alone may use them.
const RESERVED: &[(&str, &[&str])] = &[
    ("clap", &["cli"]),
    ("indicatif", &["cli"]),
    ("tempfile", &["dynoid"]),
    ("hdf5-pure", &["recording"]),
    ("parquet", &["recording"]),
    ("rayon", &["mdf", "numerics", "work"]),
    ("resvg", &["page"]),
];

/// Crates outside the house, which no room may use.
const OUTSIDE: &[&str] = &["xtask"];

/// Longest README of a floor, in lines.
const FLOOR_README_LINES: usize = 20;

/// The house as the tables describe it, floor by floor from the lowest.
pub(super) struct House {
    floors: Vec<Floor>,
}

struct Floor {
    name: String,
    rooms: Vec<Room>,
}

struct Room {
    name: String,
    may_use: MayUse,
}

enum MayUse {
    All,
    These(Vec<String>),
}

impl House {
    /// Reads the section "Rooms": a heading `### floor: …` for each floor, and below it a table whose first column has
    /// the rooms and whose third column has what they may use.
    pub(super) fn read(architecture: &str) -> Result<Self, String> {
        let rooms = architecture.split("\n## ").find(|section| section.starts_with("Rooms\n"));
        let mut floors = Vec::new();
        for section in rooms.ok_or("ARCHITECTURE.md has no section Rooms")?.split("\n### ").skip(1) {
            let (name, rows) = section.split_once(':').ok_or("ARCHITECTURE.md: a floor's heading has no colon")?;
            let rows = rows.lines().filter(|line| line.starts_with("| ")).skip(2);
            floors.push(Floor { name: name.to_owned(), rooms: rows.map(Room::read).collect::<Result<_, _>>()? });
        }
        Ok(Self { floors })
    }

    fn room(&self, name: &str) -> Option<(usize, &Room)> {
        let floors = self.floors.iter().enumerate();
        floors.flat_map(|(floor, f)| f.rooms.iter().map(move |room| (floor, room))).find(|(_, room)| room.name == name)
    }

    /// Faults of the packages: what breaks a table.
    pub(super) fn faults(&self, metadata: &Value) -> Result<Vec<String>, String> {
        let packages = metadata["packages"].as_array().ok_or("cargo metadata lists no packages")?;
        let mut faults: Vec<String> = packages.iter().flat_map(|package| self.faults_of(package)).collect();
        let present: Vec<&str> = packages.iter().map(name_of).collect();
        for room in self.floors.iter().flat_map(|floor| &floor.rooms).filter(|r| !present.contains(&r.name.as_str())) {
            faults.push(format!("ARCHITECTURE.md has a room `{}`, which no crate has", room.name));
        }
        Ok(faults)
    }

    fn faults_of(&self, package: &Value) -> Vec<String> {
        let name = name_of(package);
        if OUTSIDE.contains(&name) {
            return Vec::new();
        }
        let Some((floor, room)) = self.room(name) else {
            return vec![format!("crate `{name}` has no row in the tables of ARCHITECTURE.md")];
        };
        let mut faults = Vec::new();
        let folder = format!("crates/{}/{name}", self.floors[floor].name);
        let manifest = Path::new(package["manifest_path"].as_str().unwrap_or_default());
        if !manifest.parent().is_some_and(|parent| parent.ends_with(&folder)) {
            faults.push(format!("`{name}` belongs into the folder {folder}"));
        }
        for used in dependencies(package) {
            match self.room(used) {
                Some((above, _)) if above > floor => faults.push(format!("`{name}` uses `{used}` of a higher floor")),
                Some(_) if !room.may_use.contains(used) => faults.push(format!("`{name}` may not use `{used}`")),
                _ => {}
            }
            if RESERVED.iter().any(|(library, owners)| *library == used && !owners.contains(&name)) {
                faults.push(format!("`{name}` may not use the library `{used}`"));
            }
        }
        faults
    }

    /// Floors without a README, or with one that nobody reads to its end.
    pub(super) fn floors_without_a_sign(&self, root: &Path) -> Vec<String> {
        let sign = |floor: &Floor| {
            let file = format!("crates/{}/README.md", floor.name);
            match std::fs::read_to_string(root.join(&file)) {
                Ok(text) if text.lines().count() > FLOOR_README_LINES => {
                    Some(format!("{file} has more than {FLOOR_README_LINES} lines"))
                }
                Ok(_) => None,
                Err(error) => Some(format!("{file}: {error}")),
            }
        };
        self.floors.iter().filter_map(sign).collect()
    }
}

impl Room {
    /// A row: name, what it is, what it may use, what it may not know.
    fn read(row: &str) -> Result<Self, String> {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let [name, _, may_use, _] = cells[..] else {
            return Err(format!("ARCHITECTURE.md: four cells are needed in the row `{row}`"));
        };
        let may_use = match may_use {
            "all" => MayUse::All,
            "–" => MayUse::These(Vec::new()),
            // A remark in parentheses says what for.
            some => MayUse::These(some.split(',').map(|used| without_remark(used).to_owned()).collect()),
        };
        Ok(Self { name: name.to_owned(), may_use })
    }
}

impl MayUse {
    fn contains(&self, name: &str) -> bool {
        match self {
            Self::All => true,
            Self::These(names) => names.iter().any(|one| one == name),
        }
    }
}

fn without_remark(cell: &str) -> &str {
    cell.split('(').next().unwrap_or_default().trim()
}

/// Dependencies of the product; those of tests are free.
fn dependencies(package: &Value) -> Vec<&str> {
    let all = package["dependencies"].as_array().map(Vec::as_slice).unwrap_or_default();
    let is_dev = |d: &Value| d["kind"].as_str() == Some("dev");
    all.iter().filter(|d| !is_dev(d)).filter_map(|d| d["name"].as_str().map(room_of)).collect()
}

fn name_of(package: &Value) -> &str {
    room_of(package["name"].as_str().unwrap_or_default())
}

/// The room of a package: published ones carry the project's name before their own.
fn room_of(package: &str) -> &str {
    package.strip_prefix("dynoid-").unwrap_or(package)
}
