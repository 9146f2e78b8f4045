//! How the values of options are written. Each function says what is wrong and what would be right.

use std::path::PathBuf;

/// Largest width or height; past it a typing error is likelier than a wish.
const LARGEST_SIDE: u32 = 65_536;

/// A parameter key and the numbers of its tangent, not yet compared with any scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Tangent {
    pub key: String,
    pub value: TangentValue,
}

/// Where a tangent's numbers come from.
#[derive(Clone, Debug, PartialEq)]
pub enum TangentValue {
    Numbers(Vec<f32>),
    File(PathBuf),
}

/// `KEY=1,0,0.3` or `KEY=@file.npy`.
pub fn tangent(text: &str) -> Result<Tangent, String> {
    let (key, value) = text
        .split_once('=')
        .ok_or_else(|| format!("no tangent is given: write {text}=1,0,0 or {text}=@tangent.npy"))?;
    let key = non_empty_key(key)?;
    let value = match value.strip_prefix('@') {
        Some("") => return Err("no file is named after '@'".into()),
        Some(file) => TangentValue::File(file.into()),
        None => TangentValue::Numbers(value.split(',').map(finite).collect::<Result<_, _>>()?),
    };
    Ok(Tangent { key, value })
}

/// A key alone: reverse mode takes no direction.
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
    let wrong = || "write width x height, as in 640x480".to_string();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |text: &str| match text.parse::<u32>() {
        Ok(n) if (1..=LARGEST_SIDE).contains(&n) => Ok(n),
        Ok(_) => Err(format!("each side is from 1 to {LARGEST_SIDE} pixels")),
        Err(_) => Err(wrong()),
    };
    Ok([side(width)?, side(height)?])
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
        let numbers = |text| tangent(text).map(|t| t.value);
        assert_eq!(
            numbers("a.b=1, -2e1,0.5"),
            Ok(TangentValue::Numbers(vec![1.0, -20.0, 0.5]))
        );
        assert_eq!(
            numbers("a.b=@c=d.npy"),
            Ok(TangentValue::File("c=d.npy".into()))
        );
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
        assert_eq!(depth("-1"), Ok(u32::MAX));
        for wrong in ["0", "-2", "x", "99999999999"] {
            assert!(depth(wrong).is_err(), "{wrong}");
        }
    }
}
