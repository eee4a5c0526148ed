//! Differences between two images of the same view.
//!
//! Three scales. *Linear light*: the values themselves; ratios between methods use it. *Display-referred*: clamped to
//! 0 … 1, sRGB-encoded (IEC 61966-2-1) and scaled to 0 … 255, but not rounded to whole numbers, as in the thesis's
//! table. *8-bit*: the same rounded to whole numbers, the bytes of a PNG file; PSNR is of these, as papers report it. The three
//! colour channels weigh the same, and coverage, the fourth component, is not compared.
//!
//! *Covered* pixels are those that hold at least one transparent fragment: coverage above 0 in the exact image.

use peelnet_core::srgb::{encode, encode8};

/// The sRGB encoding of a linear value in 64 bits, clamped to 0 … 1 first. What is not a number becomes black, as on
/// a screen. A test compares it with the renderer's, which encodes pictures in 32 bits.
#[allow(clippy::manual_clamp, reason = "`clamp` would keep a NaN")]
pub fn srgb_encode(linear: f32) -> f64 {
    let v = f64::from(linear.max(0.0).min(1.0));
    if v <= 0.003_130_8 {
        12.92 * v
    } else {
        1.055 * v.powf(1.0 / 2.4) - 0.055
    }
}

/// How much darker than the exact image a pixel must be in some channel, on the 0–255 scale, to count as an
/// artefact: a quarter of the range, far beyond what a wrong weight in a smooth place does.
pub const DARK: f64 = 64.0;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Differences {
    /// Mean squared error in linear light over all pixels and channels.
    pub mse_linear: f64,
    /// The same over covered pixels; `None` if no pixel is covered.
    pub mse_linear_covered: Option<f64>,
    /// Mean squared error on the 0–255 scale.
    pub mse255: f64,
    /// The same over covered pixels; `None` if no pixel is covered.
    pub mse255_covered: Option<f64>,
    /// Mean squared error of 8-bit sRGB images over all pixels and channels.
    pub mse_8bit: f64,
    /// Peak signal-to-noise ratio of `mse_8bit`, dB; `None` where the 8-bit images are identical.
    pub psnr: Option<f64>,
    /// 99th percentile (nearest rank) of the pixel error: the largest difference of the three channels, 0–255 scale.
    pub p99_error: f64,
    /// The largest pixel error, 0–255 scale.
    pub max_error: f64,
    pub covered_pixels: u64,
    /// Pixels that are brighter than the exact image in no channel and darker by more than [`DARK`] in some channel.
    pub dark_pixels: u64,
    /// Pixels with a component that is not finite. Such a component enters every error as 0.
    pub non_finite_pixels: u64,
}

/// Rounding of a value of an [`error_image`] in 32 bits, on the 0–255 scale: a dozen roundings of 255 · 2⁻²⁴ each, of the encoding of two
/// values up to 255, and of decoding where these come from 8-bit levels.
pub const ERROR_ROUNDING: f64 = 12.0 * 255.0 / (1 << 24) as f64;

/// The error image: signed differences of sRGB-encoded values, 0–255. What is not finite counts as black.
///
/// # Panics
/// If the images differ in size.
pub fn error_image(exact: &[[f32; 4]], approximate: &[[f32; 4]]) -> Vec<[f32; 3]> {
    assert_eq!(exact.len(), approximate.len(), "pixels of the two images");
    let level = |x: f32| 255.0 * encode(if x.is_finite() { x } else { 0.0 });
    let pixels = exact.iter().zip(approximate);
    let errors = pixels.map(|(e, a)| std::array::from_fn(|k| level(a[k]) - level(e[k])));
    errors.collect()
}

/// Peak signal-to-noise ratio of a mean squared error on the 0–255 scale, dB; `None` where there is no error.
pub fn psnr(mse255: f64) -> Option<f64> {
    (mse255 > 0.0).then(|| 10.0 * (255.0 * 255.0 / mse255).log10())
}

/// Sorts points by time, and marks those that no other one is both faster than and at least as accurate as. `of` is time and error.
pub fn mark_front<P>(points: &mut [P], of: impl Fn(&P) -> [f64; 2], set: impl Fn(&mut P, bool)) {
    points.sort_by(|a, b| {
        let ([a_time, a_error], [b_time, b_error]) = (of(a), of(b));
        a_time.total_cmp(&b_time).then(a_error.total_cmp(&b_error))
    });
    let mut least = f64::INFINITY;
    for p in points {
        let [_, error] = of(p);
        set(p, error < least);
        least = least.min(error);
    }
}

/// Squares summed over a pixel's channels in linear light and as displayed, and the largest difference of a channel.
#[derive(Clone, Copy, Default)]
struct Errors {
    linear: f64,
    display: f64,
    most: f64,
}

/// Compares an image with the exact one, both linear RGB and coverage, row by row.
///
/// # Panics
/// If they differ in size.
pub fn differences(exact: &[[f32; 4]], approximate: &[[f32; 4]]) -> Differences {
    assert_eq!(exact.len(), approximate.len(), "pixels of the two images");
    let (mut all, mut covered) = (Vec::new(), Vec::new());
    let mut result = Differences::default();
    let mut squares_8bit = 0u64;
    for (e, a) in exact.iter().zip(approximate) {
        let mut errors = Errors::default();
        let (mut brightest, mut darkest) = (0.0f64, 0.0f64);
        let mut finite = true;
        for k in 0..3 {
            finite &= a[k].is_finite();
            let value = if a[k].is_finite() { a[k] } else { 0.0 };
            errors.linear += (f64::from(value) - f64::from(e[k])).powi(2);
            let d = 255.0 * (srgb_encode(value) - srgb_encode(e[k]));
            errors.display += d * d;
            squares_8bit += u64::from(encode8(value).abs_diff(encode8(e[k]))).pow(2);
            errors.most = errors.most.max(d.abs());
            brightest = brightest.max(d);
            darkest = darkest.min(d);
        }
        result.non_finite_pixels += u64::from(!finite);
        // Half a level of tolerance: rounding noise in one channel must not hide a black pixel.
        result.dark_pixels += u64::from(brightest < 0.5 && darkest < -DARK);
        all.push(errors);
        if e[3] > 0.0 {
            covered.push(errors);
        }
    }
    let mean = |of: &[Errors], value: fn(&Errors) -> f64| {
        let sum: f64 = of.iter().map(value).sum();
        (!of.is_empty()).then(|| sum / (3.0 * of.len() as f64))
    };
    result.mse_linear = mean(&all, |e| e.linear).unwrap_or_default();
    result.mse_linear_covered = mean(&covered, |e| e.linear);
    result.mse255 = mean(&all, |e| e.display).unwrap_or_default();
    result.mse255_covered = mean(&covered, |e| e.display);
    result.mse_8bit = squares_8bit as f64 / (3 * exact.len().max(1)) as f64;
    result.psnr = psnr(result.mse_8bit);
    result.covered_pixels = covered.len() as u64;
    if let Some(last) = all.len().checked_sub(1) {
        // Nearest rank.
        let rank = (0.99 * all.len() as f64).ceil() as usize - 1;
        let by_error = |a: &Errors, b: &Errors| a.most.total_cmp(&b.most);
        for (value, rank) in [(&mut result.p99_error, rank), (&mut result.max_error, last)] {
            *value = all.select_nth_unstable_by(rank, by_error).1.most;
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The measured encoding is the shown one. 1e-6: a dozen 32-bit roundings of values up to 1.055.
    #[test]
    fn pictures_are_encoded_alike() {
        for k in -100..1200 {
            let linear = k as f32 * 1e-3;
            let shown = f64::from(peelnet_core::srgb::encode(linear));
            assert!((shown - srgb_encode(linear)).abs() < 1e-6, "{linear}");
        }
    }

    /// White against black in one channel of one of four pixels: the error is 255² / (4 · 3) on the display scale.
    #[test]
    fn one_wrong_channel() {
        let exact = [0.5, 0.0, 0.0, 0.0].map(|covered| [1.0, 1.0, 1.0, covered]);
        let mut wrong = exact;
        wrong[0][1] = 0.0;
        let d = differences(&exact, &wrong);
        assert!((d.mse255 - 255.0 * 255.0 / 12.0).abs() < 1e-9);
        assert!((d.mse255_covered.unwrap() - 255.0 * 255.0 / 3.0).abs() < 1e-9);
        assert!((d.mse_linear - 1.0 / 12.0).abs() < 1e-12);
        // 10·log10(12)
        assert!((d.psnr.unwrap() - 10.791_812_460_476).abs() < 1e-9);
        assert!((d.p99_error - 255.0).abs() < 1e-9);
        assert_eq!(d.dark_pixels, 1);
    }

    /// PSNR is of 8-bit images: half a level more or less of linear light is another byte or the same one. Three of six channels are one
    /// level off: 10·log10(255² / 0.5).
    #[test]
    fn psnr_is_of_8_bit_images() {
        let level = |x: f64| peelnet_core::srgb::decode((x / 255.0) as f32);
        let exact = [[level(100.0); 4], [level(200.0); 4]];
        let same = [[level(100.4); 4], [level(199.6); 4]];
        let d = differences(&exact, &same);
        assert_eq!((d.mse_8bit, d.psnr), (0.0, None));
        assert!((d.mse255 - 0.16).abs() < 1e-3, "{}", d.mse255);
        let next = [[level(100.6); 4], [level(200.4); 4]];
        let d = differences(&exact, &next);
        assert_eq!(d.mse_8bit, 0.5);
        assert!((d.psnr.unwrap() - 51.141_103_565_318).abs() < 1e-9);
    }

    #[test]
    fn the_percentile_is_the_nearest_rank() {
        let exact = vec![[0.0, 0.0, 0.0, 1.0]; 200];
        let mut wrong = exact.clone();
        // Two of 200 pixels are wrong: 1 %, just beyond the 99th percentile.
        wrong[3][0] = 1.0;
        wrong[77][0] = 1.0;
        assert_eq!(differences(&exact, &wrong).p99_error, 0.0);
        wrong[78][0] = 1.0;
        assert!(differences(&exact, &wrong).p99_error > 254.9);
    }

    #[test]
    fn what_is_not_finite_is_counted_and_black() {
        let exact = [[1.0; 4]];
        let wrong = [[f32::NAN, f32::INFINITY, f32::NAN, 1.0]];
        let d = differences(&exact, &wrong);
        assert_eq!((d.non_finite_pixels, d.dark_pixels), (1, 1));
        assert_eq!(d.mse_linear, 1.0);
        let errors = error_image(&exact, &wrong);
        let is_white = |x: &f32| (f64::from(*x) + 255.0).abs() < ERROR_ROUNDING;
        assert!(errors.as_flattened().iter().all(is_white), "{errors:?}");
    }
}
