//! The page of `peelnet extract --preview`: what an extraction would write.

use crate::EvalError;
use crate::preview::{Preview, ScenePreview};
use crate::report::{
    Files, Measurement, Results, Table, page,
    picture::{figure, png_uri},
};
use maud::{Markup, html};
use peelnet_core::files::{counted, printable, thousands};
use peelnet_render::ImageFormat;
use std::path::Path;

impl Measurement for Preview {
    const FILES: Files<Self> = &[("preview.html", Results::<Self>::page)];
}

impl Results<Preview> {
    /// The sums, in a sentence or two.
    pub fn text(&self) -> String {
        let p = &self.measured;
        let lost = match p.lost_fragments {
            0 => String::new(),
            n => format!(" Peeling leaves {} out.", counted(n, "fragment")),
        };
        format!(
            "{} of {} in {}. About {} as {}, estimated from {}.{lost} No dataset was written.",
            counted(p.rows, "row"),
            counted(p.pixels, "pixel"),
            counted(p.parts, "part"),
            match p.expected_bytes {
                few if few < 1_000_000 => counted(few, "byte"),
                many => format!("{:.1} MB", many as f64 / 1e6),
            },
            p.format,
            counted(p.sampled_rows, "row"),
        )
    }

    /// A line for each scene.
    pub fn table(&self) -> Table {
        Table::from_rows(
            &self.measured.scenes,
            &[
                ("scene", &|s| printable(&s.name).into_owned()),
                ("views", &|s| thousands(s.views)),
                ("parts", &|s| thousands(s.parts)),
                ("rows", &|s| thousands(s.rows)),
                ("pixels with rows", &|s| thousands(s.pixels)),
                ("rows a pixel", &|s| match s.pixels {
                    0 => "–".to_owned(),
                    n => format!("{:.2}", s.rows as f64 / n as f64),
                }),
                ("held out", &|s| {
                    ["no", "yes"][usize::from(s.held_out)].to_owned()
                }),
            ],
        )
    }

    fn page(&self, _: &Path) -> Result<String, EvalError> {
        let scenes = self.measured.scenes.iter().map(of_scene);
        let scenes = scenes.collect::<Result<Vec<_>, _>>()?;
        let [width, height] = self.measured.size;
        let body = html! {
            p { (self.text()) }
            p.note {
                "A part is one view of one scene, or of a varied copy of it, peeled at " (width) "x" (height) ". Rows are exact: they were peeled and \
                 counted. Pictures show the scenes themselves, drawn exactly; histograms count the rows of all parts. Point at a bar for its figures."
            }
            (self.table().html("", |_| false))
            @for scene in scenes { (scene) }
        };
        Ok(page::page(
            self,
            "Preview of an extraction",
            body,
            &[],
            None,
        ))
    }
}

fn of_scene(scene: &ScenePreview) -> Result<Markup, EvalError> {
    let picture = |(k, image): (usize, &peelnet_render::Image)| {
        let png = image.encoded(ImageFormat::Png);
        let png = png.map_err(EvalError::at(format!("scene '{}'", scene.name)))?;
        Ok(figure(&png_uri(&png), &format!("view {k}")))
    };
    let pictures = scene.pictures.iter().enumerate().map(picture);
    let pictures = pictures.collect::<Result<Vec<_>, EvalError>>()?;
    let left_out = scene.views - pictures.len() as u64;
    Ok(html! {
        h2 { (printable(&scene.name)) }
        div.gallery { @for picture in pictures { (picture) } }
        @if left_out > 0 { p.note { (counted(left_out, "more view")) " without a picture." } }
        @if scene.rows == 0 {
            p { "No rows: nothing transparent is seen." }
        } @else {
            div.gallery {
                (page::histogram("rows by linear depth, scene units", &scene.depth, "rows"))
                (page::histogram("rows by alpha", &scene.alpha, "rows"))
                (page::histogram("pixels by their number of fragments", &scene.fragments_per_pixel, "pixels"))
            }
        }
        "\n"
    })
}
