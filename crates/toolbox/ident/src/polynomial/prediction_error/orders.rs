//! How many coefficients each polynomial of one equation has, and where they are in θ.

use std::ops::Range;

use lti::PolynomialEquation;

use crate::IdentError;

/// Orders or delays, one an input; a single number stands for every input.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PerInput(Vec<usize>);

impl From<usize> for PerInput {
    fn from(value: usize) -> Self {
        PerInput(vec![value])
    }
}

impl<const N: usize> From<[usize; N]> for PerInput {
    fn from(values: [usize; N]) -> Self {
        PerInput(values.to_vec())
    }
}

impl From<Vec<usize>> for PerInput {
    fn from(values: Vec<usize>) -> Self {
        PerInput(values)
    }
}

impl PerInput {
    /// One value an input.
    pub(super) fn spread(&self, what: &'static str, inputs: usize) -> Result<Vec<usize>, IdentError> {
        match self.0.as_slice() {
            [one] => Ok(vec![*one; inputs]),
            values if values.len() == inputs => Ok(values.to_vec()),
            values => Err(IdentError::Length { what, expected: inputs, found: values.len() }),
        }
    }
}

/// The orders of one equation `A y = Σ B_k/F_k u_k + C/D e`; the coefficients are in θ in the order a, b, c, d, f.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Orders {
    pub(super) na: usize,
    pub(super) nb: Vec<usize>,
    pub(super) nc: usize,
    pub(super) nd: usize,
    pub(super) nf: Vec<usize>,
    pub(super) nk: Vec<usize>,
}

impl Orders {
    pub(super) fn inputs(&self) -> usize {
        self.nb.len()
    }

    pub(super) fn count(&self) -> usize {
        self.na + self.nb.iter().sum::<usize>() + self.nc + self.nd + self.nf.iter().sum::<usize>()
    }

    pub(super) fn a(&self) -> Range<usize> {
        0..self.na
    }

    pub(super) fn b(&self, input: usize) -> Range<usize> {
        let first = self.na + self.nb[..input].iter().sum::<usize>();
        first..first + self.nb[input]
    }

    pub(super) fn c(&self) -> Range<usize> {
        let first = self.na + self.nb.iter().sum::<usize>();
        first..first + self.nc
    }

    pub(super) fn d(&self) -> Range<usize> {
        let first = self.c().end;
        first..first + self.nd
    }

    pub(super) fn f(&self, input: usize) -> Range<usize> {
        let first = self.d().end + self.nf[..input].iter().sum::<usize>();
        first..first + self.nf[input]
    }

    /// Returns true if the residuals are those of the output alone, with no memory of earlier residuals or outputs.
    pub(super) fn is_output_error(&self) -> bool {
        self.na + self.nc + self.nd == 0
    }

    /// The same dynamics with white noise on the output, and where each remaining coefficient is in the full θ.
    pub(super) fn without_noise(&self) -> (Orders, Vec<usize>) {
        let noise = self.c().start..self.d().end;
        let place = (0..self.count()).filter(|j| !noise.contains(j)).collect();
        (Orders { nc: 0, nd: 0, ..self.clone() }, place)
    }

    /// Past samples of an input that its numerator reaches.
    pub(super) fn reach(&self, input: usize) -> usize {
        (self.nk[input] + self.nb[input]).saturating_sub(1)
    }

    /// States of the chain of `A` and of what needs no denominator of its own, in the innovations form.
    pub(super) fn output_states(&self) -> usize {
        let direct = (0..self.inputs()).filter(|k| self.nf[*k] == 0).map(|k| self.reach(k)).max().unwrap_or(0);
        let noise = if self.nd == 0 { self.nc } else { 0 };
        self.na.max(direct).max(noise)
    }

    /// States of the chain of `B_k/F_k`.
    pub(super) fn input_states(&self, input: usize) -> usize {
        if self.nf[input] == 0 { 0 } else { self.nf[input].max(self.reach(input)) }
    }

    /// States of the chain of `C/D`.
    pub(super) fn noise_states(&self) -> usize {
        if self.nd == 0 { 0 } else { self.nc.max(self.nd) }
    }

    /// States of the innovations form.
    pub(super) fn states(&self) -> usize {
        self.output_states() + (0..self.inputs()).map(|k| self.input_states(k)).sum::<usize>() + self.noise_states()
    }

    /// Largest shift of any signal in the equation or its gradient.
    pub(super) fn memory(&self) -> usize {
        let inputs = (0..self.inputs()).map(|k| self.reach(k).max(self.nf[k])).max().unwrap_or(0);
        self.na.max(self.nc).max(self.nd).max(inputs).max(self.states())
    }

    /// The equation with these coefficients, for output `output` of `outputs`.
    pub(super) fn equation(&self, theta: &[f64], output: usize, outputs: usize) -> PolynomialEquation {
        let mut a = vec![Vec::new(); outputs];
        a[output] = theta[self.a()].to_vec();
        let lists =
            |range: &dyn Fn(usize) -> Range<usize>| (0..self.inputs()).map(|k| theta[range(k)].to_vec()).collect();
        PolynomialEquation {
            a,
            b: lists(&|k| self.b(k)),
            nk: self.nk.clone(),
            c: theta[self.c()].to_vec(),
            d: theta[self.d()].to_vec(),
            f: lists(&|k| self.f(k)),
        }
    }
}
