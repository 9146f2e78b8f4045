//! Files that never end, and headers that claim what no memory holds: told at once.

#![cfg(target_os = "linux")]

use crate::workplace::{SCENE, npy, text, workplace};
use std::io::Read;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Address space of the program: what reads on without end fails for want of it rather than taking
/// the machine's.
const KILOBYTES: u32 = 2_000_000;

/// Far more than any of these take, and less than a pipe that nobody writes into.
const PATIENCE: Duration = Duration::from_secs(30);

fn refuses(directory: &Path, line: &str, code: i32, part: &str) -> Result<(), String> {
    let program = env!("CARGO_BIN_EXE_warpath");
    let mut child = Command::new("sh")
        .args([
            "-c",
            &format!("ulimit -v {KILOBYTES}; exec {program} {line}"),
        ])
        .current_dir(directory)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let started = Instant::now();
    let status = loop {
        match child.try_wait().unwrap() {
            Some(status) => break status,
            None if started.elapsed() > PATIENCE => {
                child.kill().unwrap();
                child.wait().unwrap();
                return Err(format!("`{line}` does not end"));
            }
            None => std::thread::sleep(Duration::from_millis(10)),
        }
    };
    let mut message = Vec::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_end(&mut message)
        .unwrap();
    let message = text(&message);
    match status.code() == Some(code) && message.contains(part) {
        true => Ok(()),
        false => Err(format!("`{line}`: {status} (wanted {code})\n{message}")),
    }
}

fn all_refuse(directory: &Path, table: &[(String, i32, &str)]) {
    let wrong: Vec<String> = table
        .iter()
        .filter_map(|(line, code, part)| refuses(directory, line, *code, part).err())
        .collect();
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn only_regular_files_are_read() {
    let directory = workplace();
    let at = directory.path();
    let pipes = ["pipe", "pipe.npy", "pipe.exr", "pipe.safetensors"];
    let made = Command::new("mkfifo").args(pipes).current_dir(at).status();
    assert!(made.unwrap().success());
    let mut table = Vec::new();
    for file in pipes.into_iter().chain(["/dev/zero"]) {
        for line in [
            format!("forward s.xml --param floor.scale=@{file}"),
            format!("backward s.xml --param floor.scale --target {file}"),
            format!("backward s.xml --param floor.scale --adjoint {file}"),
        ] {
            table.push((line, 3, "not a regular file"));
        }
    }
    let job = |id: usize, file: &str| {
        format!(
            r#"{{"id":"{id}","mode":"render","scene":"s.xml","set":{{"floor.scale":"{file}"}}}}"#
        )
    };
    let jobs: Vec<String> = pipes.iter().enumerate().map(|(i, p)| job(i, p)).collect();
    std::fs::write(at.join("jobs.jsonl"), jobs.join("\n")).unwrap();
    table.push(("batch jobs.jsonl".into(), 5, "4 of 4 jobs failed"));
    all_refuse(at, &table);
}

/// An OpenEXR header without anything behind it.
fn exr_claiming(side: i32) -> Vec<u8> {
    let mut bytes = b"\x76\x2f\x31\x01\x02\0\0\0".to_vec();
    let mut attribute = |name: &str, kind: &str, value: &[u8]| {
        bytes.extend(format!("{name}\0{kind}\0").as_bytes());
        bytes.extend((value.len() as i32).to_le_bytes());
        bytes.extend(value);
    };
    let channel =
        |name: &str| [name.as_bytes(), b"\0\x02\0\0\0\0\0\0\0\x01\0\0\0\x01\0\0\0"].concat();
    let channels = ["B", "G", "R"].map(channel).concat();
    attribute("channels", "chlist", &[channels.as_slice(), b"\0"].concat());
    attribute("compression", "compression", &[0]);
    let window = [0, 0, side - 1, side - 1].map(i32::to_le_bytes).concat();
    attribute("dataWindow", "box2i", &window);
    attribute("displayWindow", "box2i", &window);
    attribute("lineOrder", "lineOrder", &[0]);
    attribute("pixelAspectRatio", "float", &1f32.to_le_bytes());
    attribute("screenWindowCenter", "v2f", &[0; 8]);
    attribute("screenWindowWidth", "float", &1f32.to_le_bytes());
    bytes.push(0);
    bytes
}

#[test]
fn headers_that_claim_too_much_are_told_before_anything_is_decoded() {
    let directory = workplace();
    let at = directory.path();
    let write = |name: &str, bytes: &[u8]| std::fs::write(at.join(name), bytes).unwrap();
    write("huge.exr", &exr_claiming(100_000));
    write("huge.pfm", b"PF\n100000 100000\n-1.0\n");
    write(
        "huge.hdr",
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n",
    );
    // As many bytes as there should be, none of them on the disk.
    npy(at, "huge.npy", "<f4", "(100000, 100000, 3)", &[]);
    let header = std::fs::metadata(at.join("huge.npy")).unwrap().len();
    let file = std::fs::File::options()
        .write(true)
        .open(at.join("huge.npy"));
    file.unwrap().set_len(header + 120_000_000_000).unwrap();
    write("huge.safetensors", &(1u64 << 60).to_le_bytes());
    write("huge.ply", b"ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n\
        property float z\nelement face 4000000000\nproperty list uchar int vertex_indices\nend_header\n");
    let mut table = Vec::new();
    for file in ["huge.exr", "huge.pfm", "huge.hdr", "huge.npy"] {
        let line = format!("backward s.xml --param floor.scale --target {file}");
        table.push((line, 3, "100000x100000 pixels, the image rendered has 8x6"));
    }
    for file in ["huge.npy", "huge.safetensors"] {
        let line = format!("forward s.xml --param floor.scale=@{file}");
        table.push((line, 3, file));
    }
    for (file, part) in [
        ("huge.exr", "absurd"),
        ("huge.pfm", "absurd"),
        ("huge.hdr", "absurd"),
    ] {
        let sky =
            format!(r#"<emitter type="envmap"><string name="filename" value="{file}"/></emitter>"#);
        let constant = SCENE.find("<emitter").unwrap();
        write(
            &format!("{file}.xml"),
            format!("{}{sky}</scene>", &SCENE[..constant]).as_bytes(),
        );
        table.push((format!("render {file}.xml"), 3, part));
    }
    let mesh = r#"<shape type="ply"><string name="filename" value="huge.ply"/></shape></scene>"#;
    write("ply.xml", SCENE.replace("</scene>", mesh).as_bytes());
    table.push(("render ply.xml".into(), 3, "truncated"));
    all_refuse(at, &table);
}

#[test]
fn what_memory_does_not_hold_is_no_fault_of_the_file() {
    let directory = workplace();
    let at = directory.path();
    // The file is whole: 2.1 GB, none of them on the disk.
    std::fs::write(at.join("sky.pfm"), b"PF\n13400 13400\n-1.0\n").unwrap();
    let file = std::fs::File::options()
        .write(true)
        .open(at.join("sky.pfm"));
    file.unwrap().set_len(21 + 13_400 * 13_400 * 12).unwrap();
    let sky =
        r#"<emitter type="envmap"><string name="filename" value="sky.pfm"/></emitter></scene>"#;
    let scene = &SCENE[..SCENE.find("<emitter").unwrap()];
    std::fs::write(at.join("sky.xml"), format!("{scene}{sky}")).unwrap();
    all_refuse(
        at,
        &[(
            "render sky.xml".into(),
            4,
            "sky.pfm: no memory for it: 2055 MB are needed",
        )],
    );
}

#[test]
fn control_characters_of_files_do_not_reach_the_terminal() {
    let directory = workplace();
    let at = directory.path();
    let bell = "\x1b]0;x\x07";
    let write = |name: &str, text: String| std::fs::write(at.join(name), text).unwrap();
    write("width.pfm", format!("PF\n{bell} 6\n-1.0\n"));
    npy(at, "kind.npy", &format!("<{bell}"), "(3,)", &[0; 12]);
    write(
        "mesh.ply",
        format!("ply\nformat ascii 1.0\nelement {bell} 1\nproperty float x\nend_header\n"),
    );
    write("mesh.obj", format!("v 0 0 {bell}\n"));
    for file in ["mesh.ply", "mesh.obj"] {
        let kind = &file[5..];
        let mesh = format!(
            r#"<shape type="{kind}"><string name="filename" value="{file}"/></shape></scene>"#
        );
        write(&format!("{kind}.xml"), SCENE.replace("</scene>", &mesh));
    }
    let c1 = "\u{9b}31m";
    write(
        "c1.xml",
        SCENE.replace(
            "type=\"rectangle\" id=\"floor\"",
            &format!("type=\"{c1}\" id=\"floor\""),
        ),
    );
    write(
        "id.xml",
        SCENE.replace("id=\"floor\"", &format!("id=\"{c1}\"")),
    );
    let name = format!("no{bell}\nerror: such");
    let lines: [(&[&str], i32); 9] = [
        (
            &[
                "backward",
                "s.xml",
                "--param",
                "floor.scale",
                "--target",
                "width.pfm",
            ],
            3,
        ),
        (
            &["forward", "s.xml", "--param", "floor.translation=@kind.npy"],
            3,
        ),
        (&["render", "ply.xml"], 3),
        (&["render", "obj.xml"], 3),
        (&["render", "c1.xml"], 3),
        (&["render", "c1.xml", "--log-format", "json"], 3),
        (&["params", "id.xml"], 0),
        (&["render", &name], 3),
        (&["render", "s.xml", &name], 2),
    ];
    for (line, code) in lines {
        let out = crate::workplace::warpath(at, line);
        let said = text(&out.stderr) + &text(&out.stdout);
        assert_eq!(out.status.code(), Some(code), "{line:?}: {said:?}");
        let raw = |c: char| c != '\n' && c.is_control();
        assert!(
            !said.is_empty() && !said.contains(raw),
            "{line:?}: {said:?}"
        );
        assert!(!said.contains("\nerror: such"), "{line:?}: {said:?}");
    }
}
