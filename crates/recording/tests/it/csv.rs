//! The CSV reader and writer.
use recording::{CsvProblem, Finding, Recording, RecordingError, Selection, decode};

fn read(text: &str) -> Recording {
    decode("a.csv", text.as_bytes(), &Selection::All).unwrap()
}

fn problem(text: &str) -> (u64, Option<usize>, CsvProblem) {
    match decode("a.csv", text.as_bytes(), &Selection::All) {
        Err(RecordingError::Csv {
            line,
            column,
            problem,
            ..
        }) => (line, column, problem),
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
        let heads: Vec<_> = r
            .channels
            .iter()
            .map(|c| (c.name.as_str(), c.unit.as_str()))
            .collect();
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
    let only = decode(
        "a.csv",
        b"time,a,time,b\n0,1,0,2\n",
        &Selection::names(["b"]),
    )
    .unwrap();
    assert_eq!(
        (
            only.rasters.len(),
            only.channels.len(),
            only.channels[0].raster
        ),
        (1, 1, 0)
    );
}

#[test]
fn exact_what_is_not_understood_names_line_and_column() {
    use CsvProblem as P;
    assert_eq!(
        problem("time,a\n0,1\n1,x\n"),
        (3, Some(2), P::NotANumber { text: "x".into() })
    );
    assert_eq!(problem("time,a\n0,x\n1,2\n").0, 2);
    assert_eq!(
        problem("time,a\n0,1\n1\n"),
        (
            3,
            None,
            P::ColumnCount {
                found: 1,
                expected: 2
            }
        )
    );
    assert_eq!(
        problem("time,a\n0,1\n1,2,3\n").2,
        P::ColumnCount {
            found: 3,
            expected: 2
        }
    );
    assert_eq!(
        problem("time;a\n0,5;1.5\n"),
        (2, Some(2), P::MixedDecimalSigns { text: "1.5".into() })
    );
    assert_eq!(problem("0,1\n1,2\n").2, P::NoHeader);
    assert_eq!(
        problem("a,b\n1,2\n"),
        (1, Some(1), P::NoTime { name: "a".into() })
    );
    assert_eq!(
        problem("time [d],b\n1,2\n").2,
        P::TimeUnit { unit: "d".into() }
    );
    assert_eq!(problem("time,,b\n1,2,3\n"), (1, Some(2), P::NoName));
    assert_eq!(
        problem("time,a\n,1\n0,1\n"),
        (2, Some(1), P::NoTimeStamp).clone()
    );
    assert_eq!(
        problem("time,a,time,b\n0,1,0,1\n1,2,,\n2,3,2,3\n"),
        (4, Some(3), P::Gap)
    );
    assert_eq!(problem("time,a\n").2, P::NoData);
    assert_eq!(problem("hello\n").2, P::NoDelimiter);
}

#[test]
fn exact_a_cut_last_line_is_reported() {
    let r = read("time,a\n0,1\n1");
    assert_eq!(r.findings, [Finding::IncompleteLastLine { line: 3 }]);
    assert_eq!(r.rasters[0].time_s, [0.0]);
    assert_eq!(
        read("time,a\n0,1").findings,
        [Finding::NoFinalLineEnd { line: 2 }]
    );
}

#[test]
fn exact_other_encodings_are_read() {
    let r = decode("a.csv", b"time;T [\xB0C]\n0;20\n", &Selection::All).unwrap();
    assert_eq!(
        (r.channels[0].unit.as_str(), r.findings),
        ("°C", vec![Finding::AssumedLatin1])
    );
    let utf16: Vec<u8> = "\u{FEFF}time;T [°C]\n0;20\n"
        .encode_utf16()
        .flat_map(u16::to_le_bytes)
        .collect();
    let r = decode("a.csv", &utf16, &Selection::All).unwrap();
    assert_eq!((r.channels[0].unit.as_str(), r.findings), ("°C", vec![]));
}

#[test]
fn exact_missing_names_are_errors_with_a_suggestion() {
    let error = decode(
        "a.csv",
        b"time,DynoSpeed\n0,1\n",
        &Selection::names(["dynospeed"]),
    )
    .unwrap_err();
    assert_eq!(
        error.to_string(),
        "a.csv: there is no channel \"dynospeed\"; did you mean \"DynoSpeed\"?"
    );
}

#[test]
fn regress_dos_end_mark_and_trailing_blanks() {
    let r = read("Time[usec],CH1(msr)\n0,2.000000e+000 \n40,3.000000e+000 \n\n\u{1A}");
    assert_eq!(
        (r.channels[0].name.as_str(), r.channels[0].unit.as_str()),
        ("CH1", "msr")
    );
    assert_eq!(
        (&r.rasters[0].time_s[..], r.findings),
        (&[0.0, 40e-6][..], vec![])
    );
}
