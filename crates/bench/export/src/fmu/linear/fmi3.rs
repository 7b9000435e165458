//! The model description of FMI 3.0.

use super::super::description::attribute;
use super::super::platforms::Runtime;
use super::description::{Description, Role, Variable};

/// `modelDescription.xml`.
pub(super) fn xml(description: &Description<'_>) -> String {
    let variables: String = description.variables.iter().map(variable).collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiModelDescription fmiVersion=\"3.0\"{head} variableNamingConvention=\"flat\">\n\
         {interfaces}  <UnitDefinitions>\n{units}  </UnitDefinitions>\n{log}  \
         <DefaultExperiment startTime=\"0\" stepSize=\"{step}\"/>\n  \
         <ModelVariables>\n{TIME}{draw}{variables}  </ModelVariables>\n{structure}</fmiModelDescription>\n",
        head = description.head("instantiationToken"),
        interfaces = interfaces(&description.step()),
        units = description.units(),
        log = super::description::LOG,
        step = description.step(),
        draw = draw(description.numbers.draws.len()),
        structure = structure(description),
    )
}

const TIME: &str = "    <Float64 name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\" unit=\"s\"/>\n";

fn draw(most: usize) -> String {
    format!(
        "    <Int32 name=\"draw\" valueReference=\"1\" description=\"{}\" causality=\"parameter\" variability=\"tunable\" \
         initial=\"exact\" min=\"0\" max=\"{most}\" start=\"0\"/>\n",
        super::description::DRAW
    )
}

fn interfaces(step: &str) -> String {
    let identifier = attribute("modelIdentifier", Runtime::Linear.identifier());
    let common = "canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"";
    let step = attribute("fixedInternalStepSize", step);
    format!(
        "  <ModelExchange{identifier} {common}/>\n  \
         <CoSimulation{identifier} {common} canHandleVariableCommunicationStepSize=\"true\"{step}/>\n"
    )
}

fn variable(variable: &Variable) -> String {
    let (head, unit, start) = (variable.head(), variable.unit(), variable.start());
    format!("    <Float64{head}{unit}{start}/>\n")
}

fn structure(description: &Description<'_>) -> String {
    let output = |(number, variable): (usize, &Variable)| {
        let known: Vec<String> =
            description.dependencies(number).into_iter().map(|other| other.reference.to_string()).collect();
        let reference = attribute("valueReference", &variable.reference.to_string());
        format!("    <Output{reference}{}/>\n", attribute("dependencies", &known.join(" ")))
    };
    let first = |(_, variable): (usize, &Variable)| {
        format!("    <InitialUnknown{}/>\n", attribute("valueReference", &variable.reference.to_string()))
    };
    let outputs: String = description.of_role(Role::Output).map(output).collect();
    let initial: String = description.of_role(Role::Output).map(first).collect();
    format!("  <ModelStructure>\n{outputs}{initial}  </ModelStructure>\n")
}
