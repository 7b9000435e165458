//! The numbers of a bench model by the names that all targets share.

use bench_model::document::BenchModelDocument;
use bench_model::model::{BenchModel, ModelParameter};

/// One number of a bench model as other programs have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Number {
    /// Name in ASCII, as in `K_p`.
    pub name: &'static str,
    /// Description, in words.
    pub description: &'static str,
    /// SI unit, as SI writes it.
    pub unit: Unit,
    /// Its value; none where the model lacks the part.
    pub value: Option<f64>,
    /// The estimated parameter that it is, if it is one.
    pub parameter: Option<ModelParameter>,
}

/// The SI units of a bench model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unit {
    /// kg m².
    Inertia,
    /// Nm/rad.
    Stiffness,
    /// Nm s/rad.
    Damping,
    /// Nm s²/rad.
    TorquePerAcceleration,
    /// s.
    Time,
    /// rad/s.
    Speed,
    /// Nm.
    Torque,
    /// rad.
    Angle,
}

impl Unit {
    /// For people, in ASCII.
    #[must_use]
    pub fn plain(self) -> &'static str {
        match self {
            Unit::Inertia => "kg m^2",
            Unit::Stiffness => "Nm/rad",
            Unit::Damping => "Nm s/rad",
            Unit::TorquePerAcceleration => "Nm s^2/rad",
            Unit::Time => "s",
            Unit::Speed => "rad/s",
            Unit::Torque => "Nm",
            Unit::Angle => "rad",
        }
    }

    /// As Modelica and FMI write it (ISO 80000, `.` between factors).
    #[must_use]
    pub fn modelica(self) -> &'static str {
        match self {
            Unit::Inertia => "kg.m2",
            Unit::Stiffness => "N.m/rad",
            Unit::Damping => "N.m.s/rad",
            Unit::TorquePerAcceleration => "N.m.s2/rad",
            Unit::Time => "s",
            Unit::Speed => "rad/s",
            Unit::Torque => "N.m",
            Unit::Angle => "rad",
        }
    }

    /// Exponents of kg, m, s and rad in FMI's base units; rad counts as a unit.
    #[must_use]
    pub fn exponents(self) -> [i32; 4] {
        match self {
            Unit::Inertia => [1, 2, 0, 0],
            Unit::Stiffness => [1, 2, -2, -1],
            Unit::Damping => [1, 2, -1, -1],
            Unit::TorquePerAcceleration => [1, 2, 0, -1],
            Unit::Time => [0, 0, 1, 0],
            Unit::Speed => [0, 0, -1, 1],
            Unit::Torque => [1, 2, -2, 0],
            Unit::Angle => [0, 0, 0, 1],
        }
    }
}

/// The name in ASCII and the unit of an estimated parameter.
#[must_use]
pub fn name_of(parameter: ModelParameter) -> (&'static str, Unit) {
    match parameter {
        ModelParameter::DynoInertia => ("J_d", Unit::Inertia),
        ModelParameter::EngineInertia => ("J_e", Unit::Inertia),
        ModelParameter::Stiffness => ("K", Unit::Stiffness),
        ModelParameter::Damping => ("B", Unit::Damping),
        ModelParameter::Proportional => ("K_p", Unit::Damping),
        ModelParameter::Integral => ("K_i", Unit::Stiffness),
        ModelParameter::ControllerDelay => ("tau_c", Unit::Time),
        ModelParameter::SpeedFeedForward => ("k", Unit::Damping),
        ModelParameter::AccelerationFeedForward => ("k_a", Unit::TorquePerAcceleration),
        ModelParameter::TorqueControlDelay => ("tau_t", Unit::Time),
        ModelParameter::TorqueControlBandwidth => ("a", Unit::Speed),
    }
}

/// All numbers of a model: the estimated ones, then those that are taken as exact. Delays of the demand are those of
/// the demand as the controller has it, in every target: see `demand_lead`.
#[must_use]
pub fn all(model: &BenchModel) -> Vec<Number> {
    all_with_lead(model, model.demand_lead())
}

/// The same with a demand that recordings have so many samples later. A draw has the lead of its estimate, which is
/// what files state.
pub(crate) fn all_with_lead(model: &BenchModel, lead: usize) -> Vec<Number> {
    let model = &model.with_demand_advanced(lead);
    let estimated = ModelParameter::ALL.into_iter().map(|parameter| {
        let (name, unit) = name_of(parameter);
        let description = parameter.quantity().name();
        Number { name, description, unit, value: model.value(parameter), parameter: Some(parameter) }
    });
    let exact = |name, description, unit, value| Number { name, description, unit, value, parameter: None };
    let (pi, feed_forward) = (model.speed_controller, model.feed_forward);
    estimated
        .chain([
            exact("T_s", "time between updates of the controller", Unit::Time, pi.map(|pi| pi.sample_time_s)),
            exact("tau_n", "delay of w_d* in the speed error", Unit::Time, pi.map(|pi| pi.demand_delay_s)),
            exact("tau_f", "delay of the feed-forward", Unit::Time, feed_forward.map(|feed| feed.delay_s)),
            exact("T_limit", "limit of the torque demand", Unit::Torque, model.torque_limit_nm),
            exact("T_gate", "time over which an encoder averages", Unit::Time, Some(model.encoder_gate_s)),
        ])
        .collect()
}

/// By how much a recorded demand is to be advanced, in ASCII; none where recordings have it as the controller does.
pub(crate) fn demand_lead(model: &BenchModel) -> Option<String> {
    let lead = model.demand_lead();
    let sample_ms = 1e3 * model.speed_controller?.sample_time_s;
    let lead_ms = (1e6 * lead as f64 * sample_ms).round() / 1e6;
    (lead > 0)
        .then(|| format!("recordings have it {lead} T_s ({lead_ms} ms) later: advance a recorded demand by as much"))
}

/// The same as a sentence for comments and pages.
pub(crate) fn demand_lead_sentence(model: &BenchModel) -> Option<String> {
    demand_lead(model).map(|words| format!("The speed demand is that of the controller; {words}."))
}

/// One part of the covariance: names of its parameters, rows, degrees of freedom.
pub(crate) type NamedCovariance = (Vec<&'static str>, Vec<Vec<f64>>, f64);

/// The covariance of a model, part by part.
pub(crate) fn covariance(document: &BenchModelDocument) -> Vec<NamedCovariance> {
    let parts: Vec<bench_model::model::PartCovariance> = document.uncertainty.clone().into();
    let named = |part: bench_model::model::PartCovariance| {
        let names = part.parameters.iter().map(|parameter| name_of(*parameter).0).collect();
        (names, part.covariance, part.degrees_of_freedom)
    };
    parts.into_iter().map(named).collect()
}

/// Who wrote a file: for its first line. What could end a comment or a string there is left out.
pub(crate) fn written_by(document: &BenchModelDocument) -> String {
    let plain =
        |text: &str| text.chars().filter(|c| c.is_ascii_alphanumeric() || ".-+".contains(*c)).collect::<String>();
    let (version, date) = (plain(&document.provenance.dynoid_version), plain(&document.provenance.date));
    format!("Written by dynoid {version} from the bench model of {date}.")
}
