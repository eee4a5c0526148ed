//! The drawn frame in memory, and its three file formats.

use crate::RenderError;
use peelnet_core::files::{Kind, STDOUT, holds};
use peelnet_core::srgb;
use std::path::Path;

/// The formats of image files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// `.png`: opaque sRGB, 8 bits a channel.
    Png,
    /// `.exr`: linear RGB and coverage in 32-bit floats.
    Exr,
    /// `.npy`: the same as an array `H×W×4`.
    Npy,
}

impl ImageFormat {
    /// The format of a file by its ending. Stdout, whose name says nothing, gets PNG.
    ///
    /// # Errors
    /// [`RenderError::Image`] for any other ending.
    pub fn from_ending(path: &Path) -> Result<Self, RenderError> {
        let ending = path.extension().and_then(|e| e.to_str());
        match ending.unwrap_or_default().to_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            "npy" => Ok(Self::Npy),
            _ if path == Path::new(STDOUT) => Ok(Self::Png),
            _ => Err(failed(
                path,
                &"the ending says the format; use .png (sRGB), .exr or .npy (linear)",
            )),
        }
    }

    /// By what a file of this format is known: all say who wrote them.
    pub const fn kind(self) -> Kind {
        match self {
            Self::Png => Kind {
                name: "a PNG image of peelnet",
                is: is_our_png,
            },
            Self::Exr => Kind {
                name: "an EXR image of peelnet",
                is: |head| {
                    head.starts_with(b"\x76\x2f\x31\x01")
                        && is_marked(head, b"software\0string\0\x07\0\0\0peelnet")
                },
            },
            Self::Npy => Kind {
                name: "an NPY image of peelnet",
                is: |head| {
                    let pixels = b"{'descr': '<f4', 'fortran_order': False, 'shape': (";
                    head.starts_with(b"\x93NUMPY\x01\0")
                        && head.get(8..10) == Some(&NPY_HEADER)
                        && head[10..].starts_with(pixels)
                },
            },
        }
    }
}

/// Keyword and text of the chunk that says who wrote a PNG file.
const SOFTWARE: [&str; 2] = ["Software", "peelnet"];

/// Length of the header of our NPY files, whose format has no place for a name: four times what other programs need, filled with spaces.
const NPY_HEADER: [u8; 2] = 502_u16.to_le_bytes();

fn is_our_png(head: &[u8]) -> bool {
    head.starts_with(b"\x89PNG\r\n\x1a\n") && is_marked(head, b"tEXtSoftware\0peelnet")
}

/// Whether a file says before its pixels, in its format's own field, that peelnet wrote it. Programs write paths into others, which may hold
/// the word.
fn is_marked(head: &[u8], mark: &[u8]) -> bool {
    holds(&head[..head.len().min(1024)], mark)
}

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
            .map(srgb::encode8)
            .collect()
    }

    /// Number of pixels with a NaN or an infinity.
    pub fn non_finite(&self) -> usize {
        self.pixels
            .iter()
            .filter(|p| p.iter().any(|c| !c.is_finite()))
            .count()
    }

    /// The bytes of a file of a format.
    pub fn encoded(&self, format: ImageFormat) -> Result<Vec<u8>, RenderError> {
        let failed = |e: &dyn std::fmt::Display| failed(Path::new("in memory"), e);
        let flat = || -> Vec<f32> { self.pixels.iter().flatten().copied().collect() };
        let mut bytes = std::io::Cursor::new(Vec::new());
        match format {
            ImageFormat::Png => self.write_png(&mut bytes).map_err(|e| failed(&e))?,
            ImageFormat::Exr => self.write_exr(&mut bytes).map_err(|e| failed(&e))?,
            ImageFormat::Npy => {
                let shape = (self.height as usize, self.width as usize, 4);
                let array =
                    ndarray::Array3::from_shape_vec(shape, flat()).map_err(|e| failed(&e))?;
                ndarray_npy::WriteNpyExt::write_npy(&array, &mut bytes).map_err(|e| failed(&e))?;
                let bytes = bytes.get_mut();
                let end = 10 + usize::from(u16::from_le_bytes([bytes[8], bytes[9]]));
                let spaces = 10 + usize::from(u16::from_le_bytes(NPY_HEADER)) - end;
                bytes.splice(end - 1..end - 1, std::iter::repeat_n(b' ', spaces));
                bytes[8..10].copy_from_slice(&NPY_HEADER);
            }
        }
        Ok(bytes.into_inner())
    }

    fn write_exr(&self, to: impl std::io::Write + std::io::Seek) -> exr::error::UnitResult {
        use exr::prelude::*;
        let size = Vec2(self.width as usize, self.height as usize);
        let pixel = |at: Vec2<usize>| self.pixels[at.flat_index_for_size(size)].into();
        let attributes = LayerAttributes {
            software_name: Some(SOFTWARE[1].into()),
            ..LayerAttributes::default()
        };
        let encoding = Encoding::FAST_LOSSLESS;
        let channels = SpecificChannels::rgba(|at| -> (f32, f32, f32, f32) { pixel(at) });
        let layer = Layer::new(size, attributes, encoding, channels);
        Image::from_layer(layer).write().to_buffered(to)
    }

    fn write_png(&self, to: impl std::io::Write) -> Result<(), png::EncodingError> {
        let mut encoder = png::Encoder::new(to, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_compression(png::Compression::Fast);
        let [keyword, text] = SOFTWARE.map(str::to_owned);
        encoder.add_text_chunk(keyword, text)?;
        let mut writer = encoder.write_header()?;
        writer.write_image_data(&self.to_srgb8())?;
        writer.finish()
    }

    /// Writes the image in the format that [`ImageFormat::from_ending`] finds. The file appears whole or not at all.
    ///
    /// # Errors
    /// An unknown ending, or a file that cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), RenderError> {
        let bytes = self.encoded(ImageFormat::from_ending(path)?)?;
        peelnet_core::files::write_whole(path, &bytes).map_err(|e| failed(path, &e))
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
        for good in ["a.png", "b/c.EXR", "d.npy"] {
            assert!(ImageFormat::from_ending(Path::new(good)).is_ok(), "{good}");
        }
        for bad in ["a", "a.jpg", ".png"] {
            assert!(ImageFormat::from_ending(Path::new(bad)).is_err(), "{bad}");
        }
        for (name, foreign) in [
            ("a.png", &b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR"[..]),
            ("a.exr", b"\x76\x2f\x31\x01\x02\0\0\0channels"),
            (
                "a.npy",
                b"\x93NUMPY\x01\0v\0{'descr': '<f4', 'fortran_order': False, 'shape': (3, 2, 4), }",
            ),
        ] {
            let kind = ImageFormat::from_ending(&at(name))
                .expect("an ending")
                .kind();
            std::fs::write(at("foreign"), foreign).expect("writes");
            let found = [name, "foreign"].map(|n| kind.is_foreign(&at(n)).expect("reads"));
            assert_eq!(found, [false, true], "{name}");
            std::fs::remove_file(at("foreign")).expect("removes");
        }
        assert_eq!(std::fs::read_dir(dir.path()).expect("lists").count(), 3);
    }
}
