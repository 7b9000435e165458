//! The derivatives of an innovations form's predictions, an instant at a time.

use super::predictor::{Free, Predictor, add_product};

/// Below this an initial state's influence is nothing; it is cut off before it becomes a denormal number.
const FORGOTTEN: f64 = 1e-100;
/// Filtered signals are padded to a multiple of so many, which are then worked on in vector registers.
const LANES: usize = 4;

/// Adds the rows of a matrix, as long as `out`, with these weights; their length is a multiple of [`LANES`].
fn add_combined<'w>(weights: impl Iterator<Item = &'w f64> + Clone, rows: &[f64], out: &mut [f64]) {
    let length = out.len();
    for (at, slot) in (0..length).step_by(LANES).zip(out.chunks_exact_mut(LANES)) {
        let mut sums: [f64; LANES] = std::array::from_fn(|i| slot[i]);
        for (weight, row) in weights.clone().zip(rows[at..].chunks(length)) {
            if let Some(row) = row.first_chunk::<LANES>() {
                (0..LANES).for_each(|i| sums[i] += weight * row[i]);
            }
        }
        slot.copy_from_slice(&sums);
    }
}

/// The derivatives of ŷ at one instant. A change of A, B or K acts like a scalar signal (a state, an input, an error)
/// into one state of the predictor; the way from every state to an output is one filter in transposed form, so that
/// each signal is filtered once an output, not once an entry.
pub(super) struct Derivatives<'a> {
    of: &'a Predictor,
    free: Free,
    initial: usize,
    /// Which of x̂, u, ε are filtered, and zeros up to a multiple of [`LANES`].
    signals: Vec<f64>,
    /// For each output, states × signals by rows.
    filtered: Vec<Vec<f64>>,
    next: Vec<f64>,
    /// For each output, `Kᵀ` of what is filtered, outputs × signals by rows.
    through: Vec<Vec<f64>>,
    /// For each output, `C_i (A − K C)^t`.
    decaying: Vec<Vec<f64>>,
    next_decaying: Vec<f64>,
}

impl<'a> Derivatives<'a> {
    pub(super) fn new(of: &'a Predictor, free: Free, initial: usize) -> Self {
        let used = of.m + if free.dynamics { of.n } else { 0 } + if free.noise { of.p } else { 0 };
        let count = used.next_multiple_of(LANES);
        let decaying = (0..of.p).map(|i| of.c[i * of.n..(i + 1) * of.n].to_vec()).collect();
        Derivatives {
            of,
            free,
            initial,
            signals: vec![0.0; count],
            filtered: vec![vec![0.0; of.n * count]; of.p],
            next: vec![0.0; of.n * count],
            through: vec![vec![0.0; of.p * count]; of.p],
            decaying,
            next_decaying: vec![0.0; of.n],
        }
    }

    /// Index of the first state, input and error among the signals.
    fn places(&self) -> (usize, usize, usize) {
        let inputs = if self.free.dynamics { self.of.n } else { 0 };
        (0, inputs, inputs + self.of.m)
    }

    /// Writes the rows `[Ψ₀, Ψ, ε]` of all outputs.
    pub(super) fn write(&self, x: &[f64], u: &[f64], e: &[f64], rows: &mut [f64]) {
        let Predictor { n, m, p, .. } = *self.of;
        let width = rows.len() / p;
        let (state, input, error) = self.places();
        for (l, row) in rows.chunks_exact_mut(width).enumerate() {
            let z = &self.filtered[l];
            let mut slots = row.iter_mut();
            let count = self.signals.len();
            let decaying = &self.decaying[l][..self.initial];
            decaying.iter().zip(slots.by_ref()).for_each(|(v, slot)| *slot = *v);
            let mut block = |rows: usize, columns: usize, first: usize| {
                for r in 0..rows {
                    let from = &z[r * count + first..r * count + first + columns];
                    from.iter().zip(slots.by_ref()).for_each(|(v, slot)| *slot = *v);
                }
            };
            if self.free.dynamics {
                block(n, n, state);
            }
            block(n, m, input);
            // A change of C or D shows at its own output at once, and at all of them through ε and K.
            let through = |i: usize, signal: usize| self.through[l][i * count + signal];
            if self.free.dynamics {
                for (i, c) in (0..p).flat_map(|i| (0..n).map(move |c| (i, c))) {
                    let direct = if i == l { x[c] } else { 0.0 };
                    slots.by_ref().take(1).for_each(|slot| *slot = direct - through(i, state + c));
                }
            }
            if self.free.feedthrough {
                for (i, j) in (0..p).flat_map(|i| (0..m).map(move |j| (i, j))) {
                    let direct = if i == l { u[j] } else { 0.0 };
                    slots.by_ref().take(1).for_each(|slot| *slot = direct - through(i, input + j));
                }
            }
            if self.free.noise {
                for r in 0..n {
                    let from = &z[r * count + error..r * count + error + p];
                    from.iter().zip(slots.by_ref()).for_each(|(v, slot)| *slot = *v);
                }
            }
            row[width - 1] = e[l];
        }
    }

    pub(super) fn advance(&mut self, x: &[f64], u: &[f64], e: &[f64]) {
        let (n, count) = (self.of.n, self.signals.len());
        let (state, input, error) = self.places();
        if self.free.dynamics {
            self.signals[state..state + n].copy_from_slice(x);
        }
        self.signals[input..input + u.len()].copy_from_slice(u);
        if self.free.noise {
            self.signals[error..error + e.len()].copy_from_slice(e);
        }
        for l in 0..self.of.p {
            if count > 0 {
                let (z, next) = (&mut self.filtered[l], &mut self.next);
                for (r, out) in next.chunks_exact_mut(count).enumerate() {
                    let direct = self.of.c[l * n + r];
                    out.iter_mut().zip(&self.signals).for_each(|(o, s)| *o = direct * s);
                    add_combined(self.of.adjoint.iter().skip(r * n).take(n), z, out);
                }
                std::mem::swap(z, next);
                if self.free.dynamics || self.free.feedthrough {
                    for (i, out) in self.through[l].chunks_exact_mut(count).enumerate() {
                        out.fill(0.0);
                        add_combined(self.of.k.iter().skip(i).step_by(self.of.p), z, out);
                    }
                }
            }
            self.advance_decaying(l);
        }
    }

    fn advance_decaying(&mut self, l: usize) {
        let (now, next) = (&mut self.decaying[l], &mut self.next_decaying);
        if self.initial == 0 || now.iter().all(|v| *v == 0.0) {
            return;
        }
        next.fill(0.0);
        add_product(&self.of.adjoint, now, next);
        if next.iter().all(|v| v.abs() < FORGOTTEN) {
            next.fill(0.0);
        }
        std::mem::swap(now, next);
    }
}
