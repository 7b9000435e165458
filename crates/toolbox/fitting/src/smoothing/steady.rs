//! Covariances settle: once a matrix is again what it was some samples before, with the same outputs measured, all that
//! is made of it is known. An output that is read at every second sample alone makes it come back every second sample.

/// Samples whose covariances are remembered.
const REMEMBERED: usize = 8;
/// How near a matrix must come, in parts of its diagonal: far below what changes a digit that anyone reads.
const SAME: f64 = 1e-11;

/// Result from a matrix under a condition.
struct Step<C, R> {
    condition: C,
    matrix: Vec<f64>,
    result: R,
}

/// The last steps. What a step makes is the matrix of the step after it, so that each step need be looked for once.
pub(super) struct Memory<C, R> {
    steps: Vec<Step<C, R>>,
    oldest: usize,
    /// How many steps were remembered.
    remembered: usize,
    /// The step that was last recalled.
    last: Option<usize>,
    /// Of each step the one that followed it, and how many were remembered then.
    followers: [Option<(usize, usize)>; REMEMBERED],
}

impl<C: PartialEq, R> Memory<C, R> {
    pub(super) fn new() -> Self {
        Memory {
            steps: Vec::with_capacity(REMEMBERED),
            oldest: 0,
            remembered: 0,
            last: None,
            followers: [None; REMEMBERED],
        }
    }

    /// Result from this matrix under this condition: as it was before, or else by `make`. The matrix is the one that
    /// the step before it made.
    ///
    /// # Errors
    /// Those of `make`.
    pub(super) fn step<E>(
        &mut self,
        condition: &C,
        matrix: &[f64],
        make: impl FnOnce() -> Result<R, E>,
    ) -> Result<&R, E>
    where
        C: Clone,
    {
        let followed = self
            .last
            .and_then(|last| self.followers[last])
            .filter(|(remembered, place)| *remembered == self.remembered && self.steps[*place].condition == *condition);
        let place = match followed {
            Some((_, place)) => place,
            None => {
                let same = |step: &Step<C, R>| step.condition == *condition && is_same(&step.matrix, matrix);
                match self.steps.iter().position(same) {
                    Some(place) => {
                        if let Some(last) = self.last {
                            self.followers[last] = Some((self.remembered, place));
                        }
                        place
                    }
                    None => self.remember(condition.clone(), matrix.to_vec(), make()?),
                }
            }
        };
        self.last = Some(place);
        Ok(&self.steps[place].result)
    }

    /// Remembers a step, and where.
    fn remember(&mut self, condition: C, matrix: Vec<f64>, result: R) -> usize {
        let step = Step { condition, matrix, result };
        self.remembered += 1;
        if self.steps.len() < REMEMBERED {
            self.steps.push(step);
            return self.steps.len() - 1;
        }
        let place = self.oldest;
        self.steps[place] = step;
        self.oldest = (self.oldest + 1) % REMEMBERED;
        place
    }
}

/// Returns true if two symmetric matrices, by rows, are the same.
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
