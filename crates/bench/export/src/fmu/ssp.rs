//! A bench and the place of an engine, connected, as a package of SSP 1.0: the bench's FMU of FMI 2.0 with its
//! parameter set.
//!
//! Source: Modelica Association, *System Structure and Parameterization* 1.0.1, chapters 3 and 5.

use bench_model::document::BenchModelDocument;

use super::archive::Archive;
use super::description::{Description, attribute};
use super::numbers::BenchNumbers;
use super::platforms::FmiVersion;
use super::variables::{ENGINE_SIDE_SPEED, ENGINE_TORQUE, Kind, Role, Variable};
use crate::names::Names;
use crate::numbers::Unit;
use crate::{ExportError, ExportedFile, ssv};

/// Names of the components.
const BENCH: &str = "bench";
const ENGINE: &str = "engine";
/// Connectors of the engine: torque and speed of its flange, by the names of FMI's terminal and of Modelica.
const ENGINE_TORQUE_OUT: &str = "tau";
const ENGINE_SPEED_IN: &str = "w";

/// The file `NAME.ssp`. Its engine is a component without a source: a place for an FMU that gives a torque at a speed.
/// `report` goes into the FMU as in [`super::fmu`].
///
/// # Errors
/// Those of [`super::fmu`].
pub fn ssp(document: &BenchModelDocument, names: &Names, report: Option<&[u8]>) -> Result<ExportedFile, ExportError> {
    // In a URI any other name would have to be encoded.
    let inner = Names::of(&document.bench.name);
    let fmu = super::fmu(document, &inner, FmiVersion::V2, report)?;
    let sets = ssv::bench(document, &inner, 0)?;
    let numbers = BenchNumbers::without_draws(document)?;
    let description = Description::of(document, &numbers);
    let sources = Sources { fmu: resource(&fmu), set: sets.first().map(resource).unwrap_or_default() };
    let mut archive = Archive::default();
    // As it is: the first bytes of the archive name the program that wrote it.
    archive.store("SystemStructure.ssd", structure(&description, &sources).as_bytes());
    archive.store(&sources.fmu, &fmu.content);
    for set in &sets {
        archive.add(&resource(set), &set.content);
    }
    Ok(ExportedFile { name: format!("{}.ssp", names.file), content: archive.into_bytes() })
}

/// Files that the bench of the structure refers to.
struct Sources {
    fmu: String,
    set: String,
}

fn resource(file: &ExportedFile) -> String {
    format!("resources/{}", file.name)
}

/// Direction of a connector for those that are connected to it.
#[derive(Clone, Copy)]
enum Direction {
    In,
    Out,
}

fn structure(description: &Description<'_>, sources: &Sources) -> String {
    let head: String = [
        ("generationTool", description.tool()),
        ("name", description.document.bench.name.clone()),
        ("generationDateAndTime", description.date()),
    ]
    .iter()
    .map(|(name, value)| attribute(name, value))
    .collect();
    let outside: Vec<&Variable> = description.variables.iter().filter(|one| is_outside(one)).collect();
    let units = ssv::units([Unit::Speed, Unit::Torque].into_iter());
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<ssd:SystemStructureDescription{head} version=\"1.0\" \
         xmlns:ssd=\"http://ssp-standard.org/SSP1/SystemStructureDescription\" \
         xmlns:ssc=\"http://ssp-standard.org/SSP1/SystemStructureCommon\">\n  <ssd:System name=\"test_cell\"{words}>\n\
         {connectors}    <ssd:Elements>\n{bench}{engine}    </ssd:Elements>\n    <ssd:Connections>\n{connections}    \
         </ssd:Connections>\n    <ssd:SystemGeometry x1=\"0\" y1=\"0\" x2=\"120\" y2=\"60\"/>\n  </ssd:System>\n  \
         <ssd:Units>\n{units}  </ssd:Units>\n  <ssd:DefaultExperiment startTime=\"0\" stopTime=\"10\"/>\n\
         </ssd:SystemStructureDescription>\n",
        words = attribute("description", &description.sentence()),
        connectors = connectors("    ", outside.iter().copied()),
        bench = bench(description, sources),
        engine = engine(),
        connections = connections(&outside),
    )
}

/// Tells whether the system shows a variable of its bench outside: demands, and all outputs.
fn is_outside(variable: &Variable) -> bool {
    let is_demand = variable.role == Role::Input && matches!(variable.name.as_str(), "speed_demand" | "torque_demand");
    is_demand || variable.is_output()
}

fn bench(description: &Description<'_>, sources: &Sources) -> String {
    let all = description.variables.iter().filter(|one| is_outside(one) || one.name == ENGINE_TORQUE);
    format!(
        "      <ssd:Component{}{} type=\"application/x-fmu-sharedlibrary\"{}>\n{}        \
         <ssd:ElementGeometry x1=\"10\" y1=\"10\" x2=\"50\" y2=\"50\"/>\n        \
         <ssd:ParameterBindings>\n          <ssd:ParameterBinding{}/>\n        </ssd:ParameterBindings>\n      \
         </ssd:Component>\n",
        attribute("name", BENCH),
        attribute("description", "dynamometer, shaft and the engine's inertia"),
        attribute("source", &sources.fmu),
        connectors("        ", all),
        attribute("source", &sources.set),
    )
}

/// An empty source is how SSP 1.0 says that an implementation is to be put here.
fn engine() -> String {
    let connectors = [
        connector(
            "        ",
            ENGINE_TORQUE_OUT,
            Direction::Out,
            "torque of the engine",
            &real(Unit::Torque.modelica()),
        ),
        connector("        ", ENGINE_SPEED_IN, Direction::In, "speed of the engine", &real(Unit::Speed.modelica())),
    ];
    format!(
        "      <ssd:Component{}{} source=\"\">\n        <ssd:Connectors>\n{}        </ssd:Connectors>\n        \
         <ssd:ElementGeometry x1=\"70\" y1=\"10\" x2=\"110\" y2=\"50\"/>\n      </ssd:Component>\n",
        attribute("name", ENGINE),
        attribute("description", "place of an engine without its inertia, which the bench has: torque at a speed"),
        connectors.concat(),
    )
}

fn connections(outside: &[&Variable]) -> String {
    let between_engine_and_bench =
        [(ENGINE, ENGINE_TORQUE_OUT, BENCH, ENGINE_TORQUE), (BENCH, ENGINE_SIDE_SPEED, ENGINE, ENGINE_SPEED_IN)];
    let inside = between_engine_and_bench.map(|(from, out, to, into)| {
        let ends = [("startElement", from), ("startConnector", out), ("endElement", to), ("endConnector", into)];
        connection(&ends)
    });
    let with_outside = outside.iter().map(|variable| {
        let element = if variable.is_output() { "startElement" } else { "endElement" };
        connection(&[(element, BENCH), ("startConnector", &variable.name), ("endConnector", &variable.name)])
    });
    inside.into_iter().chain(with_outside).collect()
}

fn connection(ends: &[(&str, &str)]) -> String {
    let ends: String = ends.iter().map(|(name, value)| attribute(name, value)).collect();
    format!("      <ssd:Connection{ends}/>\n")
}

/// The connectors of variables, by their names.
fn connectors<'a>(margin: &str, variables: impl Iterator<Item = &'a Variable>) -> String {
    let all: String = variables
        .map(|variable| {
            let direction = if variable.is_output() { Direction::Out } else { Direction::In };
            let kind = match variable.kind {
                Kind::Boolean => "<ssc:Boolean/>".to_owned(),
                Kind::Real(unit, ..) => real(unit.name),
                Kind::ControlMode(_) | Kind::Integer(_) => "<ssc:Integer/>".to_owned(),
            };
            connector(margin, &variable.name, direction, &variable.description, &kind)
        })
        .collect();
    format!("{margin}<ssd:Connectors>\n{all}{margin}</ssd:Connectors>\n")
}

fn real(unit: &str) -> String {
    format!("<ssc:Real{}/>", attribute("unit", unit))
}

fn connector(margin: &str, name: &str, direction: Direction, description: &str, kind: &str) -> String {
    let direction = match direction {
        Direction::In => "input",
        Direction::Out => "output",
    };
    format!(
        "{margin}  <ssd:Connector{}{}{}>{kind}</ssd:Connector>\n",
        attribute("name", name),
        attribute("kind", direction),
        attribute("description", description)
    )
}
