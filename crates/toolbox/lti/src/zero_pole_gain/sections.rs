//! Zeros and poles as a cascade of sections of first and second order.

use super::ZeroPoleGain;
use super::roots::{factors, members};
use crate::Complex64;
use crate::error::LtiError;
use crate::polynomial::from_roots;
use crate::state_space::StateSpace;
use crate::transfer_function::TransferFunction;

/// One or two poles, with at most as many zeros.
struct Section {
    zeros: Vec<Complex64>,
    poles: Vec<Complex64>,
}

impl ZeroPoleGain {
    /// The system in state space: a cascade of sections of first and second order, each pole with the zeros next to it.
    ///
    /// No polynomial of higher order is formed, so poles that lie close together stay where they are.
    ///
    /// # Errors
    /// [`LtiError::DelayPresent`]; [`LtiError::Improper`] where there are more zeros than poles.
    pub fn to_state_space(&self) -> Result<StateSpace, LtiError> {
        if self.delay_s != 0.0 {
            return Err(LtiError::DelayPresent { delay_s: self.delay_s });
        }
        if self.zeros.len() > self.poles.len() {
            return Err(LtiError::Improper { numerator: self.zeros.len(), denominator: self.poles.len() });
        }
        let mut whole = StateSpace::gain(faer::Mat::full(1, 1, self.gain), self.sample_time_s)?;
        for Section { zeros, poles } in self.sections() {
            let section = TransferFunction::new(from_roots(&zeros), from_roots(&poles), self.sample_time_s)?;
            whole = whole.series(&section.to_state_space()?)?;
        }
        Ok(whole)
    }

    /// Poles in ones and twos; then every zero, pairs first, to the nearest section with room for it.
    fn sections(&self) -> Vec<Section> {
        let (mut real, pairs): (Vec<Complex64>, Vec<Complex64>) = factors(&self.poles).partition(|p| p.im == 0.0);
        real.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
        let pairs = pairs.into_iter().map(|p| members(p).collect::<Vec<Complex64>>());
        let poles = pairs.chain(real.chunks(2).map(<[Complex64]>::to_vec));
        let mut sections: Vec<Section> = poles.map(|poles| Section { zeros: Vec::new(), poles }).collect();
        let (single, double): (Vec<Complex64>, Vec<Complex64>) = factors(&self.zeros).partition(|z| z.im == 0.0);
        for zero in double.into_iter().chain(single) {
            let count = members(zero).count();
            let distance = |s: &Section| s.poles.iter().map(|p| (p - zero).norm()).fold(f64::INFINITY, f64::min);
            let nearest = sections
                .iter_mut()
                .filter(|s| s.zeros.len() + count <= s.poles.len())
                .min_by(|a, b| distance(a).total_cmp(&distance(b)));
            // There is room: no more zeros than poles, and pairs come first.
            if let Some(section) = nearest {
                section.zeros.extend(members(zero));
            }
        }
        sections
    }
}
