//! From starting values to the fit: multi-start of the response, then one ripple line after another.

use bench_model::drive_ripple::RippleLine;
use faer::Mat;
use ident::covariance::batched_sandwich;
use ident::{Bounds, IdentError, Minimum, NonlinearOptions, minimise};

use super::ripple::{lowers_cost, strongest_line};
use super::rippled::{Response, RippledModel};

/// Most ripple lines looked for.
const MOST_LINES: usize = 4;
/// Starts taken into the nonlinear search.
const STARTS: usize = 3;
/// Residuals below this fraction of the signal are rounding.
const ROUNDING: f64 = 1e-9;
/// Shortest batch for the covariance, s; long against the memory of the residuals.
const BATCH_S: f64 = 0.5;
/// Fewest batches.
const FEWEST_BATCHES: usize = 8;
/// Most batches.
const MOST_BATCHES: usize = 40;

/// Fits response, offset and as many ripple lines as the data show; the gain stays one.
///
/// The best of `starts` (values of the response's parameters, at least one) are refined.
///
/// # Errors
/// No start leads to a fit.
pub(crate) fn fit_with_ripple<R: Response>(
    model: &mut RippledModel<'_, R>,
    starts: &[Vec<f64>],
    bounds: &[Bounds],
) -> Result<Minimum, IdentError> {
    let mut fit = fit_from_best(model, starts, bounds, &[])?;
    let scale: f64 = model.observed().values.iter().map(|y| y * y).sum();
    let mut frequencies: Vec<f64> = Vec::new();
    while frequencies.len() < MOST_LINES && fit.cost > ROUNDING * ROUNDING * scale {
        let Some(line) = next_line(model, &fit, &frequencies) else { break };
        frequencies.push(line);
        let Ok(mut next) = fit_with_lines(model, &fit.parameters, bounds, &frequencies) else { break };
        if frequencies.len() == 1 {
            // Unexplained, the strongest ripple can lead the response away to where no slope leads back from, such as
            // to a jump of the held demand.
            let lines = model.linear_of(&next.parameters).1;
            let afresh = fit_from_best(model, starts, bounds, &lines);
            next = afresh.ok().filter(|afresh| afresh.cost < next.cost).unwrap_or(next);
        }
        if !lowers_cost(fit.cost, next.cost, model.observed().len(), next.parameters.len()) {
            break;
        }
        fit = next;
        frequencies = model.linear_of(&fit.parameters).1.iter().map(|l| l.frequency_hz).collect();
    }
    let lines = model.linear_of(&fit.parameters).1.len();
    model.set_lines(lines);
    Ok(fit)
}

fn next_line<R: Response>(model: &RippledModel<'_, R>, fit: &Minimum, known: &[f64]) -> Option<f64> {
    let observed = model.observed();
    strongest_line(&fit.residuals, &observed.places, observed.sample_time_s, known).ok().flatten()
}

/// The best fit from those starts that come closest with these ripple lines.
fn fit_from_best<R: Response>(
    model: &mut RippledModel<'_, R>,
    starts: &[Vec<f64>],
    bounds: &[Bounds],
    lines: &[RippleLine],
) -> Result<Minimum, IdentError> {
    let ripple = model.ripple_of(lines);
    let mut ranked: Vec<(f64, &Vec<f64>)> = starts.iter().map(|s| (model.coarse_cost(s, &ripple), s)).collect();
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let frequencies: Vec<f64> = lines.iter().map(|line| line.frequency_hz).collect();
    let mut best: Result<Minimum, IdentError> = Err(IdentError::Constant { what: "the demand" });
    for (_, start) in ranked.iter().take(STARTS) {
        let found = fit_with_lines(model, start, bounds, &frequencies);
        match (&best, &found) {
            (Ok(b), Ok(f)) if f.cost >= b.cost => {}
            (Ok(_), Err(_)) => {}
            _ => best = found,
        }
    }
    best
}

/// Refines response and lines together from the response's parameters at the front of `start`.
///
/// # Errors
/// Those of the linear and of the nonlinear least squares.
pub(crate) fn fit_with_lines<R: Response>(
    model: &mut RippledModel<'_, R>,
    start: &[f64],
    bounds: &[Bounds],
    frequencies_hz: &[f64],
) -> Result<Minimum, IdentError> {
    let start = model.with_linear_part(&start[..model.response_count()], frequencies_hz)?;
    let bounds = model.bounds(bounds, &start, line_reach_hz(model));
    minimise(model, &start, &bounds, NonlinearOptions::default())
}

/// Refines a fit with its gain free.
///
/// # Errors
/// Those of the nonlinear least squares.
pub(crate) fn free_the_gain<R: Response>(
    model: &mut RippledModel<'_, R>,
    fit: &Minimum,
    bounds: &[Bounds],
) -> Result<Minimum, IdentError> {
    let mut bounds = model.bounds(bounds, &fit.parameters, line_reach_hz(model));
    bounds[model.response_count()] = Bounds::NONE;
    minimise(model, &fit.parameters, &bounds, NonlinearOptions::default())
}

/// Half the resolution of the record: within it the search for a frequency has one minimum.
fn line_reach_hz<R: Response>(model: &RippledModel<'_, R>) -> f64 {
    let times = &model.observed().times_s;
    match (times.first(), times.last()) {
        (Some(first), Some(last)) if last > first => 0.5 / (last - first),
        _ => 0.0,
    }
}

/// Covariance of a fit's parameters, robust to coloured residuals, and its degrees of freedom.
///
/// # Errors
/// Too few samples.
pub(crate) fn robust_covariance(fit: &Minimum, sample_time_s: f64) -> Result<(Mat<f64>, f64), IdentError> {
    batched_sandwich(fit, batches(fit.residuals.len(), sample_time_s))
}

/// [`robust_covariance`], but the widest of those at the fit and `reach` beside its first parameter, a delay.
///
/// Where samples and steps of a held demand fall on the same instants, the cost has a kink: to one side of it a delay
/// meets the next step, to the other it moves along the one before, which may show next to nothing of it.
///
/// # Errors
/// Those of [`robust_covariance`].
pub(crate) fn covariance_beside_kinks<R: Response>(
    model: &mut RippledModel<'_, R>,
    fit: &Minimum,
    bounds: &[Bounds],
    reach: f64,
) -> Result<(Mat<f64>, f64), IdentError> {
    let sample_time_s = model.observed().sample_time_s;
    let mut widest = robust_covariance(fit, sample_time_s)?;
    let all = model.bounds(bounds, &fit.parameters, line_reach_hz(model));
    for side in [-reach, reach] {
        let mut beside = fit.parameters.clone();
        beside[0] = (beside[0] + side).clamp(all[0].lower, all[0].upper);
        let still = NonlinearOptions { iteration_limit: 0, ..NonlinearOptions::default() };
        let Ok(there) = minimise(model, &beside, &all, still) else { continue };
        let found = robust_covariance(&Minimum { residuals: fit.residuals.clone(), ..there }, sample_time_s)?;
        if found.0[(0, 0)] > widest.0[(0, 0)] {
            widest = found;
        }
    }
    Ok(widest)
}

/// By how much the standard error of the second parameter, a lag, has to be larger than the slopes at the minimum say:
/// two of these errors away to either side the cost should have risen by what two standard errors are worth. Where
/// delay and lag hardly differ in their effect, it rises less.
///
/// # Source
/// Profile likelihood: Bates & Watts, *Nonlinear Regression Analysis and Its Applications*, 1988, ch. 6.
pub(crate) fn flatness<R: Response>(
    model: &mut RippledModel<'_, R>,
    fit: &Minimum,
    bounds: &[Bounds],
    variance: f64,
) -> f64 {
    let all = model.bounds(bounds, &fit.parameters, line_reach_hz(model));
    let (lag, error) = (fit.parameters[1], variance.sqrt());
    let mut flatness: f64 = 1.0;
    for factor in [-2.0, 2.0].map(|errors: f64| (errors * error / lag).exp()) {
        let moved = (factor * lag).clamp(all[1].lower, all[1].upper);
        let (mut start, mut fixed) = (fit.parameters.clone(), all.clone());
        (start[1], fixed[1]) = (moved, Bounds::new(moved, moved));
        let Ok(there) = minimise(model, &start, &fixed, NonlinearOptions::default()) else { continue };
        // By the robust variance: a rise of the cost counts as one error where the white one would with the white
        // variance.
        let errors = ((there.cost - fit.cost) * fit.unscaled_covariance[(1, 1)] / variance).max(0.0).sqrt();
        flatness = flatness.max((moved / lag).ln().abs() * lag / error / errors.max(LEAST_ERRORS));
    }
    flatness
}

/// The delay and lag of another minimum with the same total delay, beyond a step of the held demand, that fits about as
/// well.
pub(crate) fn rival<R: Response>(
    model: &mut RippledModel<'_, R>,
    fit: &Minimum,
    bounds: &[Bounds],
    factor: f64,
) -> Option<[f64; 2]> {
    let all = model.bounds(bounds, &fit.parameters, line_reach_hz(model));
    let mut start = fit.parameters.clone();
    let lag = (factor * start[1]).clamp(all[1].lower, all[1].upper);
    let delay = start[0] + 1.0 / start[1] - 1.0 / lag;
    (start[0], start[1]) = (delay.clamp(all[0].lower, all[0].upper), lag);
    let there = minimise(model, &start, &all, NonlinearOptions::default()).ok()?;
    let errors = ((there.cost - fit.cost) / fit.noise_variance()).max(0.0).sqrt();
    (errors < RIVAL_ERRORS).then_some([there.parameters[0], there.parameters[1]])
}

/// A minimum whose cost is larger by no more than so many standard errors are worth is a rival.
const RIVAL_ERRORS: f64 = 3.0;
/// A cost that rises by less than this many standard errors is flat.
const LEAST_ERRORS: f64 = 0.02;

/// Into how many batches so many samples are cut for a covariance robust to what is left in them.
pub fn batches(samples: usize, sample_time_s: f64) -> usize {
    ((samples as f64 * sample_time_s / BATCH_S) as usize).clamp(FEWEST_BATCHES, MOST_BATCHES)
}
