//! Writing bench files: a proposal to be filled in, and one that reads back as it was.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::stated::PLACEHOLDER;
use crate::bench_file::stated::{BenchFile, Limits, ReportIdentity, ShaftPrior};
use crate::channels::ChannelMapping;
use crate::channels::{Ambiguity, Guess};
use crate::facts::BenchVariant;
use crate::role::Role;

/// Material of a commented bench file.
#[derive(Debug, Clone, Copy)]
pub struct Draft<'a> {
    /// The bench's name.
    pub name: &'a str,
    /// The proposed channels.
    pub guess: &'a Guess,
    /// The recordings' names or patterns.
    pub files: &'a [String],
    /// Recordings whose names hold no label.
    pub unlabelled: &'a [String],
}

/// Statements of a report on itself, to be filled in by whoever wants them.
const REPORT_HINT: &str = r#"
# What the report says of itself. Leave out what you do not need.
# [report]
# title = "Bench model of cell 4"
# test_id = "T-2026-017"
# customer = "Engine development"
# engine = "2.0 l, four cylinders"
# author = "A. Meyer"
# approved_by = "B. Schmidt"
# confidentiality = "confidential"
# logo = "logo.png"
"#;

impl BenchFile {
    /// A commented bench file with the channels proposed by a guess, each with its reasons. What a recording cannot
    /// show (inertias, cylinders) is left as [`PLACEHOLDER`], which is refused until a person has filled it in.
    pub fn to_commented_toml(draft: &Draft<'_>) -> String {
        let variant = variant_key(draft.guess.variant());
        let mut text = String::new();
        let _ = write!(
            text,
            r#"# Bench file of dynoid. Fill in what says "{PLACEHOLDER}", and check what was guessed.

[bench]
name = {name}
# "load-cell": T_d is measured by a load cell; "torque-flange": the shaft torque is measured by a flange.
variant = "{variant}"
cylinders = "{PLACEHOLDER}" # a number, e.g. 4
strokes = 4
# Inertia of the dynamometer's rotor with everything on its side of the shaft, e.g. "0.6 kg m²".
dynamometer_inertia = "{PLACEHOLDER}"
# How well it is known: standard uncertainty in % of it, 0 for an exact value. Without it dynoid takes 1 %.
# dynamometer_inertia_uncertainty_percent = 2
# Slope of its bearing friction over speed (c_1 of `dynoid friction`), if it is known.
# dynamometer_friction = "0.01 Nm s/rad"
# The part of its friction that does not depend on the speed (c_0 of `dynoid friction`), if it is known.
# dynamometer_coulomb_friction = "1 Nm"
# Inertia of the engine, flywheel included, e.g. "0.2 kg m²".
engine_inertia = "{PLACEHOLDER}"
# Without it dynoid takes 2 %.
# engine_inertia_uncertainty_percent = 5

# What the bench must not exceed. Leave out what you do not know.
[limits]
# torque = "400 Nm"       # limit of the drive; samples at the limit are left out
# shaft_torque = "500 Nm"
# speed = "6000 rpm"
# torque_slew = "5000 Nm/s"        # of the torque demand
# shaft_torque_slew = "5000 Nm/s"
# time_at_resonance = "5 s"        # longest stay of the firing near the shaft's resonance
# power = "200 kW"                 # of the dynamometer
# speed_gradient = "5000 rpm/s"
# continuous_torque = "250 Nm"     # of the drive, I²t; with its time constant, or with an overload from cold
# thermal_time_constant = "90 s"
# overload_torque = "400 Nm"
# overload_time = "60 s"

# What is known of the shaft, for experiments that are predicted or simulated before a model is estimated: its resonance,
# or its stiffness.
# [shaft]
# resonance = "18 Hz"
# stiffness = "2400 Nm/rad"
# damping = "6 Nm s/rad"

# role = "channel name", or {{ name = "channel name", unit = "rpm", sign = -1, gate_ms = 1.0 }}.
# Torques of the dynamometer are positive when they brake; if yours are negative then, write sign = -1.
[channels]
"#,
            name = quoted(draft.name),
        );
        for role in Role::ALL {
            write_role(&mut text, draft.guess, role);
        }
        write_recordings(&mut text, draft);
        text.push_str(REPORT_HINT);
        text
    }

    /// The bench file as TOML without comments; reading it gives the same bench file.
    pub fn to_toml(&self) -> String {
        let mut text = format!(
            "[bench]\nname = {}\nvariant = \"{}\"\ncylinders = {}\nstrokes = {}\n",
            quoted(&self.name),
            variant_key(self.variant),
            self.cylinders,
            self.strokes
        );
        let _ = writeln!(text, "dynamometer_inertia = \"{} kg m²\"", self.dynamometer_inertia_kg_m2);
        if let Some(percent) = self.dynamometer_inertia_uncertainty_percent {
            let _ = writeln!(text, "dynamometer_inertia_uncertainty_percent = {percent}");
        }
        let friction = [
            ("dynamometer_friction", self.dynamometer_friction_nm_s_per_rad, "Nm s/rad"),
            ("dynamometer_coulomb_friction", self.dynamometer_coulomb_friction_nm, "Nm"),
        ];
        write_values(&mut text, &friction);
        if let Some(percent) = self.dynamometer_friction_uncertainty_percent {
            let _ = writeln!(text, "dynamometer_friction_uncertainty_percent = {percent}");
        }
        let _ = writeln!(text, "engine_inertia = \"{} kg m²\"", self.engine_inertia_kg_m2);
        if let Some(percent) = self.engine_inertia_uncertainty_percent {
            let _ = writeln!(text, "engine_inertia_uncertainty_percent = {percent}");
        }
        write_limits(&mut text, self.limits);
        write_shaft(&mut text, self.shaft);
        write_channels(&mut text, &self.channels);
        let _ = writeln!(text, "\n[recordings]\nfiles = [{}]", quoted_list(&self.recordings.files));
        for stated in &self.recordings.labels {
            let label = quoted(&stated.label.to_string());
            let _ = writeln!(text, "\n[[recordings.label]]\nfile = {}\nlabel = {label}", quoted(&stated.file));
        }
        for stretch in &self.recordings.stretches {
            let (file, key) = (quoted(&stretch.file), stretch.usage.key());
            let (from_s, to_s) = (stretch.from_s, stretch.to_s);
            let _ = writeln!(text, "\n[[recordings.stretch]]\nfile = {file}\n{key} = [{from_s:?}, {to_s:?}]");
        }
        write_report(&mut text, &self.report);
        write_virtual_bench(&mut text, &self.virtual_bench);
        text
    }
}

fn write_limits(text: &mut String, limits: Limits) {
    text.push_str("\n[limits]\n");
    let values = [
        ("torque", limits.torque_nm, "Nm"),
        ("shaft_torque", limits.shaft_torque_nm, "Nm"),
        ("speed", limits.speed_rad_s, "rad/s"),
        ("torque_slew", limits.torque_slew_nm_per_s, "Nm/s"),
        ("shaft_torque_slew", limits.shaft_torque_slew_nm_per_s, "Nm/s"),
        ("time_at_resonance", limits.time_at_resonance_s, "s"),
        ("power", limits.power_w, "W"),
        ("speed_gradient", limits.speed_gradient_rad_s2, "rad/s²"),
        ("continuous_torque", limits.drive_heat.map(|heat| heat.continuous_torque_nm), "Nm"),
        ("thermal_time_constant", limits.drive_heat.map(|heat| heat.time_constant_s), "s"),
    ];
    write_values(text, &values);
}

fn write_shaft(text: &mut String, shaft: ShaftPrior) {
    if shaft == ShaftPrior::default() {
        return;
    }
    text.push_str("\n[shaft]\n");
    let values = [
        ("stiffness", shaft.stiffness_nm_per_rad, "Nm/rad"),
        ("resonance", shaft.resonance_hz, "Hz"),
        ("damping", shaft.damping_nm_s_per_rad, "Nm s/rad"),
    ];
    write_values(text, &values);
}

fn write_report(text: &mut String, report: &ReportIdentity) {
    if *report == ReportIdentity::default() {
        return;
    }
    text.push_str("\n[report]\n");
    let values = [
        ("title", &report.title),
        ("test_id", &report.test_id),
        ("customer", &report.customer),
        ("engine", &report.engine),
        ("author", &report.author),
        ("approved_by", &report.approved_by),
        ("confidentiality", &report.confidentiality),
        ("logo", &report.logo),
    ];
    for (key, value) in values.into_iter().filter_map(|(key, value)| Some((key, value.as_ref()?))) {
        let _ = writeln!(text, "{key} = {}", quoted(value));
    }
}

fn write_values(text: &mut String, values: &[(&str, Option<f64>, &str)]) {
    for (key, value, unit) in values {
        if let Some(value) = value {
            let _ = writeln!(text, "{key} = \"{value} {unit}\"");
        }
    }
}

fn write_virtual_bench(text: &mut String, table: &toml::Table) {
    if table.is_empty() {
        return;
    }
    let whole = toml::Table::from_iter([("virtual_bench".to_owned(), toml::Value::Table(table.clone()))]);
    let _ = write!(text, "\n{whole}");
}

fn write_channels(text: &mut String, channels: &BTreeMap<Role, ChannelMapping>) {
    text.push_str("\n[channels]\n");
    for (role, mapping) in channels {
        let _ = writeln!(text, "{} = {}", role.key(), mapping_value(mapping));
    }
}

/// A mapping as the value of its key: the name alone where nothing else is stated.
fn mapping_value(mapping: &ChannelMapping) -> String {
    let mut parts = vec![format!("name = {}", quoted(&mapping.name))];
    parts.extend(mapping.unit.map(|unit| format!("unit = \"{}\"", unit.spelling)));
    parts.extend(mapping.inverted.then(|| "sign = -1".to_owned()));
    parts.extend((mapping.factor != 1.0).then(|| format!("factor = {}", mapping.factor)));
    parts.extend(mapping.gate_s.map(|gate_s| format!("gate_ms = {}", gate_s * 1e3)));
    if parts.len() == 1 { quoted(&mapping.name) } else { format!("{{ {} }}", parts.join(", ")) }
}

fn write_role(text: &mut String, guess: &Guess, role: Role) {
    let (key, symbol) = (role.key(), role.symbol());
    let Some(choice) = guess.choices.get(&role) else {
        let _ = writeln!(text, "# {symbol}: no channel was found.");
        let needed = super::read::required_roles(guess.variant()).contains(&role);
        let _ = match needed {
            true => writeln!(text, "{key} = \"{PLACEHOLDER}\""),
            false => writeln!(text, "# {key} = \"\""),
        };
        return;
    };
    let reasons: Vec<String> = choice.reasons.iter().map(|reason| on_one_line(&reason.to_string())).collect();
    let _ = writeln!(
        text,
        "# {symbol}, guessed with {:.0} % confidence: {}.",
        100.0 * choice.confidence.min(0.99),
        reasons.join("; ")
    );
    if let Some(Ambiguity { channels, .. }) = guess.ambiguous.iter().find(|ambiguity| ambiguity.role == role) {
        let _ = writeln!(
            text,
            "# PLEASE CHECK: these would fit about as well: {}.",
            on_one_line(&channels[1..].join(", "))
        );
    }
    let mapping = ChannelMapping { unit: choice.unit, ..ChannelMapping::named(&choice.channel) };
    let _ = writeln!(text, "{key} = {}", mapping_value(&mapping));
}

fn write_recordings(text: &mut String, draft: &Draft<'_>) {
    let _ = write!(
        text,
        r#"
# Files or patterns, relative to this file. A recording's name holds its label, {{test}}_{{T|N}}_{{NT|TN}}, such as BS_T_NT:
# the test, what is excited (torque or speed), and who controls what (dynamometer first).
[recordings]
files = [{}]
"#,
        quoted_list(draft.files)
    );
    for file in draft.unlabelled {
        let _ = writeln!(
            text,
            "\n[[recordings.label]]\nfile = {}\nlabel = \"{PLACEHOLDER}\" # e.g. \"BS_T_NT\"",
            quoted(file)
        );
    }
}

fn variant_key(variant: BenchVariant) -> &'static str {
    match variant {
        BenchVariant::LoadCell => "load-cell",
        BenchVariant::TorqueFlange => "torque-flange",
    }
}

/// A text as a TOML string.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn quoted_list(texts: &[String]) -> String {
    texts.iter().map(|text| quoted(text)).collect::<Vec<_>>().join(", ")
}

/// A text from a recording made safe for a comment.
fn on_one_line(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}
