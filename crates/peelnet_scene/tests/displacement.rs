//! Displacement maps in scene files and MTL files.

#![allow(clippy::unwrap_used, reason = "a failing test may panic")]

use glam::Vec3;
use peelnet_scene::Scene;
use std::{io, path::Path};

/// A square of four units in the plane z = 0.
const SQUARE: &str = "mtllib a.mtl\nv -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n";

const HEAD: &str = "[camera]\nposition = [0, 0, 6]\ntarget = [0, 0, 0]\nnear = 0.1\nfar = 100\n[[object]]\nname = 'a'\n";

fn read(path: &Path, scene: &str, mtl: &str) -> io::Result<Vec<u8>> {
    match path.to_str().unwrap() {
        "s.toml" => Ok(scene.as_bytes().to_vec()),
        "a.obj" => Ok(SQUARE.as_bytes().to_vec()),
        "a.mtl" => Ok(mtl.as_bytes().to_vec()),
        "white.png" => {
            let mut bytes = io::Cursor::new(Vec::new());
            let image = image::GrayImage::from_pixel(2, 2, image::Luma([255]));
            image.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
            Ok(bytes.into_inner())
        }
        _ => Err(io::ErrorKind::NotFound.into()),
    }
}

fn load_at(name: &str, scene: &str, mtl: &str, time: Option<f32>) -> Result<Scene, String> {
    let scene = Scene::from_bytes_at(name, time, |path| read(path, scene, mtl));
    scene.map_err(|e| e.to_string())
}

fn load(text: &str) -> Result<Scene, String> {
    load_at("s.toml", &format!("{HEAD}{text}\n"), "newmtl m\n", None)
}

/// The vertices of an object, in the scene.
fn places(scene: &Scene) -> Vec<Vec3> {
    let object = &scene.objects[0];
    let positions = object.mesh.positions.iter();
    positions
        .map(|p| object.world_from_object.transform_point3(*p))
        .collect()
}

fn assert_height(scene: &Scene, height: f32) {
    for p in places(scene) {
        assert!((p.z - height).abs() < 1e-6, "{p} is not {height} high");
    }
}

/// The scale is a length of the scene, whatever the object's own lengths are.
#[test]
fn scales_are_lengths_of_the_scene() {
    let material = "[object.material]\ndisplacement_map = 'white.png'\ndisplacement_scale = 0.25\ndisplacement_level = 3";
    for place in ["", "fit = 1.0\n", "scale = 10\n", "fit = 0.5\nscale = -3\n"] {
        let scene = load(&format!("mesh = 'a.obj'\n{place}{material}")).unwrap();
        let height = if place.contains('-') { -0.25 } else { 0.25 };
        assert_height(&scene, height);
        assert_eq!(scene.triangles(), 2 << 6);
        assert!(scene.objects[0].materials[0].maps.displacement.is_none());
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
    let middle = format!("mesh = 'a.obj'\n{material}\ndisplacement_middle = 0.5");
    assert_height(&load(&middle).unwrap(), 0.125);
    // A generated shape has texture coordinates where a map needs them; two objects of it are moved apart.
    let sphere = "mesh = { shape = 'sphere' }\nmaterial = { displacement_map = { pattern = 'noise', size = 256 }, displacement_scale = 0.1 }";
    let scene = load(&format!(
        "{sphere}\n[[object]]\nmesh = {{ shape = 'sphere' }}"
    ))
    .unwrap();
    let radii = places(&scene).into_iter().map(Vec3::length);
    let (least, most) = radii.fold((9.0f32, 0.0f32), |(a, b), r| (a.min(r), b.max(r)));
    assert!(least > 0.9 && most > 1.02 && most < 1.11, "{least} {most}");
    assert!(scene.objects[1].mesh.triangles.len() < scene.objects[0].mesh.triangles.len());
}

/// Between states the scale is interpolated, as other numbers are.
#[test]
fn states_of_a_timeline() {
    let text = format!(
        "{HEAD}mesh = 'a.obj'\nmaterial = {{ displacement_map = 'white.png', displacement_scale = 1 }}\n[[timeline]]\ntime = 0\n\
         [[timeline]]\ntime = 2\n[[timeline.object]]\nname = 'a'\nmaterial = {{ displacement_scale = 3 }}\n"
    );
    for (time, height) in [(0.0, 1.0), (0.5, 1.5), (2.0, 3.0)] {
        let scene = load_at("s.toml", &text, "newmtl m\n", Some(time)).unwrap();
        assert_height(&scene, height);
    }
}

/// `disp` of an MTL file: base + gain × luminance, in the file's own lengths. Alone, in a scene file, and scattered.
#[test]
fn mtl_files() {
    for (statement, height) in [
        ("disp white.png", 1.0),
        ("map_disp -mm 0.25 0.5 white.png", 0.75),
        ("disp -mm -1 0.5 -clamp on white.png", -0.5),
    ] {
        let mtl = format!("newmtl m\nd 0.5\n{statement}\n");
        let alone = load_at("a.obj", "", &mtl, None).unwrap();
        assert_height(&alone, height);
        assert!(alone.warnings.is_empty(), "{:?}", alone.warnings);
        assert!(alone.objects[0].materials[0].maps.displacement.is_none());
        let file = format!("{HEAD}mesh = 'a.obj'\nscale = 2\n");
        assert_height(&load_at("s.toml", &file, &mtl, None).unwrap(), 2.0 * height);
        let head = HEAD.replace("[[object]]\nname = 'a'\n", "");
        let scatter = format!(
            "{head}[[scatter]]\ncount = 3\nmesh = 'a.obj'\nmin = [0, 0, 0]\nmax = [0, 0, 0]\nrotate = [0, 0, 0]\n"
        );
        let scattered = load_at("s.toml", &scatter, &mtl, None).unwrap();
        assert_height(&scattered, height);
        let materials = scattered.objects.iter().flat_map(|o| &o.materials);
        assert!(materials.into_iter().all(|m| m.maps.displacement.is_none()));
    }
}

#[test]
fn bad_displacements() {
    let with = |text: &str| format!("mesh = 'a.obj'\n[object.material]\n{text}");
    let map = "displacement_map = 'white.png'";
    for (text, words) in [
        (with("displacement_scale = 1"), ["displacement_scale", "add that"]),
        (with(map), ["displacement_map", "needs displacement_scale"]),
        (with(&format!("{map}\ndisplacement_scale = inf")), ["displacement_scale", "finite"]),
        (
            with(&format!("{map}\ndisplacement_scale = 1\ndisplacement_level = 11")),
            ["displacement_level", "0 … 10"],
        ),
        (
            format!("mesh = {{ shape = 'sphere', triangles = 100_000 }}\nmaterial = {{ {map}, displacement_scale = 1, displacement_level = 9 }}").replace("png'\n", "png',"),
            ["object 1.material.displacement_map", "displacement_level of 4 or less"],
        ),
        (with("displacement_map = 'none.png'\ndisplacement_scale = 1"), ["none.png", "cannot read"]),
    ] {
        let e = load(&text).unwrap_err();
        for word in words {
            assert!(e.contains(word), "no '{word}' in: {e}");
        }
    }
}
