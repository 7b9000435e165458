//! Starting values: simplified refined instrumental variables.
//!
//! `y⁽ⁿ⁾ + a_{n−1} y⁽ⁿ⁻¹⁾ + … = Σ_k b_m u_k⁽ᵐ⁾ + …`, every signal filtered by `1/Â(s)`, is linear in the coefficients; noise
//! on `y` is kept from biasing them by instruments made of the simulated output of the model before. Inputs share the
//! denominator. Time is counted in samples.
//!
//! # Source
//! Young, P. C. & Jakeman, A. (1980), *Refined instrumental variable methods of recursive time-series analysis III*, Int.
//! J. Control 31; Garnier & Wang (eds.), *Identification of Continuous-time Models from Sampled Data*, 2008, ch. 4.

use faer::Mat;
use lti::Complex64;
use numerics::linalg::{self, Qr};

use super::companion::Companion;
use super::record::Record;
use crate::{IdentError, Intersample, Triangle};

/// Singular values below this part of the largest take no part in a starting value.
const NEGLIGIBLE: f64 = 1e-12;

/// What is to be started.
#[derive(Debug, Clone)]
pub(crate) struct Structure<'a> {
    /// Degree of the numerator from each input.
    pub(crate) degrees: &'a [usize],
    /// Delay from each input, in samples.
    pub(crate) delays: &'a [f64],
    pub(crate) poles: usize,
    /// Poles known to be at zero.
    pub(crate) integrators: usize,
    pub(crate) offset: bool,
    pub(crate) intersample: Intersample,
}

/// Coefficients in ascending powers of p, in units of one over the sample time; A is monic, its leading one not stored.
#[derive(Debug, Clone)]
pub(crate) struct Estimate {
    pub(crate) a: Vec<f64>,
    pub(crate) b: Vec<Vec<f64>>,
}

impl Structure<'_> {
    /// Regression on filtered derivatives, the filter being `1/(p + λ)ⁿ`.
    pub(crate) fn least_squares(&self, records: &[Record<'_>], lambda: f64) -> Result<Estimate, IdentError> {
        let poles = vec![Complex64::new(-lambda, 0.0); self.poles];
        self.regress(records, &filter_of(&poles), None)
    }

    /// One round of instrumental variables about the estimate before.
    pub(crate) fn refine(&self, records: &[Record<'_>], before: &Estimate) -> Result<Estimate, IdentError> {
        let length = records.iter().map(|r| r.output.len()).max().unwrap_or(1);
        // The filter of a settled estimate is its denominator, known integrators included: only then does y⁽ⁿ⁾/Â + … come to
        // y itself, whatever is assumed of it between the samples.
        let mut filter = vec![0.0; self.integrators];
        filter.extend(stable_filter(&before.a[self.integrators..], 1.0 / length as f64)?);
        self.regress(records, &filter, Some(before))
    }

    fn regress(
        &self,
        records: &[Record<'_>],
        filter: &[f64],
        model: Option<&Estimate>,
    ) -> Result<Estimate, IdentError> {
        let feedback = self.poles - self.integrators;
        let forward: usize = self.degrees.iter().map(|m| m + 1).sum();
        let nuisance = records.len() * (self.poles + usize::from(self.offset));
        let unknown = feedback + forward + nuisance;
        let instruments = if model.is_some() { feedback } else { 0 };
        let mut triangle = Triangle::new(instruments + unknown + 1);
        let mut row = vec![0.0; instruments + unknown + 1];
        for (index, record) in records.iter().enumerate() {
            let columns = self.columns(record, filter, model)?;
            let place = instruments + feedback + forward + index * (self.poles + usize::from(self.offset));
            for i in 0..columns[0].len() {
                // [instruments in place of y | u, nuisance | y | target]: the first two blocks are the instruments.
                row.fill(0.0);
                let (ours, own) = columns.split_at(1 + instruments + forward + feedback);
                let value = |c: &Vec<f64>| c[i];
                let (target, rest) = (ours[0][i], &ours[1..]);
                row[..instruments].iter_mut().zip(rest).for_each(|(slot, c)| *slot = value(c));
                row[instruments..instruments + forward]
                    .iter_mut()
                    .zip(&rest[instruments..])
                    .for_each(|(s, c)| *s = value(c));
                let shared = place - feedback;
                row[shared..shared + own.len()].iter_mut().zip(own).for_each(|(slot, c)| *slot = value(c));
                let y = instruments + forward + nuisance;
                row[y..y + feedback].iter_mut().zip(&rest[instruments + forward..]).for_each(|(s, c)| *s = value(c));
                row[instruments + unknown] = target;
                triangle.push_row(&row);
            }
        }
        let solution = solve(&triangle.finish(), instruments, unknown);
        Ok(self.unpack(&solution, forward, nuisance))
    }

    /// `[y⁽ⁿ⁾ | instruments | u derivatives | −y derivatives | free responses, one]`, all filtered.
    fn columns(
        &self,
        record: &Record<'_>,
        filter: &[f64],
        model: Option<&Estimate>,
    ) -> Result<Vec<Vec<f64>>, IdentError> {
        let y = filled(record);
        let (mut from_y, target) = derivatives(&[&y], record.first, (filter, 0.0), Intersample::FirstOrderHold)?;
        let mut columns = vec![target];
        if let Some(model) = model {
            columns.extend(self.instruments(record, filter, model)?);
        }
        for ((u, m), delay) in record.inputs.iter().zip(self.degrees).zip(self.delays) {
            let (mut from_u, highest) = derivatives(u, record.first, (filter, *delay), self.intersample)?;
            from_u.push(highest);
            from_u.truncate(m + 1);
            columns.append(&mut from_u);
        }
        from_y.iter_mut().flatten().for_each(|v| *v = -*v);
        columns.extend(from_y.drain(self.integrators..));
        let length = record.output.len() - record.first;
        let free = Companion::monic(filter, &[1.0], 0.0).free_responses(self.intersample, length)?;
        columns.extend(free.into_iter().map(|mut response| {
            response.resize(length, 0.0);
            response
        }));
        if self.offset {
            columns.push(vec![1.0; length]);
        }
        columns.iter_mut().for_each(|c| record.keep(c));
        Ok(columns)
    }

    /// Filtered derivatives of the simulated output, negative.
    fn instruments(&self, record: &Record<'_>, filter: &[f64], model: &Estimate) -> Result<Vec<Vec<f64>>, IdentError> {
        let n = self.poles;
        let length = record.output.len() - record.first;
        let mut columns = vec![vec![0.0; length]; n];
        for ((u, b), delay) in record.inputs.iter().zip(&model.b).zip(self.delays) {
            let cascade = Companion::monic(filter, b, *delay).cascade(self.intersample)?;
            cascade.run(u, record.first, &mut vec![0.0; 2 * n], |k, state, _, _| {
                columns.iter_mut().zip(&state[n..]).for_each(|(column, w)| column[k - record.first] -= w);
            });
        }
        Ok(columns.split_off(self.integrators))
    }

    fn unpack(&self, solution: &[f64], forward: usize, nuisance: usize) -> Estimate {
        let mut a = vec![0.0; self.integrators];
        a.extend_from_slice(&solution[forward + nuisance..]);
        let mut rest = &solution[..forward];
        let mut take = |count: usize| {
            let (own, others) = rest.split_at(count);
            rest = others;
            own.to_vec()
        };
        let b = self.degrees.iter().map(|m| take(m + 1)).collect();
        Estimate { a, b }
    }
}

/// `p^j/Â x` for j < n, and for j = n.
type Derivatives = (Vec<Vec<f64>>, Vec<f64>);

fn derivatives(
    x: &[&[f64]],
    first: usize,
    (filter, delay): (&[f64], f64),
    intersample: Intersample,
) -> Result<Derivatives, IdentError> {
    let n = filter.len();
    let sampled = Companion::monic(filter, &[1.0], delay).sampled(intersample)?;
    let mut columns = vec![Vec::new(); n];
    let mut highest = Vec::new();
    sampled.run(x, first, &mut vec![0.0; n], |_, z, v, _| {
        columns.iter_mut().zip(z).for_each(|(column, z)| column.push(*z));
        highest.push(v - filter.iter().zip(z).map(|(a, z)| a * z).sum::<f64>());
    });
    Ok((columns, highest))
}

/// The output with the sample before in place of missing ones.
fn filled(record: &Record<'_>) -> Vec<f64> {
    let mut last = record.output.iter().skip(record.first).copied().find(|y| !y.is_nan()).unwrap_or(0.0);
    let mut fill = |y: &f64| {
        last = if y.is_nan() { last } else { *y };
        last
    };
    record.output.iter().map(&mut fill).collect()
}

/// Solves `Zᵀ Φ θ = Zᵀ y` from the factor of `[Z′ | Φ | y]`, whose first columns after `Z′` belong to both.
fn solve(factor: &Mat<f64>, instruments: usize, unknown: usize) -> Vec<f64> {
    // Rows 0..unknown of the factor are QᵀΦ and Qᵀy on an orthonormal basis of the instruments.
    let column = |j: usize| instruments + j;
    let scale: Vec<f64> = (0..unknown)
        .map(|j| (0..unknown).map(|i| factor[(i, column(j))].powi(2)).sum::<f64>().sqrt())
        .map(|length| if length > 0.0 { length } else { 1.0 })
        .collect();
    let matrix = Mat::from_fn(unknown, unknown, |i, j| factor[(i, column(j))] / scale[j]);
    let right = Mat::from_fn(unknown, 1, |i, _| factor[(i, instruments + unknown)]);
    let solution = linalg::least_norm(matrix.as_ref(), right.as_ref(), NEGLIGIBLE)
        .unwrap_or_else(|_| Qr::new(matrix.as_ref()).least_squares(right.as_ref()));
    (0..unknown).map(|j| solution[(j, 0)] / scale[j]).collect()
}

/// `Â` of these poles, ascending, without its leading one.
fn filter_of(poles: &[Complex64]) -> Vec<f64> {
    let mut ascending = lti::polynomial::from_roots(poles);
    ascending.reverse();
    ascending.pop();
    ascending
}

/// The polynomial with its poles mirrored into the left half-plane, at least so far from the axis.
pub(crate) fn stable_filter(a: &[f64], margin: f64) -> Result<Vec<f64>, IdentError> {
    let descending: Vec<f64> = std::iter::once(1.0).chain(a.iter().rev().copied()).collect();
    let mirror = |p: Complex64| Complex64::new(-p.re.abs().max(margin), p.im);
    Ok(filter_of(&lti::polynomial::roots(&descending)?.into_iter().map(mirror).collect::<Vec<_>>()))
}
