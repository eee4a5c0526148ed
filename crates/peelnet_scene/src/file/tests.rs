//! Scene files, sound and bad.

use super::*;
use glam::Vec3;
use std::fs;

const CAMERA: &str = "[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nnear = 0.1\nfar = 100\n";

fn load(text: &str) -> Result<Scene, SceneError> {
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join("s.toml");
    fs::write(&path, text).expect("writes");
    Scene::load(&path)
}

#[test]
fn transforms_apply_in_the_documented_order() {
    let scene = load(&format!(
        "{CAMERA}[[object]]\nmesh = {{ shape = 'box', size = [2, 4, 8] }}\nfit = 1.0\nscale = 2.0\nrotate = [90, 0, 0]\ntranslate = [0, 0, 5]\n"
    ))
    .expect("loads");
    // fit: 0.25 × 0.5 × 1; scale: 0.5 × 1 × 2; turned about x: 0.5 × 2 × 1; moved by 5.
    let o = &scene.objects[0];
    let far = o
        .mesh
        .positions
        .iter()
        .map(|p| o.world_from_object.transform_point3(*p));
    let (lo, hi) = far.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(a, b), p| {
        (a.min(p), b.max(p))
    });
    assert!((lo - Vec3::new(-0.25, -1.0, 4.5)).length() < 1e-5, "{lo}");
    assert!((hi - Vec3::new(0.25, 1.0, 5.5)).length() < 1e-5, "{hi}");
}

#[test]
fn orbit_lights_and_defaults() {
    let scene = load(&format!(
        "{CAMERA}[orbit]\nviews = 4\n[[light]]\nposition = [4, 6, 4]\n[[object]]\nmesh = {{ shape = 'sphere' }}\n[object.material]\nalpha = 0.5\n"
    ))
    .expect("loads");
    assert_eq!((scene.name.as_str(), scene.views.len()), ("s", 4));
    assert!((scene.views[1].position - Vec3::new(6.0, 0.0, 0.0)).length() < 1e-5);
    let m = &scene.objects[0].materials[0];
    assert_eq!(
        (m.alpha, m.lighting, m.is_opaque()),
        (0.5, Lighting::Phong, false)
    );
    assert_eq!(scene.hash.len(), 64);
    assert!(scene.transparent_bounds().is_some());
}

/// Numbers are interpolated between states; textures and meshes are those of the state before; what a state does not name stays as it was.
#[test]
fn a_scene_ages() {
    let text = format!(
        "{CAMERA}[[object]]\nname = 'pot'\nmesh = {{ shape = 'sphere' }}\nmaterial = {{ color = [1, 0, 0], alpha = 0.2 }}\n\
         [[timeline]]\ntime = 0\nlabel = 'new'\n\
         [[timeline]]\ntime = 10\n[[timeline.object]]\nname = 'pot'\nmaterial = {{ alpha = 0.6, color_map = {{ pattern = 'noise', size = 8 }} }}\n\
         [[timeline]]\ntime = 30\n[[timeline.object]]\nname = 'pot'\nmesh = {{ shape = 'box' }}\nmaterial = {{ color = [0, 0, 1] }}\n"
    );
    let folder = tempfile::tempdir().expect("temporary folder");
    let path = folder.path().join("s.toml");
    fs::write(&path, &text).expect("writes");
    let at = |time: f32| Scene::load_at(&path, Some(time)).expect("loads");
    for (time, alpha, blue, mapped, name) in [
        (0.0, 0.2, 0.0, false, "sphere"),
        (5.0, 0.4, 0.0, false, "sphere"),
        (10.0, 0.6, 0.0, true, "sphere"),
        (20.0, 0.6, 0.5, true, "sphere"),
        (30.0, 0.6, 1.0, true, "box"),
    ] {
        let scene = at(time);
        let (object, m) = (&scene.objects[0], &scene.objects[0].materials[0]);
        assert!((m.alpha - alpha).abs() < 1e-6, "{time}: {}", m.alpha);
        assert!((m.color[2] - blue).abs() < 1e-6, "{time}: {:?}", m.color);
        assert_eq!(m.maps.color.is_some(), mapped, "{time}");
        assert_eq!(object.mesh.parts[0].name, name, "{time}");
        assert_eq!((scene.time, scene.timeline.len()), (time, 3));
    }
    // Without a time it is the first state.
    let first = Scene::load(&path).expect("loads");
    assert_eq!((first.time, first.timeline[0].label.as_str()), (0.0, "new"));
    let e = Scene::load_at(&path, Some(31.0)).expect_err("too late");
    assert!(e.to_string().contains("from 0 to 30"), "{e}");
    fs::write(&path, &text[..text.find("[[timeline]]").expect("states")]).expect("writes");
    let e = Scene::load_at(&path, Some(1.0)).expect_err("no timeline");
    assert!(e.to_string().contains("add [[timeline]]"), "{e}");
}

/// A bad scene gives one error that names the file, the line or key, and a hint.
fn refuses(text: &str, words: &[&str]) {
    let Err(e) = load(text) else {
        panic!("loads: {text}");
    };
    let e = e.to_string();
    for word in words {
        assert!(e.contains(word), "{text}\ngives: {e}\nwithout: {word}");
    }
}

#[test]
fn bad_files_and_cameras() {
    refuses(&format!("colour = 1\n{CAMERA}"), &["s.toml:1", "colour"]);
    refuses("name = \"x", &["s.toml:1"]);
    refuses("", &["camera", "add a [camera]"]);
    for (good, bad, words) in [
        ("near = 0.1", "near = 200", ["camera.near", "below far"]),
        ("near = 0.1", "near = 0", ["camera.near", "positive"]),
        ("[0, 0, 6]", "[0, 0, 0]", ["camera.target", "differ"]),
        ("[0, 0, 6]", "[0, 6, 0]", ["camera.up", "line of sight"]),
        ("[0, 0, 6]", "[0, nan, 6]", ["camera.position", "finite"]),
    ] {
        refuses(&CAMERA.replace(good, bad), &words);
    }
    for (more, words) in [
        ("fov_y = 180.0", ["camera.fov_y", "180"]),
        ("fov_y = 179.9999", ["camera.fov_y", "0.01 and 179"]),
        ("fov_y = 1e-40", ["camera.fov_y", "0.01 and 179"]),
        ("[orbit]\nviews = 0", ["orbit.views", "1"]),
        (
            "[[light]]\nposition = [1, 1, 1]\ndirection = [1, 0, 0]",
            ["light 1", "either"],
        ),
        ("[[light]]\ndirection = [0, 0, 0]", ["light 1", "not zero"]),
        (
            "[[timeline]]\ntime = 1\n[[timeline]]\ntime = 1",
            ["timeline 2.time", "later"],
        ),
        (
            "[[timeline]]\ntime = 1\n[[timeline.object]]\nname = 'x'",
            ["timeline 1.object.name", "'x'"],
        ),
    ] {
        refuses(&format!("{CAMERA}{more}"), &words);
    }
    let lights = "[[light]]\nposition = [1, 1, 1]\n".repeat(crate::MAX_LIGHTS + 1);
    refuses(
        &format!("{CAMERA}{lights}"),
        &["light", "16385 lights", "at most 16384"],
    );
}

/// Lengths and places that 32-bit numbers do not hold: a quad of a tenth of a billion loses half of itself on some rasterisers.
#[test]
fn shapes_beyond_their_numbers() {
    for (mesh, words) in [
        (
            "{ shape = 'sphere', radius = 3e38 }",
            ["object 1.mesh", "radius"],
        ),
        (
            "{ shape = 'sphere', radius = 1e-30 }",
            ["object 1.mesh", "radius"],
        ),
        (
            "{ shape = 'quad', size = [1e9, 1e9] }",
            ["object 1", "65536 times"],
        ),
        (
            "{ shape = 'lathe', profile = [[0, -1e38], [1e38, 0], [0, 1e38]] }",
            ["object 1", "reaches"],
        ),
    ] {
        refuses(&format!("{CAMERA}[[object]]\nmesh = {mesh}"), &words);
    }
    let far = "[[object]]\nmesh = { shape = 'quad' }\ntranslate = [0, 1e30, 0]";
    refuses(&format!("{CAMERA}{far}"), &["object 1", "reaches 1e30"]);
}

#[test]
fn bad_objects() {
    let object = |text: &str| format!("{CAMERA}[[object]]\n{text}\n");
    for (mesh, words) in [
        (
            "{ shape = 'sphere', raduis = 2 }",
            &["s.toml:7", "raduis", "radius"][..],
        ),
        (
            "{ shape = 'sphere', radius = -2 }",
            &["object 1.mesh", "positive"],
        ),
        (
            "'cow.fbx'",
            &["object 1.mesh", "export the mesh as one of them"],
        ),
        ("'none.obj'", &["none.obj", "cannot read"]),
        ("7", &["s.toml:7", "path or a table"]),
    ] {
        refuses(&object(&format!("mesh = {mesh}")), words);
    }
    for (more, words) in [
        ("scael = 2.0", &["s.toml:8", "scael", "scale"][..]),
        ("scale = 0.0", &["object 1.scale", "not 0"]),
        (
            "vertex_colors = [[0, 0, 0, 0], [2, 0, 0, 1]]",
            &["object 1.vertex_colors", "0 … 1"],
        ),
    ] {
        refuses(
            &object(&format!("mesh = {{ shape = 'box' }}\n{more}")),
            words,
        );
    }
}

#[test]
fn bad_materials() {
    let material = |text: &str| {
        format!("{CAMERA}[[object]]\nmesh = {{ shape = 'box' }}\n[object.material]\n{text}\n")
    };
    for (text, words) in [
        ("alpha = 1.5", ["object 1.material.alpha", "0 … 1"]),
        (
            "shininess = 0.5",
            ["object 1.material.shininess", "at least 1"],
        ),
        (
            "emission = [0, -1, 0]",
            ["object 1.material.emission", "not negative"],
        ),
        (
            "alpha_cutoff = 0.5",
            ["object 1.material.alpha_cutoff", "mask"],
        ),
        ("lighting = 'toon'", ["lighting", "phong"]),
        (
            "color_map = { pattern = 'noise', size = 1 }",
            ["object 1.material.color_map", "4 … 4096"],
        ),
        ("color_map = { pattern = 'wood' }", ["wood", "noise"]),
        ("color_map = 'none.png'", ["none.png", "cannot read"]),
    ] {
        refuses(&material(text), &words);
    }
    let metal = material("metallic_roughness_map = { pattern = 'noise' }");
    let lit = format!("{metal}[[light]]\nposition = [1, 1, 1]\n");
    refuses(&lit, &["metallic_roughness_map", "pbr"]);
}

/// Among them a count and a grid that would take all memory, or overflow. Found by fuzzing.
#[test]
fn bad_scatters() {
    for (text, words) in [
        ("count = 1", ["scatter 1.mesh", "either"]),
        (
            "count = 1\nmesh = { shape = 'box' }\nalpha = [0.5, 1.5]",
            ["scatter 1.alpha", "0 … 1"],
        ),
        (
            "count = 4294967295\nmesh = { shape = 'box' }",
            ["scatter 1.count", "at most"],
        ),
        (
            "count = 1\nmesh = { shape = 'box' }\ngrid = [4294967295, 4294967295, 1]",
            ["scatter 1.grid", "65535"],
        ),
    ] {
        let bounds = "min = [0, 0, 0]\nmax = [1, 1, 1]\n";
        refuses(&format!("{CAMERA}[scatter]\n{bounds}{text}"), &words);
    }
}

/// What a small file multiplies is counted before it is made: each of these would take gigabytes.
#[test]
fn small_files_cannot_ask_for_endless_memory() {
    let bounds = "min = [0, 0, 0]\nmax = [1, 1, 1]\n";
    let scatter = |count: usize| {
        format!("[[scatter]]\n{bounds}count = {count}\nmesh = {{ shape = 'quad' }}\n")
    };
    let scatter = scatter(1000) + &scatter(999_500);
    let huge = "[[object]]\nmesh = { shape = 'quad' }\n[[object]]\nmesh = { shape = 'sphere', triangles = 60_000_000 }\n";
    let points = "[0.5, 0.5], ".repeat(10_000);
    let lathe =
        format!("[[object]]\nmesh = {{ shape = 'lathe', profile = [[0, 0], {points} [0, 1]] }}\n");
    let instances = format!(
        "[[scatter]]\n{bounds}count = 100_000\nmesh = {{ shape = 'sphere', triangles = 20_000 }}\n"
    );
    for (text, words) in [
        (
            scatter.as_str(),
            &["scatter 2.count", "999500", "1000 before", "1000000"][..],
        ),
        (huge, &["object 2.mesh", "60000000", "50000000"]),
        (&lathe, &["object 1.mesh", "10002", "10000"]),
        (&instances, &["object", "triangles", "1431655765"]),
    ] {
        refuses(&format!("{CAMERA}{text}"), words);
    }
}

/// A pattern is made once, however many parts and objects show it.
#[test]
fn patterns_are_shared() {
    let object = "[[object]]\nmesh = { shape = 'quad' }\nmaterial = { color_map = { pattern = 'checker', size = 8 } }\n";
    let scene = load(&format!("{CAMERA}{object}{object}")).expect("loads");
    let map = |i: usize| scene.objects[i].materials[0].maps.color.clone();
    let (first, second) = (map(0).expect("a map"), map(1).expect("a map"));
    assert!(std::sync::Arc::ptr_eq(&first, &second));
}

/// Colours reflect at most all light; emission and background are radiance, lights have an intensity.
#[test]
fn colours_are_no_bytes() {
    let bytes = "color = [255, 0, 0]\n";
    let object = "[[object]]\nmesh = { shape = 'box' }\n";
    let scatter =
        "[[scatter]]\ncount = 1\nmin = [0, 0, 0]\nmax = [1, 1, 1]\nmesh = { shape = 'box' }\n";
    for (text, place) in [
        (
            format!("{object}[object.material]\n{bytes}"),
            "object 1.material.color",
        ),
        (format!("{scatter}{bytes}"), "scatter 1.color"),
        (
            format!("[[light]]\nposition = [1, 1, 1]\n{bytes}"),
            "light 1: color",
        ),
    ] {
        refuses(
            &format!("{CAMERA}{text}"),
            &[place, "255", "0 … 1", "divide"],
        );
    }
    let bright = format!(
        "background = [2, 2, 2]\n{CAMERA}[[light]]\nposition = [1, 1, 1]\nintensity = 30\n{object}[object.material]\nemission = [9, 0, 0]\n"
    );
    assert!(load(&bright).expect("loads").warnings.is_empty());
    let scene = load(&format!("background = [255, 255, 255]\n{CAMERA}{object}")).expect("loads");
    assert!(
        scene.warnings[0].contains("background"),
        "{:?}",
        scene.warnings
    );
}

/// A byte order mark before the first key; a name that is too long, and one that would clear a terminal.
#[test]
fn names_and_marks() {
    let named = |name: &str| format!("\u{feff}name = \"{name}\"\n{CAMERA}");
    assert_eq!(load(&named("a")).expect("loads").name, "a");
    refuses(&named(&"é".repeat(201)), &["name", "201", "200"]);
    let text = format!(
        "{CAMERA}[[object]]\nmesh = {{ shape = 'box' }}\nmaterial = {{ \"\\u001b[2J\\nx\" = 1 }}\n"
    );
    let Err(e) = load(&text) else { panic!("loads") };
    assert!(!e.to_string().contains(char::is_control), "{e:?}");
}
