//! Names for other programs.

use export::names::Names;

#[test]
fn exact_names_are_words_that_programs_take() {
    let of = |name: &str| {
        let names = Names::of(name);
        (names.file, names.class)
    };
    let pair = |file: &str, class: &str| (file.to_owned(), class.to_owned());
    assert_eq!(of("Test cell 4"), pair("test_cell_4", "TestCell4"));
    assert_eq!(of("Prüfstand/7 (neu)"), pair("pruefstand_7_neu", "Pruefstand7Neu"));
    // The same with the umlaut as two characters, as files of macOS have it.
    assert_eq!(of("Pru\u{308}fstand"), of("Prüfstand"));
    assert_eq!(of("Ölprüfstand groß"), pair("oelpruefstand_gross", "OelpruefstandGross"));
    assert_eq!(of("Prověřovací zkušebna č. 3"), pair("proverovaci_zkusebna_c_3", "ProverovaciZkusebnaC3"));
    assert_eq!(of("Banc d’été Ça"), pair("banc_d_ete_ca", "BancDEteCa"));
    assert_eq!(of("4 north"), pair("bench_4_north", "Bench4North"));
    assert_eq!(of("TestCell4"), pair("testcell4", "TestCell4"));
    assert_eq!(of("試験"), pair("bench", "Bench"));
    for taken in ["class", "lambda", "end", "function", "numpy"] {
        assert_eq!(of(taken).0, format!("{taken}_model"));
    }
}
