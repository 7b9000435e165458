//! A figure as data: what the report's own plotting script (`assets/*.js`) draws.
//!
//! A figure has one x-axis and one or more panels below each other that share it. Values are rounded and long traces
//! thinned on the way in, so that a report of many recordings stays small.

mod rounded;
mod thin;

use bench::study::Trace;
use serde::Serialize;

pub(crate) use rounded::{Rounded, rounded};
use thin::kept_indices;

/// Largest number of points drawn of one trace.
const MAX_POINTS: usize = 4000;

/// Panels on one x-axis, with a title above and a caption below.
#[derive(Debug, Serialize)]
pub(crate) struct Figure {
    /// What is shown.
    pub(crate) title: String,
    /// What to see in it; plain text, placed by the page and not by the script.
    #[serde(skip)]
    pub(crate) caption: String,
    /// The shared x-axis.
    pub(crate) x: Axis,
    /// Panels, top to bottom.
    pub(crate) panels: Vec<Panel>,
}

/// One panel.
#[derive(Debug, Serialize)]
pub(crate) struct Panel {
    /// The y-axis.
    pub(crate) y: Axis,
    /// A remark behind the axis' name.
    pub(crate) note: String,
    /// Height of the drawing area, CSS pixels.
    pub(crate) height: u32,
    /// What is drawn, first at the bottom.
    pub(crate) layers: Vec<Layer>,
}

/// An axis.
#[derive(Debug, Serialize)]
pub(crate) struct Axis {
    pub(crate) label: String,
    pub(crate) unit: String,
    pub(crate) scale: Scale,
    /// Fixed range; otherwise it follows the data in view.
    pub(crate) range: Option<[Rounded; 2]>,
}

/// How an axis maps numbers to length.
#[derive(Debug, Clone, Copy, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Scale {
    Linear,
    Log,
}

/// The role of a series, from which the page takes colour and stroke.
#[derive(Debug, Clone, Copy, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Style {
    Measured,
    Modelled,
    Other,
    Residual,
}

/// Something drawn in a panel.
#[derive(Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Layer {
    /// A polyline.
    Line { name: String, style: Style, x: Abscissa, y: Vec<Rounded> },
    /// Dots, with error bars where `low` and `high` are given.
    Points {
        name: String,
        style: Style,
        x: Abscissa,
        y: Vec<Rounded>,
        #[serde(skip_serializing_if = "Option::is_none")]
        low: Option<Vec<Rounded>>,
        #[serde(skip_serializing_if = "Option::is_none")]
        high: Option<Vec<Rounded>>,
    },
    /// Sticks from zero, for correlations.
    Stems { name: String, style: Style, x: Abscissa, y: Vec<Rounded> },
    /// A band between two curves.
    Band { name: String, style: Style, x: Abscissa, low: Vec<Rounded>, high: Vec<Rounded> },
    /// A horizontal line.
    HorizontalMark { y: Rounded, label: String },
    /// Vertical lines with one meaning; `label` stands at the first.
    VerticalMarks { x: Vec<Rounded>, label: String },
    /// A shaded range of y, across the panel.
    YRegion { low: Rounded, high: Rounded, label: String },
    /// A shaded range of x, over the panel's height.
    XRegion { low: Rounded, high: Rounded, label: String },
}

/// The x values of a series.
#[derive(Debug, Clone, Serialize)]
#[serde(untagged)]
pub(crate) enum Abscissa {
    /// `start + step·n`; where samples were left out, `skip` holds the step from each kept index to the next, the
    /// first counted from zero.
    Uniform {
        start: f64,
        step: f64,
        #[serde(skip_serializing_if = "Option::is_none")]
        skip: Option<Vec<u32>>,
    },
    /// Each value.
    Values(Vec<Rounded>),
}

impl Axis {
    /// A linear axis that follows the data.
    pub(crate) fn linear(label: &str, unit: &str) -> Self {
        Axis { label: label.to_owned(), unit: unit.to_owned(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis that follows the data.
    pub(crate) fn log(label: &str, unit: &str) -> Self {
        Axis { scale: Scale::Log, ..Axis::linear(label, unit) }
    }

    /// Time in a recording.
    pub(crate) fn time() -> Self {
        Axis::linear("time", "s")
    }

    /// Frequency, logarithmic.
    pub(crate) fn frequency() -> Self {
        Axis::log("frequency", "Hz")
    }

    /// The same axis with a fixed range; one that is not finite or empty is ignored.
    pub(crate) fn within(mut self, low: f64, high: f64) -> Self {
        self.range = (low < high && (high - low).is_finite()).then_some([Rounded(low), Rounded(high)]);
        self
    }
}

impl Panel {
    /// A panel without remark.
    pub(crate) fn new(y: Axis, height: u32, layers: Vec<Layer>) -> Self {
        Panel { y, note: String::new(), height, layers }
    }

    /// The same panel with a remark behind the axis' name.
    pub(crate) fn noted(self, note: String) -> Self {
        Panel { note, ..self }
    }
}

impl Layer {
    /// A uniformly sampled trace, thinned if it is long.
    pub(crate) fn trace(name: &str, style: Style, trace: &Trace) -> Self {
        let finite_or_zero = |value: f64| if value.is_finite() { value } else { 0.0 };
        let kept = kept_indices(&trace.values, MAX_POINTS);
        let y = match &kept {
            Some(kept) => kept.iter().filter_map(|&index| trace.values.get(index)).copied().map(Rounded).collect(),
            None => rounded(&trace.values),
        };
        let x = Abscissa::Uniform {
            start: finite_or_zero(trace.start_s),
            step: finite_or_zero(trace.sample_time_s),
            skip: kept.map(|kept| thin::steps(&kept)),
        };
        Layer::Line { name: name.to_owned(), style, x, y }
    }

    /// A curve over frequency or the like.
    pub(crate) fn curve(name: &str, style: Style, x: &[f64], y: &[f64]) -> Self {
        Layer::Line { name: name.to_owned(), style, x: Abscissa::Values(rounded(x)), y: rounded(y) }
    }

    /// Dots without error bars.
    pub(crate) fn dots(name: &str, style: Style, x: &[f64], y: &[f64]) -> Self {
        Layer::Points {
            name: name.to_owned(),
            style,
            x: Abscissa::Values(rounded(x)),
            y: rounded(y),
            low: None,
            high: None,
        }
    }
}

/// How many samples of a trace are drawn; `None` if all are.
pub(crate) fn drawn_of(trace: &Trace) -> Option<usize> {
    kept_indices(&trace.values, MAX_POINTS).map(|kept| kept.len())
}
