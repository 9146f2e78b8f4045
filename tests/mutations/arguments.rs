//! Command lines, and mutations of them.

use super::extremes;
use super::random::Random;
use warpath::scene::parameters::Parameter;

/// Values that options are given beside what is right.
const OPTIONS: [(&str, &[&str]); 15] = [
    (
        "--spp",
        &["0", "-1", "1", "3", "1048577", "4294967296", "x", ""],
    ),
    (
        "--seed",
        &["18446744073709551615", "18446744073709551616", "-1", "0"],
    ),
    ("--threads", &["0", "1", "3", "64", "4097", "x"]),
    (
        "--max-depth",
        &["0", "1", "-1", "-2", "4294967295", "9223372036854775808"],
    ),
    (
        "--resolution",
        &[
            "0x0",
            "1x1",
            "1x40",
            "65537x1",
            "65536x65536",
            "x",
            "4",
            "300x1",
            "1x3",
        ],
    ),
    (
        "--backend",
        &[
            "embree",
            "embree:low",
            "embree:high",
            "obvhs:fastest",
            "obvhs-bvh2:very-slow",
            "obvhs",
            "",
            "x",
        ],
    ),
    ("--sensor", &["0", "1", "2", "99999999999999999999"]),
    (
        "-D",
        &[
            "far=1e30",
            "bright=nan",
            "bright=",
            "far=0",
            "nothing=1",
            "bright=3.4e38",
            "far",
            "bright=1e6",
        ],
    ),
    ("--method", &["fd", "interior", "reparam", "auto", "x"]),
    ("--tolerance", &["0", "nan", "1", "-1", "1e-300", "0.999"]),
    ("--loss", &["l1", "l2", "x"]),
    (
        "--memory",
        &["1M", "40M", "64M", "0", "nan", "1e30G", "101%", "100%"],
    ),
    (
        "--shard",
        &["1/1", "0/2", "3/2", "2/2", "1/4294967295", "x"],
    ),
    ("--split", &["jobs", "samples"]),
    ("--log-format", &["json", "text", "x"]),
];

const FLAGS: [&str; 6] = [
    "--json",
    "--quiet",
    "--no-stderr",
    "--resume",
    "--nonsense",
    "--help",
];

/// Options that every command that traces takes.
pub fn common(random: &mut Random) -> Vec<String> {
    let mut out = Vec::new();
    let mut push = |option: &str, value: String| out.extend([option.to_string(), value]);
    push("--threads", random.pick(&["1", "2"]).to_string());
    if random.chance(80) {
        push("--spp", random.pick(&["1", "2", "4", "4", "6"]).to_string());
    }
    if random.chance(50) {
        push("--max-depth", (1 + random.below(5)).to_string());
    }
    if random.chance(30) {
        push("--seed", random.below(1000).to_string());
    }
    let backends = [
        "embree",
        "obvhs",
        "obvhs-bvh2",
        "embree:low",
        "embree:high",
        "obvhs:slow",
    ];
    if random.chance(60) {
        push("--backend", random.pick(&backends).to_string());
    }
    talk(&mut out, random);
    out
}

/// How a command talks.
pub fn talk(out: &mut Vec<String>, random: &mut Random) {
    for (flag, percent) in [("--json", 15), ("--quiet", 15), ("--log-format=json", 15)] {
        if random.chance(percent) {
            out.push(flag.into());
        }
    }
}

/// A key to differentiate by; one that moves nothing, if there is one, where motion would be
/// refused.
pub fn key<'a>(
    parameters: &'a [Parameter],
    refuses_motion: bool,
    random: &mut Random,
) -> &'a Parameter {
    let all: Vec<_> = parameters.iter().filter(|p| p.differentiable).collect();
    let still: Vec<_> = all
        .iter()
        .copied()
        .filter(|p| !p.moves_visibility)
        .collect();
    let fitting = match refuses_motion && !still.is_empty() && random.chance(90) {
        true => still,
        false => all,
    };
    match fitting.is_empty() {
        true => random.pick(parameters),
        false => fitting[random.below(fitting.len())],
    }
}

/// A tangent of one row.
pub fn row(parameter: &Parameter, random: &mut Random) -> Vec<f64> {
    let length = parameter.shape.last().copied().unwrap_or(1);
    (0..length).map(|_| random.number(-1.0, 1.0)).collect()
}

/// Changes an option, a key or a tangent, and says how.
pub fn mutate(
    arguments: &mut Vec<String>,
    parameters: &[Parameter],
    random: &mut Random,
) -> String {
    let params: Vec<usize> = (1..arguments.len())
        .filter(|i| arguments[i - 1] == "--param")
        .collect();
    if !params.is_empty() && random.chance(60) {
        let argument = &mut arguments[*random.pick(&params)];
        let changed = parameter(argument, parameters, random);
        *argument = changed;
        return format!("--param {argument}");
    }
    if random.chance(15) {
        let flag = *random.pick(&FLAGS);
        arguments.push(flag.into());
        return flag.into();
    }
    if random.chance(8) {
        let at = 1 + random.below(arguments.len() - 1);
        let gone = arguments.remove(at);
        return format!("without {gone}");
    }
    let (option, values) = random.pick(&OPTIONS);
    let value = random.pick(values).to_string();
    let what = format!("{option} {value:?}");
    match arguments.iter().position(|a| a == option) {
        Some(at) if at + 1 < arguments.len() => arguments[at + 1] = value,
        _ => arguments.extend([option.to_string(), value]),
    }
    what
}

/// Another key, a misspelt one, or extreme numbers.
fn parameter(argument: &str, parameters: &[Parameter], random: &mut Random) -> String {
    let (key, tangent) = match argument.split_once('=') {
        Some((key, tangent)) => (key, Some(tangent)),
        None => (argument, None),
    };
    match (random.below(6), tangent) {
        (0, Some(tangent)) => format!("{}={tangent}", misspelt(key, parameters, random)),
        (0, None) => misspelt(key, parameters, random),
        (1, Some(_)) => format!(
            "{key}={}",
            random.pick(&["", "@", "@nothing.npy", "@s.xml", ",", "1;2"])
        ),
        (_, Some(tangent)) => {
            let parts: Vec<&str> = tangent.split(',').collect();
            let at = random.below(parts.len());
            let number = extremes::number(random);
            let whole = random.chance(50);
            let parts = parts.iter().enumerate();
            let parts: Vec<&str> = parts
                .map(|(i, part)| if whole || i == at { &number } else { *part })
                .collect();
            format!("{key}={}", parts.join(","))
        }
        (_, None) => random.pick(parameters).key.clone(),
    }
}

pub fn misspelt(key: &str, parameters: &[Parameter], random: &mut Random) -> String {
    match random.below(4) {
        0 => random.pick(parameters).key.clone(),
        1 => {
            let all = random.pick(parameters);
            all.aliases.first().unwrap_or(&all.key).clone()
        }
        2 => key.chars().rev().collect(),
        _ => extremes::word(random).into(),
    }
}
