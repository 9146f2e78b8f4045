//! Every citation key in the documents and sources, like [Loubet2019], is in docs/references.bib.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

#[test]
fn citations_resolve() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let bib = std::fs::read_to_string(root.join("docs/references.bib")).unwrap();
    let known: BTreeSet<&str> = bib
        .lines()
        .filter_map(|l| l.strip_prefix('@')?.split_once('{')?.1.strip_suffix(','))
        .collect();
    let mut files = vec![root.join("README.md"), root.join("CHANGELOG.md")];
    for folder in ["docs", "src", "scenes"] {
        collect(&root.join(folder), &mut files);
    }
    let mut cited = BTreeSet::new();
    for file in files {
        let text = std::fs::read_to_string(&file).unwrap();
        for key in citations(&text) {
            assert!(
                known.contains(key),
                "{}: [{key}] is not in docs/references.bib",
                file.display()
            );
            cited.insert(key.to_string());
        }
    }
    for key in known {
        assert!(
            cited.contains(key),
            "docs/references.bib: nothing cites [{key}]"
        );
    }
}

/// What stands in brackets, begins with a capital and ends with a year.
fn citations(text: &str) -> impl Iterator<Item = &str> {
    text.split('[').skip(1).filter_map(|rest| {
        let (key, _) = rest.split_once(']')?;
        // As rustdoc wants it.
        let key = key.trim_end_matches('\\');
        let name = key.trim_end_matches(|c: char| c.is_ascii_digit());
        let is_key = key.len() == name.len() + 4
            && name.starts_with(|c: char| c.is_ascii_uppercase())
            && name.chars().all(|c| c.is_ascii_alphabetic());
        is_key.then_some(key)
    })
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|e| e == "md" || e == "rs") {
            files.push(path);
        }
    }
}
