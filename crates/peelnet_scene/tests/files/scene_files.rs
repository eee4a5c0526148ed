//! Scene files and mesh files as scenes, sound and bad, from files in memory.

use crate::{
    CAMERA, assert_all_refused, assert_framed, assert_refused, assert_says, image, load_at,
    load_files, ply, stl,
};
use glam::Vec3;
use peelnet_scene::{Blending, Lighting, Material, Scene, SceneError};
use std::{
    cell::RefCell,
    io,
    path::{Path, PathBuf},
    sync::Arc,
};

/// A square of four units in the plane z = 0.
const SQUARE: &str = "mtllib a.mtl\nv -2 -2 0\nv 2 -2 0\nv 2 2 0\nv -2 2 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nusemtl m\nf 1/1 2/2 3/3 4/4\n";

/// A scene file beside which there are a mesh and three images, at a time. The diffuse one is black, the specular one white with a glossiness of 0.4.
fn load_text_at(text: &str, time: Option<f32>) -> Result<Scene, String> {
    let [white, diffuse, specular] =
        [[255; 4], [0, 0, 0, 128], [255, 255, 255, 102]].map(|texel| image(&[texel]));
    let files: [(&str, &[u8]); 6] = [
        ("s.toml", text.as_bytes()),
        ("a.obj", SQUARE.as_bytes()),
        ("a.mtl", b"newmtl m\n"),
        ("white.png", &white),
        ("diffuse.png", &diffuse),
        ("specular.png", &specular),
    ];
    load_at(&files, time)
}

fn load(text: &str) -> Result<Scene, String> {
    load_text_at(&format!("{CAMERA}{text}\n"), None)
}

/// Bad scenes, one a line: keys behind a camera, where ` ; ` ends a line, and words of the error. It names the file, the line or key, and a fix.
const BAD: &str = "
[camera => s.toml:6
colour = 1 => s.toml:6 & colour
background = [.8, 1, 1] => s.toml:6 & write 0.8, not .8
fov_y = 180.0 => camera.fov_y & 180
fov_y = 1e-40 => camera.fov_y & 0.01 … 179
[orbit] ; views = 0 => orbit.views & 1
[[light]] ; position = [1, 1, 1] ; direction = [1, 0, 0] => light 1 & either
[[light]] ; direction = [0, 0, 0] => light 1 & not zero
[[light]] ; position = [1, 1, 1] ; color = [255, 0, 0] => light 1: color & 255 & 0 … 1 & divide
[[timeline]] ; time = 1 ; [[timeline]] ; time = 1 => timeline 2.time & later
[[timeline]] ; time = 1 ; [[timeline.object]] ; name = 'x' => timeline 1.object.name & 'x'
[[object]] ; name = 'x' ; mesh = { shape = 'box' } ; [[timeline]] ; time = 1 ; [[timeline.object]] ; name = 'x' ; [[timeline.object]] ; name = 'x' => timeline 1.object.name & twice
[[object]] ; mesh = { shape = 'sphere', radius = 3e38 } => object 1.mesh & radius
[[object]] ; mesh = { shape = 'sphere', radius = 1e-30 } => object 1.mesh & radius
[[object]] ; mesh = { shape = 'sphere', radius = -2 } => object 1.mesh & positive
[[object]] ; mesh = { shape = 'sphere', triangles = 3 } => object 1.mesh & triangles
[[object]] ; mesh = { shape = 'torus', tube = 2.0 } => object 1.mesh & tube
[[object]] ; mesh = { shape = 'sphere', tube = 2.0 } => s.toml:7 & tube
[[object]] ; mesh = { shape = 'cow' } => s.toml:7 & cow
[[object]] ; mesh = { shape = 'bumpy', amplitude = 0.9 } => object 1.mesh & amplitude
[[object]] ; mesh = { shape = 'lathe', profile = [[0, 0], [1, 1]] } => object 1.mesh & profile
[[object]] ; mesh = { shape = 'lathe', profile = [[0, 0], [-1, 1], [0, 2]] } => object 1.mesh & profile
[[object]] ; mesh = { shape = 'strands', segments = 0 } => object 1.mesh & segments
[[object]] ; mesh = { shape = 'strands', count = 20000000 } => object 1.mesh & 50000000
[[object]] ; mesh = { shape = 'strands', roots = 2.0 } => object 1.mesh & roots
[[object]] ; mesh = { shape = 'terrain', height = 0.0 } => object 1.mesh & height
[[object]] ; mesh = { shape = 'quad', size = [1e9, 1e9] } => object 1 & 65536 times
[[object]] ; mesh = { shape = 'quad' } ; translate = [0, 1e30, 0] => object 1 & reaches 1e30
[[object]] ; mesh = { shape = 'lathe', profile = [[0, -1e38], [1e38, 0], [0, 1e38]] } => object 1 & reaches
[[object]] ; mesh = { shape = 'sphere', raduis = 2 } => s.toml:7 & raduis & radius
[[object]] ; mesh = { radius = 2 } => s.toml:7 & with shape
[[object]] ; mesh = 'cow.fbx' => object 1.mesh & export the mesh as one of them
[[object]] ; mesh = 'none.obj' => none.obj & cannot read
[[object]] ; mesh = 7 => s.toml:7 & path or a table
[[object]] ; mesh = { shape = 'box' } ; scael = 2.0 => s.toml:8 & scael & scale
[[object]] ; mesh = { shape = 'box' } ; scale = 0.0 => object 1.scale & not 0
[[object]] ; mesh = { shape = 'box' } ; vertex_colors = [[0, 0, 0, 0], [2, 0, 0, 1]] => object 1.vertex_colors & 0 … 1
[scatter] ; min = [0, 0, 0] ; max = [1, 1, 1] ; count = 1 => scatter 1.mesh & either
[scatter] ; min = [0, 0, 0] ; max = [1, 1, 1] ; count = 1 ; mesh = { shape = 'box' } ; alpha = [0.5, 1.5] => scatter 1.alpha & 0 … 1
[scatter] ; min = [0, 0, 0] ; max = [1, 1, 1] ; count = 1 ; mesh = { shape = 'box' } ; color = [255, 0, 0] => scatter 1.color & 255 & divide
[scatter] ; min = [0, 0, 0] ; max = [1, 1, 1] ; count = 1 ; mesh = { shape = 'box' } ; color = 'red' => expected \"random\" or [r, g, b]
[scatter] ; min = [0, 0, 0] ; max = [1, 1, 1] ; count = 1 ; mesh = { shape = 'box' } ; rotate = 'x' => expected \"random\", \"camera\" or [x, y, z] degrees
[scatter] ; min = [0, 0, 0] ; max = [1, 1, 1] ; count = 4294967295 ; mesh = { shape = 'box' } => scatter 1.count & at most
[scatter] ; min = [0, 0, 0] ; max = [1, 1, 1] ; count = 1 ; mesh = { shape = 'box' } ; grid = [4294967295, 4294967295, 1] => scatter 1.grid & 65535
";

/// Bad materials of a mesh with texture coordinates, in a scene with a light.
const BAD_MATERIALS: &str = "
color = [255, 0, 0] => object 1.material.color & 255 & 0 … 1 & divide
alpha = 1.5 => object 1.material.alpha & 0 … 1
shininess = 0.5 => object 1.material.shininess & at least 1
emission = [0, -1, 0] => object 1.material.emission & at least 0
alpha_cutoff = 0.5 => object 1.material.alpha_cutoff & mask
lighting = 'toon' => s.toml:11 & phong
color_map = { pattern = 'noise', size = 1 } => object 1.material.color_map & 4 … 4096
color_map = { pattern = 'wood' } => wood & noise
color_map = 'none.png' => none.png & cannot read
metallic_roughness_map = { pattern = 'noise' } => metallic_roughness_map & pbr
displacement_scale = 1 => displacement_scale & add that
displacement_map = 'white.png' => displacement_map & needs displacement_scale
displacement_map = 'white.png' ; displacement_scale = inf => displacement_scale & must lie in
displacement_map = 'white.png' ; displacement_scale = 1 ; displacement_level = 11 => displacement_level & 0 … 10
displacement_map = 'none.png' ; displacement_scale = 1 => none.png & cannot read
glossiness = 0.5 => object 1.material.glossiness & pbr
lighting = 'pbr' ; glossiness = 2 => glossiness & 0 … 1
lighting = 'pbr' ; specular_color = [0, 2, 0] => specular_color & 0 … 1
lighting = 'pbr' ; glossiness = 1 ; roughness = 0 => glossiness & one of them
lighting = 'pbr' ; glossiness_map = 'white.png' ; specular_glossiness_map = 'white.png' => glossiness_map & one of them
lighting = 'pbr' ; specular_color_map = 'none.png' => none.png & cannot read
";

#[test]
fn bad_scene_files() {
    let material =
        "[[light]]\nposition = [1, 1, 1]\n[[object]]\nmesh = 'a.obj'\n[object.material]\n";
    assert_all_refused(BAD, load);
    assert_all_refused(BAD_MATERIALS, |text| load(&format!("{material}{text}")));
    for (good, bad, words) in [
        ("near = 0.1", "near = 200", "camera.near & below far"),
        ("near = 0.1", "near = 0", "camera.near & positive"),
        ("[0, 0, 6]", "[0, 0, 0]", "camera.target & differ"),
        ("[0, 0, 6]", "[0, 6, 0]", "camera.up & line of sight"),
        ("[0, 0, 6]", "[0, nan, 6]", "camera.position & finite"),
        (CAMERA, "name = \"x", "s.toml:1"),
        (CAMERA, "", "camera & add a [camera]"),
    ] {
        let text = CAMERA.replace(good, bad);
        assert_refused(load_text_at(&text, None), words);
    }
    let lights = "[[light]]\nposition = [1, 1, 1]\n".repeat(peelnet_scene::MAX_LIGHTS + 1);
    assert_refused(load(&lights), "light & 16385 lights & at most 16384");
    // The second of two scatters, on its own line.
    let scatter =
        "[[scatter]]\ncount = 1\nmesh = { shape = 'quad' }\nmin = [0, 0, 0]\nmax = [1, 1, 1]\n";
    let line = 1 + CAMERA.matches('\n').count() + 2 * scatter.matches('\n').count();
    let text = format!("{scatter}{scatter}bogus = 1\n");
    assert_refused(load(&text), &format!("s.toml:{line}: & bogus"));
    // A name that would clear a terminal.
    let text = "[[object]]\nmesh = { shape = 'box' }\nmaterial = { \"\\u001b[2J\\nx\" = 1 }\n";
    assert_refused(load(text), "s.toml");
}

/// What a small file multiplies is counted before it is made: each of these would take gigabytes.
#[test]
fn small_files_cannot_ask_for_endless_memory() {
    let scatter = |count: usize, mesh: &str| {
        format!(
            "[[scatter]]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\ncount = {count}\nmesh = {{ {mesh} }}\n"
        )
    };
    let object = |mesh: &str| format!("[[object]]\nmesh = {{ {mesh} }}\n");
    let quads = scatter(1000, "shape = 'quad'") + &scatter(999_500, "shape = 'quad'");
    let huge = object("shape = 'quad'") + &object("shape = 'sphere', triangles = 60_000_000");
    let points = "[0.5, 0.5], ".repeat(10_000);
    let lathe = object(&format!(
        "shape = 'lathe', profile = [[0, 0], {points} [0, 1]]"
    ));
    let instances = scatter(100_000, "shape = 'sphere', triangles = 20_000");
    let displaced = object("shape = 'sphere', triangles = 100_000")
        + "material = { displacement_map = 'white.png', displacement_scale = 1, displacement_level = 4 }";
    let state = |time| format!("[[timeline]]\ntime = {time}\n[[timeline.object]]\nname = 'a'\n");
    let states = (0..101).map(state).collect::<String>();
    let states = (object("shape = 'quad'") + "name = 'a'\n").repeat(10_000) + &states;
    for (text, words) in [
        (quads, "scatter 2.count & 999500 & 1000 before & 1000000"),
        (huge, "object 2.mesh & 60000000 & 50000000"),
        (lathe, "object 1.mesh & 10002 & 10000"),
        (instances, "object & triangles & 1431655765"),
        (states, "timeline & 1010000 changes & 1000000"),
        (
            displaced,
            "object 1.material.displacement_map & displacement_level of 3 or less",
        ),
    ] {
        assert_refused(load(&text), words);
    }
}

#[test]
fn transforms_apply_in_the_documented_order() {
    let text = "[[object]]\nmesh = { shape = 'box', size = [2, 4, 8] }\nfit = 1.0\nscale = 2.0\nrotate = [90, 0, 90]\ntranslate = [0, 0, 5]\n";
    let scene = load(text).unwrap();
    // fit: 0.25 × 0.5 × 1; scale: 0.5 × 1 × 2; turned about x: 0.5 × 2 × 1, about z: 2 × 0.5 × 1; moved by 5.
    let places = places(&scene).into_iter().map(|p| (p, p));
    let (lo, hi) = places
        .reduce(|(a, b), (p, _)| (a.min(p), b.max(p)))
        .unwrap();
    assert!((lo - Vec3::new(-1.0, -0.25, 4.5)).length() < 1e-5, "{lo}");
    assert!((hi - Vec3::new(1.0, 0.25, 5.5)).length() < 1e-5, "{hi}");
    // The turn about x takes y to z, where the one about z leaves it.
    let turned = scene.objects[0]
        .world_from_object
        .transform_vector3(Vec3::Y);
    assert!((turned.normalize() - Vec3::Z).length() < 1e-6, "{turned}");
}

/// The vertices of the first object, in the scene.
fn places(scene: &Scene) -> Vec<Vec3> {
    let object = &scene.objects[0];
    let place = |p: &Vec3| object.world_from_object.transform_point3(*p);
    object.mesh.positions.iter().map(place).collect()
}

/// An orbit, defaults, and patterns, which are made once, however many parts and objects show them.
#[test]
fn orbit_lights_and_defaults() {
    let object = "[[object]]\nmesh = { shape = 'quad' }\nmaterial = { alpha = 0.5, color_map = { pattern = 'checker', size = 8 } }\n";
    let text = format!("[orbit]\nviews = 4\n[[light]]\nposition = [4, 6, 4]\n{object}{object}");
    let scene = load(&text).unwrap();
    assert_eq!((scene.name.as_str(), scene.views.len()), ("s", 4));
    assert!((scene.views[1].position - Vec3::new(6.0, 0.0, 0.0)).length() < 1e-5);
    let m = &scene.objects[0].materials[0];
    assert_eq!((m.alpha, m.lighting), (0.5, Lighting::Phong));
    assert!(!m.is_opaque() && scene.hash.len() == 64);
    assert!(scene.transparent_bounds().is_some());
    let [first, second] = [0, 1].map(|i| scene.objects[i].materials[0].maps.color.clone().unwrap());
    assert!(Arc::ptr_eq(&first, &second));
}

/// Emission and background are radiance, lights have an intensity; a byte order mark before the first key; names.
#[test]
fn radiance_and_names() {
    let bright = "[[light]]\nposition = [1, 1, 1]\nintensity = 30\n[[object]]\nmesh = { shape = 'box' }\n[object.material]\nemission = [9, 0, 0]\n";
    for (background, warned) in [("[2, 2, 2]", false), ("[255, 255, 255]", true)] {
        let text = format!("\u{feff}name = 'a'\nbackground = {background}\n{CAMERA}{bright}");
        let scene = load_text_at(&text, None).unwrap();
        assert_eq!(scene.name, "a");
        let about = scene.warnings.iter().any(|w| w.contains("background"));
        assert_eq!(about, warned, "{:?}", scene.warnings);
    }
    let long = format!("name = '{}'\n{CAMERA}", "é".repeat(201));
    assert_refused(load_text_at(&long, None), "name & 201 & 200");
}

/// A pattern takes time by its texels, not by its cells: with all nodes of their grids, these would take minutes.
#[test]
fn small_patterns_of_many_cells_are_made_at_once() {
    let object = |seed: usize| {
        let map = format!("{{ pattern = 'noise', cells = 256, size = 4, seed = {seed} }}");
        format!("[[object]]\nmesh = {{ shape = 'quad' }}\nmaterial = {{ color_map = {map} }}\n")
    };
    let scene = load(&(0..1000).map(object).collect::<String>()).unwrap();
    assert_eq!(scene.objects.len(), 1000);
}

/// Numbers are interpolated between states; textures and meshes are those of the state before; what a state does not name stays as it was.
#[test]
fn a_scene_ages() {
    let object = "[[object]]\nname = 'pot'\nmesh = { shape = 'sphere' }\nmaterial = { color = [1, 0, 0], alpha = 0.2, normal_map = 'white.png' }\n";
    let states = "[[timeline]]\ntime = 0\nlabel = 'new'\n\
         [[timeline]]\ntime = 10\n[[timeline.object]]\nname = 'pot'\nmaterial = { alpha = 0.6, color_map = { pattern = 'noise', size = 8 }, normal_map = 'diffuse.png' }\n\
         [[timeline]]\ntime = 30\n[[timeline.object]]\nname = 'pot'\nmesh = { shape = 'box' }\nmaterial = { color = [0, 0, 1] }\n";
    let at = |time| load_text_at(&format!("{CAMERA}{object}{states}"), time);
    for (time, alpha, blue, mapped, name) in [
        (0.0, 0.2, 0.0, false, "sphere"),
        (5.0, 0.4, 0.0, false, "sphere"),
        (10.0, 0.6, 0.0, true, "sphere"),
        (20.0, 0.6, 0.5, true, "sphere"),
        (30.0, 0.6, 1.0, true, "box"),
    ] {
        let scene = at(Some(time)).unwrap();
        let (object, m) = (&scene.objects[0], &scene.objects[0].materials[0]);
        assert!((m.alpha - alpha).abs() < 1e-6, "{time}: {}", m.alpha);
        assert!((m.color[2] - blue).abs() < 1e-6, "{time}: {:?}", m.color);
        assert_eq!(m.maps.color.is_some(), mapped, "{time}");
        assert_eq!(object.mesh.parts[0].name, name, "{time}");
        assert_eq!((scene.time, scene.timeline.len()), (time, 3));
        // No command may replace what another state shows.
        let has = |name| scene.files.contains(&PathBuf::from(name));
        assert!(has("white.png") && has("diffuse.png"), "{time}");
    }
    // Without a time it is the first state.
    let first = at(None).unwrap();
    assert_eq!((first.time, first.timeline[0].label.as_str()), (0.0, "new"));
    assert_refused(at(Some(31.0)), "from 0 to 30");
    let none = load_text_at(&format!("{CAMERA}{object}"), Some(1.0));
    assert_refused(none, "add [[timeline]]");
}

fn assert_height(scene: &Scene, height: f32) {
    for p in places(scene) {
        assert!((p.z - height).abs() < 1e-6, "{p} is not {height} high");
    }
    let materials = scene.objects.iter().flat_map(|o| &o.materials);
    assert!(materials.into_iter().all(|m| m.maps.displacement.is_none()));
}

/// The scale of a displacement is a length of the scene, whatever the object's own lengths are; between states it is interpolated.
#[test]
fn displacements_are_lengths_of_the_scene() {
    let object = "[[object]]\nname = 'a'\nmesh = 'a.obj'\n";
    let material = "[object.material]\ndisplacement_map = 'white.png'\ndisplacement_scale = 0.25\ndisplacement_level = 3";
    for place in ["", "fit = 1.0\n", "scale = 10\n", "fit = 0.5\nscale = -3\n"] {
        let scene = load(&format!("{object}{place}{material}")).unwrap();
        assert_height(&scene, if place.contains('-') { -0.25 } else { 0.25 });
        assert_eq!(scene.triangles(), 2 << 6);
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
    let middle = format!("{object}{material}\ndisplacement_middle = 0.5");
    assert_height(&load(&middle).unwrap(), 0.125);
    let states = "[[timeline]]\ntime = 0\n[[timeline]]\ntime = 2\n[[timeline.object]]\nname = 'a'\nmaterial = { displacement_scale = 3 }\n";
    for (time, height) in [(0.0, 0.25), (0.5, 0.9375), (2.0, 3.0)] {
        let text = format!("{CAMERA}{object}{material}\n{states}");
        assert_height(&load_text_at(&text, Some(time)).unwrap(), height);
    }
    // A generated shape has texture coordinates where a map needs them; two objects of it are moved apart.
    let sphere = "[[object]]\nmesh = { shape = 'sphere' }\n";
    let map = "material = { displacement_map = { pattern = 'noise', size = 256 }, displacement_scale = 0.1 }\n";
    let scene = load(&format!("{sphere}{map}{sphere}")).unwrap();
    let radii = places(&scene).into_iter().map(Vec3::length);
    let (least, most) = radii.fold((9.0f32, 0.0f32), |(a, b), r| (a.min(r), b.max(r)));
    assert!(least > 0.9 && most > 1.02 && most < 1.11, "{least} {most}");
    assert!(scene.objects[1].mesh.triangles.len() < scene.objects[0].mesh.triangles.len());
}

/// `disp` of an MTL file: base + gain × luminance, in the file's own lengths. Alone, in a scene file, and scattered.
#[test]
fn displacements_of_mtl_files() {
    let white = image(&[[255; 4]]);
    for (statement, height) in [
        ("disp white.png", 1.0),
        ("map_disp -mm 0.25 0.5 white.png", 0.75),
        ("disp -mm -1 0.5 -clamp on white.png", -0.5),
    ] {
        let mtl = format!("newmtl m\nd 0.5\n{statement}\n");
        let object = format!("{CAMERA}[[object]]\nmesh = 'a.obj'\nscale = 2\n");
        let scatter = format!(
            "{CAMERA}[[scatter]]\ncount = 3\nmesh = 'a.obj'\nmin = [0, 0, 0]\nmax = [0, 0, 0]\n"
        );
        let files: [(&str, &[u8]); 3] = [
            ("a.obj", SQUARE.as_bytes()),
            ("a.mtl", mtl.as_bytes()),
            ("white.png", &white),
        ];
        let alone = load_files(&files).unwrap();
        assert_height(&alone, height);
        assert!(alone.warnings.is_empty(), "{:?}", alone.warnings);
        for (text, height) in [(object, 2.0 * height), (scatter, height)] {
            let with = [&[("s.toml", text.as_bytes())], &files[..]].concat();
            assert_height(&load_files(&with).unwrap(), height);
        }
    }
}

fn pbr(text: &str) -> Material {
    let head = "[[light]]\nposition = [1, 2, 3]\n[[object]]\nmesh = { shape = 'box' }\n";
    let text = format!("{head}[object.material]\nlighting = 'pbr'\n{text}");
    load(&text).unwrap().objects[0].materials[0].clone()
}

/// Specular colour and glossiness: a dielectric, whose colour stays, and an unlit surface.
#[test]
fn specular_and_glossiness() {
    let m = pbr("color = [0.2, 0.4, 0.6]\nglossiness = 0.9");
    assert!((m.color[1] - 0.4).abs() < 1e-3 && m.metallic < 1e-3);
    assert!((m.roughness - 0.1).abs() < 1e-6 && m.maps.metallic_roughness.is_none());
    let unlit = "[[object]]\nmesh = { shape = 'box' }\nmaterial = { color = [0.2, 0.4, 0.6], specular_color = [1, 1, 1] }";
    let scene = load(unlit).unwrap();
    assert_eq!(scene.objects[0].materials[0].color, [0.2, 0.4, 0.6]);
}

/// One texture with glossiness in its alpha, two of them, and a pattern.
#[test]
fn specular_textures() {
    let m = pbr("color_map = 'diffuse.png'\nspecular_glossiness_map = 'specular.png'");
    assert_eq!((m.color, m.metallic, m.roughness), ([1.0; 3], 1.0, 1.0));
    assert_eq!(m.maps.color.unwrap().texels[0], [255, 255, 255, 128]);
    let metal = m.maps.metallic_roughness.unwrap();
    assert_eq!(metal.texels[0], [255, 153, 255, 255]);
    assert!(m.blend);
    // As a map of its own, the specular colours' alpha says nothing, and the glossiness is the red of another.
    let m = pbr(
        "color = [0, 0, 0]\nspecular_color_map = 'specular.png'\nglossiness_map = 'diffuse.png'",
    );
    let metal = m.maps.metallic_roughness.unwrap();
    assert_eq!(metal.texels[0], [255, 255, 255, 255]);
    let m = pbr("glossiness_map = { pattern = 'checker', size = 8 }");
    let metal = m.maps.metallic_roughness.unwrap();
    let mut rough: Vec<u8> = metal.texels.iter().map(|t| t[1]).collect();
    rough.sort_unstable();
    rough.dedup();
    assert_eq!(rough, [0, 255]);
}

/// Numbers are interpolated between states; those in textures stay.
#[test]
fn states_of_glossiness() {
    let text = "[[light]]\nposition = [1, 2, 3]\n[[object]]\nname = 'a'\nmesh = { shape = 'box' }\n\
        material = { color = [0, 0, 0], lighting = 'pbr', specular_color = [1, 1, 1], glossiness = 1.0 }\n[[timeline]]\ntime = 0\n\
        [[timeline]]\ntime = 2\n[[timeline.object]]\nname = 'a'\nmaterial = { glossiness = 0.0 }\n\
        [[timeline]]\ntime = 4\n[[timeline.object]]\nname = 'a'\nmaterial = { specular_glossiness_map = 'specular.png' }\n";
    let at = |time: f32| {
        let scene = load_text_at(&format!("{CAMERA}{text}"), Some(time));
        scene.unwrap().objects[0].materials[0].clone()
    };
    assert_eq!(at(0.5).roughness, 0.25);
    let last = at(4.0);
    assert_eq!((last.roughness, last.metallic), (1.0, 1.0));
    assert!(last.maps.metallic_roughness.is_some());
}

const CUBE: &str = "mtllib cube.mtl\nv 1 1 1\nv 2 1 1\nv 2 2 1\nv 1 2 1\nv 1 1 2\nv 2 1 2\nv 2 2 2\nv 1 2 2\nusemtl m\n\
f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 3 4 8 7\nf 2 3 7 6\nf 1 5 8 4\n";

#[test]
fn an_obj_file_is_a_scene() {
    for name in ["cube.obj", "cube.OBJ", "Cube.Obj"] {
        let glass = b"newmtl m\nKd 0.2 0.4 0.6\nd 0.3\n";
        let scene = load_files(&[(name, CUBE.as_bytes()), ("cube.mtl", glass)]).unwrap();
        assert_framed(&scene);
        assert_eq!((scene.objects.len(), scene.triangles()), (1, 12));
        assert_eq!((scene.lights.len(), scene.files.len()), (2, 2));
        assert_eq!(scene.name.to_lowercase(), "cube");
        let m = &scene.objects[0].materials[0];
        assert_eq!((m.color, m.alpha), ([0.2, 0.4, 0.6], 0.3));
        assert_eq!((m.lighting, m.is_opaque()), (Lighting::Phong, false));
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
}

/// What is opaque stays so, and a warning says how to look through it. One pair of lights suits one kind of lighting: a material with a
/// roughness decides for all.
#[test]
fn materials_of_mesh_files() {
    let files: [(&str, &[u8]); 1] = [("a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")];
    let scene = load_files(&files).unwrap();
    assert!(scene.objects[0].materials[0].is_opaque());
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    assert!(scene.warnings[0].contains("opaque") && scene.warnings[0].contains("alpha = 0.5"));
    assert_refused(load_at(&files, Some(1.0)), "timeline");
    let obj = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\nusemtl b\nf 1 3 2\n";
    let mtl = b"newmtl a\nKd 1 0 0\nnewmtl b\nPr 0.5\n";
    let scene = load_files(&[("a.obj", obj.as_bytes()), ("m.mtl", mtl)]).unwrap();
    let materials = &scene.objects[0].materials;
    assert!(materials.iter().all(|m| m.lighting == Lighting::Pbr));
    // Physically based light falls off with the square of the distance, so it begins brighter.
    assert!(scene.lights[0].intensity > 3.0);
}

/// What blends in its file does so in a scatter; an opacity makes a cut-out transparent between its holes; that of vertices counts.
#[test]
fn materials_of_files_in_scenes() {
    let triangle = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nproperty uchar alpha\n\
        element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0 128\n1 0 0 128\n0 1 0 128\n3 0 1 2\n";
    let mut gltf = serde_json::json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
        "materials": [{"alphaMode": "MASK", "alphaCutoff": 0.25}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "b.bin"}],
    });
    let positions = [0f32, 0., 0., 1., 0., 0., 0., 1., 0.].map(f32::to_le_bytes);
    let masked = gltf.to_string();
    gltf["materials"][0] = serde_json::json!({});
    let opaque = gltf.to_string();
    let load = |text: &str| {
        let text = format!("{CAMERA}{text}");
        let files: [(&str, &[u8]); 4] = [
            ("s.toml", text.as_bytes()),
            ("a.ply", triangle.as_bytes()),
            ("m.gltf", masked.as_bytes()),
            ("b.bin", positions.as_flattened()),
        ];
        let m = load_files(&files).unwrap().objects[0].materials[0].clone();
        (m.is_opaque(), m.alpha_cutoff)
    };
    let scatter = "[[scatter]]\nmin = [0, 0, 0]\nmax = [1, 1, 1]\ncount = 1\n";
    for (text, material) in [
        ("mesh = 'a.ply'", (false, None)),
        ("mesh = 'm.gltf'", (true, Some(0.25))),
        ("mesh = 'm.gltf'\nalpha = 0.5", (false, Some(0.125))),
    ] {
        assert_eq!(load(&format!("{scatter}{text}")), material, "{text}");
        let text = text.replace("alpha = 0.5", "material = { alpha = 0.5 }");
        assert_eq!(load(&format!("[[object]]\n{text}")), material, "{text}");
    }
    let colors =
        "[[object]]\nmesh = { shape = 'quad' }\nvertex_colors = [[1, 0, 0, 0.5], [1, 0, 0, 1]]\n";
    assert!(!load(colors).0);
    assert!(load(&format!("{colors}material = {{ blend = false }}")).0);
    // An opaque scene says so, of whatever format.
    let files: [(&str, &[u8]); 2] = [
        ("m.gltf", opaque.as_bytes()),
        ("b.bin", positions.as_flattened()),
    ];
    let warnings = load_files(&files).unwrap().warnings.join("\n");
    assert_says(&warnings, "is opaque");
}

/// Splats have a colour and an opacity, and no other key; where a scene has any, it blends in display space unless it says otherwise.
#[test]
fn splats_in_scenes() {
    let object = "[[object]]\nmesh = { shape = 'splats', count = 9 }\nmaterial = { alpha = 0.5, color = [1, 0, 0], metallic = 1 }\n";
    let of = |head: &str, object: &str| {
        let text = format!("{head}\n{CAMERA}{object}");
        load_files(&[("s.toml", text.as_bytes())]).unwrap()
    };
    let scene = of("", object);
    let warnings = scene.warnings.join("\n");
    assert_says(
        &warnings,
        "object 1.material.metallic: changes nothing of splats",
    );
    assert!(
        !warnings.contains("alpha") && !warnings.contains("color"),
        "{warnings}"
    );
    assert_eq!(scene.blending, Blending::Display);
    assert_eq!(of("blending = 'linear'", object).blending, Blending::Linear);
    let quad = "[[object]]\nmesh = { shape = 'quad' }\n";
    assert_eq!(of("", quad).blending, Blending::Linear);
    assert_eq!(of("blending = 'display'", quad).blending, Blending::Display);
}

/// What belongs to a map, where there is none.
#[test]
fn values_without_their_maps_are_reported() {
    let object = "[[object]]\nmesh = { shape = 'quad' }\nmaterial = { normal_scale = 2, occlusion_strength = 1, wrap = 'clamp' }\n\
        [[scatter]]\nmesh = { shape = 'quad' }\ncount = 1\nmin = [0, 0, 0]\nmax = [1, 1, 1]\njitter = 1\n";
    let text = format!("{CAMERA}{object}");
    let scene = load_files(&[("s.toml", text.as_bytes())]).unwrap();
    let warnings = scene.warnings.join("\n");
    let words = "material.normal_scale: changes nothing & material.occlusion_strength: & material.wrap: & scatter 1.jitter: changes nothing";
    assert_says(&warnings, words);
    let text = text.replace(
        "wrap =",
        "color_map = { pattern = 'noise', cells = 4, colors = [[1, 1, 1], [0, 0, 0]] }, wrap =",
    );
    let scene = load_files(&[("s.toml", text.as_bytes())]).unwrap();
    assert!(
        !scene.warnings.join("\n").contains("wrap"),
        "{:?}",
        scene.warnings
    );
}

/// Tiny, far from the origin, and so large that lengths overflow.
#[test]
fn any_size_is_framed_or_refused() {
    for (scale, offset) in [(1e-5, 0.0), (1e12, 0.0), (1.0, 1e6), (1e-3, -1e4)] {
        let v = |x: f32, y: f32| format!("v {} {} {offset}\n", x * scale + offset, y * scale);
        let obj = format!("{}{}{}f 1 2 3\n", v(0.0, 0.0), v(1.0, 0.0), v(0.0, 1.0));
        assert_framed(&load_files(&[("a.obj", obj.as_bytes())]).unwrap());
    }
    let huge = b"v 0 0 0\nv 1e30 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_refused(load_files(&[("a.obj", huge)]), "a.obj & scale it down");
}

/// One file of either format.
#[test]
fn scans_are_scenes() {
    let ply = ply::square_text().replace(" 0 255\n", " 0 128\n");
    let stl = stl::text(&stl::cube());
    let scene = load_files(&[("scan.PLY", ply.as_bytes())]).unwrap();
    assert_framed(&scene);
    // Its opacity is the file's.
    assert!(!scene.objects[0].materials[0].is_opaque());
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let scene = load_files(&[("part.Stl", stl.as_bytes())]).unwrap();
    assert_framed(&scene);
    assert!(scene.objects[0].materials[0].is_opaque());
    assert!(scene.warnings[0].contains("opaque"));
}

/// A scene file that names an OBJ file with a library, a glTF file with a buffer, and images, most of them in more than one place.
pub fn room() -> Vec<(&'static str, Vec<u8>)> {
    let objects = "[[object]]\nmesh = 'meshes/a.obj'\n[[object]]\nmesh = 'meshes/b.gltf'\n\
        [[object]]\nmesh = { shape = 'sphere' }\nmaterial = { color_map = 'image.png', emissive_map = 'image.png' }\n";
    let positions: [f32; 9] = [0., 0., 0., 1., 0., 0., 0., 1., 0.];
    let buffer = positions.iter().flat_map(|x| x.to_le_bytes()).collect();
    let mtl = "newmtl m\nmap_Kd a.png\nmap_Ke a.png\n";
    let gltf = serde_json::json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": "c.png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "buffers": [{"byteLength": 36, "uri": "../a%20buffer.bin"}],
    });
    vec![
        ("room/image.png", image(&[[9; 4]])),
        ("room/meshes/../a buffer.bin", buffer),
        ("room/meshes/a.mtl", mtl.into()),
        ("room/meshes/a.obj", SQUARE.into()),
        ("room/meshes/a.png", image(&[[9, 9, 9, 255]])),
        ("room/meshes/b.gltf", gltf.to_string().into()),
        ("room/meshes/c.png", image(&[[9; 4]])),
        ("room/scene.toml", format!("{CAMERA}{objects}").into()),
    ]
}

pub fn write_room() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (path, bytes) in room() {
        let path = folder.path().join(path);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    }
    folder
}

/// Loads the room without one of its files; returns the files that were read too.
fn load_room(missing: &str) -> (Result<Scene, SceneError>, Vec<PathBuf>) {
    let files = room();
    let read = RefCell::new(Vec::new());
    let scene = Scene::from_bytes("room/scene.toml", |path| {
        read.borrow_mut().push(path.to_owned());
        let found = files.iter().find(|(name, _)| Path::new(name) == path);
        let found = found.filter(|(name, _)| *name != missing);
        let bytes = found.map(|(_, bytes)| bytes.clone());
        bytes.ok_or(io::ErrorKind::NotFound.into())
    });
    (scene, read.into_inner())
}

/// Every file is read once through the function; the file system gives the same scene. One that is missing is an error with its path.
#[test]
fn files_come_from_a_function() {
    let (scene, mut read) = load_room("");
    let scene = scene.unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    read.sort();
    let names: Vec<PathBuf> = room().into_iter().map(|(name, _)| name.into()).collect();
    assert_eq!(read, names);
    let loaded = Scene::load(write_room().path().join("room/scene.toml")).unwrap();
    assert_eq!(loaded.hash, scene.hash);
    for name in ["scene.toml", "meshes/a.obj", "meshes/b.gltf", "image.png"] {
        let missing = Path::new("room").join(name);
        let e = load_room(missing.to_str().unwrap()).0.unwrap_err();
        let is_named = matches!(&e, SceneError::Read { path, .. } if *path == missing);
        assert!(is_named, "{e}");
    }
}
