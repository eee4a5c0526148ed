use crate::report::ReportError;
use base64::{Engine as _, engine::general_purpose::STANDARD};
use image::{DynamicImage, ImageFormat, imageops::FilterType};
use maud::{Markup, html};
use std::{io::Cursor, path::Path};

/// A picture file; `None` where it does not exist.
pub(crate) fn read(path: &Path) -> Result<Option<DynamicImage>, ReportError> {
    if !path.exists() {
        return Ok(None);
    }
    let picture = image::open(path);
    let failed = ReportError::at(path, "cannot read the picture");
    picture.map(Some).map_err(failed)
}

/// A picture as `data:` URI, shrunk to at most `width` pixels; `path` is where it came from, for errors.
pub(crate) fn data_uri(
    path: &Path,
    picture: &DynamicImage,
    width: u32,
) -> Result<String, ReportError> {
    let shrunk;
    let picture = if picture.width() > width {
        shrunk = picture.resize(width, u32::MAX, FilterType::Triangle);
        &shrunk
    } else {
        picture
    };
    let mut png = Cursor::new(Vec::new());
    let written = picture.to_rgb8().write_to(&mut png, ImageFormat::Png);
    written.map_err(ReportError::at(path, "cannot shrink the picture"))?;
    Ok(format!(
        "data:image/png;base64,{}",
        STANDARD.encode(png.get_ref())
    ))
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
) -> Result<Option<Markup>, ReportError> {
    let Some(picture) = read(path)? else {
        return Ok(None);
    };
    let uri = data_uri(path, &picture, width)?;
    Ok(Some(figure(&uri, caption)))
}
