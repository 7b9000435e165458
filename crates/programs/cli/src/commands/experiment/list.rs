//! `dynoid experiment list`: the experiments of the method, and the shapes of `dynoid can`.

use capability::shapes::{self, Shape};
use report::catalogue::{experiment, overview, shape};
use rig::experiment::catalogue::{self, Parameter, Template};
use rig::experiment::{DemandKind, free_form};
use serde::Serialize;

use crate::cli::experiment::ListArguments;
use crate::commands::result::Sorted;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &ListArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let shown = Shown::of(arguments.name.as_deref())?;
    if arguments.json {
        terminal.json(&Sorted(facts(&shown)))?;
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

/// The list in numbers.
#[derive(Serialize)]
struct Facts {
    experiments: Vec<ExperimentFacts>,
    shapes: Vec<ShapeFacts>,
    free_form: FreeFormFacts,
}

#[derive(Serialize)]
struct ExperimentFacts {
    label: String,
    demands: &'static str,
    gives: &'static str,
    parameters: Vec<Parameter>,
}

#[derive(Serialize)]
struct ShapeFacts {
    name: &'static str,
    demands: &'static str,
    parameters: &'static [Parameter],
}

#[derive(Serialize)]
struct FreeFormFacts {
    demands: Vec<DemandFacts>,
    parameters: &'static [Parameter],
}

#[derive(Serialize)]
struct DemandFacts {
    name: &'static str,
    unit: &'static str,
}

fn facts(shown: &Shown) -> Facts {
    let experiment = |template: &&Template| ExperimentFacts {
        label: template.label().to_string(),
        demands: template.demands,
        gives: template.gives,
        parameters: template.parameters(),
    };
    let shape = |shape: &Shape| ShapeFacts { name: shape.name, demands: shape.demands, parameters: shape.parameters };
    let demand = |kind: DemandKind| DemandFacts { name: kind.name(), unit: kind.unit() };
    Facts {
        experiments: shown.templates.iter().map(experiment).collect(),
        shapes: shown.shapes.iter().map(shape).collect(),
        free_form: FreeFormFacts { demands: DemandKind::ALL.map(demand).into(), parameters: free_form::PARAMETERS },
    }
}
