//! What a run leaves behind.

use super::{CONFIG, optimize};
use crate::workplace::{SCENE, text, warpath, workplace};

/// Colours and numbers of vertices and faces.
const KITE: &str = "ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property float color_0
property float color_1
property float color_2
property float part_0
element face 2
property list uchar int vertex_indices
property float color_0
property float color_1
property float color_2
property float share_0
end_header
-1 -1 0.4 0.1 0.2 0.3 0.2
0 -1 0.4 0.4 0.5 0.6 0.9
-1 0 0.4 0.7 0.8 0.9 0.4
0 0 0.4 0.2 0.9 0.1 0.7
3 0 1 2 0.9 0.1 0.1 0.3
3 1 3 2 0.1 0.1 0.9 0.8
";

const PAINTED: &str = r#"
  <shape type="ply" id="kite"><string name="filename" value="kite.ply"/>
    <bsdf type="mask">
      <texture type="mesh_attribute" name="opacity"><string name="name" value="vertex_part"/></texture>
      <bsdf type="blendbsdf">
        <texture type="mesh_attribute" name="weight"><string name="name" value="face_share"/></texture>
        <bsdf type="diffuse">
          <texture type="mesh_attribute" name="reflectance"><string name="name" value="vertex_color"/></texture>
        </bsdf>
        <bsdf type="diffuse">
          <texture type="mesh_attribute" name="reflectance"><string name="name" value="face_color"/></texture>
        </bsdf>
      </bsdf>
    </bsdf>
  </shape>
</scene>"#;

#[test]
fn files_are_what_they_are_said_to_be() {
    let directory = workplace();
    let at = directory.path();
    let config = CONFIG.replace("spp = 4\n", "spp = 4\nturntable = 2\npictures_every = 2\n");
    std::fs::write(at.join("c.toml"), config).unwrap();
    let (code, said) = optimize(at, "c.toml", &["-o", "out", "--log-format", "json"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("\"stage\":\"optimize\""), "{said}");
    let report = std::fs::read_to_string(at.join("out/report.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    for file in report["files"].as_array().unwrap() {
        let file = file.as_str().unwrap();
        assert!(at.join("out").join(file).exists(), "{file}");
    }
    let of_folder = std::fs::read_dir(at.join("out")).unwrap();
    for entry in of_folder.map(|entry| entry.unwrap()) {
        let name = entry.file_name().into_string().unwrap();
        let is_told = report["files"]
            .as_array()
            .unwrap()
            .contains(&name.clone().into());
        assert!(is_told || entry.path().is_dir(), "{name}: {report}");
    }
    let csv = std::fs::read_to_string(at.join("out/loss.csv")).unwrap();
    assert_eq!(csv.lines().count(), 7);
    let columns = csv.lines().next().unwrap().split(',').count();
    assert!(csv.lines().all(|line| line.split(',').count() == columns));
    let page = std::fs::read_to_string(at.join("out/index.html")).unwrap();
    for part in [
        "<svg",
        "data:image/png;base64,",
        "card.translation",
        "</html>",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // Nothing on the page comes from elsewhere, and a page of a run that is done is not refreshed.
    for part in ["src=\"http", "href=", "refresh"] {
        assert!(!page.contains(part), "{part}");
    }
    for (name, start) in [
        ("turntable-card.png", &b"\x89PNG"[..]),
        ("mesh-card.ply", b"ply\n"),
        ("mesh-card.obj", b"o card\n"),
        ("view-0_cam.png", b"\x89PNG"),
    ] {
        let bytes = std::fs::read(at.join("out").join(name)).unwrap();
        assert!(bytes.starts_with(start), "{name}");
    }
}

/// The scene that is written renders to the same image as the one it was made from, with the same
/// random numbers: what was parsed, moved and written is what is parsed again.
#[test]
fn the_final_scene_is_the_scene() {
    let directory = workplace();
    let at = directory.path();
    let config = CONFIG.replace("start = [0.1, 0, 0]", "start = [0, 0, 0]\nlr = 1e-30");
    std::fs::write(at.join("c.toml"), config).unwrap();
    std::fs::write(at.join("kite.ply"), KITE).unwrap();
    std::fs::write(at.join("s.xml"), SCENE.replace("</scene>", PAINTED)).unwrap();
    let (code, said) = optimize(at, "c.toml", &["-o", "out", "--quiet"]);
    assert_eq!(code, Some(0), "{said}");
    let mut images = Vec::new();
    for (scene, folder) in [("s.xml", "a"), ("out/scene.xml", "b")] {
        let out = warpath(
            at,
            &["render", scene, "-o", folder, "--spp", "16", "--quiet"],
        );
        assert!(out.status.success(), "{}", text(&out.stderr));
        images.push(std::fs::read(at.join(folder).join("image.exr")).unwrap());
    }
    assert!(images[0] == images[1]);
}

/// A floor that turns out of sight within the step of differences.
#[test]
fn what_the_engine_warns_of_is_handed_on_once() {
    let directory = workplace();
    let at = directory.path();
    let scene = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/scenes/failures/grazing.xml\"\ndefines = { height = \"0.02\" }"
    );
    let config = CONFIG
        .replace("s.xml\"", scene)
        .replace("steps = 6", "steps = 2")
        .replace("[render]\nspp = 8", "[render]\nspp = 64\nmethod = \"fd\"")
        .replace("lr = 0.02", "lr = 1e-4")
        .replace("card.translation", "floor.rotation")
        .replace("[0.1, 0, 0]", "[1e-3, 0, 0]");
    std::fs::write(at.join("c.toml"), config).unwrap();
    let (code, said) = optimize(at, "c.toml", &["-o", "out"]);
    assert_eq!(code, Some(0), "{said}");
    let told = "floor.rotation, number 0: finite differences over the two steps are far apart";
    assert_eq!(said.matches(told).count(), 1, "{said}");
    let report = std::fs::read_to_string(at.join("out/report.json")).unwrap();
    assert_eq!(report.matches(told).count(), 1, "{report}");
}
