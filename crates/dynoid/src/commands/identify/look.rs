//! `dynoid bode`, `step`, `poles`: what a model is like.

use std::f64::consts::TAU;

use ident::uncertainty::{Dynamics, UncertainRoot};
use ident::{Fit, IdentError, LinearModel, ModelDocument};
use lti::{Complex64, Mode, TimeGrid};
use plot::{Abscissa, Axis, Figure, Layer, Marker, Panel, Style, rounded};

use super::judge::{picture, written};
use super::model_file;
use super::words::significant;
use crate::cli::identify::ModelArguments;
use crate::error::{CliError, Outcome};
use crate::table::{Align, Table};
use crate::terminal::Terminal;

/// Frequencies of a Bode plot.
const FREQUENCIES: usize = 400;

/// A model file with its name and, where it carries one, its estimate.
struct Model {
    name: String,
    document: ModelDocument,
    fit: Option<Fit<ident::AnyModel>>,
}

fn models(arguments: &ModelArguments) -> Result<Vec<Model>, CliError> {
    model_file::checked_share("--level", arguments.level)?;
    let read = |path: &std::path::PathBuf| {
        let document = model_file::read(path)?;
        let fit = document.estimate.as_ref().map(|_| document.fit()).transpose();
        let fit = fit.map_err(|error| CliError::ModelFile { path: path.clone(), reason: error.to_string() })?;
        Ok(Model { name: model_file::name(path), document, fit })
    };
    arguments.models.iter().map(read).collect()
}

/// Every way from an input to an output of a model.
fn channels(model: &Model) -> impl Iterator<Item = (usize, usize)> + use<> {
    let (inputs, outputs) = (model.document.model.inputs(), model.document.model.outputs());
    (0..outputs).flat_map(move |output| (0..inputs).map(move |input| (output, input)))
}

fn channel_name(model: &Model, (output, input): (usize, usize)) -> String {
    format!("{} → {}", model.document.inputs[input].name, model.document.outputs[output].name)
}

fn failed(source: IdentError) -> CliError {
    CliError::identify("the response", source)
}

/// A curve with a band, over frequency or time.
struct Curve {
    model: usize,
    channel: String,
    x: Vec<f64>,
    /// Each quantity: name, unit, values, band.
    quantities: Vec<Quantity>,
}

struct Quantity {
    name: &'static str,
    unit: String,
    values: Vec<f64>,
    band: Option<Vec<(f64, f64)>>,
}

/// `dynoid bode`
pub(crate) fn bode(arguments: &ModelArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let models = models(arguments)?;
    let mut curves = Vec::new();
    for (number, model) in models.iter().enumerate() {
        let grid = model.document.model.system().and_then(|s| s.frequency_grid(FREQUENCIES));
        let omega = grid.map_err(|e| failed(e.into()))?;
        for channel in channels(model) {
            curves.push(bode_curve(model, number, channel, &omega, arguments.level).map_err(failed)?);
        }
    }
    show(&curves, &models, Axis::frequency(), arguments, terminal)
}

fn bode_curve(
    model: &Model,
    number: usize,
    (output, input): (usize, usize),
    omega: &[f64],
    level: f64,
) -> Result<Curve, IdentError> {
    let response = model.document.model.frequency_response(output, input, omega)?;
    let band = model.fit.as_ref().map(|fit| fit.frequency_band(output, input, omega)).transpose()?;
    let decibel = |gain: f64| 20.0 * gain.log10();
    let magnitude = band.as_ref().map(|b| b.magnitude(level).iter().map(|(l, h)| (decibel(*l), decibel(*h))).collect());
    Ok(Curve {
        model: number,
        channel: channel_name(model, (output, input)),
        x: response.freq_hz(),
        quantities: vec![
            Quantity { name: "magnitude", unit: "dB".into(), values: response.magnitude_db(), band: magnitude },
            Quantity {
                name: "phase",
                unit: "°".into(),
                values: response.phase_deg(),
                band: band.as_ref().map(|b| b.phase_deg(level)),
            },
        ],
    })
}

/// `dynoid step`
pub(crate) fn step(arguments: &ModelArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let models = models(arguments)?;
    let mut curves = Vec::new();
    for (number, model) in models.iter().enumerate() {
        for channel in channels(model) {
            curves.push(step_curve(model, number, channel, arguments.level).map_err(failed)?);
        }
    }
    show(&curves, &models, Axis::time(), arguments, terminal)
}

fn step_curve(model: &Model, number: usize, (output, input): (usize, usize), level: f64) -> Result<Curve, IdentError> {
    let document = &model.document;
    let system = document.model.system()?;
    let natural = system.time_grid()?;
    let sample_time_s = system.sample_time_s().unwrap_or(natural.step_s);
    let delay_s = longest_delay_s(document)?;
    let samples = natural.points + (delay_s / sample_time_s).ceil() as usize;
    let grid = TimeGrid { step_s: sample_time_s, points: samples };
    let (values, band) = match &model.fit {
        Some(fit) => {
            let band = fit.step_band(output, input, &grid)?;
            (band.values.clone(), Some(band.intervals(level)))
        }
        None => {
            let form = document.model.innovations(sample_time_s, ident::Intersample::ZeroOrderHold)?;
            let channel = form.system().channel(output, input)?;
            let u = faer::Mat::full(samples, 1, 1.0);
            let y = channel.simulate(u.as_ref(), &vec![0.0; channel.states()])?;
            (y.col_as_slice(0).to_vec(), None)
        }
    };
    let unit = document.outputs[output].unit.clone();
    Ok(Curve {
        model: number,
        channel: channel_name(model, (output, input)),
        x: (0..samples).map(|n| n as f64 * sample_time_s).collect(),
        quantities: vec![Quantity { name: "step response", unit, values, band }],
    })
}

/// The longest delay of a continuous model; a discrete one holds its delays as states.
fn longest_delay_s(document: &ModelDocument) -> Result<f64, IdentError> {
    let mut longest = 0.0_f64;
    for output in 0..document.model.outputs() {
        for input in 0..document.model.inputs() {
            longest = longest.max(document.model.delay_s(output, input)?);
        }
    }
    Ok(longest)
}

/// Draws and prints curves, models of the same channel in one figure.
fn show(
    curves: &[Curve],
    models: &[Model],
    x: Axis,
    arguments: &ModelArguments,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let mut names: Vec<&str> = curves.iter().map(|c| c.channel.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    let figure = |name: &&str| {
        let same: Vec<&Curve> = curves.iter().filter(|c| c.channel == *name).collect();
        curve_figure(name, &same, models, x.clone())
    };
    picture(&arguments.result, "Models", || names.iter().map(figure).collect())?;
    if arguments.result.json {
        let quantity = |q: &Quantity| {
            let band = q.band.as_ref().map(|b| b.iter().map(|(l, h)| [*l, *h]).collect::<Vec<_>>());
            serde_json::json!({"name": q.name, "unit": q.unit, "values": q.values, "band": band})
        };
        let curve = |c: &Curve| {
            let quantities: Vec<_> = c.quantities.iter().map(quantity).collect();
            serde_json::json!({"model": models[c.model].name, "channel": c.channel, x.label.as_str(): c.x, "quantities": quantities})
        };
        terminal.json(&curves.iter().map(curve).collect::<Vec<_>>())?;
    } else if !terminal.is_quiet() {
        curves.iter().for_each(|c| terminal.table(&curve_table(c, &models[c.model].name, &x)));
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

fn curve_figure(title: &str, curves: &[&Curve], models: &[Model], x: Axis) -> Figure {
    let count = curves.first().map_or(0, |c| c.quantities.len());
    let panel = |index: usize| {
        let mut layers = Vec::new();
        for curve in curves {
            let (quantity, style) = (&curve.quantities[index], Style::of_model(curve.model));
            let name = models[curve.model].name.clone();
            if let Some(band) = &quantity.band {
                let (low, high): (Vec<f64>, Vec<f64>) = band.iter().copied().unzip();
                let x = Abscissa::Values(rounded(&curve.x));
                layers.push(Layer::Band { name: name.clone(), style, x, low: rounded(&low), high: rounded(&high) });
            }
            layers.push(Layer::curve(&name, style, &curve.x, &quantity.values));
        }
        let first = curves.first().map(|c| &c.quantities[index]);
        let axis = first.map_or_else(|| Axis::linear("", ""), |q| Axis::linear(q.name, &q.unit));
        Panel::new(axis, if index == 0 { 200 } else { 130 }, layers)
    };
    Figure::new(title, x, (0..count).map(panel).collect())
}

/// About twenty lines of a curve.
fn curve_table(curve: &Curve, model: &str, x: &Axis) -> Table {
    let mut table = Table::new(&[("model", Align::Left), ("at", Align::Right), ("value", Align::Left)]);
    let step = curve.x.len().div_ceil(20).max(1);
    for n in (0..curve.x.len()).step_by(step) {
        let text = |q: &Quantity| {
            let band = q.band.as_ref().map(|b| format!(" ({} … {})", significant(b[n].0), significant(b[n].1)));
            format!("{} {} {}{}", q.name, significant(q.values[n]), q.unit, band.unwrap_or_default())
        };
        let values: Vec<String> = curve.quantities.iter().map(text).collect();
        table.row([
            format!("{model}, {}", curve.channel).into(),
            format!("{} {}", significant(curve.x[n]), x.unit).into(),
            values.join(", ").into(),
        ]);
    }
    table
}

/// `dynoid poles`
pub(crate) fn poles(arguments: &ModelArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let models = models(arguments)?;
    let rows = rows(&models).map_err(failed)?;
    picture(&arguments.result, "Poles and zeros", || pole_figures(&rows, &models, arguments.level))?;
    if arguments.result.json {
        let row = |r: &Row| {
            let mode = r.mode(&models);
            serde_json::json!({
                "model": models[r.model].name, "channel": r.channel, "kind": r.kind(),
                "re": r.root.value.re, "im": r.root.value.im, "covariance": r.root.covariance,
                "near_multiple": r.root.near_multiple,
                "natural_frequency_hz": mode.natural_frequency_rad_s / TAU, "damping": mode.damping,
            })
        };
        terminal.json(&rows.iter().map(row).collect::<Vec<_>>())?;
    } else if !terminal.is_quiet() {
        terminal.table(&pole_table(&rows, &models, arguments.level));
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

/// Poles and zeros of one model, as a table.
pub(super) fn roots_table(document: &ModelDocument, level: f64) -> Result<Table, IdentError> {
    let fit = document.estimate.as_ref().map(|_| document.fit()).transpose()?;
    let models = [Model { name: "model".into(), document: document.clone(), fit }];
    Ok(pole_table(&rows(&models)?, &models, level))
}

/// Poles and zeros of every way through every model.
fn rows(models: &[Model]) -> Result<Vec<Row>, IdentError> {
    let mut rows = Vec::new();
    for (number, model) in models.iter().enumerate() {
        for channel in channels(model) {
            let (poles, zeros) = roots(model, channel)?;
            let name = channel_name(model, channel);
            let row = |is_pole| {
                let name = name.clone();
                move |root| Row { model: number, channel: name.clone(), is_pole, root }
            };
            rows.extend(poles.into_iter().map(row(true)));
            rows.extend(zeros.into_iter().map(row(false)));
        }
    }
    Ok(rows)
}

struct Row {
    model: usize,
    channel: String,
    is_pole: bool,
    root: UncertainRoot,
}

impl Row {
    fn kind(&self) -> &'static str {
        if self.is_pole { "pole" } else { "zero" }
    }

    fn mode(&self, models: &[Model]) -> Mode {
        let sample_time_s = models[self.model].document.model.system().ok().and_then(|s| s.sample_time_s());
        Mode::new(self.root.value, sample_time_s)
    }
}

type Roots = (Vec<UncertainRoot>, Vec<UncertainRoot>);

/// Poles and zeros of a channel; without an estimate they carry no uncertainty.
fn roots(model: &Model, (output, input): (usize, usize)) -> Result<Roots, IdentError> {
    if let Some(fit) = &model.fit {
        return Ok((fit.poles(output, input)?, fit.zeros(output, input)?));
    }
    let zpk = model.document.model.system()?.to_zero_pole_gain(output, input)?;
    let certain = |value: &Complex64| UncertainRoot {
        value: *value,
        covariance: [[0.0; 2]; 2],
        near_multiple: false,
        degrees_of_freedom: f64::INFINITY,
    };
    Ok((zpk.poles().iter().map(certain).collect(), zpk.zeros().iter().map(certain).collect()))
}

fn pole_table(rows: &[Row], models: &[Model], level: f64) -> Table {
    let columns = [
        ("model", Align::Left),
        ("", Align::Left),
        ("value", Align::Right),
        ("frequency", Align::Right),
        ("damping", Align::Right),
        ("region", Align::Left),
    ];
    let mut table = Table::new(&columns);
    for row in rows {
        let (value, mode, ellipse) = (row.root.value, row.mode(models), row.root.ellipse(level));
        let imaginary = if value.im == 0.0 {
            String::new()
        } else {
            format!(" {} {}i", if value.im < 0.0 { '−' } else { '+' }, significant(value.im.abs()))
        };
        let region = match (ellipse.semi_major, row.root.near_multiple) {
            (0.0, _) => "–".to_owned(),
            (_, true) => "near another root: no region".to_owned(),
            (major, false) => format!("half axes {} and {}", significant(major), significant(ellipse.semi_minor)),
        };
        table.row([
            format!("{}, {}", models[row.model].name, row.channel).into(),
            row.kind().into(),
            format!("{}{imaginary}", significant(value.re)).into(),
            format!("{} Hz", significant(mode.natural_frequency_rad_s / TAU)).into(),
            significant(mode.damping).into(),
            region.into(),
        ]);
    }
    table
}

/// The complex plane: one figure for discrete models, one for continuous ones.
fn pole_figures(rows: &[Row], models: &[Model], level: f64) -> Vec<Figure> {
    let is_discrete = |m: &Model| m.document.model.system().is_ok_and(|s| s.sample_time_s().is_some());
    let plane = |discrete: bool| {
        let chosen: Vec<usize> = (0..models.len()).filter(|n| is_discrete(&models[*n]) == discrete).collect();
        (!chosen.is_empty()).then(|| plane(rows, models, &chosen, (level, discrete)))
    };
    [plane(true), plane(false)].into_iter().flatten().collect()
}

fn plane(rows: &[Row], models: &[Model], chosen: &[usize], (level, discrete): (f64, bool)) -> Figure {
    let mut layers = Vec::new();
    if discrete {
        let circle: Vec<Complex64> = (0..=360).map(|n| Complex64::cis(f64::from(n).to_radians())).collect();
        layers.push(path("unit circle", Style::Measured, &circle));
    }
    for row in rows.iter().filter(|row| chosen.contains(&row.model)) {
        let style = Style::of_model(row.model);
        let ellipse = row.root.ellipse(level);
        if ellipse.semi_major.is_finite() && ellipse.semi_major > 0.0 && !row.root.near_multiple {
            let mut points = ellipse.points(90);
            points.extend(points.first().copied());
            layers.push(path(&format!("{} % region", 100.0 * level), style, &points));
        }
    }
    for &number in chosen {
        for (is_pole, marker, kind) in [(true, Marker::Cross, "poles"), (false, Marker::Ring, "zeros")] {
            let own = rows.iter().filter(|r| r.model == number && r.is_pole == is_pole);
            let (x, y): (Vec<f64>, Vec<f64>) = own.map(|r| (r.root.value.re, r.root.value.im)).unzip();
            let name = format!("{kind} of {}", models[number].name);
            let style = Style::of_model(number);
            layers.push(Layer::Markers { name, style, marker, x: rounded(&x), y: rounded(&y) });
        }
    }
    let unit = if discrete { "" } else { "rad/s" };
    let title = if discrete { "Poles and zeros, discrete" } else { "Poles and zeros, continuous" };
    let panel = Panel::new(Axis::linear("imaginary part", unit), 420, layers);
    Figure::new(title, Axis::linear("real part", unit), vec![panel]).with_equal_axes()
}

fn path(name: &str, style: Style, points: &[Complex64]) -> Layer {
    let (x, y): (Vec<f64>, Vec<f64>) = points.iter().map(|p| (p.re, p.im)).unzip();
    Layer::Path { name: name.to_owned(), style, x: rounded(&x), y: rounded(&y) }
}
