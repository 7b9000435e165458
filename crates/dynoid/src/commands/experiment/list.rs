//! `dynoid experiment list`: the experiments of the method.

use rig::experiment::catalogue::{self, Parameter, Template};
use rig::experiment::{DemandKind, free_form};

use crate::cli::experiment::ListArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;
use page::{Align, Table, Tone};

pub(crate) fn run(arguments: &ListArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let found = arguments.name.as_deref().map(catalogue::find).transpose();
    let one = found.map_err(|error| CliError::Usage { what: error.to_string() })?;
    let shown: Vec<&Template> = one.map_or_else(|| catalogue::all().iter().collect(), |template| vec![template]);
    if arguments.json {
        terminal.json(&json(&shown))?;
    } else if let Some(template) = one {
        detail(template, terminal);
    } else {
        overview(&shown, terminal);
    }
    Ok(Outcome::Done)
}

fn json(shown: &[&Template]) -> serde_json::Value {
    let experiment = |template: &&Template| {
        serde_json::json!({"label": template.label().to_string(), "demands": template.demands,
            "gives": template.gives, "parameters": template.parameters()})
    };
    let demand = |kind: DemandKind| serde_json::json!({"name": kind.name(), "unit": kind.unit()});
    serde_json::json!({
        "experiments": shown.iter().map(experiment).collect::<Vec<_>>(),
        "free_form": {"demands": DemandKind::ALL.map(demand), "parameters": free_form::PARAMETERS},
    })
}

fn overview(shown: &[&Template], terminal: &mut Terminal) {
    let mut table = Table::new(&[("experiment", Align::Left), ("gives", Align::Left)]);
    for template in shown {
        table.row([template.label().to_string().into(), template.gives.into()]);
        table.note(&format!("{}. {}.", template.demands, names(&template.parameters())));
    }
    terminal.table(&table);
    terminal.gap();
    terminal.paragraph(
        "A label is {test}_{T|N}_{mode}: what is excited, torque or speed; NT: the dynamometer controls speed, TN: torque.",
    );
    terminal.paragraph("Parameters, with units and ranges: dynoid experiment list NAME");
    terminal.paragraph(&format!(
        "Demands of your own: a file with columns {}, in place of a name",
        DemandKind::ALL.map(|kind| format!("{} [{}]", kind.name(), kind.unit())).join(", ")
    ));
}

fn names(parameters: &[Parameter]) -> String {
    let name = |p: &Parameter| format!("{} {}", p.name, with_unit(p.default, p.unit));
    parameters.iter().map(name).collect::<Vec<_>>().join(", ")
}

fn with_unit(value: f64, unit: &str) -> String {
    if unit.is_empty() { value.to_string() } else { format!("{value} {unit}") }
}

fn detail(template: &Template, terminal: &mut Terminal) {
    terminal.heading(&template.label().to_string(), Tone::Strong);
    terminal.paragraph(&format!("Demands: {}.", template.demands));
    terminal.paragraph(&format!("Gives: {}.", template.gives));
    terminal.gap();
    let mut table = Table::new(&[
        ("parameter", Align::Left),
        ("default", Align::Right),
        ("from", Align::Right),
        ("to", Align::Right),
        ("unit", Align::Left),
        ("what it is", Align::Left),
    ]);
    for parameter in template.parameters() {
        table.row([
            parameter.name.into(),
            parameter.default.to_string().into(),
            parameter.lowest.to_string().into(),
            parameter.highest.to_string().into(),
            parameter.unit.into(),
            parameter.meaning.into(),
        ]);
    }
    terminal.table(&table);
    terminal.gap();
    terminal.line("speed and duration have options of their own; the others are given as --set NAME=VALUE");
}
