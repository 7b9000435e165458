//! `dynoid experiment list`: the experiments of the method, and the shapes of `dynoid can`.

use capability::shapes::{self, Shape};
use report::catalogue::{experiment, overview, shape};
use rig::experiment::catalogue::{self, Template};
use rig::experiment::{DemandKind, free_form};

use crate::cli::experiment::ListArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &ListArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let shown = Shown::of(arguments.name.as_deref())?;
    if arguments.json {
        terminal.json(&json(&shown))?;
        return Ok(Outcome::Done);
    }
    terminal.page(&match (&shown.templates[..], &shown.shapes[..]) {
        ([template], []) => experiment(template),
        ([], [only]) => shape(only),
        (templates, shapes) => overview(templates, shapes),
    });
    Ok(Outcome::Done)
}

/// List that is shown.
struct Shown {
    templates: Vec<&'static Template>,
    shapes: Vec<Shape>,
}

impl Shown {
    /// All, or the one with a name.
    fn of(name: Option<&str>) -> Result<Self, CliError> {
        let Some(name) = name else {
            return Ok(Shown { templates: catalogue::all().iter().collect(), shapes: shapes::ALL.to_vec() });
        };
        match (catalogue::find(name), shapes::find(name)) {
            (Ok(template), _) => Ok(Shown { templates: vec![template], shapes: Vec::new() }),
            (_, Some(shape)) => Ok(Shown { templates: Vec::new(), shapes: vec![*shape] }),
            (Err(error), None) => {
                let names = shapes::ALL.map(|shape| shape.name).join(", ");
                Err(CliError::Usage { what: format!("{error}; shapes of `dynoid can` are {names}") })
            }
        }
    }
}

fn json(shown: &Shown) -> serde_json::Value {
    let one = |template: &&Template| {
        serde_json::json!({"label": template.label().to_string(), "demands": template.demands,
            "gives": template.gives, "parameters": template.parameters()})
    };
    let shape = |shape: &Shape| serde_json::json!({"name": shape.name, "demands": shape.demands, "parameters": shape.parameters});
    let demand = |kind: DemandKind| serde_json::json!({"name": kind.name(), "unit": kind.unit()});
    serde_json::json!({
        "experiments": shown.templates.iter().map(one).collect::<Vec<_>>(),
        "shapes": shown.shapes.iter().map(shape).collect::<Vec<_>>(),
        "free_form": {"demands": DemandKind::ALL.map(demand), "parameters": free_form::PARAMETERS},
    })
}
