//! Draws every view of a scene exactly and with each method, and measures the differences.

use crate::{
    EvalError, Partial, Row,
    contours::Pairs,
    front::BASE,
    json_hash,
    metrics::{differences, error_image},
    perceptual::Displayed,
    rows::each_once,
    stage::{Ready, Stage, Watch, exact_method, in_turn, percentile},
    transmittance::Peeled,
};
use peelnet_model::{Model, Recipe};
use peelnet_render::gpu::{Gpu, record::PassTime};
use peelnet_render::{
    Frame, Image, LearnedWeight, MethodOptions, MethodSpec, Profile, milliseconds, of_method,
};
use peelnet_scene::Scene;
use sha2::{Digest as _, Sha256};
use std::{path::Path, sync::LazyLock};

pub use crate::stage::EXACT;

#[derive(Clone, Debug)]
pub struct Plan<'a> {
    pub size: [u32; 2],
    /// Samples a pixel, 1 or 4, of all methods and of the exact image that they are compared with.
    pub samples: u32,
    /// Methods in addition to the exact one; the exact one may be among them.
    pub methods: &'a [MethodSpec],
    /// Weights for the learned methods among them, found by recipe.
    pub learned: &'a [LearnedWeight],
    /// The models of those weights; the estimates of those given here are compared fragment by fragment.
    pub models: &'a [Model],
    /// Whether a method that needs more than this adapter allows is left out and reported, instead of ending the comparison.
    pub lenient: bool,
    /// Views of each scene; all of them when none.
    pub views: Option<usize>,
    /// Frames of each method and view that are timed, after the comparison and all methods in turn.
    pub frames: u32,
    /// Where view 0 of every method is saved as `<scene>-<method>.png`.
    pub images: Option<&'a Path>,
}

impl<'a> Plan<'a> {
    /// These methods on all views, five timed frames each, without networks and pictures.
    pub fn new(size: [u32; 2], methods: &'a [MethodSpec]) -> Self {
        Self {
            size,
            samples: 1,
            methods,
            learned: &[],
            models: &[],
            lenient: false,
            views: None,
            frames: 5,
            images: None,
        }
    }

    /// How a method is drawn, with its network where it is among those of the plan.
    pub(crate) fn options(&self, method: &MethodSpec) -> MethodOptions {
        let mut learned = self.learned.iter();
        let learned = learned.find(|l| l.recipe.method == method.name());
        let options = MethodOptions::sized(self.size);
        options.sampled(self.samples).with(learned)
    }

    pub fn views_of(&self, scene: &Scene) -> usize {
        self.views.unwrap_or(scene.views.len())
    }
}

/// Most characters of a name in a file's name; file systems take 255 in all.
const MAX_NAME: usize = 100;

/// File name of a method's picture of a scene: another one for every pair of names, on every file system.
///
/// Digits, small letters, '-' and '.' stay; any other byte becomes '_' and two hexadecimal digits, because some file systems refuse ':' and
/// '=', and some take `A` for `a`. A long name ends in its hash.
pub fn image_name(scene: &str, method: &str) -> String {
    let plain = |text: &str| -> String {
        let mut plain = String::new();
        for byte in text.bytes() {
            if byte.is_ascii_digit() || byte.is_ascii_lowercase() || matches!(byte, b'-' | b'.') {
                plain.push(char::from(byte));
            } else {
                plain.push_str(&format!("_{byte:02x}"));
            }
        }
        if plain.len() > MAX_NAME {
            let hash = json_hash(&text);
            // No escape begins with h.
            plain = format!("{}_h{}", &plain[..MAX_NAME - 34], &hash[..32]);
        }
        plain
    };
    // `x-deep` drawn by `one` is not `x` drawn by `deep-one`.
    let scene = plain(scene);
    let scene = match scene.strip_suffix("-deep") {
        Some(before) => format!("{before}_2ddeep"),
        None => scene,
    };
    // Files whose names begin with a point are hidden.
    let scene = match scene.strip_prefix('.') {
        Some(rest) => format!("_2e{rest}"),
        None => scene,
    };
    format!("{scene}-{}.png", plain(method))
}

/// Bytes of a picture file that are read.
const MOST_OF_PICTURE: u64 = 1 << 30;

fn picture_hash(path: &Path) -> Result<String, EvalError> {
    let bytes = peelnet_core::files::read(path, MOST_OF_PICTURE);
    let bytes = bytes.map_err(EvalError::io(path, "read the picture"))?;
    Ok(peelnet_core::files::hex(&Sha256::digest(bytes)))
}

/// Checks that the pictures in a folder of results are those of its rows. Pictures that are missing are left out of reports.
///
/// # Errors
/// A picture of another run.
pub fn check_pictures(rows: &[Row], folder: &Path) -> Result<(), EvalError> {
    for row in rows {
        let path = folder
            .join("images")
            .join(image_name(&row.scene, &row.method));
        if !path.exists() {
            continue;
        }
        // Its header says the size, before anything is decoded.
        let size = image::image_dimensions(&path);
        let is_sized = size.is_ok_and(|size| size == (row.width, row.height));
        let is_drawn = match &row.picture {
            Some(drawn) if is_sized => picture_hash(&path)? == *drawn,
            _ => is_sized,
        };
        if !is_drawn {
            return Err(EvalError::OtherPicture(path));
        }
    }
    Ok(())
}

/// SHA-256 of all shaders of this program.
static SHADERS: LazyLock<String> = LazyLock::new(|| json_hash(&peelnet_render::shaders::SOURCES));

/// Methods of which rows were drawn by other shaders than this program's, or with a network that does not ship.
pub fn drawn_otherwise(rows: &[Row]) -> Vec<&str> {
    let shipped = Recipe::ALL
        .iter()
        .filter_map(|&r| Model::shipped(r).ok()?.hash().ok());
    let shipped: Vec<String> = shipped.collect();
    let is_own = |row: &&Row| {
        row.shaders == *SHADERS && row.network.iter().all(|network| shipped.contains(network))
    };
    each_once(
        rows.iter()
            .filter(|row| !is_own(row))
            .map(|row| row.method.as_str()),
    )
}

struct Entry<'a> {
    method: MethodSpec,
    name: String,
    model: Option<&'a Model>,
    /// Its hash.
    network: Option<String>,
    /// None of a method that is composited on the CPU.
    ready: Option<Ready>,
}

/// Compares every method of the plan on the views of a scene that `partial` lacks, and adds their rows, the exact method's first.
pub(crate) fn compare(
    gpu: &Gpu,
    scene: &Scene,
    plan: &Plan<'_>,
    partial: &mut Partial,
    watch: &mut Watch<'_>,
) -> Result<(), EvalError> {
    let done = partial.done(&scene.name);
    let left = (0..plan.views_of(scene)).filter(|&view| !done.contains(&(view as u32)));
    let left: Vec<usize> = left.collect();
    if left.is_empty() {
        return Ok(());
    }
    if let Some(folder) = plan.images {
        std::fs::create_dir_all(folder).map_err(EvalError::io(folder, "create the folder"))?;
    }
    let stage = Stage::new(gpu, scene)?;
    let mut entries = prepare(&stage, plan, watch)?;
    // Fragments of coloured transmission have no single opacity.
    let peeled = (!scene.is_tinted()).then(|| Peeled::new(gpu, scene, plan.size, true));
    let mut peeled = peeled.transpose()?;
    for view in left {
        let mut rows = draw(&stage, plan, view, &mut entries, &mut peeled, watch)?;
        if plan.frames > 0 {
            time(&stage, plan.frames, view, &mut entries, &mut rows, watch)?;
        }
        for (row, entry) in rows.iter_mut().zip(&entries) {
            row.adapter.clone_from(&gpu.info.name);
            row.shaders.clone_from(&SHADERS);
            row.network.clone_from(&entry.network);
            row.scene_content.clone_from(&scene.content);
        }
        partial.push(rows)?;
    }
    Ok(())
}

/// The exact method first, so that its image is there for all others.
fn prepare<'a>(
    stage: &Stage<'_>,
    plan: &Plan<'a>,
    watch: &mut Watch<'_>,
) -> Result<Vec<Entry<'a>>, EvalError> {
    let scene = &stage.scene.name;
    let exact = exact_method();
    let others = plan.methods.iter().filter(|m| **m != exact);
    // Nobody named the base of the times.
    let is_lenient = |name: &str| plan.lenient || name == BASE;
    let mut entries = Vec::new();
    for method in std::iter::once(&exact).chain(others) {
        let name = method.to_string();
        let mut ready = None;
        if method.method().cpu_only.is_none() {
            match stage.ready(method, plan.options(method)) {
                Err(e) if is_lenient(&name) && e.is_of_method() && !entries.is_empty() => {
                    watch.left_out(scene, &name, &e.reason());
                    continue;
                }
                prepared => ready = Some(prepared?),
            }
        } else if let Err(why) = method.check_scene(stage.scene) {
            watch.left_out(scene, &name, &why.to_string());
            continue;
        } else if plan.samples > 1 {
            let why = "it is composited on the CPU, of one sample a pixel";
            watch.left_out(scene, &name, why);
            continue;
        } else if stage.scene.transparency_scale < 1.0 {
            let why = "it is composited on the CPU, at full resolution";
            watch.left_out(scene, &name, why);
            continue;
        }
        let mut models = plan.models.iter();
        let model = models.find(|m| m.meta.recipe.method == method.name());
        entries.push(Entry {
            method: method.clone(),
            name,
            model,
            network: model.and_then(|m| m.hash().ok()),
            ready,
        });
    }
    Ok(entries)
}

/// Draws a view with every method and compares it with the exact image: a row each. Methods that turn out too large are removed.
fn draw(
    stage: &Stage<'_>,
    plan: &Plan<'_>,
    view: usize,
    entries: &mut Vec<Entry<'_>>,
    peeled: &mut Option<Peeled<'_>>,
    watch: &mut Watch<'_>,
) -> Result<Vec<Row>, EvalError> {
    let scene = &stage.scene.name;
    let camera = &stage.scene.views[view];
    let stacks = peeled.as_mut().map(|peeled| peeled.stacks(view));
    let stacks = stacks.transpose()?;
    let pairs = Pairs::where_they_fit(stage, plan.size, plan.samples, camera)?;
    let mut exact: Option<(Image, Displayed)> = None;
    let mut rows: Vec<Row> = Vec::new();
    while let Some(entry) = entries.get_mut(rows.len()) {
        watch.check()?;
        let name = &entry.name;
        let drawn = match (&mut entry.ready, &exact, &mut *peeled) {
            (Some(ready), ..) => stage.image(ready, camera),
            (None, Some((image, _)), Some(peeled)) => peeled.composite(view, &entry.method, image),
            (None, ..) => unreachable!("the exact method has passes, and others are left out"),
        };
        let frame = match drawn {
            Err(e) if plan.lenient && e.is_of_method() && !rows.is_empty() => {
                watch.left_out(scene, name, &e.reason());
                entries.remove(rows.len());
                continue;
            }
            frame => frame?,
        };
        if exact.is_none() {
            stage.check_exact(&frame.image)?;
        }
        let mut picture = None;
        if let (0, Some(folder)) = (view, plan.images) {
            let path = folder.join(image_name(scene, name));
            frame.image.save(&path).map_err(stage.failed(name))?;
            picture = Some(picture_hash(&path)?);
        }
        let shown = Displayed::new(&frame.image);
        let (against, displayed) = exact
            .as_ref()
            .map_or((&frame.image, &shown), |(image, shown)| (image, shown));
        let errors = error_image(&against.pixels, &frame.image.pixels);
        let mut row = Row {
            method: name.clone(),
            scene: scene.clone(),
            view: view as u32,
            samples: plan.samples,
            picture,
            ssim: shown.ssim(displayed),
            flip: Some(shown.flip(displayed)),
            transmittance_error: stacks
                .as_ref()
                .and_then(|s| s.error(&entry.method, entry.model)),
            contour_pairs: pairs.as_ref().and_then(|pairs| pairs.share(&errors)),
            ..row(&frame, &against.pixels)
        };
        // Only the exact method knows the fragments of a view for certain.
        if let Some(first) = rows.first() {
            (row.fragments, row.max_layers) = (first.fragments, first.max_layers);
        }
        rows.push(row);
        exact.get_or_insert((frame.image, shown));
        watch.drawn(scene, name);
    }
    Ok(rows)
}

/// Times the view, all methods in turn: median, least and 90th percentile of a method's frames; passes and bytes as they were timed.
fn time(
    stage: &Stage<'_>,
    frames: u32,
    view: usize,
    entries: &mut [Entry<'_>],
    rows: &mut [Row],
    watch: &mut Watch<'_>,
) -> Result<(), EvalError> {
    // What is composited on the CPU has no time.
    let timed = entries.iter_mut().zip(rows);
    let timed = timed.filter_map(|(e, row)| Some(((stage, e.ready.as_mut()?), row)));
    let (mut ready, rows): (Vec<_>, Vec<_>) = timed.unzip();
    let frames = in_turn(&mut ready, &stage.scene.views[view], frames, watch)?;
    for (row, frames) in rows.into_iter().zip(&frames) {
        let times = || frames.iter().map(method_ms);
        row.time_ms = percentile(times(), 0.5);
        row.time_ms_min = times().reduce(f64::min);
        row.time_ms_p90 = percentile(times(), 0.9);
        row.wall_ms = percentile(frames.iter().map(|f| f.wall_micros / 1e3), 0.5);
        let passes: Vec<_> = frames.iter().map(|f| of_method(&f.times)).collect();
        row.time_by_pass = medians_by_pass(&passes);
        if let Some(Profile { stats, .. }) = frames.first() {
            row.passes = stats.geometry_passes + stats.fullscreen_passes;
            row.bytes_per_pixel = Some(stats.bytes_per_pixel);
        }
    }
    Ok(())
}

/// GPU time of a method's passes; without timestamps the clock time of the frame.
pub(crate) fn method_ms(frame: &Profile) -> f64 {
    milliseconds(&of_method(&frame.times)).unwrap_or(frame.wall_micros / 1e3)
}

/// Median over frames of each pass's time: `name=ms`, by first appearance, passes of one name summed in each frame.
fn medians_by_pass(frames: &[Vec<PassTime>]) -> String {
    let names = each_once(frames.iter().flatten().map(|pass| pass.label.as_str()));
    let parts = names.iter().map(|name| {
        let sums = frames.iter().map(|passes| {
            let of_name = passes.iter().filter(|p| p.label == *name);
            of_name.map(|p| p.micros / 1e3).sum()
        });
        let median = percentile(sums, 0.5).unwrap_or_default();
        format!("{}={median:.4}", name.replace(' ', "-"))
    });
    parts.collect::<Vec<_>>().join(" ")
}

fn row(frame: &Frame, exact: &[[f32; 4]]) -> Row {
    let (d, stats) = (differences(exact, &frame.image.pixels), &frame.stats);
    let passes = stats.geometry_passes + stats.fullscreen_passes;
    // A method on the CPU has no passes, and no times of its own.
    let drawn = passes > 0;
    Row {
        width: frame.image.width,
        height: frame.image.height,
        fragments: stats.fragments,
        max_layers: stats.max_layers,
        lost: stats.fragments.map(|_| stats.lost),
        mse_linear: d.mse_linear,
        mse_linear_covered: d.mse_linear_covered,
        mse255: d.mse255,
        mse255_covered: d.mse255_covered,
        psnr: d.psnr,
        p99_error: d.p99_error,
        max_error: d.max_error,
        covered_pixels: d.covered_pixels,
        dark_pixels: d.dark_pixels,
        non_finite_pixels: d.non_finite_pixels,
        passes,
        bytes_per_pixel: drawn.then_some(stats.bytes_per_pixel),
        ..Row::default()
    }
}

#[cfg(test)]
mod tests {
    use super::image_name;
    use peelnet_render::{METHODS, MethodSpec};
    use std::collections::BTreeSet;

    /// Names that differ have files that differ, also where case is ignored.
    #[test]
    fn names_that_differ_have_pictures_that_differ() {
        let long = "x".repeat(5000);
        let mut scenes: Vec<&str> = "a/b a_b a:b A a ä Ä a_2fb . a-deep a_2ddeep"
            .split(' ')
            .collect();
        scenes.extend(["", &long, &long[1..]]);
        let methods = MethodSpec::curve();
        let mut names = BTreeSet::new();
        for scene in &scenes {
            for method in &methods {
                let name = image_name(scene, &method.to_string()).to_lowercase();
                assert!(!name.starts_with('.'));
                assert!(name.len() < 255 && !name.contains(['/', '\\', ':']));
                names.insert(name);
            }
        }
        assert_eq!(names.len(), scenes.len() * methods.len());
        // A '-' stands between the names: no method's name ends in another one's behind a '-', unless behind `deep-`.
        for method in METHODS {
            let ending = format!("-{}", method.name);
            let mut begins = METHODS.iter().filter_map(|m| m.name.strip_suffix(&ending));
            assert!(begins.all(|begin| begin == "deep"), "{ending}");
        }
    }
}
