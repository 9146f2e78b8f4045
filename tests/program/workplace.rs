//! A directory with a scene and files of all kinds, and the program run in it.

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A square lit by a constant environment and a smaller one over it, small enough to load in no
/// time.
pub const SCENE: &str = r#"<scene version="3.0.0">
  <default name="side" value="8"/><default name="count" value="4"/>
  <default name="filter" value="box"/>
  <integrator type="path"><integer name="max_depth" value="2"/></integrator>
  <sensor type="perspective" id="cam">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="$count"/></sampler>
    <film type="hdrfilm"><integer name="width" value="$side"/><integer name="height" value="6"/>
      <rfilter type="$filter"/></film>
  </sensor>
  <sensor type="perspective" id="second"><float name="fov" value="50"/></sensor>
  <shape type="rectangle" id="floor">
    <bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.1"/></bsdf>
  </shape>
  <shape type="rectangle" id="card">
    <transform name="to_world"><scale value="0.35"/><rotate z="1" angle="20"/><translate x="0.2" y="0.1" z="0.8"/></transform>
  </shape>
  <emitter type="constant" id="env"><rgb name="radiance" value="1, 1, 1"/></emitter>
</scene>
"#;

pub fn warpath(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_warpath"))
        .args(arguments)
        .current_dir(directory)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

/// Splits at spaces, which no argument here contains.
pub fn typed(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

/// Sends a signal (TERM, INT) to a process. Every shell can; a program of that name is not
/// everywhere.
pub fn signal(process: u32, name: &str) {
    let line = format!("kill -{name} {process}");
    let sent = Command::new("sh").args(["-c", &line]).status();
    assert!(sent.unwrap().success(), "{line}");
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Runs every line and compares its exit code and a part of its message; reports all that
/// fail.
pub fn expect(directory: &Path, table: &[(&str, i32, &str)]) {
    let mut wrong = Vec::new();
    for (line, code, part) in table {
        let out = warpath(directory, &typed(line));
        let message = text(&out.stderr);
        let panicked = message.contains("panicked") || message.contains("RUST_BACKTRACE");
        let in_order = out.status.code() == Some(*code) && message.contains(part) && !panicked;
        if !in_order || !out.stdout.is_empty() {
            wrong.push(format!(
                "`{line}`: {} (wanted {code}, {part:?})\n{message}",
                out.status
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

pub fn npy(directory: &Path, name: &str, descr: &str, shape: &str, data: &[u8]) {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    std::fs::write(directory.join(name), bytes).unwrap();
}

pub fn floats(count: usize, value: f32) -> Vec<u8> {
    value.to_le_bytes().repeat(count)
}

/// A directory with the scene and a collection of good and bad files.
pub fn workplace() -> tempfile::TempDir {
    let directory = tempfile::tempdir().unwrap();
    let at = directory.path();
    std::fs::write(at.join("s.xml"), SCENE).unwrap();
    npy(at, "target.npy", "<f4", "(6, 8, 3)", &floats(144, 0.5));
    npy(at, "small.npy", "<f4", "(4, 4, 3)", &floats(48, 0.5));
    npy(at, "turned.npy", "<f4", "(8, 6, 3)", &floats(144, 0.5));
    npy(at, "nan.npy", "<f4", "(6, 8, 3)", &floats(144, f32::NAN));
    npy(at, "flat.npy", "<f4", "(144,)", &floats(144, 0.5));
    npy(at, "short.npy", "<f4", "(6, 8, 3)", &floats(100, 0.5));
    npy(at, "complex.npy", "<c8", "(6, 8, 3)", &floats(288, 0.5));
    npy(at, "three.npy", "<f4", "(3,)", &floats(3, 1.0));
    npy(at, "four.npy", "<f4", "(4,)", &floats(4, 1.0));
    npy(at, "infinite.npy", "<f4", "(3,)", &floats(3, f32::INFINITY));
    std::fs::write(at.join("text.npy"), "not an array").unwrap();
    std::fs::write(at.join("text.exr"), "not an image").unwrap();
    std::fs::write(at.join("photo.jpg"), "not read").unwrap();
    std::fs::write(at.join("a_file"), "in the way").unwrap();
    directory
}
