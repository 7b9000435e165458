//! Frequency responses.

use std::f64::consts::{PI, TAU};

use ident::IdentError;
use ident::uncertainty::{Dynamics, Feature};
use lti::{LtiError, Margins, StateSpace, common_frequency_grid};
use page::Axis;
use page::decimal::{digits, with_range};
use signal::Complex64;

use super::curves::{Curve, Curves, Over, Quantity, unstable};
use super::facts::Fact;
use super::model::{LoopMargins, Model, channel_name, channels};
use crate::words::ratio_unit;

/// Frequencies of a Bode plot.
const FREQUENCIES: usize = 400;
/// A gain at rest this small beside the largest gain is rounding of zero; one this near to one is one.
const ROUNDING: f64 = 1e-9;

/// Frequency responses, models of one channel in one figure.
///
/// # Errors
/// Where a model has no frequency response, or no uncertainty of it.
pub fn bode(models: Vec<Model>, level: f64) -> Result<Curves, IdentError> {
    let systems = models.iter().map(|model| model.document.model.system());
    let systems: Vec<StateSpace> = systems.collect::<Result<_, LtiError>>()?;
    let all = common_frequency_grid(&systems, FREQUENCIES)?;
    let mut curves = Vec::new();
    for (number, model) in models.iter().enumerate() {
        // All on one grid, so that curves can be compared point by point, each up to where it ends.
        let nyquist = model.sample_time_s().map_or(f64::INFINITY, |t| PI / t);
        let omega: Vec<f64> = all.iter().copied().filter(|omega| *omega <= nyquist).collect();
        for (output, input) in channels(model) {
            curves.push(curve(model, number, output, input, &omega, level)?);
        }
    }
    Ok(Curves { models, curves, over: Over::Frequency, level })
}

fn curve(
    model: &Model,
    number: usize,
    output: usize,
    input: usize,
    omega: &[f64],
    level: f64,
) -> Result<Curve, IdentError> {
    let response = model.document.model.frequency_response(output, input, omega)?;
    let band = model.fit.as_ref().map(|fit| fit.frequency_band(output, input, omega)).transpose()?;
    let magnitude = band.as_ref().map(|b| b.magnitude(level).iter().map(|(l, h)| (decibel(*l), decibel(*h))).collect());
    let phase = band.as_ref().map(|b| b.phase_deg(level));
    Ok(Curve {
        model: number,
        channel: channel_name(model, output, input),
        x: response.freq_hz(),
        quantities: vec![
            Quantity { axis: Axis::linear("magnitude", "dB"), values: response.magnitude_db(), band: magnitude },
            Quantity { axis: Axis::angle("phase"), values: response.phase_deg(), band: phase },
        ],
        summary: summary(model, output, input, omega, &response.response, level)?,
    })
}

fn decibel(gain: f64) -> f64 {
    20.0 * gain.log10()
}

fn summary(
    model: &Model,
    output: usize,
    input: usize,
    omega: &[f64],
    response: &[Complex64],
    level: f64,
) -> Result<Vec<Fact>, IdentError> {
    let features = model.features(output, input);
    let in_hertz = |name: &str, f: &Feature| {
        Fact::number(name, f.value / TAU, "Hz", f.interval(level).map(|(low, high)| (low / TAU, high / TAU)))
    };
    let growing = model.growing_mode()?;
    let largest = response.iter().map(|gain| gain.norm()).fold(0.0, f64::max);
    let at_rest = features.dc_gain()?.map(|gain| (cleaned(gain.value, largest), gain.interval(level)));
    let mut facts = match &growing {
        Some(mode) => vec![unstable(mode, "it has no static gain and no bandwidth")],
        None => vec![gain_at_rest(model, at_rest, output, input)],
    };
    for resonance in features.resonances(omega)? {
        let gain = &resonance.gain;
        let interval = gain.interval(level).map(|(low, high)| (decibel(low), decibel(high)));
        let height = with_range(decibel(gain.value), "dB", interval);
        facts.push(in_hertz("resonance", &resonance.omega_rad_s).noted(height));
    }
    if growing.is_some() {
        return Ok(facts);
    }
    if let Some(bandwidth) = features.bandwidth_rad_s(omega)? {
        facts.push(in_hertz("bandwidth (−3 dB)", &bandwidth));
    }
    match model.margins {
        LoopMargins::OfModel => {
            // What reaches its input exactly at rest is a closed loop: closing it once more means nothing.
            let is_closed = at_rest.is_some_and(|(gain, _)| gain == 1.0);
            let is_of_one_kind = model.document.outputs[output].unit == model.document.inputs[input].unit;
            if !model.is_noise && is_of_one_kind && !is_closed {
                facts.extend(margins(&features.margins(omega)?));
            }
        }
        LoopMargins::Within { gain_db, phase_deg, crossover_hz } if (output, input) == (0, 0) => {
            let opened = "of the speed loop, opened at the controller";
            facts.push(Fact::number("gain margin", gain_db, "dB", None).noted(opened.to_owned()));
            let at = format!("at {} Hz, {opened}", digits(crossover_hz, 4));
            facts.push(Fact::number("phase margin", phase_deg, "°", None).noted(at));
        }
        LoopMargins::Within { .. } | LoopMargins::None => {}
    }
    Ok(facts)
}

/// A gain at rest without the rounding of zero and of one.
fn cleaned(gain: f64, largest: f64) -> f64 {
    match gain {
        _ if gain.abs() < ROUNDING * largest => 0.0,
        _ if (gain - 1.0).abs() < ROUNDING => 1.0,
        _ => gain,
    }
}

/// The gain at rest with its interval; none where the model integrates.
fn gain_at_rest(model: &Model, gain: Option<(f64, Option<(f64, f64)>)>, output: usize, input: usize) -> Fact {
    let unit = ratio_unit(&model.document.outputs[output].unit, &model.document.inputs[input].unit);
    match gain {
        Some((0.0, _)) => Fact::number("gain at rest", 0.0, &unit, None),
        Some((gain, interval)) => {
            Fact::number("gain at rest", gain, &unit, interval).noted(format!("{} dB", digits(decibel(gain.abs()), 4)))
        }
        None => Fact::remark("gain at rest", "infinite: the model integrates"),
    }
}

/// How far the loop that the model alone would close is from its stability limit: where output and input are of one
/// kind, so that they can be subtracted.
fn margins(margins: &Margins) -> Vec<Fact> {
    let remark = |omega: f64| format!("at {} Hz, closed with a unit feedback", digits(omega / TAU, 4));
    let smallest = margins.gain.iter().filter(|m| m.gain_db.is_finite());
    let gain = smallest.min_by(|a, b| a.gain_db.abs().total_cmp(&b.gain_db.abs()));
    let phase = margins.phase.iter().min_by(|a, b| a.phase_deg.abs().total_cmp(&b.phase_deg.abs()));
    let gain = gain.map(|m| Fact::number("gain margin", m.gain_db, "dB", None).noted(remark(m.omega_rad_s)));
    let phase = phase.map(|m| Fact::number("phase margin", m.phase_deg, "°", None).noted(remark(m.omega_rad_s)));
    gain.into_iter().chain(phase).collect()
}
