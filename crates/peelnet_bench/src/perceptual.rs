//! Differences as people see them, from well-kept crates, on 8-bit sRGB images.

use image::{GrayImage, Luma};
use peelnet_render::Image;

/// An image as both crates read it.
#[derive(Debug)]
pub struct Displayed {
    luma: GrayImage,
    /// Three bytes a pixel.
    rgb: Vec<u8>,
}

impl Displayed {
    pub fn new(image: &Image) -> Self {
        let bytes = image.to_srgb8();
        let mut luma = GrayImage::new(image.width, image.height);
        for (gray, p) in luma.pixels_mut().zip(bytes.chunks_exact(3)) {
            // BT.709 weights on encoded values.
            let [r, g, b] = [p[0], p[1], p[2]].map(f64::from);
            *gray = Luma([(0.2126 * r + 0.7152 * g + 0.0722 * b).round() as u8]);
        }
        Self { luma, rgb: bytes }
    }

    /// Width and height in pixels, and three bytes a pixel, row by row.
    pub fn rgb8(&self) -> ([u32; 2], &[u8]) {
        (self.luma.dimensions().into(), &self.rgb)
    }

    /// Mean structural similarity (Wang et al. 2004) of the luma: `image-compare`'s, over windows of 8×8 pixels; 1 for equal
    /// images. `None` for images smaller than a window, or of different sizes.
    pub fn ssim(&self, exact: &Self) -> Option<f64> {
        let algorithm = image_compare::Algorithm::MSSIMSimple;
        let (width, height) = self.luma.dimensions();
        if width < 8 || height < 8 {
            return None;
        }
        let found = image_compare::gray_similarity_structure(&algorithm, &exact.luma, &self.luma);
        Some(found.ok()?.score)
    }

    /// Mean ꟻLIP (Andersson et al. 2020): NVIDIA's own code in `nv-flip`, for a display seen at 67 pixels a degree; 0 for
    /// equal images, at most 1. Its code is C++, which is not compiled for a page.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn flip(&self, exact: &Self) -> f64 {
        let of = |image: &Self| {
            let (width, height) = image.luma.dimensions();
            nv_flip::FlipImageRgb8::with_data(width, height, &image.rgb)
        };
        let map = nv_flip::flip(of(exact), of(self), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
        let all = map.to_vec();
        all.iter().map(|&x| f64::from(x)).sum::<f64>() / all.len().max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(gray: impl Fn(usize) -> f32) -> Displayed {
        Displayed::new(&Image {
            width: 64,
            height: 48,
            pixels: (0..48 * 64).map(|i| [gray(i); 4]).collect(),
        })
    }

    /// Constant images have no structure: what is left of SSIM is its luminance term
    /// `(2 μ ν + c) / (μ² + ν² + c)`, c = (0.01 · 255)².
    #[test]
    fn equal_images_and_constant_ones() {
        let a = image(|i| (i % 64) as f32 / 64.0);
        assert_eq!(a.flip(&a), 0.0);
        assert!((a.ssim(&a).unwrap() - 1.0).abs() < 1e-6);
        let (black, white) = (image(|_| 0.0), image(|_| 1.0));
        let c = 2.55f64 * 2.55;
        let want = c / (255.0 * 255.0 + c);
        assert!((white.ssim(&black).unwrap() - want).abs() < 1e-6);
    }
}
