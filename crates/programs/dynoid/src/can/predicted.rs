//! Answers of a model.

use capability::{Answer, CanInputs, CapabilityError, Easier, FollowingSpread, LimitOf, Verdict, can, easier};
use cycle::RequirementSet;
use design::safety::{ASSUMED_ENGINE, FrictionSpread};
use page::{Finding, Page};
use report::can::{Asked, answer};
use rig::engine_pulses::KnownPulses;
use virtual_bench::Assumption;
use work::Context;

use super::facts::{BeyondFacts, EasierFacts, LimitFacts, OwnFacts, PredictedFacts, SetFacts};
use super::requirements::Requirements;
use super::test::{Test, What};
use crate::error::Error;
use crate::known::{Draws, KnownBench, PulsesFrom};

/// The answer to whether a bench can run a test.
#[derive(Debug, Clone)]
pub struct Predicted {
    test: String,
    duration_s: f64,
    verdict: Verdict,
    easier: Vec<Easier>,
    sets: Vec<RequirementSet>,
    has_study: bool,
    is_cycle: bool,
    pulses: KnownPulses,
    assumptions: Vec<Assumption>,
    friction: FrictionSpread,
    following: Option<FollowingSpread>,
}

impl Predicted {
    /// Runs a test on many benches, drawn from what is known of this one. A no comes with changes that would make it a
    /// yes.
    ///
    /// # Errors
    /// A bench or a test that cannot be predicted.
    pub fn of(
        bench: &KnownBench,
        test: &Test,
        wanted: &Requirements,
        draws: Draws,
        context: &Context,
    ) -> Result<Self, Error> {
        let run = |inputs: &CanInputs<'_>| Ok((can(inputs, context)?, ()));
        Self::by(bench, test, wanted, draws, run, context).map(|(predicted, ())| predicted)
    }

    /// The same, by a run that gives more than the verdict.
    pub(super) fn by<T>(
        bench: &KnownBench,
        test: &Test,
        wanted: &Requirements,
        draws: Draws,
        run: impl FnOnce(&CanInputs<'_>) -> Result<(Verdict, T), CapabilityError>,
        context: &Context,
    ) -> Result<(Self, T), Error> {
        let stated = bench.virtual_bench();
        let (model, assumptions) = match &test.what {
            What::Plan { plan, .. } => (bench.model_for(plan), stated.assumed_for(plan)),
            What::Cycle { .. } => (bench.model_with_shaft(), stated.assumptions.clone()),
        };
        let model = model.map_err(|reason| bench.refused(reason))?;
        let is_assumed = bench.assumes_engine();
        let inputs = CanInputs {
            demand: test.demand(),
            model: &model,
            engine: &stated.parameters.engine,
            pulses: &stated.pulses,
            limits: bench.file().limits,
            validity: bench.validity(),
            spread: bench.spread(),
            slowest_engine_control: if is_assumed { ASSUMED_ENGINE } else { 1.0 },
            friction: bench.friction(),
            disturbances: bench.disturbances(),
            following: if is_assumed { FollowingSpread::ASSUMED } else { FollowingSpread::NONE },
            filter_hz: None,
            sets: &wanted.sets,
            own: &wanted.own,
            samples: draws.benches,
            seed: draws.seed,
        };
        let (verdict, more) = run(&inputs).map_err(|error| bench.refused(error))?;
        let easier = match verdict.answer {
            Answer::No => easier(&inputs, context).map_err(|error| bench.refused(error))?,
            Answer::Yes | Answer::Perhaps | Answer::NotShown | Answer::NotJudged => Vec::new(),
        };
        let predicted = Predicted {
            test: test.title().to_owned(),
            duration_s: test.duration_s(),
            easier,
            sets: wanted.sets.clone(),
            has_study: bench.assembled().is_some(),
            is_cycle: test.is_cycle(),
            pulses: stated.pulses.clone(),
            assumptions,
            friction: inputs.friction,
            following: Some(inputs.following).filter(|_| is_assumed && inputs.is_torque_demanded()),
            verdict,
        };
        Ok((predicted, more))
    }

    /// The same test with another verdict on its runs; changes that would make a no a yes were not looked for.
    pub(super) fn with_verdict(&self, verdict: Verdict) -> Self {
        Predicted {
            verdict,
            test: self.test.clone(),
            easier: Vec::new(),
            sets: self.sets.clone(),
            pulses: self.pulses.clone(),
            assumptions: self.assumptions.clone(),
            ..*self
        }
    }

    /// The verdict, with all its numbers.
    pub fn verdict(&self) -> &Verdict {
        &self.verdict
    }

    /// Changes that would make a no a yes.
    pub fn easier(&self) -> &[Easier] {
        &self.easier
    }

    /// The answer as a sentence.
    pub fn sentence(&self) -> String {
        answer(&self.verdict)
    }

    /// Limits that the bench file does not state, so that they were not checked.
    pub fn unchecked(&self) -> &[LimitOf] {
        &self.verdict.unchecked
    }

    /// Tells whether nothing speaks against the test. One that no limit and no requirement judges is not refused.
    pub fn is_yes(&self) -> bool {
        matches!(self.verdict.answer, Answer::Yes | Answer::NotJudged)
    }

    /// The answer as a page; [`KnownBench::on_page`] adds the bench.
    pub fn page(&self) -> Page {
        report::can::predicted(&self.asked())
    }

    /// The basis of the answer.
    pub(super) fn rests_on(&self) -> Vec<Finding> {
        report::can::rests_on(&self.asked())
    }

    fn asked(&self) -> Asked<'_> {
        Asked {
            test: &self.test,
            duration_s: self.duration_s,
            verdict: &self.verdict,
            easier: &self.easier,
            sets: &self.sets,
            has_study: self.has_study,
            is_cycle: self.is_cycle,
            pulses: &self.pulses,
            assumptions: &self.assumptions,
            friction: self.friction,
            following: self.following,
        }
    }

    /// The answer in numbers.
    pub fn facts(&self) -> PredictedFacts<'_> {
        let verdict = &self.verdict;
        PredictedFacts {
            test: &self.test,
            duration_s: self.duration_s,
            answer: verdict.answer,
            sentence: self.sentence(),
            beyond: verdict.beyond.iter().map(BeyondFacts::of).collect(),
            kept: &verdict.kept,
            unstable: &verdict.unstable,
            samples: verdict.kept.of,
            limits: verdict.limits.iter().map(LimitFacts::of).collect(),
            unchecked: &verdict.unchecked,
            requirements: verdict.sets.iter().map(SetFacts::of).collect(),
            own: verdict.own.iter().map(OwnFacts::of).collect(),
            easier: self.easier.iter().map(EasierFacts::of).collect(),
            doubts: &verdict.doubts,
            spread: if self.has_study { "study" } else { "prior" },
            engine_pulses: PulsesFrom::of(&self.pulses),
            assumptions: &self.assumptions,
            friction: self.friction,
            engine_following: self.following,
        }
    }
}
