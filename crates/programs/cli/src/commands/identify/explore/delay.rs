//! `dynoid data delay`: dead times beside dynamics, and what other methods say.

use dataset::CommonClock;
use dynoid::linear::{Gaps, Loaded, check_movement};
use ident::Dataset;
use toolbox_report::delay::{Delays, Known, spacing};

use super::super::data::{read, say};
use crate::cli::identify::DelayArguments;
use crate::commands::result::{Sorted, check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// Delays that are tried by default, in samples.
const LONGEST: usize = 30;

/// `dynoid data delay`
pub(crate) fn delay(arguments: &DelayArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &terminal.files())?;
    if arguments.data.inputs.is_empty() {
        return Err(CliError::Usage { what: "a delay is one from an input: name it with --input".into() });
    }
    let options = arguments.data.options();
    let loaded = Loaded::take(&read(&options, terminal)?, CommonClock::Fastest, &options)?;
    check_movement(&loaded)?;
    let spacing = spacing(&loaded.data);
    let loaded = loaded.cut_at(Gaps::OfInputs)?;
    say(&loaded.notes, &mut Vec::new(), terminal);
    let longest = longest(&loaded.data, arguments.longest)?;
    let known = Known {
        adjustments: &loaded.adjustments,
        spacing,
        clock_is_given: arguments.data.sample_time_s.is_some(),
        between_is_given: arguments.data.between.is_some(),
    };
    let found = Delays::of(loaded.data, &known, longest, terminal.work());
    let found = found.map_err(|source| CliError::identify("the delay", source))?;
    show(&arguments.result, || found.page(), || Sorted(found.facts()), terminal)?;
    Ok(Outcome::Done)
}

/// The longest delay to look for: what was asked for, or what the data allow.
fn longest(data: &Dataset, given: Option<usize>) -> Result<usize, CliError> {
    let samples = data.experiments().iter().map(|e| e.len()).max().unwrap_or(0);
    let Some(longest) = given else { return Ok(LONGEST.min(samples / 4).max(1)) };
    if longest == 0 || longest >= samples / 2 {
        let what = format!("--longest {longest}: give at least 1, and less than half of the {samples} samples on end");
        return Err(CliError::Usage { what });
    }
    Ok(longest)
}
