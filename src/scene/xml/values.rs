//! Numbers, flags and colours as they are written in attributes. Errors are sentences.

use crate::scene::nearest::shown;
use crate::scene::spectrum::Spectrum;

/// Splits at commas and white space.
pub(super) fn tokens(text: &str) -> Vec<&str> {
    text.split(|c: char| c == ',' || c.is_whitespace())
        .filter(|t| !t.is_empty())
        .collect()
}

/// A number that a scene may hold: finite also in single precision.
pub(super) fn number(text: &str) -> Result<f64, String> {
    let value: f64 = text
        .trim()
        .parse()
        .map_err(|_| format!("\"{}\" is not a number", shown(text)))?;
    if (value as f32).is_finite() {
        Ok(value)
    } else {
        Err(format!(
            "{} is not a finite single-precision number",
            shown(text)
        ))
    }
}

/// Exactly `N` numbers.
pub(super) fn numbers<const N: usize>(text: &str) -> Result<[f64; N], String> {
    let words = tokens(text);
    if words.len() != N {
        return Err(format!("expected {N} numbers, got {}", words.len()));
    }
    let mut out = [0.0; N];
    for (slot, word) in out.iter_mut().zip(words) {
        *slot = number(word)?;
    }
    Ok(out)
}

pub(super) fn integer(text: &str) -> Result<i64, String> {
    text.trim()
        .parse()
        .map_err(|_| format!("\"{}\" is not an integer", shown(text)))
}

pub(super) fn boolean(text: &str) -> Result<bool, String> {
    if text.eq_ignore_ascii_case("true") {
        Ok(true)
    } else if text.eq_ignore_ascii_case("false") {
        Ok(false)
    } else {
        Err(format!(
            "\"{}\" is neither \"true\" nor \"false\"",
            shown(text)
        ))
    }
}

/// `wavelength:value` pairs, in nanometres.
pub(super) fn spectrum(text: &str) -> Result<Spectrum, String> {
    let pair = |word: &str| match word.split_once(':') {
        Some((nm, value)) => Ok([number(nm)?, number(value)?]),
        None => {
            let what = format!("\"{}\" is no pair of wavelength:value", shown(word));
            Err(what)
        }
    };
    let pairs: Result<Vec<_>, String> = tokens(text).into_iter().map(pair).collect();
    Spectrum::new(pairs?)
}

/// One or three linear values.
pub(super) fn rgb(text: &str) -> Result<[f64; 3], String> {
    if text.trim_start().starts_with('#') {
        return Err("hexadecimal colours are written <srgb value=\"#rrggbb\"/>".to_string());
    }
    match tokens(text).len() {
        1 => numbers::<1>(text).map(|[v]| [v; 3]),
        3 => numbers::<3>(text),
        n => Err(format!("expected one or three colour values, got {n}")),
    }
}

/// `#rrggbb`, or one or three values in 0…1: sRGB-encoded, decoded to linear.
pub(super) fn srgb(text: &str) -> Result<[f64; 3], String> {
    let text = text.trim();
    let encoded = match text.strip_prefix('#') {
        Some(hex) if hex.len() == 6 && hex.bytes().all(|b| b.is_ascii_hexdigit()) => {
            let packed = u32::from_str_radix(hex, 16).map_err(|e| e.to_string())?;
            [packed >> 16, packed >> 8, packed].map(|v| f64::from(v & 255) / 255.0)
        }
        Some(_) => return Err(format!("\"{}\" is not of the form #rrggbb", shown(text))),
        None => rgb(text)?,
    };
    if let Some(bad) = encoded.iter().find(|v| !(0.0..=1.0).contains(*v)) {
        return Err(format!("an sRGB value is between 0 and 1, not {bad}"));
    }
    Ok(encoded.map(srgb_to_linear))
}

fn srgb_to_linear(v: f64) -> f64 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours() {
        assert_eq!(rgb("0.5").unwrap(), [0.5; 3]);
        assert_eq!(rgb("1, 2 3").unwrap(), [1.0, 2.0, 3.0]);
        assert!(rgb("1 2").is_err());
        let [r, g, b] = srgb("#ff8000").unwrap();
        assert!((r - 1.0).abs() < 1e-12 && (g - 0.215_860_5).abs() < 1e-6 && b == 0.0);
        assert!(srgb("#ff80").is_err() && srgb("#+f8000").is_err());
        assert!(srgb("1e25").is_err() && srgb("0.2, -0.1, 0.3").is_err());
    }

    #[test]
    fn numbers_are_finite() {
        assert!(number("1e39").is_err() && number("nan").is_err() && number("inf").is_err());
        assert_eq!(number(" 1e-3 ").unwrap(), 1e-3);
    }
}
