//! The CSV reader and writer.
use recording::{CsvProblem, Finding, Recording, RecordingError, Selection, SkipReason, StartTime, decode};

fn read(text: &str) -> Recording {
    decode("a.csv", text.as_bytes(), &Selection::All).unwrap()
}

fn problem(text: &str) -> (u64, Option<usize>, CsvProblem) {
    match decode("a.csv", text.as_bytes(), &Selection::All) {
        Err(RecordingError::Csv { line, column, problem, .. }) => (line, column, problem),
        other => panic!("{other:?}"),
    }
}

#[test]
fn exact_dialects_mean_the_same() {
    let dialects = [
        "time [s],n [1/min],M [Nm]\n0,1200,-1.5\n0.5,,2e3\n",
        "\u{FEFF}time;n;M\ns;1/min;Nm\n0;1200;-1,5\n0,5;;2e3\n",
        "Time (s)\tn (1/min)\tM (Nm)\r\n0\t1200\t-1.5\r\n0.5\t\t2e3\r\n",
        "sep=;\ntime [ms];\"n [1/min]\";M [Nm]\n\"0\";1200;-1,5\n500;;2e3\n",
    ];
    for text in dialects {
        let r = read(text);
        assert_eq!(r.rasters.len(), 1, "{text}");
        assert_eq!(r.rasters[0].time_s, [0.0, 0.5], "{text}");
        let heads: Vec<_> = r.channels.iter().map(|c| (c.name.as_str(), c.unit.as_str())).collect();
        assert_eq!(heads, [("n", "1/min"), ("M", "Nm")], "{text}");
        assert_eq!(r.channels[0].samples[0], 1200.0);
        assert!(r.channels[0].samples[1].is_nan());
        assert_eq!(r.channels[1].samples, [-1.5, 2000.0]);
        assert_eq!((r.findings, r.comment), (vec![], None));
    }
}

#[test]
fn exact_blocks_have_their_own_clocks() {
    let r = read("time,a,time,b,c\n0,1,0,10,100\n1,2,,,\n2,3,,,\n");
    assert_eq!(r.rasters[0].time_s, [0.0, 1.0, 2.0]);
    assert_eq!(r.rasters[1].time_s, [0.0]);
    assert_eq!(r.channel("c").unwrap().raster, 1);
    assert_eq!(r.channel("c").unwrap().samples, [100.0]);
    let only = decode("a.csv", b"time,a,time,b\n0,1,0,2\n", &Selection::names(["b"])).unwrap();
    assert_eq!((only.rasters.len(), only.channels.len(), only.channels[0].raster), (1, 1, 0));
}

#[test]
fn exact_what_is_not_understood_names_line_and_column() {
    use CsvProblem as P;
    let text = |text: &str| text.to_owned();
    assert_eq!(problem("time,a\n0,1\n1,x\n"), (3, Some(2), P::NotANumber { text: text("x") }));
    assert_eq!(problem("time,a\n0,1\n1\n"), (3, None, P::ColumnCount { found: 1, expected: 2 }));
    assert_eq!(problem("time,a\n0,1\n1,2,3\n").2, P::ColumnCount { found: 3, expected: 2 });
    assert_eq!(problem("time,a\n0,5,1\n1,0,2\n").2, P::ColumnCount { found: 3, expected: 2 });
    assert_eq!(problem("time;a\n0,5;1.5\n"), (2, Some(2), P::MixedDecimalSigns { text: text("1.5") }));
    assert_eq!(problem("0,1\n1,2\n").2, P::NoHeader);
    assert_eq!(problem("a,b\n1,2\n"), (1, Some(1), P::NoTime { name: text("a") }));
    assert_eq!(problem("T,b\n1,2\n"), (1, Some(1), P::NoTime { name: text("T") }));
    assert_eq!(problem("time [pc],b\n1,2\n").2, P::TimeUnit { unit: text("pc") });
    assert_eq!(problem("time,,b\n1,,3\n2,2,3\n"), (3, Some(2), P::NoName));
    assert_eq!(problem("time,a\n0,1\n,1\n"), (3, Some(1), P::NoTimeStamp));
    assert_eq!(problem("time,a\n0,1\n-,1\n"), (3, Some(1), P::NoTimeStamp));
    assert_eq!(problem("time,a\n,1\n0,1\n"), (2, Some(1), P::NoTimeStamp));
    assert_eq!(problem("time,a\nstart,1\n0,1\n"), (2, Some(1), P::NotATime { text: text("start") }));
    assert_eq!(problem("time,a,time,b\n0,1,0,1\n1,2,,\n2,3,2,3\n"), (4, Some(3), P::Gap));
    assert_eq!(problem("time,a\n").2, P::NoData);
    assert_eq!(problem("hello\n").2, P::NoDelimiter);
}

#[test]
fn exact_a_number_with_two_readings_is_refused_unless_another_tells() {
    use CsvProblem as P;
    let text = |text: &str| text.to_owned();
    let first = |text: &str| read(text).channels[0].samples.clone();
    assert_eq!(problem("time;n\n0;1,234\n1;1,250\n"), (2, Some(2), P::AmbiguousSign { text: text("1,234") }));
    assert_eq!(problem("time\tn\n0\t1.234\n").2, P::AmbiguousSign { text: text("1.234") });
    // A comma that separates columns does not group digits, nor does the point beside it.
    assert_eq!(first("time,n\n0,1.234\n"), [1.234]);
    assert_eq!(problem("time,n\n0,\"1,234\"\n").2, P::AmbiguousSign { text: text("1,234") });
    assert_eq!(first("time;n\n0,000;1,234\n"), [1.234]);
    assert_eq!(first("time;n\n0;1,234\n1;1234,5\n"), [1.234, 1234.5]);
    assert_eq!(first("time;n\n21.11.2026 12:00:00,5;1,234\n"), [1.234]);
    for grouped in ["1.234,5", "1,234.5", "1.234.567", "1 234", "1'234.5", "-12\u{a0}345,6"] {
        let table = format!("time;n\n0,5;{grouped}\n");
        assert_eq!(problem(&table), (2, Some(2), P::GroupedDigits { text: grouped.into() }), "{grouped}");
    }
    // What is not selected tells too, and mixed signs are found in it while nothing is settled.
    let selected = |table: &str| decode("a.csv", table.as_bytes(), &Selection::names(["n"]));
    assert_eq!(selected("time;n;M\n0;1,234;0,5\n").unwrap().channels[0].samples, [1.234]);
    assert!(selected("time;n;M\n0;1,234;0.5\n").is_err());
}

#[test]
fn exact_missing_values_and_truth_values() {
    let words = ["", "NaN", "n/a", "-", "#N/A", "1.#QNAN", "-1.#IND", "#NV", "null", "nan"];
    for word in words {
        let r = read(&format!("time;a\n0;1\n1;{word}\n2;3\n"));
        assert!(r.channels[0].samples[1].is_nan() && r.channels[0].samples[2] == 3.0, "{word}");
    }
    let r = read("time,on,high\n0,true,inf\n1,FALSE,-1.#INF\n");
    assert_eq!(r.channels[0].samples, [1.0, 0.0]);
    assert_eq!(r.channels[1].samples, [f64::INFINITY, f64::NEG_INFINITY]);
}

#[test]
fn exact_text_columns_are_skipped() {
    let table = "time,state,n\n0,idle,1\n1,\"a, \"\"b\"\"\nc\",2\n2,3,4\n";
    let r = read(table);
    assert_eq!((r.channels.len(), &r.channels[0].samples[..]), (1, &[1.0, 2.0, 4.0][..]));
    let reason = SkipReason::NotNumeric { kind: "text".into() };
    assert_eq!(r.findings, [Finding::SkippedChannel { channel: "state".into(), reason: reason.clone() }]);
    let error = decode("a.csv", table.as_bytes(), &Selection::names(["state"])).unwrap_err();
    assert_eq!(error, RecordingError::UnusableChannel { file: "a.csv".into(), channel: "state".into(), reason });
}

#[test]
fn regress_a_sign_of_comments_in_a_full_line_is_text() {
    let r = read("mark,time,a\n,0,1\n#2,1,2\n# a remark\n,2,3\n");
    assert_eq!(
        (&r.rasters[0].time_s[..], &r.channels.last().unwrap().samples[..]),
        (&[0.0, 1.0, 2.0][..], &[1.0, 2.0, 3.0][..])
    );
}

#[test]
fn exact_headings_of_three_rows() {
    let tables = [
        "time;n;M\ns;1/min;Nm\n;speed of the shaft;torque\n0;1;2\n",
        "time;n;M\ntime stamp of the recorder;speed of the shaft;torque\n[s];[1/min];[Nm]\n0;1;2\n",
        "Bench 4;run 7\n\n# by hand\ntime;n;M\ns;1/min;Nm\nas recorded;speed of the shaft;torque\n0;1;2\n",
    ];
    for table in tables {
        let r = read(table);
        let heads: Vec<_> = r.channels.iter().map(|c| (c.name.as_str(), c.unit.as_str(), c.comment.as_str())).collect();
        assert_eq!(heads, [("n", "1/min", "speed of the shaft"), ("M", "Nm", "torque")], "{table}");
        assert_eq!((&r.rasters[0].time_s[..], &r.channels[1].samples[..]), (&[0.0][..], &[2.0][..]));
    }
    assert_eq!(read(tables[2]).comment.unwrap(), "Bench 4 run 7\n# by hand");
}

#[test]
fn exact_headings_of_other_shapes() {
    let clock = |table: &str| {
        let r = read(table);
        assert_eq!(r.channels.last().unwrap().samples, [5.0, 6.0], "{table}");
        r.rasters[0].time_s.clone()
    };
    assert_eq!(clock("# time [ms],a\n0,5\n500,6\n"), [0.0, 0.5]);
    assert_eq!(clock("%% run\nt/ms;a\n0;5\n% a remark\n500;6\n"), [0.0, 0.5]);
    assert_eq!(clock("Zeit in ms;a\n0;5\n500;6\n"), [0.0, 0.5]);
    assert_eq!(clock("No;time_ms;a\n1;0;5\n2;500;6\n"), [0.0, 0.5]);
    assert_eq!(clock("\"time\n[ms]\";\"a;b\"\n0;5;\n500;6;\n"), [0.0, 0.5]);
    assert_eq!(clock("dt\tn\n6\t93\ntime\ta\n0\t5\n0.5\t6\n"), [0.0, 0.5]);
    assert_eq!(clock("sep=|\ntime|a\n0|5\n0.5|6\n"), [0.0, 0.5]);
    assert_eq!(clock("time,T,a\r0,1,5\r0.5,2,6\r"), [0.0, 0.5]);
    let r = read("time_1,a,b,time_2,c\n0,1,2,0,3\n1,4,5,,\n");
    assert_eq!((r.rasters.len(), r.rasters[1].time_s.len(), r.channels[2].raster), (2, 1, 1));
    let wide: Vec<String> = (0..5000).map(|c| format!("c{c}")).collect();
    let row: Vec<String> = (0..5000).map(|c| c.to_string()).collect();
    let r = read(&format!("time,{}\n0,{}\n", wide.join(","), row.join(",")));
    assert_eq!((r.channels.len(), r.channels[4999].samples[0]), (5000, 4999.0));
}

#[test]
fn exact_clock_times_and_dates() {
    let start = |table: &str| {
        let r = read(table);
        (r.rasters[0].time_s.clone(), r.start_time)
    };
    let at = |nanoseconds, is_local, utc_offset_min| Some(StartTime { nanoseconds, is_local, utc_offset_min });
    let noon = 1_795_262_400_000_000_000;
    let local = at(noon, true, None);
    assert_eq!(start("time;n\n12:34:56.789;1\n12:34:57.000;2\n"), (vec![45296.789, 45297.0], None));
    assert_eq!(start("time,n\n23:59:59.5,1\n0:00:00.5,2\n0:00:01,3\n"), (vec![86399.5, 86400.5, 86401.0], None));
    assert_eq!(start("time,n\n11:59:59 AM,1\n12:00:00 PM,2\n"), (vec![43199.0, 43200.0], None));
    let half = vec![0.0, 0.5];
    let tables = [
        "time,n\n2026-11-21T12:00:00,1\n2026-11-21T12:00:00.5,2\n",
        "Zeit;n\n21.11.2026 12:00:00,000;1\n21.11.2026 12:00:00,500;2\n",
        "Date;Time;n\n21.11.2026;12:00:00,000;1\n21.11.2026;12:00:00,500;2\n",
        "date,n\n2026/11/21 12:00:00.000,1\n2026/11/21 12:00:00.500,2\n",
        "time,n\nhh:mm:ss,rpm\n11/21/2026 12:00:00 PM,1\n11/21/2026 12:00:00.5 PM,2\n",
    ];
    for table in tables {
        assert_eq!(start(table), (half.clone(), local), "{table}");
    }
    assert_eq!(
        start("time,n\n2026-11-21T12:00:00Z,1\n2026-11-21 12:00:00.5 UTC,2\n"),
        (half.clone(), at(noon, false, Some(0)))
    );
    let shifted = "time,n\n2026-11-21T13:00:00+01:00,1\n2026-11-21T12:00:00.5+0000,2\n";
    assert_eq!(start(shifted), (half.clone(), at(noon, false, Some(60))));
    assert_eq!(start("time [Excel],n\n46347.5,1\n46347.75,2\n"), (vec![0.0, 21600.0], local));
    let two = read("time_1,a,time_2,b\n2026-11-21T12:00:01,1,2026-11-21T12:00:00,1\n");
    assert_eq!((two.rasters[0].time_s[0], two.rasters[1].time_s[0]), (0.0, -1.0));
    use CsvProblem as P;
    assert_eq!(problem("time,n\n03/04/2026 12:00:00,1\n").2, P::AmbiguousDate { text: "03/04/2026 12:00:00".into() });
    for bad in ["2026-02-30 12:00:00", "34:56.7", "12:60:00", "later", "2026-11-21T12:00:00+01:00"] {
        let table = format!("time,n\n2026-11-21T12:00:00,1\n{bad},2\n");
        assert_eq!(problem(&table), (3, Some(1), P::NotATime { text: bad.into() }), "{bad}");
    }
}

#[test]
fn exact_a_cut_last_line_is_reported() {
    let r = read("time,a\n0,1\n1");
    assert_eq!(r.findings, [Finding::IncompleteLastLine { line: 3 }]);
    assert_eq!(r.rasters[0].time_s, [0.0]);
    assert_eq!(read("time,a\n0,1").findings, [Finding::NoFinalLineEnd { line: 2 }]);
}

#[test]
fn exact_other_encodings_are_read() {
    let r = decode("a.csv", b"time;T [\xB0C]\n0;20\n", &Selection::All).unwrap();
    assert_eq!((r.channels[0].unit.as_str(), r.findings), ("°C", vec![Finding::AssumedLatin1]));
    let utf16: Vec<u8> = "\u{FEFF}time;T [°C]\n0;20\n".encode_utf16().flat_map(u16::to_le_bytes).collect();
    let r = decode("a.csv", &utf16, &Selection::All).unwrap();
    assert_eq!((r.channels[0].unit.as_str(), r.findings), ("°C", vec![]));
}

#[test]
fn exact_missing_names_are_errors_with_a_suggestion() {
    let error = decode("a.csv", b"time,DynoSpeed\n0,1\n", &Selection::names(["dynospeed"])).unwrap_err();
    assert_eq!(error.to_string(), "a.csv: there is no channel \"dynospeed\"; did you mean \"DynoSpeed\"?");
}

#[test]
fn regress_dos_end_mark_and_trailing_blanks() {
    let r = read("Time[usec],CH1(msr)\n0,2.000000e+000 \n40,3.000000e+000 \n\n\u{1A}");
    assert_eq!((r.channels[0].name.as_str(), r.channels[0].unit.as_str()), ("CH1", "msr"));
    assert_eq!((&r.rasters[0].time_s[..], r.findings), (&[0.0, 40e-6][..], vec![]));
}

/// Integers that a double cannot hold are said, whoever wrote them.
#[test]
fn exact_rounded_integers_are_said() {
    let rounded = |text: &str| {
        let findings = decode("a.csv", text.as_bytes(), &Selection::All).unwrap().findings;
        findings.contains(&Finding::RoundedIntegers { channel: "n".into() })
    };
    assert!(rounded("t [s],n\n0,1\n1,9007199254740993\n"));
    assert!(rounded("t [s],n\n0,1\n1,-18446744073709551615\n"));
    assert!(!rounded("t [s],n\n0,1\n1,9007199254740991\n"));
    assert!(!rounded("t [s],n\n0,1.5\n1,1e300\n"));
}

/// Channels by name, with their times and samples.
fn table(text: &str) -> Vec<(String, Vec<f64>, Vec<f64>)> {
    let r = read(text);
    r.channels.iter().map(|c| (c.name.clone(), r.time_s(c).unwrap().to_vec(), c.samples.clone())).collect()
}

/// Lines of `time;n` and `clock;b` side by side, the second block at `step_s` and shorter.
fn two_blocks(headings: [&str; 2], step_s: f64) -> String {
    let line = |row: usize| match row < 12 {
        true => format!("{};{row};{};{}\n", 0.01 * row as f64, step_s * row as f64, 5 + row),
        false => format!("{};{row};;\n", 0.01 * row as f64),
    };
    format!("{};a;{};b\n{}", headings[0], headings[1], (0..30).map(line).collect::<String>())
}

#[test]
fn regress_a_second_clock_is_known_by_its_numbers() {
    let pandas = "Time (s);a;Time (s).1;b\n0;1;0;5\n0,5;2;2;6\n1;3;;\n1,5;4;;\n";
    assert_eq!(table(pandas)[1], ("b".into(), vec![0.0, 2.0], vec![5.0, 6.0]));
    let headings = [
        ["time_fast [s]", "time_slow [s]"],
        ["Time_Group1 [s]", "Time_Group2 [s]"],
        ["t_fast [s]", "t_slow [s]"],
        ["Zeit_schnell [s]", "Zeit_langsam [s]"],
        ["time A [s]", "time B [s]"],
        ["DynoSpeed_time [s]", "T_time [s]"],
        ["Time 1ms raster [s]", "Time 10ms raster [s]"],
        ["time", "timestamp"],
        ["time", "t"],
        ["t1", "t2"],
        ["Zeit", "time"],
        ["timeFast [s]", "timeSlow"],
    ];
    for pair in headings {
        let channels = table(&two_blocks(pair, 0.1));
        assert_eq!(channels.len(), 2, "{pair:?}");
        assert_eq!((channels[0].1.len(), channels[1].1.len(), channels[1].1[11]), (30, 12, 0.1 * 11.0), "{pair:?}");
    }
    let milliseconds = two_blocks(["t_fast [s]", "t_slow [ms]"], 100.0);
    assert!((table(&milliseconds)[1].1[11] - 1.1).abs() < 1e-12);
}

#[test]
fn regress_a_channel_that_is_measured_in_time_stays_one() {
    let duration = "time [s];n;injection time [ms];M\n0;1;3,2;5\n1;2;3,1;6\n2;3;3,4;7\n";
    let units = "time;n;t_oil;M\ns;rpm;°C;Nm\n0;1;0,5;5\n1;2;1,7;6\n2;3;2,4;7\n";
    let first = "injection duration [ms];time [s];n\n3,2;0;5\n3,1;1;6\n3,3;2;7\n";
    let doubt = CsvProblem::ClockOrChannel { name: "time [s]".into(), clock: "injection duration [ms]".into() };
    assert_eq!(problem(first), (1, Some(2), doubt));
    let last = "time;n;t_oil\n0;1;0,5\n1;2;1,7\n2;3;2,4\n";
    let stated = "time [s];n;dead time_channel [s];M\n0;1;0;5\n1;2;3;6\n2;3;7;7\n";
    for (text, channels) in [(duration, 3), (units, 3), (last, 2), (stated, 3)] {
        let found = table(text);
        assert_eq!(found.len(), channels, "{text}");
        assert!(found.iter().all(|(_, time_s, _)| *time_s == [0.0, 1.0, 2.0]), "{text}");
    }
    // The same clock, counted from elsewhere, or the same numbers again.
    let epoch = "time [s];n;unix time [s];M\n0;1;1700000000;5\n1;2;1700000001;6\n2;3;1700000002;7\n";
    let again = "time;n;timestamp;M\n0;1;0;5\n1;2;1;6\n2;3;2;7\n";
    for text in [epoch, again] {
        assert!(table(text).iter().all(|(_, time_s, _)| *time_s == [0.0, 1.0, 2.0]), "{text}");
        assert_eq!(read(text).rasters.len(), 1);
    }
    // What goes on otherwise later is found out; of two with a number both are clocks.
    let line = |row: usize| format!("{row};1;{};2\n", row + usize::from(row > 300));
    let lines: String = (0..400).map(line).collect();
    let doubt = CsvProblem::ClockOrChannel { name: "timestamp".into(), clock: "time".into() };
    assert_eq!(problem(&format!("time;n;timestamp;M\n{lines}")), (303, Some(3), doubt));
    assert_eq!(table(&format!("t1;n;t2;M\n{lines}"))[1].1[399], 400.0);
}

#[test]
fn regress_temperatures_beside_a_clock_are_no_clocks() {
    let short = "t;t1;t2;n\n0;25,5;26,5;1000\n0,1;25,6;26,6;1001\n";
    let names: Vec<_> = table(short).into_iter().map(|(name, time_s, _)| (name, time_s)).collect();
    let on_t = |name: &str| (name.to_owned(), vec![0.0, 0.1]);
    assert_eq!(names, [on_t("t1"), on_t("t2"), on_t("n")]);
    let falling = "t;t1;n\n0;25,5;1\n1;25,4;2\n";
    assert_eq!(table(falling).len(), 2);
    let last = table("t [s];T [°C];t_oil;t2\n0;20;25,5;26\n1;21;26,5;28\n");
    assert_eq!(last.iter().map(|c| c.0.as_str()).collect::<Vec<_>>(), ["T", "t_oil", "t2"]);
    // Both read as the clock of what follows, or as channels.
    let doubtful = [
        "t;n;t1 x;M\n0;1;1;1\n1;2;2;2\n2;3;3;3\n",
        "t;t1;n\n0;25,5;1\n1;25,6;2\n2;25,9;3\n",
        "t;n;t1;M\n0;1;25,5;1\n1;2;25,6;2\n2;3;25,9;3\n",
    ];
    for (text, (column, name)) in doubtful.iter().zip([(3, "t1 x"), (2, "t1"), (3, "t1")]) {
        let doubt = CsvProblem::ClockOrChannel { name: name.into(), clock: "t".into() };
        assert_eq!(problem(text), (1, Some(column), doubt), "{text}");
    }
}

#[test]
fn regress_a_clock_without_channels_is_said() {
    let r = read("time,speed,time_2\n0,1,0\n1,2,3\n");
    let skipped = Finding::SkippedChannel { channel: "time_2".into(), reason: SkipReason::NoChannels };
    assert_eq!((r.channels.len(), r.findings), (1, vec![skipped]));
}

#[test]
fn regress_of_two_readings_of_a_clock_the_one_that_always_rises_is_it() {
    let lines = |stamp: &dyn Fn(usize) -> String| -> String {
        (0..250).map(|row| format!("{};{:.2};{row}\n", stamp(row), row as f64 / 100.0)).collect()
    };
    let dates = |row: usize| format!("2024-01-01 10:00:{:02}", row / 100);
    let clock = |row: usize| format!("10:00:{:02}", (row + 50) / 100);
    let tables = [
        ("Timestamp", "Elapsed Time [s]", lines(&dates)),
        ("Uhrzeit", "Zeit [s]", lines(&clock)),
        ("Time", "Time [s]", lines(&clock)),
    ];
    for (coarse, fine, samples) in tables {
        let r = read(&format!("{coarse};{fine};n\n{samples}"));
        assert_eq!((r.channels.len(), r.rasters.len(), r.rasters[0].time_s[249]), (1, 1, 2.49), "{coarse}");
        let skipped = Finding::SkippedChannel { channel: coarse.into(), reason: SkipReason::CoarseTime };
        assert_eq!(r.findings, [skipped], "{coarse}");
    }
    // To the millisecond the stamp is as good, and the number a channel.
    let stamps = lines(&|row| format!("2024-01-01 10:00:{:06.3}", row as f64 / 100.0));
    let r = read(&format!("Timestamp;Elapsed Time [s];n\n{stamps}"));
    assert_eq!((r.channels.len(), r.rasters[0].time_s[249], r.start_time.is_some()), (2, 2.49, true));
}

#[test]
fn regress_units_below_names_without_time() {
    let read = |text: &str| {
        let r = recording::decode_untimed("a.csv", text.as_bytes(), 0.1).unwrap();
        r.channels.into_iter().map(|c| (c.name, c.unit, c.samples)).collect::<Vec<_>>()
    };
    let channel = |name: &str, unit: &str, samples: [f64; 2]| (name.to_owned(), unit.to_owned(), samples.to_vec());
    let expected = [channel("speed", "1/min", [1.5, 2.0]), channel("torque", "Nm", [2.0, 3.0])];
    assert_eq!(read("speed;torque\n1/min;Nm\n1,5;2\n2;3\n"), expected);
    assert_eq!(read("speed|torque\n[1/min]|[Nm]\n1,5|2\n2|3\n"), expected);
    for names in [["speed", "torque"], ["n", "M"]] {
        let grouped = read(&format!("motor;load\n{};{}\n1,5;2\n2;3\n", names[0], names[1]));
        assert_eq!(grouped, [channel(names[0], "", [1.5, 2.0]), channel(names[1], "", [2.0, 3.0])]);
    }
}

#[test]
fn regress_two_units_of_one_clock_are_refused() {
    let two = |name: &str, below: &str| CsvProblem::TwoTimeUnits { name: name.into(), below: below.into() };
    assert_eq!(problem("time_ms,a\ns,Nm\n0,1\n10,2\n"), (1, Some(1), two("ms", "s")));
    assert_eq!(problem("time [s],a\nms,Nm\n0,1\n10,2\n"), (1, Some(1), two("s", "ms")));
    assert_eq!(read("time_ms,a\nms,Nm\n0,1\n10,2\n").rasters[0].time_s, [0.0, 0.01]);
}

#[test]
fn regress_row_numbers_without_a_name_are_left_out() {
    let r = read(",time,a\n0,0.0,1\n1,0.5,2\n2,1.0,3\n");
    assert_eq!((&r.rasters[0].time_s[..], &r.channels[0].samples[..]), (&[0.0, 0.5, 1.0][..], &[1.0, 2.0, 3.0][..]));
    let skipped = Finding::SkippedChannel { channel: "column 1".into(), reason: SkipReason::RowNumbers };
    assert_eq!(r.findings, [skipped]);
    assert_eq!(problem(",time,a\n0,0.0,1\n0,0.5,2\n"), (3, Some(1), CsvProblem::NoName));
    assert_eq!(problem(",time,a\n2.5,0.0,1\n"), (2, Some(1), CsvProblem::NoName));
}

#[test]
fn regress_bars_between_decimal_commas() {
    for text in ["time|a|b\n0|1,5|2\n1|2,5|3\n", "Zeit|a|b\n0,0|1,5|2\n1,0|2,5|3\n"] {
        let r = read(text);
        assert_eq!(
            (&r.rasters[0].time_s[..], &r.channels[0].samples[..]),
            (&[0.0, 1.0][..], &[1.5, 2.5][..]),
            "{text}"
        );
        assert_eq!(r.format, recording::Format::Csv { delimiter: '|', decimal_comma: true });
    }
    // Bars within text separate nothing.
    assert_eq!(read("time,n,flags\n0,1,a|b\n1,2,b|c\n").channels[0].samples, [1.0, 2.0]);
}

#[test]
fn regress_nul_bytes_at_the_end_are_said() {
    let r = read("time,a\n0,1\n1,2\n\0\0\0\0");
    assert_eq!(
        (&r.rasters[0].time_s[..], r.findings),
        (&[0.0, 1.0][..], vec![Finding::NulBytes { offset: 15, count: 4 }])
    );
    let cut = read(&format!("time,a\n0,1\n1{}", "\0".repeat(1 << 19)));
    assert_eq!(cut.rasters[0].time_s, [0.0]);
    let expected = [Finding::NulBytes { offset: 12, count: 1 << 19 }, Finding::IncompleteLastLine { line: 3 }];
    assert_eq!(cut.findings, expected);
    assert!(cut.findings.iter().all(Finding::is_loss));
}

#[test]
fn exact_utf16_is_read_without_a_byte_order_mark() {
    let text = "time;T [°C]\n0;20\n";
    let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
    for bytes in [&little, &big] {
        let r = decode("a.csv", bytes, &Selection::All).unwrap();
        assert_eq!((r.channels[0].unit.as_str(), &r.channels[0].samples[..], r.findings), ("°C", &[20.0][..], vec![]));
    }
    let cut = [&little[..], &[0; 7]].concat();
    let r = decode("a.csv", &cut, &Selection::All).unwrap();
    assert_eq!((r.channels.len(), r.findings), (1, vec![Finding::NulBytes { offset: 34, count: 7 }]));
}

#[test]
fn regress_numbers_beyond_a_double_are_refused() {
    for text in ["1e400", "-1e400", "1.5e999"] {
        let settled = format!("time,a\n0.5,1.25\n1,{text}\n");
        assert_eq!(problem(&settled), (3, Some(2), CsvProblem::TooLarge { text: text.into() }));
    }
    assert_eq!(problem("time;a\n0,5;1,5e400\n"), (2, Some(2), CsvProblem::TooLarge { text: "1,5e400".into() }));
    assert_eq!(read("time,a\n0,1e300\n1,inf\n").channels[0].samples, [1e300, f64::INFINITY]);
}

#[test]
fn regress_clocks_since_1970_are_read_by_their_numbers() {
    for (unit, per_second) in [("ms", 1_000_i64), ("µs", 1_000_000), ("ns", 1_000_000_000)] {
        let first = 1_700_000_000 * per_second;
        let rows = (0..4).map(|k| format!("{},{k}\n", first + k * per_second / 100)).collect::<String>();
        let r = read(&format!("timestamp,u\n{rows}"));
        for (k, t) in r.rasters[0].time_s.iter().enumerate() {
            assert!((t - 0.01 * k as f64).abs() < 1e-6, "{unit}: {t}");
        }
        assert_eq!(r.findings, [Finding::CountsSince1970 { unit: unit.into() }]);
        assert_eq!(r.start_time.unwrap().nanoseconds, 1_700_000_000_000_000_000);
    }
    // Seconds are what they are, and so is a long record in a small unit.
    assert_eq!(read("time,u\n1700000000.00,1\n1700000000.01,2\n").rasters[0].time_s[0], 1_700_000_000.0);
    assert_eq!(read("time [ms],u\n1700000000000,1\n1700000000010,2\n").rasters[0].time_s[0], 1_700_000_000.0);
    assert_eq!(read("time [s],u\n5000000,1\n5000001,2\n").rasters[0].time_s[0], 5_000_000.0);
}

/// `Time [min]` of a lap beside `Time [s]`: it stands, or goes on as the clock does from elsewhere, or begins anew.
#[test]
fn regress_a_second_column_of_the_clocks_name_in_another_unit_is_a_channel() {
    let laps: [fn(usize) -> f64; 4] = [
        |_| 1.0,
        |row| (7.5 + 0.02 * row as f64) / 60.0,
        |row| 0.02 * (row % 50) as f64 / 60.0,
        |row| (row / 50) as f64,
    ];
    for lap in laps {
        let line = |row: usize| format!("{:.2},{row},{:.6},{}\n", 0.02 * row as f64, lap(row), 1000 + row);
        let text = format!("Time [s],Distance [m],Time [min],Speed [rpm]\n{}", (0..200).map(line).collect::<String>());
        let found = read(&text);
        let names: Vec<&str> = found.channels.iter().map(|c| c.name.as_str()).collect();
        assert_eq!((found.rasters.len(), names), (1, vec!["Distance", "Time", "Speed"]));
        assert!((found.rasters[0].time_s[199] - 3.98).abs() < 1e-12);
        assert_eq!(found.findings, []);
    }
    // What goes on otherwise is the clock of another raster, in whatever unit.
    let line = |row: usize| format!("{:.2},{row},{},{}\n", 0.02 * row as f64, 5 * row, 1000 + row);
    let two = format!("Time [s],n [rpm],Time [ms],M [Nm]\n{}", (0..200).map(line).collect::<String>());
    let found = read(&two);
    assert_eq!((found.rasters.len(), found.rasters[1].time_s[199]), (2, 0.995));
    // The same name and unit, standing.
    let standing = read("Time [s];a;Time [s];b\n0;1;3;2\n1;2;3;3\n2;2;3;3\n");
    assert_eq!((standing.rasters.len(), standing.channels.len()), (1, 3));
}

#[test]
fn regress_a_clock_without_a_unit_that_is_hardly_in_seconds_is_said() {
    let table = |heading: &str, time: &dyn Fn(usize) -> String| {
        let rows: String = (0..50).map(|row| format!("{};{row}\n", time(row))).collect();
        read(&format!("{heading};n\n{rows}"))
    };
    let doubtful =
        |clock: &str, likely: &str| vec![Finding::DoubtfulSeconds { clock: clock.into(), likely: likely.into() }];
    let milliseconds = |row: usize| (91 + 70 * row).to_string();
    let days = |row: usize| format!("{:.9}", 44838.383368 + 0.1 * row as f64 / 86400.0);
    let matlab = |row: usize| format!("{:.9}", 738857.25 + 0.1 * row as f64 / 86400.0);
    let microseconds = |row: usize| (10_000 * row).to_string();
    assert_eq!(table("TIME", &milliseconds).findings, doubtful("TIME", "ms"));
    assert_eq!(table("t", &microseconds).findings, doubtful("t", "us"));
    let excel = table("Time", &days);
    assert_eq!(excel.findings, doubtful("Time", "days, as spreadsheets count"));
    assert_eq!(table("Time", &matlab).findings, doubtful("Time", "days, as MATLAB counts"));
    // The remedies that the message states.
    assert!(excel.findings[0].to_string().contains("\"time [excel]\""), "{}", excel.findings[0]);
    for (heading, time, step_s) in [
        ("time [ms]", &milliseconds as &dyn Fn(usize) -> String, 0.07),
        ("time_ms", &milliseconds, 0.07),
        ("time [us]", &microseconds, 0.01),
        ("time [excel]", &days, 0.1),
        ("time [d]", &matlab, 0.1),
        ("time [s]", &milliseconds, 70.0),
        // A slow logger, and seconds of a long day.
        ("time", &|row| row.to_string(), 1.0),
        ("time", &|row| format!("{:.3}", 44838.0 + 0.05 * row as f64), 0.05),
        ("time", &|row| format!("{:.1}", 2.5 * row as f64), 2.5),
    ] {
        let found = table(heading, time);
        let time_s = &found.rasters[0].time_s;
        assert_eq!(found.findings, [], "{heading}");
        assert!(((time_s[49] - time_s[0]) / 49.0 - step_s).abs() < 1e-3 * step_s, "{heading}: {time_s:?}");
    }
}
