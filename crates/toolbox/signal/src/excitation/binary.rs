//! Signals that switch between two levels.

use serde::{Deserialize, Serialize};

use super::{Random, Timing};
use crate::Signal;
use crate::error::{SignalError, check_finite, check_range};

/// A signal that switches between two levels: every `hold_s` it changes with the given probability.
///
/// `hold_s` is rounded to whole samples, at least one. With a probability of 0.5 the holds are independent.
///
/// # Errors
/// [`SignalError::Parameter`], [`SignalError::SampleTime`], [`SignalError::NonFinite`] for the levels.
///
/// # Example
/// ```
/// use signal::excitation::{Random, Timing, random_binary};
/// let timing = Timing { sample_time_s: 1e-3, length: 1000 };
/// let x = random_binary(&mut Random::new(1), timing, [-5.0, 5.0], 0.01, 0.5)?;
/// assert!(x.samples.chunks(10).all(|c| c.iter().all(|v| *v == c[0] && v.abs() == 5.0)));
/// # Ok::<(), signal::SignalError>(())
/// ```
pub fn random_binary(
    random: &mut Random,
    timing: Timing,
    levels: [f64; 2],
    hold_s: f64,
    switch_probability: f64,
) -> Result<Signal, SignalError> {
    check_finite(&levels)?;
    check_range("switch_probability", switch_probability, 0.0, 1.0)?;
    let hold = timing.samples_in("hold_s", hold_s)?;
    let mut high = random.uniform() < 0.5;
    let sample = |i: usize| {
        if i > 0 && i.is_multiple_of(hold) && random.uniform() < switch_probability {
            high = !high;
        }
        levels[usize::from(high)]
    };
    timing.signal((0..timing.length).map(sample).collect())
}

/// Feedback taps of a shift register of 2, 3, … 31 bits that runs through all its non-zero states; bit `i` stands for
/// tap `i + 1`.
///
/// Source: Golomb, S. W. (1967), *Shift Register Sequences*; Alfke, P. (1996), Xilinx application note XAPP 052.
const TAPS: [u32; 30] = [
    0x3,
    0x6,
    0xc,
    0x14,
    0x30,
    0x60,
    0xb8,
    0x110,
    0x240,
    0x500,
    0x829,
    0x100d,
    0x2015,
    0x6000,
    0xd008,
    0x12000,
    0x20400,
    0x40023,
    0x90000,
    0x14_0000,
    0x30_0000,
    0x42_0000,
    0xe1_0000,
    0x120_0000,
    0x200_0023,
    0x400_0013,
    0x900_0000,
    0x1400_0000,
    0x2000_0029,
    0x4800_0000,
];

/// A pseudo-random binary sequence of maximal length from a shift register with linear feedback: periodic with
/// `(2^order − 1) · hold` samples, white up to about `0.4/(hold · T)` hertz; in a period it is once more often high
/// than low.
///
/// At the switching clock its autocorrelation has two values: for levels `±a`, `a²` at multiples of the period and
/// `−a²/(2^order − 1)` elsewhere.
///
/// # Example
/// ```
/// use signal::excitation::{Prbs, Timing};
/// let prbs = Prbs { order: 7, hold: 2, levels: [-1.0, 1.0], seed: 1 };
/// assert_eq!(prbs.period(), 254);
/// let x = prbs.generate(Timing { sample_time_s: 1e-3, length: 254 })?;
/// assert_eq!(x.samples.iter().sum::<f64>(), 2.0);
/// # Ok::<(), signal::SignalError>(())
/// ```
///
/// # Source
/// Ljung, L. (1999), *System Identification*, §13.3.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Prbs {
    /// Bits of the register, 2 to 31.
    pub order: usize,
    /// Samples each bit is held, at least one.
    pub hold: usize,
    /// The levels, low and high.
    pub levels: [f64; 2],
    /// Where in its period the sequence starts; zero is taken as one.
    pub seed: u64,
}

impl Prbs {
    /// The period in samples; none of any use for an order or a hold out of range.
    #[must_use]
    pub fn period(&self) -> usize {
        ((1_usize << self.order.min(31)) - 1).saturating_mul(self.hold)
    }

    /// The sequence.
    ///
    /// # Errors
    /// [`SignalError::Parameter`] for an order outside 2 ..= 31 or a hold of zero, [`SignalError::NonFinite`] for the
    /// levels, [`SignalError::SampleTime`].
    pub fn generate(&self, timing: Timing) -> Result<Signal, SignalError> {
        check_range("order", self.order as f64, 2.0, 31.0)?;
        check_range("hold", self.hold as f64, 1.0, f64::MAX)?;
        check_finite(&self.levels)?;
        let (taps, states) = (TAPS[self.order - 2], (1_u32 << self.order) - 1);
        // 1 ..= states
        let mut register = (self.seed.wrapping_sub(1) % u64::from(states)) as u32 + 1;
        let sample = |i: usize| {
            if i > 0 && i.is_multiple_of(self.hold) {
                let feedback = (register & taps).count_ones() & 1;
                register = ((register << 1) | feedback) & states;
            }
            self.levels[(register & 1) as usize]
        };
        timing.signal((0..timing.length).map(sample).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::TAPS;

    /// `x^power` modulo the register's polynomial over GF(2): the register's state after so many steps.
    fn power(mut exponent: u64, polynomial: u64, order: usize) -> u64 {
        let times = |mut a: u64, mut b: u64| {
            let mut product = 0;
            while b > 0 {
                product ^= if b & 1 == 1 { a } else { 0 };
                a <<= 1;
                a ^= if (a >> order) & 1 == 1 { polynomial } else { 0 };
                b >>= 1;
            }
            product
        };
        let (mut result, mut square) = (1, 2);
        while exponent > 0 {
            if exponent & 1 == 1 {
                result = times(result, square);
            }
            square = times(square, square);
            exponent >>= 1;
        }
        result
    }

    /// The register returns to its state after `2^n − 1` steps and after no divisor of that.
    #[test]
    fn exact_every_register_is_of_maximal_length() {
        for (i, taps) in TAPS.iter().enumerate() {
            let (order, polynomial) = (i + 2, (u64::from(*taps) << 1) | 1);
            let states = (1_u64 << order) - 1;
            assert_eq!(power(states, polynomial, order), 1, "order {order}");
            let (mut left, mut factor) = (states, 2);
            while left > 1 {
                if factor * factor > left {
                    factor = left;
                }
                if left.is_multiple_of(factor) {
                    assert!(states == factor || power(states / factor, polynomial, order) != 1, "order {order}");
                    left /= factor;
                } else {
                    factor += 1;
                }
            }
        }
    }
}
