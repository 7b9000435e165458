//! The block diagram of the bench with the estimated numbers in its blocks, as inline SVG.

use bench_model::model::ModelParameter;
use rig::results::{Estimate, Outcome, Quantity, Reason};
use study::Study;

use crate::wording::{join, listed, number};
use page::markup;
use page::markup::Markup;
use page::{Blocks, Symbol};

/// The diagram's own coordinates; the page scales it.
const WIDTH: i32 = 880;
const HEIGHT: i32 = 356;

/// A block: where it is, what it is, and its text.
struct Block {
    x: i32,
    y: i32,
    width: i32,
    height: i32,
    link: &'static str,
    title: &'static str,
    /// Lines of finished SVG text content; the first is the largest.
    lines: Vec<Markup>,
    estimated: bool,
}

/// The section with the diagram.
pub(crate) fn section(study: &Study) -> Blocks {
    let blocks: Markup = blocks(study).iter().map(draw).collect();
    let svg = markup!(
        "<div class=\"wide\"><svg viewBox=\"0 24 {} {}\" role=\"group\" aria-label=\"Block diagram of the bench\">{}{}{}</svg></div>",
        Markup::raw(WIDTH.to_string()),
        Markup::raw(HEIGHT.to_string()),
        Markup::raw(ARROW_HEAD),
        arrows(),
        blocks,
    );
    page::Block::Drawing {
        svg: svg.into_string(),
        description: description(study),
        caption:
            "Speeds in rpm at the controller and in rad/s at the shaft; torque in Nm. Dashed blocks are not estimated."
                .into(),
    }
    .into()
}

/// The diagram in words, with its numbers.
fn description(study: &Study) -> String {
    let controller = estimate(&study.speed_controller, |part| &part.estimate);
    let torque = estimate(&study.torque_control, |part| &part.delay_and_lag);
    let shaft = estimate(&study.shaft, |part| &part.estimate);
    format!(
        "Block diagram of the bench: speed control demands a torque from the torque control, which acts on the \
         dynamometer; the shaft connects it with the engine. Speed control: {controller}. Torque control: {torque}. \
         Shaft: {shaft}."
    )
}

/// The parameters of a part with their values.
fn estimate<T>(part: &Outcome<T>, of: impl Fn(&T) -> &Estimate) -> String {
    let Outcome::Estimated(part) = part else { return "not estimated".to_owned() };
    let parameters = of(part).parameters.iter();
    let texts: Vec<String> =
        parameters.map(|one| format!("{} {}", one.quantity.symbol(), number::parameter(one))).collect();
    texts.join(", ")
}

fn blocks(study: &Study) -> [Block; 5] {
    let (speed, speed_known) = speed_control(study);
    let (torque, torque_known) = torque_control(study);
    let (shaft, shaft_known) = shaft(study);
    let block =
        |x, y, width, link, title, lines, estimated| Block { x, y, width, height: 96, link, title, lines, estimated };
    [
        block(110, 36, 330, "speed-control", "Speed control", speed, speed_known),
        block(550, 36, 250, "torque-control", "Torque control", torque, torque_known),
        block(110, 212, 180, "provenance", "Dynamometer", inertia(study, ModelParameter::DynoInertia), true),
        block(390, 212, 180, "shaft", "Shaft", shaft, shaft_known),
        block(660, 212, 150, "provenance", "Engine", inertia(study, ModelParameter::EngineInertia), true),
    ]
}

fn speed_control(study: &Study) -> (Vec<Markup>, bool) {
    let part = match &study.speed_controller {
        Outcome::Estimated(part) => part,
        Outcome::NotEstimated { needs } => return (absent(needs), false),
    };
    let [k_p, k_i] =
        [Quantity::ProportionalGain, Quantity::IntegralGain].map(|quantity| digits(&part.estimate, quantity));
    let law = markup!("{} ({} + {}/s) (N − N*)", delay(&part.estimate, Quantity::ControllerDelay), k_p, k_i);
    let feed_forward = match &study.feed_forward {
        Outcome::Estimated(part) => {
            let [k, k_a] = [Quantity::SpeedFeedForward, Quantity::AccelerationFeedForward]
                .map(|quantity| signed(&digits(&part.estimate, quantity)));
            markup!("{} N* {} dN*/dt", k, k_a)
        }
        Outcome::NotEstimated { needs } => markup!("<tspan class=\"absent\">feed-forward {}</tspan>", short(needs)),
    };
    (vec![law, feed_forward], true)
}

fn torque_control(study: &Study) -> (Vec<Markup>, bool) {
    match &study.torque_control {
        Outcome::Estimated(part) => {
            let a = digits(&part.delay_and_lag, Quantity::TorqueControlBandwidth);
            let lag = markup!("{} · {}/(s + {})", delay(&part.delay_and_lag, Quantity::TorqueControlDelay), a, a);
            let total = part.delay_and_lag.parameter(Quantity::TorqueControlTotalDelay).map(number::parameter);
            (vec![lag, total.map(|total| markup!("total delay {}", total)).unwrap_or_default()], true)
        }
        Outcome::NotEstimated { needs } => (absent(needs), false),
    }
}

fn shaft(study: &Study) -> (Vec<Markup>, bool) {
    match &study.shaft {
        Outcome::Estimated(part) => {
            let [k, b] = [Quantity::Stiffness, Quantity::Damping].map(|quantity| digits(&part.estimate, quantity));
            let zero = number::significant(part.zero.value, 3);
            (vec![markup!("({} + {} s)/s", k, b), markup!("zero at {} rad/s", zero)], true)
        }
        Outcome::NotEstimated { needs } => (absent(needs), false),
    }
}

/// An inertia as the model has it; without a model that of the bench file.
fn inertia(study: &Study, which: ModelParameter) -> Vec<Markup> {
    let stated = match which {
        ModelParameter::EngineInertia => study.bench.engine_inertia_kg_m2,
        _ => study.bench.dynamometer_inertia_kg_m2,
    };
    let modelled = study.model.as_ref().and_then(|assembled| assembled.model.value(which));
    let kg_m2 = modelled.unwrap_or(stated);
    let origin = if kg_m2 == stated { "as given" } else { "of the model" };
    vec![markup!("1/({} s)", number::significant(kg_m2, 4)), markup!("{} {}", symbol_svg(which.symbol()), origin)]
}

/// The factor e^(−τ s) with its number.
fn delay(estimate: &Estimate, quantity: Quantity) -> Markup {
    let seconds = estimate.parameter(quantity).map(|p| number::significant(p.value, 3));
    let seconds = seconds.unwrap_or_else(|| "?".to_owned());
    markup!("e<tspan class=\"power\" dy=\"-6\">−{} s</tspan><tspan dy=\"6\">\u{200b}</tspan>", seconds)
}

/// A parameter's value, short enough for a block and without unit.
fn digits(estimate: &Estimate, quantity: Quantity) -> String {
    let value = estimate.parameter(quantity).map(|parameter| number::significant(parameter.written().value, 4));
    value.unwrap_or_else(|| "?".to_owned())
}

/// A number as a further summand: `+ 2`, `− 2`.
fn signed(digits: &str) -> String {
    match digits.strip_prefix('−') {
        Some(magnitude) => format!("− {magnitude}"),
        None => format!("+ {digits}"),
    }
}

fn absent(needs: &[Reason]) -> Vec<Markup> {
    vec![markup!("<tspan class=\"absent\">not estimated</tspan>"), markup!("{}", short(needs))]
}

/// The labels that are needed, short enough for a block.
fn short(needs: &[Reason]) -> String {
    let first = needs.iter().find_map(|need| match need {
        Reason::Recording { any_of } => Some(join(&listed(any_of), "or")),
        _ => None,
    });
    match first {
        Some(labels) if labels.chars().count() <= 26 => format!("needs {labels}"),
        _ => "needs: see its section".to_owned(),
    }
}

fn draw(block: &Block) -> Markup {
    let centre = block.x + block.width / 2;
    let class = if block.estimated { "block" } else { "block missing" };
    let at = |value: i32| Markup::raw(value.to_string());
    let texts: Markup = block
        .lines
        .iter()
        .enumerate()
        .map(|(n, line)| {
            let (class, y) = if n == 0 { ("law", block.y + 56) } else { ("more", block.y + 79) };
            markup!("<text class=\"{}\" x=\"{}\" y=\"{}\">{}</text>", class, at(centre), at(y), line)
        })
        .collect();
    markup!(
        "<a href=\"#{}\"><g class=\"{}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" rx=\"6\"/>\
         <text class=\"name\" x=\"{}\" y=\"{}\">{}</text>{}</g></a>",
        block.link,
        class,
        at(block.x),
        at(block.y),
        at(block.width),
        at(block.height),
        at(centre),
        at(block.y + 26),
        block.title,
        texts
    )
}

const ARROW_HEAD: &str = "<defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"7\" refY=\"4\" markerWidth=\"8\" \
                          markerHeight=\"8\" markerUnits=\"userSpaceOnUse\" orient=\"auto-start-reverse\">\
                          <path d=\"M0 0.5 8 4 0 7.5z\"/></marker></defs>";

/// Every signal: its path, its name and where the name stands.
fn arrows() -> Markup {
    let signals = [
        ("M20 64H110", "N_d*", 24, 56),
        ("M440 84H550", "T_d*", 484, 76),
        ("M675 132V172H240V212", "T_d", 642, 164),
        ("M390 244H290", "T_shaft", 340, 236),
        ("M570 244H660", "T_shaft", 615, 236),
        ("M872 260H810", "T_e", 848, 252),
        ("M200 308V352H468", "ω_d", 330, 344),
        ("M735 308V352H492", "ω_e", 620, 344),
        ("M480 340V308", "Δω", 500, 328),
        ("M200 352H50V104H110", "N_d", 74, 96),
    ];
    let mut all: Markup = signals.iter().map(|(path, name, x, y)| signal(path, name, *x, *y)).collect();
    all.push(Markup::raw(
        "<circle class=\"node\" cx=\"200\" cy=\"352\" r=\"3\"/><circle class=\"sum\" cx=\"480\" cy=\"352\" r=\"12\"/>\
         <text class=\"sign\" x=\"458\" y=\"370\">−</text><text class=\"sign\" x=\"502\" y=\"370\">+</text>\
         <text class=\"sign\" x=\"252\" y=\"205\">−</text><text class=\"sign\" x=\"302\" y=\"259\">+</text>\
         <text class=\"sign\" x=\"650\" y=\"259\">−</text><text class=\"sign\" x=\"822\" y=\"275\">+</text>",
    ));
    all
}

fn signal(path: &str, name: &str, x: i32, y: i32) -> Markup {
    markup!(
        "<path class=\"wire\" d=\"{}\"/><text class=\"signal\" x=\"{}\" y=\"{}\">{}</text>",
        path,
        Markup::raw(x.to_string()),
        Markup::raw(y.to_string()),
        symbol_svg(name)
    )
}

/// A symbol inside an SVG `text` element.
fn symbol_svg(text: &str) -> Markup {
    let set = |(piece, below)| match below {
        true => markup!("<tspan class=\"sub\" dy=\"3\">{}</tspan><tspan dy=\"-3\">\u{200b}</tspan>", piece),
        false => markup!("{}", piece),
    };
    Symbol::new(text).pieces().into_iter().map(set).collect()
}
