//! A figure as data, drawn by [`crate::svg`].
//!
//! A figure has one x-axis and one or more panels below each other that share it. Values are rounded and long traces
//! thinned on the way in, so that a report of many recordings stays small.

mod rounded;
pub(crate) mod thin;

use serde::Serialize;

pub use rounded::{Rounded, rounded};

/// Largest number of points drawn of one line.
pub(crate) const MAX_POINTS: usize = 4000;
/// Panels on one x-axis, with a title above and a caption below.
#[derive(Debug, Clone, Serialize)]
pub struct Figure {
    /// Title of the figure.
    pub title: String,
    /// Caption that points out what to see in it.
    pub caption: String,
    /// The shared x-axis.
    pub x: Axis,
    /// Panels, top to bottom.
    pub panels: Vec<Panel>,
    /// True if a length means the same along both axes, as in a complex plane.
    pub equal_axes: bool,
    /// The recording that is shown over time, whose figures a page zooms together; empty for none.
    pub recording: String,
    /// True if words such as `T_d` are symbols, to be set with an index; otherwise they are names.
    pub symbols: bool,
}

/// One panel.
#[derive(Debug, Clone, Serialize)]
pub struct Panel {
    /// The y-axis.
    pub y: Axis,
    /// A remark behind the axis' name.
    pub note: String,
    /// Height of the drawing area, CSS pixels.
    pub height: u32,
    /// Layers of the drawing, first at the bottom.
    pub layers: Vec<Layer>,
}

/// An axis.
#[derive(Debug, Clone, Serialize)]
pub struct Axis {
    /// Quantity that it shows.
    pub label: String,
    /// Its unit, empty for none.
    pub unit: String,
    /// How numbers become lengths.
    pub scale: Scale,
    /// Fixed range; otherwise it follows the data in view.
    pub range: Option<[Rounded; 2]>,
}

/// How an axis maps numbers to length.
#[derive(Debug, Clone, Copy, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Scale {
    /// In proportion.
    Linear,
    /// By the logarithm; only positive numbers have a place.
    Log,
    /// In proportion, with marks at parts of a turn of 360.
    Angle,
}

/// The role of a series, from which the page takes colour and stroke.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Style {
    /// A measurement.
    Measured,
    /// A model, or the first of several.
    Modelled,
    /// A second model.
    Other,
    /// Residuals, or a third model.
    Residual,
    /// A fourth model.
    Fourth,
    /// A fifth model.
    Fifth,
    /// A sixth model.
    Sixth,
    /// A seventh model.
    Seventh,
    /// An eighth model.
    Eighth,
    /// A ninth model.
    Ninth,
    /// A tenth model.
    Tenth,
    /// A thin line to read other things by.
    Guide,
}

impl Style {
    /// Those of models, in the order in which models get them.
    pub(crate) const MODELS: [Style; 10] = [
        Style::Modelled,
        Style::Other,
        Style::Residual,
        Style::Fourth,
        Style::Fifth,
        Style::Sixth,
        Style::Seventh,
        Style::Eighth,
        Style::Ninth,
        Style::Tenth,
    ];

    /// The style of model number `index`, counted from zero; styles come back after ten.
    pub fn of_model(index: usize) -> Style {
        Self::MODELS[index % Self::MODELS.len()]
    }
}

/// The shape of a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Marker {
    /// ×, for poles.
    Cross,
    /// ○, for zeros.
    Ring,
}

/// Something drawn in a panel. A layer's `name` is in the legend, one entry a name; `x` and `y` are as long as each
/// other, and so are `low` and `high`.
#[allow(missing_docs)] // the fields are what their names say, and what the variant says of them
#[derive(Debug, Clone, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Layer {
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
    /// Markers at points in no order.
    Markers { name: String, style: Style, marker: Marker, x: Vec<Rounded>, y: Vec<Rounded> },
    /// A curve that may turn back, such as an ellipse or a Nyquist curve.
    Path { name: String, style: Style, x: Vec<Rounded>, y: Vec<Rounded> },
    /// A band between two curves.
    Band { name: String, style: Style, x: Abscissa, low: Vec<Rounded>, high: Vec<Rounded> },
    /// Shades over a plane, the first at the bottom of all: columns of cells of equal width from `x[0]` to `x[1]`, each
    /// a string with a digit a cell from `y[0]` up to `y[1]`. `0` is blank and `9` darkest; an empty string leaves a
    /// column out.
    Shades { x: [Rounded; 2], y: [Rounded; 2], columns: Vec<String> },
    /// Words beside points, those left out that would cover one before them.
    Words { style: Style, x: Vec<Rounded>, y: Vec<Rounded>, words: Vec<String> },
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
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Abscissa {
    #[allow(missing_docs)] // said here
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
    pub fn linear(label: &str, unit: &str) -> Self {
        Axis { label: label.to_owned(), unit: unit.to_owned(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis that follows the data.
    pub fn log(label: &str, unit: &str) -> Self {
        Axis { scale: Scale::Log, ..Axis::linear(label, unit) }
    }

    /// Degrees.
    pub fn angle(label: &str) -> Self {
        Axis { scale: Scale::Angle, ..Axis::linear(label, "°") }
    }

    /// Time in a recording.
    pub fn time() -> Self {
        Axis::linear("time", "s")
    }

    /// Frequency, logarithmic.
    pub fn frequency() -> Self {
        Axis::log("frequency", "Hz")
    }

    /// The same axis with a fixed range; one that is not finite or empty is ignored.
    pub fn within(mut self, low: f64, high: f64) -> Self {
        self.range = (low < high && (high - low).is_finite()).then_some([Rounded(low), Rounded(high)]);
        self
    }
}

impl Figure {
    /// A figure without caption.
    pub fn new(title: &str, x: Axis, panels: Vec<Panel>) -> Self {
        let (title, caption, recording) = (title.to_owned(), String::new(), String::new());
        Figure { title, caption, x, panels, equal_axes: false, recording, symbols: true }
    }

    /// The same figure with a caption.
    pub fn with_caption(self, caption: impl Into<String>) -> Self {
        Figure { caption: caption.into(), ..self }
    }

    /// The same figure as one of those of a recording.
    pub fn of_recording(self, recording: impl Into<String>) -> Self {
        Figure { recording: recording.into(), ..self }
    }

    /// The same figure with its texts as they are: names of channels and files are no symbols.
    pub fn with_plain_text(self) -> Self {
        Figure { symbols: false, ..self }
    }

    /// The same figure with one scale for both axes.
    pub fn with_equal_axes(self) -> Self {
        Figure { equal_axes: true, ..self }
    }
}

impl Figure {
    /// The number of points of each line.
    pub(crate) fn line_lengths(&self) -> impl Iterator<Item = usize> {
        self.panels.iter().flat_map(|panel| &panel.layers).filter_map(|layer| match layer {
            Layer::Line { y, .. } => Some(y.len()),
            _ => None,
        })
    }
}

impl Panel {
    /// A panel without remark.
    pub fn new(y: Axis, height: u32, layers: Vec<Layer>) -> Self {
        Panel { y, note: String::new(), height, layers }
    }

    /// The same panel with a remark behind the axis' name.
    pub fn noted(self, note: String) -> Self {
        Panel { note, ..self }
    }
}

impl Layer {
    /// A uniformly sampled trace. If it is long, not every sample is drawn.
    pub fn trace(name: &str, style: Style, (start_s, sample_time_s): (f64, f64), values: &[f64]) -> Self {
        let finite_or_zero = |value: f64| if value.is_finite() { value } else { 0.0 };
        let (start, step) = (finite_or_zero(start_s), finite_or_zero(sample_time_s));
        let x = Abscissa::Uniform { start, step, skip: None };
        Layer::Line { name: name.to_owned(), style, x, y: rounded(values) }
    }

    /// A curve over frequency or the like.
    pub fn curve(name: &str, style: Style, x: &[f64], y: &[f64]) -> Self {
        Layer::Line { name: name.to_owned(), style, x: Abscissa::Values(rounded(x)), y: rounded(y) }
    }

    /// Dots without error bars.
    pub fn dots(name: &str, style: Style, x: &[f64], y: &[f64]) -> Self {
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
