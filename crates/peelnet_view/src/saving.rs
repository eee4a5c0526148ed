//! What leaves the window: pictures, numbered frames, scene files and shader text.

use crate::{
    app::App,
    eye,
    slot::Slot,
    stage::Stage,
    task::{Fallible, Job, one_line},
};
use peelnet_core::files::shown;
use peelnet_export::{Language, Options};
use peelnet_render::{Image, ImageFormat};
use std::{
    cell::Cell,
    f32::consts::TAU,
    path::{Path, PathBuf},
    rc::Rc,
};

/// What is being saved, and what was.
#[derive(Default)]
pub(crate) struct Output {
    pub job: Job<(), String>,
    /// Frames written, and all.
    pub progress: Rc<Cell<(u32, u32)>>,
}

impl Output {
    pub fn last(&self) -> Option<&Result<String, String>> {
        self.job.get(&())
    }

    /// Says what was done at once.
    fn show(&mut self, result: Fallible<String>) {
        self.job.last = Some(((), result.map_err(|e| one_line(&*e))));
    }
}

impl App {
    /// Draws the view into a file, as `peelnet render` does.
    pub(crate) fn save_picture(&mut self, ending: &str) {
        let Some(stage) = &self.stage else { return };
        let path = free_name(Path::new(""), stage, &self.first, ending);
        let (shot, camera) = (self.first.shot(stage, self.size), self.camera);
        self.output.progress.set((0, 1));
        self.output.job.begin((), async move {
            let image = shot.frame(&camera).await?.image;
            save(&image, &path)
        });
    }

    /// Draws numbered frames into a new folder: of one turn about the target, or of the timeline from its first state to its last.
    pub(crate) fn save_frames(&mut self, timeline: bool, count: u32) {
        let Some(stage) = &self.stage else { return };
        let folder = free_name(Path::new(""), stage, &self.first, "-frames");
        let mut shot = self.first.shot(stage, self.size);
        let (gpu, source, camera) = (stage.gpu.clone(), stage.source.clone(), self.camera);
        let times = stage.times().filter(|_| timeline);
        let progress = Rc::clone(&self.output.progress);
        progress.set((0, count));
        self.output.job.begin((), async move {
            if folder.exists() {
                return Err(format!("{}: is there already", shown(&folder)).into());
            }
            for number in 0..count {
                let mut camera = camera;
                if let Some((from, to)) = times {
                    let share = number as f32 / (count - 1).max(1) as f32;
                    let time = from + share * (to - from);
                    shot.renderer = Stage::open(&gpu, source.clone(), Some(time))?.renderer;
                } else {
                    // The last frame is one step before the first: the film repeats without a pause.
                    eye::orbit(&mut camera, TAU * number as f32 / count as f32, 0.0);
                }
                let image = shot.frame(&camera).await?.image;
                save(&image, &folder.join(format!("{number:05}.png")))?;
                progress.set((number + 1, count));
            }
            Ok(format!("{}: {count} frames", shown(&folder)))
        });
    }

    /// Saves the scene with its changes beside the file it came from, and says what such a file cannot hold.
    pub(crate) fn save_scene(&mut self) {
        let Some(stage) = &self.stage else { return };
        let name = free_name(&stage.source.folder(), stage, &self.first, ".toml");
        let saved = stage.edited(&self.camera).and_then(|edited| {
            let said = keep(&name, edited.text.as_bytes())?;
            Ok(match edited.left_out.join("; without ") {
                left_out if left_out.is_empty() => said,
                left_out => format!("{said}, without {left_out}"),
            })
        });
        self.output.show(saved);
    }

    /// Writes the network that is drawn, and its text as WGSL, into two new files beside the scene.
    pub(crate) fn export_network(&mut self) {
        let (Some(stage), Some(model)) = (&self.stage, self.first.model()) else {
            return;
        };
        let folder = stage.source.folder();
        let names = [".safetensors", ".wgsl"];
        let names = names.map(|ending| free_name(&folder, stage, &self.first, ending));
        let exported = || -> Fallible<String> {
            let text = peelnet_export::wgsl(&model)?;
            let first = keep(&names[0], &model.to_bytes()?)?;
            Ok(format!("{first}, {}", keep(&names[1], text.as_bytes())?))
        };
        let exported = exported();
        if exported.is_ok()
            && self.first.own_network().is_some()
            && let Some(network) = &mut self.first.network
        {
            let [file, _] = names;
            network.path = Some(file);
        }
        self.output.show(exported);
    }

    pub(crate) fn copy_shader(&mut self, ui: &egui::Context, language: Language) {
        let Some(model) = self.first.model() else {
            return;
        };
        let options = Options {
            language,
            ..Options::default()
        };
        let copied = peelnet_export::text(&model, &options).map(|text| {
            let (lines, name) = (text.lines().count(), language.name());
            ui.copy_text(text);
            format!("{lines} lines of {name} are in the clipboard")
        });
        self.output.show(copied.map_err(Into::into));
    }
}

fn save(image: &Image, path: &Path) -> Fallible<String> {
    let format = ImageFormat::from_ending(path)?;
    if cfg!(target_arch = "wasm32") {
        return keep(path, &image.encoded(format)?);
    }
    if format.kind().is_foreign(path).unwrap_or(false) {
        let name = shown(path);
        return Err(format!("{name}: another file has this name; choose another").into());
    }
    image.save(path)?;
    Ok(format!("{} is written", shown(path)))
}

/// Writes a new file; what was written.
#[cfg(not(target_arch = "wasm32"))]
fn keep(path: &Path, bytes: &[u8]) -> Fallible<String> {
    let name = shown(path);
    if path.exists() {
        return Err(format!("{name}: is there already; move it away").into());
    }
    peelnet_core::files::write_whole(path, bytes).map_err(|e| format!("{name}: {e}"))?;
    Ok(format!("{name} is written"))
}

#[cfg(target_arch = "wasm32")]
fn keep(path: &Path, bytes: &[u8]) -> Fallible<String> {
    crate::web::download(path, bytes)?;
    Ok(format!("{} is among your downloads", shown(path)))
}

/// A name for a file of this view that is still free, of letters that every file system takes.
fn free_name(folder: &Path, stage: &Stage, slot: &Slot, ending: &str) -> PathBuf {
    let plain = |text: &str| -> String {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '.';
        let plain = text.chars().map(|c| if is_plain(c) { c } else { '_' });
        plain.take(60).collect()
    };
    let (scene, method) = (plain(&stage.scene.name), plain(&slot.spec.to_string()));
    let numbers = (1..10_000).map(|n| format!("-{n}"));
    let names = std::iter::once(String::new()).chain(numbers);
    let mut paths = names.map(|n| folder.join(format!("{scene}-{method}{n}{ending}")));
    let free = paths.find(|path| !path.exists());
    free.unwrap_or_else(|| folder.join(format!("{scene}-{method}-10000{ending}")))
}
