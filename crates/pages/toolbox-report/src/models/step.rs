//! Step responses.

use ident::uncertainty::{Dynamics, Feature};
use ident::{AnyModel, IdentError, LinearModel};
use lti::TimeGrid;
use page::Axis;

use super::curves::{Curve, Curves, Over, Quantity, unstable};
use super::facts::Fact;
use super::model::{Model, channel_name, channels, longest_delay_s};

/// Time constants for which a growing response is followed: to hundreds of millions of its beginning.
const RUN_AWAY: f64 = 20.0;
/// Points of a growing discrete response, at least.
const FEWEST: usize = 5;
/// Intervals of a response, at most.
const MOST: f64 = 20_000.0;

/// Step responses, models of one channel in one figure.
///
/// # Errors
/// Where a model has no step response, or no uncertainty of it.
pub fn step(models: Vec<Model>, level: f64) -> Result<Curves, IdentError> {
    let own: Vec<TimeGrid> = models.iter().map(grid).collect::<Result<_, _>>()?;
    let mut curves = Vec::new();
    for (number, model) in models.iter().enumerate() {
        let drawn = shared(&models, &own, number)?;
        for (output, input) in channels(model) {
            curves.push(curve(model, number, output, input, &own[number], &drawn, level)?);
        }
    }
    Ok(Curves { models, curves, over: Over::Time, level })
}

/// The response of a way, drawn on one grid and summed up on the model's own.
fn curve(
    model: &Model,
    number: usize,
    output: usize,
    input: usize,
    own: &TimeGrid,
    grid: &TimeGrid,
    level: f64,
) -> Result<Curve, IdentError> {
    let document = &model.document;
    let (values, band) = match &model.fit {
        Some(fit) => {
            let band = fit.step_band(output, input, grid)?;
            (band.values.clone(), Some(band.intervals(level)))
        }
        None => {
            let form = document.model.innovations(grid.step_s, ident::Intersample::ZeroOrderHold)?;
            let channel = form.system().channel(output, input)?;
            let u = faer::Mat::full(grid.points, 1, 1.0);
            let y = channel.simulate(u.as_ref(), &vec![0.0; channel.states()])?;
            (y.col_as_slice(0).to_vec(), None)
        }
    };
    Ok(Curve {
        model: number,
        channel: channel_name(model, output, input),
        x: grid.times(),
        summary: summary(model, output, input, own, &values, level)?,
        quantities: vec![Quantity {
            axis: Axis::linear("step response", &document.outputs[output].unit),
            values,
            band,
        }],
    })
}

/// Times until the model has settled, after its longest delay, or has run away.
fn grid(model: &Model) -> Result<TimeGrid, IdentError> {
    let system = model.document.model.system()?;
    let natural = system.time_grid()?;
    let delays = (longest_delay_s(model)? / natural.step_s).ceil() as usize;
    let Some(mode) = system.growing_mode()? else {
        return Ok(TimeGrid { points: natural.points + delays, ..natural });
    };
    let until_s = RUN_AWAY * -mode.time_constant_s();
    if system.sample_time_s().is_some() {
        let points = natural.points.min((until_s / natural.step_s).ceil() as usize + 1);
        return Ok(TimeGrid { points: points.max(FEWEST) + delays, ..natural });
    }
    let step_s = natural.step_s.min(until_s / natural.points as f64);
    let delays = (longest_delay_s(model)? / step_s).ceil() as usize;
    Ok(TimeGrid { step_s, points: natural.points.min((until_s / step_s).ceil() as usize + 1) + delays })
}

/// The times of one of several models: as long as the longest of those that settle, and for continuous models the same.
fn shared(models: &[Model], own: &[TimeGrid], number: usize) -> Result<TimeGrid, IdentError> {
    let end_s = |grid: &TimeGrid| (grid.points - 1) as f64 * grid.step_s;
    let mut settling = Vec::new();
    for (model, grid) in models.iter().zip(own) {
        if model.growing_mode()?.is_none() {
            settling.push((grid, model.sample_time_s().is_none()));
        }
    }
    if !settling.iter().any(|(grid, _)| std::ptr::eq(*grid, &own[number])) {
        return Ok(own[number]);
    }
    let longest_s = settling.iter().map(|(grid, _)| end_s(grid)).fold(0.0, f64::max);
    let finest = settling.iter().filter(|(_, is_continuous)| *is_continuous).map(|(grid, _)| grid.step_s);
    let step_s = match models[number].sample_time_s() {
        Some(step_s) => step_s,
        None => finest.fold(f64::INFINITY, f64::min).max(longest_s / MOST),
    };
    // A fast discrete model beside a slow one is drawn no further than it has points.
    Ok(TimeGrid { step_s, points: (longest_s / step_s).min(MOST).round() as usize + 1 })
}

fn summary(
    model: &Model,
    output: usize,
    input: usize,
    grid: &TimeGrid,
    values: &[f64],
    level: f64,
) -> Result<Vec<Fact>, IdentError> {
    let number = |name: &str, f: &Feature, unit: &str| Fact::number(name, f.value, unit, f.interval(level));
    let features = model.features(output, input);
    let unit = &model.document.outputs[output].unit;
    let step = match model.growing_mode()? {
        Some(mode) => return Ok(vec![unstable(&mode, "the response diverges and has no final value")]),
        None => features.step(grid)?,
    };
    let mut facts = match step {
        None => vec![Fact::remark("final value", "none: the model integrates, or ends at zero")],
        Some(step) => {
            let rise = step.rise_time_s.map(|rise| number("rise time (10 to 90 %)", &rise, "s"));
            let settling = step.settling_time_s.map(|time| Fact::number("settling time (2 %)", time, "s", None));
            let mut facts = vec![number("final value", &step.final_value, unit)];
            facts.extend(rise.into_iter().chain(settling));
            facts.push(number("overshoot", &step.overshoot_percent, "%"));
            facts
        }
    };
    let dead = match dead_samples(model, values) {
        Some(samples) => Fact::number("dead time", samples as f64 * grid.step_s, "s", None)
            .noted(format!("{samples} samples besides the one of the hold")),
        None => number("dead time", &features.number(|m| m.delay_s(output, input))?, "s"),
    };
    let has_delay = !model.is_noise && !matches!(model.document.model, AnyModel::StateSpace(_));
    facts.extend(Some(dead).filter(|_| has_delay));
    Ok(facts)
}

/// Samples that a discrete model waits: the zeros its step response begins with, but for that at the step itself. A
/// state space has no zeros by structure, and a continuous model has its delay.
fn dead_samples(model: &Model, values: &[f64]) -> Option<usize> {
    let is_discrete = matches!(model.document.model, AnyModel::Polynomial(_));
    let zeros = values.iter().take_while(|v| **v == 0.0).count();
    is_discrete.then(|| zeros.saturating_sub(1))
}
