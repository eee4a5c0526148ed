//! The window's controls, pressed one by one, without a window.

use crate::{
    Mode, Start, address,
    app::{App, configuration},
    compare::MODES,
    slot::Shot,
    stage::{Source, Stage},
};
use eframe::egui_wgpu::{RenderState, RendererOptions};
use egui_kittest::{Harness, kittest::Queryable as _};
use peelnet_bench::{metrics, report::dataset::Pixel};
use peelnet_core::files::thousands;
use peelnet_model::{Model, Recipe};
use peelnet_peel::{ExtractOptions, extract};
use peelnet_render::gpu::{AdapterRequest, Gpu};
use peelnet_render::{FrameStatus, MethodOptions, MethodSpec, Renderer};
use peelnet_scene::{Scene, suite};
use std::{
    fs,
    path::{Path, PathBuf},
    time::{Duration, Instant},
};

/// How long something may take that a frame does not wait for: a hundred times what it takes on two idle cores.
const PATIENCE: Duration = Duration::from_secs(120);

const SIZE: [f32; 2] = [900.0, 500.0];

const PICTURE: &str = "Picture of the scene";

type Window = Harness<'static, App>;

fn window(scene: &str, method: &str) -> Window {
    sized(scene, method, SIZE)
}

fn sized(scene: &str, method: &str, size: [f32; 2]) -> Window {
    let gpu = Gpu::open(&AdapterRequest::Auto).unwrap();
    let (config, options) = (configuration(&gpu), RendererOptions::PREDICTABLE);
    let made = RenderState::create(&config, &gpu.instance, None, options);
    let egui = pollster::block_on(made).unwrap();
    let start = Start::new(scene, method.parse().unwrap());
    let app = App::new(&gpu, start, Source::named(scene), Vec::new());
    let mut window = Harness::builder()
        .with_size(size)
        .with_max_steps(1000)
        .build_ui_state(move |ui, app: &mut App| app.frame(ui, &egui), app);
    window.state_mut().panels.measures = false;
    steps(&mut window);
    window
}

fn stage(window: &Window) -> &Stage {
    window.state().stage.as_ref().unwrap()
}

/// What the window shows, after a few frames.
fn texels(window: &mut Window) -> Vec<[u8; 4]> {
    steps(window);
    let app = window.state();
    app.display.texels(&app.gpu)
}

fn whole(window: &mut Window) {
    until(window, "whole", |app| {
        let second = !app.compare.mode.needs_second() || app.second.status == FrameStatus::Whole;
        second && app.first.status == FrameStatus::Whole
    });
}

/// A few frames: what one frame asks for, the next ones show.
fn steps(window: &mut Window) {
    window.run_steps(4);
}

fn until(window: &mut Window, what: &str, holds: impl Fn(&App) -> bool) {
    let begin = Instant::now();
    while !holds(window.state()) {
        assert!(begin.elapsed() < PATIENCE, "{what}");
        window.step();
        std::thread::sleep(Duration::from_millis(2));
    }
}

fn press(window: &mut Window, label: &str) {
    window.get_by_label(label).click();
    steps(window);
}

fn method(window: &Window) -> String {
    window.state().first.spec.to_string()
}

/// A method is chosen from the list, and every parameter of every method has a control with a name, which the harness checks of all widgets, and the picture is drawn.
#[test]
fn every_method_has_its_controls() {
    let mut w = sized("boxes", "wboit-eq9", [900.0, 900.0]);
    press(&mut w, "Draw with");
    press(&mut w, "mboit4");
    assert_eq!(method(&w), "mboit4");
    for m in crate::panels::methods::offered() {
        let spec = MethodSpec::points(m).next().unwrap();
        w.state_mut().first.set_spec(spec);
        steps(&mut w);
        for parameter in m.all_parameters() {
            let mut controls = w.query_all_by_label(parameter.name);
            assert!(controls.next().is_some(), "{}: {}", m.name, parameter.name);
        }
        assert_eq!(w.state().first.failure, None, "{}", m.name);
        w.check_accessibility();
    }
}

/// Blending rounds to 11 bits in the viewer's 16-bit target, far less than one of 255 levels; a value at the border of two levels may then fall to
/// the other side.
const LEVELS: u8 = 1;

/// The picture is that of `peelnet render`, but for the precision of its target.
fn assert_shows(w: &mut Window, scene: &Scene) {
    whole(w);
    let shown = texels(w);
    let app = w.state();
    let renderer = Renderer::new(&app.gpu, scene).unwrap();
    let options = MethodOptions::sized(app.size);
    let mut prepared = renderer.method(&app.first.spec, options).unwrap();
    let image = renderer.image(&mut prepared, &scene.views[0]).unwrap();
    let want = image.image.to_srgb8();
    let worst = shown.iter().zip(want.chunks_exact(3)).map(|(a, b)| {
        let channels = a.iter().zip(b).map(|(a, b)| a.abs_diff(*b));
        channels.max().unwrap()
    });
    assert!(worst.max().unwrap() <= LEVELS, "{}", app.first.spec);
    assert_eq!(shown.len() * 3, want.len());
}

#[test]
fn the_picture_is_the_renderers() {
    for name in ["deep-medium", "mboit4", "abuffer", "kbuffer-4"] {
        let mut w = window("cups", name);
        assert_shows(&mut w, &suite::load("cups").unwrap());
    }
}

/// A file of splats is dropped onto the window. It blends in display space, and is not encoded for the display again.
#[test]
fn dropped_splats_are_shown_as_they_blend() {
    let mut w = window("boxes", "splat");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("two.splat");
    let mut bytes = Vec::new();
    for (x, color) in [(0.0f32, [200, 90, 40, 220]), (0.3, [30, 120, 220, 160])] {
        let floats = [x, 0.2 * x, x, 0.4, 0.3, 0.1];
        bytes.extend(floats.into_iter().flat_map(f32::to_le_bytes));
        bytes.extend(color);
        bytes.extend([255, 128, 160, 128]);
    }
    fs::write(&path, bytes).unwrap();
    let file = std::sync::Arc::new(Dropped(path.clone()));
    w.input_mut().dropped_files.push(file);
    until(&mut w, "loaded", |app| {
        app.stage
            .as_ref()
            .is_some_and(|stage| stage.scene.objects.len() == 1)
    });
    let scene = Scene::load(&path).unwrap();
    assert_eq!(scene.blending, peelnet_scene::Blending::Display);
    assert_shows(&mut w, &scene);
}

/// Each comparison shows what it says of two pictures that differ.
#[test]
fn comparisons_show_both_pictures() {
    let mut w = window("cups", "wboit-eq9");
    // Panels differ in width.
    w.state_mut().panels.bare = true;
    let picture = |w: &mut Window, mode: Mode| {
        w.state_mut().compare.mode = mode;
        steps(w);
        whole(w);
        texels(w)
    };
    let first = picture(&mut w, Mode::One);
    let split = picture(&mut w, Mode::Split);
    let second = picture(&mut w, Mode::Second);
    let error = picture(&mut w, Mode::Error);
    let [width, _] = w.state().size;
    let divider = (width as f32 * 0.5).round() as usize;
    assert_ne!(first, second);
    for (i, shown) in split.iter().enumerate() {
        let is_left = i % (width as usize) < divider;
        let want = if is_left { first[i] } else { second[i] };
        assert_eq!(*shown, want, "{i}");
    }
    // Black exactly where the pictures are equal, as far as 8 bits tell.
    let black = error[0];
    assert_eq!(first[0], second[0]);
    for (i, heat) in error.iter().enumerate() {
        let difference = (0..3).map(|k| first[i][k].abs_diff(second[i][k]));
        if difference.max().unwrap() > 1 {
            assert_ne!(*heat, black, "{i}");
        }
    }
}

#[test]
fn comparisons_are_chosen_by_their_names() {
    let mut w = window("boxes", "wboit-eq9");
    for (mode, _, name, _) in MODES {
        press(&mut w, name);
        assert_eq!(w.state().compare.mode, mode);
        if mode.needs_second() {
            w.get_by_label("Against");
        }
    }
    until(&mut w, "layers", |app| app.counter.map().is_some());
}

#[test]
fn keys_do_what_the_list_says() {
    let mut w = window("cups", "wboit-eq9");
    let key = |w: &mut Window, key: egui::Key| {
        w.key_press(key);
        steps(w);
    };
    key(&mut w, egui::Key::Num2);
    assert_eq!(w.state().view, Some(1));
    assert_eq!(w.state().camera, suite::load("cups").unwrap().views[1]);
    key(&mut w, egui::Key::F);
    assert_eq!(w.state().view, None);
    key(&mut w, egui::Key::C);
    assert_eq!(w.state().compare.mode, Mode::Split);
    let before = method(&w);
    key(&mut w, egui::Key::M);
    assert_ne!(method(&w), before);
    w.key_press_modifiers(egui::Modifiers::SHIFT, egui::Key::M);
    steps(&mut w);
    assert_eq!(method(&w), before);
    key(&mut w, egui::Key::H);
    assert!(w.state().panels.help);
    let position = w.state().camera.position;
    key(&mut w, egui::Key::ArrowLeft);
    assert_ne!(w.state().camera.position, position);
    key(&mut w, egui::Key::Tab);
    assert!(w.state().panels.bare);
    // The harness leaves a margin, a window does not.
    let [width, height] = SIZE.map(|x| x as u32);
    assert!(w.state().size[0] > width - 20 && w.state().size[1] > height - 20);
}

/// Drags the pointer from the middle of the picture to another point of it.
fn drag(w: &mut Window, to: impl Fn(egui::Rect) -> egui::Pos2) {
    let picture = w.get_by_label(PICTURE).rect();
    w.drag_at(picture.center());
    w.step();
    w.hover_at(to(picture));
    w.step();
    w.drop_at(to(picture));
    steps(w);
}

/// A drag over the picture turns the eye, and the distance to its target stays; a drag of the divider moves that, and the eye stays.
#[test]
fn the_eye_and_the_divider_are_dragged() {
    let mut w = window("cups", "wboit-eq9");
    let before = w.state().camera;
    drag(&mut w, |picture| picture.center() + egui::vec2(40.0, 10.0));
    let after = w.state().camera;
    assert_ne!(before.position, after.position);
    assert_eq!(before.target, after.target);
    let [far, near] = [before, after].map(|c| (c.position - c.target).length());
    assert!((far / near - 1.0).abs() < 1e-5);
    w.state_mut().compare.mode = Mode::Split;
    steps(&mut w);
    drag(&mut w, |picture| picture.lerp_inside([0.25, 0.5]));
    assert!((w.state().compare.divider - 0.25).abs() < 0.01);
    assert_eq!(w.state().camera, after);
}

/// Fragments come front to back; T is the product of what is in front, by the formula; the exact method believes just that.
#[test]
fn a_pixel_lists_its_fragments() {
    let mut w = window("cups", "abuffer");
    let middle = w.get_by_label(PICTURE).rect().center();
    w.hover_at(middle);
    w.step();
    w.drag_at(middle);
    w.drop_at(middle);
    steps(&mut w);
    assert!(w.state().inspector.pixel.is_some());
    until(&mut w, "fragments", |app| app.inspector.layers().is_some());
    let layers = w.state().inspector.layers().unwrap().as_ref().unwrap();
    assert!(layers.len() > 2);
    let mut front = 1.0;
    for pair in layers.windows(2) {
        assert!(pair[0].fragment.depth <= pair[1].fragment.depth);
    }
    for layer in layers {
        assert!((layer.exact - front).abs() < 1e-12);
        assert!(!layer.object.is_empty());
        front *= 1.0 - f64::from(layer.fragment.alpha);
    }
}

/// The exact method has no error; another one has.
#[test]
fn errors_are_measured_while_the_view_rests() {
    let mut w = window("boxes", "abuffer");
    w.state_mut().panels.measures = true;
    for (method, errs) in [("abuffer", false), ("wboit-eq9", true)] {
        w.state_mut().first.set_spec(method.parse().unwrap());
        steps(&mut w);
        let key = w.state().key().unwrap();
        until(&mut w, "measured", |app| app.errors.get(&key).is_some());
        let numbers = w.state().errors.get(&key).unwrap().as_ref().unwrap();
        assert_eq!(numbers.differences.mse255 > 0.0, errs);
        assert_eq!(numbers.flip.is_some_and(|x| x > 0.0), errs);
        assert!(numbers.stats.fragments.is_some_and(|n| n > 0));
    }
}

/// Every method gets a point, exact ones an error of 0, and a click on the list switches.
#[test]
fn all_methods_are_measured_on_the_view() {
    let mut w = sized("boxes", "wboit-eq9", [640.0, 420.0]);
    let app = w.state_mut();
    let stage = app.stage.as_ref().unwrap();
    // A small picture: it is the number of methods that takes time.
    app.front.measure(stage, stage.view(app.camera, [48, 32]));
    until(&mut w, "front", |app| !app.front.job.is_busy());
    let front = &w.state().front;
    assert_eq!(front.job.get(&()), Some(&Ok(())));
    let measured = front.measured.borrow();
    assert_eq!(measured.points.len(), measured.all);
    assert_eq!(measured.left_out, []);
    let exact = measured.points.iter().find(|p| p.method == "abuffer");
    assert_eq!(exact.unwrap().mse255, 0.0);
    assert!(measured.points.iter().any(|p| p.on_front));
}

/// The command of a view and a page's address name what is shown; an address is read as it was written.
#[test]
fn links_show_the_same_again() {
    let mut w = window("vase", "wboit-eq10:factor=3e4,targets=f32");
    let time = stage(&w).times().unwrap().1;
    let app = w.state_mut();
    app.edit(|stage| stage.set_time(time));
    let method = "wboit-eq10:factor=3e4,targets=f32";
    let command = app.command().unwrap();
    let want = format!("peelnet view vase --method={method} --view=0 --time={time}");
    assert_eq!(command, want.replace(method, &format!("'{method}'")));
    app.panels.bare = true;
    app.stage.as_mut().unwrap().source.path = "meine Szene & mehr=ä+.glb".into();
    let read = |app: &App| {
        let mut start = Start::new("", "abuffer".parse().unwrap());
        assert_eq!(address::read(&app.query().unwrap(), &mut start), [""; 0]);
        assert_eq!(start.scene, app.stage.as_ref().unwrap().source.path);
        let read = (start.method, start.time, start.bare);
        assert_eq!(read, (app.first.spec.clone(), Some(time), true));
        (start.view, start.camera)
    };
    app.show_view(0);
    assert_eq!(read(app), (0, None));
    app.move_eye(|camera, _| {
        camera.position = [0.1, -2.5, 1e-3].into();
        camera.target = [3.0, 4.0, 5.0].into();
        camera.fov_y_degrees = 33.3;
    });
    let numbers = vec![0.1, -2.5, 1e-3, 3.0, 4.0, 5.0, 33.3];
    assert_eq!(read(app), (0, Some(numbers)));
}

#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        fs::read(&self.0).map_err(|e| e.to_string())
    }
}

/// A scene that is dropped is shown, with its changes saved as a file that shows the same; what is none is a message.
#[test]
fn dropped_and_saved_scenes() {
    let mut w = window("boxes", "wboit-eq9");
    let folder = tempfile::tempdir().unwrap();
    let drop = |w: &mut Window, path: &Path| {
        let file = std::sync::Arc::new(Dropped(path.to_owned()));
        w.input_mut().dropped_files.push(file);
        steps(w);
    };
    let scene = folder.path().join("mine.toml");
    fs::write(&scene, suite::find("cups").unwrap().text).unwrap();
    drop(&mut w, &scene);
    assert_eq!(w.state().recent[0], scene);
    let note = folder.path().join("note.txt");
    fs::write(&note, "no scene").unwrap();
    drop(&mut w, &note);
    let says = w.query_by_label_contains("not a scene or a network");
    assert!(says.is_some());
    assert_eq!(stage(&w).scene.objects.len(), 6);
    let mut clear = stage(&w).scene.objects[0].materials[0].clone();
    clear.alpha = 0.25;
    let app = w.state_mut();
    app.edit(|stage| stage.set_material(0, 0, clear));
    app.move_eye(|camera, _| crate::eye::orbit(camera, 0.5, 0.1));
    app.save_scene();
    let said = app.output.last().unwrap().as_ref().unwrap();
    assert!(!said.contains("without"), "{said}");
    let files = fs::read_dir(folder.path()).unwrap();
    let mut files = files.map(|e| e.unwrap().path());
    let saved = files.find(|p| *p != scene && p.extension().is_some_and(|e| e == "toml"));
    let again = Scene::load(saved.unwrap()).unwrap();
    assert_eq!(again.views, [app.camera]);
    assert_eq!(again.objects[0].materials[0].alpha, 0.25);
}

#[test]
fn a_network_is_read_again_when_its_file_changes() {
    let mut w = window("boxes", "wboit-eq9");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("m.safetensors");
    let write = |method: &str| {
        let recipe = Recipe::for_method(method).unwrap();
        Model::shipped(recipe).unwrap().save(&path).unwrap();
    };
    let loaded = |app: &App| app.first.own_network().map(|n| n.model.meta.recipe.method);
    write("deep-small");
    w.state_mut().open_network(Source::named(&path));
    steps(&mut w);
    assert_eq!(method(&w), "deep-small");
    assert_eq!(w.state().first.failure, None);
    assert_eq!(loaded(w.state()), Some("deep-small"));
    // Files keep times to a fraction of a second at best.
    std::thread::sleep(Duration::from_millis(50));
    write("deep-large");
    until(&mut w, "read again", |app| {
        loaded(app) == Some("deep-large")
    });
    assert_eq!(method(&w), "deep-large");
}

/// Trains on a scene in a small size; returns once the first network is drawn.
fn training(scene: &str, epochs: u32) -> Window {
    let mut w = sized(scene, "wboit-eq9", [900.0, 900.0]);
    let training = &mut w.state_mut().training;
    (training.size, training.epochs) = ([96, 64], Some(epochs));
    press(&mut w, "Training");
    press(&mut w, "Train on this scene");
    until(&mut w, "the first network", |app| {
        app.first.own_network().is_some()
    });
    assert_eq!(method(&w), "deep-small");
    w
}

/// The number and the epoch of the network that is drawn.
fn trained(w: &Window) -> (u64, u32) {
    let network = w.state().first.own_network().unwrap();
    (network.number, network.model.meta.epochs)
}

/// Mean squared error of the picture by the network that is drawn.
fn error(w: &Window) -> f64 {
    let (app, size) = (w.state(), [96, 64]);
    let Shot {
        renderer,
        spec,
        options,
    } = app.first.shot(stage(w), size);
    let draw = |spec: &MethodSpec, options| {
        let mut prepared = renderer.method(spec, options).unwrap();
        renderer
            .image(&mut prepared, &app.camera)
            .unwrap()
            .image
            .pixels
    };
    let exact = draw(&"abuffer".parse().unwrap(), MethodOptions::sized(size));
    metrics::differences(&exact, &draw(&spec, options)).mse255
}

/// The picture follows: another network after the first, and at the end a better one, which is exported.
#[test]
fn the_picture_follows_a_training() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("mine.toml");
    fs::write(&scene, suite::find("boxes").unwrap().text).unwrap();
    let mut w = training(scene.to_str().unwrap(), 200);
    let (first, first_error) = (trained(&w), error(&w));
    until(&mut w, "another network", |app| {
        app.first.own_network().unwrap().number != first.0
    });
    until(&mut w, "trained", |app| !app.training.is_busy());
    assert_eq!(w.state().messages.0, []);
    assert_eq!(
        (trained(&w).1, w.state().training.history.len()),
        (200, 200)
    );
    let last_error = error(&w);
    assert!(last_error < 0.5 * first_error, "{first_error} {last_error}");
    let app = w.state_mut();
    app.panels.measures = true;
    until(&mut w, "measured", |app| !app.awaits_training());
    let text = w.state().training.text().unwrap();
    assert!(text.contains("trained 200 epochs of 200 in "), "{text}");
    assert!(text.contains("; MSE of the view "), "{text}");
    press(&mut w, "Export network");
    let network = w.state().first.own_network().unwrap();
    let exported = network.path.clone().unwrap();
    assert_eq!(Model::load(&exported).unwrap(), network.model);
    let text = fs::read_to_string(exported.with_extension("wgsl")).unwrap();
    assert_eq!(text, network.weight.wgsl);
    assert!(w.state().command().unwrap().contains("--model="));
}

/// Stop keeps the last whole epoch.
#[test]
fn a_training_is_stopped() {
    let mut w = training("boxes", 100_000);
    press(&mut w, "Stop training");
    until(&mut w, "stopped", |app| !app.training.is_busy());
    let history = w.state().training.history.len();
    assert_eq!(trained(&w).1 as usize, history);
    assert!(history < 100_000, "it was not stopped");
    assert_eq!(w.state().messages.0, []);
    w.get_by_label("Train on this scene");
}

/// Another scene ends a training, and so does another network; what was drawn last stays, and nothing comes after it.
#[test]
fn another_scene_ends_a_training() {
    let mut w = training("boxes", 100_000);
    w.state_mut().open(Source::named("cups"), None);
    let last = trained(&w);
    steps(&mut w);
    assert!(!w.state().training.is_busy());
    std::thread::sleep(Duration::from_millis(600));
    steps(&mut w);
    assert_eq!(trained(&w), last);
    assert_eq!(w.state().messages.0, []);
}

/// A dataset has its views, a pixel's rows and histograms beside the picture; a network is trained on it.
#[test]
fn a_dataset_is_looked_into_and_trained_on() {
    let folder = tempfile::tempdir().unwrap();
    let mut w = sized("boxes", "wboit-eq9", [900.0, 1800.0]);
    let options = ExtractOptions {
        size: [96, 64],
        ..ExtractOptions::new(folder.path().join("rows"))
    };
    let scenes = [stage(&w).scene.clone()];
    let m = extract(
        &stage(&w).gpu,
        &scenes,
        &options,
        &false.into(),
        &mut |_| (),
    );
    let m = m.unwrap().manifest;
    w.state_mut().open_dataset(folder.path());
    let [(true, said)] = &w.state().messages.0[..] else {
        panic!("{:?}", w.state().messages.0)
    };
    assert!(said.contains("not a dataset"), "{said}");
    w.state_mut().messages.0.clear();
    w.state_mut().open_dataset(&options.out);
    until(&mut w, "read", |app| !app.awaits_dataset());
    steps(&mut w);
    w.get_by_label(&format!(
        "{} rows of {} pixels",
        thousands(m.rows),
        thousands(m.pixels)
    ));
    // The pixel with the most rows; then the one that is clicked.
    let deepest = |w: &Window| {
        let looked = w.state().dataset.as_ref().unwrap();
        let view = looked.view.get(&looked.part).unwrap().as_ref().unwrap();
        (
            view.grid.deepest().unwrap().title(),
            view.grid.pixel([48, 32]).map(Pixel::title),
        )
    };
    let (most, middle) = deepest(&w);
    w.get_by_label(&most);
    press(&mut w, "A view of the dataset");
    assert_eq!(w.state().dataset.as_ref().unwrap().cell, Some([48, 32]));
    w.get_by_label(&middle.unwrap());
    press(&mut w, "Histograms");
    w.get_by_label("Histogram of transmittance");
    w.check_accessibility();
    // Another view has another picture.
    w.state_mut().dataset.as_mut().unwrap().part = 1;
    until(&mut w, "read", |app| !app.awaits_dataset());
    assert_ne!(deepest(&w).0, most);
    w.state_mut().training.epochs = Some(3);
    press(&mut w, "Training");
    press(&mut w, "Train on this dataset");
    until(&mut w, "trained", |app| !app.training.is_busy());
    assert_eq!(w.state().messages.0, []);
    assert_eq!(trained(&w).1, 3);
    let trained_on = &w.state().first.own_network().unwrap().model.meta.dataset;
    assert_eq!(trained_on.as_ref().unwrap().hash, m.hash);
    // What was drawn last has moved the panel.
    steps(&mut w);
    press(&mut w, "Close dataset");
    w.get_by_label("Train on this scene");
}

/// What cannot be trained is one message.
#[test]
fn a_training_that_fails_says_why() {
    let mut w = window("boxes", "wboit-eq9");
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("opaque.toml");
    let text = "[camera]\nposition = [0, 0, 5]\ntarget = [0, 0, 0]\nfov_y = 45\nnear = 0.1\nfar = 100.0\n\n[[object]]\nmesh = { shape = \"quad\", size = [1, 1] }\n";
    fs::write(&scene, text).unwrap();
    w.state_mut().open(Source::named(&scene), None);
    assert_eq!(w.state().messages.0, []);
    let context = w.ctx.clone();
    w.state_mut().begin_training(&context, None);
    until(&mut w, "failed", |app| !app.training.is_busy());
    let [(true, said)] = &w.state().messages.0[..] else {
        panic!("{:?}", w.state().messages.0)
    };
    assert!(said.contains("nothing to learn from"), "{said}");
}

#[test]
fn changes_show_and_are_taken_back() {
    let mut w = window("cups", "wboit-eq9");
    let before = texels(&mut w);
    let object = stage(&w).scene.objects[0].clone();
    let moved = glam::Mat4::from_translation(glam::Vec3::X) * object.world_from_object;
    let mut clear = object.materials[0].clone();
    clear.alpha = 0.01;
    type Change<'a> = &'a dyn Fn(&mut Stage) -> crate::task::Fallible<()>;
    let changes: [Change<'_>; 3] = [
        &|stage| stage.set_transform(0, moved),
        &|stage| stage.set_material(0, 0, clear.clone()),
        &|stage| stage.set_lights(Vec::new()),
    ];
    for change in changes {
        w.state_mut().edit(change);
        assert!(texels(&mut w) != before);
        w.state_mut().edit(Stage::reset);
        assert!(texels(&mut w) == before);
    }
}

/// The timeline moves by its labels; layers are highlighted and shaded as the check boxes say.
#[test]
fn time_and_layers() {
    let mut w = sized("vase", "wboit-eq9", [1000.0, 900.0]);
    let last = stage(&w).scene.timeline.last().unwrap().clone();
    press(&mut w, &last.label);
    let time = |w: &Window| stage(w).scene.time;
    assert_eq!(time(&w), last.time);
    press(&mut w, "Play");
    assert!(w.state().panels.plays);
    press(&mut w, "Pause");
    assert_ne!(time(&w), last.time);
    press(&mut w, "Layers");
    press(&mut w, "Layer 1");
    let layers = |w: &Window| stage(w).shown.clone();
    assert_eq!(layers(&w).layers.unwrap().highlight, 1);
    press(&mut w, "Increasing layers only");
    assert!(layers(&w).layers.unwrap().increasing);
    press(&mut w, "Shade the highlighted layer alone");
    assert!(layers(&w).shade_all);
    assert_eq!(w.state().first.failure, None);
    press(&mut w, "None");
    assert_eq!(layers(&w).layers, None);
}

#[test]
fn a_narrow_window_has_one_column() {
    let mut w = sized("boxes", "wboit-eq9", [360.0, 740.0]);
    let picture = w.get_by_label(PICTURE).rect();
    assert!(picture.width() >= 340.0, "{picture:?}");
    assert!(picture.height() > 200.0, "{picture:?}");
    w.get_by_label("Method");
    press(&mut w, "Controls");
    press(&mut w, "Results");
    let picture = w.get_by_label(PICTURE).rect();
    assert!(picture.height() > 600.0, "{picture:?}");
}
