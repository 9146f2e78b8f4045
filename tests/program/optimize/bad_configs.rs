//! What is wrong with a configuration is said with its place, and what would be right.

use super::{CONFIG, optimize};
use crate::workplace::workplace;

/// Where the good configuration has its targets from.
const VIEWS: &str = "[truth]\nspp = 64\n\n[[view]]\nsensor = \"cam\"";

/// What of the good configuration is replaced, by what, and a part of the message.
// Long: a table.
const BAD: [(&str, &str, &str); 72] = [
    (
        "scene = \"s.xml\"",
        "",
        "bad.toml:1:1: scene: it is missing; write scene = \"scene.xml\"",
    ),
    (
        "scene = \"s.xml\"",
        "scene = 3",
        "bad.toml:1:9: scene: write a text in quotes, not a whole number",
    ),
    (
        "scene = \"s.xml\"",
        "scene = \"no.xml\"",
        "no.xml: there is no such file",
    ),
    (
        "scene = \"s.xml\"",
        "scene = s.xml",
        "bad.toml:1:9: not TOML",
    ),
    ("steps = 6", "", "steps: it is missing; write steps = 100"),
    (
        "steps = 6",
        "steps = 0",
        "bad.toml:2:9: steps: write a whole number from 1 to",
    ),
    (
        "steps = 6",
        "steps = 2.5",
        "bad.toml:2:9: steps: write a whole number from 1 to 10000000, not 2.5",
    ),
    (
        "steps = 6",
        "steps = 6\nsteps = 7",
        "bad.toml:3:1: not TOML: this key is written twice; take one out",
    ),
    (
        "steps = 6",
        "step = 6\nsteps = 6",
        "bad.toml:2:1: step: the file has no such key; the nearest known name is \"steps\"",
    ),
    (
        "seed = 3",
        "seed = -3",
        "bad.toml:3:8: seed: write a whole number from 0",
    ),
    (
        "seed = 3",
        "seed = 1979-05-27",
        "bad.toml:3:8: a date or a time",
    ),
    (
        "seed = 3",
        "defines = { side = [1] }",
        "defines.side: write a text, a number, true or false",
    ),
    (
        "seed = 3",
        "defines = { sied = 8 }",
        "defines.sied: the scene has no such parameter; the nearest is \"side\"",
    ),
    (
        VIEWS,
        "",
        "view: nothing says what the images should be; write [[view]] with a target",
    ),
    (
        "spp = 64",
        "spp = 64.0",
        "truth.spp: write a whole number from 1 to 1048576, not 64.0",
    ),
    (
        "spp = 64",
        "scene = \"no.xml\"",
        "no.xml: there is no such file",
    ),
    (
        VIEWS,
        "[[view]]\nsensor = 0",
        "view 0 has no target; write target = \"photo.png\", or [truth]",
    ),
    (
        VIEWS,
        "[[view]]\ntarget = \"no.png\"",
        "no.png: No such file",
    ),
    (VIEWS, "[[view]]\ntarget = \"text.exr\"", "text.exr"),
    (
        VIEWS,
        "[[view]]\ntarget = \"turned.npy\"",
        "of another shape; give a picture of its shape",
    ),
    (
        VIEWS,
        "[[view]]\ntarget = \"target.npy\"\nsensor = \"cma\"",
        "there is no sensor \"cma\"; the scene has cam, second",
    ),
    (
        VIEWS,
        "[[view]]\ntarget = \"target.npy\"\nsensor = 7",
        "sensor 7: the scene has 2 sensors",
    ),
    (
        VIEWS,
        "[[view]]\ntarget = \"target.npy\"\nsensor = 0.5",
        "view.0.sensor: write a sensor's id, or its number",
    ),
    (
        VIEWS,
        "[[view]]\ntarget = \"target.npy\"\nmask = \"alpha\"",
        "it has no alpha; name a mask's file instead",
    ),
    (
        VIEWS,
        "[[view]]\ntarget = \"target.npy\"\ntarged = 1",
        "view.0.targed: view.0 has no such key; the nearest known name is \"target\"",
    ),
    (
        "seed = 3",
        "view = 3",
        "bad.toml:8:3: not TOML: this key is written twice",
    ),
    (
        "spp = 8\n",
        "spp = 0\n",
        "bad.toml:12:7: render.spp: write whole numbers of samples from 1 to 1048576, not 0",
    ),
    (
        "spp = 8\n",
        "spp = [[1, 8]]\n",
        "render.spp: write a number, or pairs of a step and a number of which the first is of step 0",
    ),
    (
        "spp = 8\n",
        "spp = 8\nssp = 8\n",
        "bad.toml:13:1: render.ssp: render has no such key; the nearest known name is \"spp\"",
    ),
    (
        "spp = 8\n",
        "method = \"reparm\"\n",
        "there is no \"reparm\"; write one of reparam, edges, loubet, warped-area, interior, fd, carried-fd, auto; the nearest known name is \"reparam\"",
    ),
    (
        "spp = 8\n",
        "resolution = [8]\n",
        "render.resolution: write [width, height] in pixels",
    ),
    (
        "spp = 8\n",
        "max_depth = 0\n",
        "render.max_depth: write a number of segments from 1, or -1 for no limit, not 0",
    ),
    (
        "spp = 8\n",
        "downscale = 4\n",
        "render.downscale: 4 does not divide 8x6",
    ),
    (
        "spp = 8\n",
        "downscale = 1.5\n",
        "render.downscale: write whole factors from 1 to 64",
    ),
    (
        "spp = 8\n",
        "shares = 0\n",
        "render.shares: write a whole number from 1 to 4096, not 0",
    ),
    (
        "spp = 8\n",
        "adaptive = true\n",
        "render.adaptive: write a table, not true or false",
    ),
    (
        "spp = 8\n",
        "adaptive = { noise_to_signal = 0 }\n",
        "render.adaptive.noise_to_signal: write a number above zero, not 0",
    ),
    (
        "name = \"adam\"",
        "name = \"adm\"",
        "bad.toml:15:8: optimizer.name: there is no \"adm\"; write one of sgd, adam, adamw, uniform; the nearest known name is \"adam\"",
    ),
    (
        "lr = 0.02",
        "lr = 0",
        "optimizer.lr: write learning rates above zero, not 0",
    ),
    (
        "lr = 0.02",
        "lr = \"fast\"",
        "optimizer.lr: write learning rates above zero, not a text",
    ),
    (
        "lr = 0.02",
        "lr = { start = 0.1 }",
        "optimizer.lr.end: it is missing; write { start = 0.1, end = 0.01 }",
    ),
    (
        "lr = 0.02",
        "lr = { start = 0.1, end = 0.01, how = \"cosin\" }",
        "optimizer.lr.how: there is no \"cosin\"; write one of linear, exponential, cosine",
    ),
    (
        "lr = 0.02",
        "momentum = 0.9",
        "optimizer.momentum: it belongs to sgd; take it out",
    ),
    (
        "lr = 0.02",
        "weight_decay = 0.1",
        "optimizer.weight_decay: it belongs to adamw; take it out",
    ),
    (
        "lr = 0.02",
        "beta1 = 1",
        "optimizer.beta1: write a number from 0 up to 1, not 1",
    ),
    (
        "lr = 0.02",
        "max_step = 0",
        "optimizer.max_step: write a length above zero, not 0",
    ),
    (
        "kind = \"l2\"",
        "kind = \"l3\"",
        "loss.kind: there is no \"l3\"; write one of l1, l2, relative_l2, log",
    ),
    (
        "kind = \"l2\"",
        "pyramid = 0",
        "loss.pyramid: write a whole number from 1 to 16, not 0",
    ),
    (
        "kind = \"l2\"",
        "silhouette = { weight = 1 }",
        "loss.silhouette.shapes: it is missing",
    ),
    (
        "kind = \"l2\"",
        "silhouette = { shapes = \"crad\" }",
        "there is no shape \"crad\"; the scene has floor, card",
    ),
    (
        "kind = \"l2\"",
        "silhouette = { shapes = \"card\" }",
        "loss.silhouette: it compares with masks, and 0-cam has none",
    ),
    (
        "[parameters.\"card.translation\"]\nstart = [0.1, 0, 0]",
        "",
        "parameters: no parameter is named; write [parameters.\"KEY\"]",
    ),
    (
        "card.translation",
        "crad.translation",
        "bad.toml:25:1: parameters.crad.translation: there is no parameter \"crad.translation\"; the nearest is \"card.translation\"",
    ),
    (
        "card.translation",
        "card.faces",
        "card.faces cannot be differentiated",
    ),
    (
        "start = [0.1, 0, 0]",
        "start = [0.1, 0]",
        "bad.toml:25:1: parameters.card.translation: start: card.translation takes 3 numbers; 2 are given",
    ),
    (
        "start = [0.1, 0, 0]",
        "start = \"four.npy\"",
        "four.npy: the shape is (4,), card.translation has (3,)",
    ),
    (
        "start = [0.1, 0, 0]",
        "min = 1\nmax = 0",
        "bad.toml:27:7: parameters.card.translation.max: it must be above min, 1",
    ),
    (
        "start = [0.1, 0, 0]",
        "min = 1",
        "it starts at 0, which is not between 1 and inf; write another start, min or max",
    ),
    (
        "start = [0.1, 0, 0]",
        "reparameterisation = \"logistic\"",
        "logistic needs both bounds; write min and max",
    ),
    (
        "start = [0.1, 0, 0]",
        "reparameterisation = \"large_steps\"",
        "large_steps is for keys that end with .vertex_positions",
    ),
    (
        "start = [0.1, 0, 0]",
        "total_variation = 1",
        "total_variation: it is for textures alone",
    ),
    (
        VIEWS,
        "[cameras]\ntransforms = \"no.json\"",
        "bad.toml:5:1: cameras: no.json: there is no such file",
    ),
    (
        VIEWS,
        "[cameras]\ncolmap = \"sparse\"\nimages = \"images\"",
        "cameras: sparse/cameras.txt: there is no such file",
    ),
    (
        VIEWS,
        "[cameras]\ncolmap = \"sparse\"",
        "cameras.images: it is missing; write the folder of COLMAP's pictures",
    ),
    (
        VIEWS,
        "[cameras]\ntransforms = \"t.json\"\nimages = \"images\"",
        "bad.toml:7:10: cameras.images: transforms.json names its pictures; take it out",
    ),
    (
        VIEWS,
        "[cameras]\nalpha = true",
        "bad.toml:5:1: cameras: write either transforms = \"transforms.json\", or colmap = \"sparse/0\" and images",
    ),
    (
        VIEWS,
        "[cameras]\ncolmap = \".\"\nimages = \".\"\nmasks = \".\"\nalpha = true",
        "bad.toml:8:9: cameras.masks: masks are either alpha or files; take one out",
    ),
    (
        VIEWS,
        "[cameras]\ntransforms = \"t.json\"\nmasks = \"masks\"",
        "cameras.masks: transforms.json names its masks, as mask_path of each frame; take it out",
    ),
    (
        "[truth]",
        "[cameras]\ntransforms = \"t.json\"\n\n[truth]",
        "view: give either [[view]] or [cameras], which brings its own views",
    ),
    (
        "spp = 64",
        "targets = \"photos\"",
        "bad.toml:6:11: truth.targets: there is no \"photos\"; write one of rendered, pictures",
    ),
    (
        "spp = 64",
        "targets = \"pictures\"",
        "view 0 has no target; write target = \"photo.png\", or [truth]",
    ),
    (
        "seed = 3",
        "views = { hold_out = 2 }",
        "bad.toml:3:22: views.hold_out: every 2 views one is left out, and there are 1; write a smaller number",
    ),
];

#[test]
fn bad_configurations_are_refused_with_their_place() {
    let directory = workplace();
    let mut wrong = Vec::new();
    for (old, new, part) in BAD {
        assert!(CONFIG.contains(old), "{old}");
        let text = CONFIG.replacen(old, new, 1);
        std::fs::write(directory.path().join("bad.toml"), text).unwrap();
        let (code, said) = optimize(directory.path(), "bad.toml", &["-o", "out"]);
        let is_right = code == Some(3) && said.contains(part) && !said.contains("panicked");
        if !is_right || !has_place(&said) {
            wrong.push(format!("{new:?}: {code:?}, wanted {part:?}\n{said}"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(!directory.path().join("out").exists());
}

/// Whether a message begins with the configuration's file, a line and a column.
fn has_place(said: &str) -> bool {
    let Some((_, after)) = said.split_once("error: bad.toml:") else {
        return false;
    };
    let mut numbers = after.split(':').take(2);
    numbers.all(|n| n.parse::<u32>().is_ok())
}

#[test]
fn bad_overrides_are_wrong_usage_or_named() {
    let directory = workplace();
    std::fs::write(directory.path().join("c.toml"), CONFIG).unwrap();
    for (set, code, part) in [
        ("optimizer.lr", 2, "the value is missing"),
        ("optimizer lr=1", 2, "is no key"),
        ("steps.more=1", 2, "stands below a value that is no table"),
        (
            "optimizer.lr=-1",
            3,
            "--set optimizer.lr=-1: optimizer.lr: write learning rates above zero, not -1",
        ),
        (
            "optimiser.lr=1",
            3,
            "--set optimiser.lr=1: optimiser: the file has no such key; the nearest known name is \"optimizer\"",
        ),
    ] {
        let (found, said) = optimize(directory.path(), "c.toml", &["--set", set, "-o", "out"]);
        assert!(
            found == Some(code) && said.contains(part),
            "{set}: {found:?} {said}"
        );
    }
}

/// A link to itself is there and cannot be read by anybody, as a file that one may not read cannot
/// by a user.
#[cfg(unix)]
#[test]
fn what_the_system_does_not_let_be_read_is_no_bad_input() {
    let directory = workplace();
    let at = directory.path();
    for name in ["loop.npy", "loop.png"] {
        std::os::unix::fs::symlink(name, at.join(name)).unwrap();
    }
    let view = "[[view]]\nsensor = \"cam\"\ntarget =";
    for (old, new) in [
        ("start = [0.1, 0, 0]", "start = \"loop.npy\""),
        (VIEWS, &format!("{view} \"loop.png\"")),
        (
            VIEWS,
            &format!("{view} \"target.npy\"\nmask = \"loop.png\""),
        ),
    ] {
        std::fs::write(at.join("bad.toml"), CONFIG.replacen(old, new, 1)).unwrap();
        let (code, said) = optimize(at, "bad.toml", &["-o", "out"]);
        assert_eq!(code, Some(4), "{new}: {said}");
        let is_told = said.contains(": Too many levels of symbolic links\n");
        assert!(is_told && has_place(&said), "{new}: {said}");
    }
    assert!(!at.join("out").exists());
}
