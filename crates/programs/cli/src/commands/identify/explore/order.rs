//! `dynoid data order`: orders and delay of ARX models.

use std::ops::RangeInclusive;

use dataset::CommonClock;
use dynoid::linear::{Gaps, check_movement};
use ident::OrderScan;
use toolbox_report::order::Orders;

use super::super::data::load_between_gaps;
use crate::cli::identify::OrderArguments;
use crate::commands::result::{Sorted, check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// Structures compared, at most.
const MOST: usize = 100_000;

/// `dynoid data order`
pub(crate) fn order(arguments: &OrderArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &terminal.files())?;
    let ranges = [range("--na", &arguments.na)?, range("--nb", &arguments.nb)?, range("--nk", &arguments.nk)?];
    let [na, nb, nk] = ranges.clone();
    let scan = OrderScan::new(na, nb, nk);
    check_size(scan.structures(), arguments)?;
    let loaded = load_between_gaps(CommonClock::Slowest, Gaps::OfInputs, &arguments.data, terminal)?;
    check_movement(&loaded)?;
    let data = loaded.data;
    let failed = |source| CliError::identify("the order scan", source);
    let table = match arguments.split {
        Some(share) => {
            let split = data.split(share).map_err(failed)?;
            scan.run_as_step(terminal.work(), &split.estimation, Some(&split.validation))
        }
        None => scan.run_as_step(terminal.work(), &data, None),
    };
    let table = table.map_err(failed)?;
    let orders = Orders { table, ranges, is_validated: arguments.split.is_some() };
    show(&arguments.result, || orders.page(), || Sorted(orders.facts()), terminal)?;
    Ok(Outcome::Done)
}

/// Refuses more structures than can be compared in good time.
fn check_size(structures: usize, arguments: &OrderArguments) -> Result<(), CliError> {
    if structures <= MOST {
        return Ok(());
    }
    let OrderArguments { na, nb, nk, .. } = arguments;
    let what = format!(
        "--na {na} --nb {nb} --nk {nk} are {structures} structures, and at most {MOST} are compared: find the delay first, \
         with `dynoid data delay`, and give a narrow --nk about it, or shorter ranges of orders"
    );
    Err(CliError::Usage { what })
}

fn range(option: &str, text: &str) -> Result<RangeInclusive<usize>, CliError> {
    let (first, last) = text.split_once(':').unwrap_or((text, text));
    match (first.trim().parse(), last.trim().parse()) {
        (Ok(first), Ok(last)) if first <= last => Ok(first..=last),
        _ => Err(CliError::Usage { what: format!("{option} {text}: give a number, or a range such as 1:6") }),
    }
}
