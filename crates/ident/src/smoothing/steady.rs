//! Covariances settle: once a matrix is again what it was some samples before, with the same outputs measured, all that is made
//! of it is known. An output that is read at every second sample alone makes it come back every second sample.

/// Samples whose covariances are remembered.
const REMEMBERED: usize = 8;
/// How near a matrix must come, in parts of its diagonal: far below what changes a digit that anyone reads.
const SAME: f64 = 1e-11;

/// What was made of a matrix under a condition.
pub(super) struct Step<C, R> {
    condition: C,
    matrix: Vec<f64>,
    pub(super) result: R,
}

/// The last steps.
pub(super) struct Memory<C, R> {
    steps: Vec<Step<C, R>>,
    oldest: usize,
}

impl<C: PartialEq, R> Memory<C, R> {
    pub(super) fn new() -> Self {
        Memory { steps: Vec::with_capacity(REMEMBERED), oldest: 0 }
    }

    /// What was made of this matrix under this condition before.
    pub(super) fn recall(&self, condition: &C, matrix: &[f64]) -> Option<&R> {
        let same = |step: &&Step<C, R>| step.condition == *condition && is_same(&step.matrix, matrix);
        self.steps.iter().find(same).map(|step| &step.result)
    }

    pub(super) fn remember(&mut self, condition: C, matrix: Vec<f64>, result: R) {
        let step = Step { condition, matrix, result };
        if self.steps.len() < REMEMBERED {
            self.steps.push(step);
        } else {
            self.steps[self.oldest] = step;
            self.oldest = (self.oldest + 1) % REMEMBERED;
        }
    }
}

/// Whether two symmetric matrices, by rows, are one.
fn is_same(a: &[f64], b: &[f64]) -> bool {
    let n = (a.len() as f64).sqrt().round() as usize;
    (0..n).all(|i| {
        let near = |j: usize| {
            let (x, y) = (a[i * n + j], b[i * n + j]);
            (x - y).powi(2) <= SAME * SAME * (a[i * n + i] * a[j * n + j]).abs()
        };
        (0..=i).all(near)
    })
}
