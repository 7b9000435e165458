//! The method's table, and multisines. Defaults are the levels and times of the thesis' bench.

use std::ops::RangeInclusive;

use signal::excitation::{Multisine, Phases, Timing};
use units::RPM_RAD_S;

use super::parameter::DURATION;
use super::parameter::SETTLING;
use super::parameter::SPEED;
use super::parameter::{SPEED_RPM, TIME_S, TORQUE_NM, parameter};
use super::{CatalogueError, Settings};
use crate::experiment::catalogue::parameter::Parameter;
use crate::experiment::catalogue::template::Template;
use crate::experiment::{ControlMode, DEMAND_HOLD_S, Excitation, ExperimentPlan, Test, UPDATE_S, Waveform};

/// Sines of a multisine that are still optimised; each costs time.
const MOST_LINES: usize = 5000;

const ENGINE_TORQUE: Parameter = parameter("torque", "Nm", 60.0, TORQUE_NM, "torque demanded of the engine");
const MEAN_TORQUE: Parameter = parameter("mean", "Nm", 60.0, TORQUE_NM, "mean of the dynamometer's torque demand");
const SWITCHING: Parameter =
    parameter("clock", "s", 0.08, TIME_S, "a level lasts this long or a multiple; not less than a firing");
const PERIOD: Parameter = parameter("period", "s", 10.0, 0.1..=1000.0, "period; its inverse is the resolution in Hz");
const SINES_RMS: &str = "root mean square of the sines together";
const ROUNDS: Parameter = parameter(
    "rounds",
    "",
    200.0,
    0.0..=5000.0,
    "rounds in which the phases are optimised for low peaks; 0: Schroeder's phases",
);

pub(super) const OPTIMAL: &[Parameter] = &[
    Parameter { meaning: "speed at which the bench is excited", ..SPEED },
    Parameter { default: 20.0, ..DURATION },
    SETTLING,
    Parameter { meaning: "mean of the dynamometer's torque demand, in speed control of the engine's", ..ENGINE_TORQUE },
];

/// The parameters of a multisine: its torque, its root mean square, its band unless another is given, and the highest
/// frequency that the clock of the demand allows.
const fn multisine_parameters(
    torque: Parameter,
    rms: Parameter,
    band_hz: RangeInclusive<f64>,
    limit_hz: f64,
    highest_means: &'static str,
) -> [Parameter; 6] {
    [
        torque,
        rms,
        parameter("lowest", "Hz", *band_hz.start(), 0.001..=limit_hz, "lowest frequency"),
        parameter("highest", "Hz", *band_hz.end(), 0.001..=limit_hz, highest_means),
        PERIOD,
        ROUNDS,
    ]
}

pub(super) const ALL: &[Template] = &[
    Template {
        test: Test::Bs,
        excitation: Excitation::Torque,
        mode: ControlMode::Nt,
        demands: "constant N_d*; engine torque switched at random between two ignition angles",
        gives: "speed controller with its feed-forward inactive; shaft",
        duration_s: 60.0,
        own: &[
            parameter("low", "Nm", 35.0, TORQUE_NM, "engine torque at one ignition angle"),
            parameter("high", "Nm", 55.0, TORQUE_NM, "engine torque at the other"),
            SWITCHING,
        ],
        build: |s| {
            let mut plan = ExperimentPlan::bs_t_nt(s.get("speed"), s.get("duration"));
            plan.engine_torque_nm =
                Waveform::RandomBinary { low: s.get("low"), high: s.get("high"), clock_s: s.get("clock") };
            Ok(plan)
        },
    },
    Template {
        test: Test::WhiteNoise,
        excitation: Excitation::Torque,
        mode: ControlMode::Tn,
        demands: "white T_d*, drawn anew every 10 ms",
        gives: "torque control, delays, shaft",
        duration_s: 60.0,
        own: &[
            MEAN_TORQUE,
            parameter("deviation", "Nm", 12.0, 0.0..=20_000.0, "standard deviation of the torque demand"),
        ],
        build: |s| {
            let mut plan = ExperimentPlan::white_noise_t_tn(s.get("speed"), s.get("duration"));
            plan.dyno_torque_nm = Waveform::WhiteNoise { mean: s.get("mean"), standard_deviation: s.get("deviation") };
            Ok(plan)
        },
    },
    Template {
        test: Test::Step,
        excitation: Excitation::Torque,
        mode: ControlMode::Tn,
        demands: "steps of T_d* between two levels",
        gives: "delays of every torque signal",
        duration_s: 20.0,
        own: &[
            parameter("first", "Nm", 60.0, TORQUE_NM, "torque demand at the start"),
            parameter("second", "Nm", 85.0, TORQUE_NM, "torque demand after the first step"),
            parameter("dwell", "s", 2.0, TIME_S, "time at each level"),
        ],
        build: |s| {
            let mut plan = ExperimentPlan::step_t_tn(s.get("speed"), s.get("duration"));
            plan.dyno_torque_nm =
                Waveform::Square { first: s.get("first"), second: s.get("second"), dwell_s: s.get("dwell") };
            Ok(plan)
        },
    },
    Template {
        test: Test::Ramp,
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        demands: "N_d* ramps up and down between two levels",
        gives: "feed-forward; shows that PI alone is not enough",
        duration_s: 40.0,
        own: &[
            ENGINE_TORQUE,
            parameter("rise", "rpm", 800.0, SPEED_RPM, "upper level above the speed"),
            parameter("start", "s", 2.0, 0.0..=1000.0, "start of the first ramp"),
            parameter("ramp", "s", 3.0, TIME_S, "length of a ramp"),
            parameter("dwell", "s", 5.0, TIME_S, "rest at each level"),
        ],
        build: |s| {
            let mut plan = ExperimentPlan::ramp_n_nt(s.get("speed"), s.get("duration"));
            plan.speed_rad_s = Waveform::Ramps {
                low: s.get("speed") * RPM_RAD_S,
                high: (s.get("speed") + s.get("rise")) * RPM_RAD_S,
                first_s: s.get("start"),
                ramp_s: s.get("ramp"),
                dwell_s: s.get("dwell"),
            };
            Ok(with_engine_torque(plan, s))
        },
    },
    Template {
        test: Test::Levels,
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        demands: "N_d* over many random levels, approached with random slopes",
        gives: "feed-forward with confidence, terms like friction",
        duration_s: 60.0,
        own: &[
            ENGINE_TORQUE,
            parameter("range", "rpm", 1800.0, 0.0..=20_000.0, "highest level above the speed"),
            parameter("dwell", "s", 3.0, TIME_S, "time from one level to the next"),
            parameter("lowest_slope", "rpm/s", 100.0, 0.1..=1e5, "slowest approach"),
            parameter("highest_slope", "rpm/s", 1000.0, 0.1..=1e5, "fastest approach"),
        ],
        build: levels,
    },
    Template {
        test: Test::Unfired,
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        demands: "motored engine; N_d* switched at random about the speed",
        gives: "K, B and inertias without firing (ARMAX from T_d to the speed)",
        duration_s: 60.0,
        own: &[
            parameter("swing", "rpm", 12.0, 0.0..=5000.0, "speed demand below and above the speed"),
            parameter("clock", "s", 0.08, TIME_S, "a level lasts this long or a multiple"),
        ],
        build: |s| {
            let mut plan = ExperimentPlan::unfired_n_nt(s.get("speed"), s.get("duration"));
            plan.speed_rad_s = Waveform::RandomBinary {
                low: (s.get("speed") - s.get("swing")) * RPM_RAD_S,
                high: (s.get("speed") + s.get("swing")) * RPM_RAD_S,
                clock_s: s.get("clock"),
            };
            Ok(plan)
        },
    },
    Template {
        test: Test::Sine,
        excitation: Excitation::Torque,
        mode: ControlMode::Tn,
        demands: "sines of T_d*, one frequency after another, each for an equal share of the time",
        gives: "gain from T_d to T_shaft at each frequency",
        duration_s: 60.0,
        own: &[
            MEAN_TORQUE,
            parameter("amplitude", "Nm", 8.0, 0.0..=20_000.0, "amplitude of each sine"),
            parameter("lowest", "Hz", 1.0, 0.01..=45.0, "first frequency"),
            parameter("highest", "Hz", 20.0, 0.01..=45.0, "last frequency"),
            parameter("step", "Hz", 1.0, 0.01..=45.0, "from one frequency to the next"),
        ],
        build: sine,
    },
    Template {
        test: Test::NoShaft,
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        demands: "shaft off; steps of N_d*",
        gives: "friction of the dynamometer, J_d, speed control without a load",
        duration_s: 18.0,
        own: &[
            parameter("rise", "rpm", 150.0, SPEED_RPM, "upper level above the speed"),
            parameter("dwell", "s", 3.0, TIME_S, "time at each level"),
        ],
        build: |s| {
            let mut plan = ExperimentPlan::no_shaft_n_nt(s.get("speed"), s.get("duration"));
            plan.speed_rad_s = Waveform::Square {
                first: s.get("speed") * RPM_RAD_S,
                second: (s.get("speed") + s.get("rise")) * RPM_RAD_S,
                dwell_s: s.get("dwell"),
            };
            Ok(plan)
        },
    },
    Template {
        test: Test::Multisine,
        excitation: Excitation::Torque,
        mode: ControlMode::Tn,
        demands: "sines of T_d* at once, period after period",
        gives: "frequency response of torque control and shaft, free of leakage; shaft",
        duration_s: 60.0,
        own: &multisine_parameters(
            MEAN_TORQUE,
            parameter("rms", "Nm", 12.0, 0.0..=20_000.0, SINES_RMS),
            0.5..=40.0,
            49.0,
            "highest frequency; demands change every 10 ms",
        ),
        build: |s| {
            let dyno_torque_nm = multisine(s, DEMAND_HOLD_S, s.get("mean"), 1.0)?;
            let plan = ExperimentPlan::step_t_tn(s.get("speed"), s.get("duration"));
            Ok(ExperimentPlan { dyno_torque_nm, ..renamed(plan, Test::Multisine) })
        },
    },
    Template {
        test: Test::Multisine,
        excitation: Excitation::Speed,
        mode: ControlMode::Nt,
        demands: "sines of N_d* at once, period after period",
        gives: "frequency response of the speed loop, free of leakage; feed-forward",
        duration_s: 60.0,
        own: &multisine_parameters(
            ENGINE_TORQUE,
            parameter("rms", "rpm", 10.0, 0.0..=5000.0, SINES_RMS),
            0.2..=10.0,
            400.0,
            "highest frequency; demands change every 1 ms",
        ),
        build: |s| {
            let speed_rad_s = multisine(s, UPDATE_S, s.get("speed"), RPM_RAD_S)?;
            let plan = ExperimentPlan::ramp_n_nt(s.get("speed"), s.get("duration"));
            Ok(with_engine_torque(ExperimentPlan { speed_rad_s, ..renamed(plan, Test::Multisine) }, s))
        },
    },
];

fn with_engine_torque(plan: ExperimentPlan, s: &Settings) -> ExperimentPlan {
    ExperimentPlan { engine_torque_nm: Waveform::Constant { value: s.get("torque") }, ..plan }
}

fn renamed(mut plan: ExperimentPlan, test: Test) -> ExperimentPlan {
    plan.label.test = test;
    plan
}

fn ordered(s: &Settings, lower: &str, upper: &str) -> Result<(f64, f64), CatalogueError> {
    let (low, high) = (s.get(lower), s.get(upper));
    if low <= high {
        return Ok((low, high));
    }
    Err(CatalogueError::Contradiction { what: format!("{lower} = {low} lies above {upper} = {high}") })
}

fn levels(s: &Settings) -> Result<ExperimentPlan, CatalogueError> {
    let (lowest, highest) = ordered(s, "lowest_slope", "highest_slope")?;
    let mut plan = ExperimentPlan::levels_n_nt(s.get("speed"), s.get("duration"));
    plan.speed_rad_s = Waveform::RandomLevels {
        low: s.get("speed") * RPM_RAD_S,
        high: (s.get("speed") + s.get("range")) * RPM_RAD_S,
        dwell_s: s.get("dwell"),
        lowest_slope_per_s: lowest * RPM_RAD_S,
        highest_slope_per_s: highest * RPM_RAD_S,
    };
    Ok(with_engine_torque(plan, s))
}

fn sine(s: &Settings) -> Result<ExperimentPlan, CatalogueError> {
    let (lowest, highest) = ordered(s, "lowest", "highest")?;
    let count = ((highest - lowest) / s.get("step") + 1e-9).floor() as usize + 1;
    let mut plan = ExperimentPlan::sine_t_tn(s.get("speed"), s.get("duration"));
    plan.dyno_torque_nm = Waveform::SineLadder {
        mean: s.get("mean"),
        amplitude: s.get("amplitude"),
        frequencies_hz: (0..count).map(|n| lowest + n as f64 * s.get("step")).collect(),
        dwell_s: s.get("duration") / count as f64,
    };
    Ok(plan)
}

/// One period of mean + multisine on a clock, times a factor.
fn multisine(s: &Settings, clock_s: f64, mean: f64, factor: f64) -> Result<Waveform, CatalogueError> {
    let (lowest, highest) = ordered(s, "lowest", "highest")?;
    let period = (s.get("period") / clock_s).round() as usize;
    let period_s = period as f64 * clock_s;
    let harmonics: Vec<usize> =
        ((lowest * period_s - 1e-9).ceil().max(1.0) as usize..=(highest * period_s + 1e-9).floor() as usize).collect();
    if harmonics.is_empty() || harmonics.len() > MOST_LINES {
        let what = format!(
            "a period of {period_s} s has {} lines from {lowest} to {highest} Hz, where 1 to {MOST_LINES} are possible; \
             change period, lowest or highest",
            harmonics.len()
        );
        return Err(CatalogueError::Contradiction { what });
    }
    let phases = match s.get("rounds") as usize {
        0 => Phases::Schroeder,
        iterations => Phases::LowCrest { iterations },
    };
    let timing = Timing { sample_time_s: clock_s, length: period };
    let sines = Multisine::flat(period, harmonics, s.get("rms"), phases).generate(timing)?;
    let values = sines.samples.iter().map(|x| (mean + x) * factor).collect();
    Ok(Waveform::Periodic { sample_time_s: clock_s, values })
}
