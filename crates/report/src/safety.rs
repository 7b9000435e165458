//! Figures of a safety check: how peaks spread over the benches drawn, and how large sines may be.

use design::safety::{Checked, Proposal, Quantity, SafetyCheck};
use page::{Axis, Figure, Layer, Panel, Rounded, Style, rounded};

use crate::wording;

/// Height of a panel on the page.
const HEIGHT: u32 = 220;

/// The figures: the distribution of the largest shaft torque (of the torque demand without a shaft), and the amplitudes of a
/// sine test.
pub fn figures(check: &SafetyCheck) -> Vec<Figure> {
    let peak = check
        .checked
        .iter()
        .find(|checked| checked.of == Quantity::ShaftTorque)
        .or(check.checked.iter().find(|checked| checked.of == Quantity::TorqueDemand));
    peak.map(distribution).into_iter().chain(check.sines.as_ref().map(amplitudes)).collect()
}

fn distribution(checked: &Checked) -> Figure {
    let (name, unit, si) = wording::quantity(checked.of);
    let finite = checked.values.iter().filter(|value| value.is_finite());
    let values: Vec<f64> = finite.map(|value| value / si).collect();
    let share: Vec<f64> = (1..=values.len()).map(|k| 100.0 * k as f64 / checked.values.len() as f64).collect();
    let mut layers = vec![Layer::curve("benches at or below", Style::Modelled, &values, &share)];
    let mark = |limit: f64| Layer::VerticalMarks { x: rounded(&[limit / si]), label: "limit".to_owned() };
    layers.extend(checked.limit.map(mark));
    layers.push(Layer::HorizontalMark { y: Rounded(95.0), label: "95 %".to_owned() });
    let panel = Panel::new(Axis::linear("share of benches", "%"), HEIGHT, layers);
    Figure::new("How the peak spreads", Axis::linear(name, unit), vec![panel]).with_caption(
        "Every bench drawn runs the experiment; the curve says on how many the peak stays below a value. Firing pulses are \
         no part of it.",
    )
}

fn amplitudes(proposal: &Proposal) -> Figure {
    let of = |number: fn(&design::safety::SafeSine) -> f64| proposal.sines.iter().map(number).collect::<Vec<f64>>();
    let frequency_hz = of(|sine| sine.frequency_hz);
    let layers = vec![
        Layer::curve("safe", Style::Modelled, &frequency_hz, &of(|sine| sine.safe_nm)),
        Layer::dots("planned", Style::Other, &frequency_hz, &of(|sine| sine.planned_nm)),
    ];
    let panel = Panel::new(Axis::linear("amplitude of T_d*", "Nm"), HEIGHT, layers);
    Figure::new("How large a sine may be", Axis::linear("frequency", "Hz"), vec![panel])
        .with_caption("With all sines at the safe amplitude or below, few enough of the benches reach a limit.")
}
