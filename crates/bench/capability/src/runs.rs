//! Runs of a test on many benches, which any limits can judge without another run.

use bench_model::document::Validity;
use cycle::{Judged, Own, RequirementSet};
use numerics::parallel;
use rig::bench_file::Limits;
use signal::proportion::Proportion;
use work::Context;

use crate::answer::{Driven, benches, nominal, outcome};
use crate::beyond::{Beyond, beyond};
use crate::courses::{self, LimitedCourse};
use crate::doubt::doubts;
use crate::error::CapabilityError;
use crate::extremes::LimitOf;
use crate::judged;
use crate::outcome::{CanInputs, Drawn, Outcome, keeps_limits, meets_sets, reached};
use crate::trace::Trace;
use crate::verdict::{
    Answer, Bands, LimitVerdict, Verdict, answer_of, bands, limit_verdict, own_verdict, proportion, set_verdict,
};

/// Answers. The runs of the benches are a step of the work.
///
/// # Errors
/// The nominal bench cannot be simulated, no samples, an uncertainty without possible benches, a requirement that
/// cannot be applied.
pub fn can(inputs: &CanInputs<'_>, context: &Context) -> Result<Verdict, CapabilityError> {
    Ok(Runs::tried(inputs, false, context)?.verdict())
}

/// Runs of a test on many benches, with all that limits are compared with on each of them.
///
/// The limits act on no run: the controller of a bench holds the torque limit of its model. So the answer to other
/// limits is that of a new run with them and the same seed.
#[derive(Debug, Clone)]
pub struct Runs {
    has_shaft: bool,
    sets: Vec<RequirementSet>,
    own: Vec<Own>,
    beyond: Vec<Beyond>,
    benches: Vec<Drawn>,
    outcomes: Vec<Outcome>,
    nominal: Outcome,
    trace: Trace,
    limits: Limits,
    validity: Validity,
    /// The controllers demand no more, Nm.
    drive_nm: Option<f64>,
}

/// One bench drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnBench {
    /// True where it keeps every limit and meets every requirement.
    pub keeps: bool,
    /// False where it is not stable.
    pub is_stable: bool,
    /// Limits that it reaches.
    pub reaches: Vec<LimitOf>,
}

impl Runs {
    /// Runs a test. The runs of the benches are a step of the work.
    ///
    /// # Errors
    /// Those of [`crate::can`].
    pub fn of(inputs: &CanInputs<'_>, context: &Context) -> Result<Self, CapabilityError> {
        Self::tried(inputs, true, context)
    }

    /// The same, with the courses of what has limits or without.
    fn tried(inputs: &CanInputs<'_>, with_courses: bool, context: &Context) -> Result<Self, CapabilityError> {
        if inputs.samples == 0 {
            return Err(CapabilityError::NoSamples);
        }
        let benches = benches(inputs)?;
        let (driven, middle) = (Driven::of(inputs), nominal(inputs));
        let trace = driven.trace(inputs, &middle)?;
        judged::check_own(&trace, inputs.own)?;
        let nominal = outcome(inputs, &driven, &middle, Ok(trace.clone()), with_courses)?;
        let run = |bench: &Drawn| outcome(inputs, &driven, bench, driven.trace(inputs, bench), with_courses);
        let outcomes = parallel::map_as_step(context, "running the test on benches", &benches, run);
        Ok(Runs {
            has_shaft: inputs.demand.has_shaft(),
            sets: inputs.sets.to_vec(),
            own: inputs.own.to_vec(),
            beyond: beyond(&inputs.demand, &inputs.validity, &trace),
            outcomes: outcomes.into_iter().collect::<Result<_, _>>()?,
            benches,
            nominal,
            trace,
            limits: inputs.limits,
            validity: inputs.validity,
            drive_nm: inputs.model.torque_limit_nm,
        })
    }

    /// The verdict by the limits of the run, with the courses.
    pub fn verdict(&self) -> Verdict {
        let bands = bands(&self.trace, &self.outcomes);
        Verdict { nominal: self.trace.clone(), bands, ..self.by(&self.limits) }
    }

    /// The verdict by other limits, without courses. The heat of the drive keeps the limit of the run.
    ///
    /// # Errors
    /// A torque limit above that of the drive, where benches reach that: with another drive they would run otherwise.
    pub fn judged(&self, limits: &Limits) -> Result<Verdict, CapabilityError> {
        let limit_nm = limits.torque_nm.unwrap_or(f64::INFINITY);
        let drive_nm = self.largest_limit(LimitOf::TorqueDemand).filter(|_| limits.torque_nm != self.limits.torque_nm);
        match drive_nm.filter(|drive_nm| limit_nm > *drive_nm) {
            Some(drive_nm) => Err(CapabilityError::BeyondDrive { limit_nm, drive_nm }),
            None => Ok(self.by(&Limits { drive_heat: self.limits.drive_heat, ..*limits })),
        }
    }

    /// Puts the outcomes of all benches together, by these limits; without the curves.
    fn by(&self, limits: &Limits) -> Verdict {
        let (outcomes, nominal) = (&self.outcomes[..], &self.nominal);
        let keeps: Vec<bool> = outcomes.iter().map(|outcome| self.keeps(outcome, limits)).collect();
        let kept = Proportion::new(keeps.iter().filter(|keeps| **keeps).count(), keeps.len());
        let verdicts: Vec<LimitVerdict> = LimitOf::of_test(self.has_shaft, limits)
            .map(|of| limit_verdict(of, of.limit(limits), outcomes, nominal))
            .collect();
        let is_limited = verdicts.iter().any(|one| one.limit.is_some());
        let is_judged = is_limited || !self.sets.is_empty() || !self.own.is_empty();
        let answer = answer_of(&kept, is_judged, !self.beyond.is_empty());
        Verdict {
            answer,
            beyond: self.beyond.clone(),
            kept,
            unstable: proportion(outcomes, |outcome| outcome.is_unstable),
            unchecked: verdicts.iter().filter(|one| one.limit.is_none()).map(|one| one.of).collect(),
            limits: verdicts,
            sets: self.sets.iter().enumerate().map(|(k, set)| set_verdict(k, set, outcomes, nominal)).collect(),
            own: self.own.iter().enumerate().map(|(k, own)| own_verdict(k, own, outcomes, nominal)).collect(),
            doubts: match answer {
                Answer::Perhaps => doubts(&self.benches, &keeps),
                Answer::Yes | Answer::No | Answer::NotShown | Answer::NotJudged => Vec::new(),
            },
            nominal: Trace::default(),
            bands: Bands::default(),
        }
    }

    /// The limits of the run.
    pub fn limits(&self) -> &Limits {
        &self.limits
    }

    /// The largest limit that can be judged without a new run, SI; none where any can.
    pub fn largest_limit(&self, of: LimitOf) -> Option<f64> {
        let drive_nm = self.drive_nm.filter(|_| of == LimitOf::TorqueDemand)?;
        let reach = |outcome: &Outcome| outcome.peaks[of as usize].value >= drive_nm;
        self.outcomes.iter().filter(|outcome| !outcome.is_unstable).any(reach).then_some(drive_nm)
    }

    /// The course of a quantity that has a limit, on all benches.
    pub fn course(&self, of: LimitOf) -> LimitedCourse {
        courses::together(of, &self.trace, &self.nominal, &self.outcomes)
    }

    /// The course of the same on one bench, SI; empty of one that is not stable, and of one that was not drawn.
    pub fn course_of_bench(&self, of: LimitOf, bench: usize) -> &[f64] {
        self.outcomes.get(bench).and_then(|outcome| outcome.limited.get(of as usize)).map_or(&[], Vec::as_slice)
    }

    /// Spans of the test, s, in which the nominal bench leaves the range of the recordings that the model is from.
    pub fn beyond_model(&self) -> Vec<(f64, f64)> {
        courses::beyond_model(&self.validity, &self.trace)
    }

    /// One bench, by these limits; none that was not drawn.
    pub fn bench(&self, bench: usize, limits: &Limits) -> Option<DrawnBench> {
        let outcome = self.outcomes.get(bench)?;
        Some(DrawnBench {
            keeps: self.keeps(outcome, limits),
            is_stable: !outcome.is_unstable,
            reaches: reached(self.has_shaft, limits, &outcome.peaks).collect(),
        })
    }

    /// Tells whether a bench keeps every limit and meets every requirement.
    fn keeps(&self, outcome: &Outcome, limits: &Limits) -> bool {
        let meets_own = outcome.own.len() == self.own.len() && outcome.own.iter().all(Judged::passes);
        !outcome.is_unstable
            && meets_own
            && meets_sets(&self.sets, &outcome.validations)
            && keeps_limits(self.has_shaft, limits, &outcome.peaks)
    }
}
