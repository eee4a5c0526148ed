//! What leaves the window: pictures, numbered frames, shader text, and the command that shows the same again.

use crate::{
    eye,
    slot::{Slot, model_of},
    stage::{Source, Stage, one_line},
    task::Task,
};
use peelnet_export::{Language, Options};
#[cfg(not(target_arch = "wasm32"))]
use peelnet_files::Standing;
use peelnet_files::shown;
use peelnet_render::{
    Image, ImageFormat, LearnedWeight, MethodOptions, MethodSpec, RenderError, Renderer,
};
use peelnet_scene::Camera;
use std::{
    cell::Cell,
    path::{Path, PathBuf},
    rc::Rc,
};

/// What numbered frames go through.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Sequence {
    /// One turn about the target.
    Turntable,
    /// The timeline from its first state to its last.
    Timeline,
}

/// Work that writes files.
#[derive(Debug, Default)]
pub(crate) struct Output {
    task: Option<Task<Result<String, String>>>,
    /// Frames written, and all.
    pub progress: Rc<Cell<(u32, u32)>>,
    /// What was written last.
    pub last: Option<Result<String, String>>,
}

impl Output {
    pub const fn is_busy(&self) -> bool {
        self.task.is_some()
    }

    pub fn cancel(&mut self) {
        self.task = None;
    }

    pub fn poll(&mut self, ui: &egui::Context) {
        if let Some(task) = &mut self.task
            && let Some(result) = task.poll(ui)
        {
            self.last = Some(result);
            self.task = None;
        }
    }

    /// Says what was done at once.
    pub fn say(&mut self, result: Result<String, String>) {
        self.last = Some(result);
    }

    /// Draws the view into a file, as `peelnet render` does.
    pub fn picture(
        &mut self,
        stage: &Stage,
        slot: &Slot,
        camera: Camera,
        size: [u32; 2],
        path: PathBuf,
    ) {
        let drawn = Drawn::of(stage, slot, size);
        let work = async move {
            let image = drawn.image(&camera).await?;
            save(&image, &path)
        };
        self.progress.set((0, 1));
        self.task = Some(Task::new(work));
    }

    /// Draws numbered frames into a new folder.
    pub fn frames(
        &mut self,
        stage: &Stage,
        slot: &Slot,
        camera: Camera,
        size: [u32; 2],
        (sequence, count): (Sequence, u32),
        folder: PathBuf,
    ) {
        let mut drawn = Drawn::of(stage, slot, size);
        let (gpu, source) = (stage.gpu.clone(), stage.source.clone());
        let timeline = &stage.scene().timeline;
        let times = timeline.first().map(|s| s.time).zip(timeline.last());
        let times = times.map(|(from, to)| (from, to.time));
        let progress = Rc::clone(&self.progress);
        progress.set((0, count));
        let work = async move {
            if folder.exists() {
                return Err(format!("{}: is there already", shown(&folder)));
            }
            for number in 0..count {
                let mut camera = camera;
                match (sequence, times) {
                    (Sequence::Turntable, _) => {
                        // The last frame is one step before the first: the film repeats without a pause.
                        let turn = std::f32::consts::TAU * number as f32 / count as f32;
                        eye::orbit(&mut camera, turn, 0.0);
                    }
                    (Sequence::Timeline, Some((from, to))) => {
                        let share = number as f32 / (count - 1).max(1) as f32;
                        let time = from + share * (to - from);
                        let stage = Stage::open(&gpu, source.clone(), Some(time))?;
                        drawn.renderer = Rc::clone(stage.renderer());
                    }
                    (Sequence::Timeline, None) => return Err("the scene has no timeline".into()),
                }
                let image = drawn.image(&camera).await?;
                save(&image, &folder.join(format!("{number:05}.png")))?;
                progress.set((number + 1, count));
            }
            Ok(format!("{}: {count} frames", shown(&folder)))
        };
        self.task = Some(Task::new(work));
    }
}

/// A method on a renderer.
struct Drawn {
    renderer: Rc<Renderer>,
    spec: MethodSpec,
    learned: Option<LearnedWeight>,
    size: [u32; 2],
}

impl Drawn {
    fn of(stage: &Stage, slot: &Slot, size: [u32; 2]) -> Self {
        Self {
            renderer: Rc::clone(stage.renderer()),
            spec: slot.spec().clone(),
            learned: slot.learned().cloned(),
            size,
        }
    }

    async fn image(&self, camera: &Camera) -> Result<Image, String> {
        let readable = |e: RenderError| one_line(&e);
        let options = MethodOptions::sized(self.size).with(self.learned.as_ref());
        let mut prepared = self
            .renderer
            .method(&self.spec, options)
            .map_err(readable)?;
        let frame = self.renderer.image_async(&mut prepared, camera).await;
        Ok(frame.map_err(readable)?.image)
    }
}

/// Writes a file. Nothing but an older picture of ours is replaced.
#[cfg(not(target_arch = "wasm32"))]
fn save(image: &Image, path: &Path) -> Result<String, String> {
    let format = ImageFormat::of(path).map_err(|e| one_line(&e))?;
    let standing = format.kind().standing(path);
    if matches!(standing, Ok(Standing::Foreign)) {
        return Err(format!(
            "{}: another file has this name; choose another",
            shown(path)
        ));
    }
    image.save(path).map_err(|e| one_line(&e))?;
    Ok(format!("{} is written", shown(path)))
}

/// Hands a file to the browser.
#[cfg(target_arch = "wasm32")]
fn save(image: &Image, path: &Path) -> Result<String, String> {
    let format = ImageFormat::of(path).map_err(|e| one_line(&e))?;
    let bytes = image.encoded(format).map_err(|e| one_line(&e))?;
    keep(path, &bytes)
}

/// Writes a new file; what was written.
#[cfg(not(target_arch = "wasm32"))]
fn keep(path: &Path, bytes: &[u8]) -> Result<String, String> {
    if path.exists() {
        return Err(format!("{}: is there already; move it away", shown(path)));
    }
    peelnet_files::write_whole(path, bytes).map_err(|e| one_line(&e))?;
    Ok(format!("{} is written", shown(path)))
}

/// Hands a new file to the browser.
#[cfg(target_arch = "wasm32")]
fn keep(path: &Path, bytes: &[u8]) -> Result<String, String> {
    crate::web::download(path, bytes)?;
    Ok(format!("{} is among your downloads", shown(path)))
}

/// Letters that every file system takes.
fn plain(text: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '.';
    text.chars()
        .map(|c| if is_plain(c) { c } else { '_' })
        .take(60)
        .collect()
}

/// A name for a file of this view that is still free.
pub(crate) fn free_name(stage: &Stage, slot: &Slot, ending: &str) -> PathBuf {
    let name = format!(
        "{}-{}",
        plain(&stage.scene().name),
        plain(&slot.spec().to_string())
    );
    let of = |number: u32| match number {
        0 => PathBuf::from(format!("{name}{ending}")),
        n => PathBuf::from(format!("{name}-{n}{ending}")),
    };
    let free = (0..10_000).map(of).find(|path| !path.exists());
    free.unwrap_or_else(|| of(10_000))
}

/// Saves the scene with its changes beside the file it came from, and says what such a file cannot hold.
pub(crate) fn scene(stage: &Stage, slot: &Slot, camera: &Camera) -> Result<String, String> {
    let edited = stage.edited(camera)?;
    let name = free_name(stage, slot, ".toml");
    let mut said = keep(&stage.source.folder().join(&name), edited.text.as_bytes())?;
    if !edited.left_out.is_empty() {
        said = format!("{said}, without {}", edited.left_out.join("; without "));
    }
    Ok(said)
}

/// The command that opens this view again.
pub(crate) fn command(stage: &Stage, slot: &Slot, camera: &Camera, view: Option<usize>) -> String {
    let (Source::Named(path) | Source::Dropped(path, _)) = &stage.source;
    let mut words = vec![
        "peelnet".to_owned(),
        "view".to_owned(),
        quoted(&path.to_string_lossy()),
        "--method".to_owned(),
        quoted(&slot.spec().to_string()),
    ];
    if let Some(network) = slot.network().filter(|n| n.is_of(slot.spec())) {
        words.push("--model".into());
        words.push(quoted(&network.path.to_string_lossy()));
    }
    if !stage.scene().timeline.is_empty() {
        words.push(format!("--time={}", stage.scene().time));
    }
    match view {
        Some(number) => words.push(format!("--view {number}")),
        None => words.push(format!("--camera={}", camera_text(camera))),
    }
    words.join(" ")
}

/// For a shell, on one line.
fn quoted(text: &str) -> String {
    let text = peelnet_files::one_line(text);
    shell_words::quote(&text).into_owned()
}

/// Eye, target and field of view, as `--camera` reads them.
pub(crate) fn camera_text(camera: &Camera) -> String {
    let [p, t] = [camera.position, camera.target];
    let numbers = [p.x, p.y, p.z, t.x, t.y, t.z, camera.fov_y_degrees];
    numbers.map(|x| x.to_string()).join(",")
}

/// Eye and target, and the field of view in degrees: six or seven numbers, as `--camera` gives them.
pub fn camera_numbers(text: &str) -> Result<Vec<f32>, String> {
    let numbers: Result<Vec<f32>, _> = text.split(',').map(|n| n.trim().parse::<f32>()).collect();
    let numbers = numbers.unwrap_or_default();
    let is_complete = matches!(numbers.len(), 6 | 7) && numbers.iter().all(|x| x.is_finite());
    let is_direction = is_complete && numbers[..3] != numbers[3..6];
    let is_angle = numbers.get(6).is_none_or(|x| *x > 0.0 && *x < 180.0);
    if is_direction && is_angle {
        return Ok(numbers);
    }
    Err("must be eye and target, and the field of view in degrees where it is another: X,Y,Z,X,Y,Z[,DEGREES]".into())
}

/// The text of a learned method in a language; `None` for methods without a network.
pub(crate) fn shader(slot: &Slot, language: Language) -> Option<Result<String, String>> {
    let model = model_of(slot.spec(), slot.network())?;
    let options = Options {
        language,
        ..Options::default()
    };
    Some(peelnet_export::text(&model, &options).map_err(|e| one_line(&e)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shells_take_names_as_they_are() {
        assert_eq!(quoted("a/b-1.glb"), "a/b-1.glb");
        assert_eq!(quoted("my mesh.glb"), "'my mesh.glb'");
        assert_eq!(quoted("it's"), r"'it'\''s'");
        assert_eq!(quoted("$(rm)"), "'$(rm)'");
    }

    #[test]
    fn cameras_are_read_as_they_are_written() {
        let camera = Camera {
            position: glam::Vec3::new(0.1, -2.5, 1e-3),
            target: glam::Vec3::new(3.0, 4.0, 5.0),
            up: glam::Vec3::Y,
            fov_y_degrees: 33.3,
            near: 0.1,
            far: 9.0,
        };
        let numbers = camera_numbers(&camera_text(&camera)).expect("reads");
        assert_eq!(numbers, [0.1, -2.5, 1e-3, 3.0, 4.0, 5.0, 33.3]);
        for bad in [
            "",
            "1,2,3",
            "1,2,3,1,2,3",
            "1,2,3,4,5,nan",
            "1,2,3,4,5,6,0",
            "1,2,3,4,5,6,7,8",
            "a,2,3,4,5,6",
        ] {
            assert!(camera_numbers(bad).is_err(), "{bad}");
        }
    }
}
