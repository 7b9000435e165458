//! Similarity of names, for "did you mean".

/// The `count` candidates closest to `wanted`, closest first. Letter case does not matter; a candidate that holds
/// `wanted`, or is held by it, is closer than the number of edits says.
pub(crate) fn closest<'a>(wanted: &str, candidates: impl Iterator<Item = &'a str>, count: usize) -> Vec<String> {
    let wanted = wanted.to_lowercase();
    let mut ranked: Vec<(usize, &str)> =
        candidates.map(|name| (distance(&wanted, &name.to_lowercase()), name)).collect();
    ranked.sort_by_key(|(distance, _)| *distance);
    ranked.into_iter().take(count).map(|(_, name)| name.to_owned()).collect()
}

/// The closest candidate, if it is so close that a slip of the keyboard explains the difference.
pub(crate) fn likely_meant<'a>(wanted: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    let best = closest(wanted, candidates, 1).pop()?;
    let allowed = 2 * wanted.chars().count().max(best.chars().count()).div_ceil(3);
    (distance(&wanted.to_lowercase(), &best.to_lowercase()) <= allowed).then_some(best)
}

/// Twice the edit distance, less where one text holds the other.
fn distance(a: &str, b: &str) -> usize {
    let edits = 2 * edit_distance(a, b);
    let shared = !a.is_empty() && !b.is_empty() && (a.contains(b) || b.contains(a));
    if shared { edits.div_ceil(3) } else { edits }
}

/// Levenshtein distance: the least number of characters inserted, removed or replaced.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, cb) in b.iter().enumerate() {
            let replaced = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = replaced.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}
