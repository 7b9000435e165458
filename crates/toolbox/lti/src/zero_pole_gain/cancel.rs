//! Taking out poles that zeros hide.

use super::ZeroPoleGain;
use super::roots::{factors, members};
use crate::Complex64;
use crate::error::LtiError;
use crate::transfer_function::TransferFunction;

impl ZeroPoleGain {
    /// The system without the poles and zeros that lie on each other, nearest ones first, real roots with real ones and
    /// pairs with pairs.
    ///
    /// A pole and a zero count as one where their distance is at most `tolerance` times the pole's size in a continuous
    /// system, and at most `tolerance` in a discrete one. The gain at rest is kept, or where the system has poles or
    /// zeros at rest the gain `k`.
    #[must_use]
    pub fn cancelled(&self, tolerance: f64) -> Self {
        let (mut zeros, mut poles): (Vec<Complex64>, Vec<Complex64>) =
            (factors(&self.zeros).collect(), factors(&self.poles).collect());
        while let Some((zero, pole)) = self.nearest(&zeros, &poles, tolerance) {
            zeros.swap_remove(zero);
            poles.swap_remove(pole);
        }
        let expand = |kept: Vec<Complex64>| kept.into_iter().flat_map(members).collect();
        let left = Self { zeros: expand(zeros), poles: expand(poles), ..self.clone() };
        let correction = self.dc_gain() / left.dc_gain();
        let usable = correction.is_finite() && correction != 0.0;
        Self { gain: left.gain * if usable { correction } else { 1.0 }, ..left }
    }

    /// The zero and the pole that lie closest together among those that count as one.
    fn nearest(&self, zeros: &[Complex64], poles: &[Complex64], tolerance: f64) -> Option<(usize, usize)> {
        let mut best = None;
        for (i, z) in zeros.iter().enumerate() {
            for (j, p) in poles.iter().enumerate().filter(|(_, p)| (p.im == 0.0) == (z.im == 0.0)) {
                let scale = if self.sample_time_s.is_some() { 1.0 } else { p.norm() };
                let distance = (z - p).norm();
                if distance <= tolerance * scale && best.is_none_or(|(least, _, _)| distance < least) {
                    best = Some((distance, i, j));
                }
            }
        }
        best.map(|(_, i, j)| (i, j))
    }
}

impl TransferFunction {
    /// The system without the poles and zeros that lie on each other; see [`ZeroPoleGain::cancelled`].
    ///
    /// # Errors
    /// Those of [`TransferFunction::to_zero_pole_gain`].
    ///
    /// # Example
    /// ```
    /// // (s + 1)(s + 2) / ((s + 1)(s + 3))
    /// let hidden = lti::TransferFunction::continuous(vec![1.0, 3.0, 2.0], vec![1.0, 4.0, 3.0])?;
    /// let seen = hidden.cancelled(1e-9)?;
    /// assert!(seen.den().len() == 2 && (seen.den()[1] - 3.0).abs() < 1e-12);
    /// # Ok::<(), lti::LtiError>(())
    /// ```
    pub fn cancelled(&self, tolerance: f64) -> Result<Self, LtiError> {
        self.to_zero_pole_gain()?.cancelled(tolerance).to_transfer_function()
    }
}
