//! The experiments of the method and the shapes of tests, before one is chosen.

use capability::shapes::Shape;
use page::{Align, Block, Page, Table};
use rig::experiment::DemandKind;
use rig::experiment::catalogue::{Parameter, Template};

/// How parameters are given.
const GIVEN: &str = "speed and duration have options of their own; the others are given as --set NAME=VALUE";

/// Experiments and shapes, and the results that each gives.
pub fn overview(shown: &[&Template], shapes: &[Shape]) -> Page {
    let mut table = Table::new(&[("experiment", Align::Left), ("gives", Align::Left)]);
    for template in shown {
        table.row([template.label().to_string().into(), template.gives.into()]);
        table.note(&format!("{}. {}.", template.demands, names(&template.parameters())));
    }
    let mut of_can = Table::new(&[("shape of `dynoid can`", Align::Left), ("demands", Align::Left)]);
    for shape in shapes {
        of_can.row([shape.name.into(), shape.demands.into()]);
        of_can.note(&format!("{}.", names(shape.parameters)));
    }
    let demands = DemandKind::ALL.map(|kind| format!("{} [{}]", kind.name(), kind.unit())).join(", ");
    let label = "A label is {test}_{T|N}_{mode}: what is excited, torque or speed; NT: the dynamometer controls speed, TN: torque.";
    let blocks = vec![
        Block::Table(table),
        Block::paragraph(label),
        Block::Table(of_can),
        Block::paragraph("Parameters, with units and ranges: dynoid experiment list NAME"),
        Block::paragraph(format!("Demands of your own: a file with columns {demands}, in place of a name")),
    ];
    Page::new("Experiments", blocks)
}

fn names(parameters: &[Parameter]) -> String {
    let name = |p: &Parameter| format!("{} {}", p.name, with_unit(p.default, p.unit));
    parameters.iter().map(name).collect::<Vec<_>>().join(", ")
}

fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { value.to_string() } else { format!("{value} {unit}") }
}

/// One experiment with its parameters.
pub fn experiment(template: &Template) -> Page {
    let label = template.label().to_string();
    let blocks = vec![
        Block::heading(label.as_str()),
        Block::paragraph(format!("Demands: {}.", template.demands)),
        Block::paragraph(format!("Gives: {}.", template.gives)),
        Block::Table(parameters(&template.parameters())),
        Block::paragraph(GIVEN),
    ];
    Page::new(label, blocks)
}

/// One shape with its parameters.
pub fn shape(shape: &Shape) -> Page {
    let blocks = vec![
        Block::heading(shape.name),
        Block::paragraph(format!("Demands: {}. It is a test of `dynoid can`.", shape.demands)),
        Block::Table(parameters(shape.parameters)),
        Block::paragraph(GIVEN),
    ];
    Page::new(shape.name, blocks)
}

fn parameters(parameters: &[Parameter]) -> Table {
    let mut table = Table::new(&[
        ("parameter", Align::Left),
        ("default", Align::Right),
        ("from", Align::Right),
        ("to", Align::Right),
        ("unit", Align::Left),
        ("what it is", Align::Left),
    ]);
    for parameter in parameters {
        table.row([
            parameter.name.into(),
            parameter.default.to_string().into(),
            parameter.lowest.to_string().into(),
            parameter.highest.to_string().into(),
            parameter.unit.into(),
            parameter.meaning.into(),
        ]);
    }
    table
}
