//! `dynoid experiment check`: whether an experiment is safe.

use dynoid::experiments::CheckedExperiment;

use super::planned::{self, WithDoubts};
use crate::cli::experiment::CheckArguments;
use crate::commands::result::{Sorted, check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &CheckArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.on.result, &terminal.files())?;
    let bench = planned::known(&arguments.on, terminal)?;
    let plan = planned::plan(&arguments.experiment, &arguments.on.plan, terminal)?.plan;
    let doubts = planned::doubts(&plan, &bench, terminal);
    let found = CheckedExperiment::of(&bench, plan, arguments.on.draws(arguments.samples), terminal.work())?;
    let json = || Sorted(WithDoubts { facts: found.facts(), doubts: &doubts });
    show(&arguments.on.result, || bench.on_page(found.page()), json, terminal)?;
    Ok(if found.is_safe(arguments.allow_unchecked) { Outcome::Done } else { Outcome::NotSafe })
}
