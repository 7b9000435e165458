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
