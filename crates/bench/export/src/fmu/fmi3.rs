//! The model description of FMI 3.0, and what it has in files of their own.

use super::description::{Description, LOG, attribute, unit_definition, variable_head};
use super::platforms::Runtime;
use super::variables::{Kind, Role, Variable};
use super::{csv, sources};

/// `modelDescription.xml`.
pub(super) fn xml(description: &Description<'_>) -> String {
    let units: String = description.units().into_iter().map(unit_definition).collect();
    let variables: String = description.variables.iter().map(variable).collect();
    let step = csv::number(description.numbers.value("T_s"));
    let experiment = attribute("stepSize", &step);
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiModelDescription fmiVersion=\"3.0\"{head} variableNamingConvention=\"flat\">\n\
         {interfaces}  <UnitDefinitions>\n{units}  </UnitDefinitions>\n{TYPES}{LOG}  \
         <DefaultExperiment startTime=\"0\" stopTime=\"10\"{experiment}/>\n  \
         <ModelVariables>\n{variables}  </ModelVariables>\n{structure}</fmiModelDescription>\n",
        head = description.head("instantiationToken"),
        interfaces = interfaces(&step),
        structure = structure(description),
    )
}

const TYPES: &str = "  <TypeDefinitions>\n    \
    <EnumerationType name=\"ControlMode\" description=\"Control of the dynamometer\">\n      \
    <Item name=\"speed_control\" value=\"1\" description=\"NT\"/>\n      \
    <Item name=\"torque_control\" value=\"2\" description=\"TN\"/>\n    \
    </EnumerationType>\n  </TypeDefinitions>\n";

fn interfaces(step: &str) -> String {
    let runtime = Runtime::Bench;
    let identifier = attribute("modelIdentifier", runtime.identifier());
    let common = "canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\" \
         providesDirectionalDerivatives=\"true\" providesAdjointDerivatives=\"true\"";
    format!(
        "  <ModelExchange{identifier} {common}/>\n  \
         <CoSimulation{identifier} {common} canHandleVariableCommunicationStepSize=\"true\"{}/>\n",
        attribute("fixedInternalStepSize", step)
    )
}

fn variable(variable: &Variable) -> String {
    let head = variable_head(variable);
    match variable.kind {
        Kind::Real(unit, start, min) => {
            let number =
                |name, value: Option<f64>| value.map_or_else(String::new, |v| attribute(name, &csv::number(v)));
            let displayed = if variable.is_speed() { " displayUnit=\"rpm\"" } else { "" };
            let derivative = match variable.role {
                Role::Derivative(state) => attribute("derivative", &state.to_string()),
                _ => String::new(),
            };
            let unit = attribute("unit", unit.name);
            format!(
                "    <Float64{head}{unit}{displayed}{}{}{}{derivative}/>\n",
                number("min", min),
                number("nominal", variable.nominal),
                number("start", start)
            )
        }
        Kind::ControlMode(start) => {
            let start = attribute("start", &start.to_string());
            format!("    <Enumeration{head} declaredType=\"ControlMode\"{start}/>\n")
        }
        Kind::Integer(max) => {
            format!("    <Int32{head} min=\"0\"{} start=\"0\"/>\n", attribute("max", &max.to_string()))
        }
        Kind::Boolean => format!("    <Boolean{head}/>\n"),
    }
}

fn structure(description: &Description<'_>) -> String {
    let entry = |element: &str, variable: &Variable| {
        let known: Vec<String> = description.dependencies(variable).map(|other| other.reference.to_string()).collect();
        let reference = attribute("valueReference", &variable.reference.to_string());
        format!("    <{element}{reference}{}/>\n", attribute("dependencies", &known.join(" ")))
    };
    let outputs: String = description.outputs().map(|variable| entry("Output", variable)).collect();
    let derivatives: String =
        description.derivatives().map(|variable| entry("ContinuousStateDerivative", variable)).collect();
    let initial = description.variables.iter().filter(|variable| variable.is_calculated());
    let initial: String = initial
        .map(|variable| {
            format!("    <InitialUnknown{}/>\n", attribute("valueReference", &variable.reference.to_string()))
        })
        .collect();
    format!("  <ModelStructure>\n{outputs}{derivatives}{initial}  </ModelStructure>\n")
}

/// `sources/buildDescription.xml`.
pub(super) fn build_description(runtime: Runtime) -> String {
    let files: String =
        sources::compiled(runtime).map(|name| format!("      <SourceFile{}/>\n", attribute("name", name))).collect();
    let identifier = attribute("modelIdentifier", runtime.identifier());
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiBuildDescription fmiVersion=\"3.0\">\n  \
         <BuildConfiguration{identifier}>\n    <SourceFileSet language=\"C99\">\n{files}    </SourceFileSet>\n  \
         </BuildConfiguration>\n</fmiBuildDescription>\n"
    )
}

/// `terminalsAndIcons/terminalsAndIcons.xml`. A bench has a terminal where the engine is flanged to the shaft.
pub(super) fn icons(runtime: Runtime) -> String {
    let terminals = match runtime {
        Runtime::Bench => TERMINALS,
        Runtime::Linear => "",
    };
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<fmiTerminalsAndIcons fmiVersion=\"3.0\">\n  \
         <GraphicalRepresentation>\n    \
         <CoordinateSystem x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\" suggestedScalingFactorTo_mm=\"0.1\"/>\n    \
         <Icon x1=\"-100\" y1=\"-100\" x2=\"100\" y2=\"100\"/>\n  \
         </GraphicalRepresentation>\n{terminals}</fmiTerminalsAndIcons>\n"
    )
}

/// The engine's flange: torque in, speed and angle out, as members of the same names.
const TERMINALS: &str = "  <Terminals>\n    \
    <Terminal name=\"engine_flange\" matchingRule=\"plug\" terminalKind=\"dynoid.rotational_flange\" \
    description=\"Where the engine is flanged to the shaft: its torque in, speed and angle there out\">\n      \
    <TerminalMemberVariable variableKind=\"signal\" memberName=\"tau\" variableName=\"engine_torque\"/>\n      \
    <TerminalMemberVariable variableKind=\"signal\" memberName=\"w\" variableName=\"engine_side_speed\"/>\n      \
    <TerminalMemberVariable variableKind=\"signal\" memberName=\"phi\" variableName=\"engine_angle\"/>\n    \
    </Terminal>\n  </Terminals>\n";
