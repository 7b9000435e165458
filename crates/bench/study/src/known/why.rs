//! Reasons for a grade.

use bench_model::model::ModelParameter;
use part_controller::speed_controller::Term;
use part_engine::Certainty;
use part_torque::torque_control::SecondOrderTest;
use rig::facts::BenchVariant;
use rig::results::{Parameter, Reason};
use rig::{ExperimentLabel, Role};
use serde::Serialize;

/// One reason why something is known as well as it is.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Why {
    /// It is not estimated for want of these.
    Needs(Vec<Reason>),
    /// The data of the estimate; none where the study does not state them.
    From(Vec<Source>),
    /// Fit on a stretch that the estimate has not seen.
    HeldOut {
        /// The signal.
        signal: String,
        /// The fit, %.
        fit_percent: f64,
    },
    /// The residuals depend on this signal.
    DependsOn(String),
    /// The residuals depend on the signal without the delay, and do not with it.
    DelaySeen {
        /// The signal.
        input: String,
        /// Share of the lags at which they depend on it without the delay.
        share: f64,
    },
    /// The residuals do not depend on this signal, with the delay or without it.
    DelayNotSeen(String),
    /// The recordings cannot show which integration rule the controller uses.
    IntegrationRule,
    /// Terms found beyond PI and delay.
    BeyondPi {
        /// Level of the tests.
        level: f64,
        /// Those found.
        terms: Vec<Term>,
        /// Speed that stays unexplained without and with them, rad/s.
        left_rad_s: (f64, f64),
    },
    /// Fit of PI alone on the same stretch, %.
    PiAlone(f64),
    /// Terms found beyond k and k_a.
    BeyondFeedForward(Vec<Term>),
    /// The initial state of the integrator takes up the constant part.
    ConstantInInitialState,
    /// Fit of a delay alone on the same stretch, %.
    DelayAlone(f64),
    /// How late the time stamps of T_d,calc are; none where no estimate of the shaft shows it.
    ClockOfDelay {
        /// The skew.
        skew: Option<Parameter>,
        /// The delay without it.
        delay: Option<Parameter>,
    },
    /// A delay behind T_d* that is below zero by more than its interval.
    BeforeDemand(Parameter),
    /// The lag is shorter than the time between samples of T_d,calc.
    LagBelowSample {
        /// The lag, s.
        lag_s: f64,
        /// The time between samples, s.
        sample_s: f64,
    },
    /// Test for more than delay and lag; none where no lag was found.
    SecondOrder(Option<SecondOrderTest>),
    /// Other recordings that show it.
    OtherRecordings {
        /// How many.
        count: usize,
        /// Those whose intervals do not overlap, by file.
        apart: Vec<(String, Parameter)>,
    },
    /// Share of the frequencies at which the residual of the shaft is larger than noise explains.
    BeyondNoise(f64),
    /// The value if the time stamps were exact, which is another one.
    IfStampsWereExact(Parameter),
    /// The torque of the shaft is computed with J_d.
    ComputedWithInertia {
        /// J_d of the bench file, kg m².
        stated_kg_m2: f64,
        /// Its standard uncertainty, %.
        uncertainty_percent: f64,
        /// J_d where it is estimated together with the shaft.
        estimated: Option<Parameter>,
    },
    /// All recordings together.
    Together {
        /// How many.
        recordings: usize,
        /// True where they differ by more than their own intervals allow.
        apart: bool,
        /// The common value.
        parameter: Parameter,
    },
    /// No recording shows whether an inertia is true on a bench of this kind.
    NotChecked(BenchVariant),
    /// Recordings that show an inertia.
    Inertia {
        /// Their estimates.
        found: Vec<FoundInertia>,
        /// True where all of them agree with the bench file.
        agree: bool,
        /// The inertia of the bench file, kg m².
        stated_kg_m2: f64,
    },
    /// A skew is estimated with K and B, and has no second method.
    Skew,
    /// A delay is measured against T_d*.
    AgainstDemand(Source),
    /// Methods that estimate a delay.
    Methods {
        /// How many.
        count: usize,
        /// True where they agree; none where there is one alone.
        agree: Option<bool>,
    },
    /// How late a torque is against the moment at which the course of N_d bends.
    BesideBend {
        /// The torque.
        role: Role,
        /// How late.
        late: Parameter,
    },
    /// Friction from recordings with the shaft off.
    ShaftOff {
        /// The recordings.
        files: Vec<String>,
        /// True where it does not differ from zero by more than its interval.
        is_small: bool,
    },
    /// Friction is in the model, from recordings with the shaft off.
    InModel {
        /// The recordings.
        files: Vec<String>,
    },
    /// The recorded speeds do not show friction.
    SpeedsShowNone,
    /// Friction cannot be estimated.
    NoFriction(Vec<Reason>),
    /// Friction was not sought; this recording shows it.
    FrictionIn(String),
    /// With the shaft on, friction cannot be separated from engine torque.
    ShaftOn,
    /// No bench records the torque of the engine.
    NotRecorded {
        /// True where replays reconstruct it.
        replayed: bool,
    },
    /// The torque of the engine was rebuilt, best in this recording.
    Rebuilt {
        /// The recording.
        file: String,
        /// How certain it is.
        certainty: Certainty,
    },
    /// The torque of the engine cannot be rebuilt, for want of the masses.
    NoMasses(Vec<Reason>),
    /// No recording allows the torque of the engine to be rebuilt.
    NotRebuilt,
    /// The parameter that most of the uncertainty is owed to.
    UncertainBy {
        /// The parameter.
        parameter: ModelParameter,
        /// Its share of the variance.
        share: f64,
    },
    /// Sine tests away from engine orders; none where there are none.
    SineTests(Option<SineTests>),
    /// Standard uncertainties of the inertias that the interval contains, as parts of them; none of an exact one.
    Inertias {
        /// Of J_d.
        dyno: Option<f64>,
        /// Of J_e.
        engine: Option<f64>,
    },
    /// No recording was replayed that the estimates have not seen.
    NothingUnseen,
    /// A recording that was replayed.
    Replayed {
        /// The recording.
        file: String,
        /// Each signal with its fit, %.
        fits: Vec<(String, f64)>,
    },
    /// T_e, which drives a replay, is reconstructed from the same recording.
    ReplayHasItsEngine,
}

/// A stretch of a recording that something was estimated from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Source {
    /// Its length, s.
    pub duration_s: f64,
    /// The recording.
    pub file: String,
    /// The experiment, where it is known.
    pub label: Option<ExperimentLabel>,
}

/// An inertia as recordings show it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FoundInertia {
    /// The recording; none where it is all without shaft.
    pub file: Option<String>,
    /// The estimate.
    pub parameter: Parameter,
}

/// Gains that sine tests measured away from engine orders.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SineTests {
    /// How many.
    pub count: usize,
    /// How far they are from the model on average, as a part of it.
    pub mean_deviation: f64,
}
