//! PNG and JPEG files, decoded into texels with at most one more copy of them in memory.

use crate::budget::Budget;
use image::{
    ColorType, DynamicImage, ImageDecoder, ImageError, ImageFormat, Limits,
    codecs::{jpeg::JpegDecoder, png::PngDecoder},
    error::LimitErrorKind,
};
use rayon::prelude::*;
use std::io::Cursor;

/// Longest side of a texture that is read: WebGPU guarantees no longer one.
const LONGEST: u32 = 8192;

/// An image's size and texels.
type Decoded = ([u32; 2], Vec<[u8; 4]>);

/// Decodes a PNG or JPEG image.
pub(super) fn decode(bytes: &[u8], budget: &mut Budget) -> Result<Decoded, String> {
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(LONGEST), Some(LONGEST));
    match image::guess_format(bytes) {
        Ok(ImageFormat::Png) => {
            let decoder = PngDecoder::with_limits(Cursor::new(bytes), limits);
            texels(decoder.map_err(|e| plain(&e))?, budget)
        }
        Ok(ImageFormat::Jpeg) => {
            let decoder = JpegDecoder::new(Cursor::new(bytes)).and_then(|mut decoder| {
                decoder.set_limits(limits)?;
                Ok(decoder)
            });
            texels(decoder.map_err(|e| plain(&e))?, budget)
        }
        _ => Err("is neither a PNG nor a JPEG image; save it as one of them".into()),
    }
}

fn texels(decoder: impl ImageDecoder, budget: &mut Budget) -> Result<Decoded, String> {
    let (width, height) = decoder.dimensions();
    if width.max(height) > LONGEST {
        return Err(too_large());
    }
    let size = [width, height];
    let count = width as usize * height as usize;
    budget.take_texels(size)?;
    let mut all = vec![[0; 4]; count];
    let color = decoder.color_type();
    match color {
        ColorType::Rgba8 => read(decoder, all.as_flattened_mut())?,
        ColorType::Rgb8 | ColorType::L8 | ColorType::La8 => {
            let channels = usize::from(color.channel_count());
            let mut raw = vec![0; count * channels];
            read(decoder, &mut raw)?;
            let raw = raw.par_chunks_exact(channels);
            all.par_iter_mut().zip(raw).for_each(|(texel, raw)| {
                *texel = match *raw {
                    [r, g, b] => [r, g, b, 255],
                    [grey, alpha] => [grey, grey, grey, alpha],
                    _ => [raw[0], raw[0], raw[0], 255],
                }
            });
        }
        // Of 16 bits a channel.
        _ => {
            drop(all);
            let image = DynamicImage::from_decoder(decoder).map_err(|e| plain(&e))?;
            all = image.into_rgba8().pixels().map(|p| p.0).collect();
        }
    }
    Ok((size, all))
}

fn read(decoder: impl ImageDecoder, into: &mut [u8]) -> Result<(), String> {
    decoder.read_image(into).map_err(|e| plain(&e))
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
