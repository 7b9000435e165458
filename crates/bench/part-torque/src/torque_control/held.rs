//! The exact response of first-order modes to a demand that is held between its samples.

use signal::{Complex64, Signal};

/// A demand held from each of its samples to the next, limited to what the drive can give. Before the first sample
/// the first value holds, after the last the last.
#[derive(Debug, Clone, PartialEq)]
pub struct HeldDemand {
    start_s: f64,
    sample_time_s: f64,
    values: Vec<f64>,
}

impl HeldDemand {
    /// The demand limited to ±`limit_nm`.
    pub fn new(demand: &Signal, limit_nm: Option<f64>) -> Self {
        let limit = limit_nm.unwrap_or(f64::INFINITY);
        HeldDemand {
            start_s: demand.start_s,
            sample_time_s: demand.sample_time_s,
            values: demand.samples.iter().map(|u| u.max(-limit).min(limit)).collect(),
        }
    }

    /// Time between its samples, s.
    pub fn sample_time_s(&self) -> f64 {
        self.sample_time_s
    }

    /// The demand as it stands at an instant.
    pub fn at(&self, time_s: f64) -> f64 {
        self.values.get(self.locate(time_s).0).copied().unwrap_or(0.0)
    }

    /// Index of the sample in force, and the time since it came into force; before the first sample: 0 and 0.
    fn locate(&self, time_s: f64) -> (usize, f64) {
        let position = (time_s - self.start_s) / self.sample_time_s;
        if position.is_nan() || position <= 0.0 {
            return (0, 0.0);
        }
        // The float-to-integer cast saturates.
        let index = (position as usize).min(self.values.len().saturating_sub(1));
        (index, (position - index as f64) * self.sample_time_s)
    }
}

/// Value and derivatives of a delayed mode at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct ModeSample {
    /// x(t − d).
    pub(crate) value: Complex64,
    /// ∂x/∂d.
    pub(crate) by_delay: Complex64,
    /// ∂x/∂a.
    pub(crate) by_rate: Complex64,
}

/// The mode dx/dt = a (u − x), i.e. a/(s + a), with real or complex rate a, on a held demand.
///
/// At the demand's instants x_n = c x_{n−1} + (1 − c) u_{n−1} with c = e^{−aT}; a time θ < T later x = u_n + e^{−aθ}
/// (x_n − u_n). Sampled every T with a delay mT + φ this is y_k = c y_{k−1} + (1 − e^{−a(T−φ)}) u_{k−1−m} +
/// (e^{−a(T−φ)} − c) u_{k−2−m}. The mode starts at rest at the first value.
///
/// A stable transfer function with distinct poles −a_i and gain one at rest is a sum of such modes, weighted to one.
///
/// # Source
/// Åström & Wittenmark, *Computer-Controlled Systems*, 3rd ed., §2.3 (zero-order hold with a fractional delay).
#[derive(Debug, Clone)]
pub(crate) struct Mode<'a> {
    demand: &'a HeldDemand,
    rate: Complex64,
    state: Vec<Complex64>,
    state_by_rate: Vec<Complex64>,
}

impl<'a> Mode<'a> {
    /// A mode whose rate is still to be set.
    pub(crate) fn new(demand: &'a HeldDemand) -> Self {
        let length = demand.values.len();
        Mode {
            demand,
            rate: Complex64::ZERO,
            state: vec![Complex64::ZERO; length],
            state_by_rate: vec![Complex64::ZERO; length],
        }
    }

    /// Computes the mode at the demand's instants for a rate; the last rate's result is kept.
    pub(crate) fn set_rate(&mut self, rate: Complex64) {
        if rate == self.rate {
            return;
        }
        self.rate = rate;
        let step = self.demand.sample_time_s;
        let keep = exponential(-rate * step);
        let (mut x, mut by_rate) =
            (Complex64::from(self.demand.values.first().copied().unwrap_or(0.0)), Complex64::ZERO);
        for (n, u) in self.demand.values.iter().enumerate() {
            (self.state[n], self.state_by_rate[n]) = (x, by_rate);
            by_rate = keep * (by_rate - (x - *u) * step);
            x = keep * (x - *u) + *u;
        }
    }

    /// The mode, delayed by `delay_s`, at an instant.
    pub(crate) fn at(&self, time_s: f64, delay_s: f64) -> ModeSample {
        let (n, since) = self.demand.locate(time_s - delay_s);
        let Some(u) = self.demand.values.get(n) else {
            return ModeSample { value: Complex64::ZERO, by_delay: Complex64::ZERO, by_rate: Complex64::ZERO };
        };
        let decay = exponential(-self.rate * since);
        let distance = decay * (self.state[n] - *u);
        ModeSample {
            value: distance + *u,
            by_delay: self.rate * distance,
            by_rate: decay * self.state_by_rate[n] - distance * since,
        }
    }
}

/// e^z, for a real z without the sine and cosine that are known.
fn exponential(z: Complex64) -> Complex64 {
    if z.im == 0.0 { Complex64::from(z.re.exp()) } else { z.exp() }
}
