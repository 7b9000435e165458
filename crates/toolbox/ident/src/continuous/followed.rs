//! Test of whether the residuals of an output still follow the inputs.

use super::channel::{ContinuousChannel, Degrees};
use super::estimate::OutputFit;
use super::record::{Beginning, Record, liveliest, records};
use super::srivc::Structure;
use super::start::quick_candidate;
use crate::colour::Colour;
use crate::data::band_limited::Ground;
use crate::distributions::chi_squared_quantile;
use crate::{Doubt, IdentError};

/// Samples looked at.
const SAMPLES: usize = 20_000;

/// Smaller parts of a residual are passed over even where they are significant: true systems have more poles than any
/// model.
const NOTABLE: f64 = 0.1;

/// The probability of doubting what chance explains.
const FALSE_ALARMS: f64 = 1e-3;

/// Residuals below this part of the output are rounding.
const ROUNDING: f64 = 1e-6;

/// A lag alone cannot follow what it leaves of a resonance.
const LEAST_POLES: usize = 2;

/// The outputs whose residual a further model of the same structure explains in part.
pub(super) fn doubts<C: ContinuousChannel>(
    ground: &Ground<'_>,
    beginning: Beginning,
    parts: &[OutputFit<C>],
    offset: bool,
) -> Result<Vec<Doubt>, IdentError> {
    let mut doubts = Vec::new();
    for (output, part) in parts.iter().enumerate() {
        let measured = records(ground, output, beginning)?;
        let series = part.residual_series(&measured);
        let share = share(ground, part, &measured, &series, offset)?;
        doubts.extend(share.map(|share| Doubt::FollowsInputs { output, share }));
    }
    Ok(doubts)
}

/// The part of the residual that is explained, where that is notable and more than chance explains.
fn share<C: ContinuousChannel>(
    ground: &Ground<'_>,
    part: &OutputFit<C>,
    measured: &[Record<'_>],
    series: &[Vec<f64>],
    offset: bool,
) -> Result<Option<f64>, IdentError> {
    let placed = |(r, s): (&Record<'_>, &Vec<f64>)| [&vec![f64::NAN; r.first], s.as_slice()].concat();
    let in_place: Vec<Vec<f64>> = measured.iter().zip(series).map(placed).collect();
    let left: Vec<Record<'_>> =
        measured.iter().zip(&in_place).map(|(r, output)| Record { output, ..r.clone() }).collect();
    let stretches = liveliest(&left, SAMPLES);
    let energy = |records: &[Record<'_>]| records.iter().map(Record::energy).sum::<f64>();
    if energy(&left) <= ROUNDING * ROUNDING * energy(measured) {
        return Ok(None);
    }
    let t = ground.plain.sample_time_s();
    let channels = part.model.channels();
    let degrees: Vec<Degrees> = channels.iter().map(C::degrees).collect();
    let delays =
        channels.iter().map(|c| Ok(c.transfer_function()?.delay_s() / t)).collect::<Result<Vec<f64>, IdentError>>()?;
    let numerators: Vec<usize> = degrees.iter().map(|d| d.numerator).collect();
    let structure = Structure {
        degrees: &numerators,
        delays: &delays,
        poles: degrees.iter().map(|d| d.poles).max().unwrap_or(0).max(LEAST_POLES),
        integrators: 0,
        offset,
        intersample: ground.plain.intersample(),
    };
    let Ok(candidate) = quick_candidate(&structure, &stretches) else { return Ok(None) };
    let share = 1.0 - candidate.cost / energy(&stretches);
    let nuisance = stretches.len() * (structure.poles + usize::from(offset));
    let unknown = structure.poles + numerators.iter().map(|m| m + 1).sum::<usize>() + nuisance;
    // The poles find the most striking of as many frequencies as there are independent pairs of samples.
    let samples = independent_samples(&stretches);
    let chance = chi_squared_quantile(1.0 - 2.0 * FALSE_ALARMS / samples.max(2.0), unknown as f64) / samples;
    Ok((share > NOTABLE.max(chance)).then_some(share))
}

/// As how many independent samples the records determine the correlation with another series that is as coloured.
fn independent_samples(records: &[Record<'_>]) -> f64 {
    let series: Vec<Vec<f64>> = records.iter().map(|r| r.output[r.first..].to_vec()).collect();
    let rows: usize = records.iter().map(Record::rows).sum();
    rows as f64 / Colour::of(&series, 1).rows_per_independent()
}
