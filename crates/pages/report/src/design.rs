//! An experiment that is to be run: what it teaches, its demands, their spectrum, what the bench will do.

use bench_model::prediction::Prediction;
use design::excitation_design::{DesignedExcitation, ExcitedDemand, LimitedQuantity, SpectralLine};
use page::{
    Abscissa, Align, Axis, Block, Blocks, Cell, Figure, Layer, Page, Panel, Rounded, Style, Table, Tone, decimal,
    rounded,
};
use rig::bench_file::Limits;
use rig::experiment::{DemandKind, Demands, ExcitationSpectrum, ExperimentPlan, NamedDemand, UPDATE_S};
use rig::facts::Engine;
use units::RPM_RAD_S;
use virtual_bench::Assumption;

use crate::assumptions::assumptions;
use crate::wording::{self, number};

/// Height of a panel on the page.
const HEIGHT: u32 = 170;

/// A designed experiment.
#[derive(Debug, Clone, Copy)]
pub struct Designed<'a> {
    /// The plan.
    pub plan: &'a ExperimentPlan,
    /// Its demands.
    pub demands: &'a Demands,
    /// Spectrum that they excite.
    pub spectrum: Option<&'a ExcitationSpectrum>,
    /// Of the bench: its firing is drawn into the spectrum.
    pub engine: Engine,
    /// Resonance of the shaft, Hz, if it is known.
    pub resonance_hz: Option<f64>,
    /// Predicted behaviour of the bench.
    pub prediction: Option<&'a Prediction>,
    /// Limits that it must not exceed.
    pub limits: Limits,
    /// Standard errors of its peaks; empty without a study.
    pub errors: &'a [f64],
    /// Assumptions of the prediction.
    pub assumptions: &'a [Assumption],
    /// Goal that it was designed for, where there is one.
    pub optimal: Option<Optimal<'a>>,
}

/// An excitation from which chosen parameters are learnt best.
#[derive(Debug, Clone, Copy)]
pub struct Optimal<'a> {
    /// The excitation.
    pub excitation: &'a DesignedExcitation,
    /// The demand that is excited.
    pub excited: ExcitedDemand,
    /// Lines of a multisine; empty for a binary demand.
    pub lines: &'a [SpectralLine],
}

/// The experiment: what it teaches, how far the bench will go, its demands.
pub fn page(designed: &Designed<'_>) -> Page {
    let plan = designed.plan;
    let mut all = Blocks::from(Block::heading(format!("{}, {} s", plan.label, plan.duration_s)));
    if let Some(optimal) = &designed.optimal {
        all.push(learns(optimal.excitation));
        let binding = wording::limited(optimal.excitation.binding);
        let peak = binding_peak(optimal);
        all.push(Block::paragraph(format!("scaled until the first peak reaches its limit: {binding} {peak}")));
    }
    if let Some(prediction) = designed.prediction {
        all.push(peaks(prediction, designed.errors));
        let resonance = designed.resonance_hz.map(|hz| format!("resonance: {}", number::measure(hz, "Hz")));
        all.push(resonance.map(Block::paragraph).into_iter().collect::<Blocks>());
        all.push(assumptions(designed.assumptions).collect::<Blocks>());
    }
    all.push(figures(designed).into_iter().collect::<Blocks>());
    Page::new(format!("{}, designed", plan.label), all.into_vec())
}

/// The limits that the prediction reaches, in words.
pub fn reached(prediction: &Prediction) -> impl Iterator<Item = String> + '_ {
    prediction.peaks.iter().filter(|peak| peak.is_beyond_limit()).map(|peak| {
        let (symbol, unit, si) = wording::peak(peak.of);
        let number = |value: f64| number::significant(value / si, 4);
        let limit = number(peak.limit.unwrap_or(f64::NAN));
        format!("{symbol} reaches {} {unit}, where the limit is {limit} {unit}", number(peak.value))
    })
}

fn peaks(prediction: &Prediction, errors: &[f64]) -> Table {
    let headings =
        [("peak of", Align::Left), ("predicted", Align::Right), ("at", Align::Right), ("limit", Align::Left)];
    let mut table = Table::new(&headings);
    for (index, peak) in prediction.peaks.iter().enumerate() {
        let (symbol, unit, si) = wording::peak(peak.of);
        let value = match errors.get(index).filter(|error| error.is_finite()) {
            Some(error) => {
                format!("{} ± {} {unit}", number::significant(peak.value / si, 4), number::significant(error / si, 2))
            }
            None => format!("{} {unit}", number::significant(peak.value / si, 4)),
        };
        let limit = match peak.limit {
            None => Cell::toned("none stated", Tone::Faint),
            Some(limit) => {
                let words = format!("{} {unit}", number::significant(limit / si, 4));
                let style = if peak.is_beyond_limit() { Tone::Bad } else { Tone::Good };
                Cell::toned(if peak.is_beyond_limit() { format!("{words}: REACHED") } else { words }, style)
            }
        };
        table.row([symbol.into(), value.into(), format!("{} s", decimal::fixed(peak.time_s, 3)).into(), limit]);
    }
    table
}

/// Knowledge gained, beside that from white noise of the same peaks.
fn learns(excitation: &DesignedExcitation) -> Table {
    let mut table = Table::new(&[
        ("learns", Align::Left),
        ("value", Align::Right),
        ("standard error", Align::Right),
        ("after white noise", Align::Right),
        ("variance", Align::Left),
    ]);
    for one in &excitation.parameters {
        let (symbol, unit, si) = wording::model_parameter(one.parameter);
        let with_unit = |value: f64, digits| format!("{} {unit}", number::significant(value / si, digits));
        let gain = one.gain_over_white_noise();
        let words = match gain >= 1.0 {
            true => format!("{} times less", number::significant(gain, 2)),
            false => format!("{} times more", number::significant(1.0 / gain, 2)),
        };
        table.row([
            symbol.into(),
            with_unit(one.value, 4).into(),
            with_unit(one.standard_error, 2).into(),
            with_unit(one.white_noise_standard_error, 2).into(),
            Cell::toned(words, if gain >= 1.0 { Tone::Good } else { Tone::Caution }),
        ]);
    }
    table
}

fn binding_peak(optimal: &Optimal<'_>) -> String {
    let peaks = &optimal.excitation.peaks;
    let demand = match optimal.excited {
        ExcitedDemand::Torque => (peaks.demand, "Nm"),
        ExcitedDemand::Speed => (peaks.demand / RPM_RAD_S, "rpm"),
    };
    let (value, unit) = match optimal.excitation.binding {
        LimitedQuantity::ShaftTorque => (peaks.shaft_torque_nm, "Nm"),
        LimitedQuantity::AirGapTorque => (peaks.air_gap_torque_nm, "Nm"),
        LimitedQuantity::Speed => (peaks.speed_rad_s / RPM_RAD_S, "rpm"),
        LimitedQuantity::Demand => demand,
    };
    format!("±{} {unit}", number::significant(value, 4))
}

/// The figures, from demands to predictions.
fn figures(designed: &Designed<'_>) -> Vec<Figure> {
    let mut figures = vec![demands(designed)];
    figures.extend(designed.spectrum.map(|spectrum| excitation(designed, spectrum)));
    figures.extend(lines(designed));
    figures.extend(designed.prediction.map(|prediction| predicted(designed, prediction)));
    figures
}

/// A demand in words, with its symbol where it has one.
pub fn demand_name(kind: DemandKind) -> &'static str {
    match kind {
        DemandKind::DynoSpeed => "N_d*",
        DemandKind::EngineSpeed => "N_e*",
        DemandKind::DynoTorque => "T_d*",
        DemandKind::ShaftTorque => "T_shaft*",
        DemandKind::EngineTorque => "engine torque demand",
        DemandKind::Throttle => "throttle",
        DemandKind::IgnitionEfficiency => "ignition efficiency",
    }
}

fn demands(designed: &Designed<'_>) -> Figure {
    let is_shown = |demand: &NamedDemand<'_>| {
        demand.kind != DemandKind::IgnitionEfficiency || demand.values.iter().any(|value| *value != 1.0)
    };
    let panel = |(index, demand): (usize, NamedDemand<'_>)| {
        let name = demand_name(demand.kind);
        let values: Vec<f64> = demand.values.iter().map(|value| value / demand.kind.si_per_unit()).collect();
        let layer = Layer::trace(name, Style::of_model(index), (0.0, UPDATE_S), &values);
        Panel::new(Axis::linear(name, demand.kind.unit()), HEIGHT, vec![layer])
    };
    let panels = designed.demands.named(designed.plan).into_iter().filter(is_shown).enumerate().map(panel).collect();
    Figure::new("Demands", Axis::time(), panels).with_caption(
        "Speeds change every millisecond, all other demands every 10 ms. Before zero the bench settles at the first \
         demands.",
    )
}

fn excitation(designed: &Designed<'_>, spectrum: &ExcitationSpectrum) -> Figure {
    let name = demand_name(spectrum.of);
    let largest = spectrum.density.iter().copied().fold(0.0, f64::max);
    let floor = largest * 1e-4;
    let shown: Vec<f64> = spectrum.density.iter().map(|density| density.max(floor)).collect();
    let mut layers = vec![Layer::curve(name, Style::Modelled, &spectrum.frequency_hz, &shown)];
    let marks = |at: &[f64], label: &str| Layer::VerticalMarks { x: rounded(at), label: label.to_owned() };
    let highest = spectrum.frequency_hz.last().copied().unwrap_or(0.0);
    layers.extend(designed.resonance_hz.filter(|f| *f <= highest).map(|f| marks(&[f], "resonance")));
    let turns_hz = designed.demands.speed_rad_s[0].abs() / std::f64::consts::TAU;
    if designed.plan.has_shaft && !designed.plan.is_motored && turns_hz > 0.0 {
        let orders = designed.engine.orders().into_iter().map(|order| order * turns_hz);
        let shown: Vec<f64> = orders.filter(|f| *f <= highest).collect();
        if !shown.is_empty() {
            layers.push(marks(&shown, "firing, /2, /4"));
        }
    }
    let unit = format!("{}²/Hz", spectrum.of.unit());
    let panel = Panel::new(Axis::log(&format!("density of {name}"), &unit), 220, layers);
    Figure::new("What is excited", Axis::frequency(), vec![panel]).with_caption(
        "Power density of the demand about its mean, over segments of 10 s. The shaft is learnt where there is power \
         near its resonance; there it also answers most. Firing lines are those of the first speed.",
    )
}

/// The lines of a designed multisine, and what their phases make of the peaks.
fn lines(designed: &Designed<'_>) -> Option<Figure> {
    let excited = designed.spectrum?.of;
    let lines = designed.optimal?.lines;
    let frequencies_hz: Vec<f64> = lines.iter().map(|line| line.frequency_hz).collect();
    let amplitudes: Vec<f64> = lines.iter().map(|line| line.amplitude / excited.si_per_unit()).collect();
    if amplitudes.is_empty() {
        return None;
    }
    let name = demand_name(excited);
    let layers = vec![Layer::Stems {
        name: name.to_owned(),
        style: Style::Modelled,
        x: Abscissa::Values(rounded(&frequencies_hz)),
        y: rounded(&amplitudes),
    }];
    let resonance =
        designed.resonance_hz.map(|f| Layer::VerticalMarks { x: rounded(&[f]), label: "resonance".to_owned() });
    let layers = layers.into_iter().chain(resonance).collect();
    let panel = Panel::new(Axis::linear(&format!("amplitude of {name}"), excited.unit()), 170, layers);
    let mut caption = "The sines of the demand.".to_owned();
    if let Some(prediction) = designed.prediction.filter(|prediction| prediction.has_shaft) {
        let factor = crest_factor(&prediction.response.shaft_torque_nm);
        caption += &format!(
            " Their phases keep peaks low: about its mean, the shaft torque peaks at {} times its root mean square.",
            number::significant(factor, 2)
        );
    }
    Some(Figure::new("Lines of the excitation", Axis::linear("frequency", "Hz"), vec![panel]).with_caption(caption))
}

/// Largest deviation from the mean over the root mean square of all.
fn crest_factor(values: &[f64]) -> f64 {
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>() / count;
    values.iter().fold(0.0_f64, |most, value| most.max((value - mean).abs())) / square.sqrt()
}

fn predicted(designed: &Designed<'_>, prediction: &Prediction) -> Figure {
    let (response, clock) = (&prediction.response, (0.0, prediction.sample_time_s));
    let rpm = |values: &[f64]| -> Vec<f64> { values.iter().map(|value| value / RPM_RAD_S).collect() };
    let limit = |limit: Option<f64>, values: &[f64]| -> Vec<Layer> {
        let Some(limit) = limit else { return Vec::new() };
        // A limit far away is said by the table of peaks; drawn, it would flatten what there is to see.
        let near = |edge: f64| values.iter().any(|value| value * edge.signum() > 0.5 * edge.abs());
        let mark = |y: f64| Layer::HorizontalMark { y: Rounded(y), label: "limit".to_owned() };
        [limit, -limit].into_iter().filter(|edge| near(*edge)).map(mark).collect()
    };
    let mut speeds = Vec::new();
    if prediction.has_shaft {
        speeds.push(Layer::trace("N_e", Style::of_model(1), clock, &rpm(&response.engine_speed_rad_s)));
    }
    let dyno_rpm = rpm(&response.dyno_speed_rad_s);
    speeds.push(Layer::trace("N_d", Style::of_model(0), clock, &dyno_rpm));
    speeds.extend(limit(designed.limits.speed_rad_s.map(|limit| limit / RPM_RAD_S), &dyno_rpm));
    let mut torques = vec![
        Layer::trace("T_d*", Style::of_model(3), clock, &response.torque_demand_nm),
        Layer::trace("T_d", Style::of_model(2), clock, &response.air_gap_torque_nm),
    ];
    torques.extend(limit(designed.limits.torque_nm, &response.torque_demand_nm));
    let mut panels = vec![
        Panel::new(Axis::linear("speed", "rpm"), HEIGHT, speeds),
        Panel::new(Axis::linear("T_d", "Nm"), HEIGHT, torques),
    ];
    if prediction.has_shaft {
        let mut shaft = vec![Layer::trace("T_shaft", Style::of_model(4), clock, &response.shaft_torque_nm)];
        shaft.extend(limit(designed.limits.shaft_torque_nm, &response.shaft_torque_nm));
        panels.push(Panel::new(Axis::linear("T_shaft", "Nm"), HEIGHT, shaft));
    }
    Figure::new("What the bench will do", Axis::time(), panels).with_caption(
        "The linear bench model under these demands. It has no firing pulses of the engine: they add to the shaft \
         torque.",
    )
}
