//! The sRGB transfer curve (IEC 61966-2-1).

/// Linear light of one sRGB-encoded number, both from 0 to 1.
pub fn srgb_to_linear(encoded: f32) -> f32 {
    if encoded <= 0.04045 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_passes_through_its_known_points() {
        assert_eq!(srgb_to_linear(0.0), 0.0);
        assert_eq!(srgb_to_linear(1.0), 1.0);
        // Middle grey, and the byte 128.
        assert!((srgb_to_linear(0.5) - 0.214_041_14).abs() < 1e-7);
        assert!((srgb_to_linear(128.0 / 255.0) - 0.215_860_5).abs() < 1e-7);
        // The straight part and the power meet.
        let step = srgb_to_linear(0.040_451) - srgb_to_linear(0.04045);
        assert!(step > 0.0 && step < 1e-6, "{step}");
    }
}
