//! Power spectra and frequency responses.

mod coherence;
mod confidence;
mod excitation;
mod facts;
mod lines;

use ident::{Dataset, Experiment};
use page::decimal::{digits, fixed, range};
use page::{Abscissa, Align, Axis, Blocks, Figure, Layer, Page, Panel, Style, Table, Tone, rounded};
use signal::SignalError;
use signal::frf::{BlackmanTukey, Etfe, FrequencyResponse, LocalKind, LocalModel, repeated_response, suited_response};
use signal::spectrum::{SpectralPeak, Welch, cross_spectrum, peaks, power_spectrum, top_range};

use crate::blocks::{finding, heading, line, name};
use crate::figures::figure;
use crate::level::LEVEL;
use crate::words::ratio_unit;
use coherence::Coherence;
use confidence::FALSE_ALARM;
use excitation::Excitation;
use lines::{Curve, Lines};

pub use facts::{CoherenceFacts, PeakFacts, PeakWidth, PeriodicFacts, SpectrumFacts};

/// Decibels by which a peak stands out of what is around it, at least.
const PROMINENCE_DB: f64 = 6.0;
/// Frequencies to either side over which the quotient of Fourier transforms is smoothed.
const ETFE_HALF_WIDTH: usize = 3;
/// Peaks listed.
const LISTED: usize = 10;

/// A curve over frequency with its band.
pub struct Spectrum {
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
    /// Of a response to inputs that repeat.
    lines: Option<Lines>,
    /// True for each frequency with a value; where there is none the input has next to no power.
    known: Vec<bool>,
    /// True if inputs repeat and their periods are not averaged.
    leaks: bool,
    /// Where local polynomials miss a resonance, Hz, and whether the response is by them all the same.
    missed: Option<(f64, bool)>,
}

impl Spectrum {
    fn peaks(&self) -> Vec<SpectralPeak> {
        let excess = 10f64.powf(PROMINENCE_DB / self.decibels);
        peaks(&self.freq_hz, &self.magnitude, &self.all_hold, self.lobe, excess)
    }

    /// Half the width within which peaks cannot be separated.
    fn resolution_hz(&self) -> f64 {
        let spacing = self.freq_hz.get(1).zip(self.freq_hz.first()).map_or(0.0, |(b, a)| b - a);
        0.5 * self.lobe as f64 * spacing
    }

    /// Where the top of a peak may lie: what the intervals allow, and what frequencies cannot be separated.
    fn top_hz(&self, peak: &SpectralPeak) -> (f64, f64) {
        let top = top_range(&self.all_hold, peak.index);
        let resolution_hz = self.resolution_hz();
        ((self.freq_hz[*top.start()] - resolution_hz).max(0.0), self.freq_hz[*top.end()] + resolution_hz)
    }

    fn curve(&self) -> Curve<'_> {
        let Spectrum { freq_hz, magnitude, band, all_hold, unit, .. } = self;
        Curve { freq_hz, magnitude, band, all_hold, unit }
    }

    /// Without values where nothing is known.
    fn only_where(mut self, known: Vec<bool>) -> Self {
        for (k, _) in known.iter().enumerate().filter(|(_, known)| !**known) {
            self.magnitude[k] = f64::NAN;
            self.phase_deg.iter_mut().for_each(|phase| phase[k] = f64::NAN);
            (self.band[k], self.all_hold[k]) = ((f64::NAN, f64::NAN), (f64::NAN, f64::NAN));
        }
        Spectrum { known, ..self }
    }

    fn facts(&self) -> SpectrumFacts {
        SpectrumFacts {
            channel: self.channel.clone(),
            unit: self.unit.clone(),
            frequency_hz: self.freq_hz.clone(),
            magnitude: self.magnitude.clone(),
            phase_deg: self.phase_deg.clone(),
            interval_95: self.band.clone(),
            peaks: self.peaks().iter().map(|peak| self.peak_facts(peak)).collect(),
            coherence: self.coherence.as_ref().map(Coherence::facts),
            periodic: self.lines.as_ref().map(Lines::facts),
            without_value_hz: excitation::ranges(&self.freq_hz, &self.known),
        }
    }

    fn peak_facts(&self, peak: &SpectralPeak) -> PeakFacts {
        match &self.lines {
            Some(lines) => lines.peak_facts(self.curve(), peak, self.excess_db(peak)),
            None => PeakFacts {
                frequency_hz: self.freq_hz[peak.index],
                frequency_interval_95_hz: self.top_hz(peak),
                magnitude: self.magnitude[peak.index],
                interval_95: self.band[peak.index],
                excess_db: self.excess_db(peak),
                width: PeakWidth::OfCurve { resolution_hz: self.resolution_hz() },
            },
        }
    }

    fn excess_db(&self, peak: &SpectralPeak) -> f64 {
        self.decibels * peak.excess.log10()
    }
}

/// How a frequency response is estimated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SpectrumMethod {
    /// Averaged periodograms.
    Welch,
    /// Windowed correlations.
    BlackmanTukey,
    /// The local polynomial method.
    Lpm,
    /// The local rational method.
    Lrm,
    /// The quotient of the Fourier transforms.
    Etfe,
}

impl SpectrumMethod {
    fn name(self) -> &'static str {
        match self {
            SpectrumMethod::Welch => "welch",
            SpectrumMethod::BlackmanTukey => "blackman-tukey",
            SpectrumMethod::Lpm => "lpm",
            SpectrumMethod::Lrm => "lrm",
            SpectrumMethod::Etfe => "etfe",
        }
    }
}

/// Treatment of inputs that repeat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Periods {
    /// Periods are found, and averaged.
    Found,
    /// Periods of this length, in seconds, are averaged.
    Given(f64),
    /// Nothing.
    Ignored,
}

/// The method, and the length of its window where one is given.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpectrumOptions {
    /// The method; without inputs it is Welch's, and where inputs repeat the mean over periods takes its place. None is
    /// the local polynomial method, or the local rational one where polynomials miss a resonance.
    pub method: Option<SpectrumMethod>,
    /// Treatment of inputs that repeat.
    pub periods: Periods,
    /// Samples of a segment or of the lag window; an eighth of the record, 1024 at most, where none is given.
    pub window: Option<usize>,
}

/// Of each recording the power spectra of the outputs, or, where there are inputs, the responses of each output to
/// them.
///
/// # Errors
/// Where the data are too short for the method.
pub fn spectra(data: &Dataset, options: &SpectrumOptions) -> Result<Vec<Spectrum>, SignalError> {
    match data.inputs() {
        0 => powers(data, options),
        _ => responses(data, options),
    }
}

/// The peaks that stand out most, by rising frequency, and the spectra drawn.
pub fn page(spectra: &[Spectrum]) -> Page {
    let mut all: Blocks = spectra.iter().map(text).collect();
    all.push(spectra.iter().map(drawn).collect::<Blocks>());
    Page::new("Spectra", all.into_vec())
}

/// The spectra in numbers.
pub fn facts(spectra: &[Spectrum]) -> Vec<SpectrumFacts> {
    spectra.iter().map(Spectrum::facts).collect()
}

fn text(s: &Spectrum) -> Blocks {
    let mut all = Blocks::from(heading(&s.channel));
    all.push(s.coherence.iter().map(|coherence| line(coherence.sentence())).collect::<Blocks>());
    all.push(s.lines.iter().map(|lines| lines.text(&s.freq_hz)).collect::<Blocks>());
    all.push(excitation::sentence(&s.freq_hz, &s.known).into_iter().map(line).collect::<Blocks>());
    if s.leaks {
        let text = "the input repeats, and this method takes what leaks between its lines for response; leave out --period none";
        all.push(finding(Tone::Caution, "periodic input", text));
    }
    match s.missed {
        Some((freq_hz, true)) => all.push(finding(
            Tone::Caution,
            "warning",
            &format!(
                "a resonance near {} Hz is narrower than local polynomials follow: magnitudes and intervals near it are too low; take --method lrm",
                digits(freq_hz, 3)
            ),
        )),
        Some((freq_hz, false)) => all.push(line(format!(
            "by local rational models (lrm), since local polynomials miss a resonance near {} Hz",
            digits(freq_hz, 3)
        ))),
        None => {}
    }
    if s.freq_hz.is_empty() {
        return all;
    }
    let mut found = s.peaks();
    if found.is_empty() {
        let above = format!("no peak is {PROMINENCE_DB} dB, and more than chance, above its surroundings");
        all.push(line(format!("no peaks: {above}")));
        return all;
    }
    let count = found.len();
    found.sort_by(|a, b| b.excess.total_cmp(&a.excess));
    found.truncate(LISTED);
    found.sort_by_key(|peak| peak.index);
    match &s.lines {
        Some(lines) => all.push(lines.table(s.curve(), &found)),
        None => all.push(table(s, &found)),
    }
    if count > LISTED {
        all.push(line(format!("the {LISTED} of {count} peaks that stand out most; all with --json")));
    }
    all
}

fn table(s: &Spectrum, peaks: &[SpectralPeak]) -> Table {
    let mut table = Table::new(&[
        ("peak at", Align::Right),
        ("its top lies within (95 %)", Align::Left),
        ("magnitude", Align::Right),
        ("above its surroundings", Align::Right),
        ("95 % interval of the magnitude", Align::Left),
    ]);
    for peak in peaks {
        table.row([
            format!("{} Hz", digits(s.freq_hz[peak.index], 5)).into(),
            format!("{} Hz", range(Some(s.top_hz(peak)))).into(),
            name(&format!("{} {}", digits(s.magnitude[peak.index], 4), s.unit)),
            format!("{} dB", fixed(s.excess_db(peak), 1)).into(),
            range(Some(s.band[peak.index])).into(),
        ]);
    }
    table
}

fn window(options: &SpectrumOptions, samples: usize) -> usize {
    options.window.unwrap_or_else(|| usual_window(samples))
}

/// Samples of a segment where none are given: an eighth of the record, 1024 at most.
#[must_use]
pub fn usual_window(samples: usize) -> usize {
    (samples / 8).clamp(16, 1024).min(samples)
}

/// Power spectral densities of the outputs.
fn powers(data: &Dataset, options: &SpectrumOptions) -> Result<Vec<Spectrum>, SignalError> {
    let mut all = Vec::new();
    for experiment in data.experiments() {
        for (output, label) in data.output_labels().iter().enumerate() {
            let welch = Welch::half_overlapping(window(options, experiment.len()));
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
                lines: None,
                known: Vec::new(),
                leaks: false,
                missed: None,
            });
        }
    }
    Ok(all)
}

/// The unit of a power density.
#[must_use]
pub fn squared_per_hertz(unit: &str) -> String {
    match unit {
        "" => "1/Hz".to_owned(),
        unit if unit.chars().all(char::is_alphabetic) => format!("{unit}²/Hz"),
        unit => format!("({unit})²/Hz"),
    }
}

/// Frequency responses from every input to every output, of each recording.
fn responses(data: &Dataset, options: &SpectrumOptions) -> Result<Vec<Spectrum>, SignalError> {
    let mut all = Vec::new();
    for experiment in data.experiments() {
        let inputs: Vec<&[f64]> = (0..data.inputs()).map(|k| experiment.input(k)).collect();
        let outputs: Vec<&[f64]> = (0..data.outputs()).map(|k| experiment.output(k)).collect();
        let period_s = if let Periods::Given(period_s) = options.periods { Some(period_s) } else { None };
        let shortest = 8.min(experiment.len());
        let repeated = match experiment.len() > shortest {
            true => repeated_response(&inputs, &outputs, data.sample_time_s(), period_s)?,
            false => None,
        };
        match repeated {
            Some(found) if options.periods != Periods::Ignored => {
                let instead_of = options.method.map(SpectrumMethod::name);
                all.extend(named(data, experiment, |output, input, name, unit| {
                    let response = &found.responses[input];
                    let lines = Lines::new(&found, response, output, experiment, data.sample_time_s(), instead_of);
                    Ok(Spectrum { lines: Some(lines), ..one_response(response, output, 0, name, unit) })
                })?);
            }
            repeated => all.extend(unrepeated(data, experiment, &inputs, repeated.is_some(), options)?),
        }
    }
    Ok(all)
}

/// One response from each input to each output, with its name and its unit.
fn named(
    data: &Dataset,
    experiment: &Experiment,
    one: impl Fn(usize, usize, String, String) -> Result<Spectrum, SignalError>,
) -> Result<Vec<Spectrum>, SignalError> {
    let mut all = Vec::new();
    for (output, label) in data.output_labels().iter().enumerate() {
        for (input, input_label) in data.input_labels().iter().enumerate() {
            let name = format!("{} → {}, {}", input_label.name, label.name, experiment.name);
            all.push(one(output, input, name, ratio_unit(&label.unit, &input_label.unit))?);
        }
    }
    Ok(all)
}

/// By a method that takes any input.
fn unrepeated(
    data: &Dataset,
    experiment: &Experiment,
    inputs: &[&[f64]],
    leaks: bool,
    options: &SpectrumOptions,
) -> Result<Vec<Spectrum>, SignalError> {
    let sample_time_s = data.sample_time_s();
    let welch = Welch::half_overlapping(window(options, experiment.len()));
    let whole: Vec<Found> = (0..data.outputs())
        .map(|output| response(inputs, experiment.output(output), sample_time_s, options))
        .collect::<Result<_, _>>()?;
    named(data, experiment, |output, input, name, unit| {
        let coherence = match inputs {
            [u] => Coherence::of(u, experiment.output(output), sample_time_s, welch)?,
            _ => None,
        };
        let excitation = Excitation::of(inputs[input], sample_time_s, welch)?;
        let Found { response, lobe, missed } = &whole[output];
        let known = excitation.known(&response.freq_hz, coherence.as_ref());
        let plain = one_response(response, 0, input, name, unit);
        let one = Spectrum { lobe: *lobe, coherence, leaks, missed: *missed, ..plain };
        Ok(one.only_where(known))
    })
}

/// A response, the frequencies to either side from which its method takes what it says of one, and where local
/// polynomials miss a resonance.
struct Found {
    response: FrequencyResponse,
    lobe: usize,
    missed: Option<(f64, bool)>,
}

fn response(inputs: &[&[f64]], y: &[f64], sample_time_s: f64, options: &SpectrumOptions) -> Result<Found, SignalError> {
    let samples = window(options, y.len());
    let found = |response: FrequencyResponse, lobe: usize| Ok(Found { response, lobe, missed: None });
    let by = |kind: LocalKind| match kind {
        LocalKind::Polynomial => LocalModel::polynomial(2, inputs.len()),
        LocalKind::Rational => LocalModel::rational(2, inputs.len()),
    };
    match options.method {
        None => {
            let suited = suited_response(inputs, y, sample_time_s)?;
            let missed = suited.missed_hz.map(|freq_hz| (freq_hz, false));
            Ok(Found { response: suited.estimate.response, lobe: by(suited.kind).half_width, missed })
        }
        Some(SpectrumMethod::Lpm) => {
            let missed_hz = suited_response(inputs, y, sample_time_s)?.missed_hz;
            let model = by(LocalKind::Polynomial);
            let response = model.estimate(inputs, &[y], sample_time_s)?.response;
            Ok(Found { response, lobe: model.half_width, missed: missed_hz.map(|freq_hz| (freq_hz, true)) })
        }
        Some(SpectrumMethod::Lrm) => {
            let model = by(LocalKind::Rational);
            found(model.estimate(inputs, &[y], sample_time_s)?.response, model.half_width)
        }
        Some(SpectrumMethod::BlackmanTukey) => {
            found(BlackmanTukey::new(samples).estimate(inputs, y, sample_time_s)?.response, 2)
        }
        Some(SpectrumMethod::Etfe) => {
            let etfe = Etfe { half_width: ETFE_HALF_WIDTH, period: None };
            found(etfe.estimate(inputs[0], y, sample_time_s)?, ETFE_HALF_WIDTH)
        }
        Some(SpectrumMethod::Welch) => {
            let cross = cross_spectrum(inputs[0], y, sample_time_s, Welch::half_overlapping(samples))?;
            let (response, variance) = (cross.response_h1(), cross.response_h1_variance());
            // Two go into the response.
            let degrees_of_freedom = vec![cross.degrees_of_freedom - 2.0; response.len()];
            let freq_hz = cross.freq_hz;
            found(FrequencyResponse { freq_hz, outputs: 1, inputs: 1, response, variance, degrees_of_freedom }, 2)
        }
    }
}

fn one_response(whole: &FrequencyResponse, output: usize, input: usize, channel: String, unit: String) -> Spectrum {
    let gains = whole.response_of(output, input);
    Spectrum {
        channel,
        unit,
        freq_hz: whole.freq_hz.clone(),
        magnitude: gains.iter().map(|g| g.norm()).collect(),
        decibels: 20.0,
        // Not unwrapped: through noise that goes astray by many turns.
        phase_deg: Some(gains.iter().map(|g| g.arg().to_degrees()).collect()),
        band: whole.magnitude_interval(output, input, LEVEL),
        all_hold: whole.magnitude_interval(output, input, 1.0 - 2.0 * FALSE_ALARM / gains.len().max(1) as f64),
        lobe: 1,
        coherence: None,
        lines: None,
        known: Vec::new(),
        leaks: false,
        missed: None,
    }
}

fn drawn(spectrum: &Spectrum) -> Figure {
    let style = Style::Modelled;
    let first = spectrum.freq_hz.iter().position(|f| *f > 0.0).unwrap_or(0);
    let x = &spectrum.freq_hz[first..];
    let layers = match &spectrum.lines {
        Some(_) => lines::layers(spectrum.curve()),
        None => curve(spectrum, first),
    };
    let mut panels = vec![Panel::new(Axis::log("magnitude", &spectrum.unit), 200, layers)];
    if let Some(phase) = &spectrum.phase_deg {
        let dots = Layer::dots("estimate", style, x, &phase[first..]);
        panels.push(Panel::new(Axis::angle("phase").within(-190.0, 190.0), 130, vec![dots]));
    }
    panels.extend(spectrum.coherence.as_ref().map(Coherence::panel));
    figure(&spectrum.channel, Axis::frequency(), panels)
}

fn curve(spectrum: &Spectrum, first: usize) -> Vec<Layer> {
    let (style, x) = (Style::Modelled, &spectrum.freq_hz[first..]);
    let (low, high): (Vec<f64>, Vec<f64>) = spectrum.band[first..].iter().copied().unzip();
    let name = "estimate".to_owned();
    let band = Layer::Band { name, style, x: Abscissa::Values(rounded(x)), low: rounded(&low), high: rounded(&high) };
    vec![band, Layer::curve("estimate", style, x, &spectrum.magnitude[first..])]
}
