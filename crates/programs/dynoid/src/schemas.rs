//! JSON schemas of the documents and of what commands print with `--json`.

use serde::Deserialize;

/// Schema of one kind of document, or of what one command prints.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Schema {
    /// Its name, such as `study`; `can-output` is what `dynoid can --json` prints.
    pub name: &'static str,
    /// The schema, of JSON Schema 2020-12.
    pub text: &'static str,
}

impl Schema {
    /// Its title, which says in some words what it describes.
    #[must_use]
    pub fn title(&self) -> String {
        #[derive(Deserialize)]
        struct Titled {
            title: String,
        }
        serde_json::from_str(self.text).map(|Titled { title }| title).unwrap_or_default()
    }
}

macro_rules! committed {
    ($($name:literal)*) => {
        &[$(Schema { name: $name, text: include_str!(concat!("../../../../docs/schemas/", $name, ".json")) }),*]
    };
}

/// All schemas, by name. A test makes them from the types; `cargo xtask schemas` writes them.
pub const SCHEMAS: &[Schema] = committed! {
    "analyses"
    "can-map-output"
    "can-output"
    "can-recorded-output"
    "capability-map"
    "controller-output"
    "cycle-validation"
    "data-delay-output"
    "data-order-output"
    "data-spectrum-output"
    "easier"
    "engine-output"
    "engine-torque"
    "excitation-design"
    "experiment-check-output"
    "experiment-design-output"
    "experiment-next-output"
    "experiment-simulate-output"
    "fit-output"
    "friction"
    "friction-output"
    "gradients"
    "init-output"
    "inspect-list-output"
    "inspect-output"
    "linear-model"
    "lines"
    "lines-output"
    "model"
    "model-bode-output"
    "model-compare-output"
    "model-comparison"
    "model-convert-zpk-output"
    "model-poles-output"
    "model-predict-output"
    "model-residuals-output"
    "model-simulate-output"
    "model-step-output"
    "next-experiments"
    "noise-test"
    "safety-check"
    "shaft"
    "shaft-output"
    "speed-control"
    "study"
    "study-output"
    "torque-control"
    "torque-control-output"
    "torque-signals"
    "torque-signals-output"
    "verdict"
    "wanted"
};

/// The schema of this name.
///
/// # Example
/// ```
/// let schema = dynoid::schemas::named("study").expect("a study has a schema");
/// assert!(schema.text.contains("https://json-schema.org/draft/2020-12/schema"));
/// ```
#[must_use]
pub fn named(name: &str) -> Option<&'static Schema> {
    SCHEMAS.iter().find(|schema| schema.name == name)
}
