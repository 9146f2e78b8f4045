//! Broken scenes and meshes: each is refused with the place and a sentence, never with a panic.

mod elements;
mod files;
mod meshes;
mod sensors;
mod surfaces;

use std::path::Path;
use warpath::scene::{SceneError, load};

/// One broken input.
struct Case {
    name: &'static str,
    /// The scene is `s.xml`.
    files: Vec<(&'static str, Vec<u8>)>,
    defines: Vec<(&'static str, &'static str)>,
    kind: Kind,
    /// The message has all of these.
    says: &'static [&'static str],
}

#[derive(Debug, PartialEq)]
enum Kind {
    Scene,
    Mesh,
    Missing,
    Define,
}

fn kind(error: &SceneError) -> Option<Kind> {
    match error {
        SceneError::Scene { .. } => Some(Kind::Scene),
        SceneError::Mesh { .. } => Some(Kind::Mesh),
        SceneError::Missing { .. } => Some(Kind::Missing),
        SceneError::Define { .. } => Some(Kind::Define),
        SceneError::Parameter { .. } | SceneError::Several { .. } | SceneError::Io { .. } => None,
    }
}

/// A scene file with an error.
fn text(name: &'static str, scene: &str, says: &'static [&'static str]) -> Case {
    Case {
        name,
        files: vec![("s.xml", scene.as_bytes().to_vec())],
        defines: Vec::new(),
        kind: Kind::Scene,
        says,
    }
}

const SENSOR: &str = "<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>";

/// `inside` stands on line 2 of an otherwise good scene.
fn inside(name: &'static str, inside: &str, says: &'static [&'static str]) -> Case {
    text(
        name,
        &format!("<scene version=\"3.0.0\">\n{inside}\n{SENSOR}</scene>"),
        says,
    )
}

/// A shape that reads the mesh file `file`.
fn mesh(
    name: &'static str,
    file: &'static str,
    bytes: impl Into<Vec<u8>>,
    says: &'static [&'static str],
) -> Case {
    let (_, plugin) = file.rsplit_once('.').expect("an extension");
    let shape =
        format!("<shape type=\"{plugin}\"><string name=\"filename\" value=\"{file}\"/></shape>");
    let mut case = inside(name, &shape, says);
    case.files.push((file, bytes.into()));
    case.kind = Kind::Mesh;
    case
}

fn ply(body: &str) -> String {
    let header = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                  element face 1\nproperty list uchar int vertex_indices\nend_header\n";
    format!("{header}{body}")
}

fn run(case: &Case, folder: &Path) -> Result<(), String> {
    for (name, bytes) in &case.files {
        let path = folder.join(name);
        std::fs::create_dir_all(path.parent().unwrap_or(folder)).map_err(|e| e.to_string())?;
        std::fs::write(path, bytes).map_err(|e| e.to_string())?;
    }
    let defines: Vec<(String, String)> = case
        .defines
        .iter()
        .map(|(n, v)| (n.to_string(), v.to_string()))
        .collect();
    let Err(error) = load(folder.join("s.xml"), &defines) else {
        return Err("it loaded".to_string());
    };
    let message = error.to_string();
    if kind(&error).as_ref() != Some(&case.kind) {
        return Err(format!("{error:?} is no {:?} error", case.kind));
    }
    if message.lines().count() > 2 || message.len() > 500 {
        return Err(format!("too long: {message}"));
    }
    match case.says.iter().find(|part| !message.contains(**part)) {
        Some(part) => Err(format!("\"{part}\" is not in: {message}")),
        None => Ok(()),
    }
}

#[test]
fn broken_scenes_and_meshes_are_refused_with_their_place() {
    let cases: Vec<Case> = [
        elements::cases(),
        surfaces::cases(),
        sensors::cases(),
        files::cases(),
        meshes::cases(),
    ]
    .into_iter()
    .flatten()
    .collect();
    assert!(cases.len() >= 150);
    let mut failures = Vec::new();
    for case in &cases {
        let folder = tempfile::tempdir().unwrap();
        if let Err(what) = run(case, folder.path()) {
            failures.push(format!("{}: {what}", case.name));
        }
    }
    assert!(
        failures.is_empty(),
        "{} of {} cases:\n{}",
        failures.len(),
        cases.len(),
        failures.join("\n")
    );
}

const SEVERAL: &str = "<scene version=\"3.0.0\">
<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>
<shape type=\"cube\" id=\"good\"/>
<shape type=\"sphere\"><float name=\"radius\" value=\"-1\"/></shape>
<shape type=\"ply\"><string name=\"filename\" value=\"none.ply\"/></shape>
</scene>";

const UNSUPPORTED: &str = "<scene version=\"3.0.0\">
<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/></sensor>
<shape type=\"sdfgrid\"/>
<shape type=\"cube\" id=\"furry\"><bsdf type=\"hair\"/><medium type=\"homogeneous\" name=\"interior\"/></shape>
<shape type=\"cube\"><bsdf type=\"hair\"><ref id=\"inside\"/></bsdf></shape>
<shape type=\"cube\" id=\"red\"><bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"0.3\"/></bsdf></shape>
</scene>";

#[test]
fn all_that_is_wrong_is_said_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.xml");
    let message = |text: &str| {
        std::fs::write(&path, text).unwrap();
        load(&path, &[]).expect_err("it is wrong").to_string()
    };
    let several = message(SEVERAL);
    assert_eq!(several.lines().count(), 2, "{several}");
    assert!(several.contains("s.xml:4:22") && several.contains("s.xml:5:19"));
    let unsupported = message(UNSUPPORTED);
    assert_eq!(unsupported.lines().count(), 3, "{unsupported}");
    for part in [
        "s.xml:3:1",
        "extract its surface",
        "s.xml:4:32",
        "fibres",
        "(and 1 more of them)",
        "out of scope",
    ] {
        assert!(unsupported.contains(part), "no \"{part}\" in {unsupported}");
    }
}

#[test]
fn what_is_not_supported_does_not_matter_for_listing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.xml");
    std::fs::write(&path, SEVERAL).unwrap();
    assert!(warpath::scene::load_to_list(&path, &[]).is_err());
    std::fs::write(&path, UNSUPPORTED).unwrap();
    let scene = warpath::scene::load_to_list(&path, &[]).expect("what there is");
    assert_eq!(scene.warnings.len(), 4, "{:?}", scene.warnings);
    let keys = warpath::scene::parameters::list(&scene);
    for key in ["furry.translation", "red.bsdf.reflectance.value"] {
        assert!(keys.iter().any(|p| p.key == key), "no {key} in {keys:?}");
    }
    assert!(!keys.iter().any(|p| p.key.starts_with("furry.bsdf")));
}
