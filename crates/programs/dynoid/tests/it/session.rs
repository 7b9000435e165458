//! A bench with recordings in memory, and errors that name the bench file.

use bench_testkit::benches::default_bench;
use dynoid::{Bench, Error, Files, Session};
use rig::bench_parameters::BenchParameters;
use rig::experiment::ExperimentPlan;
use study::Source;
use work::Context;

#[test]
fn exact_a_session_of_recordings_in_memory_gives_study_and_controller() {
    let context = Context::new();
    let recording = virtual_bench::simulate(&BenchParameters::default(), &ExperimentPlan::bs_t_nt(1200.0, 16.0), 1);
    let source =
        Source { file: "BS_T_NT_1200.mf4".to_owned(), sha256: "of it".to_owned(), recording: Ok(recording.unwrap()) };
    let session = Session::of(Bench::of("bench.toml".as_ref(), default_bench()), vec![source], &context);
    assert_eq!(session.experiments().len(), 1, "{:?}", session.doubts());
    let (first, second) = (session.study(&context).unwrap(), session.study(&context).unwrap());
    assert_eq!(first, second, "a session keeps its recordings");
    assert!(first.speed_controller.estimated().is_some());
    assert_eq!(session.controller(&context).controllers.len(), 1);
}

#[test]
fn regress_a_bench_without_recordings_says_so() {
    let context = Context::new();
    let session = Session::without_recordings(Bench::of("cell/bench.toml".as_ref(), default_bench()));
    assert!(matches!(session.study(&context), Err(Error::NoRecordingsListed { path }) if path.ends_with("bench.toml")));
    assert!(session.friction().is_err());
}

#[test]
fn regress_a_faulty_bench_file_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bench.toml");
    std::fs::write(&path, "[bench]\nname = 3\n").unwrap();
    let error = Bench::load(&path, &Files::new("test", false)).unwrap_err();
    assert!(matches!(&error, Error::BenchFile { path: named, .. } if *named == path), "{error}");
}
