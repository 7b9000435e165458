//! The model description of FMI 2.0.

use super::super::description::attribute;
use super::super::fmi2::source_files;
use super::super::platforms::Runtime;
use super::description::{Description, Role, Variable};

/// `modelDescription.xml`.
pub(super) fn xml(description: &Description<'_>) -> String {
    let variables: String = description.variables.iter().map(variable).collect();
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
         <fmiModelDescription fmiVersion=\"2.0\"{head} variableNamingConvention=\"flat\" numberOfEventIndicators=\"0\">\n\
         {interfaces}  <UnitDefinitions>\n{units}  </UnitDefinitions>\n{log}  \
         <DefaultExperiment startTime=\"0\" stepSize=\"{step}\"/>\n  \
         <ModelVariables>\n{TIME}{draw}{variables}  </ModelVariables>\n{structure}</fmiModelDescription>\n",
        head = description.head("guid"),
        interfaces = interfaces(),
        units = description.units(),
        log = super::description::LOG,
        step = description.step(),
        draw = draw(description.numbers.draws.len()),
        structure = structure(description),
    )
}

const TIME: &str = "    <ScalarVariable name=\"time\" valueReference=\"0\" causality=\"independent\" variability=\"continuous\">\n      \
    <Real unit=\"s\"/>\n    </ScalarVariable>\n";
/// Variables before the channels, `time` and `draw`.
const BEFORE: usize = 2;

fn draw(most: usize) -> String {
    format!(
        "    <ScalarVariable name=\"draw\" valueReference=\"1\" description=\"{}\" causality=\"parameter\" variability=\"tunable\" \
         initial=\"exact\">\n      <Integer min=\"0\" max=\"{most}\" start=\"0\"/>\n    </ScalarVariable>\n",
        super::description::DRAW
    )
}

fn interfaces() -> String {
    let common =
        "canNotUseMemoryManagementFunctions=\"true\" canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"";
    let files = source_files(Runtime::Linear);
    let identifier = attribute("modelIdentifier", Runtime::Linear.identifier());
    format!(
        "  <ModelExchange{identifier} {common}>\n{files}  </ModelExchange>\n  \
         <CoSimulation{identifier} {common} canHandleVariableCommunicationStepSize=\"true\">\n{files}  </CoSimulation>\n"
    )
}

fn variable(variable: &Variable) -> String {
    let (head, unit, start) = (variable.head(), variable.unit(), variable.start());
    format!("    <ScalarVariable{head}>\n      <Real{unit}{start}/>\n    </ScalarVariable>\n")
}

fn structure(description: &Description<'_>) -> String {
    let position = |variable: &Variable| {
        let found = description.variables.iter().position(|other| other.reference == variable.reference);
        found.map_or(0, |index| index + 1 + BEFORE).to_string()
    };
    let output = |(number, variable): (usize, &Variable)| {
        let known: Vec<String> = description.dependencies(number).into_iter().map(position).collect();
        let (index, known) = (attribute("index", &position(variable)), attribute("dependencies", &known.join(" ")));
        format!("      <Unknown{index}{known}/>\n")
    };
    let first =
        |(_, variable): (usize, &Variable)| format!("      <Unknown{}/>\n", attribute("index", &position(variable)));
    let outputs: String = description.of_role(Role::Output).map(output).collect();
    let initial: String = description.of_role(Role::Output).map(first).collect();
    format!(
        "  <ModelStructure>\n    <Outputs>\n{outputs}    </Outputs>\n    <InitialUnknowns>\n{initial}    \
         </InitialUnknowns>\n  </ModelStructure>\n"
    )
}
