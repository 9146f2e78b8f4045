//! `check` says yes to a right gradient and no to a wrong one.

use crate::workplace::{SCENE, text, typed, warpath, workplace};

/// With a filter that has a derivative everywhere, unless `line` names another.
fn check(line: &str) -> (Option<i32>, serde_json::Value, String) {
    let directory = workplace();
    let filter = if line.contains("filter=") {
        ""
    } else {
        "-D filter=gaussian"
    };
    // The edges are parallel to the lattice, so that a run has few and large errors, and one seed
    // in some is judged wrong.
    let line = format!("check s.xml --resolution 32x24 --spp 256 --seed 4 -o out {filter} {line}");
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
        assert_eq!(found["method"], "auto");
        assert!(
            said.contains("auto agrees with finite differences"),
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
        assert_eq!(found["method"], "interior");
        assert!(said.contains("interior ignores visibility"), "{said}");
    }
}

#[test]
fn interior_is_right_where_nothing_moves() {
    let (code, _, said) = check("--method interior --param floor.bsdf.reflectance.value=1,1,1");
    assert_eq!(code, Some(0), "{said}");
}

/// The floor's sides lie between two pixels, and the image has no derivative there: not the
/// method's fault.
#[test]
fn edges_between_pixels_of_a_box_filter_are_explained() {
    let (code, _, said) = check("-D filter=box --param cam.translation=1,0,0");
    assert_eq!(code, Some(1), "{said}");
    assert!(
        said.contains("under a box filter an edge that lies between two pixels"),
        "{said}"
    );
}

/// Two samples a pixel, 48 pixels: the error bar of the bias is 8 % after all the runs there are
/// without asking for more.
const NOISY: &str =
    "check s.xml --param card.translation=1,0.3,0 --resolution 8x6 --spp 2 -D filter=gaussian";

#[test]
fn noise_larger_than_what_is_looked_for_is_no_agreement() {
    let directory = workplace();
    let out = warpath(directory.path(), &typed(&format!("{NOISY} -o out -q")));
    let message = text(&out.stderr);
    assert_eq!(out.status.code(), Some(6), "{message}");
    assert!(message.contains("cannot tell: "), "{message}");
    assert!(message.contains(" times the samples"), "{message}");
    assert!(text(&out.stdout).ends_with("\ncannot tell\n"));
    let found = std::fs::read(directory.path().join("out/check.json")).unwrap();
    let found: serde_json::Value = serde_json::from_slice(&found).unwrap();
    assert_eq!(found["verdict"]["outcome"], "cannot_tell");
    assert_eq!(found["verdict"]["agrees"], false);

    let sure = format!("{NOISY} -o out --until-sure");
    let out = warpath(directory.path(), &typed(&sure));
    let message = text(&out.stderr);
    assert_eq!(out.status.code(), Some(0), "{message}");
    assert!(
        message.contains("8 more of finite differences"),
        "{message}"
    );
    let found = std::fs::read(directory.path().join("out/check.json")).unwrap();
    let found: serde_json::Value = serde_json::from_slice(&found).unwrap();
    let compared = &found["forward_against_fd"];
    assert!(compared["reference_runs"].as_u64() > Some(32), "{compared}");
    let error = compared["relative_bias_se"].as_f64().unwrap();
    assert!(error <= 0.03, "{error}");
}

/// A plane without end under a constant environment looks the same wherever it is.
#[test]
fn gradients_that_are_zero_agree() {
    let directory = workplace();
    let plane = r#"<shape type="rectangle" id="floor"><transform name="to_world"><scale value="50"/></transform>"#;
    let floor = r#"<shape type="rectangle" id="floor">"#;
    let card = SCENE.find(r#"<shape type="rectangle" id="card">"#).unwrap();
    let end = SCENE.find(r#"<emitter type="constant""#).unwrap();
    let scene = format!("{}{}", &SCENE[..card], &SCENE[end..]);
    let scene = scene.replace(floor, plane);
    std::fs::write(directory.path().join("plane.xml"), scene).unwrap();
    for parameter in [
        "floor.translation=1,0,0",
        "floor.rotation=0,0,1",
        "cam.translation=1,0,0",
    ] {
        let line = format!(
            "check plane.xml --param {parameter} --resolution 16x12 --spp 16 -D filter=gaussian -o out"
        );
        let out = warpath(directory.path(), &typed(&line));
        let said = text(&out.stdout) + &text(&out.stderr);
        assert_eq!(out.status.code(), Some(0), "{said}");
        assert!(said.contains("finite differences are both zero"), "{said}");
        assert!(
            said.contains("the image does not depend on the parameters"),
            "{said}"
        );
    }
}

#[test]
fn how_much_there_is_to_do_is_said_before_and_how_long_after_the_first_run() {
    let directory = workplace();
    let line = "check s.xml --param env.radiance.value=1,1,1 --spp 4 -o out";
    let out = warpath(directory.path(), &typed(line));
    let message = text(&out.stderr);
    // Whether so few samples agree is chance.
    assert!(matches!(out.status.code(), Some(0 | 1)), "{message}");
    let mut lines = message.lines();
    let first = lines.next().unwrap();
    assert!(
        first.starts_with("17 runs of 8x6 pixels with 4 samples"),
        "{message}"
    );
    assert!(first.contains("7.9e3 camera paths"), "{message}");
    assert!(
        lines
            .next()
            .unwrap()
            .ends_with(" left, without more runs for noise"),
        "{message}"
    );
    // It is told again once finite differences were seen to take another time, not otherwise.
    let mut told: Vec<&str> = message
        .lines()
        .filter(|line| line.ends_with(" left, without more runs for noise"))
        .collect();
    let count = told.len();
    told.dedup();
    assert_eq!(told.len(), count, "{message}");
}

/// A card that hangs closer before a wall than differences step: they move it through the wall.
const CLOSE: &str = r#"<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="2"/></integrator>
<sensor type="perspective">
  <float name="fov" value="40"/>
  <transform name="to_world"><lookat origin="0,0,4" target="0,0,0" up="0,1,0"/></transform>
  <film type="hdrfilm"><rfilter type="gaussian"/></film>
</sensor>
<emitter type="constant"/>
<shape type="rectangle"><bsdf type="diffuse"/></shape>
<shape type="rectangle" id="card">
  <transform name="to_world"><scale value="0.3"/><translate x="0.2" y="0.1" z="0.01"/></transform>
  <bsdf type="diffuse"><rgb name="reflectance" value="0.8"/></bsdf>
</shape></scene>"#;

#[test]
fn differences_that_pass_something_accuse_nobody() {
    let directory = workplace();
    std::fs::write(directory.path().join("close.xml"), CLOSE).unwrap();
    let line = "check close.xml --resolution 16x16 --spp 64 --param card.translation=0,0,1 -o out";
    let out = warpath(directory.path(), &typed(line));
    let message = text(&out.stderr);
    assert_eq!(out.status.code(), Some(6), "{message}");
    assert!(
        message.contains("passes something within a step"),
        "{message}"
    );
    assert!(message.contains("cannot tell: "), "{message}");
}

/// A block that stands on a floor is lifted.
#[test]
fn what_stands_on_something_is_explained() {
    const STANDS: &str = r#"<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="2"/></integrator>
  <sensor type="perspective" id="cam"><float name="fov" value="30"/>
    <transform name="to_world"><lookat origin="0.5, -4, 2" target="0, 0, 0.4" up="0, 0, 1"/></transform>
    <film type="hdrfilm"><rfilter type="gaussian"/></film>
  </sensor>
  <shape type="rectangle" id="floor"><transform name="to_world"><scale value="6"/></transform></shape>
  <shape type="cube" id="cube">
    <transform name="to_world"><scale value="0.5"/><rotate z="1" angle="25"/><translate z="0.5"/></transform>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.9, 0.9, 0.9"/></bsdf>
  </shape>
  <emitter type="constant"/>
</scene>"#;
    let directory = workplace();
    std::fs::write(directory.path().join("stands.xml"), STANDS).expect("a file");
    let line = "check stands.xml --method reparam --param cube.translation=0,0,1 --resolution 16x16 --spp 256 -q -o out";
    let out = warpath(directory.path(), &typed(line));
    let said = text(&out.stderr);
    assert_ne!(out.status.code(), Some(0), "{said}");
    assert!(said.contains("stands on something else"), "{said}");
}
