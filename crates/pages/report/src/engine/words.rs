//! The engine's torque, in words and figures.

use page::{Abscissa, Axis, Figure, Layer, Panel, Style, rounded};
use part_engine::{
    Certainty, Cycle, Cycles, Cylinder, Cylinders, EngineRecording, EngineTorque, InertiaSource, Order, Profile,
    RebuiltEngine, TwoMasses,
};
use part_torque::torque_smoother::TorqueSource;
use rig::results::Outcome;

use crate::figures::{BAND, HEIGHT};
use crate::wording::{self, number};

/// Working cycles of which the torque is drawn.
const SHOWN_CYCLES: f64 = 3.0;
/// How much of the torque is drawn where cycles cannot be separated, s.
const SHOWN_S: f64 = 0.25;
/// Cycles whose means are drawn: more of them cover each other.
const DRAWN_CYCLES: usize = 75;
/// Cylinders that differ so little by chance are alike.
const LEVEL: f64 = 0.01;

/// Masses with which the torque is rebuilt, in words.
pub fn masses(masses: &TwoMasses) -> String {
    let inertia = masses.values[masses.values.len() - 1];
    let deviation = masses.covariance.last().and_then(|row| row.last()).map_or(0.0, |v| v.sqrt());
    let from = match &masses.inertia_from {
        InertiaSource::Estimated(file) => {
            format!("J_e = {} from {file}", number::plus_minus(inertia, BAND * deviation, "kg m²"))
        }
        InertiaSource::BenchFile => format!(
            "J_e = {} from the bench file; a wide-band T_d* in torque control (WhiteNoise_T_TN) shows it better",
            number::plus_minus(inertia, BAND * deviation, "kg m²")
        ),
    };
    format!("Shaft from {}; {from}.", masses.shaft_from)
}

/// How the engine's torque was rebuilt, and how certain it is.
pub fn rebuilt(certainty: &Certainty) -> String {
    let from = match certainty.torque {
        TorqueSource::Modelled => "T_d* through the torque control",
        TorqueSource::Calculated => "T_d,calc",
    };
    let newton_metres = |value: f64| number::significant_with_unit(value, 2, "Nm");
    let doubt = crate::torque::doubt(certainty.widening, certainty.converged);
    format!(
        "known to ±{} (95 %, half of the time better), ±{} of it from shaft and inertias; computed from N_d, N_e and {from}. A once-a-turn \
         error of the engine's encoder is unknown: each 0.01 % of it adds {} at order 1. Bearing friction of the \
         dynamometer counts as engine torque{doubt}",
        newton_metres(certainty.half_width_nm),
        newton_metres(certainty.of_masses_nm),
        newton_metres(certainty.once_a_turn_nm),
    )
}

/// The cycles in a sentence.
pub fn cycles(cycles: &Cycles) -> String {
    let count = cycles.cycles.len() as f64;
    let mean = cycles.cycles.iter().map(|cycle| cycle.mean_nm).sum::<f64>() / count;
    let each: Vec<f64> = cycles.cycles.iter().map(|cycle| cycle.standard_deviation_nm).collect();
    let variation = match cycles.variation_nm > 0.0 {
        true => format!("by {} (standard deviation)", number::significant_with_unit(cycles.variation_nm, 2, "Nm")),
        false => "no more than that".to_owned(),
    };
    format!(
        "{} cycles of {} on average, each known to ±{} (noise only, without masses and shaft); from one to the next they vary {variation}",
        cycles.cycles.len(),
        number::significant_with_unit(mean, 3, "Nm"),
        number::significant_with_unit(BAND * median(&each), 2, "Nm"),
    )
}

/// Verdict on differences between cylinders.
pub fn cylinders(cylinders: &Cylinders) -> String {
    let by_chance = |probability: f64| match probability < 1e-6 {
        true => "below 10⁻⁶".to_owned(),
        false => number::significant(probability, 2),
    };
    let turn = &cylinders.once_a_turn;
    let of_turn = format!(
        "{} of it (root mean square) repeats with every turn, as an encoder error of {} would; the encoder's part \
         grows with the square of the speed, so a recording at another speed decides",
        number::significant_with_unit(turn.rms_nm, 2, "Nm"),
        number::significant_with_unit(100.0 * turn.encoder_error, 2, "%"),
    );
    match (cylinders.alike_probability < LEVEL, turn.alike_probability) {
        (false, _) => {
            format!("no difference between cylinders is found (probability {})", by_chance(cylinders.alike_probability))
        }
        (true, Some(beyond)) if beyond < LEVEL => format!(
            "the cylinders differ (by chance with probability {}); {of_turn}; which of them is the first to fire is not recorded",
            by_chance(beyond)
        ),
        (true, _) => format!("a difference between cylinders cannot be separated from the encoder: {of_turn}"),
    }
}

/// How the cylinders' parts are cut, and what their intervals hold.
pub const CUT: &str = "A cylinder's part lasts from one trough of the firing order to the next, as no mark shows top \
    dead centre. It therefore contains torque of the neighbouring cylinders. The ± (95 %) contains noise and a \
    once-a-turn error of the engine's encoder: as large as the torque that repeats with every turn, and at least \
    0.01 %";

/// A cylinder's row: place in the order of firing, mean torque less the cycle's with its interval, scatter.
pub fn cylinder_rows(cylinders: &Cylinders) -> Vec<[String; 3]> {
    let row = |(place, c): (usize, &Cylinder)| {
        [
            (place + 1).to_string(),
            number::plus_minus(c.apart_nm, BAND * c.whole_error_nm(), "Nm"),
            number::significant_with_unit(c.variation_nm, 2, "Nm"),
        ]
    };
    cylinders.cylinders.iter().enumerate().map(row).collect()
}

fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(f64::NAN)
}

/// Of every recording: some cycles over time, the torque over the crank's angle, cycle by cycle, cylinders, orders.
pub fn figures(found: &EngineTorque) -> Vec<Figure> {
    found.recordings.iter().flat_map(figures_of).collect()
}

/// Those of one recording.
pub fn figures_of(recording: &EngineRecording) -> Vec<Figure> {
    let Outcome::Estimated(engine) = &recording.engine else { return Vec::new() };
    let mut all = vec![over_time(&recording.file, engine, recording.cycles.estimated())];
    match &recording.cycles {
        Outcome::NotEstimated { needs: why } => {
            let last = all.len() - 1;
            all[last].caption.push_str(&format!(" Cycles and cylinders: {}.", wording::reasons(why)));
        }
        Outcome::Estimated(found) => all.extend([
            over_angle(&recording.file, found, &found.profile),
            by_cycle(&recording.file, found),
            by_cylinder(&recording.file, found),
            by_order(&recording.file, found),
        ]),
    }
    all
}

fn over_time(file: &str, engine: &RebuiltEngine, cycles: Option<&Cycles>) -> Figure {
    let cycle_s = cycles.map(|found| median(&found.cycles.iter().map(|c| c.duration_s).collect::<Vec<_>>()));
    let shown_s = cycle_s.map_or(SHOWN_S, |cycle_s| SHOWN_CYCLES * cycle_s);
    let count = ((shown_s / engine.sample_time_s) as usize).min(engine.smoothed_nm.len());
    let from = (engine.smoothed_nm.len() - count) / 2;
    let shown = from..from + count;
    let clock = (engine.start_s + from as f64 * engine.sample_time_s, engine.sample_time_s);
    let (smoothed, deviation) = (&engine.smoothed_nm[shown.clone()], &engine.standard_deviation_nm[shown.clone()]);
    let end = |sign: f64| -> Vec<f64> { smoothed.iter().zip(deviation).map(|(t, s)| t + sign * BAND * s).collect() };
    let band = Layer::Band {
        name: "95 % band of the smoother".to_owned(),
        style: Style::Modelled,
        x: Abscissa::Uniform { start: clock.0, step: clock.1, skip: None },
        low: rounded(&end(-1.0)),
        high: rounded(&end(1.0)),
    };
    let layers = vec![
        band,
        Layer::trace("filter without phase shift, to 120 Hz", Style::Measured, clock, &engine.zero_phase_nm[shown]),
        Layer::trace("smoother", Style::Modelled, clock, smoothed),
    ];
    Figure::new(
        &format!("{file}: engine torque rebuilt"),
        Axis::time(),
        vec![Panel::new(Axis::linear("T_e", "Nm"), HEIGHT, layers)],
    )
    .with_caption(format!("{} of it, from the middle; {}.", number::duration(shown_s), rebuilt(&engine.certainty())))
    .of_recording(file)
}

fn over_angle(file: &str, cycles: &Cycles, profile: &Profile) -> Figure {
    let end = |sign: f64| -> Vec<f64> {
        profile.mean_nm.iter().zip(&profile.deviation_nm).map(|(t, s)| t + sign * s).collect()
    };
    let clock = (0.0, profile.step_deg);
    let layers = vec![
        Layer::Band {
            name: "one standard deviation from cycle to cycle".to_owned(),
            style: Style::Modelled,
            x: Abscissa::Uniform { start: clock.0, step: clock.1, skip: None },
            low: rounded(&end(-1.0)),
            high: rounded(&end(1.0)),
        },
        Layer::trace("mean of all cycles", Style::Modelled, clock, &profile.mean_nm),
    ];
    Figure::new(
        &format!("{file}: engine torque over the crank's angle"),
        Axis::linear("angle from a trough of the firing order", "°"),
        vec![Panel::new(Axis::linear("T_e", "Nm"), HEIGHT, layers)],
    )
    .with_caption(format!("{}.", self::cycles(cycles)))
}

fn by_cycle(file: &str, cycles: &Cycles) -> Figure {
    let middle = |c: &Cycle| (c.start_s + 0.5 * c.duration_s, c.mean_nm, c.standard_deviation_nm);
    let count = cycles.cycles.len();
    let drawn = count.min(DRAWN_CYCLES);
    let shown = cycles.cycles.iter().skip((count - drawn) / 2).take(drawn);
    let layer = bars("mean of a cycle, 95 % by noise", shown.map(middle));
    let panel = Panel::new(Axis::linear("T_e of a cycle", "Nm"), HEIGHT, vec![layer]);
    let figure =
        Figure::new(&format!("{file}: engine torque cycle by cycle"), Axis::time(), vec![panel]).of_recording(file);
    let caption = match drawn < count {
        true => format!("{drawn} of {count} cycles, from the middle, with 95 % intervals by noise."),
        false => "With 95 % intervals by noise.".to_owned(),
    };
    figure.with_caption(caption)
}

fn by_cylinder(file: &str, cycles: &Cycles) -> Figure {
    let all = &cycles.cylinders.cylinders;
    let row = |(place, c): (usize, &Cylinder)| ((place + 1) as f64, c.apart_nm, c.whole_error_nm());
    let layer = bars("mean over the cylinder's part, 95 %", all.iter().enumerate().map(row));
    let panel = Panel::new(Axis::linear("T_e less the cycle's mean", "Nm"), HEIGHT, vec![layer]);
    let axis = Axis::linear("place in the order of firing", "").within(0.5, all.len() as f64 + 0.5);
    Figure::new(&format!("{file}: engine torque cylinder by cylinder"), axis, vec![panel])
        .with_caption(format!("{}. {CUT}.", cylinders(&cycles.cylinders)))
}

fn by_order(file: &str, cycles: &Cycles) -> Figure {
    let row = |o: &Order| (o.order, o.amplitude_nm, o.standard_error_nm);
    let layer = bars("amplitude common to all cycles, 95 %", cycles.orders.iter().map(row));
    let panel = Panel::new(Axis::linear("amplitude", "Nm"), HEIGHT, vec![layer]);
    Figure::new(
        &format!("{file}: orders of the engine torque"),
        Axis::linear("order of the crankshaft", ""),
        vec![panel],
    )
}

/// Dots with 95 % bars, from place, value and standard error.
fn bars(name: &str, rows: impl Iterator<Item = (f64, f64, f64)>) -> Layer {
    let rows: Vec<(f64, f64, f64)> = rows.collect();
    let column = |of: &dyn Fn(&(f64, f64, f64)) -> f64| rounded(&rows.iter().map(of).collect::<Vec<f64>>());
    Layer::Points {
        name: name.to_owned(),
        style: Style::Modelled,
        x: Abscissa::Values(column(&|r| r.0)),
        y: column(&|r| r.1),
        low: Some(column(&|r| r.1 - BAND * r.2)),
        high: Some(column(&|r| r.1 + BAND * r.2)),
    }
}
