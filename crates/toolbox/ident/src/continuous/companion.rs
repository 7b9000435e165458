//! A transfer function in time counted in samples, as the chain of derivatives that its sensitivities are made of.

use faer::Mat;
use lti::{LtiError, StateSpace};

use super::channel::{ContinuousChannel, Degrees};
use super::sampled::Sampled;
use crate::Intersample;

/// `B(p)/A(p)` with `p` in units of one over the sample time: `z_j = p^j / Ā u` are its states (Ā is monic).
#[derive(Debug, Clone)]
pub(crate) struct Companion {
    /// Leading coefficient of A.
    lead: f64,
    /// ā₀ … ā_{n−1}.
    a: Vec<f64>,
    /// b̄₀ … b̄_m, divided by the leading coefficient of A.
    b: Vec<f64>,
    /// In samples.
    delay: f64,
    sample_time_s: f64,
}

impl Companion {
    pub(crate) fn new(channel: &impl ContinuousChannel, sample_time_s: f64) -> Result<Self, LtiError> {
        let system = channel.transfer_function()?;
        let Degrees { numerator: m, poles: n } = channel.degrees();
        if m > n {
            return Err(LtiError::Improper { numerator: m, denominator: n });
        }
        let (num, den) = (ascending(system.num(), m), ascending(system.den(), n));
        let scaled = |c: &[f64]| -> Vec<f64> {
            c.iter().enumerate().map(|(power, v)| v / sample_time_s.powi(power as i32)).collect()
        };
        let (num, mut den) = (scaled(&num), scaled(&den));
        let lead = den.pop().unwrap_or(1.0);
        let monic = |c: Vec<f64>| -> Vec<f64> { c.iter().map(|v| v / lead).collect() };
        let (b, a) = (monic(num), monic(den));
        if a.iter().chain(&b).any(|v| !v.is_finite()) {
            return Err(LtiError::NonFinite { what: "transfer function in units of samples" });
        }
        Ok(Companion { lead, a, b, delay: system.delay_s() / sample_time_s, sample_time_s })
    }

    /// From ascending coefficients in time counted in samples; the leading one of the denominator is not given.
    pub(crate) fn monic(a: &[f64], b: &[f64], delay: f64) -> Self {
        Companion { lead: 1.0, a: a.to_vec(), b: b.to_vec(), delay, sample_time_s: 1.0 }
    }

    pub(crate) fn order(&self) -> usize {
        self.a.len()
    }

    /// Returns true if every pole but those at zero lies in the left half-plane.
    pub(crate) fn is_stable(&self) -> Result<bool, LtiError> {
        let polynomial: Vec<f64> = std::iter::once(1.0).chain(self.a.iter().rev().copied()).collect();
        let last = polynomial.iter().rposition(|c| *c != 0.0).unwrap_or(0);
        Ok(lti::polynomial::roots(&polynomial[..=last])?.iter().all(|p| p.re < 0.0))
    }

    /// `c` and `d` of `y = c z + d v`.
    pub(crate) fn output(&self) -> (Vec<f64>, f64) {
        let n = self.a.len();
        let direct = self.b.get(n).copied().unwrap_or(0.0);
        ((0..n).map(|j| self.b.get(j).copied().unwrap_or(0.0) - direct * self.a[j]).collect(), direct)
    }

    fn matrices(&self) -> (Mat<f64>, Vec<f64>) {
        let n = self.a.len();
        let f = Mat::from_fn(n, n, |i, j| if i + 1 == n { -self.a[j] } else { f64::from(u8::from(j == i + 1)) });
        (f, (0..n).map(|i| f64::from(u8::from(i + 1 == n))).collect())
    }

    /// `z` at the samples.
    pub(crate) fn sampled(&self, intersample: Intersample) -> Result<Sampled, LtiError> {
        let (f, g) = self.matrices();
        Sampled::new(&f, &g, self.delay, intersample)
    }

    /// `z`, and after it `w_j = p^j / Ā y`, at the samples.
    pub(crate) fn cascade(&self, intersample: Intersample) -> Result<Sampled, LtiError> {
        let (f, g) = self.matrices();
        let (c, d) = self.output();
        let n = c.len();
        let both = Mat::from_fn(2 * n, 2 * n, |i, j| match (i < n, j < n) {
            (true, true) => f[(i, j)],
            (true, false) => 0.0,
            (false, true) => g[i - n] * c[j],
            (false, false) => f[(i - n, j - n)],
        });
        let input: Vec<f64> = g.iter().copied().chain(g.iter().map(|g| g * d)).collect();
        Sampled::new(&both, &input, self.delay, intersample)
    }

    /// The sampled system; band-limited inputs are taken as straight.
    pub(crate) fn to_state_space(&self, sample_time_s: f64, intersample: Intersample) -> Result<StateSpace, LtiError> {
        let (c, d) = self.output();
        let jumps = intersample == Intersample::ZeroOrderHold;
        let between = if jumps { intersample } else { Intersample::FirstOrderHold };
        self.sampled(between)?.to_state_space(&c, d, sample_time_s)
    }

    /// The sampled system with the coefficients of the delayed input's course as inputs.
    pub(crate) fn band_limited(&self, sample_time_s: f64) -> Result<StateSpace, LtiError> {
        let ((f, g), (c, d)) = (self.matrices(), self.output());
        Sampled::new(&f, &g, 0.0, Intersample::BandLimited)?.to_state_space(&c, d, sample_time_s)
    }

    /// In samples.
    pub(crate) fn delay(&self) -> f64 {
        self.delay
    }

    /// Derivatives of `y` by `b_m … b₀`, `a_n … a₀` (not divided by the leading one, in SI) and the delay in seconds,
    /// from the state of the [`cascade`](Self::cascade), the delayed input `v` and its slope a sample.
    pub(crate) fn sensitivities(&self, state: &[f64], v: f64, slope: f64, out: &mut [f64]) {
        let n = self.a.len();
        let (z, w) = state.split_at(n);
        let (m, d) = (self.b.len() - 1, self.b.get(n).copied().unwrap_or(0.0));
        let next = |x: &[f64], drive: f64| drive - self.a.iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
        let z_n = next(z, v);
        let derivative = |j: usize| if j < n { z[j] } else { z_n };
        let y: f64 = self.b.iter().enumerate().map(|(j, b)| b * derivative(j)).sum();
        let w_n = next(w, y);
        let (mut scale, t) = (1.0 / self.lead, self.sample_time_s);
        for j in 0..=n {
            if j <= m {
                out[m - j] = scale * derivative(j);
            }
            out[m + 1 + n - j] = -scale * if j < n { w[j] } else { w_n };
            scale /= t;
        }
        // ẏ = c ż + d v̇; ż_j = z_{j+1}.
        let c = |j: usize| self.b.get(j).copied().unwrap_or(0.0) - d * self.a[j];
        let rate: f64 = (0..n).map(|j| c(j) * derivative(j + 1)).sum::<f64>() + d * slope;
        out[m + n + 2] = -rate / t;
    }
}

/// Coefficients from the constant term up to the given degree, of a polynomial in descending powers.
fn ascending(descending: &[f64], degree: usize) -> Vec<f64> {
    let mut coefficients: Vec<f64> = descending.iter().rev().copied().collect();
    coefficients.resize(degree + 1, 0.0);
    coefficients
}
