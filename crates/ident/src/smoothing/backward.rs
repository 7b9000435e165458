//! The way back: what later measurements say of earlier states.

use faer::{Mat, MatRef};

use super::Smoothed;
use super::forward::{Forward, Innovation, dot};
use super::steady::Memory;

/// The gradient of the likelihood by the state, and minus its curvature: r and N of Durbin and Koopman.
struct Later {
    gradient: Vec<f64>,
    information: Vec<f64>,
    product: Vec<f64>,
    column: Vec<f64>,
}

/// x̂(k) = x(k | k−1) + P(k | k−1) r, with the covariance P − P N P.
pub(super) fn smooth(forward: &Forward, outputs: MatRef<'_, f64>) -> Smoothed {
    let (n, samples) = (forward.states, outputs.nrows());
    let mut states = Mat::zeros(samples, n);
    let mut covariances = vec![0.0; samples * n * n];
    let mut later = Later {
        gradient: vec![0.0; n],
        information: vec![0.0; n * n],
        product: vec![0.0; n * n],
        column: vec![0.0; n],
    };
    // N at a sample and the covariance of its state, by the forward step and N at the sample after it.
    let mut memory: Memory<usize, (Vec<f64>, Vec<f64>)> = Memory::new();
    let mut left = forward.innovations.len();
    for sample in (0..samples).rev() {
        if sample + 1 < samples {
            later.gradient_through_transition(&forward.transition);
        }
        let p = &forward.covariances[sample * n * n..(sample + 1) * n * n];
        let last = left;
        while left > 0 && forward.innovations[left - 1].sample == sample {
            left -= 1;
        }
        let step = |i: usize| {
            let innovation = &forward.innovations[i];
            let c = &forward.output[innovation.output * n..(innovation.output + 1) * n];
            (c, &forward.gains[i * n..(i + 1) * n], innovation)
        };
        for (c, gain, innovation) in (left..last).rev().map(step) {
            later.gradient_through_measurement(c, gain, innovation);
        }
        let number = forward.settled[sample];
        if memory.recall(&number, &later.information).is_none() {
            let before = later.information.clone();
            if sample + 1 < samples {
                later.information_through_transition(&forward.transition);
            }
            for (c, gain, innovation) in (left..last).rev().map(step) {
                later.information_through_measurement(c, gain, innovation.variance);
            }
            let mut posterior = vec![0.0; n * n];
            later.posterior(p, &mut posterior);
            let information = std::mem::replace(&mut later.information, before.clone());
            memory.remember(number, before, (information, posterior));
        }
        if let Some((information, posterior)) = memory.recall(&number, &later.information) {
            covariances[sample * n * n..(sample + 1) * n * n].copy_from_slice(posterior);
            later.information.copy_from_slice(information);
        }
        for i in 0..n {
            states[(sample, i)] = forward.predicted[sample * n + i] + dot(&p[i * n..(i + 1) * n], &later.gradient);
        }
    }
    Smoothed { states, log_likelihood: forward.log_likelihood(), covariances }
}

impl Later {
    /// r ← Aᵀ r.
    fn gradient_through_transition(&mut self, a: &[f64]) {
        let n = self.gradient.len();
        for j in 0..n {
            self.column[j] = (0..n).map(|i| a[i * n + j] * self.gradient[i]).sum();
        }
        self.gradient.copy_from_slice(&self.column);
    }

    /// N ← Aᵀ N A.
    fn information_through_transition(&mut self, a: &[f64]) {
        let n = self.gradient.len();
        for i in 0..n {
            for j in 0..n {
                self.product[i * n + j] = (0..n).map(|k| self.information[i * n + k] * a[k * n + j]).sum();
            }
        }
        for i in 0..n {
            for j in 0..n {
                self.information[i * n + j] = (0..n).map(|k| a[k * n + i] * self.product[k * n + j]).sum();
            }
        }
    }

    /// With L = I − K cᵀ: r ← c v/F + Lᵀ r.
    fn gradient_through_measurement(&mut self, c: &[f64], gain: &[f64], innovation: &Innovation) {
        let push = innovation.value / innovation.variance - dot(gain, &self.gradient);
        self.gradient.iter_mut().zip(c).for_each(|(r, c)| *r += push * c);
    }

    /// N ← c cᵀ/F + Lᵀ N L.
    fn information_through_measurement(&mut self, c: &[f64], gain: &[f64], variance: f64) {
        let n = c.len();
        for i in 0..n {
            self.column[i] = dot(&self.information[i * n..(i + 1) * n], gain);
        }
        let square = dot(gain, &self.column) + 1.0 / variance;
        for i in 0..n {
            for j in 0..n {
                self.information[i * n + j] += square * c[i] * c[j] - self.column[i] * c[j] - c[i] * self.column[j];
            }
        }
    }

    /// P − P N P.
    fn posterior(&mut self, p: &[f64], into: &mut [f64]) {
        let n = self.gradient.len();
        for i in 0..n {
            for j in 0..n {
                self.product[i * n + j] = (0..n).map(|k| self.information[i * n + k] * p[k * n + j]).sum();
            }
        }
        for i in 0..n {
            for j in 0..n {
                let taken: f64 = (0..n).map(|k| p[i * n + k] * self.product[k * n + j]).sum();
                into[i * n + j] = p[i * n + j] - taken;
            }
        }
    }
}
