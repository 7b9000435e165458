//! Manifests for other collections of programs: where the files of a release are, and their sums.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use super::files::{REPOSITORY, VERSION, write};

/// Manifests, by their paths below `manifests`.
const TEMPLATES: [(&str, &str); 5] = [
    ("winget/Dynoid.Dynoid.yaml", include_str!("templates/winget/version.yaml")),
    ("winget/Dynoid.Dynoid.installer.yaml", include_str!("templates/winget/installer.yaml")),
    ("winget/Dynoid.Dynoid.locale.en-US.yaml", include_str!("templates/winget/locale.yaml")),
    ("homebrew/dynoid.rb", include_str!("templates/dynoid.rb")),
    ("conda-forge/recipe.yaml", include_str!("templates/recipe.yaml")),
];

/// Writes the manifests whose files are all there, and names the others.
pub(super) fn write_all(folder: &Path, sums: &BTreeMap<String, String>, day: &str) -> Result<(), String> {
    for (path, template) in TEMPLATES {
        let file = folder.join("manifests").join(path);
        match filled(template, sums, day) {
            Ok(text) => {
                let above = file.parent().unwrap_or(folder);
                fs::create_dir_all(above).map_err(|error| format!("{}: {error}", above.display()))?;
                write(&file, text.as_bytes())?;
            }
            Err(missing) => println!("not written: {path}, since {missing} is not there"),
        }
    }
    Ok(())
}

/// A template with version, addresses and sums; or the name of a file that has no sum.
fn filled(template: &str, sums: &BTreeMap<String, String>, day: &str) -> Result<String, String> {
    let template = template.replace("<<version>>", VERSION).replace("<<day>>", day);
    let mut rest = template.replace("<<repository>>", REPOSITORY);
    let mut text = String::new();
    while let Some((before, (name, after))) =
        rest.split_once("<<sha256 ").and_then(|(before, rest)| Some((before, rest.split_once(">>")?)))
    {
        text.push_str(before);
        text.push_str(sums.get(name).ok_or_else(|| name.to_owned())?);
        rest = after.to_owned();
    }
    Ok(text + &rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_a_manifest_has_the_sums_of_its_files() {
        let sums = BTreeMap::from([(format!("a-{VERSION}.zip"), "12ab".to_owned())]);
        let text = filled("v<<version>> <<day>>: <<sha256 a-<<version>>.zip>>.", &sums, "2026-01-01");
        assert_eq!(text, Ok(format!("v{VERSION} 2026-01-01: 12ab.")));
        assert_eq!(filled("<<sha256 b>>", &sums, ""), Err("b".to_owned()));
    }
}
