//! A response to the demand, with gain, offset and ripple, as residuals for nonlinear least squares.

use std::f64::consts::TAU;

use bench_model::drive_ripple::{DriveRipple, RippleLine};
use faer::{Mat, MatMut};
use ident::{Bounds, IdentError, ResidualModel, least_squares};
use signal::Complex64;

use super::held::{HeldDemand, Mode};
use super::observed::Observed;
use super::ripple::folded_to_zero_hz;

/// Parameters of one line: frequency, additive cosine and sine, relative cosine and sine.
const LINE: usize = 5;

/// A model m(t; θ) of the torque without ripple.
pub(crate) trait Response {
    /// Number of parameters.
    fn parameter_count(&self) -> usize;

    /// Writes m at the instants into `values` and, when asked, ∂m/∂θ_j into `derivatives[j]`.
    fn evaluate(
        &mut self,
        parameters: &[f64],
        times_s: &[f64],
        values: &mut [f64],
        derivatives: Option<&mut [Vec<f64>]>,
    );
}

/// e^{−sd} a/(s + a) on the held demand; θ = (d, a).
pub(crate) struct DelayAndLag<'a>(Mode<'a>);

impl<'a> DelayAndLag<'a> {
    pub(crate) fn new(demand: &'a HeldDemand) -> Self {
        DelayAndLag(Mode::new(demand))
    }
}

impl Response for DelayAndLag<'_> {
    fn parameter_count(&self) -> usize {
        2
    }

    fn evaluate(
        &mut self,
        parameters: &[f64],
        times_s: &[f64],
        values: &mut [f64],
        mut derivatives: Option<&mut [Vec<f64>]>,
    ) {
        self.0.set_rate(Complex64::from(parameters[1]));
        for (i, time) in times_s.iter().enumerate() {
            let sample = self.0.at(*time, parameters[0]);
            values[i] = sample.value.re;
            if let Some([by_delay, by_rate, ..]) = derivatives.as_deref_mut() {
                (by_delay[i], by_rate[i]) = (sample.by_delay.re, sample.by_rate.re);
            }
        }
    }
}

/// Residuals ε = y − ŷ of
/// ŷ = o + m(t; θ) (g + Σ_l (p_l cos φ_l + q_l sin φ_l)) + Σ_l (v_l cos φ_l + w_l sin φ_l), φ_l = 2π f_l (t − t_ref).
///
/// Parameters: θ, g, o, then f, v, w, p, q of each line.
pub(crate) struct RippledModel<'a, R> {
    response: R,
    observed: &'a Observed,
    lines: usize,
    /// The ripple that the samples fold to zero frequency, Hz: the gain is then free.
    folded_hz: Option<f64>,
    values: Vec<f64>,
    derivatives: Vec<Vec<f64>>,
}

impl<'a, R: Response> RippledModel<'a, R> {
    pub(crate) fn new(response: R, observed: &'a Observed) -> Self {
        let rows = observed.len();
        let derivatives = vec![vec![0.0; rows]; response.parameter_count()];
        let folded_hz = folded_to_zero_hz(observed.sample_time_s);
        RippledModel { response, observed, lines: 0, folded_hz, values: vec![0.0; rows], derivatives }
    }

    pub(crate) fn observed(&self) -> &Observed {
        self.observed
    }

    /// Parameters of the response, and with them the index of the gain.
    pub(crate) fn response_count(&self) -> usize {
        self.response.parameter_count()
    }

    /// Sets the number of ripple lines.
    pub(crate) fn set_lines(&mut self, lines: usize) {
        self.lines = lines;
    }

    /// Bounds: the response's, the gain fixed unless ripple folds to it, frequencies within `reach_hz` of where they
    /// are.
    pub(crate) fn bounds(&self, response: &[Bounds], parameters: &[f64], reach_hz: f64) -> Vec<Bounds> {
        let n = self.response_count();
        let mut bounds = response.to_vec();
        bounds.resize(parameters.len(), Bounds::NONE);
        if self.folded_hz.is_none() {
            bounds[n] = Bounds::new(parameters[n], parameters[n]);
        }
        for line in 0..self.lines {
            let at = n + 2 + LINE * line;
            bounds[at] = Bounds::new(parameters[at] - reach_hz, parameters[at] + reach_hz);
        }
        bounds
    }

    /// Factor and addend of these lines at each sample: see [`RippleLine::parts`].
    pub(crate) fn ripple_of(&self, lines: &[RippleLine]) -> Vec<(f64, f64)> {
        let at = |t: &f64| {
            let parts = lines.iter().map(|line| line.parts(t - self.observed.reference_s));
            parts.fold((0.0, 0.0), |sum, part| (sum.0 + part.0, sum.1 + part.1))
        };
        self.observed.times_s.iter().map(at).collect()
    }

    /// Cost of the response with gain one, a ripple of known factors and addends, and the best offset, for coarse
    /// searches.
    pub(crate) fn coarse_cost(&mut self, response: &[f64], ripple: &[(f64, f64)]) -> f64 {
        self.response.evaluate(response, &self.observed.times_s, &mut self.values, None);
        let n = self.observed.len() as f64;
        let samples = || self.observed.values.iter().zip(&self.values).zip(ripple);
        let errors = || samples().map(|((y, m), (factor, addend))| y - m * (1.0 + factor) - addend);
        let mean = errors().sum::<f64>() / n;
        errors().map(|e| (e - mean).powi(2)).sum()
    }

    /// All parameters for a response and line frequencies, with gain one and the linear ones by least squares.
    ///
    /// # Errors
    /// Too few samples or dependent regressors.
    pub(crate) fn with_linear_part(
        &mut self,
        response: &[f64],
        frequencies_hz: &[f64],
    ) -> Result<Vec<f64>, IdentError> {
        self.lines = frequencies_hz.len();
        self.response.evaluate(response, &self.observed.times_s, &mut self.values, None);
        let (offset, lines) = linear_part(&self.values, 1.0, self.observed, frequencies_hz)?;
        let mut parameters = response.to_vec();
        parameters.extend([1.0, offset]);
        for line in lines {
            parameters.push(line.frequency_hz);
            parameters.extend(line.additive_nm);
            parameters.extend(line.relative);
        }
        Ok(parameters)
    }

    /// Offset, lines and, where there is one, the line that the samples fold to zero frequency.
    pub(crate) fn ripple(&self, parameters: &[f64]) -> DriveRipple {
        let (offset_nm, mut lines) = self.linear_of(parameters);
        lines.extend(self.folded_hz.map(|frequency_hz| {
            let gain = parameters[self.response_count()];
            folded_line(frequency_hz, gain, self.observed)
        }));
        DriveRipple { offset_nm, lines, reference_s: self.observed.reference_s }
    }

    /// Offset and lines out of all parameters.
    pub(crate) fn linear_of(&self, parameters: &[f64]) -> (f64, Vec<RippleLine>) {
        let n = self.response_count();
        let lines = parameters[n + 2..].chunks_exact(LINE).map(|p| RippleLine {
            frequency_hz: p[0],
            additive_nm: [p[1], p[2]],
            relative: [p[3], p[4]],
        });
        (parameters[n + 1], lines.collect())
    }
}

/// The line at a multiple of the sample rate that multiplies the torque by `gain` at the samples. What it does between
/// them, and what it adds, the samples do not show.
fn folded_line(frequency_hz: f64, gain: f64, observed: &Observed) -> RippleLine {
    let first_s = observed.times_s.first().map_or(0.0, |first| first - observed.reference_s);
    let (sin, cos) = (TAU * frequency_hz * first_s).sin_cos();
    RippleLine { frequency_hz, additive_nm: [0.0; 2], relative: [(gain - 1.0) * cos, (gain - 1.0) * sin] }
}

/// Offset and ripple that bring the model values `m`, times a gain, closest to the samples.
///
/// # Errors
/// Too few samples or dependent regressors.
pub(crate) fn linear_part(
    m: &[f64],
    gain: f64,
    observed: &Observed,
    frequencies_hz: &[f64],
) -> Result<(f64, Vec<RippleLine>), IdentError> {
    let mut regressors = Mat::full(observed.len(), 1 + 4 * frequencies_hz.len(), 1.0);
    for (l, frequency_hz) in frequencies_hz.iter().enumerate() {
        for (i, time_s) in observed.times_s.iter().enumerate() {
            let (sin, cos) = (TAU * frequency_hz * (time_s - observed.reference_s)).sin_cos();
            for (k, value) in [cos, sin, m[i] * cos, m[i] * sin].into_iter().enumerate() {
                regressors[(i, 1 + 4 * l + k)] = value;
            }
        }
    }
    let target: Vec<f64> = observed.values.iter().zip(m).map(|(y, m)| y - gain * m).collect();
    let fit = least_squares(regressors.as_ref(), &target)?;
    let line = |(frequency_hz, p): (&f64, &[f64])| RippleLine {
        frequency_hz: *frequency_hz,
        additive_nm: [p[0], p[1]],
        relative: [p[2], p[3]],
    };
    let lines = frequencies_hz.iter().zip(fit.parameters[1..].chunks_exact(4)).map(line).collect();
    Ok((fit.parameters[0], lines))
}

impl<R: Response> ResidualModel for RippledModel<'_, R> {
    fn parameter_count(&self) -> usize {
        self.response_count() + 2 + LINE * self.lines
    }

    fn residual_count(&self) -> usize {
        self.observed.len()
    }

    fn evaluate(
        &mut self,
        parameters: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let n = self.response_count();
        let wanted = jacobian.is_some().then_some(self.derivatives.as_mut_slice());
        self.response.evaluate(&parameters[..n], &self.observed.times_s, &mut self.values, wanted);
        let (gain, offset, lines) = (parameters[n], parameters[n + 1], &parameters[n + 2..]);
        for i in 0..residuals.len() {
            let m = self.values[i];
            let since = self.observed.times_s[i] - self.observed.reference_s;
            let (mut factor, mut added) = (gain, offset);
            for (l, p) in lines.chunks_exact(LINE).enumerate() {
                let (sin, cos) = (TAU * p[0] * since).sin_cos();
                factor += p[3] * cos + p[4] * sin;
                added += p[1] * cos + p[2] * sin;
                if let Some(j) = jacobian.as_mut() {
                    let slope = p[2] * cos - p[1] * sin + m * (p[4] * cos - p[3] * sin);
                    let row = [TAU * since * slope, cos, sin, m * cos, m * sin];
                    for (k, value) in row.iter().enumerate() {
                        j[(i, n + 2 + LINE * l + k)] = -value;
                    }
                }
            }
            residuals[i] = self.observed.values[i] - added - m * factor;
            if let Some(j) = jacobian.as_mut() {
                for (k, column) in self.derivatives.iter().enumerate() {
                    j[(i, k)] = -factor * column[i];
                }
                (j[(i, n)], j[(i, n + 1)]) = (-m, -1.0);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use signal::Signal;

    /// The trait's methods are private to the crate, so this test lives here.
    #[test]
    fn prop_jacobian_is_the_finite_difference() {
        let levels = (0..400).map(|i: i32| f64::from((i / 10) * 37 % 11) * 3.0 + 20.0);
        let demand = Signal { start_s: 0.3, sample_time_s: 1e-3, samples: levels.collect() };
        let torque = Signal { start_s: 0.3004, sample_time_s: 4e-3, samples: vec![30.0; 95] };
        let observed = Observed::new(&torque, &[true; 95], 0..95);
        let held = HeldDemand::new(&demand, None);
        let mut model = RippledModel::new(DelayAndLag::new(&held), &observed);
        model.set_lines(2);
        let point = [2.13e-3, 431.0, 1.02, 0.4, 71.3, 0.5, -0.3, 0.02, 0.03, 100.2, -0.2, 0.7, 0.01, -0.02];
        let (mut residuals, mut jacobian) = (vec![0.0; 95], Mat::zeros(95, point.len()));
        assert!(model.evaluate(&point, &mut residuals, Some(jacobian.as_mut())).is_ok());
        let (mut above, mut below) = (vec![0.0; 95], vec![0.0; 95]);
        for j in 0..point.len() {
            let step = 1e-5 * point[j].abs();
            let mut moved = point;
            moved[j] = point[j] + step;
            assert!(model.evaluate(&moved, &mut above, None).is_ok());
            moved[j] = point[j] - step;
            assert!(model.evaluate(&moved, &mut below, None).is_ok());
            let size = jacobian.col(j).norm_max();
            for i in 0..95 {
                let slope = (above[i] - below[i]) / (2.0 * step);
                assert!((slope - jacobian[(i, j)]).abs() < 1e-5 * size, "parameter {j}, sample {i}");
            }
        }
    }
}
