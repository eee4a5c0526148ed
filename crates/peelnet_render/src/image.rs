//! The drawn frame in memory, and its three file formats.

use crate::error::RenderError;
use peelnet_core::srgb;
use std::path::Path;

/// Linear RGB and coverage, row 0 on top.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `height × width` pixels: linear red, green, blue, and coverage `1 − T_∞`.
    pub pixels: Vec<[f32; 4]>,
}

impl Image {
    /// sRGB-encoded 8-bit RGB, three bytes a pixel.
    pub fn to_srgb8(&self) -> Vec<u8> {
        self.pixels
            .iter()
            .flat_map(|p| [p[0], p[1], p[2]])
            .map(|c| (srgb::encode(c) * 255.0).round() as u8)
            .collect()
    }

    /// Number of pixels with a NaN or an infinity.
    pub fn non_finite(&self) -> usize {
        self.pixels
            .iter()
            .filter(|p| p.iter().any(|c| !c.is_finite()))
            .count()
    }

    /// The PNG file's bytes: opaque sRGB, 8 bits a channel.
    ///
    /// # Errors
    /// If the encoder fails.
    pub fn to_png(&self) -> Result<Vec<u8>, RenderError> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        image::write_buffer_with_format(
            &mut bytes,
            &self.to_srgb8(),
            self.width,
            self.height,
            image::ExtendedColorType::Rgb8,
            image::ImageFormat::Png,
        )
        .map_err(|e| failed(Path::new("in memory"), &e))?;
        Ok(bytes.into_inner())
    }

    /// Writes the image by its ending: `.png` (sRGB, 8 bits), `.exr` (linear, 32-bit float) or `.npy` (linear, 32-bit
    /// float, `H×W×4` with coverage). The file appears whole or not at all.
    ///
    /// # Errors
    /// An unknown ending, or a file that cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), RenderError> {
        let ending = path
            .extension()
            .and_then(|e| e.to_str())
            .unwrap_or_default()
            .to_lowercase();
        let flat = || -> Vec<f32> { self.pixels.iter().flatten().copied().collect() };
        let mut bytes = std::io::Cursor::new(Vec::new());
        match ending.as_str() {
            "png" => bytes = std::io::Cursor::new(self.to_png()?),
            "exr" => image::Rgba32FImage::from_raw(self.width, self.height, flat())
                .ok_or_else(|| failed(path, &"pixels do not fill the frame"))?
                .write_to(&mut bytes, image::ImageFormat::OpenExr)
                .map_err(|e| failed(path, &e))?,
            "npy" => {
                let shape = (self.height as usize, self.width as usize, 4);
                let array =
                    ndarray::Array3::from_shape_vec(shape, flat()).map_err(|e| failed(path, &e))?;
                ndarray_npy::WriteNpyExt::write_npy(&array, &mut bytes)
                    .map_err(|e| failed(path, &e))?;
            }
            other => {
                return Err(failed(
                    path,
                    &format!("unknown image ending '{other}'; use .png, .exr or .npy"),
                ));
            }
        }
        peelnet_files::write_whole(path, &bytes.into_inner()).map_err(|e| failed(path, &e))
    }
}

fn failed(path: &Path, reason: &dyn std::fmt::Display) -> RenderError {
    RenderError::Image {
        path: path.to_owned(),
        message: reason.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_has_its_known_values() {
        assert_eq!(srgb::encode(0.0), 0.0);
        assert!((srgb::encode(1.0) - 1.0).abs() < 1e-6);
        // Middle grey: 18 % reflectance encodes to 0.4614.
        assert!((srgb::encode(0.18) - 0.461_356).abs() < 1e-5);
        assert_eq!(srgb::encode(7.0), srgb::encode(1.0));
    }

    #[test]
    fn files_read_back() {
        let image = Image {
            width: 2,
            height: 3,
            pixels: (0..6).map(|i| [i as f32 * 0.125, 2.0, -1.0, 0.5]).collect(),
        };
        let dir = tempfile::tempdir().expect("temporary folder");
        let at = |n: &str| dir.path().join(n);
        image.save(&at("a.npy")).expect("npy");
        let back: ndarray::Array3<f32> = ndarray_npy::read_npy(at("a.npy")).expect("reads");
        assert_eq!(back.shape(), [3, 2, 4]);
        assert_eq!(back[[2, 1, 0]], 0.625);
        image.save(&at("a.exr")).expect("exr");
        let back = image::open(at("a.exr")).expect("reads").to_rgba32f();
        assert_eq!(back.get_pixel(1, 2).0, [0.625, 2.0, -1.0, 0.5]);
        image.save(&at("a.png")).expect("png");
        let back = image::open(at("a.png")).expect("reads").to_rgb8();
        assert_eq!(back.get_pixel(0, 0).0, [0, 255, 0]);
        assert!(image.save(&at("a.gif")).is_err());
        assert_eq!(std::fs::read_dir(dir.path()).expect("lists").count(), 3);
    }
}
