//! The speed controller without the samples of T_d*.

use part_controller::speed_controller::{
    Controller, ControllerRecording, Discrete, FeedForwardFound, FeedForwardRecording, LimitRecording, SpeedControl,
};
use part_controller::speed_controller::{FeedForwardTerms, Structure};
use rig::ExperimentLabel;
use rig::results::{Estimate, Found, ResidualTest, Stretch, Validation, WrittenParameter};
use serde::Serialize;

/// The speed controller of each recording, and its feed-forward.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SpeedControlFacts<'a> {
    controllers: Vec<ControllerFacts<'a>>,
    feed_forward: Vec<FeedForwardFacts<'a>>,
    limits: &'a [LimitRecording],
}

impl<'a> SpeedControlFacts<'a> {
    /// Of an analysis.
    pub fn of(found: &'a SpeedControl) -> Self {
        SpeedControlFacts {
            controllers: found.controllers.iter().map(ControllerFacts::of).collect(),
            feed_forward: found.feed_forward.iter().map(FeedForwardFacts::of).collect(),
            limits: &found.limits,
        }
    }
}

/// The controller of one recording.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ControllerFacts<'a> {
    file: &'a str,
    label: &'a ExperimentLabel,
    found: Found<'a, FoundController<'a>>,
}

impl<'a> ControllerFacts<'a> {
    /// Of the results of a recording.
    pub fn of(one: &'a ControllerRecording) -> Self {
        let found = one.found.written_as(|found| FoundController::of(found));
        ControllerFacts { file: &one.file, label: &one.label, found }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct FoundController<'a> {
    with_delay: &'a Estimate,
    without_delay: &'a Estimate,
    validation: ValidationFacts<'a>,
    validation_without_delay: ValidationFacts<'a>,
    si: Vec<WrittenParameter>,
    discrete: &'a Discrete,
    structure: Found<'a, &'a Structure>,
}

impl<'a> FoundController<'a> {
    fn of(found: &'a Controller) -> Self {
        FoundController {
            with_delay: &found.with_delay,
            without_delay: &found.without_delay,
            validation: ValidationFacts::of(&found.validation),
            validation_without_delay: ValidationFacts::of(&found.validation_without_delay),
            si: report::controller::gains_in_si(found).collect(),
            discrete: &found.discrete,
            structure: found.structure.written(),
        }
    }
}

/// The feed-forward of one recording.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct FeedForwardFacts<'a> {
    file: &'a str,
    label: &'a ExperimentLabel,
    found: Found<'a, FoundFeedForward<'a>>,
}

impl<'a> FeedForwardFacts<'a> {
    fn of(one: &'a FeedForwardRecording) -> Self {
        let found = one.found.written_as(|found| FoundFeedForward::of(found));
        FeedForwardFacts { file: &one.file, label: &one.label, found }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct FoundFeedForward<'a> {
    estimate: &'a Estimate,
    validation: ValidationFacts<'a>,
    pi_alone: ValidationFacts<'a>,
    terms: Found<'a, &'a FeedForwardTerms>,
}

impl<'a> FoundFeedForward<'a> {
    fn of(found: &'a FeedForwardFound) -> Self {
        FoundFeedForward {
            estimate: &found.straight.estimate,
            validation: ValidationFacts::of(&found.straight.validation),
            pi_alone: ValidationFacts::of(&found.straight.pi_alone),
            terms: found.terms.written(),
        }
    }
}

/// A validation without its traces.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct ValidationFacts<'a> {
    stretch: &'a Stretch,
    quantity: &'a str,
    unit: &'a str,
    fit_percent: f64,
    rms_error: f64,
    residuals: &'a Option<ResidualTest>,
    share_outside: Option<f64>,
}

impl<'a> ValidationFacts<'a> {
    fn of(validation: &'a Validation) -> Self {
        ValidationFacts {
            stretch: &validation.stretch,
            quantity: &validation.quantity,
            unit: &validation.unit,
            fit_percent: validation.fit_percent,
            rms_error: validation.rms_error,
            residuals: &validation.residuals,
            share_outside: validation.residuals.as_ref().map(ResidualTest::share_outside),
        }
    }
}
