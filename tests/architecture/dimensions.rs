//! No two users share a random dimension: each row of the table is drawn at one place.

use crate::sources::of_the_crate;

const TABLE: &str = "src/paths/dimensions.rs";
const KINDS: [&str; 3] = ["Pair", "Single", "Branch"];
/// Numbers of a stream that stand in no table: those of a branch, by whoever made it.
const RAW: [&str; 3] = [".uniform(", ".keyed(", ".child("];
const MAY_DRAW_RAW: [&str; 3] = [TABLE, "src/paths/random.rs", "src/boundary/reciprocal.rs"];

/// Variants of an enum in the order of the text.
fn variants(text: &str, name: &str) -> Vec<String> {
    let file = syn::parse_file(text).expect("a source file");
    let found = file.items.into_iter().find_map(|item| match item {
        syn::Item::Enum(item) if item.ident == name => Some(item.variants),
        _ => None,
    });
    let variants = found.unwrap_or_else(|| panic!("no enum {name} in {TABLE}"));
    variants.iter().map(|v| v.ident.to_string()).collect()
}

/// Whole words in code that are `name`.
fn uses(text: &str, name: &str) -> usize {
    let code = text.lines().filter(|l| !l.trim_start().starts_with("//"));
    let goes_on = |c: char| c.is_alphanumeric() || c == '_';
    code.map(|line| {
        let places = line.match_indices(name);
        let whole = places.filter(|(i, _)| !line[i + name.len()..].starts_with(goes_on));
        whole.count()
    })
    .sum()
}

#[test]
fn each_row_has_one_user() {
    let sources = of_the_crate();
    let table = sources.iter().find(|s| s.path == TABLE).expect(TABLE);
    let mut wrong = Vec::new();
    for kind in KINDS {
        for variant in variants(&table.text, kind) {
            let row = format!("{kind}::{variant}");
            let others = sources.iter().filter(|s| s.path != TABLE);
            let users: Vec<_> = others
                .flat_map(|s| std::iter::repeat_n(&s.path, uses(&s.text, &row)))
                .collect();
            if users.len() != 1 {
                wrong.push(format!(
                    "{row} is drawn at {} places: {users:?}",
                    users.len()
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn nothing_is_drawn_past_the_table() {
    let mut wrong = Vec::new();
    for source in of_the_crate() {
        let is_free = MAY_DRAW_RAW.contains(&source.path.as_str());
        for raw in RAW.iter().filter(|_| !is_free) {
            if source.path.starts_with("src/paths") || source.path.starts_with("src/boundary") {
                let count = source.text.matches(raw).count();
                wrong.extend((count > 0).then(|| format!("{}: {raw}", source.path)));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
