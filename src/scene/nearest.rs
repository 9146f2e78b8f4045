//! The known name nearest to a mistyped one.

/// Longest name that is compared: the distance is quadratic in the length.
const LONGEST_COMPARED_NAME_CHARS: usize = 200;

/// Fewest single-character insertions, deletions, replacements and swaps of neighbours.
pub fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    // Three rows of the table of distances between prefixes are alive at a time.
    let mut before_last = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let replace = last[j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = replace.min(last[j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before_last[j - 2] + 1);
            }
        }
        before_last = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

/// The known name nearest to `name`, if there is any and the name is not absurdly long.
pub fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    if name.chars().count() > LONGEST_COMPARED_NAME_CHARS {
        return None;
    }
    let lower = name.to_lowercase();
    let distance = |known: &str| {
        let known = known.to_lowercase();
        // A beginning of a name, such as "diag" for "diagonal", is closer than its length says.
        let abbreviates = lower.len() >= 3 && known.starts_with(&lower);
        match edit_distance(&lower, &known) {
            d if abbreviates => d.min(1),
            d => d,
        }
    };
    known
        .into_iter()
        .filter(|k| k.chars().count() <= LONGEST_COMPARED_NAME_CHARS)
        .min_by_key(|k| (distance(k), edit_distance(name, k)))
}

/// Whether a name is another one but for a few letters; if it is not, that they are the nearest
/// says nothing of what is meant.
pub fn is_mistyped(name: &str, known: &str) -> bool {
    let [name, known] = [name, known].map(str::to_lowercase);
    let letters = name.chars().count();
    let abbreviates = letters >= 3 && known.starts_with(&name);
    abbreviates || edit_distance(&name, &known) <= (letters / 4).max(1)
}

/// The known name that was mistyped, if one was.
pub fn mistyped<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    nearest(name, known).filter(|near| is_mistyped(name, near))
}

/// `; the nearest known name is "…"` if one was mistyped, or nothing.
pub fn nearest_hint<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    match mistyped(name, known) {
        Some(near) => format!("; the nearest known name is \"{near}\""),
        None => String::new(),
    }
}

/// The same, and `; there are …` if none was.
pub fn known_hint<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    let known: Vec<&str> = known.into_iter().collect();
    let near = nearest_hint(name, known.iter().copied());
    match first_names(known.into_iter().map(String::from)) {
        Some(names) if near.is_empty() => format!("; there are {names}"),
        _ => near,
    }
}

/// The first of some names, once each, and how many more there are; `None` if there are none.
pub fn first_names(names: impl IntoIterator<Item = String>) -> Option<String> {
    const MOST: usize = 16;
    let mut once: Vec<String> = Vec::new();
    for name in names {
        if !once.contains(&name) {
            once.push(name);
        }
    }
    let more = once.len().saturating_sub(MOST);
    once.truncate(MOST);
    let names = once.join(", ");
    match (once.is_empty(), more) {
        (true, _) => None,
        (false, 0) => Some(names),
        (false, more) => Some(format!("{names} and {more} more")),
    }
}

/// A user's text for a message: shortened, without control characters.
pub fn shown(text: &str) -> String {
    const LONGEST_CHARS: usize = 80;
    let mut out: String = text
        .chars()
        .take(LONGEST_CHARS)
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    if text.chars().nth(LONGEST_CHARS).is_some() {
        out.push('…');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_edits() {
        assert_eq!(edit_distance("sphere", "sphere"), 0);
        assert_eq!(edit_distance("shpere", "sphere"), 1);
        assert_eq!(edit_distance("", "ply"), 3);
        assert_eq!(edit_distance("kitten", "sitting"), 3);
    }

    #[test]
    fn finds_the_nearest() {
        assert_eq!(nearest("sphre", ["cube", "sphere", "ply"]), Some("sphere"));
        assert_eq!(nearest("PLY", ["cube", "ply"]), Some("ply"));
        assert_eq!(nearest("diag", ["x", "diagonal"]), Some("diagonal"));
        assert_eq!(nearest("x", []), None);
    }

    #[test]
    fn tells_a_slip_from_another_name() {
        let known = ["alpha", "reflectance"];
        assert_eq!(mistyped("reflectence", known), Some("reflectance"));
        assert_eq!(mistyped("refl", known), Some("reflectance"));
        assert_eq!(mistyped("roughness", known), None);
        assert_eq!(
            known_hint("roughness", known),
            "; there are alpha, reflectance"
        );
    }
}
