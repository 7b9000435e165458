//! Checks of a recording and of the equation: J_d, the channels of the speeds, bands of frequencies, terms left out.

use ident::frequency::Prior;
use rig::estimation::EstimateError;
use rig::results::{Estimate, Stretch};

use super::inputs::ShaftInputs;
use super::places;
use super::solution::{Dated, Solution, Unknowns};
use super::term::Term;
use super::terms::{Beyond, TermTest};

/// So much of a recording shows whether speeds are exchanged, s: it changes what is left a thousandfold.
const EXCHANGE_S: f64 = 60.0;

/// J_d as the data see it, with its standard error, kg m²: a check on the value in the bench file. `None` where the
/// torque is that of a flange, which does not depend on J_d.
///
/// # Errors
/// Those of [`super::estimate`].
pub fn inertia(inputs: &ShaftInputs<'_>) -> Result<Option<(f64, f64)>, EstimateError> {
    if inputs.inertia_kg_m2.is_none() {
        return Ok(None);
    }
    let solution = Solution::of(inputs, &inputs.stretch()?, Unknowns::ShaftAndInertia)?;
    let variance = solution.fit.covariance[(places::INERTIA, places::INERTIA)];
    Ok(Some((solution.fit.fit.parameters[places::INERTIA], variance.sqrt())))
}

/// By how many times the equation leaves less with N_d and N_e exchanged: far beyond one where their channels are mixed
/// up.
///
/// # Errors
/// Those of [`super::estimate`].
pub fn gain_by_exchange(inputs: &ShaftInputs<'_>) -> Result<f64, EstimateError> {
    let whole = inputs.stretch()?;
    let stretch = Stretch { end_s: whole.end_s.min(whole.start_s + EXCHANGE_S), ..whole };
    // From no skew at all: far skews make up for some of an exchange.
    let misfit = |inputs: &ShaftInputs<'_>| -> Result<f64, EstimateError> {
        let mut start = Solution::of(inputs, &stretch, Unknowns::ShaftWithoutTiming)?.fit.fit.parameters;
        start[places::GATE] = inputs.gate_s.0;
        let near = Dated { from: Some(&start), ..Dated::as_recorded(inputs) };
        Ok(Solution::dated(inputs, &stretch, Unknowns::Shaft, near)?.fit.scale)
    };
    let exchanged = ShaftInputs { dyno_speed: inputs.engine_speed, engine_speed: inputs.dyno_speed, ..inputs.clone() };
    Ok(misfit(inputs)? / misfit(&exchanged)?)
}

/// K and B from bands of frequencies, each with gate and skews as the whole band shows them and, second, as if time
/// stamps were exact and speeds momentary; nothing where a band shows nothing, K or B being at zero.
///
/// # Errors
/// Those of [`super::estimate`].
pub fn by_band(
    inputs: &ShaftInputs<'_>,
    bands_hz: &[(f64, f64)],
) -> Result<Vec<Option<(Estimate, Estimate)>>, EstimateError> {
    let stretch = inputs.stretch()?;
    let whole = Solution::of(inputs, &stretch, Unknowns::Shaft)?;
    let (theta, covariance) = (&whole.fit.fit.parameters, &whole.fit.covariance);
    let known = |parameter: usize| {
        let standard_uncertainty = covariance[(parameter, parameter)].sqrt();
        (standard_uncertainty > 0.0).then(|| Prior { parameter, value: theta[parameter], standard_uncertainty })
    };
    let timing = [places::SKEW_ENGINE, places::SKEW_TORQUE, places::GATE, places::FRICTION];
    let timing: Vec<Prior> = timing.into_iter().filter_map(known).collect();
    let of_band = |band_hz: (f64, f64)| {
        let timed = Dated { dating: whole.spectra.dating, band_hz, known: &timing, from: Some(theta) };
        let own = Solution::dated(inputs, &stretch, Unknowns::Shaft, timed).ok()?;
        if [places::K, places::B].iter().any(|at| own.fit.fit.at_bound[*at]) {
            return None;
        }
        let exact = Dated { band_hz, ..Dated::as_recorded(inputs) };
        let naive = Solution::dated(inputs, &stretch, Unknowns::ShaftWithoutTiming, exact).ok()?;
        Some((own.estimate(&stretch), naive.estimate(&stretch)))
    };
    Ok(bands_hz.iter().map(|band_hz| of_band(*band_hz)).collect())
}

/// Tests every [`Term`] beyond the simple shaft on the whole of a recording, each by itself.
///
/// # Errors
/// Those of [`super::estimate`].
pub fn beyond(inputs: &ShaftInputs<'_>) -> Result<Beyond, EstimateError> {
    let stretch = inputs.stretch()?;
    // A term that is there may spoil a fit without it, skews included: each is estimated from the start.
    let test = |term: Term| {
        // What is not moved, or not told from K, B and timing, leaves the fit without a solution.
        let Ok(Solution { fit, .. }) = Solution::of(inputs, &stretch, Unknowns::ShaftAnd(term)) else {
            return TermTest::new(term, None);
        };
        let deviation = fit.covariance[(places::TERM, places::TERM)].sqrt();
        TermTest::new(term, (deviation > 0.0).then_some((&fit, deviation)))
    };
    let simple_misfit = Solution::of(inputs, &stretch, Unknowns::Shaft)?.fit.scale;
    Ok(Beyond::judged(simple_misfit, Term::ALL.into_iter().map(test).collect()))
}
