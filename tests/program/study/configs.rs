//! What is wrong in a configuration is told with its place and what would be right.

use super::CONFIG;
use crate::workplace::{expect, text, typed, warpath, workplace};

/// A part of the configuration, what it is replaced by, and what is said of it.
const WRONG: [(&str, &str, &str); 24] = [
    ("spp = [4, 16]", "spp = = 3", "c.toml:2:7: not TOML"),
    (
        "repeats = 12",
        "repeat = 12",
        "c.toml:3:1: repeat: the file has no such key; the nearest known name is \"repeats\"",
    ),
    (
        "repeats = 12",
        "repeats = 1",
        "c.toml:3:11: repeats: write a whole number from 2 to 4096, not 1",
    ),
    (
        "spp = [4, 16]",
        "spp = [16, 4]",
        "c.toml:2:7: spp: write ascending numbers",
    ),
    ("spp = [4, 16]", "spp = [4.5]", "not 4.5"),
    ("spp = [4, 16]", "spp = []", "ascending"),
    (
        "seed = 3",
        "methods = [\"reparm\"]",
        "the nearest known name is \"reparam\"",
    ),
    (
        "seed = 3",
        "methods = [\"fd\", \"fd\"]",
        "c.toml:4:11: methods: fd is there twice",
    ),
    ("seed = 3", "methods = []", "none is named"),
    ("seed = 3", "resolution = \"16\"", "c.toml:4:14: resolution"),
    (
        "runs = 12",
        "steps = 1",
        "reference.steps: write a whole number from 2 to 6",
    ),
    (
        "name = \"card\"",
        "name = \"../card\"",
        "c.toml:9:8: scene.0.name: names are parts of file names",
    ),
    ("file = \"s.xml\"", "", "scene.0.file: it is missing"),
    ("file = \"s.xml\"", "file = \"none.xml\"", "none.xml"),
    (
        "\"card.translation\"",
        "\"cart.translation\"",
        "the nearest is \"card.translation\"",
    ),
    (
        "\"card.translation\" = [1, 0, 0]",
        "\"card.translation\" = [0, 0, 0]",
        "all tangents are zero",
    ),
    (
        "\"card.translation\" = [1, 0, 0]",
        "\"card.translation\" = \"x\"",
        "write a number, a list of numbers, or \"@tangent.npy\"",
    ),
    (
        "\"card.translation\" = [1, 0, 0]",
        "\"card.translation\" = [1, 0]",
        "c.toml:12:1: ",
    ),
    (
        "[scene.direction.shift]",
        "[scene.directoin.shift]",
        "the nearest known name is \"direction\"",
    ),
    (
        "seed = 3",
        "peers = { file = \"p.json\" }",
        "peers.label: it is missing",
    ),
    (
        "seed = 3",
        "variant.wide = { method = \"reparam\" }",
        "c.toml:4:27: variant.wide.method: ",
    ),
    (
        "seed = 3",
        "variant.wide = { method = \"loubet\", film_kernel = 1 }",
        "the nearest known name is \"film_kernel_px\"",
    ),
    (
        "seed = 3",
        "variant.fd = { method = \"loubet\" }",
        "variant.fd: a method has this name",
    ),
    (
        "seed = 3",
        "variant.odd = { method = \"warped-area\", rays = 5 }",
        "write an even number",
    ),
];

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let directory = workplace();
    let mut complaints = Vec::new();
    for (part, other, said) in WRONG {
        assert!(CONFIG.contains(part), "{part}");
        std::fs::write(directory.path().join("c.toml"), CONFIG.replace(part, other)).unwrap();
        let out = warpath(directory.path(), &typed("study c.toml -o out"));
        let message = text(&out.stderr);
        let code = out.status.code();
        let wanted = 3;
        if code != Some(wanted) || !message.contains(said) || message.contains("panicked") {
            complaints.push(format!("{other}: {code:?}, wanted {said:?}\n{message}"));
        }
        assert!(!directory.path().join("out").exists(), "{other}");
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}

#[test]
fn what_is_typed_is_checked_before_anything_is_measured() {
    let directory = workplace();
    super::write_config(directory.path());
    let bounds = [
        ("none.toml", ""),
        ("word.toml", "[[bound]]\nverdict = [\"rihgt\"]\n"),
        ("figure.toml", "[[bound]]\nat_most = { rmes = 1 }\n"),
        ("empty.toml", "[[bound]]\nscene = \"card\"\n"),
        (
            "nothing.toml",
            "[[bound]]\nscene = \"card\"\nspp = 8\nverdict = [\"right\"]\n",
        ),
    ];
    for (name, text) in bounds {
        std::fs::write(directory.path().join(name), text).unwrap();
    }
    expect(
        directory.path(),
        &[
            ("study none.xml", 3, "none.xml"),
            (
                "study c.toml --set repeats=many",
                3,
                "--set repeats=many: repeats: write a whole number",
            ),
            ("study c.toml --set repeats", 2, "the value is missing"),
            (
                "study c.toml --only crad",
                3,
                "--only crad: there is no such scene; the nearest known name is \"card\"",
            ),
            ("study c.toml --assert missing.toml", 3, "missing.toml"),
            (
                "study c.toml --assert none.toml",
                3,
                "write a table [[bound]]",
            ),
            (
                "study c.toml --assert word.toml",
                3,
                "word.toml:2:11: bound.0.verdict: there is no \"rihgt\"",
            ),
            (
                "study c.toml --assert figure.toml",
                3,
                "the nearest known name is \"rmse\"",
            ),
            ("study c.toml --assert empty.toml", 3, "nothing is bound"),
            (
                "study c.toml --assert nothing.toml -q",
                3,
                "nothing.toml:1:1: the study has nothing of this scene, direction, method and spp",
            ),
            (
                "study c.toml --report a_file/table.md -q",
                4,
                "a_file: cannot be written into",
            ),
            (
                "study c.toml --report . -q",
                4,
                ".: cannot be written: it is a folder",
            ),
        ],
    );
    assert!(!directory.path().join("out").exists());
}
