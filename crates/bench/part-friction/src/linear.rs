//! Friction by two numbers, as the bench model has it.

use rig::dyno_friction::EstimatedFriction;
use rig::facts::StatedInertia;
use signal::distributions::normal_quantile;

use crate::{Friction, Inertia, Term};

impl Friction {
    /// c_0 sgn ω + c_1 ω over the speeds that were seen, by least squares; terms of higher order leave a rest beside
    /// the line, which counts as an error of c_0. A T_d that is off is no friction. Where J_d is the stated one, its
    /// uncertainty counts too.
    ///
    /// A part may be below zero: run-outs often show the sum better than its parts. `None` where the sum is below zero
    /// by more than its uncertainty.
    #[must_use]
    pub fn linear(&self, stated: StatedInertia) -> Option<EstimatedFriction> {
        let speeds: Vec<f64> = self.curve.iter().map(|point| point.speed_rad_s.abs()).collect();
        let of_friction = |(_, term): &(usize, Term)| *term != Term::Offset;
        let terms: Vec<(usize, Term)> = self.terms().iter().copied().enumerate().filter(of_friction).collect();
        let lines: Vec<[f64; 2]> = terms.iter().map(|(_, term)| line(&speeds, *term)).collect::<Option<_>>()?;
        let values = terms.iter().map(|(place, _)| Some(self.friction.parameters.get(*place)?.value));
        let values: Vec<f64> = values.collect::<Option<_>>()?;
        let part = |i: usize| lines.iter().zip(&values).map(|(line, value)| line[i] * value).sum::<f64>();
        let parts = [part(0), part(1)];
        let curve = |speed: f64| terms.iter().zip(&values).map(|((_, term), c)| c * term.at(speed)).sum::<f64>();
        let beside = speeds.iter().map(|speed| (curve(*speed) - parts[0] - parts[1] * speed).powi(2)).sum::<f64>();
        let share = match self.inertia {
            Inertia::Stated { .. } => stated.uncertainty_percent / 100.0,
            Inertia::Estimated { .. } => 0.0,
        };
        let widened = self.normal_variance()?;
        let entry = |i: usize, j: usize| {
            let all = (0..terms.len()).flat_map(|k| (0..terms.len()).map(move |l| (k, l)));
            let of_estimate: f64 =
                all.map(|(k, l)| lines[k][i] * self.friction.covariance[terms[k].0][terms[l].0] * lines[l][j]).sum();
            let of_line = if (i, j) == (0, 0) { beside / speeds.len() as f64 } else { 0.0 };
            widened * of_estimate + share * share * parts[i] * parts[j] + of_line
        };
        let covariance: [[f64; 2]; 2] = std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)));
        let mut recordings: Vec<String> = self.run_outs.iter().map(|run_out| run_out.stretch.file.clone()).collect();
        recordings.dedup();
        let seen = self.run_outs.iter().flat_map(|run_out| &run_out.measured_rad_s);
        let range = |(low, high): (f64, f64), speed: &f64| (low.min(speed.abs()), high.max(speed.abs()));
        let found = EstimatedFriction {
            coulomb_nm: parts[0],
            viscous_nm_s_per_rad: parts[1],
            covariance,
            speeds_rad_s: seen.fold((f64::INFINITY, 0.0), range),
            recordings,
        };
        Some(found).filter(|found| !found.drives())
    }

    /// Over the variance of the estimate, that of a normal number with the same interval.
    fn normal_variance(&self) -> Option<f64> {
        let one = self.friction.parameters.first()?;
        let half_width = 0.5 * (one.interval.1 - one.interval.0);
        let normal = normal_quantile(0.975) * one.standard_error;
        Some(if normal > 0.0 { (half_width / normal).powi(2) } else { 1.0 })
    }
}

/// The line of least squares through a term over these speeds: its value at standstill and its slope.
fn line(speeds: &[f64], term: Term) -> Option<[f64; 2]> {
    let count = speeds.len() as f64;
    let middle = speeds.iter().sum::<f64>() / count;
    let mean = speeds.iter().map(|speed| term.at(*speed)).sum::<f64>() / count;
    let spread: f64 = speeds.iter().map(|speed| (speed - middle).powi(2)).sum();
    let slope = speeds.iter().map(|speed| (speed - middle) * (term.at(*speed) - mean)).sum::<f64>() / spread;
    slope.is_finite().then_some([mean - slope * middle, slope])
}
