//! How the values of options are written. Each function says what is wrong and what would be right.

use crate::batch::queue::scheduler::ShardChoice;
use crate::jobs::numbers::Numbers;
use crate::jobs::resolution;
use crate::methods::ESTIMATORS;
use clap::builder::{PossibleValue, PossibleValuesParser};

/// A parameter's key with its tangent.
pub type Tangent = (String, Numbers);

/// `KEY=1,0,0.3` or `KEY=@file.npy`.
pub fn tangent(text: &str) -> Result<Tangent, String> {
    let (key, value) = text
        .split_once('=')
        .ok_or_else(|| format!("no tangent is given: write {text}=1,0,0 or {text}=@tangent.npy"))?;
    let key = non_empty_key(key)?;
    let value = match value.strip_prefix('@') {
        Some("") => return Err("no file is named after '@'".into()),
        Some(file) => Numbers::File(file.into()),
        None => Numbers::list(value.split(',').map(finite).collect::<Result<_, _>>()?),
    };
    Ok((key, value))
}

/// A key alone: backward takes no direction.
pub fn bare_key(text: &str) -> Result<String, String> {
    match text.split_once('=') {
        None => non_empty_key(text),
        Some((key, _)) => Err(format!("backward takes no tangent: write --param {key}")),
    }
}

fn non_empty_key(key: &str) -> Result<String, String> {
    match key.trim() {
        "" => Err("the parameter's key is missing; `warpath params SCENE` lists the keys".into()),
        key => Ok(key.into()),
    }
}

fn finite(text: &str) -> Result<f32, String> {
    match text.trim().parse::<f32>() {
        Ok(number) if number.is_finite() => Ok(number),
        Ok(_) => Err(format!("'{text}' is not a finite number")),
        Err(_) if text.trim().is_empty() => Err("a number of the tangent is missing".into()),
        Err(_) => Err(format!("'{text}' is not a number")),
    }
}

/// `NAME=VALUE`.
pub fn definition(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some(("", _)) => Err("the name is missing: write -D name=value".into()),
        Some((name, value)) => Ok((name.into(), value.into())),
        None => Err(format!("the value is missing: write -D {text}=value")),
    }
}

/// `WxH`.
pub fn resolution(text: &str) -> Result<[u32; 2], String> {
    resolution::resolution(text)
}

/// A number of segments, or -1.
pub fn depth(text: &str) -> Result<u32, String> {
    match text.parse::<i64>() {
        Ok(-1) => Ok(u32::MAX),
        Ok(0) => {
            Err("a path of no segments is black; 1 shows emitters alone, 2 direct light".into())
        }
        Ok(n) if n > 0 => u32::try_from(n).map_err(|_| "too deep; -1 means no limit".into()),
        _ => Err("write a whole number from 1, or -1 for no limit".into()),
    }
}

/// The name of a method.
pub fn method() -> PossibleValuesParser {
    let built = ESTIMATORS.iter();
    let built = built.map(|e| PossibleValue::new(e.name).help(e.about));
    PossibleValuesParser::new(built)
}

/// A number of threads.
pub fn threads(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(n) if (1..=4096).contains(&n) => Ok(n),
        _ => Err("write a whole number from 1 to 4096".into()),
    }
}

/// A time.
pub fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if x > 0.0 && x <= 3600.0 => Ok(x),
        _ => Err("write a number of seconds, as in 0.25".into()),
    }
}

/// `I/N`, `auto` or `auto/N`.
pub fn shard(text: &str) -> Result<ShardChoice, String> {
    text.parse()
}

/// Bytes: `8G`, `500M`, or a part of the machine's, `50%`.
pub fn memory(text: &str) -> Result<Memory, String> {
    let wrong = || {
        "write an amount as in 8G or 500M, or a part of the machine's memory as in 50%".to_string()
    };
    let split = text
        .find(|c: char| !c.is_ascii_digit() && c != '.')
        .unwrap_or(text.len());
    let number: f64 = text[..split].parse().map_err(|_| wrong())?;
    let bytes = |exponent: i32| match number * 1024f64.powi(exponent) {
        bytes if bytes >= 1024f64.powi(2) && bytes < 1e18 => Ok(Memory::Bytes(bytes as u64)),
        _ => Err("at least 1M is needed".to_string()),
    };
    match text[split..]
        .trim()
        .trim_end_matches(['b', 'B'])
        .trim_end_matches('i')
    {
        "%" if number > 0.0 && number <= 100.0 => Ok(Memory::Share(number / 100.0)),
        "" => bytes(0),
        "k" | "K" => bytes(1),
        "m" | "M" => bytes(2),
        "g" | "G" => bytes(3),
        "t" | "T" => bytes(4),
        _ => Err(wrong()),
    }
}

/// How much memory may be taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Memory {
    Bytes(u64),
    /// Of the machine's.
    Share(f64),
}

/// A share of a whole.
pub fn share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(x) if (0.0..1.0).contains(&x) => Ok(x),
        _ => Err("write a number from 0 up to 1, as in 0.03".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tangents_are_numbers_or_files() {
        let numbers = |text| tangent(text).map(|t| t.1);
        assert_eq!(
            numbers("a.b=1, -2e1,0.5"),
            Ok(Numbers::list(vec![1.0, -20.0, 0.5]))
        );
        assert_eq!(numbers("a.b=@c=d.npy"), Ok(Numbers::File("c=d.npy".into())));
        for wrong in [
            "a.b", "=1", "a=", "a=1,,2", "a=nan", "a=1,inf", "a=1e99", "a=@", "a=x",
        ] {
            assert!(tangent(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_and_depths_have_their_limits() {
        assert_eq!(resolution("640x480"), Ok([640, 480]));
        for wrong in [
            "640", "0x4", "4x", "x4", "-1x4", "4x4x4", "70000x1", "4.5x4",
        ] {
            assert!(resolution(wrong).is_err(), "{wrong}");
        }
        assert_eq!(memory("8G"), Ok(Memory::Bytes(8 << 30)));
        assert_eq!(memory("1.5GiB"), Ok(Memory::Bytes(3 << 29)));
        assert_eq!(memory("25%"), Ok(Memory::Share(0.25)));
        for wrong in ["", "G", "0", "-1G", "101%", "8X", "nan", "1e99G"] {
            assert!(memory(wrong).is_err(), "{wrong}");
        }
        assert_eq!(depth("-1"), Ok(u32::MAX));
        for wrong in ["0", "-2", "x", "99999999999"] {
            assert!(depth(wrong).is_err(), "{wrong}");
        }
    }
}
