//! Any text may be read as a bench model, and what is read may be exported: `cargo +nightly fuzz run model_file`.
#![no_main]

use bench_model::document::BenchModelDocument;
use export::names::Names;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let Ok(document) = BenchModelDocument::from_json(text) else { return };
    let names = Names::of(&document.bench.name);
    let _ = export::python::bench(&document, &names);
    let _ = export::ssv::bench(&document, &names, 2);
    let _ = export::fmu::c_files(&document, &names);
    let _ = export::toolbox_models(&document);
    let again = document.to_json().ok().map(|text| BenchModelDocument::from_json(&text));
    assert_eq!(again, Some(Ok(document)));
});
