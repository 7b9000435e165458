//! Orthonormal bases of what is fitted along with the parameters but not asked for: initial states and offsets.

use numerics::vector::{add_scaled, dot, norm};

/// A column that loses all but this part of its length to the columns before it says nothing new.
const DEPENDENT: f64 = 1e-10;

/// An orthonormal basis of a few tall columns, and how the columns are combined from it.
#[derive(Debug, Clone, Default)]
pub(crate) struct Basis {
    columns: Vec<Vec<f64>>,
    /// For each column of the basis, its combination of the columns given.
    combinations: Vec<Vec<f64>>,
}

impl Basis {
    /// By Gram and Schmidt, twice over; dependent columns are left out.
    pub(crate) fn new(given: Vec<Vec<f64>>) -> Self {
        let count = given.len();
        let mut basis = Basis::default();
        for (index, mut column) in given.into_iter().enumerate() {
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
