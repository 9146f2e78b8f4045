//! Spectra as colours in linear sRGB, as the rgb variants of Mitsuba 3.9.1 take them
//! (`spectrum_list_to_srgb`).

use super::nearest::shown;
use super::observer::OBSERVER;

/// The observer's, in nanometres.
const FIRST_NM: f64 = 360.0;
const LAST_NM: f64 = 830.0;
const STEP_NM: f64 = 5.0;
/// Wavelengths at which spectra are looked up.
const LOOKS: usize = 1000;
/// One over the integral of ȳ over wavelengths in nanometres.
const PER_LUMINANCE: f64 = 0.009_367_658_735_689_113;
/// What makes the integral of ȳ over D65, which is one at 560 nanometres, that of ȳ.
const D65_SCALE: f64 = 1.010_127_359_949_035_4;
/// From XYZ to linear sRGB.
const SRGB: [[f64; 3]; 3] = [
    [3.240_479, -1.537_15, -0.498_535],
    [-0.969_256, 1.875_991, 0.041_556],
    [0.055_648, -0.204_043, 1.057_311],
];

/// Values at wavelengths in nanometres, which increase; linear between, zero beyond.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Spectrum(Vec<[f64; 2]>);

/// What a spectrum is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Of {
    /// Light.
    Emission,
    /// Reflectances and the like, seen under D65: from 0 to 1.
    Reflectance,
    /// Indices of refraction, averaged under D65.
    Index,
}

impl Spectrum {
    /// From wavelengths and values; errors are sentences.
    pub fn new(points: Vec<[f64; 2]>) -> Result<Self, String> {
        if points.len() < 2 {
            return Err("a spectrum has two wavelengths at least".to_string());
        }
        match points.windows(2).find(|p| p[1][0] <= p[0][0]) {
            None => Ok(Self(points)),
            Some(p) => Err(format!(
                "wavelengths must increase, and {} follows {}",
                p[1][0], p[0][0]
            )),
        }
    }

    /// From lines of a wavelength and a value, as files have them; `#` begins a remark.
    pub fn from_lines(text: &str) -> Result<Self, String> {
        let number = |word: &str| match word.parse::<f64>() {
            Ok(number) if (number as f32).is_finite() => Ok(number),
            _ => Err(format!("\"{}\" is not a finite number", shown(word))),
        };
        let mut points = Vec::new();
        for (number_of_line, line) in (1..).zip(text.lines()) {
            let line = line.split('#').next().unwrap_or_default();
            let words: Vec<&str> = line.split_whitespace().collect();
            let point = match words[..] {
                [] => continue,
                [nm, value] => number(nm).and_then(|nm| Ok([nm, number(value)?])),
                _ => Err("a line has a wavelength and a value".to_string()),
            };
            points.push(point.map_err(|e| format!("line {number_of_line}: {e}"))?);
        }
        Self::new(points)
    }

    fn at(&self, nm: f64) -> f64 {
        let after = self.0.partition_point(|p| p[0] < nm);
        match (after.checked_sub(1).map(|b| self.0[b]), self.0.get(after)) {
            (_, Some(&[at, value])) if at == nm => value,
            (Some([a, low]), Some(&[b, high])) => low + (high - low) * (nm - a) / (b - a),
            _ => 0.0,
        }
    }

    /// Linear sRGB; what lies outside of it is cut off.
    pub fn srgb(&self, of: Of) -> [f64; 3] {
        let mut xyz = [0.0; 3];
        for look in 0..LOOKS {
            let nm = FIRST_NM + (LAST_NM - FIRST_NM) * look as f64 / (LOOKS - 1) as f64;
            let place = (nm - FIRST_NM) / STEP_NM;
            let before = (place as usize).min(OBSERVER.len() - 2);
            let [low, high] = [OBSERVER[before], OBSERVER[before + 1]];
            let part = place - before as f64;
            let seen: [f64; 4] = std::array::from_fn(|i| {
                f64::from(low[i]) + part * (f64::from(high[i]) - f64::from(low[i]))
            });
            let light = match of {
                Of::Emission => 1.0,
                Of::Reflectance | Of::Index => D65_SCALE * seen[3],
            };
            let value = self.at(nm) * light;
            (0..3).for_each(|i| xyz[i] += seen[i] * value);
        }
        let scale = (LAST_NM - FIRST_NM) / LOOKS as f64 * PER_LUMINANCE;
        let most = match of {
            Of::Reflectance => 1.0,
            Of::Emission | Of::Index => f64::INFINITY,
        };
        SRGB.map(|row| {
            let sum: f64 = row.iter().zip(xyz).map(|(m, x)| m * x).sum();
            (scale * sum).clamp(0.0, most)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What Mitsuba 3.9.1, variant scalar_rgb, makes of spectra (its `mi.traverse`).
    #[test]
    fn colours_are_mitsubas() {
        let list = |points: &[[f64; 2]]| Spectrum::new(points.to_vec()).expect("a spectrum");
        let even = list(&[[300.0, 0.5], [900.0, 0.5]]);
        let rising = list(&[[400.0, 0.1], [700.0, 0.5]]);
        let steep = list(&[[400.0, 2.0], [700.0, 3.0]]);
        let violet = list(&[[400.0, 0.1], [500.0, 0.2]]);
        let cases = [
            (&even, Of::Reflectance, [0.49949265, 0.49943686, 0.4994008]),
            (&even, Of::Emission, [0.60244185, 0.4741141, 0.4546334]),
            (
                &rising,
                Of::Reflectance,
                [0.42119348, 0.29055786, 0.15390773],
            ),
            (&rising, Of::Emission, [0.49609208, 0.27684027, 0.13582286]),
            (&steep, Of::Index, [2.7948322, 2.4759684, 2.1258602]),
            (&violet, Of::Reflectance, [0.0, 0.00657276, 0.1669417]),
        ];
        for (spectrum, of, expected) in cases {
            let colour = spectrum.srgb(of);
            for (c, e) in colour.into_iter().zip(expected) {
                assert!(
                    (c - e).abs() < 2e-6 * (1.0 + e),
                    "{colour:?}, not {expected:?}"
                );
            }
        }
    }

    #[test]
    fn files_have_remarks_and_places() {
        let read = Spectrum::from_lines("# nm value\n400 0.1 # violet\n\n700 0.5\n");
        assert_eq!(read, Spectrum::new(vec![[400.0, 0.1], [700.0, 0.5]]));
        let said = |text: &str| Spectrum::from_lines(text).expect_err("an error");
        assert!(said("400 0.1\n700\n").contains("line 2"));
        assert!(said("400 nan\n").contains("nan"));
        assert!(said("400 0.1").contains("two wavelengths"));
        assert!(said("700 0.1\n400 0.1").contains("400 follows 700"));
    }
}
