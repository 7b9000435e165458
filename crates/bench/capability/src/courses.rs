//! Courses of what has limits: the largest magnitudes in stretches of a run.

use std::ops::Range;

use bench_model::document::Validity;
use serde::Serialize;

use crate::beyond::is_beyond_model;
use crate::extremes::{Drive, LimitOf, course};
use crate::outcome::Outcome;
use crate::trace::Trace;
use crate::verdict::Spread;

/// Stretches into which a run is cut.
const STRETCHES: usize = 400;

/// Course of a quantity that has a limit, SI: its largest magnitude in each stretch of the test. That of a cycle has no
/// firing pulses.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct LimitedCourse {
    /// When each stretch begins, s.
    pub time_s: Vec<f64>,
    /// The nominal bench.
    pub nominal: Vec<f64>,
    /// 5 % of the benches are below.
    pub low: Vec<f64>,
    /// 95 % of the benches are below.
    pub high: Vec<f64>,
}

/// The largest magnitude in each stretch of a run, by the place of the quantity in [`LimitOf::ALL`].
pub(crate) fn of(trace: &Trace, drive: &Drive) -> Vec<Vec<f64>> {
    let in_stretches = |of: LimitOf| {
        let values = course(of, trace, &[], drive);
        let largest = |stretch: Range<usize>| values[stretch].iter().copied().fold(0.0, f64::max);
        stretches(values.len()).map(largest).collect()
    };
    LimitOf::ALL.map(in_stretches).into()
}

/// The courses of all benches together.
pub(crate) fn together(of: LimitOf, trace: &Trace, nominal: &Outcome, outcomes: &[Outcome]) -> LimitedCourse {
    let values = |outcome: &'_ Outcome| outcome.limited.get(of as usize).cloned().unwrap_or_default();
    let all: Vec<Vec<f64>> = outcomes.iter().map(values).filter(|course| !course.is_empty()).collect();
    let nominal = values(nominal);
    let spreads: Vec<Spread> =
        (0..nominal.len()).map(|k| Spread::of(all.iter().map(|course| course[k]).collect())).collect();
    let along = |probability: f64| spreads.iter().map(|spread| spread.quantile(probability)).collect();
    let time_s = stretches(trace.dyno_demand_nm.len()).map(|stretch| trace.time_s(stretch.start));
    LimitedCourse { time_s: time_s.take(nominal.len()).collect(), low: along(0.05), high: along(0.95), nominal }
}

/// Spans of a run, s, in which it leaves the range of the recordings that a model is from.
pub(crate) fn beyond_model(validity: &Validity, trace: &Trace) -> Vec<(f64, f64)> {
    let is_beyond = is_beyond_model(validity, trace);
    let mut spans: Vec<(f64, f64)> = Vec::new();
    for stretch in stretches(trace.dyno_demand_nm.len()) {
        let (from_s, to_s) = (trace.time_s(stretch.start), trace.time_s(stretch.end));
        match spans.last_mut() {
            _ if !stretch.clone().any(&is_beyond) => {}
            Some(last) if last.1 == from_s => last.1 = to_s,
            _ => spans.push((from_s, to_s)),
        }
    }
    spans
}

fn stretches(samples: usize) -> impl Iterator<Item = Range<usize>> {
    let count = STRETCHES.min(samples);
    (0..count).map(move |k| k * samples / count..(k + 1) * samples / count)
}
