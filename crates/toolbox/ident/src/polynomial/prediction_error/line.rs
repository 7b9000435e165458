//! Signals that run through the equation a block at a time, and the filters between them.

/// Rows in a block: few enough that all signals of an equation stay in the cache.
pub(super) const BLOCK: usize = 1024;

/// A block of a signal, preceded by as many earlier samples as the equation reaches back.
#[derive(Debug, Clone)]
pub(super) struct Line {
    values: Vec<f64>,
    memory: usize,
}

impl Line {
    /// A signal that has been zero so far.
    pub(super) fn new(memory: usize) -> Self {
        Line { values: vec![0.0; memory + BLOCK], memory }
    }

    /// Forgets the past.
    pub(super) fn clear(&mut self) {
        self.values.fill(0.0);
    }

    /// The block itself.
    pub(super) fn now(&self, rows: usize) -> &[f64] {
        self.lag(0, rows)
    }

    /// The block, to be changed.
    pub(super) fn now_mut(&mut self, rows: usize) -> &mut [f64] {
        &mut self.values[self.memory..self.memory + rows]
    }

    /// The block `lag` samples earlier.
    pub(super) fn lag(&self, lag: usize, rows: usize) -> &[f64] {
        &self.values[self.memory - lag..self.memory - lag + rows]
    }

    /// Values before the block.
    pub(super) fn past(&self) -> &[f64] {
        &self.values[..self.memory]
    }

    /// Makes the block of `rows` rows past, before the next.
    pub(super) fn advance(&mut self, rows: usize) {
        self.values.copy_within(rows..rows + self.memory, 0);
    }

    /// The block becomes `Σ_j num_j q^−(delay+j)` of `source`.
    pub(super) fn weigh(&mut self, source: &Line, num: &[f64], delay: usize, rows: usize) {
        self.now_mut(rows).fill(0.0);
        self.add_weighed(source, num, delay, rows);
    }

    /// Adds `Σ_j num_j q^−(delay+j)` of `source` to the block.
    pub(super) fn add_weighed(&mut self, source: &Line, num: &[f64], delay: usize, rows: usize) {
        for (j, c) in num.iter().enumerate() {
            let block = self.values[self.memory..self.memory + rows].iter_mut();
            block.zip(source.lag(delay + j, rows)).for_each(|(v, s)| *v += c * s);
        }
    }

    /// The block becomes `source · (1 + num₁ q⁻¹ + …)/(1 + den₁ q⁻¹ + …)`.
    pub(super) fn run_through(&mut self, source: &Line, num: &[f64], den: &[f64], rows: usize) {
        self.now_mut(rows).copy_from_slice(source.now(rows));
        self.add_weighed(source, num, 1, rows);
        self.recur(den, rows);
    }

    /// Divides the block by `1 + den₁ q⁻¹ + …`, going on from the past of the line.
    pub(super) fn recur(&mut self, den: &[f64], rows: usize) {
        divide(den, &mut self.values[self.memory - den.len()..self.memory + rows]);
    }
}

/// Divides a signal by `1 + den₁ q⁻¹ + …`; its first values, as many as the coefficients, are the past.
pub(super) fn divide(den: &[f64], signal: &mut [f64]) {
    match den.len() {
        0 => {}
        1 => recur_fixed::<1>(den, signal),
        2 => recur_fixed::<2>(den, signal),
        3 => recur_fixed::<3>(den, signal),
        4 => recur_fixed::<4>(den, signal),
        5 => recur_fixed::<5>(den, signal),
        6 => recur_fixed::<6>(den, signal),
        7 => recur_fixed::<7>(den, signal),
        8 => recur_fixed::<8>(den, signal),
        9 => recur_fixed::<9>(den, signal),
        10 => recur_fixed::<10>(den, signal),
        order => {
            for t in order..signal.len() {
                let past = signal[t - order..t].iter().rev();
                signal[t] -= den.iter().zip(past).map(|(c, v)| c * v).sum::<f64>();
            }
        }
    }
}

/// A recursion of known order, whose past stays in registers.
fn recur_fixed<const N: usize>(den: &[f64], block: &mut [f64]) {
    let den: [f64; N] = std::array::from_fn(|j| den[j]);
    let (past, rows) = block.split_at_mut(N);
    let mut latest: [f64; N] = std::array::from_fn(|j| past[N - 1 - j]);
    for row in rows {
        // The newest value last: only its product waits for the row before.
        let mut value = *row;
        for j in (0..N).rev() {
            value -= den[j] * latest[j];
        }
        for j in (1..N).rev() {
            latest[j] = latest[j - 1];
        }
        latest[0] = value;
        *row = value;
    }
}

/// Returns true if `1 + p₁ q⁻¹ + …` has all its roots within the circle of this radius, by the Schur–Cohn recursion.
///
/// # Source
/// Åström, *Introduction to Stochastic Control Theory*, 1970, ch. 5 (theorem 2.1).
pub(super) fn is_stable(p: &[f64], radius: f64) -> bool {
    let mut power = 1.0;
    let mut q: Vec<f64> = std::iter::once(1.0)
        .chain(p.iter().map(|c| {
            power *= radius;
            c / power
        }))
        .collect();
    while q.len() > 1 {
        let n = q.len() - 1;
        let reflection = q[n];
        if reflection.is_nan() || reflection.abs() >= 1.0 {
            return false;
        }
        let scale = 1.0 - reflection * reflection;
        q = (0..n).map(|j| (q[j] - reflection * q[n - j]) / scale).collect();
    }
    true
}

/// Where a root that lay on the unit circle is put.
const INNER: f64 = 1.0 - 1e-3;

/// `1 + p₁ q⁻¹ + …` with the roots outside the unit circle mirrored into it, where one lies beyond `radius`.
pub(super) fn stabilised(p: &[f64], radius: f64) -> Vec<f64> {
    if is_stable(p, radius) {
        return p.to_vec();
    }
    let full: Vec<f64> = std::iter::once(1.0).chain(p.iter().copied()).collect();
    let Ok(roots) = lti::polynomial::roots(&full) else {
        return vec![0.0; p.len()];
    };
    let inside = roots.iter().map(|r| {
        let size = r.norm();
        if size >= 1.0 { r * ((1.0 / size).min(INNER) / size) } else { *r }
    });
    lti::polynomial::from_roots(&inside.collect::<Vec<_>>())[1..].to_vec()
}
