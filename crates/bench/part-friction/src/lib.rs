//! Friction and inertia of the dynamometer from recordings without shaft: steps of speed, and run-outs (thesis §4.8).
//!
//! J_d dω_d/dt = −T_d − T_fric(ω_d) (4.1), T_fric = c_0 sgn ω + c_1 ω + c_2 ω|ω| + c_3 ω³, and where both directions
//! are seen T_0, by which friction differs between them or T_d is off. Integrated over time, nothing is differentiated:
//! ω_d(t) = ω_0 − (1/J_d) ∫T_d(t − δ) dt − Σ (c_i/J_d) ∫…dt, linear in 1/J_d and c_i/J_d. δ, by which the torque's
//! clock is late against the speed's, is a parameter too. What torques leave unsaid adds up in the speed as a random
//! walk does, under the encoder's white noise; the ratio of the two is that of greatest likelihood, and the estimate
//! that of generalised least squares. Intervals are robust to residuals that are coloured all the same.

mod error;
mod fitted;
mod free_run;
mod linear;
mod options;
mod regression;

use numerics::null::nan_if_null;
use rig::Experiment;
use rig::results::{Estimate, Parameter, Stretch};
use serde::{Deserialize, Serialize};

pub use error::FrictionError;
use fitted::Drive;
use fitted::Fitted;
use free_run::{Directions, FreeRun};
pub use options::{CurvePoint, FrictionOptions, RunOut, Term, TorqueUsed};
use regression::{Excitation, Problem};

/// A term of higher order stays where the interval of its coefficient at this level does not hold zero.
const TERM_LEVEL: f64 = 0.99;
/// 1/J_d counts as determined by the data below this relative standard error.
const DETERMINED: f64 = 0.1;
/// Friction drives where it does so beyond so many half widths of its interval, ...
const DRIVES_HALF_WIDTHS: f64 = 2.0;
/// ... and by this part of the largest torque.
const DRIVES_PART: f64 = 0.05;

/// Whence J_d.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "from", rename_all = "snake_case")]
pub enum Inertia {
    /// The recordings: T_d changed the speed.
    Estimated {
        /// J_d, kg m².
        inertia: Box<Parameter>,
        /// By how much T_d is later than N_d, s.
        delay: Box<Parameter>,
    },
    /// The bench file: T_d was zero, not recorded, or changed nothing, and the recordings show friction over inertia
    /// alone.
    Stated {
        /// J_d, kg m².
        #[serde(deserialize_with = "nan_if_null")]
        inertia_kg_m2: f64,
        /// Why.
        why: Undetermined,
    },
}

/// Why the recordings do not show J_d.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Undetermined {
    /// No torque was recorded.
    NoTorque,
    /// T_d was zero throughout.
    TorqueFree,
    /// T_d hardly changed the speed, or only as friction does.
    LittleExcitation,
}

/// A choice of terms and what it leaves unexplained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// Its terms.
    pub terms: Vec<Term>,
    /// Coefficients over J_d.
    pub per_inertia: Vec<Parameter>,
    /// −2 ln likelihood + ln(samples) for each parameter, less that of the best candidate.
    #[serde(deserialize_with = "nan_if_null")]
    pub bic_above_best: f64,
    /// True for the one that was chosen.
    pub chosen: bool,
}

/// Friction and inertia of a dynamometer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Friction {
    /// J_d and whence.
    pub inertia: Inertia,
    /// Coefficients of T_fric, Nm and so on.
    pub friction: Estimate,
    /// Coefficients over J_d: what a run-out shows by itself.
    pub per_inertia: Estimate,
    /// All choices of terms that were compared with each other.
    pub candidates: Vec<Candidate>,
    /// T_fric over the speeds that were seen.
    pub curve: Vec<CurvePoint>,
    /// Run-outs that were used.
    pub run_outs: Vec<RunOut>,
}

impl Friction {
    /// The terms that were chosen.
    #[must_use]
    pub fn terms(&self) -> &[Term] {
        self.candidates.iter().find(|c| c.chosen).map_or(&[], |c| &c.terms)
    }

    /// J_d, estimated or stated, kg m².
    #[must_use]
    pub fn inertia_kg_m2(&self) -> f64 {
        match &self.inertia {
            Inertia::Estimated { inertia, .. } => inertia.value,
            Inertia::Stated { inertia_kg_m2, .. } => *inertia_kg_m2,
        }
    }
}

/// Estimates friction, and J_d where torque shows it, from recordings without shaft, all together.
///
/// Coulomb and viscous friction are always there, an offset where both directions are seen and separate it from zero; a
/// quadratic and a cubic term where they are separated from zero with 99 % confidence. Samples of N_d that drop out are
/// left out. Without a recorded torque, the longest fall of the speed is used. Where T_d is known at its own samples
/// alone, or as the load cell sees it, means over several of them are compared.
///
/// # Errors
/// No recording; one with the shaft on; no N_d; a speed that hardly varies; too few samples; a T_d of the wrong sign;
/// friction that drives, or is known to within no torque that acted.
///
/// # Source
/// Glans & Kärnell 2018, (4.1); Ljung 1999, ch. 7; Ibragimov & Müller 2010 for the intervals.
pub fn estimate(experiments: &[&Experiment], options: FrictionOptions) -> Result<Friction, FrictionError> {
    let mut free_runs: Vec<FreeRun> = Vec::new();
    for experiment in experiments {
        free_runs.extend(free_run::free_runs(experiment, options)?);
    }
    let Some(file) = free_runs.first().map(|free_run| free_run.file.clone()) else {
        return Err(FrictionError::NoRecording);
    };
    free_run::check_range(&free_runs)?;
    let failed = |source| FrictionError::Ident { file: file.clone(), source };
    let mut problem = Problem::new(&free_runs);
    let directions = free_run::directions(&free_runs);
    let (drive, inertia) = drive(&mut problem, directions, options.inertia_kg_m2).map_err(failed)?;
    let whole = problem.fit(&directions.with(&Term::ALL), drive);
    let has_offset = whole.is_ok_and(|fit| fit.is_significant(Term::Offset, TERM_LEVEL));
    let directions = if has_offset { Directions::Both } else { Directions::One };
    let mut fits = Vec::new();
    for count in (2..=Term::ALL.len()).rev() {
        match problem.fit(&directions.with(&Term::ALL[..count]), drive) {
            Ok(fit) => fits.push(fit),
            // Speeds that lie too close together for terms of such order.
            Err(fitting::IdentError::RankDeficient { .. }) if count > 2 => {}
            Err(source) => return Err(failed(source)),
        }
    }
    let is_least = |fit: &Fitted| fit.terms.last() == Some(&Term::Viscous);
    let chosen = fits.iter().position(|fit| is_least(fit) || fit.is_last_significant(TERM_LEVEL)).unwrap_or(0);
    for terms in [&[Term::Coulomb][..], &[Term::Viscous]] {
        fits.push(problem.fit(&directions.with(terms), drive).map_err(failed)?);
    }
    let fit = &fits[chosen];
    let whence = match inertia {
        None => Inertia::Estimated {
            inertia: Box::new(fit.inertia().ok_or(FrictionError::NoRecording)?),
            delay: Box::new(problem.delay(fit)),
        },
        Some(why) => Inertia::Stated { inertia_kg_m2: options.inertia_kg_m2, why },
    };
    let best = fits.iter().map(|fit| fit.bic).fold(f64::INFINITY, f64::min);
    let stretches: Vec<Stretch> = free_runs.iter().map(FreeRun::stretch).collect();
    check_torques(fit, &free_runs)?;
    let per_inertia = fit.per_inertia(&stretches);
    let friction = fit.friction(&stretches);
    Ok(Friction {
        curve: fit.curve(free_run::speeds(&free_runs), |_| true),
        candidates: fits
            .iter()
            .enumerate()
            .map(|(i, fit)| Candidate {
                terms: fit.terms.clone(),
                per_inertia: fit.per_inertia(&stretches).parameters,
                bic_above_best: fit.bic - best,
                chosen: i == chosen,
            })
            .collect(),
        run_outs: free_runs.iter().map(|free_run| free_run.run_out(fit)).collect(),
        inertia: whence,
        friction,
        per_inertia,
    })
}

/// Refuses friction that no dynamometer by itself has.
fn check_torques(fit: &Fitted, free_runs: &[FreeRun]) -> Result<(), FrictionError> {
    let largest_nm = free_run::largest_torque_nm(free_runs, fit.inertia_kg_m2());
    let mut files: Vec<&str> = free_runs.iter().map(|free_run| free_run.file.as_str()).collect();
    files.dedup();
    let files = files.join(", ");
    // An offset of T_d is no friction.
    let curve = fit.curve(free_run::speeds(free_runs), |term| term != Term::Offset);
    let sharpest = curve.iter().min_by(|a, b| a.half_width_nm.total_cmp(&b.half_width_nm));
    if let Some(CurvePoint { speed_rad_s, torque_nm, half_width_nm }) = sharpest.copied()
        && half_width_nm.max(torque_nm.abs() - half_width_nm) > largest_nm
    {
        return Err(FrictionError::BeyondTorques { files, torque_nm, half_width_nm, speed_rad_s, largest_nm });
    }
    let slowest = free_runs.iter().flat_map(|c| &c.speed.samples).fold(f64::INFINITY, |least, w| least.min(w.abs()));
    let driving_nm = |point: &CurvePoint| -point.torque_nm * point.speed_rad_s.signum();
    let drives = |point: &&CurvePoint| {
        point.speed_rad_s.abs() >= slowest
            && driving_nm(point) > (DRIVES_HALF_WIDTHS * point.half_width_nm).max(DRIVES_PART * largest_nm)
    };
    let worst = curve.iter().filter(drives).max_by(|a, b| driving_nm(a).total_cmp(&driving_nm(b)));
    match worst {
        Some(CurvePoint { speed_rad_s, torque_nm, .. }) => {
            Err(FrictionError::Drives { files, torque_nm: *torque_nm, speed_rad_s: *speed_rad_s })
        }
        None => Ok(()),
    }
}

/// How T_d acts in the equations: with J_d free where the data determine it, else as the bench file has it.
fn drive(
    problem: &mut Problem<'_>,
    directions: Directions,
    stated_kg_m2: f64,
) -> Result<(Drive, Option<Undetermined>), fitting::IdentError> {
    let usual = directions.with(&Term::ALL[..2]);
    let stated = Drive::Known { inertia_kg_m2: stated_kg_m2 };
    let why = match problem.excitation(stated_kg_m2) {
        Excitation::NotRecorded => Undetermined::NoTorque,
        Excitation::None => Undetermined::TorqueFree,
        Excitation::Little => Undetermined::LittleExcitation,
        Excitation::Enough => match problem.settle_delay(&usual) {
            Ok(fit) if fit.inertia_error() < DETERMINED => return Ok((Drive::Free, None)),
            Ok(_) | Err(fitting::IdentError::RankDeficient { .. }) => Undetermined::LittleExcitation,
            Err(error) => return Err(error),
        },
    };
    problem.forget_delay();
    problem.settle_noise(&usual, stated)?;
    Ok((stated, Some(why)))
}
