//! `dynoid spectrum`, `delay`, `order`: what data say before a model is chosen.

use ident::delay::{ArxDelay, FractionalDelay, ImpulseDelay, PhaseDelay};
use ident::distributions::normal_quantile;
use ident::{Criterion, Dataset, OrderScan, OrderTable, ScannedStructure};
use plot::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded};
use signal::frf::{BlackmanTukey, Etfe, FrequencyResponse, LocalModel};
use signal::spectrum::{Welch, cross_spectrum, power_spectrum};

use super::data::load;
use super::judge::{picture, written};
use super::words::significant;
use crate::cli::identify::{DelayArguments, OrderArguments, SpectrumArguments, SpectrumMethod};
use crate::error::{CliError, Outcome};
use crate::table::{Align, Table};
use crate::terminal::Terminal;

/// Confidence of bands.
const LEVEL: f64 = 0.95;
/// Structures listed.
const LISTED: usize = 10;

/// A curve over frequency with its band.
struct Spectrum {
    channel: String,
    unit: String,
    freq_hz: Vec<f64>,
    magnitude: Vec<f64>,
    phase_deg: Option<Vec<f64>>,
    band: Vec<(f64, f64)>,
}

/// `dynoid spectrum`
pub(crate) fn spectrum(arguments: &SpectrumArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let data = load(&arguments.data, terminal)?.data;
    let failed = |source: signal::SignalError| CliError::identify("the spectrum", source.into());
    let spectra = match data.inputs() {
        0 => powers(&data, arguments),
        _ => responses(&data, arguments),
    };
    let spectra = spectra.map_err(failed)?;
    picture(&arguments.result, "Spectra", || spectra.iter().map(figure).collect())?;
    if arguments.result.json {
        let one = |s: &Spectrum| {
            let band: Vec<[f64; 2]> = s.band.iter().map(|(a, b)| [*a, *b]).collect();
            serde_json::json!({"channel": s.channel, "unit": s.unit, "frequency_hz": s.freq_hz,
                "magnitude": s.magnitude, "phase_deg": s.phase_deg, "interval_95": band})
        };
        terminal.json(&spectra.iter().map(one).collect::<Vec<_>>())?;
    } else if !terminal.is_quiet() {
        spectra.iter().for_each(|s| terminal.table(&peaks(s)));
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

fn window(arguments: &SpectrumArguments, samples: usize) -> usize {
    arguments.window.unwrap_or((samples / 8).clamp(16, 1024).min(samples))
}

/// Power spectral densities of the outputs.
fn powers(data: &Dataset, arguments: &SpectrumArguments) -> Result<Vec<Spectrum>, signal::SignalError> {
    let mut all = Vec::new();
    for experiment in data.experiments() {
        for (output, label) in data.output_labels().iter().enumerate() {
            let welch = Welch::half_overlapping(window(arguments, experiment.len()));
            let power = power_spectrum(experiment.output(output), data.sample_time_s(), welch)?;
            all.push(Spectrum {
                channel: format!("{}, {}", label.name, experiment.name),
                unit: if label.unit.is_empty() { "1/Hz".into() } else { format!("({})²/Hz", label.unit) },
                band: power.interval(LEVEL)?.into_iter().map(|[low, high]| (low, high)).collect(),
                freq_hz: power.freq_hz,
                magnitude: power.density,
                phase_deg: None,
            });
        }
    }
    Ok(all)
}

/// Frequency responses from every input to every output, of each recording.
fn responses(data: &Dataset, arguments: &SpectrumArguments) -> Result<Vec<Spectrum>, signal::SignalError> {
    let mut all = Vec::new();
    for experiment in data.experiments() {
        let inputs: Vec<&[f64]> = (0..data.inputs()).map(|k| experiment.input(k)).collect();
        for (output, label) in data.output_labels().iter().enumerate() {
            let y = experiment.output(output);
            let response = response(&inputs, y, data.sample_time_s(), arguments)?;
            for (input, input_label) in data.input_labels().iter().enumerate() {
                let name = format!("{} → {}, {}", input_label.name, label.name, experiment.name);
                all.push(one_response(&response, input, name, ratio_unit(&label.unit, &input_label.unit)));
            }
        }
    }
    Ok(all)
}

fn ratio_unit(output: &str, input: &str) -> String {
    match (output, input) {
        ("", "") => String::new(),
        (output, "") => output.to_owned(),
        ("", input) => format!("1/({input})"),
        (output, input) => format!("{output}/({input})"),
    }
}

fn response(
    inputs: &[&[f64]],
    y: &[f64],
    sample_time_s: f64,
    arguments: &SpectrumArguments,
) -> Result<FrequencyResponse, signal::SignalError> {
    let samples = window(arguments, y.len());
    match arguments.method {
        SpectrumMethod::Lpm => {
            Ok(LocalModel::polynomial(2, inputs.len()).estimate(inputs, &[y], sample_time_s)?.response)
        }
        SpectrumMethod::Lrm => {
            Ok(LocalModel::rational(2, inputs.len()).estimate(inputs, &[y], sample_time_s)?.response)
        }
        SpectrumMethod::BlackmanTukey => Ok(BlackmanTukey::new(samples).estimate(inputs, y, sample_time_s)?.response),
        SpectrumMethod::Etfe => Etfe { half_width: 3, period: None }.estimate(inputs[0], y, sample_time_s),
        SpectrumMethod::Welch => {
            let cross = cross_spectrum(inputs[0], y, sample_time_s, Welch::half_overlapping(samples))?;
            let (response, variance) = (cross.response_h1(), cross.response_h1_variance());
            Ok(FrequencyResponse { freq_hz: cross.freq_hz, outputs: 1, inputs: 1, response, variance })
        }
    }
}

fn one_response(whole: &FrequencyResponse, input: usize, channel: String, unit: String) -> Spectrum {
    // Methods of one input answer for the first alone.
    let input = input.min(whole.inputs - 1);
    let (gains, variance) = (whole.response_of(0, input), whole.variance_of(0, input));
    // The part of the variance along the gain is half of it.
    let reach = normal_quantile(0.5 + LEVEL / 2.0);
    let band = gains.iter().zip(&variance).map(|(g, v)| {
        let half = reach * (0.5 * v).sqrt();
        ((g.norm() - half).max(0.0), g.norm() + half)
    });
    let omega = whole.freq_hz.iter().map(|f| f * std::f64::consts::TAU).collect();
    let phase = lti::FrequencyResponse::new(omega, gains.clone()).map(|r| r.phase_deg()).ok();
    Spectrum {
        channel,
        unit,
        freq_hz: whole.freq_hz.clone(),
        magnitude: gains.iter().map(|g| g.norm()).collect(),
        phase_deg: phase,
        band: band.collect(),
    }
}

fn figure(spectrum: &Spectrum) -> Figure {
    let style = Style::Modelled;
    let first = spectrum.freq_hz.iter().position(|f| *f > 0.0).unwrap_or(0);
    let x = &spectrum.freq_hz[first..];
    let (low, high): (Vec<f64>, Vec<f64>) = spectrum.band[first..].iter().copied().unzip();
    let name = "estimate".to_owned();
    let band = Layer::Band { name, style, x: Abscissa::Values(rounded(x)), low: rounded(&low), high: rounded(&high) };
    let curve = Layer::curve("estimate", style, x, &spectrum.magnitude[first..]);
    let mut panels = vec![Panel::new(Axis::log("magnitude", &spectrum.unit), 200, vec![band, curve])];
    if let Some(phase) = &spectrum.phase_deg {
        panels.push(Panel::new(
            Axis::linear("phase", "°"),
            130,
            vec![Layer::curve("estimate", style, x, &phase[first..])],
        ));
    }
    Figure::new(&spectrum.channel, Axis::frequency(), panels)
}

/// The largest peaks of a curve.
fn peaks(spectrum: &Spectrum) -> Table {
    let columns = [
        ("peaks of", Align::Left),
        ("frequency", Align::Right),
        ("magnitude", Align::Right),
        ("95 % interval", Align::Left),
    ];
    let mut table = Table::new(&columns);
    let m = &spectrum.magnitude;
    let mut at: Vec<usize> = (1..m.len().saturating_sub(1)).filter(|i| m[*i] > m[i - 1] && m[*i] >= m[i + 1]).collect();
    at.sort_by(|a, b| m[*b].total_cmp(&m[*a]));
    for i in at.into_iter().take(LISTED) {
        table.row([
            spectrum.channel.as_str().into(),
            format!("{} Hz", significant(spectrum.freq_hz[i])).into(),
            format!("{} {}", significant(m[i]), spectrum.unit).into(),
            format!("{} … {}", significant(spectrum.band[i].0), significant(spectrum.band[i].1)).into(),
        ]);
    }
    table
}

/// `dynoid delay`
pub(crate) fn delay(arguments: &DelayArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let data = load(&arguments.data, terminal)?.data;
    let failed = |source| CliError::identify("the delay", source);
    let arx = ArxDelay { highest: arguments.longest, ..ArxDelay::default() };
    let ranking = arx.estimate(&data).map_err(failed)?;
    let impulse =
        ImpulseDelay { lags: arguments.longest, ..ImpulseDelay::default() }.estimate(&data).map_err(failed)?;
    let siso = data.inputs() == 1 && data.outputs() == 1;
    let phase = siso.then(|| PhaseDelay { highest: arguments.longest, ..PhaseDelay::default() }.estimate(&data));
    let fraction = siso.then(|| FractionalDelay(arx).estimate(&data));
    let seconds = |samples: f64| significant(samples * data.sample_time_s());
    if arguments.result.json {
        let estimate = |e: Option<Result<ident::delay::DelayEstimate, ident::IdentError>>| match e {
            Some(Ok(e)) => serde_json::json!({"samples": e.samples, "standard_error": e.standard_error}),
            Some(Err(reason)) => serde_json::json!({"error": reason.to_string()}),
            None => serde_json::Value::Null,
        };
        let candidates: Vec<_> = ranking
            .candidates
            .iter()
            .take(LISTED)
            .map(|c| serde_json::json!({"samples": c.delays, "loss": c.loss, "weight": c.weight}))
            .collect();
        let starts: Vec<_> = impulse.iter().map(|i| i.delay).collect();
        terminal.json(&serde_json::json!({
            "sample_time_s": data.sample_time_s(),
            "arx": {"samples": ranking.delays, "candidates": candidates},
            "impulse_response": starts, "phase": estimate(phase), "arx_fraction": estimate(fraction),
        }))?;
    } else if !terminal.is_quiet() {
        let mut table = Table::new(&[
            ("method", Align::Left),
            ("samples", Align::Right),
            ("seconds", Align::Right),
            ("", Align::Left),
        ]);
        for (input, delay) in ranking.delays.iter().enumerate() {
            let name = format!("ARX comparison, {}", data.input_labels()[input].name);
            let weight = ranking.candidates.first().map(|c| format!("weight {:.3} among the delays tried", c.weight));
            table.row([
                name.into(),
                delay.to_string().into(),
                seconds(*delay as f64).into(),
                weight.unwrap_or_default().into(),
            ]);
        }
        for (input, start) in impulse.iter().enumerate() {
            let name = format!("impulse response, {}", data.input_labels()[input % data.inputs()].name);
            let (samples, time) =
                start.delay.map_or(("–".into(), "–".into()), |d| (d.to_string(), seconds(d as f64)));
            table.row([name.into(), samples.into(), time.into(), "first coefficient that is significant".into()]);
        }
        for (name, estimate) in [("phase of the response", phase), ("ARX, below a sample", fraction)] {
            match estimate {
                Some(Ok(e)) => {
                    let error = format!("± {} samples (standard error)", significant(e.standard_error));
                    table.row([name.into(), significant(e.samples).into(), seconds(e.samples).into(), error.into()]);
                }
                Some(Err(reason)) => table.row([name.into(), "–".into(), "–".into(), reason.to_string().into()]),
                None => {}
            }
        }
        terminal.table(&table);
    }
    let weights = || {
        let mut pairs: Vec<(f64, f64)> =
            ranking.candidates.iter().filter_map(|c| Some((*c.delays.first()? as f64, c.loss))).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (x, y): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let panel =
            Panel::new(Axis::linear("mean squared error", ""), 200, vec![Layer::curve("ARX", Style::Modelled, &x, &y)]);
        vec![Figure::new(
            "Delay by comparison of ARX models",
            Axis::linear("delay of the first input", "samples"),
            vec![panel],
        )]
    };
    picture(&arguments.result, "Delay", weights)?;
    written(&arguments.result.plot, terminal);
    Ok(Outcome::Done)
}

/// `dynoid order`
pub(crate) fn order(arguments: &OrderArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let data = load(&arguments.data, terminal)?.data;
    let failed = |source| CliError::identify("the order scan", source);
    let scan =
        OrderScan::new(range("--na", &arguments.na)?, range("--nb", &arguments.nb)?, range("--nk", &arguments.nk)?);
    let table = match arguments.split {
        Some(share) => {
            let split = data.split(super::model_file::checked_share("--split", share)?).map_err(failed)?;
            scan.run_validated(&split.estimation, &split.validation)
        }
        None => scan.run(&data),
    };
    let table = table.map_err(failed)?;
    picture(&arguments.result, "Order", || vec![loss_figure(&table)])?;
    let mut criteria = vec![
        ("AIC", Criterion::Aic),
        ("AICc", Criterion::Aicc),
        ("BIC", Criterion::Bic),
        ("FPE", Criterion::Fpe),
        ("MDL", Criterion::Mdl),
    ];
    if arguments.split.is_some() {
        criteria.push(("unseen data", Criterion::Validation));
    }
    if arguments.result.json {
        let one = |s: &ScannedStructure| {
            serde_json::json!({"na": s.na, "nb": s.nb, "nk": s.nk, "parameters": s.parameters, "loss": s.loss,
                "validation_fit_percent": s.validation_fit, "criteria": s.criteria})
        };
        let best: serde_json::Map<String, serde_json::Value> =
            criteria.iter().map(|(name, c)| ((*name).to_owned(), one(table.best(*c)))).collect();
        let all: Vec<_> = table.structures().iter().map(one).collect();
        terminal.json(&serde_json::json!({"best": best, "structures": all}))?;
    } else if !terminal.is_quiet() {
        let columns = [
            ("best by", Align::Left),
            ("na", Align::Right),
            ("nb", Align::Right),
            ("nk", Align::Right),
            ("loss", Align::Right),
            ("fit on unseen data", Align::Left),
        ];
        let mut best = Table::new(&columns);
        for (name, criterion) in criteria {
            let s = table.best(criterion);
            let fit = s.validation_fit.map_or("–".to_owned(), |f| format!("{f:.2} %"));
            best.row([
                name.into(),
                s.na.to_string().into(),
                s.nb.to_string().into(),
                s.nk.to_string().into(),
                significant(s.loss).into(),
                fit.into(),
            ]);
        }
        terminal.table(&best);
        terminal.line(&format!("{} structures on {} samples", table.structures().len(), table.samples()));
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

fn range(option: &str, text: &str) -> Result<std::ops::RangeInclusive<usize>, CliError> {
    let (first, last) = text.split_once(':').unwrap_or((text, text));
    match (first.trim().parse(), last.trim().parse()) {
        (Ok(first), Ok(last)) if first <= last => Ok(first..=last),
        _ => Err(CliError::Usage { what: format!("{option} {text}: give a number, or a range such as 1:6") }),
    }
}

/// The least loss for each number of parameters.
fn loss_figure(table: &OrderTable) -> Figure {
    let most = table.structures().iter().map(|s| s.parameters).max().unwrap_or(0);
    let least = |value: fn(&ScannedStructure) -> Option<f64>| {
        let of = |d: usize| {
            let same = table.structures().iter().filter(|s| s.parameters == d).filter_map(value);
            Some((d as f64, same.min_by(f64::total_cmp)?))
        };
        (0..=most).filter_map(of).unzip::<f64, f64, Vec<_>, Vec<_>>()
    };
    let (x, fitted) = least(|s| Some(s.loss));
    let mut layers = vec![Layer::curve("estimation data", Style::Modelled, &x, &fitted)];
    let (x, unseen) = least(|s| s.validation_loss);
    if !x.is_empty() {
        layers.push(Layer::curve("unseen data", Style::Other, &x, &unseen));
    }
    let panel = Panel::new(Axis::log("least loss", ""), 220, layers);
    Figure::new("Loss over the number of parameters", Axis::linear("parameters", ""), vec![panel])
}
