//! Polynomial models as state space and as transfer functions.

use faer::Mat;

use super::{PolynomialEquation, PolynomialModel};
use crate::error::LtiError;
use crate::innovations::Innovations;
use crate::polynomial::multiply;
use crate::state_space::StateSpace;
use crate::state_space::check_index;
use crate::transfer_function::TransferFunction;

impl PolynomialEquation {
    /// `B_k` with its delay: `nk` zeros, then the coefficients.
    #[must_use]
    pub fn delayed_b(&self, input: usize) -> Vec<f64> {
        std::iter::repeat_n(0.0, self.nk[input]).chain(self.b[input].iter().copied()).collect()
    }
}

/// `1 + p₁ q⁻¹ + …` in full.
fn monic(coefficients: &[f64]) -> Vec<f64> {
    std::iter::once(1.0).chain(coefficients.iter().copied()).collect()
}

/// A ratio in `q⁻¹` as a transfer function in `z`.
fn ratio(num: &[f64], den: &[f64], sample_time_s: f64) -> Result<TransferFunction, LtiError> {
    let length = num.len().max(den.len());
    let padded = |p: &[f64]| p.iter().copied().chain(std::iter::repeat_n(0.0, length - p.len())).collect();
    TransferFunction::discrete(padded(num), padded(den), sample_time_s)
}

impl PolynomialModel {
    /// The way from an input to an output, `B/(A F)`; nothing is cancelled.
    ///
    /// # Errors
    /// [`LtiError::Index`]; [`LtiError::OutputsCoupled`] where the output depends on another one through `A`: take the
    /// channel of [`PolynomialModel::innovations`] instead.
    pub fn transfer_function(&self, output: usize, input: usize) -> Result<TransferFunction, LtiError> {
        let e = self.uncoupled(output)?;
        check_index("input", input, self.inputs())?;
        ratio(&e.delayed_b(input), &multiply(&monic(&e.a[output]), &monic(&e.f[input])), self.sample_time_s())
    }

    /// The way from the noise of an output to that output, `C/(A D)`.
    ///
    /// # Errors
    /// Those of [`PolynomialModel::transfer_function`].
    pub fn noise_transfer_function(&self, output: usize) -> Result<TransferFunction, LtiError> {
        let e = self.uncoupled(output)?;
        ratio(&monic(&e.c), &multiply(&monic(&e.a[output]), &monic(&e.d)), self.sample_time_s())
    }

    fn uncoupled(&self, output: usize) -> Result<&PolynomialEquation, LtiError> {
        check_index("output", output, self.outputs())?;
        let e = &self.equations()[output];
        let coupled = e.a.iter().enumerate().any(|(j, a)| j != output && a.iter().any(|v| *v != 0.0));
        if coupled { Err(LtiError::OutputsCoupled { output }) } else { Ok(e) }
    }

    /// The model in innovations form, in observer canonical form: one chain of states for `A` and what needs no
    /// denominator of its own, one for every `B_k/F_k` with an `F_k`, one for `C/D` with a `D`.
    ///
    /// # Errors
    /// None for a model that was checked; the type is that of [`Innovations::new`].
    pub fn innovations(&self) -> Result<Innovations, LtiError> {
        let chains: Vec<Chains> = self.chains();
        let states = chains.last().map_or(0, |c| c.end);
        let (inputs, outputs) = (self.inputs(), self.outputs());
        let mut m = Matrices {
            a: Mat::zeros(states, states),
            b: Mat::zeros(states, inputs),
            c: Mat::zeros(outputs, states),
            d: Mat::zeros(outputs, inputs),
            k: Mat::zeros(states, outputs),
        };
        for (i, (e, chain)) in self.equations().iter().zip(&chains).enumerate() {
            m.outputs(i, e, chain);
        }
        for (i, (e, chain)) in self.equations().iter().zip(&chains).enumerate() {
            m.chain_of_output(i, e, chain);
            e.f.iter().enumerate().filter(|(_, f)| !f.is_empty()).for_each(|(k, f)| m.chain_of_input(k, e, f, chain));
            if !e.d.is_empty() {
                m.chain_of_noise(i, e, chain);
            }
        }
        let system = StateSpace::new(m.a, m.b, m.c, m.d, Some(self.sample_time_s()))?;
        Innovations::new(system, m.k, self.noise_covariance().to_owned())
    }

    fn chains(&self) -> Vec<Chains> {
        let mut next = 0;
        let mut take = |count: usize| {
            next += count;
            (next - count, count)
        };
        let reach = |e: &PolynomialEquation, k: usize| (e.nk[k] + e.b[k].len()).saturating_sub(1);
        let chains = |e: &PolynomialEquation| {
            let own_a = e.a.iter().map(Vec::len).max().unwrap_or(0);
            let own_b = (0..e.b.len()).filter(|k| e.f[*k].is_empty()).map(|k| reach(e, k)).max().unwrap_or(0);
            let own_c = if e.d.is_empty() { e.c.len() } else { 0 };
            let output = take(own_a.max(own_b).max(own_c));
            let inputs: Vec<_> = (0..e.b.len())
                .map(|k| take(if e.f[k].is_empty() { 0 } else { e.f[k].len().max(reach(e, k)) }))
                .collect();
            let noise = take(if e.d.is_empty() { 0 } else { e.c.len().max(e.d.len()) });
            Chains { output, end: noise.0 + noise.1, inputs, noise }
        };
        self.equations().iter().map(chains).collect()
    }
}

/// First state and length of each chain of one equation.
struct Chains {
    output: (usize, usize),
    inputs: Vec<(usize, usize)>,
    noise: (usize, usize),
    end: usize,
}

struct Matrices {
    a: Mat<f64>,
    b: Mat<f64>,
    c: Mat<f64>,
    d: Mat<f64>,
    k: Mat<f64>,
}

impl Matrices {
    /// The output is the sum of the heads of its chains, the direct terms of the inputs, and the noise.
    fn outputs(&mut self, i: usize, e: &PolynomialEquation, chain: &Chains) {
        let heads = chain.inputs.iter().chain([&chain.output, &chain.noise]);
        heads.filter(|(_, length)| *length > 0).for_each(|(first, _)| self.c[(i, *first)] = 1.0);
        for k in 0..e.b.len() {
            self.d[(i, k)] = e.delayed_b(k).first().copied().unwrap_or(0.0);
        }
    }

    /// Each state of a chain becomes its predecessor.
    fn shift(&mut self, (first, length): (usize, usize)) {
        (1..length).for_each(|m| self.a[(first + m - 1, first + m)] = 1.0);
    }

    /// `x_m⁺ = x_{m+1} − Σ_j a_{j,m} y_j + Σ_k b_{k,m} u_k + c_m e` over what has no denominator of its own.
    fn chain_of_output(&mut self, i: usize, e: &PolynomialEquation, chain: &Chains) {
        self.shift(chain.output);
        let first = chain.output.0;
        for (j, a) in e.a.iter().enumerate() {
            for (m, value) in a.iter().enumerate() {
                for s in 0..self.a.ncols() {
                    self.a[(first + m, s)] -= value * self.c[(j, s)];
                }
                for k in 0..self.b.ncols() {
                    self.b[(first + m, k)] -= value * self.d[(j, k)];
                }
                self.k[(first + m, j)] -= value;
            }
        }
        for k in (0..e.b.len()).filter(|k| e.f[*k].is_empty()) {
            e.delayed_b(k).iter().skip(1).enumerate().for_each(|(m, value)| self.b[(first + m, k)] += value);
        }
        if e.d.is_empty() {
            e.c.iter().enumerate().for_each(|(m, value)| self.k[(first + m, i)] += value);
        }
    }

    /// `w = B/F u`: `x_m⁺ = x_{m+1} − f_m w + b_m u`, `w = x₁ + b₀ u`.
    fn chain_of_input(&mut self, k: usize, e: &PolynomialEquation, f: &[f64], chain: &Chains) {
        self.shift(chain.inputs[k]);
        let first = chain.inputs[k].0;
        let b = e.delayed_b(k);
        let direct = b.first().copied().unwrap_or(0.0);
        for (m, value) in f.iter().enumerate() {
            self.a[(first + m, first)] -= value;
            self.b[(first + m, k)] -= value * direct;
        }
        b.iter().skip(1).enumerate().for_each(|(m, value)| self.b[(first + m, k)] += value);
    }

    /// `v = C/D e`: `x_m⁺ = x_{m+1} − d_m v + c_m e`, `v = x₁ + e`.
    fn chain_of_noise(&mut self, i: usize, e: &PolynomialEquation, chain: &Chains) {
        self.shift(chain.noise);
        let first = chain.noise.0;
        for (m, value) in e.d.iter().enumerate() {
            self.a[(first + m, first)] -= value;
            self.k[(first + m, i)] -= value;
        }
        e.c.iter().enumerate().for_each(|(m, value)| self.k[(first + m, i)] += value);
    }
}
