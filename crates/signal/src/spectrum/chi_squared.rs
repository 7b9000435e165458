//! Quantiles of χ², for intervals of spectral densities.

/// The quantile of χ² with `freedom` degrees (positive) at `probability` (between 0 and 1), to about 1e-12 relative.
///
/// Doubling and halving bracket it and bisection in the logarithm finishes, which cannot fail.
pub(crate) fn chi_squared_quantile(probability: f64, freedom: f64) -> f64 {
    let cdf = |x: f64| lower_gamma_ratio(0.5 * freedom, 0.5 * x);
    let (mut low, mut high) = (freedom, freedom);
    while cdf(low) > probability && low > f64::MIN_POSITIVE {
        low *= 0.5;
    }
    while cdf(high) < probability && high < f64::MAX / 2.0 {
        high *= 2.0;
    }
    while high / low > 1.0 + 1e-13 {
        let middle = (low * high).sqrt();
        if middle <= low || middle >= high {
            break;
        }
        if cdf(middle) < probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    high
}

/// `P(a, x) = γ(a, x)/Γ(a)`: series below `a + 1`, Lentz's continued fraction above.
///
/// # Source
/// Abramowitz and Stegun, 6.5.29 and 6.5.31.
fn lower_gamma_ratio(a: f64, x: f64) -> f64 {
    let front = (a * x.ln() - x - ln_gamma(a)).exp();
    if x < a + 1.0 {
        let (mut term, mut sum, mut k) = (1.0 / a, 1.0 / a, a);
        while term > 1e-17 * sum {
            k += 1.0;
            term *= x / k;
            sum += term;
        }
        return front * sum;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1e300, 1.0 / b);
    let mut fraction = d;
    for i in 1..100_000 {
        let an = -f64::from(i) * (f64::from(i) - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        fraction *= c * d;
        if (c * d - 1.0).abs() < 1e-16 {
            break;
        }
    }
    1.0 - front * fraction
}

/// Stirling's series after raising the argument above 10.
fn ln_gamma(x: f64) -> f64 {
    let (mut shift, mut z) = (0.0, x);
    while z < 10.0 {
        shift += z.ln();
        z += 1.0;
    }
    let r = 1.0 / (z * z);
    let series = (1.0 / 12.0 - r * (1.0 / 360.0 - r * (1.0 / 1260.0 - r * (1.0 / 1680.0 - r / 1188.0)))) / z;
    (z - 0.5) * z.ln() - z + 0.5 * std::f64::consts::TAU.ln() + series - shift
}

#[cfg(test)]
mod tests {
    /// SciPy 1.17: `chi2.ppf(p, nu)`.
    #[test]
    fn ref_quantiles() {
        let cases = [
            (0.025, 1.0, 0.0009820691171752555),
            (0.975, 1.0, 5.023886187314888),
            (0.025, 2.0, 0.05063561596857975),
            (0.975, 2.0, 7.377758908227871),
            (0.005, 37.3, 18.796328107425605),
            (0.995, 37.3, 63.2731793264587),
            (0.025, 2400.0, 2266.113830823127),
            (0.999, 200000.0, 201960.13558391845),
        ];
        for (p, freedom, expected) in cases {
            let got = super::chi_squared_quantile(p, freedom);
            assert!((got / expected - 1.0).abs() < 1e-10, "{got} {expected}");
        }
    }
}
