//! `(pI − A) X = B` at many points `p`.
//!
//! A delay or a moving mean over many samples has many states, which only hand on what they get. Without the few states
//! that close circles, no state acts on itself by way of others: each follows from those before it by substitution, as
//! a linear function of the few and of the inputs. The equations of these few alone are solved. Substitution has no
//! pivots, so each solution is put into all equations, and one that leaves more than rounding is not taken.
//!
//! # Source
//! Higham, N. J. (2002), *Accuracy and Stability of Numerical Algorithms*, 2nd ed., §7.2, for the backward error.

use faer::{Mat, MatRef};
use numerics::linalg;

use crate::Complex64;

/// Below so many states all equations are solved at once.
const MANY: usize = 16;
/// Largest backward error, relative to each entry, of a solution that is taken.
const ROUNDING: f64 = 1e-12;

/// The equations of a system, prepared for many points.
pub(super) struct Resolvent<'a> {
    a: MatRef<'a, f64>,
    b: MatRef<'a, f64>,
    handed_on: Option<HandedOn>,
}

impl<'a> Resolvent<'a> {
    pub(super) fn new(a: MatRef<'a, f64>, b: MatRef<'a, f64>) -> Self {
        let handed_on = (a.nrows() >= MANY).then(|| HandedOn::of(a)).flatten();
        Resolvent { a, b, handed_on }
    }

    /// `X`, states × inputs; not finite on a pole.
    pub(super) fn at(&self, point: Complex64) -> Mat<Complex64> {
        let by_substitution = self.handed_on.as_ref().and_then(|states| states.solution(self.b, point));
        by_substitution.unwrap_or_else(|| full_solution(self.a, self.b, point))
    }
}

/// `X` of all equations at once.
pub(super) fn full_solution(a: MatRef<'_, f64>, b: MatRef<'_, f64>, point: Complex64) -> Mat<Complex64> {
    let complex = |value: f64| Complex64::new(value, 0.0);
    let n = a.nrows();
    if n == 0 {
        return Mat::zeros(0, b.ncols());
    }
    let resolvent = Mat::from_fn(n, n, |i, j| if i == j { point - a[(i, j)] } else { complex(-a[(i, j)]) });
    let b = Mat::from_fn(n, b.ncols(), |i, j| complex(b[(i, j)]));
    linalg::complex_solve(resolvent.as_ref(), b.as_ref())
}

/// States in the order in which each follows from those before it and from a few.
struct HandedOn {
    /// Entries of `A` that are not zero, by rows.
    rows: Vec<Vec<(usize, f64)>>,
    in_order: Vec<usize>,
    few: Vec<usize>,
    /// Place of a state among the few.
    place: Vec<Option<usize>>,
}

impl HandedOn {
    /// `None` where the few would be more than half of all.
    fn of(a: MatRef<'_, f64>) -> Option<Self> {
        let n = a.nrows();
        let mut rows = vec![Vec::new(); n];
        let mut acts_on = vec![Vec::new(); n];
        for j in 0..n {
            for i in (0..n).filter(|i| a[(*i, j)] != 0.0) {
                rows[i].push((j, a[(i, j)]));
                acts_on[j].push(i);
            }
        }
        // How many of the states that are left a state needs, and acts on.
        let mut needs: Vec<usize> = rows.iter().map(Vec::len).collect();
        let mut serves: Vec<usize> = acts_on.iter().map(Vec::len).collect();
        let mut is_left = vec![true; n];
        let (mut in_order, mut few) = (Vec::with_capacity(n), Vec::new());
        let mut ready: Vec<usize> = (0..n).filter(|i| needs[*i] == 0).collect();
        while in_order.len() + few.len() < n {
            let next = match ready.pop() {
                Some(state) => {
                    in_order.push(state);
                    state
                }
                None => {
                    let state = (0..n).filter(|i| is_left[*i]).max_by_key(|i| needs[*i] * serves[*i])?;
                    few.push(state);
                    state
                }
            };
            if 2 * few.len() > n {
                return None;
            }
            is_left[next] = false;
            for (needed, _) in &rows[next] {
                serves[*needed] -= 1;
            }
            for served in &acts_on[next] {
                needs[*served] -= 1;
                if needs[*served] == 0 && is_left[*served] {
                    ready.push(*served);
                }
            }
        }
        let mut place = vec![None; n];
        few.iter().enumerate().for_each(|(k, state)| place[*state] = Some(k));
        Some(HandedOn { rows, in_order, few, place })
    }

    /// `X`; `None` where it does not solve the equations to within rounding.
    fn solution(&self, b: MatRef<'_, f64>, point: Complex64) -> Option<Mat<Complex64>> {
        let (n, few, inputs) = (self.rows.len(), self.few.len(), b.ncols());
        let mut forms = vec![Vec::new(); n];
        for state in &self.in_order {
            let mut form = self.driven(*state, b, &forms);
            form.iter_mut().for_each(|entry| *entry /= point);
            forms[*state] = form;
        }
        let driven: Vec<Vec<Complex64>> = self.few.iter().map(|state| self.driven(*state, b, &forms)).collect();
        let own = |i: usize, j: usize| if i == j { point } else { Complex64::ZERO };
        let of_few = match few {
            0 => Mat::zeros(0, inputs),
            _ => linalg::complex_solve(
                Mat::from_fn(few, few, |i, j| own(i, j) - driven[i][j]).as_ref(),
                Mat::from_fn(few, inputs, |i, j| driven[i][few + j]).as_ref(),
            ),
        };
        let value = |state: usize, input: usize| match self.place[state] {
            Some(place) => of_few[(place, input)],
            None => {
                let form = &forms[state];
                form[few + input] + (0..few).map(|k| form[k] * of_few[(k, input)]).sum::<Complex64>()
            }
        };
        let x = Mat::from_fn(n, inputs, value);
        self.is_solved_by(&x, b, point).then_some(x)
    }

    /// `A x + b u` of a state, as a linear function of the few states and of the inputs.
    fn driven(&self, state: usize, b: MatRef<'_, f64>, forms: &[Vec<Complex64>]) -> Vec<Complex64> {
        let few = self.few.len();
        let mut sum = vec![Complex64::ZERO; few];
        sum.extend((0..b.ncols()).map(|input| Complex64::new(b[(state, input)], 0.0)));
        for (other, entry) in &self.rows[state] {
            match self.place[*other] {
                Some(place) => sum[place] += entry,
                None => sum.iter_mut().zip(&forms[*other]).for_each(|(sum, part)| *sum += part * entry),
            }
        }
        sum
    }

    /// Tells whether what is left of each equation is rounding beside its terms.
    fn is_solved_by(&self, x: &Mat<Complex64>, b: MatRef<'_, f64>, point: Complex64) -> bool {
        let solves = |state: usize, input: usize| {
            let own = point * x[(state, input)];
            let (mut left, mut size) = (own - b[(state, input)], own.norm() + b[(state, input)].abs());
            for (other, entry) in &self.rows[state] {
                let term = x[(*other, input)] * entry;
                left -= term;
                size += term.norm();
            }
            left.norm() <= ROUNDING * size
        };
        (0..x.ncols()).all(|input| (0..x.nrows()).all(|state| solves(state, input)))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use faer::Mat;
    use proptest::prelude::*;

    use super::{HandedOn, MANY, Resolvent, full_solution};
    use crate::Complex64;

    /// Largest difference of two solutions, over the largest entry.
    fn apart(one: &Mat<Complex64>, other: &Mat<Complex64>) -> f64 {
        (one - other).norm_max() / other.norm_max()
    }

    proptest! {
        /// Some states that act on one another, delays behind them, and what comes back of these.
        #[test]
        fn prop_delays_are_substituted_and_solve_the_equations(
            core in 1_usize..6,
            delays in 15_usize..60,
            values in prop::collection::vec(-1.0_f64..1.0, 400),
            scales in prop::collection::vec(-3.0_f64..3.0, 70),
            angle in 0.0_f64..3.2,
        ) {
            let n = core + delays;
            let sparse = |i: usize, j: usize| {
                let value = values[(31 * i + 17 * j) % 400];
                match (i < core, j < core) {
                    (true, true) => value,
                    (true, false) => if (i + j).is_multiple_of(7) { value } else { 0.0 },
                    (false, true) => if (i + j).is_multiple_of(3) { value } else { 0.0 },
                    (false, false) => f64::from(u8::from(i == j + 1)),
                }
            };
            let a = Mat::from_fn(n, n, |i, j| sparse(i, j) * 10_f64.powf(scales[i] - scales[j]));
            let b = Mat::from_fn(n, 2, |i, j| values[(3 * i + j) % 400]);
            let point = Complex64::cis(angle);
            let found = HandedOn::of(a.as_ref()).unwrap();
            prop_assert!(found.few.len() <= core + 1, "{:?}", found.few);
            if let Some(x) = found.solution(b.as_ref(), point) {
                let far = apart(&x, &full_solution(a.as_ref(), b.as_ref(), point));
                prop_assert!(far < 1e-9, "{far:e}");
            }
        }

        #[test]
        fn prop_a_full_matrix_is_solved_at_once(values in prop::collection::vec(0.1_f64..1.0, 400)) {
            let a = Mat::from_fn(20, 20, |i, j| values[20 * i + j]);
            prop_assert!(HandedOn::of(a.as_ref()).is_none());
        }
    }

    /// Without pivots the large entries would leave nothing of the small ones.
    #[test]
    fn exact_a_solution_that_substitution_spoils_is_not_taken() {
        let n = MANY;
        let mut a = Mat::from_fn(n, n, |i, j| f64::from(u8::from(i == j + 1)));
        a[(0, n - 1)] = 0.5;
        let b = Mat::from_fn(n, 1, |i, _| f64::from(u8::from(i == 0)));
        let point = Complex64::new(1e-3, 0.0);
        let x = Resolvent::new(a.as_ref(), b.as_ref()).at(point);
        assert!(apart(&x, &full_solution(a.as_ref(), b.as_ref(), point)) < 1e-9);
    }
}
