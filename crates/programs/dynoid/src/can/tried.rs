//! Tests that were run on many benches, and are judged by any limits at once.

use capability::{CanInputs, LimitOf, Runs};
use page::Tone;
use report::can::limit_of;
use serde::Serialize;
use work::Context;

use super::facts::PredictedFacts;
use super::predicted::Predicted;
use super::requirements::Requirements;
use super::test::Test;
use crate::error::{Error, NotPredicted};
use crate::known::{Draws, KnownBench};
use crate::limits::{MovableFacts, OtherLimits};

/// A test that was run on many benches. Other limits judge the same runs.
#[derive(Debug)]
pub struct Tried {
    predicted: Predicted,
    runs: Runs,
}

impl Tried {
    /// Runs a test on many benches, as [`Predicted::of`] does.
    ///
    /// # Errors
    /// Those of [`Predicted::of`].
    pub fn of(
        bench: &KnownBench,
        test: &Test,
        wanted: &Requirements,
        draws: Draws,
        context: &Context,
    ) -> Result<Self, Error> {
        let run = |inputs: &CanInputs<'_>| {
            let runs = Runs::of(inputs, context)?;
            // The courses stay with the runs.
            Ok((runs.judged(runs.limits())?, runs))
        };
        let (predicted, runs) = Predicted::by(bench, test, wanted, draws, run, context)?;
        Ok(Tried { predicted, runs })
    }

    /// The answer by the limits of the bench file, without courses.
    pub fn predicted(&self) -> &Predicted {
        &self.predicted
    }

    /// The answer by other limits, without another run.
    ///
    /// # Errors
    /// A limit that is no positive number, and one that these runs cannot judge.
    pub fn judged(&self, other: &OtherLimits) -> Result<Predicted, NotPredicted> {
        Ok(self.predicted.with_verdict(self.runs.judged(&other.in_place_of(self.runs.limits())?)?))
    }

    /// The answer in numbers, with what limits can be moved and what it rests on.
    pub fn facts(&self) -> TriedFacts<'_> {
        let verdict = self.predicted.verdict();
        let rests_on = self.predicted.rests_on().into_iter().map(|finding| RestsOn {
            is_doubt: finding.tone != Tone::Plain,
            severity: finding.severity,
            words: finding.text.plain(),
        });
        let stated = verdict.limits.iter().filter(|one| one.of != LimitOf::DriveHeat);
        TriedFacts {
            answer: self.predicted.facts(),
            binding: verdict.binding(),
            movable: stated
                .map(|one| MovableFacts::of(one.of, self.runs.limits(), self.runs.largest_limit(one.of)))
                .collect(),
            rests_on: rests_on.collect(),
            beyond_model_s: self.runs.beyond_model(),
        }
    }

    /// The course of a quantity that has a limit, and beside it that of one bench.
    ///
    /// # Errors
    /// Those of [`Tried::judged`].
    pub fn course(
        &self,
        of: LimitOf,
        bench: Option<usize>,
        other: &OtherLimits,
    ) -> Result<LimitedCourseFacts, NotPredicted> {
        let (name, unit, si) = limit_of(of);
        let (limits, course) = (other.in_place_of(self.runs.limits())?, self.runs.course(of));
        let scaled = |values: &[f64]| values.iter().map(|value| value / si).collect();
        let bench = bench.and_then(|place| {
            let drawn = self.runs.bench(place, &limits)?;
            let reaches = drawn.reaches.iter().map(|of| limit_of(*of).0).collect();
            let values = scaled(self.runs.course_of_bench(of, place));
            Some(BenchFacts { keeps: drawn.keeps, is_stable: drawn.is_stable, reaches, values })
        });
        Ok(LimitedCourseFacts {
            of,
            name,
            unit,
            time_s: course.time_s,
            nominal: scaled(&course.nominal),
            low: scaled(&course.low),
            high: scaled(&course.high),
            bench,
        })
    }
}

/// Numbers of [`Tried`].
#[derive(Debug, Serialize)]
pub struct TriedFacts<'a> {
    answer: PredictedFacts<'a>,
    /// The limit that most benches reach or come nearest to.
    binding: Option<LimitOf>,
    movable: Vec<MovableFacts>,
    rests_on: Vec<RestsOn>,
    /// Spans in which the nominal bench leaves the range of the recordings that the model is from.
    beyond_model_s: Vec<(f64, f64)>,
}

/// A sentence on the basis of an answer.
#[derive(Debug, Serialize)]
struct RestsOn {
    is_doubt: bool,
    severity: String,
    words: String,
}

/// Course of a quantity that has a limit: its largest magnitude in each stretch of the test.
#[derive(Debug, Serialize)]
pub struct LimitedCourseFacts {
    of: LimitOf,
    name: &'static str,
    unit: &'static str,
    time_s: Vec<f64>,
    nominal: Vec<f64>,
    /// 5 % of the benches are below.
    low: Vec<f64>,
    /// 95 % of the benches are below.
    high: Vec<f64>,
    bench: Option<BenchFacts>,
}

/// One bench drawn.
#[derive(Debug, Serialize)]
struct BenchFacts {
    keeps: bool,
    is_stable: bool,
    reaches: Vec<&'static str>,
    values: Vec<f64>,
}
