//! Draws every view of a scene exactly and with each method, and measures the differences.

use crate::transmittance::Sample;
use crate::{
    EvalError, Row, check_stop, contours::Pairs, each_once, metrics, perceptual::Displayed,
    settings_hash,
};
use peelnet_gpu::{Gpu, GpuError, record::PassTime};
use peelnet_model::Model;
use peelnet_render::{
    Frame, Image, LearnedWeight, MethodOptions, MethodSpec, Prepared, Profile, RenderError,
    Renderer, Role, milliseconds, of_method,
};
use peelnet_scene::Scene;
use std::path::Path;
use std::sync::atomic::AtomicBool;

/// The method that judges all others.
pub const EXACT: &str = Role::Reference.method();

/// What errors of the drawing of [`Pairs`] name in place of a method.
pub(crate) const SURFACES: &str = "surfaces";

/// What is drawn.
#[derive(Clone, Debug)]
pub struct Plan<'a> {
    /// Width and height of every frame, pixels.
    pub size: [u32; 2],
    /// Samples a pixel, 1 or 4, of all methods and of the exact image that judges them.
    pub samples: u32,
    /// Methods in addition to the exact one; the exact one may be among them.
    pub methods: &'a [MethodSpec],
    /// Weights for the learned methods among them, found by recipe.
    pub learned: &'a [LearnedWeight],
    /// The models of those weights; the estimates of those given here are judged fragment by fragment.
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

    /// Frames of each method and view: the compared one, and where any are timed one more to warm up.
    pub const fn frames_of_each(&self) -> usize {
        match self.frames {
            0 => 1,
            n => n as usize + 2,
        }
    }

    fn options(&self) -> MethodOptions {
        MethodOptions::sized(self.size).sampled(self.samples)
    }

    /// How many views of a scene are drawn.
    pub fn views_of(&self, scene: &Scene) -> usize {
        let all = scene.views.len();
        self.views.map_or(all, |n| n.min(all))
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
            let hash = settings_hash(&text.into());
            // No escape begins with h.
            plain = format!("{}_h{}", &plain[..MAX_NAME - 34], &hash[..32]);
        }
        plain
    };
    format!("{}-{}.png", plain(scene), plain(method))
}

/// What happens while methods are compared.
#[derive(Debug)]
pub enum Event<'a> {
    /// A frame was drawn with this method.
    Drawn(&'a str),
    /// A method was left out from here on, and why.
    LeftOut(&'a str, String),
    /// A view is done: its rows, the exact method's first.
    View(Vec<Row>),
}

/// Compares every method of the plan on every view of a scene except those in `done`, and reports frames and views.
///
/// # Errors
/// If a method cannot draw or a picture cannot be written, or what `notify` returns; [`EvalError::Interrupted`] once `stop` is
/// set.
pub fn compare(
    gpu: &Gpu,
    scene: &Scene,
    plan: &Plan<'_>,
    done: &[u32],
    stop: &AtomicBool,
    notify: &mut dyn FnMut(Event<'_>) -> Result<(), EvalError>,
) -> Result<(), EvalError> {
    let left: Vec<usize> = (0..plan.views_of(scene))
        .filter(|&view| !done.contains(&(view as u32)))
        .collect();
    if left.is_empty() {
        return Ok(());
    }
    if let Some(folder) = plan.images {
        std::fs::create_dir_all(folder).map_err(EvalError::io(folder, "create the folder"))?;
    }
    let renderer = Renderer::new(gpu, scene).map_err(EvalError::render(&scene.name, "upload"))?;
    let stage = Stage {
        gpu,
        scene,
        plan,
        renderer,
        stop,
    };
    let mut entries = stage.prepare(notify)?;
    let mut sample = Sample::new(gpu, scene, plan.size)?;
    for view in left {
        let mut rows = stage.draw(view, &mut entries, &mut sample, notify)?;
        stage.time(view, &mut entries, &mut rows, notify)?;
        notify(Event::View(rows))?;
    }
    Ok(())
}

/// A method ready to draw.
struct Entry<'a> {
    name: String,
    method: MethodSpec,
    model: Option<&'a Model>,
    /// None of a method that is composited on the CPU.
    prepared: Option<Prepared>,
}

/// A scene that methods are compared on.
struct Stage<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    plan: &'a Plan<'a>,
    renderer: Renderer,
    stop: &'a AtomicBool,
}

impl<'a> Stage<'a> {
    fn failed(&self, method: &str) -> impl FnOnce(RenderError) -> EvalError + use<> {
        EvalError::render(&self.scene.name, method)
    }

    /// The exact method first, so that its image is there for all others.
    fn prepare(
        &self,
        notify: &mut dyn FnMut(Event<'_>) -> Result<(), EvalError>,
    ) -> Result<Vec<Entry<'a>>, EvalError> {
        let plan = self.plan;
        let exact: MethodSpec = EXACT.parse().map_err(self.failed(EXACT))?;
        let others = plan.methods.iter().filter(|m| m.to_string() != EXACT);
        let mut entries = Vec::new();
        for method in std::iter::once(&exact).chain(others) {
            let name = method.to_string();
            let mut learned = plan.learned.iter();
            let learned = learned.find(|l| l.recipe.method == method.name());
            let mut models = plan.models.iter();
            let mut entry = Entry {
                name,
                method: method.clone(),
                model: models.find(|m| m.meta.recipe.method == method.name()),
                prepared: None,
            };
            if method.method().cpu_only.is_some() {
                if plan.samples > 1 {
                    let why = "it is composited on the CPU, of one sample a pixel".to_owned();
                    notify(Event::LeftOut(&entry.name, why))?;
                } else {
                    entries.push(entry);
                }
                continue;
            }
            let prepared = match self.renderer.method(method, plan.options().with(learned)) {
                Err(e) if plan.lenient && is_too_large(&e) && !entries.is_empty() => {
                    notify(Event::LeftOut(&entry.name, e.to_string()))?;
                    continue;
                }
                prepared => prepared.map_err(self.failed(&entry.name))?,
            };
            entry.prepared = Some(prepared);
            entries.push(entry);
        }
        Ok(entries)
    }

    /// The neighbours of a view that show the same surfaces; none where they need more memory than there is. What it takes is free again
    /// before the methods draw.
    fn pairs(&self, view: usize) -> Result<Option<Pairs>, EvalError> {
        let (size, samples) = (self.plan.size, self.plan.samples);
        match Pairs::drawn(&self.renderer, size, samples, &self.scene.views[view]) {
            Err(e) if is_too_large(&e) => Ok(None),
            pairs => pairs.map(Some).map_err(self.failed(SURFACES)),
        }
    }

    /// Draws a view with every method and compares it with the exact image: a row each. Methods that turn out too large are removed.
    fn draw(
        &self,
        view: usize,
        entries: &mut Vec<Entry<'a>>,
        sample: &mut Sample<'_>,
        notify: &mut dyn FnMut(Event<'_>) -> Result<(), EvalError>,
    ) -> Result<Vec<Row>, EvalError> {
        let camera = &self.scene.views[view];
        let stacks = sample.peel(view)?;
        let pairs = self.pairs(view)?;
        let mut exact: Option<(Image, Displayed)> = None;
        let mut rows: Vec<Row> = Vec::new();
        while let Some(entry) = entries.get_mut(rows.len()) {
            check_stop(self.stop)?;
            let name = &entry.name;
            let drawn = if let Some(prepared) = &mut entry.prepared {
                self.renderer.image(prepared, camera)
            } else {
                let (image, _) = exact.as_ref().expect("the exact method has passes");
                Ok(sample.composite(view, &entry.method, image)?)
            };
            let frame = match drawn {
                Err(e) if self.plan.lenient && is_too_large(&e) && !rows.is_empty() => {
                    notify(Event::LeftOut(name, e.to_string()))?;
                    entries.remove(rows.len());
                    continue;
                }
                frame => frame.map_err(self.failed(name))?,
            };
            if let (0, Some(folder)) = (view, self.plan.images) {
                let path = folder.join(image_name(&self.scene.name, name));
                frame.image.save(&path).map_err(self.failed(name))?;
            }
            let shown = Displayed::new(&frame.image);
            let (against, displayed) = exact
                .as_ref()
                .map_or((&frame.image, &shown), |(image, shown)| (image, shown));
            let differences = metrics::differences(&against.pixels, &frame.image.pixels)?;
            let mut row = row(self.gpu, self.scene, name, view, &frame, differences);
            row.samples = self.plan.samples;
            row.ssim = shown.ssim(displayed);
            if let Some(pairs) = &pairs {
                let errors = metrics::error_image(&against.pixels, &frame.image.pixels)?;
                row.contour_pairs = pairs.share(&errors)?;
            }
            row.transmittance_error = stacks.error(&entry.method, entry.model);
            row.flip = Some(shown.flip(displayed));
            // Only the exact method knows the fragments of a view for certain.
            if let Some(first) = rows.first() {
                (row.fragments, row.max_layers) = (first.fragments, first.max_layers);
            }
            rows.push(row);
            if exact.is_none() {
                exact = Some((frame.image, shown));
            }
            notify(Event::Drawn(name))?;
        }
        Ok(rows)
    }

    /// Times the view, all methods in turn, so that whatever else the machine does affects all of them alike.
    fn time(
        &self,
        view: usize,
        entries: &mut [Entry<'_>],
        rows: &mut [Row],
        notify: &mut dyn FnMut(Event<'_>) -> Result<(), EvalError>,
    ) -> Result<(), EvalError> {
        let camera = &self.scene.views[view];
        let mut frames: Vec<Vec<Profile>> = vec![Vec::new(); entries.len()];
        if self.plan.frames == 0 {
            return Ok(());
        }
        for number in 0..=self.plan.frames {
            for (entry, frames) in entries.iter_mut().zip(&mut frames) {
                check_stop(self.stop)?;
                let Some(prepared) = &mut entry.prepared else {
                    continue;
                };
                let timed = self.renderer.profile(prepared, camera);
                let timed = timed.map_err(self.failed(&entry.name))?;
                // The first is the warm-up: until then the method drew images.
                if number > 0 {
                    frames.push(timed);
                }
                notify(Event::Drawn(&entry.name))?;
            }
        }
        for (row, frames) in rows.iter_mut().zip(&frames) {
            // Of what is composited on the CPU there are none.
            if !frames.is_empty() {
                put_times(row, frames);
            }
        }
        Ok(())
    }
}

/// Whether it is memory that a frame lacks: another adapter, or a smaller frame, has it.
pub(crate) fn is_too_large(error: &RenderError) -> bool {
    matches!(
        error,
        RenderError::Gpu(GpuError::TooLarge { .. } | GpuError::OutOfMemory { .. })
    )
}

/// Median, least and 90th percentile of a method's frames; passes and bytes as they were timed.
fn put_times(row: &mut Row, frames: &[Profile]) {
    let sorted = |time: &dyn Fn(&Profile) -> f64| {
        let mut times: Vec<f64> = frames.iter().map(time).collect();
        times.sort_by(f64::total_cmp);
        times
    };
    // Nearest rank.
    let rank = |times: &[f64], share: f64| {
        let i = (share * times.len() as f64).ceil() as usize;
        times.get(i.max(1) - 1).copied()
    };
    let times = sorted(&method_ms);
    row.time_ms = rank(&times, 0.5);
    row.time_ms_min = times.first().copied();
    row.time_ms_p90 = rank(&times, 0.9);
    row.wall_ms = rank(&sorted(&|frame| frame.wall_micros / 1e3), 0.5);
    let passes: Vec<_> = frames.iter().map(|f| of_method(&f.times)).collect();
    row.time_by_pass = medians_by_pass(&passes);
    if let Some(Profile { stats, .. }) = frames.first() {
        row.passes = stats.geometry_passes + stats.fullscreen_passes;
        row.bytes_per_pixel = Some(stats.bytes_per_pixel);
    }
}

/// GPU time of a method's passes; without timestamps the clock time of the frame.
pub(crate) fn method_ms(frame: &Profile) -> f64 {
    milliseconds(&of_method(&frame.times)).unwrap_or(frame.wall_micros / 1e3)
}

/// Median over frames of each pass's time: `name=ms`, by first appearance, passes of one name summed in each frame.
fn medians_by_pass(frames: &[Vec<PassTime>]) -> String {
    let names = each_once(frames.iter().flatten().map(|pass| pass.label.as_str()));
    let median = |name: &str| {
        let mut sums: Vec<f64> = frames
            .iter()
            .map(|passes| {
                let of_name = passes.iter().filter(|p| p.label == name);
                of_name.map(|p| p.micros / 1e3).sum()
            })
            .collect();
        sums.sort_by(f64::total_cmp);
        sums[(sums.len() - 1) / 2]
    };
    let parts: Vec<String> = names
        .iter()
        .map(|name| format!("{}={:.4}", name.replace(' ', "-"), median(name)))
        .collect();
    parts.join(" ")
}

fn row(
    gpu: &Gpu,
    scene: &Scene,
    method: &str,
    view: usize,
    frame: &Frame,
    d: metrics::Differences,
) -> Row {
    // A method on the CPU has no passes, and no times of its own.
    let drawn = frame.stats.fullscreen_passes + frame.stats.geometry_passes > 0;
    Row {
        method: method.to_owned(),
        scene: scene.name.clone(),
        view: u32::try_from(view).unwrap_or(u32::MAX),
        width: frame.image.width,
        height: frame.image.height,
        fragments: frame.stats.fragments,
        max_layers: frame.stats.max_layers,
        lost: frame.stats.fragments.map(|_| frame.stats.lost),
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
        time_ms: milliseconds(&of_method(&frame.times)),
        wall_ms: drawn.then_some(frame.wall_micros / 1e3),
        time_by_pass: medians_by_pass(&[of_method(&frame.times)]),
        passes: frame.stats.geometry_passes + frame.stats.fullscreen_passes,
        bytes_per_pixel: drawn.then_some(frame.stats.bytes_per_pixel),
        adapter: gpu.info.name.clone(),
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
        let scenes = [
            "a/b",
            "a_b",
            "a:b",
            "A",
            "a",
            "ä",
            "Ä",
            "a_2fb",
            "",
            ".",
            &long,
            &long[1..],
        ];
        let curve = MethodSpec::curve();
        let methods: Vec<String> = curve.iter().map(ToString::to_string).collect();
        let pairs = scenes
            .iter()
            .flat_map(|s| methods.iter().map(move |m| (s, m)));
        let names: BTreeSet<String> = pairs
            .map(|(scene, method)| image_name(scene, method).to_lowercase())
            .collect();
        assert_eq!(names.len(), scenes.len() * methods.len());
        assert!(
            names
                .iter()
                .all(|n| n.len() < 255 && !n.contains(['/', '\\', ':']))
        );
        // A '-' stands between the names: no method's name ends in another one's behind a '-'.
        for method in METHODS {
            let ending = format!("-{}", method.name);
            assert!(
                METHODS.iter().all(|m| !m.name.ends_with(&ending)),
                "{ending}"
            );
        }
    }
}
