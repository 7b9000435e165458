//! Friction of dynamometers that could be the one at hand.

use bench_model::friction::{Beside, DynoFriction};
use numerics::null::nan_if_null;
use numerics::random::Stream;
use rig::BenchFile;
use rig::dyno_friction::{DOUBT_PERCENT, EstimatedFriction, ExpectedFriction, MOST_COULOMB, MOST_SLOPE_S_PER_RAD};
use serde::{Deserialize, Serialize};
use signal::distributions::normal_quantile;

/// Whence friction is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum FrictionFrom {
    /// The bench file.
    Stated,
    /// Run-outs, joined with what is stated or assumed.
    Estimated,
    /// Dynamometers in general, for all or a part of it.
    Assumed,
}

/// How friction differs between the benches drawn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FrictionSpread {
    /// Whence it is known.
    pub from: FrictionFrom,
    /// Coulomb friction at the least and at the most, Nm; of estimates the 95 % range.
    #[serde(deserialize_with = "nan_if_null")]
    pub coulomb_nm: (f64, f64),
    /// Slope over speed at the least and at the most, Nm s/rad; of estimates the 95 % range.
    #[serde(deserialize_with = "nan_if_null")]
    pub viscous_nm_s_per_rad: (f64, f64),
    /// The mean of the benches drawn; the middle between the least and the most where it is none.
    #[serde(default)]
    pub mean: Option<DynoFriction>,
    /// Both parts with their covariance where run-outs show them.
    #[serde(default)]
    pub run_outs: Option<ExpectedFriction>,
}

impl FrictionSpread {
    /// No friction.
    pub const NONE: FrictionSpread = FrictionSpread {
        from: FrictionFrom::Stated,
        coulomb_nm: (0.0, 0.0),
        viscous_nm_s_per_rad: (0.0, 0.0),
        mean: None,
        run_outs: None,
    };

    /// Spread that a bench file states; else the one that run-outs show; else the one that a dynamometer with this
    /// torque limit can have.
    #[must_use]
    pub fn of(bench: &BenchFile, torque_limit_nm: f64, estimated: Option<&EstimatedFriction>) -> Self {
        if let Some(estimated) = EstimatedFriction::unless_stated(estimated, bench) {
            return Self::of_run_outs(ExpectedFriction::of(bench, torque_limit_nm, Some(estimated)));
        }
        let percent = bench.dynamometer_friction_uncertainty_percent.unwrap_or(DOUBT_PERCENT);
        let (slope, coulomb) = (bench.dynamometer_friction_nm_s_per_rad, bench.dynamometer_coulomb_friction_nm);
        let coulomb_nm = stated_or_up_to(coulomb, percent, MOST_COULOMB * torque_limit_nm);
        let slope_nm_s_per_rad = stated_or_up_to(slope, percent, MOST_SLOPE_S_PER_RAD * torque_limit_nm);
        FrictionSpread {
            from: if slope.and(coulomb).is_some() { FrictionFrom::Stated } else { FrictionFrom::Assumed },
            coulomb_nm: (coulomb_nm.low, coulomb_nm.high),
            viscous_nm_s_per_rad: (slope_nm_s_per_rad.low, slope_nm_s_per_rad.high),
            mean: Some(line([coulomb_nm.mean, slope_nm_s_per_rad.mean])),
            run_outs: None,
        }
    }

    fn of_run_outs(expected: ExpectedFriction) -> Self {
        let about = |i: usize| {
            let (mean, reach) = (expected.parts[i], normal_quantile(0.975) * expected.covariance[i][i].sqrt());
            (mean - reach, mean + reach)
        };
        FrictionSpread {
            from: FrictionFrom::Estimated,
            coulomb_nm: about(0),
            viscous_nm_s_per_rad: about(1),
            mean: Some(line(expected.parts)),
            run_outs: Some(expected),
        }
    }

    /// The middle of what it can be: what is stated, where it is.
    #[must_use]
    pub fn middle(&self) -> DynoFriction {
        let middle = |(low, high): (f64, f64)| 0.5 * (low + high);
        self.mean.unwrap_or_else(|| line([middle(self.coulomb_nm), middle(self.viscous_nm_s_per_rad)]))
    }

    /// The friction of a bench.
    #[must_use]
    pub fn draw(&self, random: &mut Stream) -> DynoFriction {
        if let Some(expected) = &self.run_outs {
            return drawn(expected, random);
        }
        let mean = self.middle();
        let about = |(low, high): (f64, f64), mean: f64| Uneven { low, mean, high };
        let coulomb_nm = about(self.coulomb_nm, mean.coulomb_nm).at(random.uniform());
        let slope = about(self.viscous_nm_s_per_rad, mean.viscous_nm_s_per_rad);
        line([coulomb_nm, slope.at(random.uniform())])
    }
}

/// Friction by both parts alone.
fn line([coulomb_nm, viscous_nm_s_per_rad]: [f64; 2]) -> DynoFriction {
    DynoFriction { coulomb_nm, viscous_nm_s_per_rad, beside: None }
}

/// A draw of both parts by their covariance. None is cut off at zero: that would raise the mean at speeds where the sum
/// is well known. The sum is never below zero, see [`DynoFriction`].
fn drawn(expected: &ExpectedFriction, random: &mut Stream) -> DynoFriction {
    let [[coulomb, both], [_, slope]] = expected.covariance;
    let root = coulomb.sqrt();
    let shared = if root > 0.0 { both / root } else { 0.0 };
    let own = (slope - shared * shared).max(0.0).sqrt();
    let (of_coulomb, of_slope) = (random.normal(), random.normal());
    let reach = 3.0_f64.sqrt();
    let deviations = random.between(-reach, reach);
    DynoFriction {
        coulomb_nm: expected.parts[0] + root * of_coulomb,
        viscous_nm_s_per_rad: expected.parts[1] + shared * of_coulomb + own * of_slope,
        beside: expected.unseen.map(|unseen| Beside { unseen, deviations }),
    }
}

/// A value that is spread evenly below its mean, and evenly above it, with the probabilities that make the mean one. No
/// value is more probable than another one where the mean is in the middle.
#[derive(Debug, Clone, Copy)]
struct Uneven {
    low: f64,
    mean: f64,
    high: f64,
}

impl Uneven {
    /// The value that a share of all lie below.
    fn at(self, share: f64) -> f64 {
        let Uneven { low, mean, high } = self;
        let below = if high > low { (high - mean) / (high - low) } else { 0.5 };
        match share < below {
            true => low + (mean - low) * share / below,
            false => mean + (high - mean) * (share - below) / (1.0 - below),
        }
    }
}

/// The stated value with a standard uncertainty in per cent of it, and never below nothing; or anything up to the most.
///
/// Below and above the mean μ by at most a and b, evenly, the variance is a b/3. So a = b = √3 σ, where that is no more
/// than μ, and else a = μ and b = 3 σ²/μ.
fn stated_or_up_to(stated: Option<f64>, percent: f64, most: f64) -> Uneven {
    let Some(mean) = stated else { return Uneven { low: 0.0, mean: 0.5 * most, high: most } };
    let reach = 3.0_f64.sqrt() * percent / 100.0;
    let below = reach.min(1.0);
    let above = if reach > 1.0 { reach * reach } else { reach };
    Uneven { low: mean * (1.0 - below), mean, high: mean * (1.0 + above) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_stated_friction_keeps_its_mean_and_its_uncertainty() {
        for percent in [5.0, 50.0, 58.0, 80.0, 150.0] {
            let spread = stated_or_up_to(Some(2.0), percent, 40.0);
            let shares: Vec<f64> = (0..100_000).map(|n| (f64::from(n) + 0.5) / 1e5).collect();
            let values: Vec<f64> = shares.iter().map(|share| spread.at(*share)).collect();
            let mean = values.iter().sum::<f64>() / 1e5;
            let deviation = (values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / 1e5).sqrt();
            assert!((mean - 2.0).abs() < 1e-4, "{percent} %: {mean}");
            assert!((deviation / (0.02 * percent) - 1.0).abs() < 1e-4, "{percent} %: {deviation}");
            assert!(values.iter().all(|value| *value >= 0.0));
        }
        let assumed = stated_or_up_to(None, 0.0, 40.0);
        assert_eq!([0.0, 0.25, 0.5, 1.0].map(|share| assumed.at(share)), [0.0, 10.0, 20.0, 40.0]);
        let exactly = stated_or_up_to(Some(2.0), 0.0, 40.0);
        assert_eq!([0.0, 0.7, 1.0].map(|share| exactly.at(share)), [2.0; 3]);
    }
}
