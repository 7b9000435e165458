//! Builds that leave formats out say so.

#[cfg(not(all(feature = "hdf5", feature = "parquet")))]
fn said(name: &str, bytes: &[u8]) -> String {
    recording::decode(name, bytes, &recording::Selection::All).unwrap_err().to_string()
}

#[cfg(not(feature = "parquet"))]
#[test]
fn exact_tables_are_refused_by_the_name_of_the_feature() {
    for (name, bytes, format) in
        [("a.parquet", &b"PAR1 and more"[..], "Parquet"), ("a.arrow", &b"ARROW1 and more"[..], "Arrow")]
    {
        let said = said(name, bytes);
        assert!(said.contains(name) && said.contains(&format!("reads no {format}")), "{said}");
        assert!(said.contains("`parquet`"), "{said}");
    }
}

#[cfg(not(feature = "hdf5"))]
#[test]
fn exact_hdf5_is_refused_by_the_name_of_the_feature() {
    for name in ["plain.h5", "small73.mat"] {
        let bytes = std::fs::read(format!("tests/it/data/mat/{name}")).unwrap();
        let said = said(name, &bytes);
        assert!(said.contains(name) && said.contains("reads no HDF5") && said.contains("`hdf5`"), "{said}");
    }
}
