//! [`FrequencyResponse`]: complex gains over a grid of frequencies.

use serde::{Deserialize, Serialize};

use crate::Complex64;
use crate::error::{LtiError, check_finite, check_shape};

/// The complex gain from one input to one output over angular frequency; a lag has a negative phase.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct FrequencyResponse {
    /// Angular frequencies, in rad/s.
    pub omega_rad_s: Vec<f64>,
    /// The gain at each, in units of output over input.
    pub response: Vec<Complex64>,
}

/// How a response is written down: complex numbers as two series.
#[derive(Clone, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct Parts {
    omega_rad_s: Vec<f64>,
    real: Vec<f64>,
    imaginary: Vec<f64>,
}

impl From<FrequencyResponse> for Parts {
    fn from(whole: FrequencyResponse) -> Self {
        let (real, imaginary) = whole.response.iter().map(|h| (h.re, h.im)).unzip();
        Self { omega_rad_s: whole.omega_rad_s, real, imaginary }
    }
}

impl TryFrom<Parts> for FrequencyResponse {
    type Error = LtiError;

    fn try_from(parts: Parts) -> Result<Self, LtiError> {
        check_shape("imaginary part", (parts.real.len(), 1), (parts.imaginary.len(), 1))?;
        let response = parts.real.iter().zip(&parts.imaginary).map(|(&re, &im)| Complex64::new(re, im)).collect();
        Self::new(parts.omega_rad_s, response)
    }
}

/// The largest gain of a response.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Peak {
    /// Where it is, in rad/s.
    pub omega_rad_s: f64,
    /// The gain's magnitude there.
    pub magnitude: f64,
}

impl FrequencyResponse {
    /// A response from frequencies and gains.
    ///
    /// # Errors
    /// [`LtiError::Shape`] where the lengths differ, [`LtiError::NonFinite`] for a frequency. Gains may be infinite.
    pub fn new(omega_rad_s: Vec<f64>, response: Vec<Complex64>) -> Result<Self, LtiError> {
        check_shape("frequency response", (omega_rad_s.len(), 1), (response.len(), 1))?;
        check_finite("frequency", omega_rad_s.iter().copied())?;
        Ok(Self { omega_rad_s, response })
    }

    /// Frequencies in hertz.
    #[must_use]
    pub fn freq_hz(&self) -> Vec<f64> {
        self.omega_rad_s.iter().map(|w| w / std::f64::consts::TAU).collect()
    }

    /// `20 log10 |H|`, in decibels.
    #[must_use]
    pub fn magnitude_db(&self) -> Vec<f64> {
        self.response.iter().map(|h| 20.0 * h.norm().log10()).collect()
    }

    /// Phase in degrees, unwrapped: no step between neighbouring frequencies is larger than half a turn. The first lies
    /// in −180 ..= 180; a gain that is not finite gives NaN and is stepped over.
    #[must_use]
    pub fn phase_deg(&self) -> Vec<f64> {
        let mut before: Option<f64> = None;
        let unwrap = |h: &Complex64| {
            let wrapped = h.arg().to_degrees();
            let phase = before.map_or(wrapped, |b| wrapped - 360.0 * ((wrapped - b) / 360.0).round());
            if phase.is_finite() {
                before = Some(phase);
            }
            phase
        };
        self.response.iter().map(unwrap).collect()
    }

    /// The largest gain at frequencies in `low_rad_s ..= high_rad_s`, refined by a parabola of the magnitude in
    /// decibels over frequency through the largest point and its neighbours; `None` where the band holds no finite
    /// gain.
    ///
    /// A resonance needs a few points across its width for the refinement to be worth anything.
    ///
    /// # Example
    /// ```
    /// let mode = lti::TransferFunction::continuous(vec![1.0], vec![1.0, 0.2, 1.0])?;
    /// let grid: Vec<f64> = (1..300).map(|i| 0.01 * f64::from(i)).collect();
    /// let peak = mode.frequency_response(&grid)?.peak(0.0, 3.0).unwrap();
    /// // ζ = 0.1: the peak lies at √(1 − 2ζ²) and is 1/(2ζ√(1 − ζ²)) high.
    /// assert!((peak.omega_rad_s - 0.98_f64.sqrt()).abs() < 1e-4);
    /// assert!((peak.magnitude - 5.0 / 0.99_f64.sqrt()).abs() < 1e-3);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    #[must_use]
    pub fn peak(&self, low_rad_s: f64, high_rad_s: f64) -> Option<Peak> {
        let magnitude = |i: usize| self.response[i].norm();
        let best = (0..self.response.len())
            .filter(|&i| (low_rad_s..=high_rad_s).contains(&self.omega_rad_s[i]) && magnitude(i).is_finite())
            .max_by(|&i, &j| magnitude(i).total_cmp(&magnitude(j)))?;
        let on_grid = Peak { omega_rad_s: self.omega_rad_s[best], magnitude: magnitude(best) };
        Some(self.refined(best).unwrap_or(on_grid))
    }

    /// The top of the parabola through three points, if the middle one is the highest.
    fn refined(&self, middle: usize) -> Option<Peak> {
        let point = |i: usize| Some((*self.omega_rad_s.get(i)?, self.response.get(i)?.norm().ln()));
        let ((x0, y0), (x1, y1), (x2, y2)) = (point(middle.checked_sub(1)?)?, point(middle)?, point(middle + 1)?);
        let (left, right) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
        let curvature = (right - left) / (x2 - x0);
        if !(left > 0.0 && right < 0.0 && curvature.is_finite()) {
            return None;
        }
        let slope = left + curvature * (x1 - x0);
        let offset = -slope / (2.0 * curvature);
        Some(Peak { omega_rad_s: x1 + offset, magnitude: (y1 + 0.5 * slope * offset).exp() })
    }
}
