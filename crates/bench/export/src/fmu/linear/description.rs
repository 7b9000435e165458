//! Common parts of both versions of a linear model's description.

use ident::{Label, ModelDocument};
use units::Quantity;

use super::super::csv;
use super::super::description::{attribute, named};
use super::model::LinearNumbers;
use crate::levels::{self, Levels};
use crate::names::Names;

/// First reference of the inputs, as `linear_instance.c` has it; outputs and initial states follow.
const FIRST: usize = 10;

/// Role of a variable for an importer.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    Input,
    Output,
    Initial,
}

/// One real variable.
pub(super) struct Variable {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) reference: usize,
    pub(super) role: Role,
    pub(super) description: String,
}

impl Variable {
    /// Attributes that both versions have.
    pub(super) fn head(&self) -> String {
        named(&self.name, &self.reference.to_string(), &self.description, causality(self.role))
    }

    pub(super) fn unit(&self) -> String {
        if self.unit.is_empty() { String::new() } else { attribute("unit", &self.unit) }
    }

    pub(super) fn start(&self) -> &'static str {
        if self.role == Role::Output { "" } else { " start=\"0\"" }
    }
}

/// Content of the description of a linear model's FMU.
pub(super) struct Description<'a> {
    pub(super) numbers: &'a LinearNumbers,
    pub(super) name: String,
    pub(super) tool: String,
    pub(super) token: &'a str,
    pub(super) variables: Vec<Variable>,
    /// Levels from which the inputs and outputs are differences, if from any.
    pub(super) levels: Option<String>,
}

impl<'a> Description<'a> {
    pub(super) fn of(
        document: &ModelDocument,
        numbers: &'a LinearNumbers,
        names: &Names,
        version: &str,
        token: &'a str,
    ) -> Self {
        Description {
            numbers,
            name: names.file.clone(),
            tool: format!("dynoid {version}"),
            token,
            variables: variables(document, numbers.system.states()),
            levels: document.trend.as_ref().map(|_| levels::sentence(document)),
        }
    }

    pub(super) fn sentence(&self) -> String {
        let system = &self.numbers.system;
        let levels =
            self.levels.as_ref().map_or_else(String::new, |words| format!(". {}", words.trim_end_matches('.')));
        format!(
            "Linear model on the clock of its data: {} inputs, {} outputs, {} states{levels}",
            system.inputs(),
            system.outputs(),
            system.states()
        )
    }

    /// Attributes of the root element that both versions have.
    pub(super) fn head(&self, token: &str) -> String {
        [
            ("generationTool", self.tool.as_str()),
            ("modelName", &self.name),
            (token, self.token),
            ("description", &self.sentence()),
        ]
        .map(|(name, value)| attribute(name, value))
        .concat()
    }

    pub(super) fn step(&self) -> String {
        csv::number(self.numbers.sample_time_s)
    }

    /// Definitions of all units, once each.
    pub(super) fn units(&self) -> String {
        let mut units: Vec<&str> = self.variables.iter().map(|variable| variable.unit.as_str()).collect();
        units.push("s");
        units.sort_unstable();
        units.dedup();
        let define = |unit: &&str| match *unit {
            "s" => "    <Unit name=\"s\"><BaseUnit s=\"1\"/></Unit>\n".to_owned(),
            unit => definition(unit),
        };
        units.iter().filter(|unit| !unit.is_empty()).map(define).collect()
    }

    /// The variables of a role, each with its number from 0.
    pub(super) fn of_role(&self, role: Role) -> impl Iterator<Item = (usize, &Variable)> {
        self.variables.iter().filter(move |variable| variable.role == role).enumerate()
    }

    /// The inputs that act on an output at once.
    pub(super) fn dependencies(&self, output: usize) -> Vec<&Variable> {
        let d = self.numbers.system.d();
        self.of_role(Role::Input)
            .filter(|(input, _)| d[(output, *input)] != 0.0)
            .map(|(_, variable)| variable)
            .collect()
    }
}

/// A unit with what it is in SI's base units; of one that is not known its name alone.
fn definition(unit: &str) -> String {
    let name = attribute("name", unit);
    let Ok(known) = units::parse_unit(unit) else { return format!("    <Unit{name}/>\n") };
    let symbols = ["kg", "m", "s", "A", "K", "rad"];
    let bases = symbols.into_iter().zip(exponents(known.quantity)).filter(|(_, exponent)| *exponent != 0);
    let bases: String = bases.map(|(base, exponent)| attribute(base, &exponent.to_string())).collect();
    let other_than = |usual: f64, name: &str, value: f64| match value == usual {
        true => String::new(),
        false => attribute(name, &csv::number(value)),
    };
    let (factor, offset) = (other_than(1.0, "factor", known.factor), other_than(0.0, "offset", known.offset));
    format!("    <Unit{name}><BaseUnit{bases}{factor}{offset}/></Unit>\n")
}

/// Exponents of kg, m, s, A, K and rad; rad counts as a unit.
fn exponents(quantity: Quantity) -> [i32; 6] {
    match quantity {
        Quantity::AngularSpeed => [0, 0, -1, 0, 0, 1],
        Quantity::Torque => [1, 2, -2, 0, 0, 0],
        Quantity::Ratio => [0; 6],
        Quantity::Inertia => [1, 2, 0, 0, 0, 0],
        Quantity::Stiffness => [1, 2, -2, 0, 0, -1],
        Quantity::Damping => [1, 2, -1, 0, 0, -1],
        Quantity::Angle => [0, 0, 0, 0, 0, 1],
        Quantity::AngularAcceleration => [0, 0, -2, 0, 0, 1],
        Quantity::TorqueRate | Quantity::Power => [1, 2, -3, 0, 0, 0],
        Quantity::Time => [0, 0, 1, 0, 0, 0],
        Quantity::Temperature => [0, 0, 0, 0, 1, 0],
        Quantity::Pressure => [1, -1, -2, 0, 0, 0],
        Quantity::Force => [1, 1, -2, 0, 0, 0],
        Quantity::Current => [0, 0, 0, 1, 0, 0],
        Quantity::Voltage => [1, 2, -3, -1, 0, 0],
        Quantity::MassFlow => [1, 0, -1, 0, 0, 0],
        Quantity::Length => [0, 1, 0, 0, 0, 0],
        Quantity::Speed => [0, 1, -1, 0, 0, 0],
    }
}

/// Level from which a channel is a difference, for its description.
fn from_level(levels: Option<&Levels>, role: Role, place: usize, unit: &str) -> String {
    let of = |levels: &Levels| match role {
        Role::Input => levels.inputs.get(place).copied(),
        Role::Output => levels.outputs.get(place).copied(),
        Role::Initial => None,
    };
    let level = levels.and_then(of).filter(|level| *level != 0.0);
    level.map_or_else(String::new, |level| {
        format!("; difference from the level {} {unit}", csv::number(level)).trim_end().to_owned()
    })
}

fn variables(document: &ModelDocument, states: usize) -> Vec<Variable> {
    let channel =
        |role: Role| move |(place, label): (usize, &Label)| (role, place, label.name.clone(), label.unit.clone());
    let initial = |state: usize| (Role::Initial, state, format!("initial_x{}", state + 1), String::new());
    let inputs = document.inputs.iter().enumerate().map(channel(Role::Input));
    let outputs = document.outputs.iter().enumerate().map(channel(Role::Output));
    let levels = Levels::of(document);
    let mut all: Vec<Variable> = Vec::new();
    for (role, place, name, unit) in inputs.chain(outputs).chain((0..states).map(initial)) {
        let level = from_level(levels.as_ref(), role, place, &unit);
        let description = match role {
            Role::Input => format!("input, sampled{level}"),
            Role::Output => format!("output of the last sample{level}"),
            Role::Initial => "state at the start".to_owned(),
        };
        let name = unused(&name, &all);
        all.push(Variable { name, unit, reference: FIRST + all.len(), role, description });
    }
    all
}

/// A name that FMI takes and no other variable has.
fn unused(name: &str, taken: &[Variable]) -> String {
    let plain: String = name.chars().filter(|c| !c.is_control()).collect();
    let plain = if plain.is_empty() { "channel".to_owned() } else { plain };
    let is_free = |name: &str| !["time", "draw"].contains(&name) && taken.iter().all(|other| other.name != name);
    if is_free(&plain) {
        return plain;
    }
    let numbered = (2..).map(|number| format!("{plain}_{number}"));
    numbered.into_iter().find(|name| is_free(name)).unwrap_or(plain)
}

/// Description of the parameter `draw`.
pub(super) const DRAW: &str = "0 the estimate, k the k-th draw of its covariance";

/// Messages by their kind; the same in FMI 2.0 and 3.0.
pub(super) const LOG: &str = "  <LogCategories>\n    \
    <Category name=\"logStatusError\" description=\"Wrong calls and values\"/>\n  </LogCategories>\n";

/// Causality, variability and `initial` of a variable.
fn causality(role: Role) -> (&'static str, &'static str, Option<&'static str>) {
    match role {
        Role::Input => ("input", "continuous", None),
        Role::Output => ("output", "discrete", Some("calculated")),
        Role::Initial => ("parameter", "fixed", Some("exact")),
    }
}
