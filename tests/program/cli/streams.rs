//! What goes to stdout and stderr.

use crate::workplace::{text, typed, warpath, workplace};
use std::process::{Command, Stdio};

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
        ("batch --help", "--resume"),
        ("merge --help", "shards"),
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
        "resume",
        "shard",
        "memory",
    ] {
        assert!(page.contains(&format!("\\-\\-{option}")), "{option}");
    }
}

#[test]
fn a_closed_stdout_is_success() {
    let directory = workplace();
    for arguments in [
        "man",
        "completions zsh",
        "--help",
        "params s.xml",
        "render s.xml --json -q",
    ] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_warpath"))
            .args(typed(arguments))
            .current_dir(directory.path())
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
#[cfg(target_os = "linux")]
fn a_full_disk_behind_stdout_is_told() {
    let directory = workplace();
    for arguments in [
        "--help",
        "-h",
        "--version",
        "render --help",
        "man",
        "completions bash",
        "params s.xml",
        "params s.xml --json",
        "batch --schema",
        "render s.xml --json -q",
        "check s.xml --param env.radiance.value=1,1,1 -q",
    ] {
        let full = std::fs::File::options().write(true).open("/dev/full");
        let out = Command::new(env!("CARGO_BIN_EXE_warpath"))
            .args(typed(arguments))
            .current_dir(directory.path())
            .stdout(full.unwrap())
            .output()
            .unwrap();
        let message = text(&out.stderr);
        assert_eq!(out.status.code(), Some(4), "{arguments}: {message}");
        assert!(
            message.contains("error: stdout: No space left on device"),
            "{arguments}: {message}"
        );
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
fn params_prints_a_table_or_json() {
    let directory = workplace();
    let out = warpath(directory.path(), &["params", "s.xml"]);
    assert_eq!(out.status.code(), Some(0), "{}", text(&out.stderr));
    let table = text(&out.stdout);
    assert!(
        table.contains("floor.vertex_positions") && table.contains("(4, 3)"),
        "{table}"
    );
    let line = |key: &str| table.lines().find(|line| line.starts_with(key)).unwrap();
    assert!(line("floor.translation ").contains("∂ v"), "{table}");
    let colour = line("floor.bsdf.reflectance.value ");
    assert!(
        colour.contains("∂ ") && !colour.contains("∂ v") && colour.contains("0.2, 0.5, 0.1"),
        "{table}"
    );
    assert!(
        line("cam.x_fov ").ends_with(" 40") && !line("cam.film.size ").contains('∂'),
        "{table}"
    );
    assert!(
        line("floor.vertex_positions ").ends_with("floor.positions"),
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
    let find = |key: &str| {
        list.as_array()
            .unwrap()
            .iter()
            .find(|p| p["key"] == key)
            .unwrap()
    };
    let positions = find("floor.vertex_positions");
    assert_eq!(positions["aliases"][0], "floor.positions");
    assert_eq!(positions["value"]["min"], -1.0);
    assert_eq!(positions["moves_visibility"], true);
    let colour = &find("floor.bsdf.reflectance.value")["value"];
    assert_eq!(*colour, serde_json::json!([0.2, 0.5, 0.1]));
}

/// Before anything is done, a bar of an unknown length would be a full one.
#[cfg(target_os = "linux")]
#[test]
fn the_bar_on_a_terminal_does_not_begin_full() {
    let directory = workplace();
    let line = format!(
        "{} render s.xml --resolution 256x256 --spp 64 -t 1 -o out",
        env!("CARGO_BIN_EXE_warpath")
    );
    let out = Command::new("script")
        .args(["-qec", &line, "/dev/null"])
        .current_dir(directory.path())
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let shown = text(&out.stdout);
    assert_eq!(out.status.code(), Some(0), "{shown}");
    let shares = shown.match_indices(" %").map(|(at, _)| {
        let before = shown[..at].rsplit(' ').next();
        before
            .and_then(|n| n.parse::<u32>().ok())
            .expect("a number")
    });
    let shares: Vec<u32> = shares.collect();
    assert!(
        shares.first().is_some_and(|share| *share < 100),
        "{shares:?}"
    );
    assert!(shares.is_sorted(), "{shares:?}");
}
