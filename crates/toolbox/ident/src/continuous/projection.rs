//! Orthonormal bases of what is fitted along with the parameters but not asked for: initial states and offsets.

use numerics::vector::{add_scaled, dot, norm};

/// A column that loses all but this part of its length to the columns before it says nothing new.
const DEPENDENT: f64 = 1e-10;

/// An orthonormal basis of a few tall columns, and how the columns are combined from it. Columns end with their last
/// value that is not zero.
#[derive(Debug, Clone, Default)]
pub(crate) struct Basis {
    columns: Vec<Vec<f64>>,
    /// For each column of the basis, its combination of the columns given.
    combinations: Vec<Vec<f64>>,
}

impl Basis {
    /// By Gram and Schmidt, twice over, short columns first, so that they stay short; dependent columns are left out.
    pub(crate) fn new(given: Vec<Vec<f64>>) -> Self {
        let count = given.len();
        let mut ordered: Vec<(usize, Vec<f64>)> = given.into_iter().map(without_zeros_at_end).enumerate().collect();
        ordered.sort_by_key(|(_, column)| column.len());
        let mut basis = Basis::default();
        for (index, mut column) in ordered {
            let length = norm(&column);
            if !(length > 0.0 && length.is_finite()) {
                continue;
            }
            column.iter_mut().for_each(|v| *v /= length);
            let mut combination = vec![0.0; count];
            combination[index] = 1.0 / length;
            for _ in 0..2 {
                for (q, of) in basis.columns.iter().zip(&basis.combinations) {
                    let along = dot(q, &column);
                    add_scaled(-along, q, &mut column);
                    add_scaled(-along, of, &mut combination);
                }
            }
            let rest = norm(&column);
            if rest > DEPENDENT {
                column.iter_mut().chain(&mut combination).for_each(|v| *v /= rest);
                basis.columns.push(column);
                basis.combinations.push(combination);
            }
        }
        basis
    }

    /// Number of independent columns.
    pub(crate) fn rank(&self) -> usize {
        self.columns.len()
    }

    /// Takes out of `x` what lies in the space; returns how the columns given add up to that.
    pub(crate) fn take_out(&self, x: &mut [f64]) -> Vec<f64> {
        let mut found = vec![0.0; self.combinations.first().map_or(0, Vec::len)];
        for _ in 0..2 {
            for (q, of) in self.columns.iter().zip(&self.combinations) {
                let along = dot(q, x);
                add_scaled(-along, q, x);
                add_scaled(along, of, &mut found);
            }
        }
        found
    }
}

fn without_zeros_at_end(mut column: Vec<f64>) -> Vec<f64> {
    column.truncate(column.iter().rposition(|v| *v != 0.0).map_or(0, |last| last + 1));
    column
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_a_short_column_takes_out_what_its_long_form_does() {
        let decay: Vec<f64> = (0..200).map(|k| 0.5_f64.powi(k)).collect();
        let slower: Vec<f64> = (0..200).map(|k| 0.8_f64.powi(k)).collect();
        let x: Vec<f64> = (0..200).map(|k| f64::from(k % 7) + 3.0).collect();
        let (mut by_long, mut by_short) = (x.clone(), x);
        let long = Basis::new(vec![slower.clone(), vec![1.0; 200], decay.clone()]).take_out(&mut by_long);
        let short = Basis::new(vec![slower, vec![1.0; 200], decay[..110].to_vec()]).take_out(&mut by_short);
        for (a, b) in long.iter().chain(&by_long).zip(short.iter().chain(&by_short)) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }

    #[test]
    fn exact_what_lies_in_the_space_is_taken_out_with_its_combination() {
        let ramp: Vec<f64> = (0..9).map(f64::from).collect();
        let mut x: Vec<f64> = ramp.iter().map(|r| 2.0 * r - 5.0).collect();
        let found = Basis::new(vec![vec![1.0; 9], ramp]).take_out(&mut x);
        assert!((found[0] + 5.0).abs() < 1e-12 && (found[1] - 2.0).abs() < 1e-12, "{found:?}");
        assert!(norm(&x) < 1e-12);
    }
}
