//! `dynoid controller`: the speed controller.

mod noise_test;

use dynoid::analyses;
use part_controller::speed_controller::{ControllerRecording, FeedForwardRecording, SpeedControl};
use rig::results::Validation;
use serde_json::{Value, json};

use super::experiments::{self, Campaign};
use super::result::show;
use crate::cli::GivenRecordings;
use crate::cli::controller::{ControllerArguments, ControllerCommand};
use crate::cli::identify::ResultArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &ControllerArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    match (&arguments.command, &arguments.given) {
        (Some(ControllerCommand::NoiseTest(arguments)), _) => noise_test::run(arguments, terminal),
        (None, Some(given)) => identify(given, &arguments.result, terminal),
        (None, None) => {
            Err(CliError::Usage { what: "name a bench file; `dynoid controller --help` has examples".into() })
        }
    }
}

fn identify(given: &GivenRecordings, result: &ResultArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let Campaign { bench, experiments, refused } = experiments::all(given, result, terminal)?;
    let found = analyses::controller(&experiments, &bench, terminal.work());
    if found.controllers.is_empty() {
        return Err(CliError::NoHeldSpeed { path: given.bench.clone() });
    }
    let page = || report::pages::controller(&found);
    let json = || short(&found, &refused);
    show(result, page, json, terminal)?;
    let tells = found.controllers.iter().any(|one| one.found.estimated().is_some());
    Ok(Outcome::of(tells, &refused))
}

/// The results without the samples of T_d*.
fn short(found: &SpeedControl, refused: &[String]) -> Value {
    let controllers: Vec<Value> = found.controllers.iter().map(short_controller).collect();
    let feed_forward: Vec<Value> = found.feed_forward.iter().map(short_feed_forward).collect();
    json!({"controllers": controllers, "feed_forward": feed_forward, "limits": found.limits, "refused": refused})
}

fn short_controller(one: &ControllerRecording) -> Value {
    let found = one.found.written_as(|c| {
        json!({
            "with_delay": c.with_delay, "without_delay": c.without_delay,
            "validation": without_traces(&c.validation),
            "validation_without_delay": without_traces(&c.validation_without_delay),
            "si": report::controller::gains_in_si(c).collect::<Vec<_>>(), "discrete": c.discrete, "structure": c.structure.written(),
        })
    });
    json!({"file": one.file, "label": one.label, "found": found})
}

fn short_feed_forward(one: &FeedForwardRecording) -> Value {
    let found = one.found.written_as(|f| {
        json!({
            "estimate": f.straight.estimate, "validation": without_traces(&f.straight.validation),
            "pi_alone": without_traces(&f.straight.pi_alone), "terms": f.terms.written(),
        })
    });
    json!({"file": one.file, "label": one.label, "found": found})
}

fn without_traces(validation: &Validation) -> Value {
    json!({
        "stretch": validation.stretch, "quantity": validation.quantity, "unit": validation.unit,
        "fit_percent": validation.fit_percent, "rms_error": validation.rms_error, "residuals": validation.residuals,
        "share_outside": validation.residuals.as_ref().map(rig::results::ResidualTest::share_outside),
    })
}
