//! `dynoid friction`: friction and inertia of the dynamometer.

use dynoid::Error;
use dynoid::facts::FrictionFacts;
use part_friction::{FrictionOptions, estimate};
use report::friction::doubts;
use rig::Experiment;
use serde::Serialize;
use units::RPM_RAD_S;

use super::experiments::{self, WithRefused};
use super::result::show;
use crate::cli::friction::FrictionArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &FrictionArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let recordings = experiments::find(&arguments.given, &arguments.result, terminal)?;
    let mut used: Vec<Experiment> = Vec::new();
    let all_named = !arguments.given.recordings.is_empty();
    let refused = experiments::each(&recordings, "reading", terminal, |experiment| {
        // Of a whole campaign those without shaft are meant; a recording that is named is meant whatever it is.
        if all_named || experiment.label.is_without_shaft() {
            used.push(experiment);
        }
    })?;
    let slowest_rad_s = arguments.slowest.map(|rpm| rpm * RPM_RAD_S);
    let options = FrictionOptions { slowest_rad_s, ..FrictionOptions::of(recordings.bench()) };
    let stated = recordings.bench().dynamometer_inertia();
    let found = estimate(&used.iter().collect::<Vec<_>>(), options).map_err(Error::from)?;
    let doubts = doubts(&found, stated);
    doubts.iter().for_each(|doubt| terminal.warning(doubt));
    let page = || report::pages::friction(&found, stated);
    let json = || {
        let facts = Facts { friction: FrictionFacts::of(&found), doubts: &doubts };
        WithRefused::sorted(facts, &refused)
    };
    show(&arguments.result, page, json, terminal)?;
    Ok(if refused.is_empty() { Outcome::Done } else { Outcome::SomeUnreadable })
}

/// Friction in numbers, with the doubts about it.
#[derive(Serialize)]
struct Facts<'a> {
    #[serde(flatten)]
    friction: FrictionFacts<'a>,
    doubts: &'a [String],
}
