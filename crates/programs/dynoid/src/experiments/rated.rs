//! Experiments to record next: their gains beside their safety.

use design::safety::{Safety, SafetyCheck};
use report::next::{reasons, recommendation};
use report::wording;
use rig::experiment::catalogue::{self, Parameter};
use serde::Serialize;
use signal::proportion::Proportion;
use study::{Candidate, NextOptions, rated_experiments, rated_plan};
use work::Context;

use super::planned::{Given, Planned};
use crate::error::Error;
use crate::files::Files;
use crate::limits::{MovableFacts, OtherLimits};
use crate::session::Session;

/// Speed and length of an experiment that states none.
const USUAL: NextOptions = NextOptions { speed_rpm: 1200.0, duration_s: 60.0, enough: 0.01, seed: 1 };

/// Experiments with their gains, and the probability that each keeps every limit.
#[derive(Debug)]
pub struct RatedExperiments {
    /// Recommendation in a sentence or two; empty for an experiment of one's own.
    recommendation: String,
    enough: f64,
    limits: Vec<MovableFacts>,
    rated: Vec<(Candidate, Option<SafetyCheck>)>,
}

impl RatedExperiments {
    /// Those of the method, as [`Session::next`] tries them, by the limits of the bench file or others.
    ///
    /// # Errors
    /// Those of [`Session::next`], and a limit that is no positive number.
    pub fn of_the_method(
        session: &Session,
        limits: &OtherLimits,
        options: NextOptions,
        context: &Context,
    ) -> Result<Self, Error> {
        let bench = session.limited(limits)?;
        let found = rated_experiments(&bench, session.prepared(), options, context);
        let (found, checks) = found.map_err(|error| Error::of_next(session.bench().path(), error))?;
        let recommendation = recommendation(&found);
        let rated = found.candidates.into_iter().zip(checks).collect();
        let limits = MovableFacts::all(&session.bench().file().limits);
        Ok(RatedExperiments { limits, recommendation, enough: options.enough, rated })
    }

    /// One experiment with numbers of one's own.
    ///
    /// # Errors
    /// The same, and an experiment or a number that is not known.
    pub fn of_one(
        session: &Session,
        limits: &OtherLimits,
        experiment: &str,
        given: &[Given],
        files: &Files,
        context: &Context,
    ) -> Result<Self, Error> {
        let planned = Planned::find(experiment, given, files, context)?;
        let bench = session.limited(limits)?;
        let options = NextOptions { speed_rpm: planned.speed_rpm.unwrap_or(USUAL.speed_rpm), ..USUAL };
        let rated = rated_plan(&bench, session.prepared(), &planned.plan, options, context);
        let rated = rated.map_err(|error| Error::of_next(session.bench().path(), error))?;
        let rated = vec![(rated.candidate, rated.check)];
        let limits = MovableFacts::all(&session.bench().file().limits);
        Ok(RatedExperiments { limits, recommendation: String::new(), enough: options.enough, rated })
    }

    /// The experiments in numbers and words.
    pub fn facts(&self) -> RatedFacts<'_> {
        RatedFacts {
            recommendation: &self.recommendation,
            limits: &self.limits,
            experiments: self.rated.iter().map(|(one, check)| self.one(one, check.as_ref())).collect(),
        }
    }

    fn one(&self, candidate: &Candidate, check: Option<&SafetyCheck>) -> RatedFact {
        let new = candidate.gains.iter().filter(|gain| gain.now.is_none()).map(|gain| gain.quantity.symbol());
        let reached = check.into_iter().flat_map(|check| &check.checked).filter_map(|one| {
            let reached = one.reached.filter(|reached| reached.count > 0)?;
            Some(ReachedFact { name: wording::quantity(one.of).0, reached })
        });
        let unchecked = check.into_iter().flat_map(|check| &check.unchecked).map(|of| wording::quantity(*of).0);
        RatedFact {
            label: candidate.label.to_string(),
            is_designed: candidate.is_designed,
            speed_rpm: candidate.speed_rpm,
            duration_s: candidate.duration_s,
            peak_shaft_torque_nm: candidate.peak_shaft_torque_nm,
            narrowing: candidate.narrowing(self.enough),
            new: new.collect(),
            gains: reasons(candidate),
            safety: candidate.safety,
            kept: check.map(|check| Proportion::new(check.any.of - check.any.count, check.any.of)),
            reached: reached.collect(),
            unchecked: unchecked.collect(),
            parameters: catalogue::of(&candidate.label).map(|of| of.parameters()).unwrap_or_default(),
        }
    }
}

/// Numbers of [`RatedExperiments`].
#[derive(Debug, Serialize)]
pub struct RatedFacts<'a> {
    recommendation: &'a str,
    /// Limits of the bench file, which can be moved.
    limits: &'a [MovableFacts],
    experiments: Vec<RatedFact>,
}

/// One experiment.
#[derive(Debug, Serialize)]
struct RatedFact {
    label: String,
    is_designed: bool,
    speed_rpm: f64,
    duration_s: f64,
    peak_shaft_torque_nm: f64,
    /// The factor by which intervals that are too wide get narrower, all factors multiplied.
    narrowing: f64,
    /// Numbers that no recording shows yet.
    new: Vec<&'static str>,
    gains: String,
    safety: Option<Safety>,
    /// How many benches like this one reach no limit; none where the experiment was not checked.
    kept: Option<Proportion>,
    reached: Vec<ReachedFact>,
    unchecked: Vec<&'static str>,
    /// Numbers that can be given to it.
    parameters: Vec<Parameter>,
}

/// A limit that some benches reach.
#[derive(Debug, Serialize)]
struct ReachedFact {
    name: &'static str,
    reached: Proportion,
}
