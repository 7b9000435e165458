//! [`ArxOrders`]: how many coefficients every polynomial of an ARX model has.

use crate::data::regression::Lagged;
use crate::{Dataset, IdentError};
use fitting::StructureError;

/// Orders and delays of an ARX model: `na[i][j]` coefficients of output `j` in equation `i`, `nb[i][k]` of input `k`,
/// the first of them `nk[i][k]` samples back.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ArxOrders {
    /// One row an output, one column an output.
    pub na: Vec<Vec<usize>>,
    /// One row an output, one column an input.
    pub nb: Vec<Vec<usize>>,
    /// One row an output, one column an input. Of no consequence where `nb` is zero.
    pub nk: Vec<Vec<usize>>,
}

impl ArxOrders {
    /// One input, one output.
    #[must_use]
    pub fn siso(na: usize, nb: usize, nk: usize) -> Self {
        Self::miso(na, &[nb], &[nk])
    }

    /// One output, one value of `nb` and `nk` an input; none for a time series.
    #[must_use]
    pub fn miso(na: usize, nb: &[usize], nk: &[usize]) -> Self {
        ArxOrders { na: vec![vec![na]], nb: vec![nb.to_vec()], nk: vec![nk.to_vec()] }
    }

    /// The same three numbers everywhere: every output depends on every output and every input.
    #[must_use]
    pub fn uniform(outputs: usize, inputs: usize, na: usize, nb: usize, nk: usize) -> Self {
        let all = |columns: usize, value: usize| vec![vec![value; columns]; outputs];
        ArxOrders { na: all(outputs, na), nb: all(inputs, nb), nk: all(inputs, nk) }
    }

    /// Refuses orders that are not made for these data.
    pub(crate) fn check(&self, data: &Dataset) -> Result<(), IdentError> {
        let (outputs, inputs) = (data.outputs(), data.inputs());
        let tables =
            [("rows of na", outputs, &self.na), ("rows of nb", inputs, &self.nb), ("rows of nk", inputs, &self.nk)];
        for (what, columns, table) in tables {
            check_length(what, outputs, table.len())?;
            table.iter().try_for_each(|row| check_length("orders of an equation", columns, row.len()))?;
        }
        let reach = self.na.iter().chain(&self.nb).chain(&self.nk).flatten().copied().max().unwrap_or(0);
        if reach >= data.samples() {
            return Err(IdentError::TooFewSamples { samples: data.samples(), parameters: reach });
        }
        if self.parameters() == 0 {
            return Err(StructureError::NoParameters.into());
        }
        Ok(())
    }

    /// Number of coefficients.
    #[must_use]
    pub fn parameters(&self) -> usize {
        self.na.iter().chain(&self.nb).flatten().sum()
    }

    /// The regressors of one equation in the order of its coefficients; signals are outputs, then inputs.
    pub(crate) fn regressors(&self, equation: usize) -> Vec<Lagged> {
        let outputs = self.na.len();
        let own = self.na[equation].iter().enumerate().map(|(j, count)| (j, 1, *count));
        let driving = self.nb[equation].iter().zip(&self.nk[equation]).enumerate();
        let driving = driving.map(|(k, (count, delay))| (outputs + k, *delay, *count));
        own.chain(driving)
            .flat_map(|(signal, first, count)| Lagged::each(signal, first as isize..(first + count) as isize))
            .collect()
    }
}

fn check_length(what: &'static str, expected: usize, found: usize) -> Result<(), IdentError> {
    if expected == found { Ok(()) } else { Err(IdentError::Length { what, expected, found }) }
}
