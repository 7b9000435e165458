//! Similarity of names, for "did you mean", and patterns of names.

/// The `count` candidates closest to `wanted`, closest first. Letter case does not matter; a candidate that holds
/// `wanted`, or is held by it, is closer than the number of edits says.
#[must_use]
pub fn closest<'a>(wanted: &str, candidates: impl Iterator<Item = &'a str>, count: usize) -> Vec<String> {
    let wanted = wanted.to_lowercase();
    let mut ranked: Vec<(usize, &str)> =
        candidates.map(|name| (distance(&wanted, &name.to_lowercase()), name)).collect();
    ranked.sort_by_key(|(distance, _)| *distance);
    ranked.into_iter().take(count).map(|(_, name)| name.to_owned()).collect()
}

/// The closest candidate, if it is so close that a slip of the keyboard explains the difference.
#[must_use]
pub fn likely_meant<'a>(wanted: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    let best = closest(wanted, candidates, 1).pop()?;
    let allowed = 2 * wanted.chars().count().max(best.chars().count()).div_ceil(3);
    (distance(&wanted.to_lowercase(), &best.to_lowercase()) <= allowed).then_some(best)
}

/// Twice the distance of Levenshtein, less where one text holds the other.
fn distance(a: &str, b: &str) -> usize {
    let edits = 2 * strsim::levenshtein(a, b);
    let shared = !a.is_empty() && !b.is_empty() && (a.contains(b) || b.contains(a));
    if shared { edits.div_ceil(3) } else { edits }
}

/// Returns true if a name fits a pattern, in which `*` stands for any characters and `?` for one.
pub(crate) fn matches(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    let (mut p, mut n) = (0, 0);
    // The last star, and where in the name it stopped.
    let mut star = None;
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => (star, p) = (Some((p, n)), p + 1),
            Some(c) if *c == '?' || *c == name[n] => (p, n) = (p + 1, n + 1),
            _ => match star {
                Some((place, stopped)) => {
                    (star, p, n) = (Some((place, stopped + 1)), place + 1, stopped + 1);
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|c| *c == '*')
}
