//! The worker on standard input.

use crate::jobs::{of_all_kinds, results, run, write};
use crate::workplace::{text, workplace};
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};

fn worker(at: &Path, rest: &str) -> (Child, ChildStdin, BufReader<ChildStdout>) {
    let mut child = Command::new(env!("CARGO_BIN_EXE_warpath"))
        .args(["batch", "-", "-o", "stream"])
        .args(rest.split_whitespace())
        .current_dir(at)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let input = child.stdin.take().unwrap();
    let output = BufReader::new(child.stdout.take().unwrap());
    (child, input, output)
}

fn ask(input: &mut ChildStdin, line: &str) {
    writeln!(input, "{line}").unwrap();
    input.flush().unwrap();
}

fn answer(output: &mut BufReader<ChildStdout>) -> Value {
    let mut line = String::new();
    output.read_line(&mut line).unwrap();
    serde_json::from_str(&line).unwrap_or_else(|_| panic!("{line}"))
}

#[test]
fn each_line_is_answered_before_the_next_is_sent() {
    let directory = workplace();
    let at = directory.path();
    let (child, mut input, mut output) = worker(at, "-t 2");
    for (number, job) in of_all_kinds(6).iter().enumerate() {
        ask(&mut input, &job.to_string());
        let said = answer(&mut output);
        assert_eq!((&said["id"], &said["status"]), (&job["id"], &json!("ok")));
        assert_eq!(said["line"], number + 1);
        // The files are there, and so is the line, when the answer comes.
        for file in said["files"].as_object().unwrap().values() {
            assert!(at.join("stream").join(file.as_str().unwrap()).exists());
        }
        assert_eq!(results(&at.join("stream")).last(), Some(&said));
    }
    ask(&mut input, "rubbish");
    let said = answer(&mut output);
    assert_eq!(
        (&said["id"], &said["code"], &said["line"]),
        (&Value::Null, &json!(3), &json!(7))
    );
    ask(&mut input, &of_all_kinds(1)[0].to_string());
    assert!(
        answer(&mut output)["message"]
            .as_str()
            .unwrap()
            .contains("line 1 already")
    );
    drop(input);
    let out = child.wait_with_output().unwrap();
    assert_eq!(out.status.code(), Some(5), "{}", text(&out.stderr));

    // A second worker knows what the first has done.
    let (child, mut input, mut output) = worker(at, "-q --resume");
    ask(&mut input, &of_all_kinds(1)[0].to_string());
    assert_eq!(answer(&mut output)["line"], 1);
    // By the number it has now: the caller may know no other.
    ask(&mut input, &of_all_kinds(6)[5].to_string());
    let said = answer(&mut output);
    assert_eq!((&said["id"], &said["line"]), (&json!("job-5"), &json!(2)));
    // Another job of an id that is done is answered as any that fails.
    let mut other = of_all_kinds(2)[1].clone();
    other["seed"] = json!(77);
    ask(&mut input, &other.to_string());
    let said = answer(&mut output);
    assert_eq!(
        (&said["id"], &said["code"], &said["line"]),
        (&json!("job-1"), &json!(2), &json!(3))
    );
    assert!(said["job"].as_str().unwrap().starts_with("fnv1a64:"));
    let message = said["message"].as_str().unwrap();
    assert!(
        message.starts_with("line 3: the results have another job job-1 (line 2 then)"),
        "{message}"
    );
    drop(input);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(5));
    write(at, "jobs.jsonl", &of_all_kinds(6));
    run(at, "batch jobs.jsonl -o file -q", 0);
    for folder in 0..6 {
        let folder = format!("job-{folder}");
        crate::jobs::assert_same_files(
            &at.join("file").join(&folder),
            &at.join("stream").join(&folder),
        );
    }
}

#[test]
fn a_scene_that_changes_is_loaded_again() {
    let directory = workplace();
    let at = directory.path();
    let (child, mut input, mut output) = worker(at, "-q");
    let job = |id: &str| json!({"id": id, "mode": "render", "scene": "s.xml"}).to_string();
    ask(&mut input, &job("a"));
    let before = answer(&mut output);
    let scene = std::fs::read_to_string(at.join("s.xml")).unwrap();
    std::fs::write(
        at.join("s.xml"),
        scene.replace("0.2, 0.5, 0.1", "0.2, 0.75, 0.1"),
    )
    .unwrap();
    ask(&mut input, &job("b"));
    let after = answer(&mut output);
    assert_ne!(before["scene_hash"], after["scene_hash"]);
    drop(input);
    assert_eq!(child.wait_with_output().unwrap().status.code(), Some(0));
}

#[test]
fn signals_and_closed_pipes_end_the_worker() {
    let directory = workplace();
    let at = directory.path();
    let (child, mut input, mut output) = worker(at, "-q");
    ask(&mut input, &of_all_kinds(1)[0].to_string());
    answer(&mut output);
    crate::workplace::signal(child.id(), "TERM");
    // Standard input stays open: the worker must not wait for it.
    let out = child.wait_with_output().unwrap();
    assert_eq!(out.status.code(), Some(143), "{}", text(&out.stderr));
    drop(input);
    assert_eq!(results(&at.join("stream")).len(), 1);

    let (child, mut input, output) = worker(at, "-q --resume");
    drop(output);
    ask(&mut input, &of_all_kinds(2)[1].to_string());
    let out = child.wait_with_output().unwrap();
    let message = text(&out.stderr);
    assert_eq!(out.status.code(), Some(4), "{message}");
    let says = "stdout was closed: nobody reads the answers; --resume goes on with stream";
    assert!(message.contains(says), "{message}");
    assert_eq!(
        results(&at.join("stream")).len(),
        2,
        "what was done is kept"
    );
}

#[test]
fn the_python_package_drives_it() {
    let python = |program: &str| {
        Command::new("python3")
            .args(["-c", program])
            .env("PYTHONPATH", "python")
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .env("WARPATH", env!("CARGO_BIN_EXE_warpath"))
            .output()
    };
    let has_what_it_needs = "import sys, numpy; sys.exit(sys.version_info < (3, 10))";
    if !python(has_what_it_needs).is_ok_and(|out| out.status.success()) {
        println!("no python3 (3.10 or later) with numpy here: not tested");
        return;
    }
    // The package's own tests, in python/tests, need pytest: `make test-python`.
    let program = "
import sys; sys.path.insert(0, 'python/examples')
import numpy as np, follow_the_gradient, warpath_worker
end = follow_the_gradient.main('scenes/demo.xml', 'occluder.translation', steps=8)
assert np.linalg.norm(end) < 0.12, end
with warpath_worker.Worker() as worker:
    job = dict(scene='scenes/demo.xml', resolution=[16, 12], spp=4)
    params = {'occluder.translation': [1, 0, 0]}
    jobs = [worker.submit(mode='forward', params=params, seed=i, **job) for i in range(3)]
    for result in [job.result() for job in jobs]:
        assert result.gradient().shape == (12, 16, 3)
        assert (result.standard_error() > 0).any()
    try:
        worker.run(mode='forward', scene='scenes/demo.xml')
        raise SystemExit('a bad job passed')
    except warpath_worker.JobFailed as error:
        assert 'params' in str(error) and error.code == 3, error
";
    let out = python(program).unwrap();
    assert!(
        out.status.success(),
        "{}{}",
        text(&out.stdout),
        text(&out.stderr)
    );
}

#[test]
fn an_image_is_an_array_on_request() {
    let directory = workplace();
    let at = directory.path();
    let job = |id: &str| json!({"id": id, "mode": "render", "scene": "s.xml", "groups": 2});
    let mut on_request = job("array");
    on_request["outputs"] = json!(["image.npy", "image.exr"]);
    write(at, "jobs.jsonl", &[job("plain"), on_request]);
    run(at, "batch jobs.jsonl -o out -q", 0);
    let folder = at.join("out/array");
    let [array, picture] = ["image.npy", "image.exr"].map(|name| {
        let file = warpath::output::picture::PictureFile::open(&folder.join(name)).unwrap();
        file.read().unwrap()
    });
    assert_eq!(array, picture);
    assert!(!folder.join("image.png").exists());
    assert!(!at.join("out/plain/image.npy").exists());

    for shard in ["1/2", "2/2"] {
        let line = format!("batch jobs.jsonl -q --split samples --shard {shard} -o part/{{shard}}");
        run(at, &line, 0);
    }
    run(at, "merge part/1-of-2 part/2-of-2 -o all -q", 0);
    for id in ["plain", "array"] {
        crate::jobs::assert_same_files(&at.join("out").join(id), &at.join("all").join(id));
    }
}
