//! What both versions of a linear model's description have in common.

use ident::{Label, ModelDocument};

use super::super::csv;
use super::super::description::{attribute, named};
use super::model::LinearNumbers;
use crate::names::Names;

/// First reference of the inputs, as `linear_instance.c` has it; outputs and initial states follow.
const FIRST: usize = 10;

/// What a variable is for an importer.
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

/// What the FMU of a linear model says of itself.
pub(super) struct Description<'a> {
    pub(super) numbers: &'a LinearNumbers,
    pub(super) name: String,
    pub(super) tool: String,
    pub(super) token: &'a str,
    pub(super) variables: Vec<Variable>,
    /// Whether means or trends were taken off the data.
    pub(super) has_trend: bool,
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
            has_trend: document.trend.is_some(),
        }
    }

    pub(super) fn sentence(&self) -> String {
        let system = &self.numbers.system;
        format!(
            "Linear model on the clock of its data: {} inputs, {} outputs, {} states",
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
            unit => format!("    <Unit{}/>\n", attribute("name", unit)),
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

fn variables(document: &ModelDocument, states: usize) -> Vec<Variable> {
    let channel = |role: Role| move |label: &Label| (role, label.name.clone(), label.unit.clone());
    let initial = |state: usize| (Role::Initial, format!("initial_x{}", state + 1), String::new());
    let inputs = document.inputs.iter().map(channel(Role::Input));
    let outputs = document.outputs.iter().map(channel(Role::Output));
    let mut all: Vec<Variable> = Vec::new();
    for (role, name, unit) in inputs.chain(outputs).chain((0..states).map(initial)) {
        let description = match role {
            Role::Input => "input, sampled".to_owned(),
            Role::Output => "output of the last sample".to_owned(),
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

/// What the parameter `draw` is.
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
