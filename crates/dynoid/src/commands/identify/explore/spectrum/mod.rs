//! `dynoid data spectrum`: power spectra and frequency responses.

mod coherence;

use dataset::CommonClock;
use ident::Dataset;
use ident::distributions::interval as student_interval;
use page::{Abscissa, Align, Axis, Figure, Layer, Panel, Style, Table, Tone as Text, rounded};
use signal::frf::{BlackmanTukey, Etfe, FrequencyResponse, LocalModel};
use signal::spectrum::{SpectralPeak, Welch, cross_spectrum, peaks, power_spectrum, top_range};

use crate::commands::identify::data::{Gaps, Loaded, check_movement, check_plot, load_on};
use crate::commands::identify::figures::figure;
use crate::commands::identify::judge::{picture, written};
use crate::commands::identify::words::{digits, range, ratio_unit};
use coherence::Coherence;

use crate::cli::identify::{SpectrumArguments, SpectrumMethod};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// Confidence of bands.
const LEVEL: f64 = 0.95;
/// Probability that chance makes a peak anywhere in a spectrum.
const FALSE_ALARM: f64 = 0.05;
/// Decibels by which a peak stands out of what is around it, at least.
const PROMINENCE_DB: f64 = 6.0;
/// Frequencies to either side over which the quotient of Fourier transforms is smoothed.
const ETFE_HALF_WIDTH: usize = 3;
/// Peaks listed.
const LISTED: usize = 10;

/// A curve over frequency with its band.
struct Spectrum {
    channel: String,
    unit: String,
    freq_hz: Vec<f64>,
    magnitude: Vec<f64>,
    /// The factor from the logarithm to decibels: 10 of powers, 20 of gains.
    decibels: f64,
    phase_deg: Option<Vec<f64>>,
    band: Vec<(f64, f64)>,
    /// Intervals so wide that chance hardly leaves the truth outside of any.
    all_hold: Vec<(f64, f64)>,
    /// Values to either side that hold a part of the same peak.
    lobe: usize,
    /// That of the channels of a response, where there is but one input.
    coherence: Option<Coherence>,
}

impl Spectrum {
    fn peaks(&self) -> Vec<SpectralPeak> {
        let excess = 10f64.powf(PROMINENCE_DB / self.decibels);
        peaks(&self.freq_hz, &self.magnitude, &self.all_hold, self.lobe, excess)
    }

    /// Half the width within which peaks cannot be told apart.
    fn resolution_hz(&self) -> f64 {
        let spacing = self.freq_hz.get(1).zip(self.freq_hz.first()).map_or(0.0, |(b, a)| b - a);
        0.5 * self.lobe as f64 * spacing
    }

    /// Where the top of a peak may lie: what the intervals allow, and what frequencies cannot be told apart.
    fn top_hz(&self, peak: &SpectralPeak) -> (f64, f64) {
        let top = top_range(&self.all_hold, peak.index);
        let resolution_hz = self.resolution_hz();
        ((self.freq_hz[*top.start()] - resolution_hz).max(0.0), self.freq_hz[*top.end()] + resolution_hz)
    }

    fn excess_db(&self, peak: &SpectralPeak) -> f64 {
        self.decibels * peak.excess.log10()
    }
}

/// `dynoid data spectrum`
pub(crate) fn spectrum(arguments: &SpectrumArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &[&arguments.data.recordings])?;
    let loaded = load_on(CommonClock::Slowest, &arguments.data, terminal)?;
    // Of a single channel there is a spectrum whatever it does; a response needs both to move.
    if loaded.data.inputs() > 0 {
        check_movement(&loaded)?;
    }
    let data = without_gaps(loaded, terminal)?;
    check_window(arguments, &data)?;
    let failed = |source: signal::SignalError| CliError::identify("the spectrum", source.into());
    check_method(arguments, data.inputs())?;
    let spectra = match data.inputs() {
        0 => powers(&data, arguments),
        _ => responses(&data, arguments),
    };
    let spectra = spectra.map_err(failed)?;
    picture(&arguments.result, "Spectra", || spectra.iter().map(drawn).collect())?;
    if arguments.result.json {
        terminal.json(&spectra.iter().map(json).collect::<Vec<_>>())?;
    } else if !terminal.is_quiet() {
        spectra.iter().for_each(|s| print(s, terminal));
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::Done)
}

/// Of each recording the longest stretch in which nothing is missing.
fn without_gaps(loaded: Loaded, terminal: &mut Terminal) -> Result<Dataset, CliError> {
    let known = loaded.notes.len();
    let cut = loaded.cut_at(Gaps::OfAll)?;
    for note in &cut.notes[known..] {
        note.clone().with("; of each recording the longest is shown").say(terminal);
    }
    let experiments = cut.data.experiments();
    let mut longest: Vec<usize> = Vec::new();
    for (index, of) in cut.recording.iter().enumerate() {
        match longest.last_mut().filter(|last| cut.recording[**last] == *of) {
            Some(last) if experiments[index].len() > experiments[*last].len() => *last = index,
            Some(_) => {}
            None => longest.push(index),
        }
    }
    cut.data.only_experiments(&longest).map_err(|source| CliError::identify("the spectrum", source))
}

/// Refuses several inputs where a method knows but one: it would take what the others do for noise.
fn check_method(arguments: &SpectrumArguments, inputs: usize) -> Result<(), CliError> {
    match arguments.method {
        SpectrumMethod::Welch | SpectrumMethod::Etfe if inputs > 1 => Err(CliError::Usage {
            what: "--method welch and etfe take one input; lpm, lrm and blackman-tukey take several".into(),
        }),
        _ => Ok(()),
    }
}

/// Refuses windows that no recording is long enough for.
fn check_window(arguments: &SpectrumArguments, data: &Dataset) -> Result<(), CliError> {
    let shortest = data.experiments().iter().map(|e| e.len()).min().unwrap_or(0);
    match arguments.window {
        Some(window) if window < 2 || window > shortest => Err(CliError::Usage {
            what: format!("--window {window}: give at least 2, and at most the {shortest} samples on end"),
        }),
        _ => Ok(()),
    }
}

fn json(s: &Spectrum) -> serde_json::Value {
    let band: Vec<[f64; 2]> = s.band.iter().map(|(a, b)| [*a, *b]).collect();
    let peak = |p: &SpectralPeak| {
        serde_json::json!({"frequency_hz": s.freq_hz[p.index], "frequency_interval_95_hz": <[f64; 2]>::from(s.top_hz(p)),
            "resolution_hz": s.resolution_hz(),
            "magnitude": s.magnitude[p.index], "interval_95": band[p.index], "excess_db": s.excess_db(p)})
    };
    let peaks: Vec<_> = s.peaks().iter().map(peak).collect();
    serde_json::json!({"channel": s.channel, "unit": s.unit, "frequency_hz": s.freq_hz,
        "magnitude": s.magnitude, "phase_deg": s.phase_deg, "interval_95": band, "peaks": peaks,
        "coherence": s.coherence.as_ref().map(Coherence::json)})
}

/// The peaks that stand out most, by rising frequency.
fn print(s: &Spectrum, terminal: &mut Terminal) {
    terminal.heading(&s.channel, Text::Strong);
    if let Some(coherence) = &s.coherence {
        terminal.line(&coherence.sentence());
    }
    let mut found = s.peaks();
    if found.is_empty() {
        return terminal.line(&format!(
            "  no peaks: nothing stands {PROMINENCE_DB} dB, and more than chance, above what is around it"
        ));
    }
    let all = found.len();
    found.sort_by(|a, b| b.excess.total_cmp(&a.excess));
    found.truncate(LISTED);
    found.sort_by_key(|peak| peak.index);
    let columns = [
        ("peak at", Align::Right),
        ("its top lies within (95 %)", Align::Left),
        ("magnitude", Align::Right),
        ("above its surroundings", Align::Right),
        ("95 % interval of the magnitude", Align::Left),
    ];
    let mut table = Table::new(&columns);
    for peak in found {
        table.row([
            format!("{} Hz", digits(s.freq_hz[peak.index], 5)).into(),
            format!("{} Hz", range(Some(s.top_hz(&peak)))).into(),
            format!("{} {}", digits(s.magnitude[peak.index], 4), s.unit).into(),
            format!("{:.1} dB", s.excess_db(&peak)).into(),
            range(Some(s.band[peak.index])).into(),
        ]);
    }
    terminal.table(&table);
    if all > LISTED {
        terminal.line(&format!("  the {LISTED} of {all} peaks that stand out most; all with --json"));
    }
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
            let confidence = 1.0 - 2.0 * FALSE_ALARM / power.freq_hz.len() as f64;
            all.push(Spectrum {
                channel: format!("{}, {}", label.name, experiment.name),
                unit: squared_per_hertz(&label.unit),
                band: power.interval(LEVEL)?.into_iter().map(|[low, high]| (low, high)).collect(),
                all_hold: power.interval(confidence)?.into_iter().map(|[low, high]| (low, high)).collect(),
                freq_hz: power.freq_hz,
                magnitude: power.density,
                decibels: 10.0,
                phase_deg: None,
                // Half the main lobe of a Hann window.
                lobe: 2,
                coherence: None,
            });
        }
    }
    Ok(all)
}

fn squared_per_hertz(unit: &str) -> String {
    match unit {
        "" => "1/Hz".to_owned(),
        unit if unit.chars().all(char::is_alphabetic) => format!("{unit}²/Hz"),
        unit => format!("({unit})²/Hz"),
    }
}

/// Frequency responses from every input to every output, of each recording.
fn responses(data: &Dataset, arguments: &SpectrumArguments) -> Result<Vec<Spectrum>, signal::SignalError> {
    let mut all = Vec::new();
    for experiment in data.experiments() {
        let inputs: Vec<&[f64]> = (0..data.inputs()).map(|k| experiment.input(k)).collect();
        for (output, label) in data.output_labels().iter().enumerate() {
            let y = experiment.output(output);
            let welch = Welch::half_overlapping(window(arguments, y.len()));
            let response = response(&inputs, y, data.sample_time_s(), arguments)?;
            for (input, input_label) in data.input_labels().iter().enumerate() {
                let name = format!("{} → {}, {}", input_label.name, label.name, experiment.name);
                let unit = ratio_unit(&label.unit, &input_label.unit);
                let coherence = match inputs[..] {
                    [u] => Coherence::of(u, y, data.sample_time_s(), welch)?,
                    _ => None,
                };
                let lobe = lobe(arguments);
                all.push(Spectrum { lobe, coherence, ..one_response(&response, input, name, unit) });
            }
        }
    }
    Ok(all)
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
        SpectrumMethod::Etfe => {
            Etfe { half_width: ETFE_HALF_WIDTH, period: None }.estimate(inputs[0], y, sample_time_s)
        }
        SpectrumMethod::Welch => {
            let cross = cross_spectrum(inputs[0], y, sample_time_s, Welch::half_overlapping(samples))?;
            let (response, variance) = (cross.response_h1(), cross.response_h1_variance());
            // Two go into the response.
            let degrees_of_freedom = vec![cross.degrees_of_freedom - 2.0; response.len()];
            let freq_hz = cross.freq_hz;
            Ok(FrequencyResponse { freq_hz, outputs: 1, inputs: 1, response, variance, degrees_of_freedom })
        }
    }
}

/// Frequencies to either side from which a method takes what it says of one.
fn lobe(arguments: &SpectrumArguments) -> usize {
    match arguments.method {
        SpectrumMethod::Welch | SpectrumMethod::BlackmanTukey => 2,
        SpectrumMethod::Lpm => LocalModel::polynomial(2, 1).half_width,
        SpectrumMethod::Lrm => LocalModel::rational(2, 1).half_width,
        SpectrumMethod::Etfe => ETFE_HALF_WIDTH,
    }
}

fn one_response(whole: &FrequencyResponse, input: usize, channel: String, unit: String) -> Spectrum {
    let (gains, variance) = (whole.response_of(0, input), whole.variance_of(0, input));
    // The part of the variance along the gain is half of it.
    let interval = |level: f64| {
        let ends = gains.iter().zip(&variance).zip(&whole.degrees_of_freedom).map(|((g, v), freedom)| {
            let (low, high) = student_interval(g.norm(), (0.5 * v).sqrt(), *freedom, level);
            (low.max(0.0), high)
        });
        ends.collect::<Vec<_>>()
    };
    Spectrum {
        channel,
        unit,
        freq_hz: whole.freq_hz.clone(),
        magnitude: gains.iter().map(|g| g.norm()).collect(),
        decibels: 20.0,
        // Not unwrapped: through noise that goes astray by many turns.
        phase_deg: Some(gains.iter().map(|g| g.arg().to_degrees()).collect()),
        band: interval(LEVEL),
        all_hold: interval(1.0 - 2.0 * FALSE_ALARM / gains.len().max(1) as f64),
        lobe: 1,
        coherence: None,
    }
}

fn drawn(spectrum: &Spectrum) -> Figure {
    let style = Style::Modelled;
    let first = spectrum.freq_hz.iter().position(|f| *f > 0.0).unwrap_or(0);
    let x = &spectrum.freq_hz[first..];
    let (low, high): (Vec<f64>, Vec<f64>) = spectrum.band[first..].iter().copied().unzip();
    let name = "estimate".to_owned();
    let band = Layer::Band { name, style, x: Abscissa::Values(rounded(x)), low: rounded(&low), high: rounded(&high) };
    let curve = Layer::curve("estimate", style, x, &spectrum.magnitude[first..]);
    let mut panels = vec![Panel::new(Axis::log("magnitude", &spectrum.unit), 200, vec![band, curve])];
    if let Some(phase) = &spectrum.phase_deg {
        let dots = Layer::dots("estimate", style, x, &phase[first..]);
        panels.push(Panel::new(Axis::angle("phase").within(-190.0, 190.0), 130, vec![dots]));
    }
    panels.extend(spectrum.coherence.as_ref().map(Coherence::panel));
    figure(&spectrum.channel, Axis::frequency(), panels)
}
