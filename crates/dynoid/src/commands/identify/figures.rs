//! Pictures of data, models and their judgement.

use ident::prediction::Response;
use ident::validate::{Independence, ResidualReport, Whiteness};
use ident::{Dataset, Label};
use page::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded};

/// Correlations below this are rounding.
const ROUNDING: f64 = 1e-12;

/// A figure whose texts are names of channels and files, not symbols.
pub(super) fn figure(title: &str, x: Axis, panels: Vec<Panel>) -> Figure {
    Figure::new(title, x, panels).with_plain_text()
}

/// What a model makes of data on its own clock.
pub(super) struct Shown<'a> {
    pub(super) name: &'a str,
    pub(super) data: &'a Dataset,
    pub(super) response: &'a Response,
}

/// Measured outputs and what models make of them, a figure for each recording and output. Models of the same output share
/// it, whatever their clocks; the measurement is drawn as the first of them met it.
pub(super) fn comparison(models: &[Shown]) -> Vec<Figure> {
    let mut seen: Vec<(usize, &Label)> = Vec::new();
    for model in models {
        for number in 0..model.data.experiments().len() {
            let new = model.data.output_labels().iter().map(|label| (number, label));
            let new: Vec<_> = new.filter(|one| !seen.contains(one)).collect();
            seen.extend(new);
        }
    }
    seen.into_iter().map(|(number, label)| compared(models, number, label)).collect()
}

fn compared(models: &[Shown], number: usize, label: &Label) -> Figure {
    let mut keys = vec![measurement(models, number, label)];
    let (mut layers, mut errors) = (Vec::new(), Vec::new());
    let mut title = String::new();
    // The first model, the one that matters most, is drawn last and covered by none.
    for (index, model) in models.iter().enumerate().rev() {
        let Some(output) = model.data.output_labels().iter().position(|own| own == label) else { continue };
        let Some(experiment) = model.data.experiments().get(number) else { continue };
        let clock = (experiment.start_s, model.data.sample_time_s());
        let (measured, modelled) = (experiment.output(output), model.response.outputs[number].col_as_slice(output));
        let difference: Vec<f64> = measured.iter().zip(modelled).map(|(y, m)| y - m).collect();
        let style = Style::of_model(index);
        // Without points, for the legend alone: there the first model is the first.
        keys.insert(1, Layer::curve(model.name, style, &[], &[]));
        layers.push(Layer::trace(model.name, style, clock, modelled));
        errors.push(trace(model.name, style, clock, &difference));
        title = format!("{}, {}", label.name, experiment.name);
    }
    keys.append(&mut layers);
    let panels = vec![
        Panel::new(Axis::linear(&label.name, &label.unit), 200, keys),
        Panel::new(Axis::linear("measured − model", &label.unit), 90, errors),
    ];
    figure(&title, Axis::time(), panels)
}

fn measurement(models: &[Shown], number: usize, label: &Label) -> Layer {
    let of = |model: &Shown| {
        let output = model.data.output_labels().iter().position(|own| own == label)?;
        let experiment = model.data.experiments().get(number)?;
        let clock = (experiment.start_s, model.data.sample_time_s());
        Some(trace("measured", Style::Measured, clock, experiment.output(output)))
    };
    models.iter().find_map(of).unwrap_or_else(|| Layer::curve("measured", Style::Measured, &[], &[]))
}

/// A trace of which every so many samples only are known, as of an output that is slower than the clock, runs from one to
/// the next; what is missing beyond that is a gap.
fn trace(name: &str, style: Style, (start_s, sample_time_s): (f64, f64), values: &[f64]) -> Layer {
    let known: Vec<usize> = (0..values.len()).filter(|i| !values[*i].is_nan()).collect();
    let steps = || known.windows(2).map(|pair| pair[1] - pair[0]);
    let least = steps().min().unwrap_or(1);
    let at = |i: usize| start_s + i as f64 * sample_time_s;
    if steps().all(|step| step % least == 0) {
        let first = known.first().map_or(0, |i| i % least);
        let kept: Vec<f64> = values.iter().skip(first).step_by(least).copied().collect();
        return Layer::trace(name, style, (at(first), least as f64 * sample_time_s), &kept);
    }
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (n, i) in known.iter().enumerate() {
        if n > 0 && i - known[n - 1] > 2 * least + 1 {
            points.push((at(*i), f64::NAN));
        }
        points.push((at(*i), values[*i]));
    }
    let (x, y): (Vec<f64>, Vec<f64>) = points.into_iter().unzip();
    Layer::curve(name, style, &x, &y)
}

/// Correlations of the residuals, a figure for each output.
pub(super) fn residuals(report: &ResidualReport, data: &Dataset, level: f64) -> Vec<Figure> {
    // What an estimate holds of its own data varies from lag to lag; there is no region at lags without pairs.
    let band = |first: f64, bounds: &[f64]| {
        let there = bounds.iter().enumerate().filter(|(_, bound)| bound.is_finite());
        let (lags, high): (Vec<f64>, Vec<f64>) = there.map(|(n, bound)| (first + n as f64, *bound)).unzip();
        let low: Vec<f64> = high.iter().map(|bound| -bound).collect();
        let (name, x) = (format!("{} % region", 100.0 * level), Abscissa::Values(rounded(&lags)));
        Layer::Band { name, style: Style::Guide, x, low: rounded(&low), high: rounded(&high) }
    };
    let stems = |name: &str, style, first: f64, values: &[f64]| {
        // There is no number at lags without pairs, and but rounding where an estimate holds a correlation.
        let there = values.iter().enumerate().filter(|(_, value)| value.abs() > ROUNDING);
        let (lags, values): (Vec<f64>, Vec<f64>) = there.map(|(n, value)| (first + n as f64, *value)).unzip();
        Layer::Stems { name: name.to_owned(), style, x: Abscissa::Values(rounded(&lags)), y: rounded(&values) }
    };
    let own = |w: &Whiteness| {
        let past = |values: &[f64]| values.get(1..).unwrap_or_default().to_vec();
        let layers = vec![band(1.0, &past(&w.bounds)), stems("with itself", Style::Modelled, 1.0, &past(&w.auto))];
        Panel::new(Axis::linear("with itself", ""), 110, layers)
    };
    let other = |(input, independence): (usize, &Independence)| {
        let first = -((independence.cross.len() / 2) as f64);
        let layers =
            vec![band(first, &independence.bounds), stems("with an input", Style::Other, first, &independence.cross)];
        Panel::new(Axis::linear(&format!("with {}", data.input_labels()[input].name), ""), 110, layers)
    };
    let of_output = |(output, whiteness): (usize, &Whiteness)| {
        let inputs = report.independence[output].iter().enumerate().map(other);
        let panels = std::iter::once(own(whiteness)).chain(inputs).collect();
        let title = format!("Correlation of the residuals of {}", data.output_labels()[output].name);
        figure(&title, Axis::linear("lag", "samples"), panels).with_caption(
            "Positive lags: the input comes first. Negative lags: the output comes first, as with feedback.",
        )
    };
    report.whiteness.iter().enumerate().map(of_output).collect()
}
