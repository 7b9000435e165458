//! From the text of a bench file to a checked [`BenchFile`].

use std::collections::BTreeMap;

use toml::de::DeTable;
use units::{self, Quantity, Unit, UnitError};

use super::fault::{BenchFileError, FaultKind};
use super::sections::{Faults, Place, Section};
use super::{stretches, virtual_bench};
use crate::bench_file::stated::{
    BenchFile, DriveHeat, LabelOverride, Limits, PLAUSIBLE_INERTIA_KG_M2, RecordingList, ReportIdentity, RunChannels,
    ShaftPrior,
};
use crate::channels::ChannelMapping;
use crate::facts::BenchVariant;
use crate::role::{Role, parse_unit_of_role};

const BENCH_KEYS: &[&str] = &[
    "name",
    "variant",
    "cylinders",
    "strokes",
    "dynamometer_inertia",
    "dynamometer_inertia_uncertainty_percent",
    "dynamometer_friction",
    "dynamometer_coulomb_friction",
    "dynamometer_friction_uncertainty_percent",
    "engine_inertia",
    "engine_inertia_uncertainty_percent",
];
const DYNAMOMETER_INERTIA_EXAMPLE: &str = "\"0.6 kg m²\"";
const ENGINE_INERTIA_EXAMPLE: &str = "\"0.2 kg m²\"";
const SPEED_LIMIT_EXAMPLE: &str = "\"6000 rpm\"";
const FRICTION_EXAMPLE: &str = "\"0.01 Nm s/rad\"";
const COULOMB_EXAMPLE: &str = "\"1 Nm\"";

/// Reads a bench file and notes every fault in it.
pub(super) fn read(text: &str) -> Result<BenchFile, BenchFileError> {
    with_root(text, read_root)
}

/// Reads what the judgement of a run takes from a bench file, and notes every fault in that alone.
pub(super) fn read_for_a_run(text: &str) -> Result<RunChannels, BenchFileError> {
    with_root(text, |root, faults| {
        let limits = root.section("limits", faults);
        Some(RunChannels {
            channels: read_channels(&root.section("channels", faults), &[], Purpose::Judgement, faults),
            speed_limit_rad_s: read_limit(&limits, "speed", Quantity::AngularSpeed, SPEED_LIMIT_EXAMPLE, faults),
        })
    })
}

/// Returns the result of a reader on a document, or all the faults that it notes.
fn with_root<T>(
    text: &str,
    reader: impl FnOnce(&Section<'_, '_>, &mut Faults<'_>) -> Option<T>,
) -> Result<T, BenchFileError> {
    let mut faults = Faults::new(text);
    let document = match DeTable::parse(text) {
        Ok(document) => document.into_inner(),
        Err(error) => {
            let offset = error.span().map_or(0, |span| span.start);
            faults.add(offset, "", FaultKind::Syntax { message: error.message().to_owned() });
            return Err(faults.into_error());
        }
    };
    match reader(&Section::root(&document), &mut faults) {
        Some(found) if faults.is_empty() => Ok(found),
        _ => Err(faults.into_error()),
    }
}

/// Purpose for which channels are read. A judgement may take one channel for several roles, and asks for no role that
/// is not filled in.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Purpose {
    Estimates,
    Judgement,
}

fn read_root(root: &Section<'_, '_>, faults: &mut Faults<'_>) -> Option<BenchFile> {
    root.only(&["bench", "limits", "shaft", "virtual_bench", "channels", "recordings", "report"], faults);
    let bench = root.section("bench", faults);
    bench.only(BENCH_KEYS, faults);
    let name = read_name(&bench, faults);
    let variant = read_variant(&bench, faults);
    let cylinders = read_cylinders(&bench, faults);
    let strokes = read_strokes(&bench, faults);
    let dynamometer_inertia = read_inertia(&bench, "dynamometer_inertia", DYNAMOMETER_INERTIA_EXAMPLE, faults);
    let engine_inertia = read_inertia(&bench, "engine_inertia", ENGINE_INERTIA_EXAMPLE, faults);
    let dynamometer_uncertainty = read_uncertainty(&bench, "dynamometer_inertia", 100.0, faults);
    let engine_uncertainty = read_uncertainty(&bench, "engine_inertia", 100.0, faults);
    let friction = read_limit(&bench, "dynamometer_friction", Quantity::Damping, FRICTION_EXAMPLE, faults);
    let coulomb = read_limit(&bench, "dynamometer_coulomb_friction", Quantity::Torque, COULOMB_EXAMPLE, faults);
    let friction_uncertainty = read_uncertainty(&bench, "dynamometer_friction", 1000.0, faults);
    if friction_uncertainty.is_some() && coulomb.is_none() {
        bench.require("dynamometer_friction", FRICTION_EXAMPLE, faults);
    }
    let limits = read_limits(&root.section("limits", faults), faults);
    let shaft = read_shaft(&root.section("shaft", faults), faults);
    let virtual_bench = virtual_bench::read(&root.section("virtual_bench", faults), faults);
    let required = variant.map_or(&[][..], |variant| match cylinders {
        Some(0) => &[Role::DynoSpeed],
        _ => required_roles(variant),
    });
    let channels = read_channels(&root.section("channels", faults), required, Purpose::Estimates, faults);
    let recordings = read_recordings(&root.section("recordings", faults), faults);
    let report = read_report(&root.section("report", faults), faults);
    Some(BenchFile {
        name: name?,
        variant: variant?,
        cylinders: cylinders?,
        strokes: strokes?,
        dynamometer_inertia_kg_m2: dynamometer_inertia?,
        dynamometer_inertia_uncertainty_percent: dynamometer_uncertainty,
        dynamometer_friction_nm_s_per_rad: friction,
        dynamometer_coulomb_friction_nm: coulomb,
        dynamometer_friction_uncertainty_percent: friction_uncertainty,
        engine_inertia_kg_m2: engine_inertia?,
        engine_inertia_uncertainty_percent: engine_uncertainty,
        limits,
        shaft,
        virtual_bench,
        channels,
        recordings,
        report,
    })
}

fn read_report(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> ReportIdentity {
    section
        .only(&["title", "test_id", "customer", "engine", "author", "approved_by", "confidentiality", "logo"], faults);
    let mut text = |key: &str, example: &str| {
        let place = section.get(key)?;
        section.line(key, place, example, faults).filter(|text| !text.trim().is_empty())
    };
    ReportIdentity {
        title: text("title", "\"Bench model of cell 4\""),
        test_id: text("test_id", "\"T-2026-017\""),
        customer: text("customer", "\"Engine development\""),
        engine: text("engine", "\"2.0 l, four cylinders\""),
        author: text("author", "\"A. Meyer\""),
        approved_by: text("approved_by", "\"B. Schmidt\""),
        confidentiality: text("confidentiality", "\"confidential\""),
        logo: text("logo", "\"logo.png\""),
    }
}

fn read_name(bench: &Section<'_, '_>, faults: &mut Faults<'_>) -> Option<String> {
    let place = bench.require("name", "\"Cell 4\"", faults)?;
    bench.line("name", place, "\"Cell 4\"", faults)
}

fn read_variant(bench: &Section<'_, '_>, faults: &mut Faults<'_>) -> Option<BenchVariant> {
    let place = bench.require("variant", "\"load-cell\" or \"torque-flange\"", faults)?;
    match bench.text("variant", place, "\"load-cell\"", faults)?.as_str() {
        "load-cell" => Some(BenchVariant::LoadCell),
        "torque-flange" => Some(BenchVariant::TorqueFlange),
        other => {
            let possible = ["\"load-cell\"", "\"torque-flange\""].map(str::to_owned).to_vec();
            faults.add(
                place.offset,
                bench.path_of("variant"),
                FaultKind::NotOneOf { found: other.to_owned(), possible },
            );
            None
        }
    }
}

fn read_cylinders(bench: &Section<'_, '_>, faults: &mut Faults<'_>) -> Option<u32> {
    let place = bench.require("cylinders", "4", faults)?;
    let remedy = "write the engine's number of cylinders; 0 where nothing fires, as in an electric machine";
    let value = bench.number_between("cylinders", (0.0, 12.0), remedy, faults)?;
    if value.fract() == 0.0 {
        return Some(value as u32);
    }
    faults.add(place.offset, bench.path_of("cylinders"), place.wrong_type("a whole number", "cylinders = 4"));
    None
}

fn read_strokes(bench: &Section<'_, '_>, faults: &mut Faults<'_>) -> Option<u32> {
    let Some(place) = bench.get("strokes") else { return Some(4) };
    let strokes = [2, 4].into_iter().find(|&strokes| place.number() == Some(f64::from(strokes)));
    if strokes.is_none() {
        let found = place.number().map_or_else(|| place.value.type_str().to_owned(), |number| number.to_string());
        let possible = vec!["4".to_owned(), "2".to_owned()];
        faults.add(place.offset, bench.path_of("strokes"), FaultKind::NotOneOf { found, possible });
    }
    strokes
}

/// Standard uncertainty of a value, % of it.
fn read_uncertainty(bench: &Section<'_, '_>, of: &str, most: f64, faults: &mut Faults<'_>) -> Option<f64> {
    let remedy = format!("write the standard uncertainty of {of} in % of it");
    bench.number_between(&format!("{of}_uncertainty_percent"), (0.0, most), &remedy, faults)
}

/// A number with a unit as text, or a bare number in SI.
fn read_value(
    section: &Section<'_, '_>,
    key: &str,
    place: Place<'_, '_>,
    quantity: Quantity,
    example: &str,
    faults: &mut Faults<'_>,
) -> Option<f64> {
    if let Some(number) = place.number() {
        return Some(number);
    }
    let Some(text) = place.value.as_str().filter(|_| !place.is_placeholder()) else {
        faults.add(place.offset, section.path_of(key), place.wrong_type("a number with its unit", example));
        return None;
    };
    match units::parse_value(text, quantity) {
        Ok(value) => Some(value),
        Err(error) => {
            let example = with_closest_unit(text, &error).unwrap_or_else(|| example.to_owned());
            faults.add(place.offset, section.path_of(key), FaultKind::Unit { error, example });
            None
        }
    }
}

/// The number as it was written, with the closest unit that exists: `"1.03 kg"` means `"1.03 kg m²"`.
fn with_closest_unit(text: &str, error: &UnitError) -> Option<String> {
    let UnitError::Unknown { text: unit, closest } = error else { return None };
    let number = text.trim().strip_suffix(unit.as_str())?.trim();
    closest.first().map(|closest| format!("\"{number} {closest}\""))
}

fn read_inertia(bench: &Section<'_, '_>, key: &str, example: &str, faults: &mut Faults<'_>) -> Option<f64> {
    let place = bench.require(key, example, faults)?;
    let value = read_value(bench, key, place, Quantity::Inertia, example, faults)?;
    if PLAUSIBLE_INERTIA_KG_M2.contains(&value) {
        return Some(value);
    }
    let looks_like = crate::bench_file::stated::plausible_inertia_units(value);
    let plausible = PLAUSIBLE_INERTIA_KG_M2.into_inner();
    let kind = FaultKind::ImplausibleInertia { value_kg_m2: value, plausible, looks_like };
    faults.add(place.offset, bench.path_of(key), kind);
    None
}

fn read_limits(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> Limits {
    let keys = [
        "torque",
        "shaft_torque",
        "speed",
        "torque_slew",
        "shaft_torque_slew",
        "time_at_resonance",
        "power",
        "speed_gradient",
        "continuous_torque",
        "thermal_time_constant",
        "overload_torque",
        "overload_time",
    ];
    section.only(&keys, faults);
    let slew = "\"5000 Nm/s\"";
    Limits {
        torque_nm: read_limit(section, "torque", Quantity::Torque, "\"400 Nm\"", faults),
        shaft_torque_nm: read_limit(section, "shaft_torque", Quantity::Torque, "\"500 Nm\"", faults),
        speed_rad_s: read_limit(section, "speed", Quantity::AngularSpeed, SPEED_LIMIT_EXAMPLE, faults),
        torque_slew_nm_per_s: read_limit(section, "torque_slew", Quantity::TorqueRate, slew, faults),
        shaft_torque_slew_nm_per_s: read_limit(section, "shaft_torque_slew", Quantity::TorqueRate, slew, faults),
        time_at_resonance_s: read_limit(section, "time_at_resonance", Quantity::Time, "\"5 s\"", faults),
        power_w: read_limit(section, "power", Quantity::Power, "\"200 kW\"", faults),
        speed_gradient_rad_s2: read_limit(
            section,
            "speed_gradient",
            Quantity::AngularAcceleration,
            "\"5000 rpm/s\"",
            faults,
        ),
        drive_heat: read_drive_heat(section, faults),
    }
}

/// The continuous torque of the drive, with its time constant or with an overload.
fn read_drive_heat(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> Option<DriveHeat> {
    let keys = ["continuous_torque", "thermal_time_constant", "overload_torque", "overload_time"];
    if keys.iter().all(|key| section.get(key).is_none()) {
        return None;
    }
    let torque = "\"250 Nm\"";
    section.require("continuous_torque", torque, faults);
    let continuous_torque_nm = read_limit(section, "continuous_torque", Quantity::Torque, torque, faults);
    let time_constant_s = read_limit(section, "thermal_time_constant", Quantity::Time, "\"90 s\"", faults);
    if section.get("thermal_time_constant").is_some() {
        if let Some((key, place)) = keys[2..].iter().find_map(|key| Some((key, section.get(key)?))) {
            faults.add(place.offset, section.path_of(key), FaultKind::Excludes { other: "thermal_time_constant" });
        }
        return Some(DriveHeat { continuous_torque_nm: continuous_torque_nm?, time_constant_s: time_constant_s? });
    }
    read_overload(section, continuous_torque_nm, faults)
}

fn read_overload(section: &Section<'_, '_>, continuous_nm: Option<f64>, faults: &mut Faults<'_>) -> Option<DriveHeat> {
    let place = section.require("overload_torque", "\"400 Nm\"", faults);
    section.require("overload_time", "\"60 s\"", faults);
    let torque_nm = read_limit(section, "overload_torque", Quantity::Torque, "\"400 Nm\"", faults);
    let time_s = read_limit(section, "overload_time", Quantity::Time, "\"60 s\"", faults);
    let (continuous_nm, value) = (continuous_nm?, torque_nm?);
    if value <= continuous_nm {
        let remedy = "write a torque above continuous_torque".to_owned();
        let kind = FaultKind::OutOfRange { value, low: continuous_nm, high: f64::INFINITY, remedy };
        faults.add(place?.offset, section.path_of("overload_torque"), kind);
    }
    DriveHeat::of_overload(continuous_nm, value, time_s?)
}

fn read_shaft(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> ShaftPrior {
    section.only(&["stiffness", "damping", "resonance"], faults);
    if let (Some(place), Some(_)) = (section.get("resonance"), section.get("stiffness")) {
        faults.add(place.offset, section.path_of("resonance"), FaultKind::Excludes { other: "stiffness" });
    }
    ShaftPrior {
        stiffness_nm_per_rad: read_limit(section, "stiffness", Quantity::Stiffness, "\"2400 Nm/rad\"", faults),
        resonance_hz: read_resonance(section, faults),
        damping_nm_s_per_rad: read_limit(section, "damping", Quantity::Damping, "\"6 Nm s/rad\"", faults),
    }
}

fn read_resonance(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> Option<f64> {
    const EXAMPLE: &str = "\"18 Hz\"";
    let place = section.get("resonance")?;
    let text = section.text("resonance", place, EXAMPLE, faults)?;
    let kind = match units::parse_frequency_hz(&text) {
        Ok(value) if (0.1..=1000.0).contains(&value) => return Some(value),
        Ok(value) => FaultKind::OutOfRange {
            value,
            low: 0.1,
            high: 1000.0,
            remedy: "write the shaft's resonance in Hz, such as \"18 Hz\"".to_owned(),
        },
        Err(error) => FaultKind::Unit { error, example: EXAMPLE.to_owned() },
    };
    faults.add(place.offset, section.path_of("resonance"), kind);
    None
}

fn read_limit(
    section: &Section<'_, '_>,
    key: &str,
    quantity: Quantity,
    example: &str,
    faults: &mut Faults<'_>,
) -> Option<f64> {
    let place = section.get(key)?;
    if place.number().is_some() {
        faults.add(place.offset, section.path_of(key), place.wrong_type("a text with a unit", example));
        return None;
    }
    let value = read_value(section, key, place, quantity, example, faults)?;
    if value > 0.0 {
        return Some(value);
    }
    let remedy = format!("write a value above 0, such as {example}");
    let kind = FaultKind::OutOfRange { value, low: 0.0, high: f64::INFINITY, remedy };
    faults.add(place.offset, section.path_of(key), kind);
    None
}

fn read_channels(
    section: &Section<'_, '_>,
    required: &[Role],
    purpose: Purpose,
    faults: &mut Faults<'_>,
) -> BTreeMap<Role, ChannelMapping> {
    section.only(&Role::ALL.map(Role::key), faults);
    let mut channels: BTreeMap<Role, ChannelMapping> = BTreeMap::new();
    for role in Role::ALL {
        let Some(place) = section.get(role.key()) else { continue };
        if purpose == Purpose::Judgement && place.is_placeholder() {
            continue;
        }
        let Some(mapping) = read_mapping(section, role, place, faults) else { continue };
        match channels.iter().find(|(_, known)| known.name == mapping.name) {
            Some((other, _)) if purpose == Purpose::Estimates => {
                let kind = FaultKind::ChannelUsedTwice { channel: mapping.name, other: other.key().to_owned() };
                faults.add(place.offset, section.path_of(role.key()), kind);
            }
            _ => {
                channels.insert(role, mapping);
            }
        }
    }
    // A bench that is only simulated needs no channels.
    for role in required.iter().filter(|_| section.table().is_some()) {
        if section.get(role.key()).is_none() {
            section.missing(role.key(), "\"NameInTheRecording\"", faults);
        }
    }
    channels
}

/// The roles without which nothing of a bench with an engine can be identified.
pub(super) fn required_roles(variant: BenchVariant) -> &'static [Role] {
    match variant {
        BenchVariant::LoadCell => &[Role::DynoSpeed, Role::EngineSpeed, Role::AirGapTorque],
        BenchVariant::TorqueFlange => &[Role::DynoSpeed, Role::EngineSpeed, Role::AirGapTorque, Role::FlangeTorque],
    }
}

fn read_mapping(
    channels: &Section<'_, '_>,
    role: Role,
    place: Place<'_, '_>,
    faults: &mut Faults<'_>,
) -> Option<ChannelMapping> {
    let path = channels.path_of(role.key());
    if place.is_placeholder() {
        faults.add(place.offset, path, FaultKind::Placeholder { example: "\"NameInTheRecording\"".to_owned() });
        return None;
    }
    if let Some(name) = place.value.as_str() {
        return Some(ChannelMapping::named(name));
    }
    let Some(section) = Section::of(place, path.clone()) else {
        let example = "\"NameInTheRecording\" or { name = \"NameInTheRecording\", unit = \"rpm\" }";
        faults.add(place.offset, path, place.wrong_type("a text or a table", example));
        return None;
    };
    section.only(&["name", "unit", "sign", "factor", "gate_ms"], faults);
    let name_place = section.require("name", "\"NameInTheRecording\"", faults)?;
    let name = section.text("name", name_place, "\"NameInTheRecording\"", faults)?;
    let remedy = "write the length of the encoder's gate in ms";
    Some(ChannelMapping {
        name,
        unit: read_unit(&section, role, faults),
        inverted: read_inverted(&section, faults),
        factor: read_factor(&section, faults),
        gate_s: section.number_between("gate_ms", (0.0, 1000.0), remedy, faults).map(|gate_ms| gate_ms * 1e-3),
    })
}

fn read_factor(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> f64 {
    let remedy = "write by what its samples are to be multiplied; for the opposite sign, sign = -1";
    section.number_between("factor", (1e-12, 1e12), remedy, faults).unwrap_or(1.0)
}

fn read_unit(section: &Section<'_, '_>, role: Role, faults: &mut Faults<'_>) -> Option<Unit> {
    let place = section.get("unit")?;
    let quantity = role.quantity();
    let example = format!("\"{}\"", units::spellings(quantity).nth(1).unwrap_or(units::si_spelling(quantity)));
    let text = section.text("unit", place, &example, faults)?;
    let unit = parse_unit_of_role(&text, role);
    unit.map_err(|error| faults.add(place.offset, section.path_of("unit"), FaultKind::Unit { error, example })).ok()
}

fn read_inverted(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> bool {
    let Some(place) = section.get("sign") else { return false };
    match place.number() {
        Some(1.0) => return false,
        Some(-1.0) => return true,
        _ => {}
    }
    let found = place.number().map_or_else(|| place.value.type_str().to_owned(), |number| number.to_string());
    let possible = vec!["1".to_owned(), "-1".to_owned()];
    faults.add(place.offset, section.path_of("sign"), FaultKind::NotOneOf { found, possible });
    false
}

fn read_recordings(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> RecordingList {
    section.only(&["files", "label", "stretch"], faults);
    RecordingList {
        files: read_files(section, faults),
        labels: read_labels(section, faults),
        stretches: stretches::read(section, faults),
    }
}

fn read_files(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> Vec<String> {
    const EXAMPLE: &str = "files = [\"*.mf4\"]";
    let Some(place) = section.get("files") else { return Vec::new() };
    let Some(elements) = place.elements() else {
        faults.add(place.offset, section.path_of("files"), place.wrong_type("an array of texts", EXAMPLE));
        return Vec::new();
    };
    elements.into_iter().filter_map(|element| section.text("files", element, EXAMPLE, faults)).collect()
}

fn read_labels(section: &Section<'_, '_>, faults: &mut Faults<'_>) -> Vec<LabelOverride> {
    const EXAMPLE: &str = "[[recordings.label]]";
    let Some(place) = section.get("label") else { return Vec::new() };
    let Some(elements) = place.elements() else {
        faults.add(place.offset, section.path_of("label"), place.wrong_type("an array of tables", EXAMPLE));
        return Vec::new();
    };
    elements.into_iter().filter_map(|element| read_label(section, element, faults)).collect()
}

fn read_label(recordings: &Section<'_, '_>, place: Place<'_, '_>, faults: &mut Faults<'_>) -> Option<LabelOverride> {
    let path = recordings.path_of("label");
    let Some(section) = Section::of(place, path.clone()) else {
        faults.add(place.offset, path, place.wrong_type("a table", "[[recordings.label]]"));
        return None;
    };
    section.only(&["file", "label"], faults);
    let file_place = section.require("file", "\"run_17.mf4\"", faults)?;
    let file = section.text("file", file_place, "\"run_17.mf4\"", faults)?;
    let label_place = section.require("label", "\"BS_T_NT\"", faults)?;
    let text = section.text("label", label_place, "\"BS_T_NT\"", faults)?;
    match text.parse() {
        Ok(label) => Some(LabelOverride { file, label }),
        Err(_) => {
            faults.add(label_place.offset, section.path_of("label"), FaultKind::NotALabel { text });
            None
        }
    }
}
