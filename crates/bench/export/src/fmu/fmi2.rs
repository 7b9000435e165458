//! The model description of FMI 2.0.

use super::description::{Description, LOG, attribute, unit_definition, variable_head};
use super::platforms::Runtime;
use super::variables::{Kind, Role, Variable};
use super::{csv, sources};

/// `modelDescription.xml`.
pub(super) fn xml(description: &Description<'_>) -> String {
    let units: String = description.units().into_iter().map(unit_definition).collect();
    let variables: String = description.variables.iter().map(|one| variable(description, one)).collect();
    let step = attribute("stepSize", &csv::number(description.numbers.value("T_s")));
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiModelDescription fmiVersion=\"2.0\"{head} variableNamingConvention=\"flat\" numberOfEventIndicators=\"0\">\n\
         {interfaces}  <UnitDefinitions>\n{units}  </UnitDefinitions>\n{TYPES}{LOG}  \
         <DefaultExperiment startTime=\"0\" stopTime=\"10\"{step}/>\n  \
         <ModelVariables>\n{variables}  </ModelVariables>\n{structure}</fmiModelDescription>\n",
        head = description.head("guid"),
        interfaces = interfaces(),
        structure = structure(description),
    )
}

const TYPES: &str = "  <TypeDefinitions>\n    \
    <SimpleType name=\"ControlMode\" description=\"Control of the dynamometer\">\n      <Enumeration>\n        \
    <Item name=\"speed_control\" value=\"1\" description=\"NT\"/>\n        \
    <Item name=\"torque_control\" value=\"2\" description=\"TN\"/>\n      \
    </Enumeration>\n    </SimpleType>\n  </TypeDefinitions>\n";

/// The sources that an importer may compile.
pub(super) fn source_files(runtime: Runtime) -> String {
    let files = sources::compiled(runtime).map(|name| format!("      <File{}/>\n", attribute("name", name)));
    format!("    <SourceFiles>\n{}    </SourceFiles>\n", files.collect::<String>())
}

fn interfaces() -> String {
    let runtime = Runtime::Bench;
    let common = "canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\" \
         canSerializeFMUstate=\"true\" providesDirectionalDerivative=\"true\"";
    let files = source_files(runtime);
    let identifier = attribute("modelIdentifier", runtime.identifier());
    format!(
        "  <ModelExchange{identifier} {common}>\n{files}  </ModelExchange>\n  \
         <CoSimulation{identifier} {common} canHandleVariableCommunicationStepSize=\"true\" \
         canInterpolateInputs=\"true\">\n{files}  </CoSimulation>\n"
    )
}

fn variable(description: &Description<'_>, variable: &Variable) -> String {
    let head = variable_head(variable);
    format!("    <ScalarVariable{head}>\n      {}\n    </ScalarVariable>\n", typed(description, variable))
}

fn typed(description: &Description<'_>, variable: &Variable) -> String {
    match variable.kind {
        Kind::Real(unit, start, min) => {
            let state = match variable.role {
                Role::Derivative(state) => description.variables.iter().find(|other| other.reference == state),
                _ => None,
            };
            let derivative = state.map(|state| attribute("derivative", &description.position(state).to_string()));
            let number =
                |name, value: Option<f64>| value.map_or_else(String::new, |v| attribute(name, &csv::number(v)));
            let displayed = if variable.is_speed() { " displayUnit=\"rpm\"" } else { "" };
            let unit = attribute("unit", unit.name);
            let (min, start) = (number("min", min), number("start", start));
            let nominal = number("nominal", variable.nominal);
            format!("<Real{unit}{displayed}{min}{nominal}{start}{}/>", derivative.unwrap_or_default())
        }
        Kind::ControlMode(start) => {
            format!("<Enumeration declaredType=\"ControlMode\"{}/>", attribute("start", &start.to_string()))
        }
        Kind::Integer(max) => format!("<Integer min=\"0\"{} start=\"0\"/>", attribute("max", &max.to_string())),
        Kind::Boolean => "<Boolean/>".to_owned(),
    }
}

fn structure(description: &Description<'_>) -> String {
    let unknown = |variable: &Variable| {
        // In FMI 2.0 parameters are no knowns of these.
        let known = description.dependencies(variable).filter(|other| !other.is_parameter());
        let known: Vec<String> = known.map(|other| description.position(other).to_string()).collect();
        let index = attribute("index", &description.position(variable).to_string());
        format!("      <Unknown{index}{}/>\n", attribute("dependencies", &known.join(" ")))
    };
    let outputs: String = description.outputs().map(unknown).collect();
    let derivatives: String = description.derivatives().map(unknown).collect();
    // What the first values depend on is not stated: parameters and initial values.
    let initial = description.variables.iter().filter(|variable| variable.is_calculated());
    let initial: String = initial
        .map(|variable| {
            format!("      <Unknown{}/>\n", attribute("index", &description.position(variable).to_string()))
        })
        .collect();
    format!(
        "  <ModelStructure>\n    <Outputs>\n{outputs}    </Outputs>\n    <Derivatives>\n{derivatives}    </Derivatives>\n    \
         <InitialUnknowns>\n{initial}    </InitialUnknowns>\n  </ModelStructure>\n"
    )
}
