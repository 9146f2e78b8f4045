//! Numbers that programs stumble over, as they are written in files.

use super::random::Random;

const NUMBERS: [&str; 46] = [
    "0",
    "-0",
    "1",
    "-1",
    "0.5",
    "2",
    "1e-3",
    "1e-6",
    "1e-10",
    "1e-20",
    "1.2e-38",
    "1e-38",
    "1e-45",
    "1e-46",
    "1e-300",
    "-1e-20",
    "0.99999994",
    "1.0000001",
    "10",
    "100",
    "1e3",
    "65504",
    "1e6",
    "1e9",
    "1e12",
    "1e17",
    "1.8e18",
    "1.9e18",
    "1e19",
    "1e20",
    "1e25",
    "1e30",
    "1e37",
    "3.4e38",
    "-3.4e38",
    "-1e6",
    "-1e17",
    "1e39",
    "1e400",
    "nan",
    "inf",
    "-inf",
    "",
    "abc",
    "4294967296",
    "16777217",
];

/// For what may be from 0 to 1, as most colours and roughnesses are.
const SHARES: [&str; 14] = [
    "0",
    "-0",
    "1",
    "0.5",
    "1e-3",
    "1e-6",
    "1e-10",
    "1e-20",
    "1.2e-38",
    "1e-45",
    "1e-46",
    "0.99999994",
    "0.999",
    "1.0000001",
];

/// Whole numbers for what costs time or memory: small, or beyond all limits.
const COUNTS: [&str; 18] = [
    "0",
    "-0",
    "1",
    "2",
    "3",
    "5",
    "7",
    "-1",
    "-2",
    "1048577",
    "2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "99999999999999999999",
    "1.5",
    "nan",
    "",
];

/// Strings that are not what was expected.
const WORDS: [&str; 12] = [
    "",
    " ",
    "none",
    "$nothing",
    "a\u{7}b\u{1b}[31m",
    "../../../etc/passwd",
    ".",
    "/",
    "é漢\u{200f}",
    "true",
    "0x10",
    "xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx",
];

pub fn number(random: &mut Random) -> String {
    match random.chance(60) {
        true => random.word(&NUMBERS).into(),
        false => of_any_size(random),
    }
}

/// Between the least and the largest of single precision, evenly over powers of ten.
fn of_any_size(random: &mut Random) -> String {
    let sign = if random.chance(15) { "-" } else { "" };
    let digits = 1 + random.below(9);
    let power = random.below(84) as i32 - 45;
    format!("{sign}{digits}e{power}")
}

pub fn share(random: &mut Random) -> String {
    match random.chance(60) {
        true => random.word(&SHARES).into(),
        false => format!("{}", random.number(0.0, 1.0)),
    }
}

pub fn count(random: &mut Random) -> String {
    random.word(&COUNTS).into()
}

pub fn word(random: &mut Random) -> &'static str {
    random.word(&WORDS)
}

/// A number that single precision can hold, infinities and NaN among them.
pub fn float(random: &mut Random) -> f64 {
    loop {
        if let Ok(number) = number(random).parse() {
            return number;
        }
    }
}

/// A finite one.
pub fn finite(random: &mut Random) -> f64 {
    loop {
        let number = float(random);
        if (number as f32).is_finite() {
            return number;
        }
    }
}
