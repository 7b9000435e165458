//! The committed JSON schemas are those of the types. With `DYNOID_WRITE_SCHEMAS`, as `cargo xtask schemas` sets it,
//! the test writes them.

use std::path::{Path, PathBuf};
use std::{env, fs};

use bench_model::document::{BenchModelDocument, ResultFormat};
use bench_testkit::schemas::assert_valid;
use bench_testkit::{documents, models};
use capability::document as capabilities;
use dataset::inspection::{File, Listing};
use design::excitation_design::ExcitationDesign;
use design::safety::SafetyCheck;
use dynoid::ProposalFacts;
use dynoid::can::{CapabilityFacts, PredictedFacts, RunFacts};
use dynoid::experiments::{CheckFacts, DesignFacts, SimulationFacts};
use dynoid::facts::{
    EngineFacts, FrictionFacts, LinesFacts, ShaftFacts, SpeedControlFacts, TorqueControlFacts, TorqueSignalsFacts,
    WrittenFacts,
};
use dynoid::schemas::SCHEMAS;
use ident::ModelDocument;
use lti::{PolynomialEquation, PolynomialModel};
use schemars::generate::SchemaSettings;
use schemars::transform::RecursiveTransform;
use schemars::{JsonSchema, Schema};
use serde_json::{Value, json};
use study::{NextExperiments, Study, document};
use toolbox_report::compare::MetFacts;
use toolbox_report::convert::ZeroPoleGainFacts;
use toolbox_report::delay::DelayFacts;
use toolbox_report::fit::EstimateFacts;
use toolbox_report::models::{CurveFacts, ModelRootsFacts};
use toolbox_report::order::OrderFacts;
use toolbox_report::residuals::ResidualFacts;
use toolbox_report::response::ResponseFacts;
use toolbox_report::spectrum::SpectrumFacts;

/// The form of a result as a document.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "the schema is all that is made of it")]
struct Document<T> {
    result: T,
}

/// The form of a study as a document.
#[derive(JsonSchema)]
#[expect(dead_code, reason = "the schema is all that is made of it")]
struct StudyDocument {
    /// Name of the table that holds the samples of the curves, where there is one.
    #[schemars(default, skip_serializing_if = "Option::is_none")]
    series_file: Option<String>,
    /// SHA-256 of that table's bytes.
    #[schemars(default, skip_serializing_if = "Option::is_none")]
    series_sha256: Option<String>,
    study: Study,
}

/// All schemas: name, title, and the type that is written. What a command prints is named after the command.
fn all() -> Vec<(&'static str, Value)> {
    vec![
        ("analyses", of_result(&document::ANALYSES, "All analyses beside a study")),
        ("can-map-output", of::<CapabilityFacts>("What `dynoid can BENCH map --json` prints")),
        ("can-output", of::<PredictedFacts>("What `dynoid can --json` prints")),
        ("can-recorded-output", of::<RunFacts>("What `dynoid can --recorded FILE --json` prints")),
        ("capability-map", of_result(&capabilities::MAP, "The largest sines that a bench can do")),
        ("controller-output", of::<SpeedControlFacts>("What `dynoid controller --json` prints")),
        ("cycle-validation", of_result(&capabilities::VALIDATION, "Judgement of a run of a cycle")),
        ("data-delay-output", of::<DelayFacts>("What `dynoid data delay --json` prints")),
        ("data-order-output", of::<OrderFacts>("What `dynoid data order --json` prints")),
        ("data-spectrum-output", of::<Vec<SpectrumFacts>>("What `dynoid data spectrum --json` prints")),
        ("easier", of_result(&capabilities::EASIER, "Changes with which a bench can run a test")),
        ("engine-output", of::<EngineFacts>("What `dynoid engine --json` prints")),
        ("engine-torque", of_result(&document::ENGINE_TORQUE, "The torque of the engine")),
        ("excitation-design", of_result(&ExcitationDesign::DOCUMENT, "A designed excitation")),
        ("experiment-check-output", of::<CheckFacts>("What `dynoid experiment check --json` prints")),
        ("experiment-design-output", of::<DesignFacts>("What `dynoid experiment design --json` prints")),
        ("experiment-next-output", of::<NextExperiments>("What `dynoid experiment next --json` prints")),
        ("experiment-simulate-output", of::<SimulationFacts>("What `dynoid experiment simulate --json` prints")),
        ("fit-output", of::<EstimateFacts>("What `dynoid fit --json` prints")),
        ("friction", of_result(&document::FRICTION, "Friction of the dynamometer")),
        ("friction-output", of::<FrictionFacts>("What `dynoid friction --json` prints")),
        ("gradients", of_result(&capabilities::GRADIENTS, "The largest gradients of the speed")),
        ("init-output", of::<ProposalFacts>("What `dynoid init --json` prints")),
        ("inspect-list-output", of::<Vec<Listing>>("What `dynoid inspect --list --json` prints")),
        ("inspect-output", of::<Vec<File>>("What `dynoid inspect --json` prints")),
        ("linear-model", with_header_of(of::<ModelDocument>("A model file of `dynoid fit`"), &linear_model())),
        ("lines", of_result(&document::LINES, "Lines of the spectra")),
        ("lines-output", of::<LinesFacts>("What `dynoid lines --json` prints")),
        ("model", with_header_of(of::<BenchModelDocument>("A bench model, such as model.json"), &bench_model())),
        ("model-bode-output", of::<Vec<CurveFacts>>("What `dynoid model bode --json` prints")),
        ("model-compare-output", of::<Vec<MetFacts>>("What `dynoid model compare --json` prints of linear models")),
        ("model-comparison", of_result(&document::MODEL_COMPARISON, "Two bench models, compared")),
        (
            "model-convert-zpk-output",
            of::<Vec<ZeroPoleGainFacts>>("What `dynoid model convert --to zpk --json` prints"),
        ),
        ("model-poles-output", of::<Vec<ModelRootsFacts>>("What `dynoid model poles --json` prints")),
        ("model-predict-output", of::<Vec<ResponseFacts>>("What `dynoid model predict --json` prints")),
        ("model-residuals-output", of::<ResidualFacts>("What `dynoid model residuals --json` prints")),
        (
            "model-simulate-output",
            of::<Vec<ResponseFacts>>("What `dynoid model simulate --json` prints of linear models"),
        ),
        ("model-step-output", of::<Vec<CurveFacts>>("What `dynoid model step --json` prints")),
        ("next-experiments", of_result(&document::NEXT_EXPERIMENTS, "Experiments to record next")),
        ("noise-test", of_result(&document::NOISE_TEST, "Effect of noise on the estimate of a PI controller")),
        ("safety-check", of_result(&SafetyCheck::DOCUMENT, "Check of an experiment against the limits of a bench")),
        ("shaft", of_result(&document::SHAFT, "The shaft")),
        ("shaft-output", of::<ShaftFacts>("What `dynoid shaft --json` prints")),
        ("speed-control", of_result(&document::SPEED_CONTROL, "The speed controller")),
        ("study", study()),
        ("study-output", of::<WrittenFacts>("What `dynoid study --json` prints")),
        ("torque-control", of_result(&document::TORQUE_CONTROL, "Models of the torque control, compared")),
        ("torque-control-output", of::<TorqueControlFacts>("What `dynoid torque-control --json` prints")),
        ("torque-signals", of_result(&document::TORQUE_SIGNALS, "The torque signals")),
        ("torque-signals-output", of::<TorqueSignalsFacts>("What `dynoid torque-signals --json` prints")),
        ("verdict", of_result(&capabilities::VERDICT, "Answer to whether a bench can run a test")),
        ("wanted", of_result(&capabilities::WANTED, "Answer to a wanted sine or gradient")),
    ]
}

/// The schema of what is written of a type.
fn of<T: JsonSchema>(title: &str) -> Value {
    let settings = SchemaSettings::draft2020_12().for_serialize();
    let settings = settings.with_transform(RecursiveTransform(as_written));
    let mut schema = settings.into_generator().into_root_schema_for::<T>();
    schema.insert("title".to_owned(), title.into());
    schema.to_value()
}

/// The same of a result in its document.
fn of_result<T: JsonSchema>(format: &ResultFormat<T>, title: &str) -> Value {
    with_header(
        of::<Document<T>>(title),
        &[("format", json!(format.format())), ("format_version", json!(format.version()))],
    )
}

fn study() -> Value {
    let header = [("format", json!("dynoid-study")), ("format_version", json!(document::FORMAT_VERSION))];
    with_header(of::<StudyDocument>("A study, such as study.json"), &header)
}

/// The schema with what the document states of itself.
fn with_header(mut schema: Value, header: &[(&str, Value)]) -> Value {
    for (name, value) in header {
        schema["properties"][name] = json!({"const": value});
        let required = schema["required"].as_array_mut().expect("a list of required fields");
        if !required.contains(&json!(name)) {
            required.push(json!(name));
        }
    }
    schema
}

/// The schema with the format and the version of this document.
fn with_header_of(schema: Value, document: &Value) -> Value {
    let header = ["format", "version"].map(|name| (name, document[name].clone()));
    with_header(schema, &header)
}

fn bench_model() -> Value {
    serde_json::to_value(documents::of_model(models::bench_a())).expect("a document")
}

fn linear_model() -> Value {
    let (a, b) = (vec![vec![-0.5]], vec![vec![1.0]]);
    let equation = PolynomialEquation { a, b, f: vec![vec![]], nk: vec![1], ..PolynomialEquation::default() };
    let model = PolynomialModel::new(0.01, vec![equation], faer::mat![[0.25]]).expect("a model");
    let label = |name: &str| vec![ident::Label { name: name.to_owned(), unit: "Nm".to_owned() }];
    serde_json::to_value(ModelDocument::new(model, label("u"), label("y"), 0.01)).expect("a document")
}

/// Makes the schema that of the text: numbers that are not finite are null, and descriptions are for readers without
/// the source.
fn as_written(schema: &mut Schema) {
    if schema.get("type") == Some(&json!("number")) {
        schema.insert("type".to_owned(), json!(["number", "null"]));
    }
    // Widths of numbers in memory, of which the text knows nothing.
    schema.remove("format");
    if let Some(Value::String(text)) = schema.get("description") {
        let plain = plain(text);
        schema.insert("description".to_owned(), plain.into());
    }
}

/// A doc comment without its examples, its line breaks and its links.
fn plain(comment: &str) -> String {
    let text = comment.split("\n# Example").next().unwrap_or_default().trim();
    let paragraphs: Vec<String> = text.split("\n\n").map(|paragraph| paragraph.replace('\n', " ")).collect();
    paragraphs.join("\n\n").replace("[`", "`").replace("`]", "`")
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../docs/schemas")
}

#[test]
fn snap_schemas_are_those_of_the_types() {
    let is_written = env::var_os("DYNOID_WRITE_SCHEMAS").is_some();
    let made = all();
    let names: Vec<&str> = made.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, SCHEMAS.iter().map(|schema| schema.name).collect::<Vec<_>>());
    for (name, mut schema) in made {
        schema["$id"] = json!(format!("urn:dynoid:schema:{name}"));
        let text = serde_json::to_string_pretty(&schema).expect("JSON") + "\n";
        let path = folder().join(format!("{name}.json"));
        if is_written {
            fs::write(&path, &text).expect("a file that can be written");
        }
        let committed = fs::read_to_string(&path).unwrap_or_default();
        assert!(
            committed == text,
            "docs/schemas/{name}.json differs from its types: run `cargo xtask schemas`, and look at what changes"
        );
    }
}

#[test]
fn exact_model_files_have_the_form_of_their_schemas() {
    assert_valid("model", &bench_model());
    assert_valid("linear-model", &linear_model());
}
