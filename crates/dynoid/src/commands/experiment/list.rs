//! `dynoid experiment list`: the experiments of the method.

use report::catalogue::{experiment, overview};
use rig::experiment::catalogue::{self, Template};
use rig::experiment::{DemandKind, free_form};

use crate::cli::experiment::ListArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &ListArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let found = arguments.name.as_deref().map(catalogue::find).transpose();
    let one = found.map_err(|error| CliError::Usage { what: error.to_string() })?;
    let shown: Vec<&Template> = one.map_or_else(|| catalogue::all().iter().collect(), |template| vec![template]);
    if arguments.json {
        terminal.json(&json(&shown))?;
    } else {
        terminal.page(&one.map_or_else(|| overview(&shown), experiment));
    }
    Ok(Outcome::Done)
}

fn json(shown: &[&Template]) -> serde_json::Value {
    let one = |template: &&Template| {
        serde_json::json!({"label": template.label().to_string(), "demands": template.demands,
            "gives": template.gives, "parameters": template.parameters()})
    };
    let demand = |kind: DemandKind| serde_json::json!({"name": kind.name(), "unit": kind.unit()});
    serde_json::json!({
        "experiments": shown.iter().map(one).collect::<Vec<_>>(),
        "free_form": {"demands": DemandKind::ALL.map(demand), "parameters": free_form::PARAMETERS},
    })
}
