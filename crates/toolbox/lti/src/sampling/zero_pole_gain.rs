//! Sampling of zeros, poles and gain.

use super::{Discretisation, matched, roots, tustin};
use crate::Complex64;
use crate::error::LtiError;
use crate::state_space::StateSpace;
use crate::zero_pole_gain::ZeroPoleGain;

impl ZeroPoleGain {
    /// This continuous system sampled; no polynomial is formed on the way, and every pole is the map of one. The delay
    /// has to be whole samples and stays; see [`StateSpace::to_discrete`](crate::StateSpace::to_discrete).
    ///
    /// # Errors
    /// Those of [`StateSpace::to_discrete`](crate::StateSpace::to_discrete), [`LtiError::FractionalDelay`],
    /// [`LtiError::Improper`].
    pub fn to_discrete(&self, method: Discretisation, sample_time_s: f64) -> Result<Self, LtiError> {
        crate::error::check_sample_time(sample_time_s)?;
        if self.sample_time_s().is_some() {
            return Err(LtiError::NotContinuous);
        }
        let lag = crate::delayed::Lag::new(self.delay_s(), sample_time_s)?;
        if lag.fraction() > 0.0 {
            return Err(LtiError::FractionalDelay { delay_s: self.delay_s(), sample_time_s });
        }
        let sampled = match method {
            Discretisation::Matched => matched::discrete(self, sample_time_s)?,
            Discretisation::Tustin { prewarp_rad_s } => {
                tustin::discrete_roots(self, tustin::step(sample_time_s, prewarp_rad_s)?, sample_time_s)?
            }
            hold => {
                let system = self.clone().with_delay(0.0)?.to_state_space()?.to_discrete(hold, sample_time_s)?;
                with_poles(&system, self.poles().iter().map(|p| (p * sample_time_s).exp()).collect())?
            }
        };
        sampled.with_delay(lag.whole() as f64 * sample_time_s)
    }

    /// The continuous system that this discrete one samples, with the same delay; every pole is the map of one. See
    /// [`StateSpace::to_continuous`](crate::StateSpace::to_continuous).
    ///
    /// # Errors
    /// Those of [`StateSpace::to_continuous`](crate::StateSpace::to_continuous), [`LtiError::Improper`].
    pub fn to_continuous(&self, method: Discretisation) -> Result<Self, LtiError> {
        let sample_time_s = self.sample_time_s().ok_or(LtiError::NotDiscrete)?;
        let continuous = match method {
            Discretisation::Matched => matched::continuous(self, sample_time_s)?,
            Discretisation::Tustin { prewarp_rad_s } => {
                tustin::continuous_roots(self, tustin::step(sample_time_s, prewarp_rad_s)?)?
            }
            hold => {
                let system = self.clone().with_delay(0.0)?.to_state_space()?.to_continuous(hold)?;
                let poles = self.poles().iter().map(|p| roots::logarithm(*p, sample_time_s));
                with_poles(&system, poles.collect::<Result<_, _>>()?)?
            }
        };
        continuous.with_delay(self.delay_s())
    }
}

/// The zeros of a system with one input and one output, with poles that are known better than as its eigenvalues: those
/// of a cascade sampled fast lie close together, and rounding moves them by far more than they are known to.
///
/// The gain is what makes both agree well away from every root: the first Markov parameter, the numerator's leading
/// coefficient, is tiny after fast sampling and mostly rounding.
fn with_poles(system: &StateSpace, poles: Vec<Complex64>) -> Result<ZeroPoleGain, LtiError> {
    let time = system.sample_time_s();
    let zeros = match system.zeros() {
        Err(LtiError::ZeroSystem) => return ZeroPoleGain::new(Vec::new(), poles, 0.0, time),
        other => other?,
    };
    let unscaled = ZeroPoleGain::new(zeros, poles, 1.0, time)?;
    let point = far_from_roots(&unscaled);
    let gain = (system.evaluate(point)[(0, 0)] / unscaled.evaluate(point)).re;
    ZeroPoleGain::new(unscaled.zeros().to_vec(), unscaled.poles().to_vec(), gain, time)
}

/// Of some points on a circle about rest, outside of every pole, the one farthest from the nearest root.
fn far_from_roots(system: &ZeroPoleGain) -> Complex64 {
    let rest = Complex64::from(if system.sample_time_s().is_some() { 1.0 } else { 0.0 });
    let furthest = system.poles().iter().map(|p| (p - rest).norm()).fold(0.0, f64::max);
    let radius = if furthest > 0.0 { 2.0 * furthest } else { 1.0 };
    let nearest = |point: &Complex64| {
        let roots = system.zeros().iter().chain(system.poles());
        roots.map(|r| (r - point).norm()).fold(f64::INFINITY, f64::min)
    };
    let points = (0..8).map(|i| rest + Complex64::from_polar(radius, 0.4 * f64::from(i)));
    points.max_by(|a, b| nearest(a).total_cmp(&nearest(b))).unwrap_or(rest + radius)
}
