//! Pictures of data and models.

use ident::prediction::Response;
use ident::{Dataset, Label};
use page::{Axis, Figure, Layer, Panel, Style};

/// A figure whose texts are names of channels and files, not symbols.
pub(crate) fn figure(title: &str, x: Axis, panels: Vec<Panel>) -> Figure {
    Figure::new(title, x, panels).with_plain_text()
}

/// Response of a model to data on its own clock.
pub(crate) struct Shown<'a> {
    pub(crate) name: &'a str,
    pub(crate) data: &'a Dataset,
    pub(crate) response: &'a Response,
}

/// Measured outputs and what models make of them, a figure for each recording and output. Models of the same output
/// share it, whatever their clocks; the measurement is drawn as the first of them met it.
pub(crate) fn comparison(models: &[Shown]) -> Vec<Figure> {
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
    let (mut title, mut recording) = (String::new(), "");
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
        recording = &experiment.name;
    }
    keys.append(&mut layers);
    let panels = vec![
        Panel::new(Axis::linear(&label.name, &label.unit), 200, keys),
        Panel::new(Axis::linear("measured − model", &label.unit), 90, errors),
    ];
    figure(&title, Axis::time(), panels).of_recording(recording)
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

/// A trace of which every so many samples only are known, as of an output that is slower than the clock, runs from one
/// to the next; what is missing beyond that is a gap.
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
