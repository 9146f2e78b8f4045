//! The real program, as users and scripts meet it: exit codes, messages, streams.

use std::path::Path;
use std::process::{Command, Output, Stdio};

/// A square lit by the sky, small enough to load in no time.
const SCENE: &str = r#"<scene version="3.0.0">
  <default name="side" value="8"/>
  <integrator type="path"><integer name="max_depth" value="2"/></integrator>
  <sensor type="perspective" id="cam">
    <float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform>
    <sampler type="independent"><integer name="sample_count" value="4"/></sampler>
    <film type="hdrfilm"><integer name="width" value="$side"/><integer name="height" value="6"/>
      <rfilter type="box"/></film>
  </sensor>
  <shape type="rectangle" id="floor">
    <bsdf type="diffuse"><rgb name="reflectance" value="0.2, 0.5, 0.1"/></bsdf>
  </shape>
  <emitter type="constant" id="env"><rgb name="radiance" value="1, 1, 1"/></emitter>
</scene>
"#;

fn warpath(directory: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_warpath"))
        .args(arguments)
        .current_dir(directory)
        .stdin(Stdio::null())
        .output()
        .unwrap()
}

/// Splits at spaces, which no argument here contains.
fn typed(line: &str) -> Vec<&str> {
    line.split_whitespace().collect()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Runs every line and compares its exit code and a part of its message; reports all that fail.
fn expect(directory: &Path, table: &[(&str, i32, &str)]) {
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

fn npy(directory: &Path, name: &str, descr: &str, shape: &str, data: &[u8]) {
    let header = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    std::fs::write(directory.join(name), bytes).unwrap();
}

fn floats(count: usize, value: f32) -> Vec<u8> {
    value.to_le_bytes().repeat(count)
}

/// A directory with the scene and a collection of good and bad files.
fn workplace() -> tempfile::TempDir {
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

#[test]
fn wrong_usage_is_told() {
    let directory = workplace();
    expect(
        directory.path(),
        &[
            ("", 2, "Usage"),
            ("paint s.xml", 2, "unrecognized subcommand 'paint'"),
            ("rendr s.xml", 2, "render"),
            ("optimize c.toml", 2, "warpath optimize is not built yet"),
            ("batch jobs.jsonl", 2, "warpath batch is not built yet"),
            ("merge a b", 2, "warpath merge is not built yet"),
            ("study c.toml", 2, "warpath study is not built yet"),
            ("bench", 2, "warpath bench is not built yet"),
            ("render", 2, "<SCENE>"),
            ("params", 2, "<SCENE>"),
            ("render s.xml t.xml", 2, "t.xml"),
            ("render s.xml --frobnicate", 2, "--frobnicate"),
            ("render s.xml --sp 4", 2, "--spp"),
            ("render s.xml --spp 0", 2, "--spp"),
            ("render s.xml --spp -3", 2, "-3"),
            ("render s.xml --spp many", 2, "many"),
            ("render s.xml --spp 5000000000", 2, "5000000000"),
            ("render s.xml --spp", 2, "--spp"),
            ("render s.xml --spp 4 --spp 8", 2, "multiple times"),
            ("render s.xml --seed -1", 2, "-1"),
            ("render s.xml --seed 1.5", 2, "1.5"),
            ("render s.xml --threads 0", 2, "from 1 to 4096"),
            ("render s.xml -t x", 2, "from 1 to 4096"),
            ("render s.xml --max-depth 0", 2, "segments is black"),
            ("render s.xml --max-depth -2", 2, "-1 for no limit"),
            ("render s.xml --max-depth deep", 2, "-1 for no limit"),
            ("render s.xml --sensor first", 2, "first"),
            ("render s.xml --resolution 640", 2, "640x480"),
            ("render s.xml --resolution 0x480", 2, "65536"),
            ("render s.xml --resolution 640x", 2, "640x480"),
            ("render s.xml --resolution 640x480x3", 2, "640x480"),
            ("render s.xml --resolution 999999x1", 2, "65536"),
            (
                "render s.xml --backend obvhs",
                2,
                "--backend obvhs is not built yet",
            ),
            ("render s.xml --backend optix", 2, "embree"),
            ("render s.xml --log-format xml", 2, "json"),
            ("render s.xml -D side", 2, "-D side=value"),
            ("render s.xml -D =8", 2, "-D name=value"),
            ("render s.xml --method reparam", 2, "--method"),
            ("forward s.xml", 2, "--param <KEY=TANGENT>"),
            (
                "forward s.xml --param floor.translation",
                2,
                "floor.translation=1,0,0",
            ),
            ("forward s.xml --param =1,0,0", 2, "key is missing"),
            (
                "forward s.xml --param floor.translation=",
                2,
                "number of the tangent is missing",
            ),
            (
                "forward s.xml --param floor.translation=1,,0",
                2,
                "number of the tangent is missing",
            ),
            (
                "forward s.xml --param floor.translation=1,a,0",
                2,
                "'a' is not a number",
            ),
            (
                "forward s.xml --param floor.translation=nan",
                2,
                "'nan' is not a finite number",
            ),
            (
                "forward s.xml --param floor.translation=1,inf,0",
                2,
                "'inf' is not a finite",
            ),
            (
                "forward s.xml --param floor.translation=1e39",
                2,
                "'1e39' is not a finite",
            ),
            (
                "forward s.xml --param floor.translation=@",
                2,
                "no file is named",
            ),
            (
                "forward s.xml --param floor.translation=1 --method auto",
                2,
                "auto is not built yet",
            ),
            (
                "forward s.xml --param floor.translation=1 --method edges",
                2,
                "edges is not built yet",
            ),
            (
                "forward s.xml --param floor.translation=1 --method warped-area",
                2,
                "not built yet",
            ),
            (
                "forward s.xml --param floor.translation=1 --method magic",
                2,
                "reparam",
            ),
            ("backward s.xml --target target.npy", 2, "--param <KEY>"),
            ("backward s.xml --param floor.translation", 2, "--adjoint"),
            (
                "backward s.xml --param floor.translation=1,0,0 --target target.npy",
                2,
                "write --param floor.translation",
            ),
            (
                "backward s.xml --param floor.translation --target a.npy --adjoint b.npy",
                2,
                "cannot be used with",
            ),
            (
                "backward s.xml --param floor.translation --adjoint b.npy --loss l1",
                2,
                "cannot be used with",
            ),
            (
                "backward s.xml --param floor.translation --target a.npy --loss l3",
                2,
                "l1",
            ),
            (
                "backward s.xml --param floor.translation --target a.npy --method fd",
                2,
                "no reverse",
            ),
            (
                "check s.xml --param floor.translation=1 --method fd",
                2,
                "checked against",
            ),
            (
                "check s.xml --param floor.translation=1 --no-stderr",
                2,
                "--no-stderr",
            ),
            (
                "check s.xml --param floor.translation=1 --tolerance 2",
                2,
                "0.03",
            ),
            ("completions tcsh", 2, "bash"),
        ],
    );
    assert!(
        !directory.path().join("out").exists(),
        "wrong usage must leave nothing behind"
    );
}

#[test]
#[ignore = "needs the scene loader"]
fn bad_input_is_told() {
    let directory = workplace();
    let forward = |rest: &str| format!("forward s.xml --param {rest}");
    let target = |file: &str| format!("backward s.xml --param floor.translation --target {file}");
    let adjoint = |file: &str| format!("backward s.xml --param floor.translation --adjoint {file}");
    let lines = [
        ("render nosuch.xml".into(), "nosuch.xml"),
        ("params nosuch.xml".into(), "nosuch.xml"),
        ("render a_file".into(), "a_file"),
        ("render .".into(), "."),
        (
            "render s.xml --sensor 1".into(),
            "the scene has 1 sensor, counted from 0: cam",
        ),
        (
            "params s.xml -s 7".into(),
            "the scene has 1 sensor, counted from 0: cam",
        ),
        ("render s.xml -D side=wide".into(), "wide"),
        (forward("flor.translation=1,0,0"), "floor.translation"),
        (forward("floor.translatoin=1,0,0"), "floor.translation"),
        (forward("nothing=1"), "nothing"),
        (forward("floor.translation=1,0"), "give 1 or 3 numbers"),
        (forward("floor.translation=1,0,0,0"), "the shape is (3,)"),
        (forward("floor.scale=1,2"), "give 1 number"),
        (
            forward("floor.translation=1 --param floor.translation=0,1,0"),
            "is given twice",
        ),
        (
            forward("floor.positions=1 --param floor.vertex_positions=1"),
            "is given twice",
        ),
        (forward("floor.translation=@nosuch.npy"), "nosuch.npy"),
        (
            forward("floor.translation=@four.npy"),
            "four.npy: the shape is (4,)",
        ),
        (
            forward("floor.translation=@infinite.npy"),
            "number 0 is not finite",
        ),
        (forward("floor.translation=@text.npy"), "not a NumPy array"),
        (
            forward("floor.vertex_positions=@three.npy"),
            "floor.vertex_positions has (4, 3)",
        ),
        (
            "backward s.xml --param nothing --target target.npy".into(),
            "nothing",
        ),
        (
            "backward s.xml --param floor.scale --param floor.scale --target target.npy".into(),
            "is given twice",
        ),
        (target("nosuch.exr"), "nosuch.exr"),
        (target("text.exr"), "not a readable OpenEXR image"),
        (target("photo.jpg"), "an .exr or an .npy"),
        (
            target("small.npy"),
            "4x4 pixels, the image rendered has 8x6",
        ),
        (target("turned.npy"), "6x8 pixels"),
        (target("nan.npy"), "the pixel at x 0, y 0 is not finite"),
        (target("flat.npy"), "(144,) is not that of an image"),
        (target("short.npy"), "400 bytes"),
        (target("complex.npy"), "c8"),
        (adjoint("text.npy"), "not a NumPy array"),
        (adjoint("small.npy"), "--resolution"),
        (
            adjoint("target.npy --resolution 4x4"),
            "8x6 pixels, the image rendered has 4x4",
        ),
        (
            "check s.xml --param floor.translation=1,0".into(),
            "give 1 or 3 numbers",
        ),
    ];
    let table: Vec<(&str, i32, &str)> = lines
        .iter()
        .map(|(line, part): &(String, &str)| (line.as_str(), 3, *part))
        .collect();
    expect(directory.path(), &table);
    assert!(
        !directory.path().join("out").exists(),
        "bad input must leave nothing behind"
    );
}

#[test]
#[ignore = "needs the scene loader"]
fn a_place_that_cannot_be_written_is_told_before_anything_is_traced() {
    let directory = workplace();
    expect(
        directory.path(),
        &[
            (
                "render s.xml -o a_file",
                4,
                "a_file: cannot be written into",
            ),
            ("render s.xml -o a_file/below", 4, "cannot be written into"),
            (
                "render s.xml -o /proc/warpath",
                4,
                "/proc/warpath: cannot be written into",
            ),
        ],
    );
}

#[test]
fn help_version_completions_and_man_go_to_stdout() {
    let directory = workplace();
    let table = [
        ("--help", "Exit codes"),
        ("-h", "forward"),
        ("--version", env!("CARGO_PKG_VERSION")),
        ("render --help", "--max-depth"),
        ("forward --help", "KEY=TANGENT"),
        ("backward --help", "--adjoint"),
        ("check --help", "--tolerance"),
        ("params --help", "--json"),
        ("completions bash", "complete -F _warpath"),
        ("completions zsh", "#compdef warpath"),
        ("completions fish", "complete -c warpath"),
        ("man", ".TH warpath 1"),
    ];
    for (line, part) in table {
        let out = warpath(directory.path(), &typed(line));
        assert_eq!(out.status.code(), Some(0), "{line}");
        assert!(
            text(&out.stdout).contains(part),
            "{line}: {}",
            text(&out.stdout)
        );
        assert!(out.stderr.is_empty(), "{line}: {}", text(&out.stderr));
    }
}

#[test]
fn the_man_page_knows_every_option() {
    let directory = workplace();
    let page = text(&warpath(directory.path(), &["man"]).stdout);
    for option in [
        "spp",
        "seed",
        "threads",
        "resolution",
        "adjoint",
        "target",
        "tolerance",
    ] {
        assert!(page.contains(&format!("\\-\\-{option}")), "{option}");
    }
}

#[test]
fn a_closed_stdout_is_success() {
    for arguments in ["man", "completions zsh", "--help"] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_warpath"))
            .args(typed(arguments))
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        drop(child.stdout.take());
        let out = child.wait_with_output().unwrap();
        assert_eq!(
            out.status.code(),
            Some(0),
            "{arguments}: {}",
            text(&out.stderr)
        );
        assert!(out.stderr.is_empty(), "{arguments}: {}", text(&out.stderr));
    }
}

#[test]
fn piped_messages_have_no_colour_with_or_without_no_color() {
    let directory = workplace();
    for no_color in [None, Some("1")] {
        for line in ["render nosuch.xml", "render s.xml --spp x", "--help"] {
            let mut command = Command::new(env!("CARGO_BIN_EXE_warpath"));
            command
                .args(typed(line))
                .current_dir(directory.path())
                .env_remove("NO_COLOR");
            if let Some(value) = no_color {
                command.env("NO_COLOR", value);
            }
            let out = command.output().unwrap();
            let all = text(&out.stdout) + &text(&out.stderr);
            assert!(!all.contains('\x1b'), "{line}: {all}");
        }
    }
}

#[test]
fn errors_can_be_json_and_quiet_keeps_them() {
    let directory = workplace();
    let out = warpath(
        directory.path(),
        &typed("render nosuch.xml --log-format json --quiet"),
    );
    assert_eq!(out.status.code(), Some(3));
    let line: serde_json::Value = serde_json::from_slice(&out.stderr).unwrap();
    assert_eq!(line["level"], "error");
    assert!(line["message"].as_str().unwrap().contains("nosuch.xml"));
}

#[test]
#[ignore = "needs the scene loader"]
fn params_prints_a_table_or_json() {
    let directory = workplace();
    let out = warpath(directory.path(), &["params", "s.xml"]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let table = text(&out.stdout);
    assert!(
        table.contains("floor.vertex_positions") && table.contains("(4, 3)"),
        "{table}"
    );
    let out = warpath(directory.path(), &["params", "s.xml", "--json"]);
    let list: serde_json::Value = serde_json::from_slice(&out.stdout).unwrap();
    let keys: Vec<&str> = list
        .as_array()
        .unwrap()
        .iter()
        .map(|p| p["key"].as_str().unwrap())
        .collect();
    assert!(
        keys.contains(&"floor.translation") && keys.contains(&"cam.translation"),
        "{keys:?}"
    );
}
