//! Butterworth design: analogue prototype, frequency transformation, bilinear transform, straight into sections.

use std::f64::consts::PI;

use super::band::Band;
use super::{Section, Sos};
use crate::Complex64;
use crate::error::{SignalError, check_range, check_sample_time};

const MAX_ORDER: usize = 20;

impl Sos {
    /// Butterworth low-pass of the given order: −3 dB at `cutoff_hz`, gain one at rest.
    ///
    /// # Errors
    /// [`SignalError::Cutoff`] unless `0 < cutoff_hz < 1/(2·sample_time_s)`, [`SignalError::Parameter`] for an order
    /// outside 1 ..= 20, [`SignalError::SampleTime`].
    ///
    /// # Source
    /// Oppenheim and Schafer, *Discrete-Time Signal Processing* (2010), ch. 7: bilinear transform, pre-warped.
    pub fn butterworth_lowpass(order: usize, cutoff_hz: f64, sample_time_s: f64) -> Result<Self, SignalError> {
        design(order, Band::Low(cutoff_hz), sample_time_s)
    }

    /// Butterworth high-pass of the given order: −3 dB at `cutoff_hz`, gain zero at rest.
    ///
    /// # Errors
    /// As [`Sos::butterworth_lowpass`].
    pub fn butterworth_highpass(order: usize, cutoff_hz: f64, sample_time_s: f64) -> Result<Self, SignalError> {
        design(order, Band::High(cutoff_hz), sample_time_s)
    }

    /// Butterworth band-pass: −3 dB at `low_hz` and `high_hz`; `order` is the prototype's, so the filter has twice
    /// that many poles.
    ///
    /// # Errors
    /// As [`Sos::butterworth_lowpass`], and [`SignalError::Cutoff`] unless `low_hz < high_hz`.
    pub fn butterworth_bandpass(
        order: usize,
        low_hz: f64,
        high_hz: f64,
        sample_time_s: f64,
    ) -> Result<Self, SignalError> {
        design(order, Band::Pass(low_hz, high_hz), sample_time_s)
    }

    /// Butterworth band-stop: −3 dB at `low_hz` and `high_hz`, gain one at rest; `order` is the prototype's.
    ///
    /// # Errors
    /// As [`Sos::butterworth_bandpass`].
    pub fn butterworth_bandstop(
        order: usize,
        low_hz: f64,
        high_hz: f64,
        sample_time_s: f64,
    ) -> Result<Self, SignalError> {
        design(order, Band::Stop(low_hz, high_hz), sample_time_s)
    }
}

/// The band with its edges pre-warped, `tan(π f T)`.
#[derive(Clone, Copy)]
enum Warped {
    Low(f64),
    High(f64),
    Pass { centre_squared: f64, width: f64 },
    Stop { centre_squared: f64, width: f64 },
}

fn design(order: usize, band: Band, sample_time_s: f64) -> Result<Sos, SignalError> {
    check_sample_time(sample_time_s)?;
    check_range("order", order as f64, 1.0, MAX_ORDER as f64)?;
    let warped = warp(band, sample_time_s)?;
    let zeros = zeros(warped);
    let mut sections = Vec::with_capacity(order);
    for k in 0..order / 2 {
        let angle = PI * (2 * k + order + 1) as f64 / (2 * order) as f64;
        let (one, two) = transform(Complex64::cis(angle), warped);
        for pole in std::iter::once(one).chain(two) {
            let z = bilinear(pole);
            sections.push(section(zeros, [-2.0 * z.re, z.norm_sqr()]));
        }
    }
    if order % 2 == 1 {
        sections.push(real_section(warped, zeros));
    }
    let reference = reference_point(warped);
    for section in &mut sections {
        // Every section gets a gain of magnitude one at the reference, which keeps intermediate results in range.
        let gain = section.at(reference).norm();
        section.b = section.b.map(|b| b / gain);
    }
    Sos::new(sections, sample_time_s)
}

fn warp(band: Band, sample_time_s: f64) -> Result<Warped, SignalError> {
    band.check(sample_time_s)?;
    let edge = |cutoff_hz: f64| (PI * cutoff_hz * sample_time_s).tan();
    Ok(match band {
        Band::Low(cutoff) => Warped::Low(edge(cutoff)),
        Band::High(cutoff) => Warped::High(edge(cutoff)),
        Band::Pass(low, high) => Warped::Pass { centre_squared: edge(low) * edge(high), width: edge(high) - edge(low) },
        Band::Stop(low, high) => Warped::Stop { centre_squared: edge(low) * edge(high), width: edge(high) - edge(low) },
    })
}

/// The analogue poles one prototype pole becomes (its conjugate gives their conjugates).
fn transform(pole: Complex64, band: Warped) -> (Complex64, Option<Complex64>) {
    match band {
        Warped::Low(edge) => (pole * edge, None),
        Warped::High(edge) => (pole.inv() * edge, None),
        Warped::Pass { centre_squared, width } => split(pole * width / 2.0, centre_squared),
        Warped::Stop { centre_squared, width } => split(pole.inv() * width / 2.0, centre_squared),
    }
}

/// Roots of `s² − 2 m s + c`.
fn split(middle: Complex64, centre_squared: f64) -> (Complex64, Option<Complex64>) {
    let root = (middle * middle - centre_squared).sqrt();
    (middle + root, Some(middle - root))
}

fn bilinear(s: Complex64) -> Complex64 {
    (s + 1.0) / (-s + 1.0)
}

/// Numerator `1 + b1 z⁻¹ + b2 z⁻²` of a full section.
fn zeros(band: Warped) -> [f64; 2] {
    match band {
        Warped::Low(_) => [2.0, 1.0],
        Warped::High(_) => [-2.0, 1.0],
        Warped::Pass { .. } => [0.0, -1.0],
        Warped::Stop { centre_squared, .. } => [-2.0 * (1.0 - centre_squared) / (1.0 + centre_squared), 1.0],
    }
}

fn section(zeros: [f64; 2], a: [f64; 2]) -> Section {
    Section { b: [1.0, zeros[0], zeros[1]], a }
}

/// The section of the prototype's real pole: first order, or second for the two poles of a band.
fn real_section(band: Warped, zeros: [f64; 2]) -> Section {
    match transform(Complex64::new(-1.0, 0.0), band) {
        (one, Some(two)) => {
            let (p, q) = (bilinear(one), bilinear(two));
            section(zeros, [-(p + q).re, (p * q).re])
        }
        (one, None) => Section { b: [1.0, zeros[0] / 2.0, 0.0], a: [-bilinear(one).re, 0.0] },
    }
}

/// Where the filter's gain is one: rest, half the sample rate, or the band's centre.
fn reference_point(band: Warped) -> Complex64 {
    match band {
        Warped::Low(_) | Warped::Stop { .. } => Complex64::new(1.0, 0.0),
        Warped::High(_) => Complex64::new(-1.0, 0.0),
        Warped::Pass { centre_squared, .. } => bilinear(Complex64::new(0.0, centre_squared.sqrt())),
    }
}
