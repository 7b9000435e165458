//! The innovations form laid out for a loop over time.

use faer::MatRef;
use lti::Innovations;

/// A matrix by rows, without its zeros: the forms of polynomial models have two or three entries a row.
#[derive(Debug, Clone)]
pub(crate) struct Rows {
    starts: Vec<usize>,
    entries: Vec<(u32, f64)>,
}

impl Rows {
    /// The matrices side by side.
    fn new(parts: &[MatRef<'_, f64>], rows: usize) -> Self {
        let (mut starts, mut entries) = (vec![0], Vec::new());
        for i in 0..rows {
            let mut offset = 0;
            for part in parts {
                let row = (0..part.ncols()).map(|j| ((offset + j) as u32, part[(i, j)]));
                entries.extend(row.filter(|(_, value)| *value != 0.0));
                offset += part.ncols();
            }
            starts.push(entries.len());
        }
        Rows { starts, entries }
    }

    /// `out = M x`, with as many rows of it as `out` has.
    pub(crate) fn product(&self, x: &[f64], out: &mut [f64]) {
        for (span, slot) in self.starts.windows(2).zip(out) {
            *slot = self.entries[span[0]..span[1]].iter().map(|(j, value)| value * x[*j as usize]).sum();
        }
    }

    fn is_zero(&self) -> bool {
        self.entries.is_empty()
    }
}

/// A model in innovations form: `[A B]` and `[C D]` act on `[x; u]`, `K` on `e`.
#[derive(Debug, Clone)]
pub(crate) struct Form {
    pub(crate) states: usize,
    pub(crate) inputs: usize,
    pub(crate) outputs: usize,
    pub(crate) transition: Rows,
    pub(crate) output: Rows,
    pub(crate) gain: Rows,
    pub(crate) model: Innovations,
}

impl Form {
    pub(crate) fn new(model: Innovations) -> Self {
        let system = model.system();
        let (states, outputs) = (system.states(), system.outputs());
        Form {
            states,
            inputs: system.inputs(),
            outputs,
            transition: Rows::new(&[system.a(), system.b()], states),
            output: Rows::new(&[system.c(), system.d()], outputs),
            gain: Rows::new(&[model.k()], states),
            model,
        }
    }

    /// Returns true if the noise is on the outputs alone, so that measurements say nothing about the state.
    pub(crate) fn is_output_error(&self) -> bool {
        self.gain.is_zero()
    }
}
