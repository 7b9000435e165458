//! Common parts of both versions of the model description.

use std::fmt::Write;

use bench_model::document::{BenchModelDocument, Range};
use sha2::{Digest, Sha256};

use super::numbers::BenchNumbers;
use super::resource;
use super::variables::{self, FmiUnit, Kind, Role, Variable};
use crate::xml::escaped;

/// One revolution a minute in rad/s, the other way round.
const RPM_PER_RAD_S: f64 = 30.0 / std::f64::consts::PI;

/// Content of an FMU's description.
pub(super) struct Description<'a> {
    pub(super) document: &'a BenchModelDocument,
    pub(super) numbers: &'a BenchNumbers,
    pub(super) variables: Vec<Variable>,
    /// Joins the description and the resources: the runtime refuses others.
    pub(super) token: String,
}

impl<'a> Description<'a> {
    pub(super) fn of(document: &'a BenchModelDocument, numbers: &'a BenchNumbers) -> Self {
        Description {
            document,
            numbers,
            variables: variables::all(numbers),
            token: token(&resource::text(numbers, "")),
        }
    }

    /// Attributes of the root element that both versions have; they call the token otherwise.
    pub(super) fn head(&self, token: &str) -> String {
        let all = [
            ("generationTool", self.tool()),
            ("modelName", self.document.bench.name.clone()),
            (token, self.token.clone()),
            ("description", self.sentence()),
            ("generationDateAndTime", self.date()),
        ];
        all.iter().map(|(name, value)| attribute(name, value)).collect()
    }

    /// One sentence about the model.
    pub(super) fn sentence(&self) -> String {
        let mode = if self.numbers.has_speed_control { "speed and torque control" } else { "torque control" };
        let lead = self
            .numbers
            .demand_lead
            .as_ref()
            .map_or_else(String::new, |words| format!("; of the speed demand {words}"));
        format!(
            "Dynamometer test bench in {mode}: two masses, a shaft and a sampled controller, identified from recordings{lead}"
        )
    }

    /// Name and version of the program that made it.
    pub(super) fn tool(&self) -> String {
        format!("dynoid {}", self.document.provenance.dynoid_version)
    }

    /// Day on which the model was made, as a time.
    pub(super) fn date(&self) -> String {
        format!("{}T00:00:00Z", self.document.provenance.date)
    }

    /// The units of all variables, once each.
    pub(super) fn units(&self) -> Vec<FmiUnit> {
        let mut units = Vec::new();
        for variable in &self.variables {
            if let Kind::Real(unit, ..) = variable.kind
                && !units.contains(&unit)
            {
                units.push(unit);
            }
        }
        units
    }

    /// The position of a variable, counted from 1.
    pub(super) fn position(&self, wanted: &Variable) -> usize {
        self.variables.iter().position(|variable| variable.reference == wanted.reference).map_or(0, |index| index + 1)
    }

    /// The inputs, states and parameters that an output, or a derivative, depends on; outputs of the controller's
    /// samples on none.
    pub(super) fn dependencies(&self, of: &Variable) -> impl Iterator<Item = &Variable> {
        let wanted: &[&str] = match of.name.as_str() {
            "shaft_torque" => &["K", "B", "dyno_side_speed", "engine_side_speed", "twist"],
            "air_gap_torque" => &["lagged_torque"],
            "der(dyno_side_speed)" => {
                &["J_d", "K", "B", "dyno_side_speed", "engine_side_speed", "twist", "lagged_torque"]
            }
            "der(engine_side_speed)" => {
                &["engine_torque", "J_e", "K", "B", "dyno_side_speed", "engine_side_speed", "twist"]
            }
            "engine_side_speed" | "der(engine_angle)" => &["engine_side_speed"],
            "der(twist)" => &["dyno_side_speed", "engine_side_speed"],
            "der(lagged_torque)" => &["a", "lagged_torque"],
            "der(dyno_angle)" => &["dyno_side_speed"],
            _ => &[],
        };
        self.variables.iter().filter(|variable| wanted.contains(&variable.name.as_str()))
    }

    /// Outputs, in order.
    pub(super) fn outputs(&self) -> impl Iterator<Item = &Variable> {
        self.variables.iter().filter(|variable| variable.is_output())
    }

    /// Derivatives of the states, in order.
    pub(super) fn derivatives(&self) -> impl Iterator<Item = &Variable> {
        self.variables.iter().filter(|variable| matches!(variable.role, Role::Derivative(_)))
    }

    /// The range of validity in words.
    pub(super) fn validity(&self) -> String {
        let range = |name: &str, unit: &str, range: Option<Range>| {
            range.map_or_else(
                || format!("{name}: not known"),
                |(low, high)| format!("{name}: {low:.1} to {high:.1} {unit}"),
            )
        };
        let rpm = self.numbers.speed_range_rad_s.map(|(low, high)| (low * RPM_PER_RAD_S, high * RPM_PER_RAD_S));
        let torque = range("T_d", "Nm", self.numbers.torque_range_nm);
        let frequency = range("frequency", "Hz", self.document.validity.frequency_hz);
        format!("{}; {torque}; {frequency}", range("N_d", "rpm", rpm))
    }
}

/// Messages by their kind; the same in FMI 2.0 and 3.0.
pub(super) const LOG: &str = "  <LogCategories>\n    \
    <Category name=\"logStatusWarning\" description=\"The bench is outside the range of validity\"/>\n    \
    <Category name=\"logStatusError\" description=\"Wrong calls and values\"/>\n  </LogCategories>\n";

/// `name="value"` for XML, with a space before it.
pub(super) fn attribute(name: &str, value: &str) -> String {
    format!(" {name}=\"{}\"", escaped(value))
}

/// Attributes of a variable that both versions have.
pub(super) fn variable_head(variable: &Variable) -> String {
    named(&variable.name, &variable.reference.to_string(), &variable.description, causality(variable.role))
}

/// Attributes of a variable: name, reference, description, and causality, variability and `initial`.
pub(super) fn named(
    name: &str,
    reference: &str,
    description: &str,
    (causality, variability, initial): (&str, &str, Option<&str>),
) -> String {
    let all = [
        ("name", Some(name)),
        ("valueReference", Some(reference)),
        ("description", Some(description)),
        ("causality", Some(causality)),
        ("variability", Some(variability)),
        ("initial", initial),
    ];
    all.into_iter().filter_map(|(name, value)| Some(attribute(name, value?))).collect()
}

/// A definition of a unit, the same in FMI 2.0 and 3.0.
pub(super) fn unit_definition(unit: FmiUnit) -> String {
    let bases = ["kg", "m", "s", "rad"].into_iter().zip(unit.exponents).filter(|(_, exponent)| *exponent != 0);
    let bases: String = bases.map(|(base, exponent)| attribute(base, &exponent.to_string())).collect();
    let name = attribute("name", unit.name);
    if unit.name == "rad/s" {
        let factor = attribute("factor", &RPM_PER_RAD_S.to_string());
        return format!(
            "    <Unit{name}>\n      <BaseUnit{bases}/>\n      <DisplayUnit name=\"rpm\"{factor}/>\n    </Unit>\n"
        );
    }
    format!("    <Unit{name}>\n      <BaseUnit{bases}/>\n    </Unit>\n")
}

/// Causality, variability and `initial` of a variable.
pub(super) fn causality(role: Role) -> (&'static str, &'static str, Option<&'static str>) {
    match role {
        Role::Time => ("independent", "continuous", None),
        Role::Input => ("input", "continuous", None),
        Role::Fixed => ("parameter", "fixed", Some("exact")),
        Role::Tunable => ("parameter", "tunable", Some("exact")),
        Role::Output => ("output", "continuous", Some("calculated")),
        Role::Sampled => ("output", "discrete", Some("calculated")),
        Role::OutputState => ("output", "continuous", Some("calculated")),
        Role::State | Role::Derivative(_) => ("local", "continuous", Some("calculated")),
    }
}

/// A UUID (version 8) of a resource.
pub(super) fn token(resource: &str) -> String {
    let hash = Sha256::digest(resource.as_bytes());
    let mut text = String::new();
    for (index, byte) in hash.iter().take(16).enumerate() {
        let byte = match index {
            6 => byte & 0x0f | 0x80,
            8 => byte & 0x3f | 0x80,
            _ => *byte,
        };
        if matches!(index, 4 | 6 | 8 | 10) {
            text.push('-');
        }
        // Writing to a string cannot fail.
        let _ = write!(text, "{byte:02x}");
    }
    format!("{{{text}}}")
}
