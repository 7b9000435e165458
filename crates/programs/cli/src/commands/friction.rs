//! `dynoid friction`: friction and inertia of the dynamometer.

use dynoid::Error;
use dynoid::facts::FrictionFacts;
use part_friction::{FrictionOptions, estimate};
use report::friction::doubts;
use rig::Experiment;
use rig::facts::StatedInertia;
use serde::Serialize;
use units::RPM_RAD_S;

use super::experiments::{self, WithRefused};
use super::result::show;
use crate::cli::friction::FrictionArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &FrictionArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let mut used: Vec<Experiment> = Vec::new();
    let mut options = FrictionOptions { inertia_kg_m2: f64::NAN, slowest_rad_s: None, torque_limit_nm: None };
    let mut stated = StatedInertia::of_dynamometer(f64::NAN, None);
    let all_named = !arguments.given.recordings.is_empty();
    let refused = experiments::each(&arguments.given, &arguments.result, "reading", terminal, |bench, experiment| {
        let slowest_rad_s = arguments.slowest.map(|rpm| rpm * RPM_RAD_S);
        options = FrictionOptions { slowest_rad_s, ..FrictionOptions::of(bench) };
        stated = bench.dynamometer_inertia();
        // Of a whole campaign those without shaft are meant; a recording that is named is meant whatever it is.
        if all_named || experiment.label.is_without_shaft() {
            used.push(experiment);
        }
    })?;
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
