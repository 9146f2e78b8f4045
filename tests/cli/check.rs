//! `check` says yes to a right gradient and no to a wrong one.

use crate::workplace::{text, typed, warpath, workplace};

/// With a filter that has a derivative everywhere, unless `line` names another.
fn check(line: &str) -> (Option<i32>, serde_json::Value, String) {
    let directory = workplace();
    let filter = if line.contains("filter=") {
        ""
    } else {
        "-D filter=gaussian"
    };
    let line = format!("check s.xml --resolution 32x24 --spp 256 -o out {filter} {line}");
    let out = warpath(directory.path(), &typed(&line));
    let said = text(&out.stdout) + &text(&out.stderr);
    let found = std::fs::read(directory.path().join("out/check.json")).expect(&said);
    for image in [
        "forward.exr",
        "fd.exr",
        "z.exr",
        "forward.png",
        "fd.png",
        "z.png",
        "report.json",
    ] {
        assert!(directory.path().join("out").join(image).exists(), "{image}");
    }
    (
        out.status.code(),
        serde_json::from_slice(&found).unwrap(),
        said,
    )
}

#[test]
fn what_is_right_passes() {
    for parameter in [
        "card.translation=1,0.3,0",
        "cam.translation=1,0,0",
        "floor.bsdf.reflectance.value=1,1,1",
    ] {
        let (code, found, said) = check(&format!("--param {parameter}"));
        assert_eq!(code, Some(0), "{parameter}: {said}");
        assert_eq!(found["verdict"]["agrees"], true);
        assert!(
            said.contains("reparam agrees with finite differences"),
            "{said}"
        );
        assert_eq!(found["forward_against_backward"]["agrees"], true, "{said}");
    }
}

#[test]
fn what_ignores_visibility_fails_where_something_moves() {
    for parameter in ["card.translation=1,0.3,0", "cam.translation=1,0,0"] {
        let (code, found, said) = check(&format!("--method interior --param {parameter}"));
        assert_eq!(code, Some(1), "{parameter}: {said}");
        assert_eq!(found["verdict"]["agrees"], false);
        assert!(said.contains("interior ignores visibility"), "{said}");
    }
}

#[test]
fn interior_is_right_where_nothing_moves() {
    let (code, _, said) = check("--method interior --param floor.bsdf.reflectance.value=1,1,1");
    assert_eq!(code, Some(0), "{said}");
}

/// The floor's sides lie between two pixels, and the image has no derivative there: not the method's fault.
#[test]
fn edges_between_pixels_of_a_box_filter_are_explained() {
    let (code, _, said) = check("-D filter=box --param cam.translation=1,0,0");
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains("under a box filter an edge that lies between two pixels"),
        "{said}"
    );
}
