//! Regressors and gradients of the structures.

use lti::PolynomialEquation;

use super::stability::is_stable;
use crate::IdentError;
use fitting::StructureError;

/// The structure followed, with one output. Lists have one entry an input; see [`PolynomialEquation`] for the signs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum RecursiveStructure {
    /// `A y = Σ B u + e`: recursive least squares.
    Arx {
        /// Coefficients of `A`.
        na: usize,
        /// Coefficients of each `B`.
        nb: Vec<usize>,
        /// Delay of each input.
        nk: Vec<usize>,
    },
    /// `A y = Σ B u + C e`: recursive maximum likelihood, the gradient filtered by `1/C`, `C` kept stable.
    Armax {
        /// Coefficients of `A`.
        na: usize,
        /// Coefficients of each `B`.
        nb: Vec<usize>,
        /// Coefficients of `C`.
        nc: usize,
        /// Delay of each input.
        nk: Vec<usize>,
    },
    /// `y = Σ B/F u + e`: recursive prediction error, the gradient filtered by `1/F`, each `F` kept stable.
    OutputError {
        /// Coefficients of each `B`.
        nb: Vec<usize>,
        /// Coefficients of each `F`.
        nf: Vec<usize>,
        /// Delay of each input.
        nk: Vec<usize>,
    },
}

/// Past values of one signal, the latest first, and of the same signal filtered.
#[derive(Debug, Clone)]
struct Past {
    plain: Vec<f64>,
    filtered: Vec<f64>,
}

impl Past {
    fn new(length: usize) -> Self {
        Past { plain: vec![0.0; length], filtered: vec![0.0; length] }
    }

    /// Takes a value in, and its filtered one, `x_f = x − Σ c_i x_f(t − i)`.
    fn push(&mut self, value: f64, filter: &[f64]) {
        let filtered = value - filter.iter().zip(&self.filtered).map(|(c, x)| c * x).sum::<f64>();
        for (list, v) in [(&mut self.plain, value), (&mut self.filtered, filtered)] {
            if !list.is_empty() {
                list.rotate_right(1);
                list[0] = v;
            }
        }
    }

    fn clear(&mut self) {
        self.plain.fill(0.0);
        self.filtered.fill(0.0);
    }
}

#[derive(Debug, Clone)]
pub(super) struct Regressor {
    na: usize,
    nb: Vec<usize>,
    nk: Vec<usize>,
    nc: usize,
    nf: Vec<usize>,
    output: Past,
    /// From the present input on.
    inputs: Vec<Past>,
    errors: Past,
    /// The noise-free output of each input's way, `B/F u`.
    responses: Vec<Past>,
    /// Samples until the regressor knows all it needs: at first, and after a missing input.
    unknown: usize,
}

impl Regressor {
    pub(super) fn new(structure: RecursiveStructure) -> Result<Self, IdentError> {
        let (na, nb, nc, nf, nk) = match structure {
            RecursiveStructure::Arx { na, nb, nk } => (na, nb, 0, Vec::new(), nk),
            RecursiveStructure::Armax { na, nb, nc, nk } => (na, nb, nc, Vec::new(), nk),
            RecursiveStructure::OutputError { nb, nf, nk } => (0, nb, 0, nf, nk),
        };
        if nb.len() != nk.len() || (!nf.is_empty() && nf.len() != nb.len()) {
            return Err(StructureError::EntriesDiffer { nb: nb.len(), nf: nf.len(), nk: nk.len() }.into());
        }
        if na + nb.iter().sum::<usize>() + nc + nf.iter().sum::<usize>() == 0 {
            return Err(StructureError::NoParameters.into());
        }
        if nf.windows(2).any(|w| w[0] != w[1]) {
            return Err(StructureError::UnequalOrders { nf }.into());
        }
        let depth = na.max(nc).max(nf.iter().copied().max().unwrap_or(0)) + 1;
        let past_input = |(b, k): (&usize, &usize)| Past::new((b + k).max(depth));
        let mut regressor = Regressor {
            output: Past::new(depth),
            inputs: nb.iter().zip(&nk).map(past_input).collect(),
            errors: Past::new(depth),
            responses: nf.iter().map(|_| Past::new(depth)).collect(),
            unknown: 0,
            na,
            nb,
            nk,
            nc,
            nf,
        };
        regressor.forget_past();
        Ok(regressor)
    }

    pub(super) fn parameter_count(&self) -> usize {
        self.na + self.nb.iter().sum::<usize>() + self.nc + self.nf.iter().sum::<usize>()
    }

    /// Parameters of the ARX model of the start: all but those of the noise, and one set of poles for all inputs.
    pub(super) fn starting_count(&self) -> usize {
        self.na + self.nb.iter().sum::<usize>() + self.nf.first().copied().unwrap_or(0)
    }

    /// Poles of each input of an output-error model.
    pub(super) fn poles(&self) -> Option<usize> {
        self.nf.first().copied().filter(|nf| *nf > 0)
    }

    pub(super) fn check(&self, inputs: &[f64], output: f64) -> Result<(), IdentError> {
        if inputs.len() != self.nb.len() {
            return Err(IdentError::Length { what: "inputs", expected: self.nb.len(), found: inputs.len() });
        }
        if let Some(index) = inputs.iter().position(|v| v.is_infinite()) {
            return Err(IdentError::NotFinite { what: "the inputs", index });
        }
        if output.is_infinite() {
            return Err(IdentError::NotFinite { what: "the output", index: 0 });
        }
        Ok(())
    }

    /// How far back the inputs are needed, the present one counted.
    fn deepest_input(&self) -> usize {
        self.nb.iter().zip(&self.nk).map(|(b, k)| b + k).max().unwrap_or(0)
    }

    /// Takes the present inputs in; whether the regressor knows all it needs.
    pub(super) fn read_inputs(&mut self, inputs: &[f64], parameters: &[f64], starting: bool) -> bool {
        self.unknown = self.unknown.saturating_sub(1);
        if inputs.iter().any(|v| v.is_nan()) {
            self.unknown = self.unknown.max(self.deepest_input());
        }
        for (k, value) in inputs.iter().enumerate() {
            let filter = if starting { 0..0 } else { self.filter_of_input(k) };
            let past = &mut self.inputs[k];
            past.push(if value.is_nan() { past.plain[0] } else { *value }, &parameters[filter]);
        }
        self.unknown == 0
    }

    /// Where the coefficients are by which the gradient with respect to `B` of an input is filtered.
    fn filter_of_input(&self, input: usize) -> std::ops::Range<usize> {
        let first = self.na + self.nb.iter().sum::<usize>();
        if self.nf.is_empty() {
            return first..first + self.nc;
        }
        let start = first + self.nf[..input].iter().sum::<usize>();
        start..start + self.nf[input]
    }

    /// Writes the regressor φ and the gradient ψ = ∂ŷ/∂θ of the present instant, in the order a, b, c, f. At the start
    /// the poles of an output-error model are those of the output itself.
    pub(super) fn write(&mut self, starting: bool, phi: &mut [f64], psi: &mut [f64]) {
        let filters = !starting && (self.nc > 0 || !self.nf.is_empty());
        let mut at = 0;
        let mut put = |past: &Past, range: std::ops::Range<usize>, sign: f64| {
            for i in range {
                phi[at] = sign * past.plain[i];
                psi[at] = if filters { sign * past.filtered[i] } else { phi[at] };
                at += 1;
            }
        };
        put(&self.output, 0..self.na, -1.0);
        for (k, past) in self.inputs.iter().enumerate() {
            put(past, self.nk[k]..self.nk[k] + self.nb[k], 1.0);
        }
        put(&self.errors, 0..self.nc, 1.0);
        for (past, nf) in self.responses.iter().zip(&self.nf) {
            put(if starting { &self.output } else { past }, 0..*nf, -1.0);
        }
    }

    /// Takes in what the instant has brought; `value` is the prediction by the parameters after it.
    pub(super) fn advance(&mut self, parameters: &[f64], output: f64, value: f64, starting: bool) {
        let output = if output.is_nan() { value } else { output };
        let c_start = self.na + self.nb.iter().sum::<usize>();
        let c = if starting { &[][..] } else { &parameters[c_start..c_start + self.nc] };
        self.output.push(output, c);
        // Until there are parameters the errors are unknown: zero is their mean.
        self.errors.push(if starting { 0.0 } else { output - value }, c);
        let (mut b_at, mut f_at) = (self.na, c_start + self.nc);
        let alone = self.responses.len() == 1;
        for (k, past) in self.responses.iter_mut().enumerate() {
            let b = &parameters[b_at..b_at + self.nb[k]];
            let f = &parameters[f_at..f_at + self.nf[k]];
            (b_at, f_at) = (b_at + self.nb[k], f_at + self.nf[k]);
            let fed: f64 = b.iter().zip(&self.inputs[k].plain[self.nk[k]..]).map(|(b, u)| b * u).sum();
            let back: f64 = f.iter().zip(&past.plain).map(|(f, w)| f * w).sum();
            match starting {
                // The output itself is the best that is known of the response to a single input.
                true => past.push(if alone { output } else { 0.0 }, &[]),
                false => past.push(fed - back, f),
            }
        }
    }

    /// After the start: the poles found are those of every input.
    pub(super) fn share_poles(&self, parameters: &mut [f64]) {
        let Some(nf) = self.nf.first() else { return };
        let first = self.na + self.nb.iter().sum::<usize>();
        for at in first + nf..parameters.len() {
            parameters[at] = parameters[at - nf];
        }
    }

    /// Returns true if the parameters are finite and the predictor, `C` or every `F`, is stable.
    pub(super) fn is_stable(&self, parameters: &[f64]) -> bool {
        parameters.iter().all(|p| p.is_finite()) && self.predictor_poles().all(|range| is_stable(&parameters[range]))
    }

    fn predictor_poles(&self) -> impl Iterator<Item = std::ops::Range<usize>> {
        let first = self.na + self.nb.iter().sum::<usize>();
        let mut at = first + self.nc;
        let f = self.nf.iter().map(move |n| {
            at += n;
            at - n..at
        });
        std::iter::once(first..first + self.nc).chain(f)
    }

    pub(super) fn forget_past(&mut self) {
        self.output.clear();
        self.errors.clear();
        self.inputs.iter_mut().chain(&mut self.responses).for_each(Past::clear);
        let back = self.na.max(self.nf.first().copied().unwrap_or(0));
        self.unknown = (back + 1).max(self.deepest_input());
    }

    /// The equation with all coefficients zero.
    pub(super) fn shape(&self) -> PolynomialEquation {
        let inputs = self.nb.len();
        PolynomialEquation {
            a: vec![vec![0.0; self.na]],
            b: self.nb.iter().map(|n| vec![0.0; *n]).collect(),
            nk: self.nk.clone(),
            c: vec![0.0; self.nc],
            d: Vec::new(),
            f: if self.nf.is_empty() {
                vec![Vec::new(); inputs]
            } else {
                self.nf.iter().map(|n| vec![0.0; *n]).collect()
            },
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The predictions of a structure whose parameters stay, and their gradients.
    fn follow(structure: &RecursiveStructure, theta: &[f64], records: &[Vec<f64>; 3]) -> Vec<(f64, Vec<f64>)> {
        let mut regressor = Regressor::new(structure.clone()).unwrap();
        let inputs = regressor.nb.len();
        let (mut phi, mut psi) = (vec![0.0; theta.len()], vec![0.0; theta.len()]);
        let mut step = |t: usize| {
            let u: Vec<f64> = records[..inputs].iter().map(|u| u[t]).collect();
            regressor.read_inputs(&u, theta, false);
            regressor.write(false, &mut phi, &mut psi);
            let value = phi.iter().zip(theta).map(|(x, p)| x * p).sum();
            regressor.advance(theta, records[2][t], value, false);
            (value, psi.clone())
        };
        (0..records[2].len()).map(&mut step).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn prop_gradients_equal_differences(
            values in prop::collection::vec(-0.45_f64..0.45, 8),
            u in prop::collection::vec(-1.0_f64..1.0, 60),
            v in prop::collection::vec(-1.0_f64..1.0, 60),
            y in prop::collection::vec(-1.0_f64..1.0, 60),
        ) {
            let records = [u, v, y];
            for structure in [
                RecursiveStructure::Arx { na: 2, nb: vec![2, 1], nk: vec![1, 2] },
                RecursiveStructure::Armax { na: 2, nb: vec![2, 1], nc: 2, nk: vec![1, 0] },
                RecursiveStructure::OutputError { nb: vec![2, 1], nf: vec![2, 2], nk: vec![1, 2] },
            ] {
                let theta = &values[..Regressor::new(structure.clone()).unwrap().parameter_count()];
                let at = follow(&structure, theta, &records);
                for j in 0..theta.len() {
                    let moved = |by: f64| {
                        let mut theta = theta.to_vec();
                        theta[j] += by;
                        follow(&structure, &theta, &records)
                    };
                    let (above, below) = (moved(1e-6), moved(-1e-6));
                    for t in 0..at.len() {
                        let difference = (above[t].0 - below[t].0) / 2e-6;
                        prop_assert!((at[t].1[j] - difference).abs() < 1e-7, "{structure:?} {j} {t}");
                    }
                }
            }
        }
    }
}
