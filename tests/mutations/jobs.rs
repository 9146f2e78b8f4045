//! Lines of batches, and mutations of them.

use super::arguments::{key, misspelt, row};
use super::extremes;
use super::pictures::ArrayFile;
use super::random::Random;
use serde_json::{Value, json};
use std::collections::BTreeMap;
use warpath::scene::parameters::{Parameter, Target};

/// What jobs of a scene are drawn from.
pub struct Surroundings<'a> {
    pub parameters: &'a [Parameter],
    /// Of the image.
    pub size: [usize; 2],
    /// Whether `reparam` refuses what moves.
    pub is_sharp: bool,
    pub arrays: &'a mut BTreeMap<String, ArrayFile>,
}

impl Surroundings<'_> {
    /// A job that is right.
    pub fn job(&mut self, number: usize, random: &mut Random) -> Value {
        let method = *random.pick(&["reparam", "reparam", "interior"]);
        let refuses_motion = self.is_sharp && method == "reparam";
        let parameter = key(self.parameters, refuses_motion, random);
        let mut job = match random.below(3) {
            0 => json!({"mode": "render"}),
            1 => {
                json!({"mode": "forward", "params": {&parameter.key: self.tangent(parameter, number, random)}})
            }
            _ => {
                let target = ["target", "adjoint"][random.below(2)];
                json!({"mode": "backward", "params": [&parameter.key], target: self.image(random)})
            }
        };
        job["id"] = json!(format!("j{number}"));
        job["scene"] = json!("s.xml");
        job["spp"] = json!(*random.pick(&[1, 2, 4, 4]));
        job["max_depth"] = json!(1 + random.below(4));
        job["seed"] = json!(random.below(100));
        if job["mode"] != "render" {
            job["method"] = json!(method);
        }
        if random.chance(40) {
            let parameter = key(self.parameters, false, random);
            job["set"] = json!({&parameter.key: self.value(parameter, number, random)});
        }
        job
    }

    fn tangent(&mut self, parameter: &Parameter, number: usize, random: &mut Random) -> Value {
        match random.chance(15) {
            true => self.file(parameter, number, random),
            false => json!(row(parameter, random)),
        }
    }

    fn value(&mut self, parameter: &Parameter, number: usize, random: &mut Random) -> Value {
        let count: usize = parameter.shape.iter().product();
        if count > 100 || random.chance(15) {
            return self.file(parameter, number, random);
        }
        let is_angle = matches!(parameter.target, Some(Target::SensorXFov(_)));
        let [low, high] = if is_angle { [30.0, 60.0] } else { [0.1, 0.9] };
        let numbers: Vec<f64> = (0..count).map(|_| random.number(low, high)).collect();
        nested(&numbers, &parameter.shape)
    }

    fn file(&mut self, parameter: &Parameter, number: usize, random: &mut Random) -> Value {
        let (name, tensor) = match random.chance(50) {
            true => (format!("v{number}.npy"), None),
            false => (
                format!("v{number}.safetensors"),
                Some(parameter.key.as_str()),
            ),
        };
        let array = ArrayFile::draw(tensor, &parameter.shape, random);
        self.arrays.insert(name.clone(), array);
        json!(name)
    }

    fn image(&mut self, random: &mut Random) -> Value {
        let [width, height] = self.size;
        let array = ArrayFile::draw(None, &[height, width, 3], random);
        self.arrays.insert("image.npy".into(), array);
        json!("image.npy")
    }
}

/// Lists of lists of a shape.
fn nested(numbers: &[f64], shape: &[usize]) -> Value {
    match shape {
        [] | [_] => json!(numbers),
        [_, rest @ ..] => {
            let length = rest.iter().product();
            let rows = numbers.chunks(length);
            rows.map(|row| nested(row, rest)).collect()
        }
    }
}

/// A value of any type.
fn odd(random: &mut Random) -> Value {
    match random.below(12) {
        0 => Value::Null,
        1 => json!(true),
        2 => json!([]),
        3 => json!({}),
        4 => json!([[1, 2, 3]]),
        5 => json!(-1),
        6 => json!(1.5),
        7 => json!(u64::MAX),
        8 => json!(0),
        _ => json!(extremes::word(random)),
    }
}

/// Changes a field of one of the jobs and says how.
pub fn mutate(jobs: &mut [Value], parameters: &[Parameter], random: &mut Random) -> String {
    let n = random.below(jobs.len());
    let other = jobs[random.below(jobs.len())].clone();
    let Some(job) = jobs[n].as_object_mut() else {
        return "nothing".into();
    };
    let field = {
        let names: Vec<&String> = job.keys().collect();
        match names.is_empty() {
            true => "id".to_string(),
            false => random.pick(&names).to_string(),
        }
    };
    match random.below(10) {
        0 => {
            let value = odd(random);
            let what = format!("{field} of job {n} is {value}");
            job.insert(field, value);
            what
        }
        1 => {
            job.remove(&field);
            format!("job {n} loses {field}")
        }
        2 => {
            let names = [
                "tagret",
                "stderr",
                "groups",
                "outputs",
                "resolution",
                "sensor",
                "loss",
                "defines",
            ];
            let name = *random.pick(&names);
            let value = odd(random);
            let what = format!("{name} of job {n} is {value}");
            job.insert(name.into(), value);
            what
        }
        3 => {
            let right = [
                json!({"stderr": false}),
                json!({"groups": 2}),
                json!({"groups": 1}),
                json!({"outputs": ["image.exr"]}),
                json!({"outputs": ["image.npy"]}),
                json!({"outputs": []}),
                json!({"resolution": [3, 2]}),
                json!({"resolution": "1x1"}),
                json!({"sensor": 1}),
                json!({"loss": "l1"}),
                json!({"defines": {"bright": 1e30}}),
                json!({"defines": {"far": "nan"}}),
                json!({"method": "fd"}),
            ];
            let more = random.pick(&right).clone();
            let what = format!("job {n} gets {more}");
            job.extend(more.as_object().cloned().unwrap_or_default());
            what
        }
        4 => {
            let value = other.get(&field).cloned().unwrap_or(Value::Null);
            let what = format!("{field} of job {n} is another's, {value}");
            job.insert(field, value);
            what
        }
        _ => numbers(job, n, parameters, random),
    }
}

/// Numbers of `set` or of tangents become extreme ones, or their keys others.
fn numbers(
    job: &mut serde_json::Map<String, Value>,
    n: usize,
    parameters: &[Parameter],
    random: &mut Random,
) -> String {
    let field = *random.pick(&["set", "params"]);
    if !job.get(field).is_some_and(Value::is_object) {
        let parameter = key(parameters, false, random);
        job.insert(
            "set".into(),
            json!({&parameter.key: extremes::finite(random)}),
        );
        return format!("job {n} sets {}", job["set"]);
    }
    let map = job[field].as_object_mut().expect("an object");
    let Some(key) = map.keys().next().cloned() else {
        return "nothing".into();
    };
    if random.chance(20) {
        let value = map.remove(&key).unwrap_or_default();
        let new = misspelt(&key, parameters, random);
        let what = format!("{field} of job {n} has {new:?} for {key}");
        map.insert(new, value);
        return what;
    }
    let extreme = match random.chance(80) {
        true => json!(extremes::finite(random)),
        false => odd(random),
    };
    let value = map.get_mut(&key).expect("the first key");
    let mut leaves = Vec::new();
    collect(value, &mut leaves);
    let whole = random.chance(40);
    let at = random.below(leaves.len().max(1));
    for (i, leaf) in leaves.into_iter().enumerate() {
        if whole || i == at {
            *leaf = extreme.clone();
        }
    }
    format!("{key} in {field} of job {n} is or has {extreme}")
}

fn collect<'a>(value: &'a mut Value, leaves: &mut Vec<&'a mut Value>) {
    match value {
        Value::Array(list) => list.iter_mut().for_each(|v| collect(v, leaves)),
        leaf => leaves.push(leaf),
    }
}
