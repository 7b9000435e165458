//! The friction that a dynamometer has beside its air-gap torque: as its class has it, as run-outs show it, and as it
//! is expected from all that is known.

use serde::{Deserialize, Serialize};
use signal::distributions::normal_quantile;

use crate::bench_file::BenchFile;

/// Coulomb friction over the torque limit at the most. Bearings, seals and the fan of asynchronous machines have 0.2 …
/// 2 % of the torque limit at 300 rad/s; this and [`MOST_SLOPE_S_PER_RAD`] make 2 % there.
pub const MOST_COULOMB: f64 = 4e-3;
/// Slope of friction over speed, over the torque limit, at the most, s/rad.
pub const MOST_SLOPE_S_PER_RAD: f64 = 5e-5;
/// Standard uncertainty of friction on another day than that of its run-out unless that is stated, % of it: friction
/// changes with the temperature of the oil.
pub const DOUBT_PERCENT: f64 = 20.0;
/// Squared distance, over the covariance, beyond which an estimate and an assumption contradict each other: 99 % of χ²
/// with two degrees of freedom. The corners of the class are at 6.
const CONTRADICTION: f64 = 9.210_340_371_976_184;
/// Share of a product of variances below which a determinant is rounding.
const SINGULAR: f64 = 1e-12;

/// Half widths of its interval by which friction drives where it is none.
const DRIVES: f64 = 2.0;

type Covariance = [[f64; 2]; 2];

/// Friction that run-outs show, T_fric = c_0 sgn ω + c_1 ω.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EstimatedFriction {
    /// c_0, Nm.
    pub coulomb_nm: f64,
    /// c_1, Nm s/rad.
    pub viscous_nm_s_per_rad: f64,
    /// Covariance of both on the day of the run-outs, in Nm and Nm s/rad.
    pub covariance: [[f64; 2]; 2],
    /// Lowest and highest speed of the run-outs, whatever the direction, rad/s.
    pub speeds_rad_s: (f64, f64),
    /// The recordings that show it.
    pub recordings: Vec<String>,
}

impl EstimatedFriction {
    /// The estimate, unless a bench file states both parts.
    #[must_use]
    pub fn unless_stated<'a>(estimated: Option<&'a Self>, bench: &BenchFile) -> Option<&'a Self> {
        let stated = bench.dynamometer_friction_nm_s_per_rad.and(bench.dynamometer_coulomb_friction_nm);
        estimated.filter(|_| stated.is_none())
    }

    /// T_fric at a speed above zero, Nm.
    #[must_use]
    pub fn torque_nm(&self, speed_rad_s: f64) -> f64 {
        self.coulomb_nm + self.viscous_nm_s_per_rad * speed_rad_s
    }

    /// Half of the 95 % interval of [`Self::torque_nm`] on the day of the run-outs, at their speeds, Nm.
    #[must_use]
    pub fn half_width_nm(&self, speed_rad_s: f64) -> f64 {
        normal_quantile(0.975) * deviation_nm(&self.covariance, speed_rad_s)
    }

    /// Tells whether it drives at the lowest or the highest speed seen, by more than two half widths of its interval.
    /// Then it is no friction.
    #[must_use]
    pub fn drives(&self) -> bool {
        let (low, high) = self.speeds_rad_s;
        [low, high].into_iter().any(|speed| self.torque_nm(speed) < -DRIVES * self.half_width_nm(speed))
    }

    /// The covariance that another day adds, when both parts differ by the same share of themselves, whose standard
    /// deviation is the one that the bench file states, or [`DOUBT_PERCENT`].
    ///
    /// # Example
    /// ```
    /// # use rig::dyno_friction::EstimatedFriction;
    /// let friction = EstimatedFriction {
    ///     coulomb_nm: 2.0, viscous_nm_s_per_rad: 0.01, covariance: [[0.09, 0.0], [0.0, 0.0]],
    ///     speeds_rad_s: (10.0, 300.0), recordings: Vec::new(),
    /// };
    /// assert!((friction.covariance_of_another_day(Some(20.0))[0][0] - 0.16).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn covariance_of_another_day(&self, uncertainty_percent: Option<f64>) -> [[f64; 2]; 2] {
        let share = uncertainty_percent.unwrap_or(DOUBT_PERCENT) / 100.0;
        let parts = [self.coulomb_nm, self.viscous_nm_s_per_rad].map(|part| share * part);
        matrix(|i, j| parts[i] * parts[j])
    }
}

/// Friction that is expected on any day: c_0 and c_1 with their covariance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExpectedFriction {
    /// c_0, Nm, and c_1, Nm s/rad.
    pub parts: [f64; 2],
    /// Their covariance.
    pub covariance: [[f64; 2]; 2],
    /// Doubt beyond the speeds of run-outs; none where friction does not rest on any.
    pub unseen: Option<Unseen>,
}

impl ExpectedFriction {
    /// Friction as a bench file states it; a part that it does not state is anywhere between none and the most that a
    /// dynamometer with this torque limit has. What run-outs show is joined with that, each weighted by its precision,
    /// unless both parts are stated. The share of the run-outs has the doubt of another day.
    ///
    /// So a poor run-out leaves the assumption as it was, and a good one replaces it. An estimate that contradicts the
    /// assumption counts alone.
    ///
    /// # Source
    /// Gelman et al. 2013, §3.5: the mean and the variance of a normal prior with a normal observation.
    #[must_use]
    pub fn of(bench: &BenchFile, torque_limit_nm: f64, estimated: Option<&EstimatedFriction>) -> Self {
        let percent = bench.dynamometer_friction_uncertainty_percent;
        let about = |mean: f64| (mean, mean * percent.unwrap_or(DOUBT_PERCENT) / 100.0);
        let class = |most: f64| (0.5 * most, most / 12.0_f64.sqrt());
        let (coulomb, slope) = (bench.dynamometer_coulomb_friction_nm, bench.dynamometer_friction_nm_s_per_rad);
        let coulomb = coulomb.map_or_else(|| class(MOST_COULOMB * torque_limit_nm), about);
        let slope = slope.map_or_else(|| class(MOST_SLOPE_S_PER_RAD * torque_limit_nm), about);
        let covariance = [[coulomb.1.powi(2), 0.0], [0.0, slope.1.powi(2)]];
        let assumed = ExpectedFriction { parts: [coulomb.0, slope.0], covariance, unseen: None };
        EstimatedFriction::unless_stated(estimated, bench).map_or(assumed, |one| assumed.joined_with(one, percent))
    }

    fn joined_with(self, estimated: &EstimatedFriction, percent: Option<f64>) -> Self {
        let (own, of_day) = (&estimated.covariance, estimated.covariance_of_another_day(percent));
        let parts = [estimated.coulomb_nm, estimated.viscous_nm_s_per_rad];
        let apart = [parts[0] - self.parts[0], parts[1] - self.parts[1]];
        let Some(weights) = inverse(&matrix(|i, j| self.covariance[i][j] + own[i][j])) else { return self };
        let distance: f64 = (0..2).map(|i| apart[i] * (weights[i][0] * apart[0] + weights[i][1] * apart[1])).sum();
        if distance > CONTRADICTION {
            let covariance = sum(own, &of_day);
            let alone = ExpectedFriction { parts, covariance, unseen: None };
            return alone.seen_within(estimated.speeds_rad_s, None);
        }
        let gain = product(&self.covariance, &weights);
        let carried = product(&product(&gain, &of_day), &matrix(|i, j| gain[j][i]));
        let both = sum(&product(&gain, own), &carried);
        let joined = ExpectedFriction {
            parts: std::array::from_fn(|i| self.parts[i] + gain[i][0] * apart[0] + gain[i][1] * apart[1]),
            covariance: matrix(|i, j| 0.5 * (both[i][j] + both[j][i])),
            unseen: None,
        };
        let learnt = matrix(|i, j| self.covariance[i][j] - joined.covariance[i][j]);
        joined.seen_within(estimated.speeds_rad_s, Some(learnt))
    }

    fn seen_within(self, speeds_rad_s: (f64, f64), learnt: Option<Covariance>) -> Self {
        let torques_nm = (self.mean_nm(speeds_rad_s.0), self.mean_nm(speeds_rad_s.1));
        ExpectedFriction { unseen: Some(Unseen { speeds_rad_s, torques_nm, learnt }), ..self }
    }

    /// The mean at a speed, whatever its direction, Nm. Friction does not drive.
    #[must_use]
    pub fn mean_nm(&self, speed_rad_s: f64) -> f64 {
        (self.parts[0] + self.parts[1] * speed_rad_s.abs()).max(0.0)
    }

    /// Its standard deviation, Nm.
    #[must_use]
    pub fn deviation_nm(&self, speed_rad_s: f64) -> f64 {
        let beyond_nm = self.unseen.map_or(0.0, |unseen| unseen.deviation_nm(speed_rad_s));
        deviation_nm(&self.covariance, speed_rad_s.abs()).hypot(beyond_nm)
    }
}

/// Doubt of friction at speeds that no run-out has.
///
/// Dry friction does not depend on the speed, viscous friction grows with it, and windage with its square. So from the
/// last speed seen on, T_fric changes by a factor between 1 and the squared ratio of the speeds. The doubt is that of a
/// number anywhere within a range of this width. It does not make friction less known than without run-outs.
///
/// # Source
/// Glans & Kärnell 2018, (4.1), with terms that are not below zero.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Unseen {
    /// Lowest and highest speed of the run-outs, rad/s.
    pub speeds_rad_s: (f64, f64),
    /// T_fric there, Nm.
    pub torques_nm: (f64, f64),
    /// Covariance of the assumption less that with the run-outs; none where they contradict each other.
    pub learnt: Option<[[f64; 2]; 2]>,
}

impl Unseen {
    /// Standard deviation that is added at a speed, Nm; zero at speeds that were seen.
    ///
    /// # Example
    /// ```
    /// # use rig::dyno_friction::Unseen;
    /// let unseen = Unseen { speeds_rad_s: (10.0, 100.0), torques_nm: (1.0, 2.0), learnt: None };
    /// assert_eq!(unseen.deviation_nm(50.0), 0.0);
    /// assert!((unseen.deviation_nm(200.0) - 2.0 * (4.0 - 1.0) / 12.0_f64.sqrt()).abs() < 1e-12);
    /// assert!((unseen.deviation_nm(0.0) - 1.0 / 12.0_f64.sqrt()).abs() < 1e-12);
    /// ```
    #[must_use]
    pub fn deviation_nm(&self, speed_rad_s: f64) -> f64 {
        let speed = speed_rad_s.abs();
        let (last, torque_nm) = match self.speeds_rad_s {
            (low, _) if speed < low => (low, self.torques_nm.0),
            (_, high) if speed > high => (high, self.torques_nm.1),
            _ => return 0.0,
        };
        let width_nm = torque_nm * ((speed / last).powi(2) - 1.0).abs();
        let evenly_nm = width_nm / 12.0_f64.sqrt();
        self.learnt.map_or(evenly_nm, |learnt| evenly_nm.min(deviation_nm(&learnt, speed)))
    }
}

/// Standard deviation of c_0 sgn ω + c_1 ω at a speed above zero, Nm.
#[must_use]
fn deviation_nm(covariance: &Covariance, speed_rad_s: f64) -> f64 {
    let [[coulomb, both], [_, slope]] = *covariance;
    (coulomb + speed_rad_s * (2.0 * both + speed_rad_s * slope)).max(0.0).sqrt()
}

fn matrix(entry: impl Fn(usize, usize) -> f64) -> Covariance {
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn product(a: &Covariance, b: &Covariance) -> Covariance {
    matrix(|i, j| a[i][0] * b[0][j] + a[i][1] * b[1][j])
}

fn sum(a: &Covariance, b: &Covariance) -> Covariance {
    matrix(|i, j| a[i][j] + b[i][j])
}

/// The inverse of a covariance that is not singular.
fn inverse(&[[a, b], [_, d]]: &Covariance) -> Option<Covariance> {
    let determinant = a * d - b * b;
    (determinant > SINGULAR * a * d).then(|| [[d / determinant, -b / determinant], [-b / determinant, a / determinant]])
}
