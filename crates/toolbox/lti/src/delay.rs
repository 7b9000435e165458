//! Delays as rational systems.

use crate::delayed::Lag;
use crate::error::{LtiError, check_delay, check_sample_time};
use crate::transfer_function::TransferFunction;

/// Highest degree of an approximated delay: beyond it the coefficients span more than numbers hold.
const MOST: usize = 20;

/// Most samples of delay that become poles.
const MOST_POLES: usize = 100_000;

impl TransferFunction {
    /// The Padé approximant of a continuous delay `e^{−s·delay}`: an all-pass of `order` poles, whose phase is right up
    /// to about `order/delay` rad/s.
    ///
    /// # Errors
    /// [`LtiError::Delay`] for a negative delay, [`LtiError::Order`] above 20.
    ///
    /// # Example
    /// ```
    /// let delay = lti::TransferFunction::pade(2.0, 1)?;
    /// assert_eq!((delay.num(), delay.den()), (&[-1.0, 1.0][..], &[1.0, 1.0][..]));
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    ///
    /// # Source
    /// Golub, G. H. and Van Loan, C. F. (2013), *Matrix Computations*, 4th ed., §9.3.1.
    pub fn pade(delay_s: f64, order: usize) -> Result<Self, LtiError> {
        check_delay(delay_s)?;
        check_order(order)?;
        let mut den = vec![1.0];
        for k in 1..=order {
            // (2n − k)! n! / ((2n)! k! (n − k)!), from the one before.
            let factor = (order + 1 - k) as f64 / ((2 * order + 1 - k) * k) as f64;
            den.push(den[k - 1] * factor * delay_s);
        }
        let num = den.iter().enumerate().map(|(k, c)| if k % 2 == 0 { *c } else { -c });
        let num: Vec<f64> = num.collect();
        let descending = |p: Vec<f64>| p.into_iter().rev().collect();
        Self::continuous(descending(num), descending(den))
    }

    /// This continuous system with its delay replaced by the Padé approximant of [`TransferFunction::pade`].
    ///
    /// # Errors
    /// [`LtiError::NotContinuous`], [`LtiError::Order`].
    pub fn with_pade_delay(&self, order: usize) -> Result<Self, LtiError> {
        if self.sample_time_s().is_some() {
            return Err(LtiError::NotContinuous);
        }
        self.clone().with_delay(0.0)?.series(&Self::pade(self.delay_s(), order)?)
    }

    /// Thiran's discrete delay: an all-pass of `order` poles whose delay at rest is exact and flat, whole samples
    /// beyond what it needs left as a delay.
    ///
    /// # Errors
    /// [`LtiError::Delay`] for a delay below `order − ½` samples, which would not be stable; [`LtiError::Order`] above
    /// 20; [`LtiError::SampleTime`].
    ///
    /// # Example
    /// ```
    /// let half = lti::TransferFunction::thiran(0.15, 0.1, 1)?;
    /// // D = 1.5: (z⁻¹ + a) / (1 + a z⁻¹) with a = (1 − D)/(1 + D).
    /// assert!((half.num()[0] + 0.2).abs() < 1e-15 && half.delay_s() == 0.0);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    ///
    /// # Source
    /// Laakso, T. I. et al. (1996), IEEE Signal Process. Mag. 13(1), 30–60, (86).
    pub fn thiran(delay_s: f64, sample_time_s: f64, order: usize) -> Result<Self, LtiError> {
        check_sample_time(sample_time_s)?;
        check_order(order)?;
        let lag = Lag::new(delay_s, sample_time_s)?;
        let samples = lag.whole() as f64 + lag.fraction();
        if samples < order as f64 - 0.5 || (order == 0 && lag.fraction() > 0.0) {
            return Err(LtiError::Delay { delay_s });
        }
        // The all-pass takes what lies within half a sample of its order.
        let whole = (samples - order as f64 + 0.5).floor();
        let d = samples - whole;
        let n = order as f64;
        let coefficient = |k: usize| {
            let k = k as f64;
            (0..=order).map(|i| (d - n + i as f64) / (d - n + k + i as f64)).product::<f64>()
        };
        let mut den = vec![1.0];
        let mut choose = 1.0;
        for k in 1..=order {
            choose *= -((order + 1 - k) as f64) / k as f64;
            den.push(choose * coefficient(k));
        }
        let num = den.iter().rev().copied().collect();
        Self::discrete(num, den, sample_time_s)?.with_delay(whole * sample_time_s)
    }

    /// This discrete system with its delay as poles at zero.
    ///
    /// # Errors
    /// [`LtiError::NotDiscrete`], [`LtiError::FractionalDelay`]; [`LtiError::Delay`] for more than 100 000 samples.
    pub fn with_delay_absorbed(&self) -> Result<Self, LtiError> {
        let sample_time_s = self.sample_time_s().ok_or(LtiError::NotDiscrete)?;
        let lag = Lag::new(self.delay_s(), sample_time_s)?;
        if lag.fraction() > 0.0 {
            return Err(LtiError::FractionalDelay { delay_s: self.delay_s(), sample_time_s });
        }
        if lag.whole() > MOST_POLES {
            return Err(LtiError::Delay { delay_s: self.delay_s() });
        }
        let mut den = self.den().to_vec();
        den.resize(den.len() + lag.whole(), 0.0);
        Self::discrete(self.num().to_vec(), den, sample_time_s)
    }
}

fn check_order(order: usize) -> Result<(), LtiError> {
    if order <= MOST { Ok(()) } else { Err(LtiError::Order { order, most: MOST }) }
}
