//! The keys of a bench file in words, for forms.

/// A key of a bench file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
pub struct Key {
    /// Its table, such as `bench`.
    pub table: &'static str,
    /// Its name.
    pub name: &'static str,
    /// Its meaning.
    pub what: &'static str,
    /// A value as it is written in TOML; of a text with its quotes.
    pub example: &'static str,
    /// True where a study needs it.
    pub is_required: bool,
}

const fn needed(table: &'static str, name: &'static str, what: &'static str, example: &'static str) -> Key {
    Key { table, name, what, example, is_required: true }
}

const fn key(table: &'static str, name: &'static str, what: &'static str, example: &'static str) -> Key {
    Key { table, name, what, example, is_required: false }
}

/// The keys that have one value each. Channels, recordings and the virtual bench have keys of other kinds.
pub const KEYS: [Key; 34] = [
    needed("bench", "name", "Name of the bench", "\"Cell 4\""),
    needed("bench", "variant", "How torque is measured: load-cell or torque-flange", "\"load-cell\""),
    needed("bench", "cylinders", "Cylinders of the engine; 0 where nothing fires", "4"),
    key("bench", "strokes", "Strokes of the engine: 2 or 4", "4"),
    needed("bench", "dynamometer_inertia", "Inertia of the dynamometer, J_d", "\"0.6 kg m²\""),
    key("bench", "dynamometer_inertia_uncertainty_percent", "Standard uncertainty of J_d, %", "1"),
    key("bench", "dynamometer_friction", "Slope of the bearings' friction over speed", "\"0.01 Nm s/rad\""),
    key("bench", "dynamometer_coulomb_friction", "Friction of the bearings at any speed", "\"1 Nm\""),
    key("bench", "dynamometer_friction_uncertainty_percent", "Standard uncertainty of both frictions, %", "20"),
    needed("bench", "engine_inertia", "Inertia of the engine with its flywheel, J_e", "\"0.2 kg m²\""),
    key("bench", "engine_inertia_uncertainty_percent", "Standard uncertainty of J_e, %", "5"),
    key("limits", "torque", "Largest torque of the drive", "\"400 Nm\""),
    key("limits", "shaft_torque", "Largest torque of the shaft", "\"500 Nm\""),
    key("limits", "speed", "Largest speed", "\"6000 rpm\""),
    key("limits", "torque_slew", "Largest change of the torque demand", "\"5000 Nm/s\""),
    key("limits", "shaft_torque_slew", "Largest change of the shaft torque", "\"5000 Nm/s\""),
    key("limits", "time_at_resonance", "Longest time that firing may stay near the resonance", "\"5 s\""),
    key("limits", "power", "Largest power of the dynamometer", "\"200 kW\""),
    key("limits", "speed_gradient", "Largest change of the speed", "\"5000 rpm/s\""),
    key("limits", "continuous_torque", "Torque that the drive gives for any time", "\"250 Nm\""),
    key("limits", "thermal_time_constant", "Time constant of the drive's heat, in place of an overload", "\"90 s\""),
    key("limits", "overload_torque", "Torque of an overload that the drive gives, cold, ...", "\"400 Nm\""),
    key("limits", "overload_time", "... for this time", "\"60 s\""),
    key("shaft", "stiffness", "Stiffness of the shaft, for predictions alone", "\"2400 Nm/rad\""),
    key("shaft", "damping", "Damping of the shaft, for predictions alone", "\"6 Nm s/rad\""),
    key("shaft", "resonance", "Resonance in torque control, in place of the stiffness", "\"18 Hz\""),
    key("report", "title", "Title of the report", "\"Bench model of cell 4\""),
    key("report", "test_id", "Number of the test or of the order", "\"T-2026-017\""),
    key("report", "customer", "For whom it is", "\"Engine development\""),
    key("report", "engine", "Engine on the bench", "\"2.0 l, four cylinders\""),
    key("report", "author", "Who made it", "\"A. Meyer\""),
    key("report", "approved_by", "Who approved it", "\"B. Schmidt\""),
    key("report", "confidentiality", "Who may read it", "\"confidential\""),
    key("report", "logo", "File of a logo, seen from the bench file", "\"logo.png\""),
];

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::bench_file::{BenchFile, FaultKind};

    const CHANNELS: &str = "[channels]\ndyno_speed = \"N\"\n";

    /// The keys that exclude one another are taken one at a time.
    const APART: [&str; 3] = ["thermal_time_constant", "resonance", "dynamometer_friction_uncertainty_percent"];

    fn text(keys: &[&Key]) -> String {
        let of = |table: &str| {
            let own = keys.iter().filter(|key| key.table == table);
            let lines: String = own.map(|key| format!("{} = {}\n", key.name, key.example)).collect();
            format!("[{table}]\n{lines}")
        };
        ["bench", "limits", "shaft", "report"].map(of).concat() + CHANNELS
    }

    #[test]
    fn exact_examples_are_values_of_their_keys() {
        let most: Vec<&Key> = KEYS.iter().filter(|key| !APART.contains(&key.name)).collect();
        let faults = text(&most).parse::<BenchFile>().unwrap_err().faults;
        // Roles of a load cell are missing, and nothing else.
        assert!(faults.iter().all(|fault| fault.key.starts_with("channels")), "{faults:?}");
    }

    #[test]
    fn exact_every_key_is_here() {
        for table in ["bench", "limits", "shaft", "report"] {
            let faults = format!("[{table}]\nnot_there = 1\n").parse::<BenchFile>().unwrap_err().faults;
            let known = faults.iter().find_map(|fault| match &fault.kind {
                FaultKind::UnknownKey { known, .. } => Some(known.clone()),
                _ => None,
            });
            let mut known = known.unwrap();
            let mut own: Vec<&str> = KEYS.iter().filter(|key| key.table == table).map(|key| key.name).collect();
            known.sort_unstable();
            own.sort_unstable();
            assert_eq!(known, own, "{table}");
        }
    }
}
