//! Statements of a bench file.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use units;

use crate::ExperimentLabel;
use crate::channels::ChannelMapping;
use crate::facts::{BenchFacts, BenchVariant, Engine, StatedInertia};
use crate::role::Role;

/// A bench file, checked and in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct BenchFile {
    /// The bench's name.
    pub name: String,
    /// Load cell or torque flange.
    pub variant: BenchVariant,
    /// Cylinders of the engine; none where nothing fires, as in an electric machine.
    pub cylinders: u32,
    /// Strokes of the engine, 2 or 4.
    pub strokes: u32,
    /// J_d, kg m².
    pub dynamometer_inertia_kg_m2: f64,
    /// Standard uncertainty of J_d, % of it, if stated.
    pub dynamometer_inertia_uncertainty_percent: Option<f64>,
    /// Slope of the dynamometer's bearing friction over speed, Nm s/rad, if stated.
    pub dynamometer_friction_nm_s_per_rad: Option<f64>,
    /// Friction of the dynamometer's bearings that does not depend on the speed, Nm, if stated.
    pub dynamometer_coulomb_friction_nm: Option<f64>,
    /// Standard uncertainty of both, % of each, if stated.
    pub dynamometer_friction_uncertainty_percent: Option<f64>,
    /// J_e, flywheel included, kg m².
    pub engine_inertia_kg_m2: f64,
    /// Standard uncertainty of J_e, % of it, if stated.
    pub engine_inertia_uncertainty_percent: Option<f64>,
    /// Limits that the bench must not exceed.
    pub limits: Limits,
    /// Prior knowledge of the shaft.
    pub shaft: ShaftPrior,
    /// Fields of [`BenchParameters`](crate::bench_parameters::BenchParameters) for simulations of this bench; empty
    /// where none is stated.
    pub virtual_bench: toml::Table,
    /// Channel of each role.
    pub channels: BTreeMap<Role, ChannelMapping>,
    /// Which recordings belong to the campaign.
    pub recordings: RecordingList,
    /// Whose report it is.
    pub report: ReportIdentity,
}

/// Part of a bench file that the judgement of a recorded run takes: no number of a model, and no role that it does not
/// use.
#[derive(Debug, Clone, PartialEq)]
pub struct RunChannels {
    /// Channel of each role. A channel may play several.
    pub channels: BTreeMap<Role, ChannelMapping>,
    /// The bench's largest speed, rad/s, if stated.
    pub speed_limit_rad_s: Option<f64>,
}

/// Statements of a report on itself; those not stated are not shown.
#[derive(Debug, Clone, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReportIdentity {
    /// Its title, in place of the bench's name.
    pub title: Option<String>,
    /// The number of the test or of the order.
    pub test_id: Option<String>,
    /// For whom it is.
    pub customer: Option<String>,
    /// The engine on the bench.
    pub engine: Option<String>,
    /// Who made it.
    pub author: Option<String>,
    /// Who approved it.
    pub approved_by: Option<String>,
    /// Who may read it.
    pub confidentiality: Option<String>,
    /// The file of a logo, relative to the bench file.
    pub logo: Option<String>,
}

/// Limits of the bench; what is not stated is not checked.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Limits {
    /// Drive's torque limit, Nm.
    pub torque_nm: Option<f64>,
    /// Shaft torque limit, Nm.
    pub shaft_torque_nm: Option<f64>,
    /// Speed limit, rad/s.
    pub speed_rad_s: Option<f64>,
    /// Largest change of the torque demand, Nm/s.
    pub torque_slew_nm_per_s: Option<f64>,
    /// Largest change of the shaft torque, Nm/s.
    pub shaft_torque_slew_nm_per_s: Option<f64>,
    /// Longest time that the firing may stay near the resonance, s.
    pub time_at_resonance_s: Option<f64>,
    /// Largest power of the dynamometer, W.
    pub power_w: Option<f64>,
    /// Largest change of the speed, rad/s².
    pub speed_gradient_rad_s2: Option<f64>,
    /// Torque that the drive's heat allows.
    pub drive_heat: Option<DriveHeat>,
}

/// The I²t of a drive: its heat θ, as a part of that of the continuous torque T_c, follows τ dθ/dt = (T/T_c)² − θ, and
/// may reach 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DriveHeat {
    /// T_c, which the drive gives for any time, Nm.
    pub continuous_torque_nm: f64,
    /// τ, s.
    pub time_constant_s: f64,
}

impl DriveHeat {
    /// That of a drive that gives an overload for so long, cold, before its heat is that of the continuous torque;
    /// `None` of an overload that is none.
    ///
    /// # Example
    /// ```
    /// use rig::bench_file::DriveHeat;
    /// // 200 Nm for ever, √2 times as much for 60 s: (T/T_c)² (1 − e^{−60/τ}) = 1.
    /// let heat = DriveHeat::of_overload(200.0, 200.0 * 2.0_f64.sqrt(), 60.0).unwrap();
    /// assert!((heat.time_constant_s - 60.0 / 2.0_f64.ln()).abs() < 1e-9);
    /// ```
    pub fn of_overload(continuous_torque_nm: f64, torque_nm: f64, time_s: f64) -> Option<Self> {
        let time_constant_s = -time_s / (-(continuous_torque_nm / torque_nm).powi(2)).ln_1p();
        (torque_nm > continuous_torque_nm).then_some(DriveHeat { continuous_torque_nm, time_constant_s })
    }
}

/// Prior knowledge of the shaft: for predictions and simulations alone, no study looks at it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShaftPrior {
    /// K, Nm/rad.
    pub stiffness_nm_per_rad: Option<f64>,
    /// Resonance in torque control, √(K(1/J_d + 1/J_e))/2π, Hz, in place of K.
    pub resonance_hz: Option<f64>,
    /// B, Nm s/rad.
    pub damping_nm_s_per_rad: Option<f64>,
}

impl ShaftPrior {
    /// K, Nm/rad: the one stated, or K = (2πf)²/(1/J_d + 1/J_e) of the resonance stated.
    ///
    /// # Example
    /// ```
    /// use rig::bench_file::ShaftPrior;
    /// let prior = ShaftPrior { resonance_hz: Some(18.0), ..ShaftPrior::default() };
    /// assert!((prior.stiffness_nm_per_rad((0.6, 0.28)).unwrap() - 2441.9).abs() < 0.1);
    /// ```
    pub fn stiffness_nm_per_rad(&self, (dyno_kg_m2, engine_kg_m2): (f64, f64)) -> Option<f64> {
        let mobility = 1.0 / dyno_kg_m2 + 1.0 / engine_kg_m2;
        let of_resonance = |f: f64| (std::f64::consts::TAU * f).powi(2) / mobility;
        self.stiffness_nm_per_rad.or(self.resonance_hz.map(of_resonance))
    }
}

/// The recordings of the campaign, as text: who reads files expands the patterns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RecordingList {
    /// File names or patterns such as `*.mf4`.
    pub files: Vec<String>,
    /// Labels of recordings whose names hold none, or the wrong one.
    pub labels: Vec<LabelOverride>,
    /// Stretches of recordings that are left out, or alone are used. Those of one recording do not overlap.
    pub stretches: Vec<StatedStretch>,
}

/// A stretch of one recording and its use. A sample at either end belongs to it.
#[derive(Debug, Clone, PartialEq)]
pub struct StatedStretch {
    /// The recording's file.
    pub file: String,
    /// Its beginning, s of the recording's clock.
    pub from_s: f64,
    /// Its end, s of the recording's clock.
    pub to_s: f64,
    /// Its use.
    pub usage: StretchUse,
}

/// Use of a stretch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StretchUse {
    /// Of its recording only such stretches are used.
    Estimate,
    /// Its samples are treated as missing.
    LeaveOut,
    /// Nothing is estimated from its samples; the model is tested on them.
    Validate,
}

impl StretchUse {
    /// All uses.
    pub const ALL: [StretchUse; 3] = [StretchUse::Estimate, StretchUse::LeaveOut, StretchUse::Validate];

    /// Its key in a bench file.
    pub fn key(self) -> &'static str {
        match self {
            StretchUse::Estimate => "estimate",
            StretchUse::LeaveOut => "leave_out",
            StretchUse::Validate => "validate",
        }
    }
}

/// The label of one recording.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelOverride {
    /// The recording's file.
    pub file: String,
    /// Its label.
    pub label: ExperimentLabel,
}

impl BenchFile {
    /// The label of a recording: the bench file's own, or else the one in the file's name.
    pub fn label_of(&self, file: &str) -> Option<ExperimentLabel> {
        let stated = self.recordings.labels.iter().find(|stated| names_same_file(file, &stated.file));
        stated.map(|stated| stated.label.clone()).or_else(|| file_name(file).parse().ok())
    }

    /// The stretches that the bench file states of a recording.
    pub fn stretches_of(&self, file: &str) -> Vec<&StatedStretch> {
        let stretches = self.recordings.stretches.iter();
        stretches.filter(|stated| names_same_file(file, &stated.file)).collect()
    }

    /// The firing of its engine.
    pub fn engine(&self) -> Engine {
        Engine { cylinders: self.cylinders, strokes: self.strokes }
    }

    /// J_d, with the uncertainty that is usual where none is stated.
    pub fn dynamometer_inertia(&self) -> StatedInertia {
        StatedInertia::of_dynamometer(self.dynamometer_inertia_kg_m2, self.dynamometer_inertia_uncertainty_percent)
    }

    /// J_e, with the uncertainty that is usual where none is stated.
    pub fn engine_inertia(&self) -> StatedInertia {
        StatedInertia::of_engine(self.engine_inertia_kg_m2, self.engine_inertia_uncertainty_percent)
    }

    /// Facts that the file states about the bench, for the study.
    pub fn facts(&self) -> BenchFacts {
        BenchFacts {
            name: self.name.clone(),
            variant: self.variant,
            cylinders: self.cylinders,
            strokes: self.strokes,
            dynamometer_inertia_kg_m2: self.dynamometer_inertia_kg_m2,
            dynamometer_inertia_uncertainty_percent: self.dynamometer_inertia_uncertainty_percent,
            engine_inertia_kg_m2: self.engine_inertia_kg_m2,
            engine_inertia_uncertainty_percent: self.engine_inertia_uncertainty_percent,
            torque_limit_nm: self.limits.torque_nm,
            shaft_torque_limit_nm: self.limits.shaft_torque_nm,
            speed_limit_rad_s: self.limits.speed_rad_s,
        }
    }
}

/// The last part of a path written with either kind of slash.
pub(super) fn file_name(file: &str) -> &str {
    file.rsplit(['/', '\\']).next().unwrap_or(file)
}

/// Tells whether two paths mean one file: equal, or one is the other's last part.
pub fn names_same_file(file: &str, stated: &str) -> bool {
    let (file, stated) = (file.replace('\\', "/"), stated.replace('\\', "/"));
    file == stated || file.ends_with(&format!("/{stated}")) || stated.ends_with(&format!("/{file}"))
}

/// The smallest and the largest inertia of a bench that is believed, kg m².
pub(super) const PLAUSIBLE_INERTIA_KG_M2: RangeInclusive<f64> = 0.001..=100.0;

/// Inertia units in which `value`, written without one or with the wrong one, would be plausible.
pub(super) fn plausible_inertia_units(value: f64) -> Vec<String> {
    let candidates = ["kg cm²", "g m²"].into_iter().filter_map(|spelling| units::parse_unit(spelling).ok());
    let fitting = candidates.filter(|unit| PLAUSIBLE_INERTIA_KG_M2.contains(&unit.to_si(value)));
    fitting.map(|unit| unit.spelling.to_owned()).collect()
}

/// Placeholder that stands where a person must write something. A bench file that still holds it is refused.
pub const PLACEHOLDER: &str = "FILL IN";
