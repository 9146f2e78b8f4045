//! The scenes of the paper's figures are whole: files that they name are there, and what is to move
//! is in them.

use serde_json::Value;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn scenes() -> Vec<PathBuf> {
    let entries = std::fs::read_dir(root().join("scenes/paper")).expect("a folder");
    entries
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|e| e == "xml"))
        .collect()
}

/// The ids of a scene, and the files that it names.
fn contents(path: &Path) -> (BTreeSet<String>, Vec<PathBuf>) {
    let text = std::fs::read_to_string(path).expect("a scene");
    let tree =
        roxmltree::Document::parse(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let ids = tree
        .descendants()
        .filter_map(|node| node.attribute("id"))
        .map(String::from)
        .collect();
    let folder = path.parent().expect("a folder");
    let files = tree
        .descendants()
        .filter(|node| node.attribute("name") == Some("filename"))
        .filter_map(|node| node.attribute("value"))
        .map(|file| folder.join(file))
        .collect();
    (ids, files)
}

#[test]
fn scenes_name_files_that_are_there() {
    let scenes = scenes();
    assert!(!scenes.is_empty());
    for scene in scenes {
        let (ids, files) = contents(&scene);
        assert!(ids.contains("cam"), "{}: no camera", scene.display());
        for file in files {
            assert!(file.exists(), "{}: {}", scene.display(), file.display());
        }
    }
}

#[test]
fn figures_move_what_is_in_their_scenes() {
    let list = root().join("scenes/paper/figures.json");
    let text = std::fs::read_to_string(list).expect("a list");
    let figures: Vec<Value> = serde_json::from_str(&text).expect("JSON");
    let mut names = BTreeSet::new();
    for figure in &figures {
        let of = |key: &str| figure[key].as_str().expect("a text");
        assert!(names.insert(of("name")), "two figures {}", of("name"));
        // What is made on demand cannot be looked into.
        if of("scene").starts_with("out/") {
            continue;
        }
        let (ids, _) = contents(&root().join(of("scene")));
        for direction in figure["direction"].as_array().expect("a list") {
            let (key, tangent) = direction
                .as_str()
                .and_then(|d| d.split_once('='))
                .expect("KEY=TANGENT");
            let id = key.split('.').next().expect("an id");
            assert!(ids.contains(id), "{}: no {id} in its scene", of("name"));
            if let Some(file) = tangent.strip_prefix('@') {
                assert!(root().join(file).exists(), "{file} is missing");
            }
        }
    }
}
