//! Results of conversions, fits and judgements are data: they are read from JSON as they were written.

use std::fmt::Debug;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use dynoid::convert::{Conversion, ConvertOptions, Converted};
use dynoid::experiments::{BenchParameters, ExperimentPlan, VirtualRecordings};
use dynoid::linear::{
    ComparedModels, DataOptions, FitData, FitNeeds, Judging, LinearFit, MeetOptions, Method, ModelResponse, NamedModel,
    ResponseOptions, TestedResiduals,
};
use dynoid::replay::{BenchReplays, ReplayOptions, ReplayedStretch};
use dynoid::{Bench, Error, Fault, FileFormat, Files, Models, Session};
use ident::ContinuousTransferFunction;
use serde::Serialize;
use serde::de::DeserializeOwned;
use tempfile::TempDir;
use work::Context;

fn files() -> Files {
    Files::new("test", false)
}

#[track_caller]
fn assert_read_back<T: Serialize + DeserializeOwned + PartialEq + Debug>(facts: &T) {
    let text = serde_json::to_string(facts).unwrap();
    let read = serde_json::from_str::<T>(&text).unwrap();
    // A number that is not known is NaN, which equals nothing.
    assert_eq!(format!("{read:?}"), format!("{facts:?}"), "{text}");
}

/// A folder with recordings of a virtual bench.
fn recorded(plans: &[ExperimentPlan]) -> (TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let simulated = VirtualRecordings::of(&BenchParameters::default(), plans, 1, &Context::new()).unwrap();
    let paths = simulated.write(folder.path(), &files()).unwrap();
    (folder, paths)
}

fn convert(recordings: &[PathBuf], out: &Path, options: ConvertOptions) -> Result<Vec<Converted>, Error> {
    let (files, mut all) = (files(), Vec::new());
    let conversion = Conversion::into_folder(files.named(recordings)?, out, FileFormat::Csv, options, &files)?;
    conversion.run(&files, &Context::new(), |converted| all.push(converted))?;
    Ok(all)
}

#[test]
fn exact_conversions_are_read_as_they_were_written_and_one_fault_leaves_the_others() {
    let (folder, mut recordings) = recorded(&[ExperimentPlan::bs_t_nt(1200.0, 2.0)]);
    let damaged = folder.path().join("damaged.csv");
    std::fs::write(&damaged, "no numbers\n").unwrap();
    recordings.push(damaged);
    let (out, options) = (folder.path().join("out"), ConvertOptions { with_hashes: true, ..ConvertOptions::default() });
    let all = convert(&recordings, &out, options).unwrap();
    assert!(matches!(&all[..], [Converted::Written(_), Converted::Failed { .. }]), "{all:?}");
    all.iter().for_each(|converted| assert_read_back(&converted.facts()));
    let Converted::Written(written) = &all[0] else { panic!("it was written") };
    assert!(Path::new(&written.facts().out).is_file() && written.facts().sha256.is_some());
    assert_eq!(written.facts().channels.len(), written.recording().channels.len());

    let named = |channel: &str| ConvertOptions { channels: vec![channel.to_owned()], ..ConvertOptions::default() };
    let both = [recordings[0].clone(), folder.path().join("copy.mf4")];
    std::fs::copy(&both[0], &both[1]).unwrap();
    let error = convert(&both, &folder.path().join("other"), named("NoSuch")).unwrap_err();
    assert!(matches!(error, Error::NoSuchChannel { .. }), "{error}");
    assert!(!error.to_string().contains("--"), "{error}");
    let late = ConvertOptions { start_s: Some(2.0), end_s: Some(1.0), ..ConvertOptions::default() };
    let error = convert(&recordings, &out, late).unwrap_err();
    assert!(error.fault() == Fault::Request && !error.to_string().contains("--"), "{error}");
    let twice = [recordings[0].clone(), recordings[0].clone()];
    let error = convert(&twice, &out, ConvertOptions::default()).unwrap_err();
    assert!(matches!(error, Error::OneTarget { .. }), "{error}");
}

#[test]
fn exact_a_fit_and_its_judgements_are_read_as_they_were_written() {
    let (folder, recordings) = recorded(&[ExperimentPlan::white_noise_t_tn(1200.0, 5.0)]);
    let (files, context, mut notes) = (files(), Context::new(), Vec::new());
    let options = DataOptions::of(&recordings, &["DynoTorqueDemand"], &["DynoTorqueCalc"]);
    let data = FitData::read(&options, &Judging::Split(0.5), FitNeeds::SIMULATION, &files, &context).unwrap();
    let lag = Method::TransferFunction(Box::new(ContinuousTransferFunction::new(0, 1)));
    let fit = LinearFit::of(data, &lag, "lag", &context).unwrap();
    assert_read_back(&fit.facts());
    assert!(fit.natural_frequencies_hz().unwrap().len() == 1 && !fit.integrates());

    let path = folder.path().join("lag.json");
    fit.write(&path, &files).unwrap();
    let Models::Linear(models) = files.models(&[path]).unwrap() else { panic!("a linear model") };
    let meet = MeetOptions::of(&recordings);
    let compared = ComparedModels::of(&models, &meet, None, &files, &context, &mut notes).unwrap();
    assert!(compared.failures().next().is_none());
    assert_read_back(&compared.facts());
    let tested = TestedResiduals::of(&models[0].document, &meet, 5, &files, &context, &mut notes).unwrap();
    assert_read_back(&tested.facts());
    let error = TestedResiduals::of(&models[0].document, &meet, 0, &files, &context, &mut notes).unwrap_err();
    assert!(error.fault() == Fault::Request && !error.to_string().contains("--"), "{error}");
    let respond = |horizon: Option<NonZeroUsize>| {
        let (model, mut notes) = (NamedModel::clone(&models[0]), Vec::new());
        let response = ResponseOptions { horizon, from_rest: false };
        ModelResponse::of(model, &meet, response, &files, &context, &mut notes).unwrap()
    };
    let (simulated, predicted) = (respond(None), respond(NonZeroUsize::new(1)));
    assert_read_back(&simulated.facts());
    assert_eq!(simulated.recording().unwrap().channels[0].name, "DynoTorqueCalc_simulated");
    assert_eq!(predicted.recording().unwrap().channels[0].name, "DynoTorqueCalc_predicted");
}

#[test]
fn exact_replays_are_read_as_they_were_written() {
    let plans = [ExperimentPlan::bs_t_nt(1200.0, 16.0), ExperimentPlan::white_noise_t_tn(1200.0, 16.0)];
    let (folder, recordings) = recorded(&plans);
    let (files, context, mut notes) = (files(), Context::new(), Vec::new());
    let mut file = bench_testkit::benches::default_bench();
    file.recordings.files = vec!["*.mf4".to_owned()];
    let bench = folder.path().join("bench.toml");
    std::fs::write(&bench, file.to_toml()).unwrap();
    let session = Session::open(Bench::of(&bench, file), &files, &context).unwrap();
    let document = session.bench_model(&context).unwrap();
    let model = dynoid::replay::BenchModelFile { path: folder.path().join("study/model.json"), document };
    let options = ReplayOptions {
        recordings: recordings[..1].to_vec(),
        stretch: ReplayedStretch::AsStudy,
        bench: None,
        mode: None,
    };
    let found = BenchReplays::of(&[model], &options, &files, &context, &mut notes).unwrap();
    let facts = found.facts();
    assert!(
        facts[0].seen_in_estimation && facts[0].signals.iter().all(|signal| signal.fit_percent > 50.0),
        "{facts:?}"
    );
    assert_read_back(&facts);
    assert_eq!(found.recording().channels.len(), facts[0].signals.len());
}
