//! Responses to inputs that repeat: values at the excited lines only.

use ident::Experiment;
use page::decimal::{digits, range};
use page::{Align, Blocks, Layer, Style, Table, Tone, rounded};
use signal::Complex64;
use signal::frf::{Estimated, FrequencyResponse, RepeatedResponse, Resonance, resonance};
use signal::spectrum::{SpectralPeak, top_range};

use super::facts::{PeakFacts, PeakWidth, PeriodicFacts};
use crate::blocks::{finding, line, name};
use crate::level::LEVEL;
use crate::words::counted;

/// Response at the lines, with the periods that it rests on.
pub(super) struct Lines {
    response: Vec<Complex64>,
    variance: Vec<f64>,
    freedom: f64,
    period_s: f64,
    period_samples: f64,
    periods: usize,
    from_s: f64,
    unsettled: usize,
    still_settling: bool,
    shared_hz: Vec<f64>,
    /// The method that was asked for, in whose place periods are averaged.
    instead_of: Option<&'static str>,
}

/// The curve that the lines belong to.
#[derive(Clone, Copy)]
pub(super) struct Curve<'a> {
    pub(super) freq_hz: &'a [f64],
    pub(super) magnitude: &'a [f64],
    pub(super) band: &'a [(f64, f64)],
    /// Intervals so wide that chance hardly leaves the truth outside of any.
    pub(super) all_hold: &'a [(f64, f64)],
    pub(super) unit: &'a str,
}

impl Curve<'_> {
    /// Where the top of a peak may lie: as far as the lines on either side.
    fn top_hz(&self, peak: &SpectralPeak) -> (f64, f64) {
        let top = top_range(self.all_hold, peak.index);
        let (before, after) = (top.start().saturating_sub(1), (top.end() + 1).min(self.freq_hz.len() - 1));
        (self.freq_hz[before], self.freq_hz[after])
    }
}

/// A peak among lines: between them, where one pole on a smooth background describes it.
struct Top {
    freq_hz: f64,
    freq_range_hz: (f64, f64),
    magnitude: f64,
    magnitude_range: Option<(f64, f64)>,
    bandwidth_hz: Option<Estimated>,
}

impl Lines {
    pub(super) fn new(
        found: &RepeatedResponse,
        response: &FrequencyResponse,
        output: usize,
        experiment: &Experiment,
        sample_time_s: f64,
        instead_of: Option<&'static str>,
    ) -> Self {
        let repetition = &found.repetition;
        Lines {
            response: response.response_of(output, 0),
            variance: response.variance_of(output, 0),
            freedom: response.degrees_of_freedom.first().copied().unwrap_or(0.0),
            period_s: repetition.period_samples * sample_time_s,
            period_samples: repetition.period_samples,
            periods: repetition.periods,
            from_s: experiment.start_s + repetition.first as f64 * sample_time_s,
            unsettled: repetition.unsettled,
            still_settling: repetition.still_settling,
            shared_hz: found.shared_hz.clone(),
            instead_of,
        }
    }

    fn resonance(&self, freq_hz: &[f64], peak: &SpectralPeak) -> Option<Resonance> {
        resonance(freq_hz, &self.response, &self.variance, self.freedom, peak.index)
    }

    fn top(&self, s: Curve<'_>, peak: &SpectralPeak) -> Top {
        match self.resonance(s.freq_hz, peak) {
            Some(found) => Top {
                freq_hz: found.freq_hz.value,
                freq_range_hz: found.freq_hz.interval(LEVEL),
                magnitude: found.height.value,
                magnitude_range: Some(found.height.interval(LEVEL)),
                bandwidth_hz: found.bandwidth_hz,
            },
            None => Top {
                freq_hz: s.freq_hz[peak.index],
                freq_range_hz: s.top_hz(peak),
                magnitude: s.magnitude[peak.index],
                magnitude_range: None,
                bandwidth_hz: None,
            },
        }
    }

    /// Period, periods and lines, and what to doubt.
    pub(super) fn text(&self, freq_hz: &[f64]) -> Blocks {
        let mut all = Blocks::from(line(self.averaged()));
        all.push(line(excited(freq_hz)));
        if self.still_settling {
            let text =
                "the output still changes from period to period; record longer, or leave out the start with --from";
            all.push(finding(Tone::Caution, "not settled", text));
        }
        if let (Some(first), Some(last)) = (self.shared_hz.first(), self.shared_hz.last()) {
            let text = format!(
                "{} between {} and {} Hz that several inputs excite are left out: one recording does not separate the \
                 inputs there; excite each input at lines of its own",
                counted(self.shared_hz.len(), "line"),
                digits(*first, 4),
                digits(*last, 4)
            );
            all.push(finding(Tone::Caution, "not separated", &text));
        }
        all
    }

    fn averaged(&self) -> String {
        let mut text = format!(
            "the input repeats every {} s ({} samples): mean of {} from {} s on",
            digits(self.period_s, 6),
            digits(self.period_samples, 8),
            counted(self.periods, "period"),
            digits(self.from_s, 5)
        );
        if self.unsettled > 0 {
            let left_out = counted(self.unsettled, "period");
            text += &format!("; {left_out} before were left out, because the output had not settled");
        }
        if let Some(method) = self.instead_of {
            text += &format!("; this takes the place of {method}, which --period none asks for");
        }
        text
    }

    pub(super) fn table(&self, s: Curve<'_>, peaks: &[SpectralPeak]) -> Blocks {
        let mut table = Table::new(&[
            ("resonance at", Align::Right),
            ("95 % interval", Align::Left),
            ("magnitude", Align::Right),
            ("95 % interval", Align::Left),
            ("−3 dB width", Align::Right),
            ("95 % interval", Align::Left),
        ]);
        let mut only_bracketed = false;
        for peak in peaks {
            let top = self.top(s, peak);
            only_bracketed |= top.magnitude_range.is_none();
            let least = if top.magnitude_range.is_none() { "at least " } else { "" };
            let width = top.bandwidth_hz.map_or("–".to_owned(), |w| format!("{} Hz", digits(w.value, 4)));
            table.row([
                format!("{} Hz", digits(top.freq_hz, 6)).into(),
                format!("{} Hz", range(Some(top.freq_range_hz))).into(),
                name(&format!("{least}{} {}", digits(top.magnitude, 4), s.unit)),
                range(top.magnitude_range.or(Some(s.band[peak.index]))).into(),
                width.into(),
                top.bandwidth_hz.map_or("–".to_owned(), |w| format!("{} Hz", range(Some(w.interval(LEVEL))))).into(),
            ]);
        }
        let mut all = Blocks::from(table);
        if only_bracketed {
            all.push(line(
                "where the lines do not determine a resonance, its top lies between the lines given; it may be higher",
            ));
        }
        all.push(line("a resonance that is much narrower than the distance of the lines may be missed between them"));
        all
    }

    pub(super) fn facts(&self) -> PeriodicFacts {
        PeriodicFacts {
            period_s: self.period_s,
            periods: self.periods,
            from_s: self.from_s,
            periods_left_out: self.unsettled,
            still_settling: self.still_settling,
            lines_shared_by_inputs_hz: self.shared_hz.clone(),
        }
    }

    pub(super) fn peak_facts(&self, s: Curve<'_>, peak: &SpectralPeak, excess_db: f64) -> PeakFacts {
        let top = self.top(s, peak);
        PeakFacts {
            frequency_hz: top.freq_hz,
            frequency_interval_95_hz: top.freq_range_hz,
            magnitude: top.magnitude,
            interval_95: top.magnitude_range.unwrap_or(s.band[peak.index]),
            excess_db,
            width: PeakWidth::AtLines {
                is_between_lines: top.magnitude_range.is_some(),
                bandwidth_hz: top.bandwidth_hz.map(|width| width.value),
                bandwidth_interval_95_hz: top.bandwidth_hz.map(|width| width.interval(LEVEL)),
            },
        }
    }
}

/// How many lines there are, where, and how far apart.
fn excited(freq_hz: &[f64]) -> String {
    let (Some(first), Some(last)) = (freq_hz.first(), freq_hz.last()) else {
        return "this input alone excites no line".to_owned();
    };
    let widest = freq_hz.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    format!(
        "{} excited, from {} to {} Hz, at most {} Hz apart; there is no value at other frequencies",
        if freq_hz.len() == 1 { "1 line is".to_owned() } else { format!("{} lines are", freq_hz.len()) },
        digits(*first, 4),
        digits(*last, 4),
        digits(widest, 4)
    )
}

/// Dots with error bars.
pub(super) fn layers(s: Curve<'_>) -> Vec<Layer> {
    let (low, high): (Vec<f64>, Vec<f64>) = s.band.iter().copied().unzip();
    let dots = Layer::dots("estimate", Style::Modelled, s.freq_hz, s.magnitude);
    match dots {
        Layer::Points { name, style, x, y, .. } => {
            vec![Layer::Points { name, style, x, y, low: Some(rounded(&low)), high: Some(rounded(&high)) }]
        }
        other => vec![other],
    }
}
