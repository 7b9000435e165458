//! From the command line to a plan.

use std::path::Path;

use dynoid::{InputFile, paths};
use recording::Selection;
use rig::experiment::catalogue::{self, CatalogueError, Parameter, Settings};
use rig::experiment::{ExperimentPlan, free_form};
use rig::{BenchFile, ControlMode};

use crate::cli::experiment::PlanArguments;
use crate::error::CliError;
use crate::terminal::Terminal;

/// A plan, and the speed that its files are named by.
pub(in crate::commands) struct Planned {
    pub(in crate::commands) plan: ExperimentPlan,
    /// None where the demands are one's own.
    pub(in crate::commands) speed_rpm: Option<f64>,
}

/// The plan of an experiment by name, or of a file of demands.
pub(in crate::commands) fn plan(
    experiment: &str,
    arguments: &PlanArguments,
    terminal: &mut Terminal,
) -> Result<Planned, CliError> {
    let path = Path::new(experiment);
    match catalogue::find(experiment) {
        Ok(template) => {
            let settings = settings(experiment, &template.parameters(), arguments)?;
            let plan = template.plan(&settings).map_err(|error| usage(experiment, error))?;
            Ok(Planned { plan, speed_rpm: Some(settings.get("speed")) })
        }
        Err(unknown) if !path.exists() && paths::ending(path).is_none() => Err(usage(experiment, unknown)),
        Err(_) => Ok(Planned { plan: from_file(path, arguments, terminal)?, speed_rpm: None }),
    }
}

/// The numbers that were given to an experiment with these parameters.
pub(super) fn settings(
    experiment: &str,
    parameters: &[Parameter],
    arguments: &PlanArguments,
) -> Result<Settings, CliError> {
    let given = given(arguments)?;
    let given: Vec<(&str, &str)> = given.iter().map(|(name, value)| (name.as_str(), value.as_str())).collect();
    Settings::parse(parameters, &given).map_err(|error| usage(experiment, error))
}

fn from_file(path: &Path, arguments: &PlanArguments, terminal: &mut Terminal) -> Result<ExperimentPlan, CliError> {
    let name = paths::with_slashes(path);
    let settings = settings(&name, free_form::PARAMETERS, arguments)?;
    let file = InputFile { path: path.to_owned(), name: name.clone() };
    let step = terminal.work().step(format!("reading {name}"), 0);
    let read = terminal.files().read_recording(&file, &Selection::All, None, &step)?;
    drop(step);
    let free = free_form::plan(&name, &read.recording, &settings)
        .map_err(|source| CliError::Demands { path: path.to_owned(), source })?;
    if !free.ignored.is_empty() {
        terminal.warning(&format!("{name}: no demands, and left out: {}", free.ignored.join(", ")));
    }
    Ok(free.plan)
}

fn usage(experiment: &str, error: CatalogueError) -> CliError {
    let remedy = match error {
        CatalogueError::UnknownExperiment { .. } => {
            "; `dynoid experiment list` shows all, and a file of demands will do too"
        }
        _ => "",
    };
    CliError::Usage { what: format!("{experiment}: {error}{remedy}") }
}

/// Names and values that were given, in either way.
pub(in crate::commands) fn given(arguments: &PlanArguments) -> Result<Vec<(String, String)>, CliError> {
    let number = |name: &str, value: Option<f64>| value.map(|value| (name.to_owned(), value.to_string()));
    let mut given: Vec<(String, String)> =
        [number("speed", arguments.speed), number("duration", arguments.duration)].into_iter().flatten().collect();
    for text in &arguments.set {
        let Some((name, value)) = text.split_once('=') else {
            return Err(CliError::Usage {
                what: format!("--set {text}: write it as NAME=VALUE, such as --set low=35"),
            });
        };
        given.push((name.to_owned(), value.to_owned()));
    }
    Ok(given)
}

/// Doubts about this plan on this bench, before it is run.
pub(in crate::commands) fn doubts(plan: &ExperimentPlan, file: &BenchFile) -> Vec<String> {
    let mut doubts = Vec::new();
    if let Some((level_s, firing_s)) = plan.switches_within_a_firing(file.engine()) {
        doubts.push(format!(
            "the engine's torque is switched every {:.0} ms, but a cylinder fires every {:.0} ms only: raise clock, as with \
             --set clock={:.2}",
            1e3 * level_s,
            1e3 * firing_s,
            (1.2 * firing_s * 100.0).ceil() / 100.0
        ));
    }
    if plan.label.mode == ControlMode::Tn && plan.is_motored {
        doubts.push("the engine is motored and does not hold its speed in TN: the speed will run away".to_owned());
    }
    doubts
}
