//! Noise that the errors of several gains have in common.

use faer::Mat;
use signal::Complex64;
use signal::frf::LocalEstimate;

use crate::ChannelPair;

/// How the errors of gains come from independent noise, such as that in the bins of a Fourier transform: the error of
/// gain `k` is `Σ_i weights[k][i] · V(first[k] + i)`, the variance of all `V` near each other being the same.
#[derive(Debug, Clone, PartialEq)]
pub struct SharedNoise {
    /// For each gain, the first noise term in its error.
    pub first: Vec<usize>,
    /// For each gain, the weights of the noise terms from the first on.
    pub weights: Vec<Vec<Complex64>>,
}

impl SharedNoise {
    /// That of one channel of a local estimate, which has this channel.
    pub(super) fn of_local(estimate: &LocalEstimate, ChannelPair { output, input }: ChannelPair) -> Self {
        let (inputs, outputs) = (estimate.response.inputs, estimate.response.outputs);
        let count = estimate.first_bin.len();
        let width = estimate.noise_weights.len() / (count * inputs * outputs).max(1);
        let of = |k: usize| {
            let begin = ((k * outputs + output) * inputs + input) * width;
            estimate.noise_weights[begin..begin + width].to_vec()
        };
        SharedNoise { first: estimate.first_bin.clone(), weights: (0..count).map(of).collect() }
    }

    /// That of these gains.
    pub(super) fn of(&self, chosen: &[usize]) -> Self {
        SharedNoise {
            first: chosen.iter().map(|k| self.first[*k]).collect(),
            weights: chosen.iter().map(|k| self.weights[*k].clone()).collect(),
        }
    }

    /// `Jᵀ R J` with `R` the correlation of the residuals, whose real and imaginary parts are in turn the rows of `J`:
    /// with `z_b = Σ_k J_k* w_k(b)`, the sum of `Re z_b z_bᴴ` over the noise terms.
    pub(super) fn middle(&self, jacobian: &Mat<f64>) -> Mat<f64> {
        let (terms, parameters) = (self.terms(), jacobian.ncols());
        let mut z = Mat::<Complex64>::zeros(terms, parameters);
        for (k, (first, weights)) in self.first.iter().zip(self.unit_weights()).enumerate() {
            for j in 0..parameters {
                let slope = Complex64::new(jacobian[(2 * k, j)], -jacobian[(2 * k + 1, j)]);
                weights.iter().enumerate().for_each(|(i, w)| z[(first + i, j)] += slope * w);
            }
        }
        let product = |i: usize, j: usize| (0..terms).map(|b| (z[(b, i)] * z[(b, j)].conj()).re).sum();
        Mat::from_fn(parameters, parameters, product)
    }

    /// `Σ_kl |ρ_kl|²` over the number of gains, `ρ` the correlation of their errors: by how much their squares scatter
    /// more together than they would without correlation.
    pub(super) fn scatter(&self) -> f64 {
        let weights = self.unit_weights();
        let count = weights.len();
        let mut sum = 0.0;
        for k in 0..count {
            for l in (k..count).take_while(|l| self.first[*l] < self.first[k] + weights[k].len()) {
                let correlation = self.correlation(&weights, k, l).norm_sqr();
                sum += if l == k { correlation } else { 2.0 * correlation };
            }
        }
        sum / count.max(1) as f64
    }

    fn correlation(&self, weights: &[Vec<Complex64>], k: usize, l: usize) -> Complex64 {
        let later = self.first[l].saturating_sub(self.first[k]);
        weights[k].iter().skip(later).zip(&weights[l]).map(|(v, w)| v * w.conj()).sum()
    }

    fn terms(&self) -> usize {
        self.first.iter().zip(&self.weights).map(|(first, w)| first + w.len()).max().unwrap_or(0)
    }

    /// The weights, their squares adding up to one.
    fn unit_weights(&self) -> Vec<Vec<Complex64>> {
        let unit = |weights: &Vec<Complex64>| {
            let length = weights.iter().map(|w| w.norm_sqr()).sum::<f64>().sqrt();
            weights.iter().map(|w| w / length).collect()
        };
        self.weights.iter().map(unit).collect()
    }
}
