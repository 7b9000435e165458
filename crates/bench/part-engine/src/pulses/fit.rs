//! The harmonics of all recordings together: a linear regression of each on mean torque and speed, on top of what is
//! known of the class.
//!
//! T_e,m = α + β T + γ ω², complex, with the class's variances as the prior of α, β and γ: what the recordings do not
//! show stays as wide as that. T is the torque for which the cylinders are charged. Within a recording the mean torque
//! also varies with the ignition angles, from cycle to cycle, and by its own errors, while the charge stays. So a
//! recording has a slope κ of its own, as far as its torque varies in one of these ways, and an error of its T.
//! The crank's angle begins anywhere in each recording.
//! The angle δ by which a recording is turned against the others is the one of the greatest evidence, in which it
//! stands as Σ_m Re(e^{−imδ} c_m) alone. Where another cylinder at the place of the first would be nearly as probable,
//! only the multiples of the firing order count.
//!
//! # Source
//! Gelman et al., *Bayesian Data Analysis*, 3rd ed. 2013, §14.8.

use std::f64::consts::{SQRT_2, TAU};

use faer::Mat;
use numerics::linalg::Cholesky;
use rig::bench_parameters::CycleHarmonic;
use rig::engine_pulses::{EnginePulses, PulseHarmonic};
use signal::Complex64;

use super::windows::{Seen, encoder_error};
use crate::source::Values;

/// Windows overlap by a half. Neighbours under a Hann window have a correlation of 1/6, which makes the variance of a
/// mean so many times larger.
const OVERLAP: f64 = 4.0 / 3.0;
/// How much more probable, as a logarithm, the best angle of a recording must be than no pulses at all, ...
const CLEAR_OF_NO_PULSES: f64 = 10.0;
/// ... and than another cylinder in the place of the first.
const CLEAR_OF_ANOTHER_CYLINDER: f64 = 4.6;
/// Angles tried for each of the harmonics.
const ANGLES_EACH: usize = 16;
/// Halvings of the step in which the best angle is looked for.
const HALVINGS: usize = 30;
/// Error of all parts of a harmonic alike: what K, J_d, the gate, and friction that changes with the speed leave
/// uncertain.
const OF_MECHANICS: f64 = 0.01;
/// A harmonic is estimated where recordings leave less than this part of the variance of the class, at the mean torque
/// and speed.
const SHOWN: f64 = 0.1;

/// Root mean square of κ over that of β. A late ignition leaves the charge and moves the burning: slider-cranks with
/// Wiebe's burning give 0.3 to 0.5 where the burning is as much weaker, and up to 1.4 where it is as much later.
const WITHOUT_CHARGE: f64 = 0.8;
/// How far the torque of the charge is from the largest that was seen, over that, where ignition angles set the torque:
/// a window is a mean over several demands, and control units keep a reserve.
const RESERVE: f64 = 0.05;

/// The regressors of a recording: those of α, β and γ, the errors of both encoders, κ, and the error of T.
const OF_RECORDING: usize = 7;
/// Those that a recording has for itself.
const OF_ITSELF: [usize; 4] = [3, 4, 5, 6];

/// Sums of a regression on N regressors, each over the standard deviation of its part in the class.
#[derive(Debug, Clone, Copy)]
struct Sums<const N: usize = 3> {
    information: [[f64; N]; N],
    along: [Complex64; N],
    squares: f64,
    windows: f64,
}

impl<const N: usize> Default for Sums<N> {
    fn default() -> Self {
        Sums { information: [[0.0; N]; N], along: [Complex64::default(); N], squares: 0.0, windows: 0.0 }
    }
}

impl<const N: usize> Sums<N> {
    fn add(&mut self, regressors: [f64; N], value: Complex64, variance: f64) {
        for i in 0..N {
            for j in 0..N {
                self.information[i][j] += regressors[i] * regressors[j] / variance;
            }
            self.along[i] += value * (regressors[i] / variance);
        }
        self.squares += value.norm_sqr() / variance;
        self.windows += 1.0;
    }

    /// These and others that are turned by an angle.
    fn plus(&self, other: &Self, turned_rad: f64) -> Self {
        let turn = Complex64::cis(-turned_rad);
        Sums {
            information: std::array::from_fn(|i| {
                std::array::from_fn(|j| self.information[i][j] + other.information[i][j])
            }),
            along: std::array::from_fn(|i| self.along[i] + turn * other.along[i]),
            squares: self.squares + other.squares,
            windows: self.windows + other.windows,
        }
    }

    /// With variances that are `times` as large.
    fn weakened(&self, times: f64) -> Self {
        Sums {
            information: self.information.map(|row| row.map(|one| one / times)),
            along: self.along.map(|one| one / times),
            squares: self.squares / times,
            windows: self.windows,
        }
    }

    /// The covariance of real and imaginary parts, with the class's of one.
    fn covariance(&self) -> [[f64; N]; N] {
        let own = |i: usize, j: usize| if i == j { 1.0 } else { 0.0 };
        let precision = Mat::from_fn(N, N, |i, j| self.information[i][j] + own(i, j));
        match Cholesky::new(precision.as_ref()) {
            Ok(factor) => {
                let inverse = factor.inverse();
                std::array::from_fn(|i| std::array::from_fn(|j| inverse[(i, j)]))
            }
            Err(_) => std::array::from_fn(|i| std::array::from_fn(|j| own(i, j))),
        }
    }

    fn solution(&self) -> [Complex64; N] {
        let covariance = self.covariance();
        std::array::from_fn(|i| (0..N).map(|j| self.along[j] * covariance[i][j]).sum())
    }

    /// How many times larger than stated the scatter about the regression is; at least once.
    fn scatter(&self) -> f64 {
        let solution = self.solution();
        let explained: f64 = (0..N).map(|i| (self.along[i].conj() * solution[i]).re).sum();
        let freedom = 2.0 * (self.windows - N as f64);
        if freedom > 0.0 { ((self.squares - explained) / freedom).max(1.0) } else { f64::INFINITY }
    }
}

impl Sums<OF_RECORDING> {
    /// Sums for α, β and γ alone, whatever the recording has for itself being anything that is probable: the Schur
    /// complement.
    fn of_engine(&self) -> Sums {
        let of_engine = [0, 1, 2];
        let alone = Sums::<{ OF_ITSELF.len() }> {
            information: OF_ITSELF.map(|i| OF_ITSELF.map(|j| self.information[i][j])),
            along: OF_ITSELF.map(|i| self.along[i]),
            squares: 0.0,
            windows: 0.0,
        };
        let (own, covariance) = (alone.solution(), alone.covariance());
        let places = 0..OF_ITSELF.len();
        let with = |i: usize, k: usize| self.information[i][OF_ITSELF[k]];
        let both = || places.clone().flat_map(|k| places.clone().map(move |l| (k, l)));
        let shared = |i: usize, j: usize| both().map(|(k, l)| with(i, k) * covariance[k][l] * with(j, l)).sum::<f64>();
        let taken = |i: usize| places.clone().map(|k| own[k] * with(i, k)).sum::<Complex64>();
        Sums {
            information: of_engine.map(|i| of_engine.map(|j| self.information[i][j] - shared(i, j))),
            along: of_engine.map(|i| self.along[i] - taken(i)),
            squares: self.squares - places.clone().map(|k| (alone.along[k].conj() * own[k]).re).sum::<f64>(),
            windows: self.windows,
        }
    }
}

/// One recording: sums at each harmonic, its variances as large as its own scatter shows.
pub(super) struct Recording {
    pub(super) file: String,
    /// True where ignition angles set its torque.
    pub(super) is_by_ignition: bool,
    sums: Vec<Sums>,
}

/// The class as the regression has it, at each harmonic.
pub(super) struct Class(Vec<OfClass>);

/// α is T_0 β and what is independent of β.
struct OfClass {
    /// T_0, Nm: a regression on T + T_0 has no more of α than that.
    uncharged_nm: f64,
    /// Standard deviations of that rest of α, of β and of γ.
    scales: [f64; 3],
}

impl Class {
    pub(super) fn of(prior: &EnginePulses) -> Self {
        let of_harmonic = |PulseHarmonic { covariance: c, .. }: &PulseHarmonic| {
            let uncharged_nm = c[0][1] / c[1][1];
            let rest = (c[0][0] - uncharged_nm * c[0][1]).max(0.0);
            OfClass { uncharged_nm, scales: [rest.sqrt(), c[1][1].sqrt(), c[2][2].sqrt()] }
        };
        Class(prior.harmonics.iter().map(of_harmonic).collect())
    }
}

impl OfClass {
    fn regressors(&self, torque_nm: f64, speed_rad_s: f64) -> [f64; 3] {
        let [rest, of_torque, of_speed] = self.scales;
        [rest, of_torque * (torque_nm + self.uncharged_nm), of_speed * speed_rad_s * speed_rad_s]
    }

    /// α, β, γ of a solution.
    fn parts<T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>>(&self, solution: [T; 3]) -> [T; 3] {
        let [rest, of_torque, of_speed] = std::array::from_fn(|i| solution[i] * self.scales[i]);
        [rest + of_torque * self.uncharged_nm, of_torque, of_speed]
    }

    /// The covariance of α, β, γ from that of a solution.
    fn covariance(&self, of_solution: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
        let columns = of_solution.map(|row| self.parts(row));
        let rows: [[f64; 3]; 3] = std::array::from_fn(|j| self.parts(columns.map(|row| row[j])));
        std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (rows[i][j] + rows[j][i])))
    }
}

/// The torque for which the cylinders are charged in a recording.
struct Charge {
    /// Of all windows in which the mean torque varies while the charge stays, Nm.
    torque_nm: f64,
    /// Part of a torque's distance from it that is no charge.
    share: f64,
    /// Standard deviation of all torques alike, Nm.
    doubt_nm: f64,
}

impl Charge {
    /// Where ignition angles set the torque, the charge is for the largest. Elsewhere it follows the torque, as far as
    /// that varies more than `doubt_nm` and more slowly than from window to window: the part of the rest in the
    /// variance is by how much it falsifies a slope over the torque.
    fn of(windows: &[Seen], is_by_ignition: bool, doubt_nm: f64) -> Self {
        let torques: Vec<f64> = windows.iter().map(|window| window.torque_nm).collect();
        if is_by_ignition {
            let largest_nm = torques.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            return Charge { torque_nm: largest_nm, share: 1.0, doubt_nm: doubt_nm.hypot(RESERVE * largest_nm) };
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let torque_nm = mean(&torques);
        let variance = mean(&torques.iter().map(|torque| (torque - torque_nm).powi(2)).collect::<Vec<_>>());
        // Windows overlap by a half: the next but one shares nothing.
        let apart: Vec<f64> = torques.windows(3).map(|three| 0.5 * (three[2] - three[0]).powi(2)).collect();
        let no_charge = mean(&apart) + doubt_nm * doubt_nm;
        let share = if no_charge < variance { no_charge / variance } else { 1.0 };
        Charge { torque_nm, share, doubt_nm }
    }

    fn missing_nm(&self, torque_nm: f64) -> f64 {
        self.share * (self.torque_nm - torque_nm)
    }
}

impl Recording {
    /// `windows` have a value for each of the first harmonics or none. Ignition angles may set their torque. The mean
    /// torque of a recording has a standard deviation of `doubt_nm`.
    pub(super) fn of(
        file: &str,
        windows: &[Seen],
        places: &[usize],
        class: &Class,
        is_by_ignition: bool,
        doubt_nm: f64,
    ) -> Self {
        let mut sums = vec![Sums::<OF_RECORDING>::default(); class.0.len()];
        let charge = Charge::of(windows, is_by_ignition, doubt_nm);
        for window in windows {
            let missing_nm = charge.missing_nm(window.torque_nm);
            for (place, wave) in places.iter().zip(&window.waves) {
                let Some(wave) = wave else { continue };
                let of_class = &class.0[*place];
                let [of_none, of_torque, of_speed] = of_class.regressors(window.torque_nm, window.speed_rad_s);
                let [engine, dyno] = wave.of_encoders_nm.map(|one| one / SQRT_2);
                let of_slope = of_class.scales[1];
                let (own_slope, own_error) = (WITHOUT_CHARGE * of_slope * missing_nm, of_slope * charge.doubt_nm);
                let all = [of_none, of_torque, of_speed, engine, dyno, own_slope, own_error];
                sums[*place].add(all, wave.torque_nm, wave.variance);
            }
        }
        let weakened = sums.iter().map(|sums| match sums.scatter() {
            scatter if scatter.is_finite() => sums.weakened(OVERLAP * scatter).of_engine(),
            _ => Sums::default(),
        });
        Recording { file: file.to_owned(), is_by_ignition, sums: weakened.collect() }
    }

    /// How much it shows of torques at the firing order, for the order in which recordings are joined.
    pub(super) fn weight(&self, cylinders: usize) -> f64 {
        self.sums.get(cylinders - 1).map_or(0.0, |sums| (0..3).map(|i| sums.information[i][i]).sum())
    }
}

/// All recordings joined: which of them count, and their sums.
pub(super) struct Joined {
    pub(super) recordings: Vec<String>,
    sums: Vec<Sums>,
    /// Of each recording, turned as the others are.
    each: Vec<Vec<Sums>>,
}

impl Joined {
    /// Of recordings, those that show most first.
    pub(super) fn of(recordings: &[Recording], cylinders: usize) -> Self {
        let count = recordings.first().map_or(0, |one| one.sums.len());
        let mut joined = Joined { recordings: Vec::new(), sums: vec![Sums::default(); count], each: Vec::new() };
        recordings.iter().for_each(|one| joined.join(one, cylinders));
        joined
    }

    fn join(&mut self, recording: &Recording, cylinders: usize) {
        let (turned_rad, is_cylinder_clear) = match self.recordings.is_empty() {
            true => (0.0, true),
            false => match self.turned(recording, cylinders) {
                Some(found) => found,
                None => return,
            },
        };
        self.recordings.push(recording.file.clone());
        let counts = |m: usize| is_cylinder_clear || m.is_multiple_of(cylinders);
        let turned = |(other, m): (&Sums, usize)| match counts(m) {
            true => Sums::default().plus(other, m as f64 * turned_rad),
            false => Sums::default(),
        };
        let own: Vec<Sums> = recording.sums.iter().zip(1..).map(turned).collect();
        self.sums.iter_mut().zip(&own).for_each(|(sums, own)| *sums = sums.plus(own, 0.0));
        self.each.push(own);
    }

    /// By which angle of the cycle a recording is turned, and whether another cylinder in the place of the first is
    /// excluded; `None` where it shows no pulses.
    fn turned(&self, recording: &Recording, cylinders: usize) -> Option<(f64, bool)> {
        let common: Vec<Complex64> = self.sums.iter().zip(&recording.sums).map(common).collect();
        let evidence = |turned_rad: f64| {
            let part = |(at, c): (usize, &Complex64)| (Complex64::cis(-((at + 1) as f64) * turned_rad) * c).re;
            common.iter().enumerate().map(part).sum::<f64>()
        };
        let step = TAU / (ANGLES_EACH * common.len()) as f64;
        let tried = (0..ANGLES_EACH * common.len()).map(|k| k as f64 * step);
        let first = tried.max_by(|a, b| evidence(*a).total_cmp(&evidence(*b)))?;
        let best = climb(&evidence, first, step);
        let others = (1..cylinders).map(|k| climb(&evidence, best + TAU * k as f64 / cylinders as f64, step));
        let next = others.map(evidence).fold(f64::NEG_INFINITY, f64::max);
        (evidence(best) > CLEAR_OF_NO_PULSES).then(|| (best, evidence(best) - next > CLEAR_OF_ANOTHER_CYLINDER))
    }

    /// The pulses of masses with these values, on top of those of the class. `at` are the mean torque and speed of the
    /// recordings, whose mean torque is uncertain by `friction_nm`, the root of its mean square.
    pub(super) fn pulses(
        &self,
        prior: &EnginePulses,
        values: &Values,
        friction_nm: f64,
        at: (f64, f64),
    ) -> Vec<PulseHarmonic> {
        let class = Class::of(prior);
        let found = |place: usize| {
            let (of_class, own) = (&prior.harmonics[place], &class.0[place]);
            let (solution, covariance) = (self.sums[place].solution(), self.covariance(place));
            let [of_none, of_torque, of_speed] = doubts(of_class.order, values);
            let parts = own.parts(solution);
            // A torque that is T + f has β f in its α.
            let doubt = [of_none.hypot(parts[1].norm() * friction_nm), of_torque, of_speed];
            let of_noise = own.covariance(&covariance);
            let entry = |i: usize, j: usize| {
                let of_mechanics = OF_MECHANICS * OF_MECHANICS * (parts[i] * parts[j].conj()).re;
                of_noise[i][j] + of_mechanics + if i == j { doubt[i].powi(2) } else { 0.0 }
            };
            let [unloaded_nm, of_torque, of_speed_nm_s2] = parts.map(|part| [part.re, part.im]);
            let found = PulseHarmonic {
                order: of_class.order,
                value: CycleHarmonic { unloaded_nm, of_torque, of_speed_nm_s2 },
                covariance: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))),
                is_estimated: false,
            };
            let left = found.standard_error_nm(at.0, at.1) / of_class.standard_error_nm(at.0, at.1);
            PulseHarmonic { is_estimated: left * left < SHOWN, ..found }
        };
        let mut all: Vec<PulseHarmonic> = (0..self.sums.len()).map(found).collect();
        let unequal = unequal(&all, prior, at);
        // Nothing was looked for where the sums are empty.
        let unseen = all.iter_mut().zip(&self.sums).filter(|(_, sums)| sums.information[1][1] == 0.0);
        unseen.for_each(|(harmonic, _)| {
            harmonic.covariance = harmonic.covariance.map(|row| row.map(|one| unequal * one))
        });
        all
    }

    /// The covariance at a harmonic, over the class's: P of the regression, and P Σ g gᵀ P by how recordings contradict
    /// what they give together, g being the gradient of the fit to each. Errors that a whole recording has alike do not
    /// average out over its windows.
    fn covariance(&self, place: usize) -> [[f64; 3]; 3] {
        let (covariance, solution) = (self.sums[place].covariance(), self.sums[place].solution());
        let step = |own: &Vec<Sums>| -> [Complex64; 3] {
            let sums = &own[place];
            let gradient: [Complex64; 3] = std::array::from_fn(|i| {
                sums.along[i] - (0..3).map(|j| solution[j] * sums.information[i][j]).sum::<Complex64>()
            });
            std::array::from_fn(|i| (0..3).map(|j| gradient[j] * covariance[i][j]).sum())
        };
        let steps: Vec<[Complex64; 3]> = self.each.iter().map(step).collect();
        let apart = |i: usize, j: usize| 0.5 * steps.iter().map(|step| (step[i] * step[j].conj()).re).sum::<f64>();
        std::array::from_fn(|i| std::array::from_fn(|j| covariance[i][j] + apart(i, j)))
    }
}

/// How unequal the cylinders are, as the variance over that of the class of the harmonics between multiples of the
/// firing order: that of those that are estimated, at the mean torque and speed.
fn unequal(all: &[PulseHarmonic], prior: &EnginePulses, at: (f64, f64)) -> f64 {
    let is_between = |m: usize| !m.is_multiple_of(prior.cylinders as usize);
    let over_class = |(found, of_class): (&PulseHarmonic, &PulseHarmonic)| {
        let amplitude_nm = found.value.at(at.0, at.1).norm();
        let squared = 0.5 * amplitude_nm * amplitude_nm + found.standard_error_nm(at.0, at.1).powi(2);
        squared / of_class.standard_error_nm(at.0, at.1).powi(2)
    };
    let between =
        (1..).zip(all.iter().zip(&prior.harmonics)).filter(|(m, (found, _))| is_between(*m) && found.is_estimated);
    let all: Vec<f64> = between.map(|(_, both)| over_class(both)).collect();
    if all.is_empty() { 1.0 } else { (all.iter().sum::<f64>() / all.len() as f64).min(1.0) }
}

/// Standard deviations that an error of the engine's encoder adds to α, β and γ: nothing separates it from a motion. An
/// error of the speed, e ω at the order o, makes a torque of the engine's inertia, o ω J_e e ω, and one of the shaft's
/// stiffness, K e ω/(o ω).
fn doubts(order: f64, values: &Values) -> [f64; 3] {
    let error = encoder_error(order) / SQRT_2;
    [error * values.stiffness / order, 0.0, error * values.engine_inertia * order]
}

/// Part of the evidence that depends on the angle between two sums.
fn common((sums, other): (&Sums, &Sums)) -> Complex64 {
    let covariance = sums.plus(other, 0.0).covariance();
    let entry = |i: usize, j: usize| sums.along[i].conj() * other.along[j] * covariance[i][j];
    (0..9).map(|k| entry(k / 3, k % 3)).sum()
}

/// The highest place about a start, by steps that are halved.
fn climb(of: &impl Fn(f64) -> f64, start: f64, step: f64) -> f64 {
    let (mut best, mut step) = (start, step);
    for _ in 0..HALVINGS {
        best = [best - step, best, best + step].into_iter().max_by(|a, b| of(*a).total_cmp(&of(*b))).unwrap_or(best);
        step *= 0.5;
    }
    best
}

#[cfg(test)]
mod tests {
    use super::{Charge, RESERVE, Seen};

    fn charge(torques_nm: impl Iterator<Item = f64>, is_by_ignition: bool) -> Charge {
        let window = |torque_nm| Seen { torque_nm, speed_rad_s: 150.0, waves: Vec::new() };
        Charge::of(&torques_nm.map(window).collect::<Vec<_>>(), is_by_ignition, 1.0)
    }

    #[test]
    fn exact_a_torque_that_scatters_or_stays_within_its_doubt_shows_no_charge() {
        let scatters = charge((0..60).map(|k| 60.0 + 5.0 * (1.7 * f64::from(k * k)).sin()), false);
        assert!(scatters.share > 0.8, "{}", scatters.share);
        let creeps = charge((0..60).map(|k| 60.0 + 0.02 * f64::from(k)), false);
        assert!((creeps.share - 1.0).abs() < 1e-12, "{}", creeps.share);
    }

    #[test]
    fn exact_a_torque_that_changes_slowly_is_that_of_the_charge() {
        let rises = charge((0..=80).map(|k| 20.0 + f64::from(k)), false);
        // Two of a step of 1 Nm and the doubt of 1 Nm, over (81² − 1)/12.
        assert!((rises.share - (2.0 + 1.0) / (6560.0 / 12.0)).abs() < 1e-12, "{}", rises.share);
        assert!((rises.missing_nm(40.0) - rises.share * 20.0).abs() < 1e-12);
    }

    #[test]
    fn exact_ignition_angles_leave_the_charge_of_the_largest_torque_or_more() {
        let set = charge([35.0, 50.0, 40.0].into_iter(), true);
        assert!((set.missing_nm(35.0) - 15.0).abs() < 1e-12);
        assert!((set.doubt_nm - 1.0_f64.hypot(RESERVE * 50.0)).abs() < 1e-12);
    }
}
