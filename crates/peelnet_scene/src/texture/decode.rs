//! PNG and JPEG files, decoded into texels with at most one more copy of them in memory.

use crate::budget::Budget;
use image::{
    DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits, error::LimitErrorKind,
};
use std::io::Cursor;

/// Longest side of a texture that is read: WebGPU guarantees no longer one.
const LONGEST: u32 = 8192;

type Decoded = ([u32; 2], Vec<[u8; 4]>);

pub(super) fn decode(bytes: &[u8], budget: &mut Budget) -> Result<Decoded, String> {
    let format = image::guess_format(bytes).ok();
    let Some(format) = format.filter(|f| [ImageFormat::Png, ImageFormat::Jpeg].contains(f)) else {
        return Err("is neither a PNG nor a JPEG image; save it as one of them".into());
    };
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(LONGEST), Some(LONGEST));
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(|e| plain(&e))?;
    let (width, height) = decoder.dimensions();
    if width.max(height) > LONGEST {
        return Err(too_large());
    }
    budget.take_texels([width, height])?;
    let image = DynamicImage::from_decoder(decoder).map_err(|e| plain(&e))?;
    let texels = image.into_rgba8().pixels().map(|p| p.0).collect();
    Ok(([width, height], texels))
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
