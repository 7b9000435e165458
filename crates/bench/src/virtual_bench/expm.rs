//! Matrix exponential of the small matrices met here.

/// A square matrix by rows.
pub(super) type Matrix<const N: usize> = [[f64; N]; N];

/// Terms of the Taylor series after scaling to a norm below 1/2: the remainder is below 2⁻¹⁸/18! < 10⁻²¹.
const TAYLOR_TERMS: usize = 18;

/// e^A by scaling and squaring of the Taylor series.
///
/// # Source
///
/// Moler & Van Loan, SIAM Review 45 (2003) 3, method 3.
pub(super) fn expm<const N: usize>(a: &Matrix<N>) -> Matrix<N> {
    let norm = a.iter().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max);
    let squarings = if norm > 0.5 { (norm / 0.5).log2().ceil().min(60.0) as i32 } else { 0 };
    let scaled = a.map(|row| row.map(|x| x * 2f64.powi(-squarings)));
    let mut sum = identity::<N>();
    for term in (1..=TAYLOR_TERMS).rev() {
        sum = product(&scaled, &sum).map(|row| row.map(|x| x / term as f64));
        for i in 0..N {
            sum[i][i] += 1.0;
        }
    }
    for _ in 0..squarings {
        sum = product(&sum, &sum);
    }
    sum
}

fn identity<const N: usize>() -> Matrix<N> {
    let mut unit = [[0.0; N]; N];
    for i in 0..N {
        unit[i][i] = 1.0;
    }
    unit
}

fn product<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    let mut c = [[0.0; N]; N];
    for i in 0..N {
        for k in 0..N {
            for j in 0..N {
                c[i][j] += a[i][k] * b[k][j];
            }
        }
    }
    c
}
