//! Acts as lines of a shell.

use super::act::Act;

const HEAD: &str = "\
# The acts of a session of dynoid, in their order. To repeat them, go to a copy of the folder and type: sh FILE
mkdir -p .dynoid
";

/// A file that repeats acts.
pub(super) fn script(acts: &[Act]) -> String {
    let lines = acts.iter().map(|act| match act {
        Act::Command(words) => format!("{}\n", typed(words)),
        Act::Saved { file, text } => {
            format!("# {file} was edited and saved.\nprintf '%s' {} > {}\n", within_quotes(text), quoted(file))
        }
    });
    std::iter::once(HEAD.to_owned()).chain(lines).collect()
}

/// An act in one line.
pub(super) fn in_short(act: &Act) -> String {
    match act {
        Act::Command(words) => typed(words),
        Act::Saved { file, .. } => format!("# {file} was edited and saved."),
    }
}

/// A command as one types it.
fn typed(words: &[String]) -> String {
    let quoted = words.iter().map(|word| quoted(word));
    std::iter::once("dynoid".to_owned()).chain(quoted).collect::<Vec<_>>().join(" ")
}

fn quoted(word: &str) -> String {
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "_@%+=:,./-".contains(letter);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => within_quotes(word),
    }
}

fn within_quotes(text: &str) -> String {
    format!("'{}'", text.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_words_are_one_word_of_a_shell() {
        let command = Act::of_command(
            &["fit", "arx", "a b.mf4", "--input=it's", "--json", "--plot=.dynoid/pages/1.html"].map(str::to_owned),
        );
        assert_eq!(in_short(&command), r"dynoid fit arx 'a b.mf4' '--input=it'\''s'");
        let saved = Act::Saved { file: "bench.toml".to_owned(), text: "name = 'x'\n".to_owned() };
        let expected = "# bench.toml was edited and saved.\nprintf '%s' 'name = '\\''x'\\''\n' > bench.toml\n";
        assert_eq!(script(&[saved]), format!("{HEAD}{expected}"));
    }
}
