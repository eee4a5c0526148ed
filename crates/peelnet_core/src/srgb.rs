//! The transfer function of sRGB (IEC 61966-2-1).

/// Linear light as it is stored, 0 … 1; what lies outside is clamped, NaN becomes 0.
#[allow(
    clippy::manual_clamp,
    reason = "clamp would hand a NaN on; max and min make it 0"
)]
pub fn encode(linear: f32) -> f32 {
    let x = linear.max(0.0).min(1.0);
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}

pub fn encode8(linear: f32) -> u8 {
    (encode(linear) * 255.0).round() as u8
}

pub fn decode(stored: f32) -> f32 {
    if stored <= 0.04045 {
        stored / 12.92
    } else {
        ((stored + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every byte comes back, white, black and middle grey are known, and the two branches meet.
    #[test]
    fn bytes_come_back() {
        for byte in 0..=255u8 {
            let x = f32::from(byte) / 255.0;
            assert_eq!(encode8(decode(x)), byte);
        }
        assert_eq!((encode(f32::NAN), encode(2.0)), (0.0, encode(1.0)));
        assert!((encode(1.0) - 1.0).abs() < 1e-6 && (decode(1.0) - 1.0).abs() < 1e-6);
        assert!((encode(0.18) - 0.461_36).abs() < 1e-5);
        assert!((encode(0.003_130_8) - encode(0.003_130_9)).abs() < 1e-5);
    }
}
