//! `dynoid step`: step responses.

use ident::uncertainty::{Dynamics, Feature};
use ident::{AnyModel, IdentError, LinearModel};
use lti::TimeGrid;
use plot::Axis;

use super::curves::{Curve, Fact, Quantity, show};
use super::{Model, channel_name, channels, driven_models, failed, longest_delay_s};
use crate::cli::identify::CurveArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid step`
pub(crate) fn step(arguments: &CurveArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let models = driven_models(&arguments.models)?;
    let mut curves = Vec::new();
    for (number, model) in models.iter().enumerate() {
        for channel in channels(model) {
            curves.push(curve(model, number, channel, arguments.models.level).map_err(failed)?);
        }
    }
    show(&curves, &models, &Axis::time(), arguments, terminal)
}

fn curve(model: &Model, number: usize, (output, input): (usize, usize), level: f64) -> Result<Curve, IdentError> {
    let document = &model.document;
    let grid = grid(model)?;
    let (values, band) = match &model.fit {
        Some(fit) => {
            let band = fit.step_band(output, input, &grid)?;
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
        channel: channel_name(model, (output, input)),
        x: grid.times(),
        summary: summary(model, (output, input), (&grid, &values), level)?,
        quantities: vec![Quantity {
            axis: Axis::linear("step response", &document.outputs[output].unit),
            values,
            band,
        }],
    })
}

/// Times until the model has settled, after its longest delay.
fn grid(model: &Model) -> Result<TimeGrid, IdentError> {
    let system = model.document.model.system()?;
    let natural = system.time_grid()?;
    let step_s = system.sample_time_s().unwrap_or(natural.step_s);
    let delay_s = longest_delay_s(model)?;
    Ok(TimeGrid { step_s, points: natural.points + (delay_s / step_s).ceil() as usize })
}

fn summary(
    model: &Model,
    (output, input): (usize, usize),
    (grid, values): (&TimeGrid, &[f64]),
    level: f64,
) -> Result<Vec<Fact>, IdentError> {
    let number = |name: &str, f: &Feature, unit: &str| Fact::number(name, f.value, unit, f.interval(level));
    let features = model.features(output, input);
    let unit = &model.document.outputs[output].unit;
    let mut facts = match features.step(grid)? {
        None => vec![Fact::remark("final value", "none: the model integrates, is not stable, or ends at zero")],
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
    facts.extend(Some(dead).filter(|_| !matches!(model.document.model, AnyModel::StateSpace(_))));
    Ok(facts)
}

/// Samples that a discrete model waits: the zeros its step response begins with, but for that at the step itself. A state
/// space has no zeros by structure, and a continuous model has its delay.
fn dead_samples(model: &Model, values: &[f64]) -> Option<usize> {
    let is_discrete = matches!(model.document.model, AnyModel::Polynomial(_));
    let zeros = values.iter().take_while(|v| **v == 0.0).count();
    is_discrete.then(|| zeros.saturating_sub(1))
}
