//! One case: files, and the commands that are run on them.

use super::arguments::{self, common, key, row, talk};
use super::bytes;
use super::jobs::{self, Surroundings};
use super::pictures::{ArrayFile, PictureFile};
use super::random::Random;
use super::scenes::SceneFiles;
use super::xml;
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use warpath::scene::load_from;
use warpath::scene::parameters::{Parameter, list};
use warpath::scene::source::Memory;

/// What is done after each other in the folder of a case.
#[derive(Clone)]
pub enum Step {
    Run {
        arguments: Vec<String>,
        input: Option<Vec<u8>>,
    },
    /// A file of those that the steps before have written is damaged, drawn with this.
    Damage(Random),
}

pub struct Case {
    pub files: BTreeMap<String, Vec<u8>>,
    pub steps: Vec<Step>,
    /// What was changed, by the number of the mutation.
    pub mutations: BTreeMap<usize, String>,
    /// How many executions it counts for.
    pub executions: usize,
    /// Whether what succeeds is run again with other threads.
    pub runs_again: bool,
}

/// What is mutated before it is written.
struct Draft {
    scene: SceneFiles,
    parameters: Vec<Parameter>,
    arrays: BTreeMap<String, ArrayFile>,
    jobs: Vec<Value>,
    /// Of each command; that of a batch with `JOBS` for its jobs.
    runs: Vec<Vec<String>>,
    /// Draws for bytes of files, after all else.
    damage: Vec<(usize, Random)>,
    /// And for what is written between the last run but one and the last.
    damage_between: Vec<(usize, Random)>,
}

/// Few mutations find most, and what they find is understood.
const MUTATIONS: [usize; 12] = [0, 1, 1, 1, 1, 1, 2, 2, 2, 3, 4, 7];

impl Case {
    /// Case `index` of a campaign, without the mutations that are `dropped`.
    pub fn draw(seed: u64, index: u64, dropped: &BTreeSet<usize>) -> Self {
        let mut random = Random::of(&[seed, index, 0]);
        let mut draft = Draft::draw(&mut random);
        let mut mutations = BTreeMap::new();
        for n in 1..=*random.pick(&MUTATIONS) {
            if !dropped.contains(&n) {
                let mut random = Random::of(&[seed, index, n as u64]);
                mutations.insert(n, draft.mutate(n, &mut random));
            }
        }
        let mut case = draft.finish(mutations);
        case.runs_again = Random::of(&[seed, index, u64::MAX]).chance(10);
        case
    }
}

impl Draft {
    fn draw(random: &mut Random) -> Self {
        let scene = SceneFiles::draw(random);
        let files = scene.files().into_iter();
        let files = files.fold(Memory::new(), |all, (name, bytes)| all.with(name, bytes));
        let loaded = load_from(&files, "s.xml", &[]);
        let loaded = loaded.unwrap_or_else(|e| panic!("case {e}"));
        let mut draft = Self {
            parameters: list(&loaded),
            scene,
            arrays: BTreeMap::new(),
            jobs: Vec::new(),
            runs: Vec::new(),
            damage: Vec::new(),
            damage_between: Vec::new(),
        };
        match random.below(40) {
            0..9 => draft.alone("render", random),
            9..20 => draft.alone("forward", random),
            20..31 => draft.alone("backward", random),
            31 | 32 => draft.alone("check", random),
            33..36 => draft.alone("params", random),
            36 => draft.batch(&["batch - -o out"], random),
            37 => draft.batch(&["batch jobs.jsonl -o out"], random),
            38 => draft.batch(
                &[
                    "batch jobs.jsonl -o out",
                    "batch jobs.jsonl -o out --resume",
                ],
                random,
            ),
            _ => {
                let split = random.pick(&["jobs", "samples"]);
                let shard =
                    |i| format!("batch jobs.jsonl --shard {i}/2 --split {split} -o out/{i}");
                draft.batch(
                    &[&shard(1), &shard(2), "merge out/1 out/2 -o merged"],
                    random,
                );
            }
        }
        draft
    }

    /// One command on the scene.
    fn alone(&mut self, command: &str, random: &mut Random) {
        let mut line = vec![command.to_string(), "s.xml".into()];
        if command == "params" {
            talk(&mut line, random);
            return self.runs.push(line);
        }
        line.extend(common(random));
        line.extend(["-o".into(), "out".into()]);
        let methods: &[&str] = match command {
            "forward" => &["reparam", "reparam", "interior", "fd"],
            _ => &["reparam", "reparam", "interior"],
        };
        let method = *random.pick(methods);
        let refuses_motion = method == "reparam" && self.scene.is_sharp();
        if command != "render" {
            line.extend(["--method".into(), method.into()]);
            let most = if command == "backward" { 6 } else { 2 };
            for n in 0..1 + random.below(most) {
                let parameter = key(&self.parameters, refuses_motion, random).clone();
                // Those of other sensors are refused.
                let other = parameter.key.starts_with("second.");
                if other
                    || line
                        .iter()
                        .any(|a| a.split('=').next() == Some(parameter.key.as_str()))
                {
                    continue;
                }
                let tangent = self.tangent(&parameter, n, random);
                line.push("--param".into());
                line.push(match command {
                    "backward" => parameter.key,
                    _ => format!("{}={tangent}", parameter.key),
                });
            }
        }
        if command == "backward" {
            let objective = *random.pick(&["--target", "--target", "--adjoint"]);
            let file = self.image(random);
            line.extend([objective.into(), file]);
            if objective == "--target" && random.chance(40) {
                line.extend(["--loss".into(), "l1".into()]);
            }
        }
        if matches!(command, "forward" | "backward") && random.chance(20) {
            line.push("--no-stderr".into());
        }
        self.runs.push(line);
    }

    fn tangent(&mut self, parameter: &Parameter, n: usize, random: &mut Random) -> String {
        if random.chance(15) {
            let name = format!("tangent{n}.npy");
            let array = ArrayFile::draw(None, &parameter.shape, random);
            self.arrays.insert(name.clone(), array);
            return format!("@{name}");
        }
        let numbers = row(parameter, random);
        let numbers: Vec<String> = numbers.iter().map(|x| format!("{x:.3}")).collect();
        numbers.join(",")
    }

    /// A picture or an array of the image's size.
    fn image(&mut self, random: &mut Random) -> String {
        let [width, height] = self.scene.size;
        let name = *random.pick(&[
            "image.npy",
            "image.exr",
            "image.png",
            "image.pfm",
            "image.hdr",
        ]);
        if name == "image.npy" {
            let array = ArrayFile::draw(None, &[height, width, 3], random);
            self.arrays.insert(name.into(), array);
        } else {
            let picture = PictureFile::of_size(name, self.scene.size, random);
            self.scene.pictures.insert(name.into(), picture);
        }
        name.into()
    }

    fn batch(&mut self, lines: &[&str], random: &mut Random) {
        let count = 2 + random.below(9);
        // Those of other sensors than the first are refused.
        let of_first = |p: &&Parameter| !p.key.starts_with("second.");
        let parameters: Vec<Parameter> = self.parameters.iter().filter(of_first).cloned().collect();
        let mut surroundings = Surroundings {
            parameters: &parameters,
            size: self.scene.size,
            is_sharp: self.scene.is_sharp(),
            arrays: &mut self.arrays,
        };
        let mut jobs: Vec<Value> = (0..count).map(|n| surroundings.job(n, random)).collect();
        self.jobs.append(&mut jobs);
        let mut options = vec![
            "--threads".to_string(),
            random.pick(&["1", "2"]).to_string(),
        ];
        if random.chance(30) {
            options.extend([
                "--memory".into(),
                random.pick(&["64M", "200M", "90%"]).to_string(),
            ]);
        }
        if random.chance(50) {
            options.extend([
                "--backend".into(),
                random.pick(&["embree", "obvhs"]).to_string(),
            ]);
        }
        let mut talking = Vec::new();
        talk(&mut talking, random);
        for line in lines {
            let mut run: Vec<String> = line.split_whitespace().map(str::to_string).collect();
            if run[0] == "batch" {
                run.extend(options.iter().cloned());
            }
            run.extend(talking.iter().cloned());
            self.runs.push(run);
        }
    }

    /// Applies mutation `n` and says what it is.
    fn mutate(&mut self, n: usize, random: &mut Random) -> String {
        let target = random.below(20);
        if self.jobs.len() > 1 && target >= 8 {
            match target {
                8..14 => return jobs::mutate(&mut self.jobs, &self.parameters, random),
                14..17 if self.runs.len() > 1 => {
                    self.damage_between.push((n, random.clone()));
                    return "a file between the runs".into();
                }
                _ => {}
            }
        }
        match target {
            0..3 if !self.scene.meshes.is_empty() => {
                let names: Vec<String> = self.scene.meshes.keys().cloned().collect();
                let name = random.pick(&names);
                let mesh = self.scene.meshes.get_mut(name).expect("a mesh");
                format!("{name}: {}", mesh.mutate(random))
            }
            3 | 4 if !self.scene.pictures.is_empty() => {
                let names: Vec<String> = self.scene.pictures.keys().cloned().collect();
                let name = random.pick(&names);
                let picture = self.scene.pictures.get_mut(name).expect("a picture");
                format!("{name}: {}", picture.mutate(random))
            }
            5 | 6 if !self.arrays.is_empty() => {
                let names: Vec<String> = self.arrays.keys().cloned().collect();
                let name = random.pick(&names);
                let array = self.arrays.get_mut(name).expect("an array");
                format!("{name}: {}", array.mutate(random))
            }
            7 | 8 => {
                self.damage.push((n, random.clone()));
                "bytes of a file".into()
            }
            9..12 => {
                let run = random.below(self.runs.len());
                arguments::mutate(&mut self.runs[run], &self.parameters, random)
            }
            _ => format!("s.xml: {}", xml::mutate(&mut self.scene, random)),
        }
    }

    fn finish(self, mut mutations: BTreeMap<usize, String>) -> Case {
        let mut files = self.scene.files();
        for (name, array) in &self.arrays {
            files.insert(name.clone(), array.encode());
        }
        let lines: Vec<String> = self.jobs.iter().map(Value::to_string).collect();
        if !lines.is_empty() {
            files.insert("jobs.jsonl".into(), (lines.join("\n") + "\n").into_bytes());
        }
        for (n, mut random) in self.damage {
            let names: Vec<String> = files.keys().cloned().collect();
            let name = random.pick(&names);
            let bytes = files.get_mut(name).expect("a file");
            let what = bytes::damage(bytes, &mut random);
            mutations.insert(n, format!("{name}: {what}"));
        }
        let streams = self.runs.iter().any(|run| run.iter().any(|a| a == "-"));
        let input = streams.then(|| files.get("jobs.jsonl").cloned().unwrap_or_default());
        let mut steps = Vec::new();
        let last = self.runs.len() - 1;
        for (i, arguments) in self.runs.into_iter().enumerate() {
            if i > 0 && i == last {
                let between = self.damage_between.iter();
                steps.extend(between.map(|(_, random)| Step::Damage(random.clone())));
            }
            let input = input.clone();
            steps.push(Step::Run { arguments, input });
        }
        Case {
            executions: self.jobs.len().max(1),
            runs_again: false,
            files,
            steps,
            mutations,
        }
    }
}
