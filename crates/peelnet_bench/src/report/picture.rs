use crate::EvalError;
use base64::{Engine as _, engine::general_purpose::STANDARD};
use image::{DynamicImage, ImageFormat, ImageReader, Limits, imageops::FilterType};
use maud::{Markup, html};
use std::{io::Cursor, path::Path};

/// Sides of a picture: no adapter draws a larger one.
const LONGEST: u32 = 16_384;

/// A picture file; `None` where it does not exist.
pub(crate) fn read(path: &Path) -> Result<Option<DynamicImage>, EvalError> {
    let decoded = || {
        let mut reader = ImageReader::open(path)?.with_guessed_format()?;
        let mut limits = Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(LONGEST), Some(LONGEST));
        limits.max_alloc = Some(1 << 30);
        reader.limits(limits);
        reader.decode()
    };
    let picture = path.exists().then(decoded).transpose();
    picture.map_err(EvalError::io(path, "read the picture"))
}

/// A picture as `data:` URI, shrunk to at most `width` pixels; `path` is where it came from, for errors.
pub(crate) fn data_uri(
    path: &Path,
    picture: &DynamicImage,
    width: u32,
) -> Result<String, EvalError> {
    let shown = match picture.width() > width {
        true => &picture.resize(width, u32::MAX, FilterType::Triangle),
        false => picture,
    };
    let mut png = Cursor::new(Vec::new());
    let written = shown.to_rgb8().write_to(&mut png, ImageFormat::Png);
    written.map_err(EvalError::io(path, "shrink the picture"))?;
    Ok(png_uri(png.get_ref()))
}

/// The bytes of a PNG file as `data:` URI.
pub(crate) fn png_uri(png: &[u8]) -> String {
    format!("data:image/png;base64,{}", STANDARD.encode(png))
}

pub(crate) fn figure(uri: &str, caption: &str) -> Markup {
    html! {
        figure {
            img loading="lazy" src=(uri) alt=(caption);
            figcaption { (caption) }
        }
        "\n"
    }
}

/// A picture file with its caption; `None` where it does not exist.
pub(crate) fn figure_of(
    path: &Path,
    width: u32,
    caption: &str,
) -> Result<Option<Markup>, EvalError> {
    let uri = read(path)?.map(|picture| data_uri(path, &picture, width));
    Ok(uri.transpose()?.map(|uri| figure(&uri, caption)))
}
