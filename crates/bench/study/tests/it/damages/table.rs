//! The damages.

use rig::experiment::ExperimentPlan;
use virtual_bench::simulate;

use super::work::{
    ALL, CALC, CELL, DYNO_SPEED, ENGINE_SPEED, SHAFT, SPEED_DEMAND, SPEEDS, TORQUE_DEMAND, TORQUES, happens,
};
use super::{Brought, Damage, parameters};

/// lbf ft in Nm.
const POUND_FOOT_NM: f64 = 1.355_817_948_331_400_4;

fn damage(
    name: impl Into<String>,
    causes: &'static [&'static str],
    apply: impl Fn(&mut Brought) + Sync + 'static,
) -> Damage {
    Damage { name: name.into(), apply: Box::new(apply), causes, hidden: None }
}

pub(super) fn damages() -> Vec<Damage> {
    [units(), swaps(), signs(), clocks(), samples(), rasters(), filters(), labels(), bench(), torques()]
        .into_iter()
        .flatten()
        .collect()
}

fn units() -> Vec<Damage> {
    const SPEED: &[&str] = &["SpeedsDisagree", "ImplausibleMagnitude", "ImplausibleInertia"];
    const TORQUE: &[&str] = &["TorquesDisagree", "ImplausibleMagnitude"];
    let mut all = Vec::new();
    for (name, channels) in
        [("all speeds", &SPEEDS[..]), ("N_d", &SPEEDS[..1]), ("N_e", &SPEEDS[1..2]), ("N_d*", &SPEEDS[2..])]
    {
        all.push(damage(format!("unit: {name} in rpm labelled rad/s"), SPEED, move |b| b.unit(channels, "rad/s")));
        all.push(damage(format!("unit: {name} in Hz labelled rpm"), SPEED, move |b| b.scaled(channels, 1.0 / 60.0)));
    }
    all.push(damage("unit: N_e in rad/s labelled rpm", SPEED, |b| b.scaled(&[ENGINE_SPEED], 0.104_72)));
    for (name, channels) in [
        ("all torques", &TORQUES[..]),
        ("T_d*", &TORQUES[..1]),
        ("T_d,calc", &TORQUES[1..2]),
        ("T_d,meas", &TORQUES[2..3]),
    ] {
        let lbft: &'static [&'static str] = if channels.len() == 4 { &["ImplausibleInertia"] } else { TORQUE };
        all.push(damage(format!("unit: {name} in lbf ft labelled Nm"), lbft, move |b| {
            b.scaled(channels, 1.0 / POUND_FOOT_NM)
        }));
        all.push(damage(
            format!("unit: {name} in kNm labelled Nm"),
            if channels.len() == 4 { &["ImplausibleInertia"] } else { TORQUE },
            move |b| b.scaled(channels, 1e-3),
        ));
        all.push(damage(format!("unit: {name} in Nm labelled kNm"), TORQUE, move |b| b.unit(channels, "kNm")));
    }
    all.push(damage("unit: T_d* in % labelled Nm", TORQUE, |b| b.scaled(&[TORQUE_DEMAND], 0.25)));
    all
}

fn swaps() -> Vec<Damage> {
    let mut all = Vec::new();
    let pairs = ALL.iter().enumerate().flat_map(|(i, a)| ALL[i + 1..].iter().map(move |b| (*a, *b)));
    for (a, b) in pairs {
        let causes: &[&str] = match (a, b) {
            (DYNO_SPEED, ENGINE_SPEED) => &["SpeedsExchanged"],
            (CALC, CELL) => &["LateSignal"],
            _ => &[
                "SpeedsDisagree",
                "ImplausibleMagnitude",
                "TorquesDisagree",
                "Constant",
                "UnfitUnit",
                "WrongTorqueSign",
            ],
        };
        all.push(damage(format!("swap: {a} and {b}"), causes, move |brought| brought.swapped(a, b)));
    }
    all
}

fn signs() -> Vec<Damage> {
    const CAUSES: &[&str] = &["WrongTorqueSign", "SpeedsDisagree", "TorquesDisagree"];
    let one = |name: &'static str| damage(format!("sign: {name}"), CAUSES, move |b| b.scaled(&[name], -1.0));
    let mut all: Vec<Damage> = ALL.into_iter().map(one).collect();
    all.push(damage("sign: all torques", CAUSES, |b| b.scaled(&TORQUES, -1.0)));
    all.push(damage("sign: both speeds", CAUSES, |b| b.scaled(&SPEEDS, -1.0)));
    all
}

fn clocks() -> Vec<Damage> {
    const DRIFT: &[&str] = &["ClockDrift", "ClockOffset"];
    const RATE: &[&str] = &["ClockRate", "ClockDrift", "PulsesOffSpeed"];
    vec![
        damage("clock: ms as s", &["SlowRaster"], |b| b.times(&ALL, |t| 1000.0 * t)),
        damage("clock: all 1 % slow", RATE, |b| b.times(&ALL, |t| 1.01 * t)),
        damage("clock: all 1 % fast", RATE, |b| b.times(&ALL, |t| 0.99 * t)),
        damage("clock: all 100 ppm slow", RATE, |b| b.times(&ALL, |t| 1.0001 * t)),
        damage("clock: N_e 100 ppm slow", DRIFT, |b| b.times(&[ENGINE_SPEED], |t| 1.0001 * t)),
        damage("clock: N_e 1 % slow", DRIFT, |b| b.times(&[ENGINE_SPEED], |t| 1.01 * t)),
        damage("clock: torques 100 ppm slow", DRIFT, |b| b.times(&[CALC], |t| 1.0001 * t)),
        damage("clock: torques 1 % slow", DRIFT, |b| b.times(&[CALC], |t| 1.01 * t)),
        damage("clock: N_d and demands 1 % slow", DRIFT, |b| b.times(&[DYNO_SPEED], |t| 1.01 * t)),
        damage("clock: T_d,calc 8 ms late", &["LateSignal"], |b| b.times(&[CALC], |t| t + 0.008)),
        damage("clock: N_e 8 ms late", &["LateSignal"], |b| b.times(&[ENGINE_SPEED], |t| t + 0.008)),
        damage("clock: torques 0.5 s late", DRIFT, |b| b.times(&[CALC], |t| t + 0.5)),
        damage("clock: stamps repeated", &["TimeNotIncreasing"], |b| {
            b.times(&[DYNO_SPEED], |t| (t * 200.0).floor() / 200.0)
        }),
        damage("clock: jitter of 0.3 ms", &["Jitter"], |b| b.times(&[DYNO_SPEED], |t| t + 3e-4 * (1e4 * t).sin())),
    ]
}

/// Removes the samples of a time from a raster's channels; the stamps are closed up.
fn without_block(brought: &mut Brought, names: &[&str], from_s: f64, to_s: f64) {
    brought.resampled(names, |time_s, x| {
        let kept: Vec<f64> =
            time_s.iter().zip(x).filter(|(t, _)| !(from_s..to_s).contains(*t)).map(|(_, x)| *x).collect();
        (time_s[..kept.len()].to_vec(), kept)
    });
}

fn samples() -> Vec<Damage> {
    const REPEATS: &[&str] = &["SamplesRepeated"];
    const STUCK: &[&str] = &["SamplesRepeated"];
    const MISSING: &[&str] = &["BlockMissing", "ClockDrift"];
    const SPIKES: &[&str] = &["Spikes"];
    let mut all = vec![
        damage("samples: a block of 0.2 s missing in all, stamps closed up", MISSING, |b| {
            without_block(b, &ALL, 8.0, 8.2)
        }),
        damage("samples: a block of 0.2 s missing in N_e, stamps closed up", MISSING, |b| {
            without_block(b, &[ENGINE_SPEED], 8.0, 8.2)
        }),
        damage("samples: a block of 50 ms missing in N_d and demands, stamps closed up", MISSING, |b| {
            without_block(b, &[DYNO_SPEED, SPEED_DEMAND, TORQUE_DEMAND], 8.0, 8.05);
        }),
        damage("samples: a block of 0.2 s missing in torques, stamps closed up", MISSING, |b| {
            without_block(b, &[CALC, CELL, SHAFT], 8.0, 8.2)
        }),
    ];
    for name in [DYNO_SPEED, ENGINE_SPEED, TORQUE_DEMAND, CALC] {
        all.push(damage(format!("samples: {name} stuck for 1 s"), STUCK, move |b| {
            b.samples(&[name], |x| {
                let (from, to) = (x.len() / 3, x.len() / 3 + x.len() / 20);
                let value = x[from];
                x[from..to].fill(value);
            });
        }));
        all.push(damage(format!("samples: 30 % of {name} repeated"), REPEATS, move |b| {
            b.samples(&[name], |x| (1..x.len()).filter(|i| happens(*i, 0.3)).for_each(|i| x[i] = x[i - 1]));
        }));
        all.push(damage(format!("samples: spikes in {name}"), SPIKES, move |b| {
            b.samples(&[name], |x| (0..x.len()).filter(|i| happens(*i, 0.001)).for_each(|i| x[i] = 3.0 * x[i] + 100.0));
        }));
    }
    all.extend([
        damage("samples: spikes to zero in N_d", SPIKES, |b| {
            b.samples(&[DYNO_SPEED], |x| (0..x.len()).filter(|i| happens(*i, 0.001)).for_each(|i| x[i] = 0.0));
        }),
        damage("samples: NaN in 5 % of N_e", &["NotANumber"], |b| {
            b.samples(&[ENGINE_SPEED], |x| (0..x.len()).filter(|i| happens(*i, 0.05)).for_each(|i| x[i] = f64::NAN));
        }),
        damage("samples: NaN in 30 % of N_d", &["NotANumber"], |b| {
            b.samples(&[DYNO_SPEED], |x| (0..x.len()).filter(|i| happens(*i, 0.3)).for_each(|i| x[i] = f64::NAN));
        }),
        damage("samples: speeds in steps of 1 rpm", &["CoarseResolution"], |b| {
            b.samples(&SPEEDS, |x| x.iter_mut().for_each(|x| *x = x.round()))
        }),
        damage("samples: N_e in steps of 1 rpm", &["CoarseResolution"], |b| {
            b.samples(&[ENGINE_SPEED], |x| x.iter_mut().for_each(|x| *x = x.round()))
        }),
        damage("samples: torques in steps of 1 Nm", &["CoarseResolution"], |b| {
            b.samples(&TORQUES, |x| x.iter_mut().for_each(|x| *x = x.round()))
        }),
    ]);
    for name in [DYNO_SPEED, ENGINE_SPEED, TORQUE_DEMAND, CALC] {
        all.push(damage(format!("samples: {name} clipped"), &["Clipped", "TorquesDisagree"], move |b| {
            b.samples(&[name], |x| {
                let mut sorted = x.clone();
                sorted.sort_by(f64::total_cmp);
                let most = sorted[sorted.len() * 8 / 10];
                x.iter_mut().for_each(|x| *x = x.min(most));
            });
        }));
        all.push(damage(format!("samples: {name} constant"), &["Constant"], move |b| {
            b.samples(&[name], |x| {
                let value = x[0];
                x.fill(value);
            })
        }));
    }
    all
}

fn rasters() -> Vec<Damage> {
    const HELD: &[&str] = &["SamplesRaised", "SamplesStraightened", "SamplesRepeated"];
    const SLOW: &[&str] = &["SlowRaster"];
    let mut all = Vec::new();
    for (way, interpolates) in [("held", false), ("interpolated", true)] {
        all.push(damage(format!("raster: N_e {way} to 1 kHz"), HELD, move |b| {
            b.raised(&[ENGINE_SPEED], 1e-3, interpolates)
        }));
        all.push(damage(format!("raster: torques {way} to 1 kHz"), HELD, move |b| {
            b.raised(&[CALC, CELL, SHAFT], 1e-3, interpolates)
        }));
        all.push(damage(format!("raster: all {way} to 1 kHz"), HELD, move |b| {
            b.raised(&[ENGINE_SPEED, CALC, CELL, SHAFT], 1e-3, interpolates)
        }));
        all.push(damage(format!("raster: all at 250 Hz {way} to 1 kHz"), HELD, move |b| {
            b.thinned(&ALL, 4e-3);
            b.raised(&ALL, 1e-3, interpolates);
        }));
        all.push(damage(format!("raster: N_d at 500 Hz {way} to 1 kHz"), HELD, move |b| {
            b.thinned(&[DYNO_SPEED], 2e-3);
            b.raised(&[DYNO_SPEED], 1e-3, interpolates);
        }));
        all.push(damage(format!("raster: N_e at 300 Hz {way} to 1 kHz"), HELD, move |b| {
            b.raised(&[ENGINE_SPEED], 1.0 / 300.0, true);
            b.raised(&[ENGINE_SPEED], 1e-3, interpolates);
        }));
    }
    all.push(damage("raster: N_d at 500 Hz", SLOW, |b| b.thinned(&[DYNO_SPEED], 2e-3)));
    all.push(damage("raster: all at 100 Hz without a filter", SLOW, |b| b.thinned(&ALL, 0.01)));
    all.push(damage("raster: N_e at 100 Hz without a filter", SLOW, |b| b.thinned(&[ENGINE_SPEED], 0.01)));
    all.push(damage("raster: torques at 20 Hz without a filter", SLOW, |b| b.thinned(&[CALC, CELL, SHAFT], 0.05)));
    all
}

fn filters() -> Vec<Damage> {
    const FILTER: &[&str] = &["SamplesFiltered", "LateSignal"];
    let mut all = Vec::new();
    for (name, channels) in
        [("N_d", &ALL[..1]), ("N_e", &ALL[1..2]), ("T_d,calc", &ALL[4..5]), ("T_d*", &ALL[3..4]), ("all", &ALL[..])]
    {
        for cutoff_hz in [20.0, 60.0, 100.0] {
            all.push(damage(format!("filter: {name} below {cutoff_hz} Hz"), FILTER, move |b| {
                b.filtered(channels, 2, cutoff_hz)
            }));
        }
    }
    all
}

fn labels() -> Vec<Damage> {
    const LABEL: &[&str] = &["LabelContradicted", "Constant"];
    vec![
        damage("label: BS named WhiteNoise_T_TN", LABEL, |b| b.renamed("BS", "WhiteNoise_T_TN_2.mf4")),
        damage("label: WhiteNoise named BS_T_NT", LABEL, |b| b.renamed("White", "BS_T_NT_2.mf4")),
        damage("label: WhiteNoise and BS exchanged", LABEL, |b| b.exchanged("White", "BS")),
        damage("label: Step named BS_T_NT", LABEL, |b| {
            b.recordings.retain(|(file, _)| !file.starts_with("BS"));
            b.renamed("Step", "BS_T_NT.mf4");
        }),
        damage("label: Ramp named NoShaft_N_NT", LABEL, |b| {
            b.recordings.retain(|(file, _)| !file.starts_with("NoShaft"));
            b.renamed("Ramp", "NoShaft_N_NT.mf4");
        }),
        damage("label: Ramp named NoShaft_N_NT without N_e", LABEL, |b| {
            b.recordings.retain(|(file, _)| !file.starts_with("NoShaft"));
            b.renamed("Ramp", "NoShaft_N_NT.mf4");
            b.file("NoShaft").1.channels.retain(|channel| channel.name != ENGINE_SPEED && channel.name != SHAFT);
        }),
        damage("label: Ramp named BS_T_NT", LABEL, |b| {
            b.recordings.retain(|(file, _)| !file.starts_with("BS"));
            b.renamed("Ramp", "BS_T_NT.mf4");
        }),
        damage("label: BS named Levels_N_NT", LABEL, |b| {
            b.recordings.retain(|(file, _)| !file.starts_with("Levels"));
            b.renamed("BS", "Levels_N_NT.mf4");
        }),
        damage("label: NoShaft named Ramp_N_NT", LABEL, |b| {
            b.recordings.retain(|(file, _)| !file.starts_with("Ramp"));
            b.renamed("NoShaft", "Ramp_N_NT.mf4");
        }),
        damage("label: BS_T_TN for BS_T_NT", LABEL, |b| b.renamed("BS", "BS_T_TN.mf4")),
        damage("label: WhiteNoise_T_NT for WhiteNoise_T_TN", LABEL, |b| b.renamed("White", "WhiteNoise_T_NT.mf4")),
        damage("label: Levels_N_TN for Levels_N_NT", LABEL, |b| b.renamed("Levels", "Levels_N_TN.mf4")),
    ]
}

fn bench() -> Vec<Damage> {
    const FIRING: &[&str] = &["FiringOrderDisagrees"];
    const INERTIA: &[&str] = &["ImplausibleInertia"];
    let mut all = Vec::new();
    for cylinders in [0, 2, 3, 5, 6, 8] {
        all.push(damage(format!("bench: {cylinders} cylinders"), FIRING, move |b| b.bench.cylinders = cylinders));
    }
    all.push(damage("bench: 2 strokes", FIRING, |b| b.bench.strokes = 2));
    for percent in [-10.0, 10.0] {
        all.push(damage(format!("bench: J_d {percent:+} %"), INERTIA, move |b| {
            b.bench.dynamometer_inertia_kg_m2 *= 1.0 + 0.01 * percent
        }));
        all.push(damage(format!("bench: J_e {percent:+} %"), INERTIA, move |b| {
            b.bench.engine_inertia_kg_m2 *= 1.0 + 0.01 * percent
        }));
    }
    all.push(damage("bench: inertias exchanged", INERTIA, |b| {
        let file = &mut b.bench;
        std::mem::swap(&mut file.dynamometer_inertia_kg_m2, &mut file.engine_inertia_kg_m2);
    }));
    let other = |b: &mut Brought, all: bool| {
        let mut parameters = parameters();
        parameters.mechanics.shaft_stiffness_nm_per_rad *= 1.5;
        parameters.controller.proportional_nm_s_per_rad *= 1.3;
        if all {
            parameters.mechanics.engine_inertia_kg_m2 *= 1.4;
        }
        let plan = ExperimentPlan::white_noise_t_tn(1230.0, 20.0);
        b.file("White").1 = simulate(&parameters, &plan, 5).unwrap();
        let plan = ExperimentPlan::levels_n_nt(1230.0, 20.0);
        b.file("Levels").1 = simulate(&parameters, &plan, 6).unwrap();
    };
    all.push(damage("bench: white noise and levels of another shaft and controller", &["RoutesDisagree"], move |b| {
        other(b, false)
    }));
    all.push(damage(
        "bench: white noise and levels of another shaft, controller and engine",
        &["RoutesDisagree"],
        move |b| other(b, true),
    ));
    all
}

fn torques() -> Vec<Damage> {
    const TORQUE: &[&str] = &["TorquesDisagree"];
    let offset = |names: &'static [&'static str]| {
        move |b: &mut Brought| b.samples(names, |x| x.iter_mut().for_each(|x| *x += 10.0))
    };
    vec![
        damage("torque: all gains 0.9", &["ImplausibleInertia"], |b| b.scaled(&TORQUES, 0.9)),
        damage("torque: T_d,calc gain 0.9", TORQUE, |b| b.scaled(&[CALC], 0.9)),
        damage("torque: T_d* gain 0.9", TORQUE, |b| b.scaled(&[TORQUE_DEMAND], 0.9)),
        damage("torque: T_d,meas gain 0.9", TORQUE, |b| b.scaled(&[CELL], 0.9)),
        damage("torque: T_d,calc 10 Nm off", TORQUE, offset(&[CALC])),
        damage("torque: T_d* 10 Nm off", TORQUE, offset(&[TORQUE_DEMAND])),
        damage("torque: T_d,meas 10 Nm off", TORQUE, offset(&[CELL])),
        damage("speed: N_d gain 1.01", &["SpeedsDisagree", "PulsesOffSpeed"], |b| b.scaled(&[DYNO_SPEED], 1.01)),
        damage("speed: N_e gain 1.01", &["SpeedsDisagree", "PulsesOffSpeed"], |b| b.scaled(&[ENGINE_SPEED], 1.01)),
        damage("speed: N_e gain 1.001", &["SpeedsDisagree", "PulsesOffSpeed"], |b| b.scaled(&[ENGINE_SPEED], 1.001)),
        damage("speed: all speeds gain 1.01", &["SpeedsDisagree", "PulsesOffSpeed"], |b| b.scaled(&SPEEDS, 1.01)),
    ]
}
