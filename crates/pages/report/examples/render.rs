//! Writes the reports of made-up studies into a folder: `cargo run -p report --example render -- FOLDER`.

#[path = "../tests/it/fixture/mod.rs"]
mod fixture;

#[allow(clippy::disallowed_methods)] // an example is a program
fn main() -> std::io::Result<()> {
    let folder = std::path::PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    std::fs::create_dir_all(&folder)?;
    let studies = [
        ("complete", fixture::complete()),
        ("bare", fixture::bare()),
        ("hostile", fixture::hostile("</script><script>document.title='broken'</script>\"'><b>")),
    ];
    for (name, study) in studies {
        std::fs::write(folder.join(format!("{name}.html")), fixture::html(&study))?;
        std::fs::write(folder.join(format!("{name}.json")), study::document::json(&study, None))?;
    }
    Ok(())
}
