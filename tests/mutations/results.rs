//! What a run leaves: files that are there, can be read, and hold numbers that are finite.

use super::promises::{Violation, value};
use safetensors::SafeTensors;
use serde_json::Value;
use std::fs;
use std::io::Read;
use std::path::Path;
use warpath::output::npy;
use warpath::output::picture::PictureFile;

/// Fields that may be null: there is no limit, no method, nothing to tell, nothing to be relative
/// to.
const NULLABLE: [&str; 9] = [
    "relative_bias",
    "relative_bias_se",
    "relative_rms",
    "max_depth",
    "method",
    "peak_memory_bytes",
    "processor_seconds",
    "id",
    "scene_hash",
];

/// The first promise about results that was not kept.
pub fn broken(
    directory: &Path,
    arguments: &[String],
    code: i32,
    stdout: &[u8],
) -> Option<Violation> {
    let command = arguments.first().map_or("", String::as_str);
    let asks_for_help = ["--help", "-h", "--version", "-V", "--schema"];
    if arguments
        .iter()
        .any(|a| asks_for_help.contains(&a.as_str()))
    {
        return None;
    }
    let output = directory.join(value(arguments, "-o").unwrap_or("out"));
    let found = match (command, code) {
        ("render" | "forward" | "backward", 0) | ("check", 0 | 1 | 6) => {
            single(command, arguments, &output)
        }
        ("params", 0) => listed(arguments, stdout),
        ("batch", 0 | 5) => batch(arguments, &output, code, stdout),
        ("merge", 0) => lines_of(&output).and_then(|lines| each(&output, &lines)),
        _ => Ok(()),
    };
    found.err().map(|what| {
        // A kind has no numbers of the case.
        let kind = what.split(" | ").next().unwrap_or_default();
        let method = value(arguments, "--method").unwrap_or("");
        Violation::new(format!("{command} {method}: {kind}"), what.clone())
    })
}

type Found<T> = Result<T, String>;

fn single(command: &str, arguments: &[String], output: &Path) -> Found<()> {
    let report = json(&output.join("report.json"))?;
    no_nulls("report.json", &report)?;
    let files = names(&report["files"]);
    let least: &[&str] = match command {
        "render" => &["image.exr", "image.png"],
        "forward" => &["gradient.exr", "gradient.npy", "gradient.png", "image.exr"],
        "backward" => &["gradients.safetensors", "gradients.npz", "image.exr"],
        _ => &["check.json", "forward.exr", "fd.exr", "z.exr"],
    };
    for name in least {
        if !files.iter().any(|f| f == name) {
            return Err(format!("{name} is not promised"));
        }
    }
    let without = arguments.iter().any(|a| a == "--no-stderr");
    if without && files.iter().any(|f| f == "stderr.npy") {
        return Err("stderr.npy in spite of --no-stderr".into());
    }
    files.iter().try_for_each(|f| file(&output.join(f)))
}

fn names(list: &Value) -> Vec<String> {
    let strings = list.as_array().into_iter().flatten();
    strings
        .filter_map(|name| Some(name.as_str()?.to_string()))
        .collect()
}

fn listed(arguments: &[String], stdout: &[u8]) -> Found<()> {
    if !arguments.iter().any(|a| a == "--json") {
        let text = String::from_utf8_lossy(stdout).to_lowercase();
        let bad = text
            .split_whitespace()
            .any(|w| w == "nan" || w == "inf" || w == "-inf");
        return match bad {
            true => Err("a value that is not finite".into()),
            false => Ok(()),
        };
    }
    let list: Value =
        serde_json::from_slice(stdout).map_err(|e| format!("the list is no JSON | {e}"))?;
    no_nulls("the list", &list)
}

fn batch(arguments: &[String], output: &Path, code: i32, stdout: &[u8]) -> Found<()> {
    let report = json(&output.join("report.json"))?;
    no_nulls("report.json", &report)?;
    let lines = lines_of(output)?;
    each(output, &lines)?;
    let failed = lines.iter().filter(|l| l["status"] != "ok").count();
    if (code == 5) != (failed > 0) {
        return Err(format!(
            "code {code} is not what results say | {failed} failed"
        ));
    }
    if arguments.iter().any(|a| a == "-") {
        let text = String::from_utf8_lossy(stdout);
        // With --json the report follows the answers.
        for line in text.lines().take_while(|line| *line != "{") {
            serde_json::from_str::<Value>(line)
                .map_err(|e| format!("an answer is no JSON | {e}"))?;
        }
    }
    Ok(())
}

fn lines_of(output: &Path) -> Found<Vec<Value>> {
    let path = output.join("results.jsonl");
    let text = fs::read_to_string(path).map_err(|e| format!("results.jsonl | {e}"))?;
    let lines = text.lines();
    let parsed = lines.map(|line| {
        serde_json::from_str(line).map_err(|e| format!("a result is no JSON | {line} {e}"))
    });
    parsed.collect()
}

/// Each job's line and files.
fn each(output: &Path, lines: &[Value]) -> Found<()> {
    for line in lines {
        no_nulls("a result", line)?;
        if line["status"] == "ok" {
            let files = line["files"].as_object().into_iter().flatten();
            for (_, path) in files {
                let path = path.as_str().ok_or("a path that is no string")?;
                file(&output.join(path))?;
            }
            continue;
        }
        let code = line["code"].as_i64().unwrap_or(-1);
        if !(1..=4).contains(&code) {
            return Err(format!("a job failed with code {code}"));
        }
        let message = line["message"].as_str().unwrap_or_default();
        if message.trim().is_empty() {
            return Err("a job failed without a message".into());
        }
    }
    Ok(())
}

fn json(path: &Path) -> Found<Value> {
    let name = name(path);
    let text = fs::read(path).map_err(|e| format!("{name} is not there | {e}"))?;
    serde_json::from_slice(&text).map_err(|e| format!("{name} is no JSON | {e}"))
}

fn name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// JSON has no NaN: writers put null for it.
fn no_nulls(whose: &str, value: &Value) -> Found<()> {
    match value {
        Value::Object(map) => map.iter().try_for_each(|(key, value)| match value {
            Value::Null if NULLABLE.contains(&key.as_str()) => Ok(()),
            Value::Null => Err(format!("null in {whose} for {key}")),
            value => no_nulls(whose, value),
        }),
        Value::Array(list) => list.iter().try_for_each(|value| match value {
            Value::Null => Err(format!("null in a list in {whose}")),
            value => no_nulls(whose, value),
        }),
        _ => Ok(()),
    }
}

/// Reads a file of results and looks at its numbers.
fn file(path: &Path) -> Found<()> {
    let name = name(path);
    let bytes = fs::read(path).map_err(|e| format!("{name} is not there | {e}"))?;
    let unreadable = |e: String| format!("{name} cannot be read | {e}");
    match name.rsplit('.').next().unwrap_or_default() {
        "exr" => {
            let image = PictureFile::open(path).and_then(PictureFile::read);
            let image = image.map_err(|e| unreadable(e.to_string()))?;
            finite(&name, image.pixels.as_flattened())
        }
        "npy" => finite(&name, &npy::decode(&bytes).map_err(unreadable)?.values),
        "safetensors" => {
            let all = SafeTensors::deserialize(&bytes).map_err(|e| unreadable(e.to_string()))?;
            all.tensors().iter().try_for_each(|(key, tensor)| {
                let words = tensor.data().as_chunks::<4>().0.iter();
                let numbers: Vec<f32> = words.map(|w| f32::from_le_bytes(*w)).collect();
                finite(&name, &numbers).map_err(|e| format!("{e} of {key}"))
            })
        }
        "npz" => archive(&name, &bytes),
        "png" => {
            let decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
            let mut reader = decoder.read_info().map_err(|e| unreadable(e.to_string()))?;
            let size = reader.output_buffer_size();
            let mut buffer = vec![0; size.ok_or_else(|| unreadable("its size".into()))?];
            let frame = reader.next_frame(&mut buffer);
            frame.map(drop).map_err(|e| unreadable(e.to_string()))
        }
        "json" => no_nulls(&name, &json(path)?),
        _ => Err(format!("a file of an unknown kind | {name}")),
    }
}

fn archive(name: &str, bytes: &[u8]) -> Found<()> {
    let unreadable = |e: String| format!("{name} cannot be read | {e}");
    let mut archive =
        zip::ZipArchive::new(std::io::Cursor::new(bytes)).map_err(|e| unreadable(e.to_string()))?;
    for i in 0..archive.len() {
        let mut entry = archive.by_index(i).map_err(|e| unreadable(e.to_string()))?;
        let mut array = Vec::new();
        entry
            .read_to_end(&mut array)
            .map_err(|e| unreadable(e.to_string()))?;
        finite(name, &npy::decode(&array).map_err(unreadable)?.values)?;
    }
    Ok(())
}

fn finite(name: &str, numbers: &[f32]) -> Found<()> {
    match numbers.iter().position(|x| !x.is_finite()) {
        None => Ok(()),
        Some(at) => Err(format!(
            "{name} is not finite | number {at} is {}",
            numbers[at]
        )),
    }
}
