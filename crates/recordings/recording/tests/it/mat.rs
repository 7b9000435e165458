//! MAT-files: what becomes a clock and what a channel, and the files of others against scipy.

use std::collections::BTreeMap;

use recording::{
    Channel, Finding, Recording, RecordingError, Selection, SkipReason, catalogue, decode, decode_untimed, encode_mat5,
};

use testdata::shared;

const VARIABLES: &[u8] = include_bytes!("data/mat/variables.mat");
const DEFLATED: &[u8] = include_bytes!("data/mat/variables_deflated.mat");

fn read(bytes: &[u8]) -> Recording {
    decode("a.mat", bytes, &Selection::All).unwrap()
}

fn channel<'a>(recording: &'a Recording, name: &str) -> &'a Channel {
    recording.channel(name).unwrap_or_else(|| panic!("no {name} in {:?}", names(recording)))
}

fn names(recording: &Recording) -> Vec<&str> {
    recording.channels.iter().map(|c| c.name.as_str()).collect()
}

/// Samples and time stamps of a channel.
fn data<'a>(recording: &'a Recording, name: &str) -> (&'a [f64], &'a [f64]) {
    let channel = channel(recording, name);
    (&channel.samples, recording.time_s(channel).unwrap())
}

fn reason<'a>(recording: &'a Recording, name: &str) -> &'a SkipReason {
    let skipped = recording.findings.iter().find_map(|finding| match finding {
        Finding::SkippedChannel { channel, reason } if channel == name => Some(reason),
        _ => None,
    });
    skipped.unwrap_or_else(|| panic!("{name} is not skipped: {:?}", recording.findings))
}

const TIME: [f64; 6] = [0.0, 0.01, 0.02, 0.03, 0.04, 0.05];

#[test]
fn exact_arrays_of_every_class_become_channels() {
    let recording = read(VARIABLES);
    assert_eq!(recording.format.to_string(), "MAT 5");
    let expected: [(&str, [f64; 6]); 10] = [
        ("torque", [0.5, 1.5, 2.5, 3.5, 4.5, 5.5]),
        ("counts", [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0]),
        ("single", [0.0, 0.25, 0.5, 0.75, 1.0, 1.25]),
        ("on", [1.0, 0.0, 1.0, 1.0, 0.0, 1.0]),
        ("big", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0].map(|n| n + 1_099_511_627_776.0)),
        ("wide(2,:)", [6.0, 7.0, 8.0, 9.0, 10.0, 11.0]),
        ("tall(:,1)", [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]),
        ("tall(:,2)", [1.0, 3.0, 5.0, 7.0, 9.0, 11.0]),
        ("deep", [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]),
        ("cells{1}", [100.0, 101.0, 102.0, 103.0, 104.0, 105.0]),
    ];
    for (name, samples) in expected {
        assert_eq!(data(&recording, name), (&samples[..], &TIME[..]), "{name}");
    }
    assert_eq!(channel(&recording, "torque").unit, "Nm");
}

#[test]
fn exact_what_is_no_channel_is_said() {
    let recording = read(VARIABLES);
    let texts = [
        ("gain", "it is the single number 7.25, not samples over time"),
        ("nothing", "it holds nothing, not numbers"),
        ("text", "it holds text, not numbers"),
        ("z", "it holds complex numbers, not numbers"),
        ("sparse", "it is stored in a way not supported: a sparse matrix; save it as a full one"),
        ("cube", "it is stored in a way not supported: an array of 3 dimensions"),
        ("cells{2}", "it holds text, not numbers"),
    ];
    for (name, text) in texts {
        assert_eq!(reason(&recording, name).to_string(), text, "{name}");
    }
    assert_eq!(*reason(&recording, "alone"), SkipReason::NoTimeVector { samples: 3 });
    let error = decode("a.mat", VARIABLES, &Selection::names(["alone"])).unwrap_err();
    assert!(matches!(error, RecordingError::UnusableChannel { .. }), "{error}");
}

#[test]
fn exact_structs_have_clocks_of_their_own() {
    let recording = read(VARIABLES);
    assert_eq!(data(&recording, "run.sub.y"), (&[5.0, 6.0, 7.0][..], &[0.0, 1.0, 2.0][..]));
}

#[test]
fn exact_simulink_structure_with_time() {
    let recording = read(VARIABLES);
    assert_eq!(data(&recording, "sim.speed"), (&[0.0, 2.0, 4.0, 6.0, 8.0, 10.0][..], &TIME[..]));
    assert_eq!(channel(&recording, "sim.speed").comment, "plant/Speed");
    assert_eq!(channel(&recording, "sim.signals(2).values(:,2)").samples[5], 25.0);
    let of_sim = |f: &&Finding| f.to_string().contains("\"sim.signals");
    assert_eq!(recording.findings.iter().filter(of_sim).count(), 0, "{:?}", recording.findings);
}

#[test]
fn exact_data_with_a_sample_time() {
    let recording = read(VARIABLES);
    let clock = [0.0, 0.0005, 0.001, 0.0015];
    assert_eq!(data(&recording, "data.voltage"), (&[1.0, 2.0, 3.0, 4.0][..], &clock[..]));
    assert_eq!(data(&recording, "data.speed"), (&[1.0, 3.0, 5.0, 7.0][..], &clock[..]));
    assert_eq!(channel(&recording, "data.speed").unit, "rad/s");
}

#[test]
fn exact_deflated_and_catalogued_alike() {
    let plain = read(VARIABLES);
    assert_eq!(read(DEFLATED), plain);
    assert_eq!(catalogue("a.mat", DEFLATED).unwrap(), plain.catalogue());
}

#[test]
fn exact_both_byte_orders_and_level_4() {
    let bytes = include_bytes!("data/mat/level4.mat");
    let level4 = read(bytes);
    assert_eq!((level4.format.to_string().as_str(), names(&level4)), ("MAT 4", vec!["y(:,1)", "y(:,2)", "k"]));
    assert_eq!(data(&level4, "y(:,2)"), (&[1.0, 3.0, 5.0, 7.0, 9.0, 11.0][..], &TIME[..]));
    assert!(matches!(reason(&level4, "z"), SkipReason::NotNumeric { .. }));
    for bytes in [&include_bytes!("data/mat/big_endian.mat")[..], include_bytes!("data/mat/big_endian4.mat")] {
        assert_eq!(data(&read(bytes), "y"), (&[-1.0, 2.0, -300.0, 4.0, 5.0, 6.0][..], &TIME[..]));
    }
}

#[test]
fn exact_untimed_arrays_get_the_row_distance() {
    let recording = decode_untimed("a.mat", VARIABLES, 0.5).unwrap();
    assert_eq!(data(&recording, "alone"), (&[1.0, 2.0, 3.0][..], &[0.0, 0.5, 1.0][..]));
    assert_eq!(data(&recording, "torque").1, TIME);
    assert!(decode_untimed("a.mat", VARIABLES, 0.0).is_err());
}

/// A recording of one raster as plain variables, without the list that [`encode_mat5`] puts first.
fn plain(time: (&str, &[f64]), channels: &[(&str, &[f64])]) -> Vec<u8> {
    let mut bytes = include_bytes!("data/mat/variables.mat")[..128].to_vec();
    for (name, samples) in std::iter::once(&time).chain(channels) {
        bytes.extend(variable(name, samples));
    }
    bytes
}

/// A column vector as an element of level 5.
pub(crate) fn variable(name: &str, samples: &[f64]) -> Vec<u8> {
    let rows = u32::try_from(samples.len()).unwrap().to_le_bytes();
    let numbers: Vec<u8> = samples.iter().flat_map(|s| s.to_le_bytes()).collect();
    let parts = [
        element(6, &[6, 0, 0, 0, 0, 0, 0, 0]),
        element(5, &[rows, [1, 0, 0, 0]].concat()),
        element(1, name.as_bytes()),
        element(9, &numbers),
    ];
    element(14, &parts.concat())
}

/// A text as an element of level 5.
fn words(name: &str, text: &str) -> Vec<u8> {
    let columns = u32::try_from(text.len()).unwrap().to_le_bytes();
    let parts = [
        element(6, &[4, 0, 0, 0, 0, 0, 0, 0]),
        element(5, &[[1, 0, 0, 0], columns].concat()),
        element(1, name.as_bytes()),
        element(16, text.as_bytes()),
    ];
    element(14, &parts.concat())
}

/// Tag, content and padding.
pub(crate) fn element(kind: u32, content: &[u8]) -> Vec<u8> {
    let size = u32::try_from(content.len()).unwrap();
    let mut bytes = [kind.to_le_bytes(), size.to_le_bytes()].concat();
    bytes.extend_from_slice(content);
    bytes.resize(bytes.len().next_multiple_of(8), 0);
    bytes
}

#[test]
fn exact_units_of_time() {
    let ramp = [0.0, 400.0, 800.0, 1200.0];
    let named = read(&plain(("time_us", &ramp), &[("y", &ramp)]));
    assert_eq!(named.rasters[0].time_s, [0.0, 0.0004, 0.0008, 0.0012]);
    let stated = read(&plain(("time", &ramp), &[("y", &ramp), ("fs", &[2500.0])]));
    assert_eq!(stated.rasters[0].time_s, named.rasters[0].time_s);
    let assumed = Finding::AssumedTimeUnit { clock: "time".into(), unit: "us".into(), stated_by: "fs".into() };
    assert!(stated.findings.contains(&assumed));
    let seconds = read(&plain(("time", &ramp), &[("y", &ramp), ("fs", &[1.0 / 400.0])]));
    assert_eq!(seconds.rasters[0].time_s, ramp);
}

/// A text beside a clock states its unit, as it does beside a channel.
#[test]
fn exact_the_unit_beside_a_clock_counts() {
    let ramp = [0.0, 10.0, 20.0];
    let of = |clock: &str, name: &str, text: &str| {
        read(&[plain((clock, &ramp), &[("n", &ramp)]), words(name, text)].concat())
    };
    let milliseconds = [0.0, 0.01, 0.02];
    let stated = [
        ("time", "time_unit"),
        ("t", "t_units"),
        ("t", "time_unit"),
        ("Time", "TimeUnit"),
        ("time_ms", "time_ms_unit"),
    ];
    for (clock, name) in stated {
        for text in ["ms", "[ms]", "Milliseconds"] {
            let recording = of(clock, name, text);
            assert_eq!(
                (data(&recording, "n").1, &recording.findings[..]),
                (&milliseconds[..], &[][..]),
                "{name} {text}"
            );
        }
    }
    assert_eq!(data(&of("time", "time_unit", ""), "n").1, ramp);
    for (clock, name, text) in [("time", "time_unit", "rpm"), ("time_ms", "time_ms_unit", "us")] {
        let (clock, unit) = (clock.to_owned(), text.to_owned());
        assert_eq!(*reason(&of(&clock, name, text), "n"), SkipReason::TimeUnit { clock, unit });
    }
    // Of two clocks, the text is the one's whose name it bears.
    let long = [0.0, 1.0, 2.0, 3.0];
    let two = plain(("time", &ramp), &[("n", &ramp), ("t", &long), ("m", &long)]);
    let two = read(&[two, words("time_unit", "ms")].concat());
    assert_eq!((data(&two, "n").1, data(&two, "m").1), (&milliseconds[..], &long[..]));
}

/// A stated unit is not overruled by a number beside it.
#[test]
fn regress_a_stated_unit_is_no_assumption() {
    let ramp = [0.0, 10.0, 20.0];
    let bytes = [plain(("t", &ramp), &[("n", &ramp), ("dt", &[0.01])]), words("t_unit", "s")].concat();
    assert_eq!(data(&read(&bytes), "n").1, ramp);
}

#[test]
fn regress_a_capital_t_is_no_clock() {
    let (rising, rest) = ([20.0, 55.0, 90.0], [1.0, -1.0, 0.5]);
    let alone = read(&plain(("T", &rising), &[("n", &rest)]));
    assert_eq!(*reason(&alone, "n"), SkipReason::NoTimeVector { samples: 3 });
    let both = read(&plain(("t", &[0.0, 0.1, 0.2]), &[("T", &rising), ("n", &rest)]));
    assert_eq!(data(&both, "T"), (&rising[..], &[0.0, 0.1, 0.2][..]));
    assert_eq!(names(&both), ["T", "n"]);
}

/// Beside a period, a numbered letter is a clock if its steps are that long.
#[test]
fn regress_a_temperature_beside_a_period_is_no_clock() {
    let (rising, rest) = ([20.0, 55.0, 90.0], [1.0, -1.0, 0.5]);
    let of = |name: &str, clock: &[f64]| read(&plain((name, clock), &[("n", &rest), ("dt", &[0.01])]));
    let temperature = of("t1", &rising);
    assert_eq!(names(&temperature), Vec::<&str>::new());
    for name in ["t1", "n"] {
        assert_eq!(*reason(&temperature, name), SkipReason::NoTimeVector { samples: 3 });
    }
    assert_eq!(data(&of("t1", &[5.0, 5.01, 5.02]), "n").1, [5.0, 5.01, 5.02]);
    assert_eq!(data(&of("t1", &[0.0, 10.0, 20.0]), "n").1, [0.0, 0.01, 0.02]);
    // A name that says time is believed.
    assert_eq!(data(&of("t", &rising), "n").1, rising);
    assert_eq!(data(&of("time_1", &rising), "n").1, rising);
}

#[test]
fn exact_clocks_that_are_none_or_too_many() {
    let falling = read(&plain(("t", &[3.0, 2.0, 1.0]), &[("y", &[1.0, 2.0, 3.0])]));
    assert_eq!(names(&falling), Vec::<&str>::new());
    assert_eq!(*reason(&falling, "y"), SkipReason::NoTimeVector { samples: 3 });
    let two = plain(("t", &[1.0, 2.0, 3.0]), &[("time", &[2.0, 4.0, 6.0]), ("y", &[1.0, 2.0, 3.0])]);
    assert_eq!(*reason(&read(&two), "y"), SkipReason::AmbiguousTime { candidates: "t, time".into() });
    let numbered = plain(("t", &[1.0, 2.0, 3.0]), &[("t2", &[2.0, 4.0, 6.0])]);
    assert_eq!(data(&read(&numbered), "t2"), (&[2.0, 4.0, 6.0][..], &[1.0, 2.0, 3.0][..]));
    let both = read(&plain(("t", &[1.0, 2.0, 3.0]), &[("time", &[1.0, 2.0, 3.0]), ("y", &[1.0, 2.0, 3.0])]));
    assert_eq!((names(&both), both.rasters.len()), (vec!["y"], 1));
}

#[test]
fn exact_a_missing_variable_of_the_list_is_said() {
    let whole = decode("a.csv", b"time [s],a,b\n0,1,2\n1,3,4\n", &Selection::All).unwrap();
    let bytes = encode_mat5(&whole).unwrap();
    let last = variable("b", &[2.0, 4.0]).len() - 8;
    let cut = read(&bytes[..bytes.len() - last]);
    assert_eq!((names(&cut), &cut.findings), (vec!["a"], &vec![Finding::MissingVariable { variable: "b".into() }]));
}

#[test]
fn exact_variables_added_to_a_list_have_its_clock() {
    let whole = decode("a.csv", b"time [s],\xC3\x96l [\xC2\xB0C]\n0,1\n1,3\n", &Selection::All).unwrap();
    let mut bytes = encode_mat5(&whole).unwrap();
    bytes.extend(variable("extra", &[7.0, 8.0]));
    let read = read(&bytes);
    assert_eq!((names(&read), channel(&read, "Öl").unit.as_str()), (vec!["Öl", "extra"], "°C"));
    assert_eq!(data(&read, "extra"), (&[7.0, 8.0][..], &[0.0, 1.0][..]));
}

#[test]
fn regress_text_with_the_mark_of_a_mat_file_is_text() {
    let mut csv = b"a,b".to_vec();
    csv.resize(126, b'x');
    csv.extend_from_slice(b"MI\n1,2\n");
    let error = decode("a.csv", &csv, &Selection::All).unwrap_err();
    assert!(matches!(error, RecordingError::Csv { .. }), "{error}");
}

#[test]
fn exact_level_7_3_has_the_same_rules() {
    let bytes = include_bytes!("data/mat/variables73.mat");
    let recording = read(bytes);
    assert_eq!(recording.format.to_string(), "MAT 7.3");
    let expected: [(&str, [f64; 6]); 6] = [
        ("torque", [0.5, 1.5, 2.5, 3.5, 4.5, 5.5]),
        ("counts", [-3.0, -2.0, -1.0, 0.0, 1.0, 2.0]),
        ("on", [1.0, 0.0, 1.0, 1.0, 0.0, 1.0]),
        ("tall(:,2)", [1.0, 3.0, 5.0, 7.0, 9.0, 11.0]),
        ("cells{1}", [100.0, 101.0, 102.0, 103.0, 104.0, 105.0]),
        ("many(2).v", [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]),
    ];
    for (name, samples) in expected {
        assert_eq!(data(&recording, name), (&samples[..], &TIME[..]), "{name}");
    }
    assert_eq!(channel(&recording, "torque").unit, "Nm");
    assert_eq!(data(&recording, "run.sub.y"), (&[5.0, 6.0, 7.0][..], &[0.0, 1.0, 2.0][..]));
    let clock = [0.0, 0.0005, 0.001, 0.0015];
    assert_eq!(data(&recording, "data.speed"), (&[1.0, 3.0, 5.0, 7.0][..], &clock[..]));
    assert_eq!(recording.channels.len(), 10);
}

const TABLES: &[u8] = include_bytes!("data/mat/tables.mat");
const TABLES73: &[u8] = include_bytes!("data/mat/tables73.mat");

#[test]
fn ref_timetables_are_read_as_mat_io_writes_them() {
    for bytes in [TABLES, TABLES73] {
        let recording = read(bytes);
        let rows = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let half_seconds = rows.map(|row| row / 2.0);
        assert_eq!(data(&recording, "run.speed"), (&rows.map(|row| 1000.0 + row)[..], &half_seconds[..]));
        assert_eq!(channel(&recording, "run.speed").unit, "rpm");
        assert_eq!(data(&recording, "run.torque"), (&[-3.0, -2.0, -1.0, 0.0, 1.0, 2.0][..], &half_seconds[..]));
        assert_eq!(channel(&recording, "run.torque").unit, "");
        let quarters = rows.map(|row| row / 4.0);
        assert_eq!(data(&recording, "dated.load"), (&rows.map(|row| 10.0 * row)[..], &quarters[..]));
        // 2024-03-01 10:00:00.250, in no time zone.
        let start = recording.start_time.unwrap();
        assert_eq!((start.nanoseconds, start.is_local), (1_709_287_200_250_000_000, true));
        let eighths = rows.map(|row| 2.0 + row / 8.0);
        assert_eq!(data(&recording, "stepped.a"), (&rows.map(|row| 3.0 * row)[..], &eighths[..]));
        assert_eq!(data(&recording, "plain"), (&rows.map(|row| 2.0 * row)[..], &TIME[..]));
    }
}

#[test]
fn ref_tables_are_read_as_mat_io_writes_them() {
    let recording = read(TABLES);
    let rows = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
    assert_eq!(data(&recording, "rated.b"), (&rows.map(|row| 4.0 * row)[..], &rows.map(|row| row / 1000.0)[..]));
    assert_eq!(data(&recording, "list.v"), (&rows.map(|row| row * row)[..], &rows.map(|row| row / 50.0)[..]));
    let half_seconds = rows.map(|row| row / 2.0);
    assert_eq!(data(&recording, "log.n"), (&rows.map(|row| 5.0 * row)[..], &half_seconds[..]));
    assert!(reason(&recording, "log.since").to_string().contains("an object of class \"duration\""));
    assert!(reason(&recording, "list.label").to_string().contains("an object of class \"string\""));
    assert_eq!(data(&recording, "stamped.w"), (&rows.map(|row| -row)[..], &rows.map(|row| row / 4.0)[..]));
}

#[test]
fn exact_selected_columns_of_tables_are_read() {
    for bytes in [TABLES, TABLES73] {
        let selected = decode("a.mat", bytes, &Selection::names(["run.torque"])).unwrap();
        assert_eq!(
            selected.channels,
            [channel(&read(bytes), "run.torque").clone()].map(|c| Channel { raster: 0, ..c })
        );
        let listed = catalogue("a.mat", bytes).unwrap();
        assert_eq!(listed.channels, read(bytes).catalogue().channels);
    }
}

/// The links between objects and contents are not believed: the rest of the file is read.
#[test]
fn exact_damaged_objects_leave_the_other_variables() {
    let whole = read(TABLES73);
    let begin = TABLES73.windows(10).rposition(|window| window == b"timetable\0").unwrap();
    let mut named = 0;
    for at in begin - 48..begin + 250 {
        let mut bytes = TABLES73.to_vec();
        bytes[at] ^= 0x55;
        let Ok(recording) = decode("a.mat", &bytes, &Selection::All) else { continue };
        assert_eq!(data(&recording, "plain"), data(&whole, "plain"), "byte {at}");
        let is_named = |f: &&Finding| matches!(f, Finding::SkippedChannel { channel, .. } if channel == "run");
        named += recording.findings.iter().filter(is_named).count();
    }
    assert!(named > 10, "{named}");
}

/// Objects have their content at the end of the file, in a form of their own; the variable holds a reference to it.
#[test]
fn exact_objects_of_level_5_are_named_with_what_to_do() {
    let object = |name: &str, class: &str| {
        let reference = [0xDD00_0000_u32, 2, 1, 1, 1, 1].map(u32::to_le_bytes).concat();
        let reference = [
            element(6, &[13, 0, 0, 0, 0, 0, 0, 0]),
            element(5, &[6_u32.to_le_bytes(), 1_u32.to_le_bytes()].concat()),
            element(1, b""),
            element(6, &reference),
        ];
        let parts = [
            element(6, &[17, 0, 0, 0, 0, 0, 0, 0]),
            element(1, name.as_bytes()),
            element(1, b"MCOS"),
            element(1, class.as_bytes()),
            element(14, &reference.concat()),
        ];
        element(14, &parts.concat())
    };
    let objects = [
        ("speed", "timeseries", "save t = ts.Time and y = ts.Data"),
        ("run", "timetable", "save t = seconds(tt.Properties.RowTimes"),
        ("logsout", "Simulink.SimulationData.Dataset", "ds{1}.Values.Data"),
        ("other", "containers.Map", "save its arrays"),
    ];
    let mut bytes = plain(("time", &TIME), &[("n", &TIME)]);
    objects.iter().for_each(|(name, class, _)| bytes.extend(object(name, class)));
    let recording = read(&bytes);
    assert_eq!(names(&recording), ["n"]);
    for (name, class, remedy) in objects {
        let text = reason(&recording, name).to_string();
        assert!(text.contains(&format!("an object of class \"{class}\"; ")) && text.contains(remedy), "{text}");
    }
}

#[test]
fn exact_what_is_no_channel_of_level_7_3_is_said() {
    let recording = read(include_bytes!("data/mat/variables73.mat"));
    let texts = [
        ("gain", "it is the single number 7.25, not samples over time"),
        ("nothing", "it holds nothing, not numbers"),
        ("z", "it holds complex numbers, not numbers"),
        ("cube", "it is stored in a way not supported: an array of 3 dimensions"),
        ("cells{2}", "it holds text, not numbers"),
        (
            "table",
            "it is stored in a way not supported: an object of class \"table\"; save s = table2struct(tbl, 'ToScalar', true) \
             (it cannot be read: the file does not hold its content)",
        ),
    ];
    for (name, text) in texts {
        assert_eq!(reason(&recording, name).to_string(), text, "{name}");
    }
    assert_eq!(recording.findings.len(), texts.len(), "{:?}", recording.findings);
}

/// No room is made for a chunk that says it is larger than the file.
#[test]
fn regress_a_chunk_larger_than_the_file_is_damage() {
    let mut bytes = include_bytes!("data/mat/small.h5").to_vec();
    // A leaf of a tree of chunks: signature, kind 1, level, count, two neighbours, then the size of the first chunk.
    let leaf = bytes.windows(5).position(|w| w == b"TREE\x01").unwrap();
    bytes[leaf + 24..leaf + 28].copy_from_slice(&u32::MAX.to_le_bytes());
    let error = decode("a.h5", &bytes, &Selection::All).unwrap_err().to_string();
    assert!(error.contains("lies beyond the end of the file"), "{error}");
}

#[test]
fn regress_chunks_of_a_newer_hdf5_are_not_taken_for_damage() {
    let recording = decode("a.h5", include_bytes!("data/mat/newer.h5"), &Selection::All).unwrap();
    assert_eq!(names(&recording), Vec::<&str>::new());
    let text = reason(&recording, "speed").to_string();
    assert!(text.contains("chunks of HDF5 2.0; write the file with libver=\"v110\""), "{text}");
}

#[test]
fn exact_hdf5_of_other_programs() {
    let recording = decode("a.h5", include_bytes!("data/mat/plain.h5"), &Selection::All).unwrap();
    assert_eq!(
        (recording.format.to_string().as_str(), names(&recording)),
        ("HDF5", vec!["speed", "table(1,:)", "table(2,:)"])
    );
    let clock = [0, 1, 2, 3, 4, 5].map(|i| f64::from(i) / 10.0);
    assert_eq!(data(&recording, "speed"), (&[0.0, 2.0, 4.0, 6.0, 8.0, 10.0][..], &clock[..]));
    assert_eq!(channel(&recording, "speed").unit, "rpm");
    assert_eq!(channel(&recording, "table(2,:)").samples, [1.0, 3.0, 5.0, 7.0, 9.0, 11.0]);
}

#[test]
fn exact_the_unit_on_a_clock_of_hdf5_counts_and_truth_values_are_numbers() {
    let recording = decode("a.h5", include_bytes!("data/mat/clock_unit.h5"), &Selection::All).unwrap();
    assert_eq!(data(&recording, "speed").1, TIME);
    assert_eq!(channel(&recording, "on").samples, [0.0, 1.0, 0.0, 1.0, 0.0, 1.0]);
    assert_eq!(channel(&recording, "half").samples, [-1.0, -0.5, 0.0, 0.5, 1.0, 1.5]);
    assert_eq!(recording.findings, []);
}

#[test]
fn regress_a_soft_link_of_old_hdf5_is_not_taken_for_damage() {
    let error = decode("a.h5", include_bytes!("data/mat/soft_link.h5"), &Selection::All).unwrap_err();
    assert_eq!(error, RecordingError::SoftLink { file: "a.h5".into() });
}

#[test]
fn regress_a_header_of_level_7_3_without_content_is_refused() {
    let mut bytes = VARIABLES[..128].to_vec();
    bytes[125] = 2;
    bytes.resize(512, 0);
    bytes.extend_from_slice(b"\x89HDF\r\n\x1a\n");
    for content in [&bytes[..], b"\x89HDF\r\n\x1a\n\0\0"] {
        let error = decode("a.mat", content, &Selection::All).unwrap_err();
        assert!(matches!(error, RecordingError::Damaged { .. }), "{error}");
    }
}

/// FNV-1a over the little-endian bytes.
fn checksum(samples: &[f64]) -> u64 {
    let bytes = samples.iter().flat_map(|s| s.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn ref_files_equal_scipy() {
    let lines = include_str!("data/mat/reference.txt").lines().filter(|l| !l.starts_with('#'));
    let mut files: BTreeMap<&str, Vec<Vec<&str>>> = BTreeMap::new();
    for line in lines {
        let (file, rest) = line.split_once('\t').unwrap();
        files.entry(file).or_default().push(rest.split('\t').collect());
    }
    for (file, expected) in files {
        let Some(path) = shared(&format!("reference/{file}")) else { continue };
        let bytes = std::fs::read(path).unwrap();
        let timed = decode(file, &bytes, &Selection::All).map(|recording| recording.catalogue());
        assert_eq!(catalogue(file, &bytes), timed, "{file}");
        let recording = decode_untimed(file, &bytes, 1.0).unwrap();
        let mut clocks = 0;
        for fields in &expected {
            let name = fields[0];
            let raster = recording.rasters.iter().find(|r| r.time_s.len().to_string() == fields[1]);
            let Some(samples) = recording.channel(name).map(|c| &c.samples).or(raster.map(|r| &r.time_s)) else {
                assert_eq!(reason(&recording, name), &SkipReason::UnusedTime { samples: 2001 }, "{file}");
                clocks += 1;
                continue;
            };
            clocks += usize::from(recording.channel(name).is_none());
            let sum: f64 = samples.iter().sum();
            let size: f64 = samples.iter().map(|s| s.abs()).sum();
            assert_eq!(samples.len().to_string(), fields[1], "{file} {name}");
            assert!((sum - fields[2].parse::<f64>().unwrap()).abs() <= 1e-9 * size, "{file} {name}: {sum}");
            assert_eq!(format!("{:016x}", checksum(samples)), fields[3], "{file} {name}");
        }
        assert!(clocks <= 1, "{file}: {clocks} are no channels");
        assert_eq!(recording.channels.len() + clocks, expected.len(), "{file}: {:?}", names(&recording));
    }
}
