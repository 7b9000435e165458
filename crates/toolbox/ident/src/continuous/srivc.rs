//! Starting values: simplified refined instrumental variables.
//!
//! `y⁽ⁿ⁾ + a_{n−1} y⁽ⁿ⁻¹⁾ + … = Σ_k b_m u_k⁽ᵐ⁾ + …`, every signal filtered by `1/Â(s)`, is linear in the coefficients;
//! noise on `y` is kept from biasing them by instruments made of the simulated output of the model before. Inputs share
//! the denominator. Time is counted in samples.
//!
//! # Source
//! Young, P. C. & Jakeman, A. (1980), *Refined instrumental variable methods of recursive time-series analysis III*,
//! Int. J. Control 31; Garnier & Wang (eds.), *Identification of Continuous-time Models from Sampled Data*, 2008, ch.
//! 4.

use faer::Mat;
use lti::Complex64;
use numerics::linalg::{self, Qr};
use numerics::vector::{dot, sum_of_squares};

use super::companion::Companion;
use super::projection::Basis;
use super::record::{Course, Record};
use super::sampled::Sampled;
use crate::{IdentError, Intersample, Triangle};

/// Singular values below this part of the largest take no part in a starting value.
const NEGLIGIBLE: f64 = 1e-12;

/// Structure for which starting values are sought.
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
        // The filter of a settled estimate is its denominator, known integrators included: only then does y⁽ⁿ⁾/Â + …
        // come to y itself, whatever is assumed of it between the samples.
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
        let (unknown, instruments) = (feedback + forward, if model.is_some() { feedback } else { 0 });
        let width = instruments + unknown + 1;
        let (mut triangle, mut sizes) = (Triangle::new(width), vec![0.0; width]);
        let filters = Filters::new(self, filter, model)?;
        for record in records {
            let (mut columns, own) = self.columns(record, &filters);
            columns.iter().zip(&mut sizes).for_each(|(column, size)| *size += sum_of_squares(column));
            columns.iter_mut().for_each(|column| {
                own.take_out(column);
            });
            let mut row = vec![0.0; width];
            for i in 0..columns[0].len() {
                row.iter_mut().zip(&columns).for_each(|(slot, column)| *slot = column[i]);
                triangle.push_row(&row);
            }
        }
        let sizes: Vec<f64> = sizes[instruments..instruments + unknown].iter().map(|size| size.sqrt()).collect();
        Ok(self.unpack(&solve(&triangle.finish(), instruments, &sizes), forward))
    }

    /// `[instruments | u derivatives | −y derivatives | y⁽ⁿ⁾]`, all filtered: instruments in place of y come first, and
    /// those after them are instruments of their own. Beside them what initial states and an offset do to the record,
    /// which is its own instrument too and can be taken out of all columns.
    fn columns(&self, record: &Record<'_>, filters: &Filters) -> (Vec<Vec<f64>>, Basis) {
        let length = record.output.len() - record.first;
        let mut columns: Vec<_> = filters.instruments(record, length).into_iter().skip(self.integrators).collect();
        for ((u, m), filter) in record.inputs.iter().zip(self.degrees).zip(&filters.of_inputs) {
            columns.extend(filters.derivatives(filter, u, record.first).into_iter().take(m + 1));
        }
        let output = filled(record);
        let measured = Course { columns: vec![&output], before: 0.0 };
        let mut from_y = filters.derivatives(&filters.of_output, &measured, record.first);
        let target = from_y.pop();
        from_y.iter_mut().flatten().for_each(|v| *v = -*v);
        columns.extend(from_y.into_iter().skip(self.integrators));
        columns.extend(target);
        let mut own = filters.free.free_responses(&filters.seen, length);
        if self.offset {
            own.push(vec![1.0; length]);
        }
        columns.iter_mut().chain(&mut own).for_each(|c| record.keep(c));
        (columns, Basis::new(own))
    }

    fn unpack(&self, solution: &[f64], forward: usize) -> Estimate {
        let mut a = vec![0.0; self.integrators];
        a.extend_from_slice(&solution[forward..]);
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

/// The filter `1/Â` and what is behind it, sampled once for all records.
struct Filters {
    /// Coefficients of Â.
    a: Vec<f64>,
    of_output: Sampled,
    of_inputs: Vec<Sampled>,
    /// Of the simulated output of the model before; none without one.
    of_model: Vec<Sampled>,
    /// The filter without delay, and how its states are seen.
    free: Sampled,
    seen: Vec<f64>,
}

impl Filters {
    fn new(structure: &Structure<'_>, filter: &[f64], model: Option<&Estimate>) -> Result<Self, IdentError> {
        let between = structure.intersample;
        let late = |delay: &f64| Ok(Companion::monic(filter, &[1.0], *delay).sampled(between)?);
        let simulated = |(b, delay): (&Vec<f64>, &f64)| Ok(Companion::monic(filter, b, *delay).cascade(between)?);
        let numerators = model.map_or(&[][..], |model| &model.b);
        let alone = Companion::monic(filter, &[1.0], 0.0);
        Ok(Filters {
            a: filter.to_vec(),
            of_output: alone.sampled(Intersample::FirstOrderHold)?,
            of_inputs: structure.delays.iter().map(late).collect::<Result<_, IdentError>>()?,
            of_model: numerators.iter().zip(structure.delays).map(simulated).collect::<Result<_, IdentError>>()?,
            free: alone.sampled(between)?,
            seen: alone.output().0,
        })
    }

    /// `p^j/Â x` for j = 0 … n.
    fn derivatives(&self, filter: &Sampled, x: &Course<'_>, first: usize) -> Vec<Vec<f64>> {
        let n = self.a.len();
        let mut columns = vec![Vec::new(); n + 1];
        filter.run(x, first, &mut vec![0.0; n], |_, z, v, _| {
            let highest = v - dot(&self.a, z);
            columns.iter_mut().zip(z.iter().chain([&highest])).for_each(|(column, value)| column.push(*value));
        });
        columns
    }

    /// Filtered derivatives of the simulated output, negative; none without a model.
    fn instruments(&self, record: &Record<'_>, length: usize) -> Vec<Vec<f64>> {
        let n = self.a.len();
        let mut columns = vec![vec![0.0; length]; n];
        for (u, cascade) in record.inputs.iter().zip(&self.of_model) {
            cascade.run(u, record.first, &mut vec![0.0; 2 * n], |k, state, _, _| {
                columns.iter_mut().zip(&state[n..]).for_each(|(column, w)| column[k - record.first] -= w);
            });
        }
        if self.of_model.is_empty() { Vec::new() } else { columns }
    }
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

/// Solves `Zᵀ Φ θ = Zᵀ y` from the factor of `[Z′ | Φ | y]`, whose first columns after `Z′` belong to both. `sizes` are
/// those of the columns of Φ before anything was taken out of them: what is rounding beside them counts for nothing.
fn solve(factor: &Mat<f64>, instruments: usize, sizes: &[f64]) -> Vec<f64> {
    // Rows 0..unknown of the factor are QᵀΦ and Qᵀy on an orthonormal basis of the instruments.
    let unknown = sizes.len();
    let scale: Vec<f64> = sizes.iter().map(|size| if *size > 0.0 { *size } else { 1.0 }).collect();
    let matrix = Mat::from_fn(unknown, unknown, |i, j| factor[(i, instruments + j)] / scale[j]);
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
