//! Textures: read from PNG and JPEG files, or generated ([`crate::pattern`]).

use crate::budget::Budget;
use image::{
    DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits, error::LimitErrorKind,
};
use rayon::prelude::*;
use serde::Deserialize;
use std::{borrow::Cow, io::Cursor, sync::Arc};

/// Longest side of a texture that is read: WebGPU guarantees no longer one.
const LONGEST: u32 = 8192;

/// Most bytes that a decoder takes before it decodes texels.
const MAX_BEFORE: u64 = 16 << 20;

/// A texture of 8 bits a channel.
#[derive(Clone, PartialEq, Eq)]
pub struct Texture {
    /// Its file or pattern, for messages.
    pub name: String,
    /// Width and height in texels.
    pub size: [u32; 2],
    /// Red, green, blue, alpha of every texel, row by row from the top.
    pub texels: Vec<[u8; 4]>,
    /// Whether any texel is not wholly opaque.
    pub has_alpha: bool,
    /// Whether every texel is grey.
    pub is_grey: bool,
}

impl std::fmt::Debug for Texture {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [width, height] = self.size;
        write!(f, "Texture({:?}, {width}x{height})", self.name)
    }
}

/// What a texture shows beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Wrap {
    /// The texture again.
    #[default]
    Repeat,
    /// The texture mirrored.
    Mirror,
    /// The texels of its edge.
    Clamp,
}

/// The textures of a material, named as in glTF 2.0; each multiplies the material's value.
#[derive(Clone, Debug, PartialEq)]
pub struct Maps {
    /// Base colour in sRGB, and opacity.
    pub color: Option<Arc<Texture>>,
    /// Tangent-space normals.
    pub normal: Option<Arc<Texture>>,
    /// Roughness in green, metallic in blue.
    pub metallic_roughness: Option<Arc<Texture>>,
    /// Share of ambient light that arrives, in red.
    pub occlusion: Option<Arc<Texture>>,
    /// Emission in sRGB.
    pub emissive: Option<Arc<Texture>>,
    /// Moves the surface, at load: it is `None` in the objects of a scene, whose meshes have been moved.
    pub displacement: Option<Displacement>,
    /// Scale of the normal map's slopes.
    pub normal_scale: f32,
    /// Strength of the occlusion map, 0 … 1.
    pub occlusion_strength: f32,
    /// What lies beyond the edges, across and down.
    pub wrap: [Wrap; 2],
    /// Whether a magnified texture shows its texels as squares.
    pub nearest: bool,
}

/// How far a texture moves a surface along its normals.
#[derive(Clone, Debug, PartialEq)]
pub struct Displacement {
    /// Its luminance is a height of 0 … 1.
    pub map: Arc<Texture>,
    /// How far white rises over black, object space.
    pub scale: f32,
    /// The height that stays where it is.
    pub middle: f32,
    /// How often every triangle is cut into four; by default until no edge spans more than two texels, six times at most.
    pub level: Option<u32>,
}

impl Maps {
    /// No maps.
    pub const NONE: Self = Self {
        color: None,
        normal: None,
        metallic_roughness: None,
        occlusion: None,
        emissive: None,
        displacement: None,
        normal_scale: 1.0,
        occlusion_strength: 1.0,
        wrap: [Wrap::Repeat; 2],
        nearest: false,
    };

    /// Whether there is any, or a displacement.
    pub(crate) fn has_any(&self) -> bool {
        self.displacement.is_some() || self.all().iter().any(Option::is_some)
    }

    /// The five that are drawn, in the order of their bindings.
    pub fn all(&self) -> [Option<&Arc<Texture>>; 5] {
        [
            self.color.as_ref(),
            self.normal.as_ref(),
            self.metallic_roughness.as_ref(),
            self.occlusion.as_ref(),
            self.emissive.as_ref(),
        ]
    }
}

impl Texture {
    fn new(name: &str, size: [u32; 2], texels: Vec<[u8; 4]>) -> Self {
        Self {
            name: name.to_owned(),
            size,
            has_alpha: texels.par_iter().any(|t| t[3] < 255),
            is_grey: texels.par_iter().all(|[r, g, b, _]| r == g && g == b),
            texels,
        }
    }

    /// Reads a PNG or JPEG image for a scene that has taken other textures, with at most one more copy of its texels in memory.
    pub(crate) fn decode(name: &str, bytes: &[u8], budget: &mut Budget) -> Result<Self, String> {
        let decoder = decoder(bytes)?;
        let (width, height) = decoder.dimensions();
        if width.max(height) > LONGEST {
            return Err(too_large());
        }
        budget
            .take_image([width, height], bytes.len())
            .map_err(|e| format!("has {e}"))?;
        let image = DynamicImage::from_decoder(decoder).map_err(|e| plain(&e))?;
        let texels = bytemuck::cast_vec(image.into_rgba8().into_raw());
        Ok(Self::new(name, [width, height], texels))
    }

    /// A texture from a function of column and row.
    pub fn of(name: &str, size: [u32; 2], texel: impl Fn(u32, u32) -> [u8; 4] + Sync) -> Self {
        Self::new(name, size, fill(size, texel))
    }

    /// The same texture without holes.
    pub(crate) fn opaque(&self) -> Self {
        let texels = self.texels.par_iter().map(|[r, g, b, _]| [*r, *g, *b, 255]);
        Self::new(&self.name, self.size, texels.collect())
    }

    fn at_size(&self, size: [u32; 2]) -> Cow<'_, Self> {
        let [width, height] = self.size;
        let texels = self.texels.as_flattened();
        let image = image::ImageBuffer::<image::Rgba<u8>, _>::from_raw(width, height, texels);
        match image.filter(|_| size != self.size) {
            None => Cow::Borrowed(self),
            Some(image) => {
                let filter = image::imageops::FilterType::Triangle;
                let image = image::imageops::resize(&image, size[0], size[1], filter);
                let texels = image.pixels().map(|p| p.0).collect();
                Cow::Owned(Self::new(&self.name, size, texels))
            }
        }
    }

    /// Two textures joined texel by texel, at the larger size of each side.
    pub(crate) fn joined(
        a: &Self,
        b: &Self,
        texel: impl Fn([u8; 4], [u8; 4]) -> [u8; 4] + Sync,
    ) -> Self {
        let size = [a.size[0].max(b.size[0]), a.size[1].max(b.size[1])];
        let (left, right) = (a.at_size(size), b.at_size(size));
        let pairs = left.texels.par_iter().zip(&right.texels);
        let name = format!("{} and {}", a.name, b.name);
        Self::new(&name, size, pairs.map(|(a, b)| texel(*a, *b)).collect())
    }

    /// Tangent-space normals of a height field that repeats: `slope` is the rise of white over black in widths of a texel.
    pub(crate) fn normals_of_heights(&self, slope: f32) -> Self {
        let [width, height] = self.size;
        let at = |x: u32, y: u32| self.texels[(y % height * width + x % width) as usize][0];
        let height = |x, y| f32::from(at(x, y)) / 255.0;
        normals_of(&self.name, self.size, slope, height)
    }
}

/// A decoder that has read what comes before the texels.
fn decoder(bytes: &[u8]) -> Result<impl ImageDecoder + '_, String> {
    let format = image::guess_format(bytes).ok();
    let Some(format) = format.filter(|f| [ImageFormat::Png, ImageFormat::Jpeg].contains(f)) else {
        return Err("is neither a PNG nor a JPEG image; save it as one of them".into());
    };
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(LONGEST), Some(LONGEST));
    // Of what is read before the texels, such as a colour profile.
    limits.max_alloc = Some(MAX_BEFORE);
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    reader.into_decoder().map_err(|e| plain(&e))
}

fn too_large() -> String {
    format!("is larger than {LONGEST} texels wide or high; save it smaller")
}

/// An error in plain words: the decoders' own show their inner state.
fn plain(e: &ImageError) -> String {
    match e {
        ImageError::Limits(e) if matches!(e.kind(), LimitErrorKind::DimensionError) => too_large(),
        ImageError::Limits(_) => "needs too much memory; save it smaller".into(),
        ImageError::Unsupported(_) => {
            "is a kind of PNG or JPEG that is not read; save it again with 8 bits a channel".into()
        }
        ImageError::IoError(_) => "is cut off; save it again".into(),
        _ => "is damaged or cut off; save it again".into(),
    }
}

/// The values of a function of column and row, row by row.
pub(crate) fn fill<T: Clone + Default + Send>(
    [width, height]: [u32; 2],
    value: impl Fn(u32, u32) -> T + Sync,
) -> Vec<T> {
    let mut all = vec![T::default(); width as usize * height as usize];
    let rows = all.par_chunks_mut(width.max(1) as usize);
    rows.zip(0..height).for_each(|(row, y)| {
        for (at, x) in row.iter_mut().zip(0..) {
            *at = value(x, y);
        }
    });
    all
}

/// Tangent-space normals of heights that repeat, by central differences; `slope` is the rise of 1 in widths of a texel.
pub(crate) fn normals_of(
    name: &str,
    size: [u32; 2],
    slope: f32,
    height: impl Fn(u32, u32) -> f32 + Sync,
) -> Texture {
    let [w, h] = size;
    Texture::of(name, size, |x, y| {
        let dx = (height((x + 1) % w, y) - height((x + w - 1) % w, y)) * 0.5 * slope;
        // Rows run downwards, the second tangent upwards.
        let dy = (height(x, (y + h - 1) % h) - height(x, (y + 1) % h)) * 0.5 * slope;
        let n = glam::Vec3::new(-dx, -dy, 1.0).normalize();
        let byte = |v: f32| (v * 127.0 + 128.0).round().clamp(0.0, 255.0) as u8;
        [byte(n.x), byte(n.y), byte(n.z), 255]
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::ImageEncoder as _;

    /// A plane that rises to the right by one texel a texel leans to the left by 45 degrees; flat ground is (128, 128, 255).
    #[test]
    fn normals_of_a_slope() {
        let ramp = normals_of("ramp", [8, 4], 1.0, |x, _| x as f32);
        let slope = 127.0 / 2f32.sqrt();
        let [left, up] = [128.0 - slope, 128.0 + slope].map(|x| x.round() as u8);
        assert_eq!(ramp.texels[8 + 3], [left, 128, up, 255]);
        let flat = normals_of("flat", [4, 4], 5.0, |_, _| 0.3);
        assert!(flat.texels.iter().all(|t| *t == [128, 128, 255, 255]));
    }

    /// A colour profile of 32 MiB, packed to a few kilobytes, is left out: it would be made and not used.
    #[test]
    fn what_precedes_the_texels_is_bounded() {
        let encoded = |profile: usize| {
            let mut bytes = Vec::new();
            let mut encoder = image::codecs::png::PngEncoder::new(&mut bytes);
            encoder.set_icc_profile(vec![0; profile]).expect("is taken");
            let written = encoder.write_image(&[7; 3], 1, 1, image::ExtendedColorType::Rgb8);
            written.map(|()| bytes).expect("encodes")
        };
        for (length, is_read) in [(1 << 10, true), (1 << 25, false)] {
            let bytes = encoded(length);
            let profile = decoder(&bytes).expect("opens").icc_profile();
            assert_eq!(profile.expect("is whole").is_some(), is_read);
            let texture = Texture::decode("x", &bytes, &mut Budget::default());
            assert_eq!(texture.expect("is read").texels, [[7, 7, 7, 255]]);
        }
    }

    /// Decoders' errors show their inner state; ours are sentences. Sides beyond the limit, a damaged chunk, another format, and a file cut off.
    #[test]
    fn errors_of_images_are_sentences() {
        let mut bytes = std::io::Cursor::new(Vec::new());
        let image = image::RgbImage::new(8193, 1);
        let written = image.write_to(&mut bytes, image::ImageFormat::Png);
        let wide = written.map(|()| bytes.into_inner()).expect("encodes");
        let mut damaged = wide.clone();
        damaged[20] ^= 0x11;
        for (bytes, word) in [
            (&*wide, "8192"),
            (&*damaged, "damaged"),
            (b"RIFF....WEBP", "PNG"),
            (b"\x89PNG\r\n\x1a\n\0\0", "save it again"),
        ] {
            let e = Texture::decode("x", bytes, &mut Budget::default()).expect_err("is not read");
            assert!(e.contains(word) && !e.contains(['{', '(', ':']), "{e}");
        }
    }
}
