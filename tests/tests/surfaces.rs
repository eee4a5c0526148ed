//! What surfaces look like, with every method: shading, images, light that takes a colour, emission, cut-outs.

use glam::{DVec3, Vec3};
use peelnet_core::{
    fragment::Fragment,
    guards::EMISSIVE_ALPHA,
    methods::over,
    shading::{self, Point},
    srgb,
};
use peelnet_render::gpu::Gpu;
use peelnet_render::{
    LayerFormula, LayerView, MethodOptions, MethodSpec, Renderer, methods::Precision,
};
use peelnet_scene::{Light, Lighting, Maps, Material, Scene, Source, Texture};
use peelnet_tests::{
    HALF, assert_alike, assert_all, assert_near, assert_refused, draw, even, gpu, light, scene,
    wall,
};
use std::sync::Arc;

/// Lit surfaces against the 64-bit reference, pixel by pixel: 1e-4 of the brightest. With and without a directional light; with and
/// without textures, whose values multiply the material's, and tilted normals.
#[test]
fn shading_is_the_twin_of_the_core() {
    let gpu = gpu();
    let lamps = [
        light(Vec3::new(1.0, 1.5, -0.5), [2.0, 1.0, 0.5]),
        light(Vec3::new(-2.0, 0.3, -1.0), [0.2, 0.9, 3.0]),
    ];
    let sun = Light {
        source: Source::Toward(Vec3::new(0.6, 0.0, 0.8)),
        ..light(Vec3::ZERO, [1.0, 0.8, 0.6])
    };
    for lighting in [Lighting::Phong, Lighting::Pbr] {
        for (first, second) in [(0.0, 0.05), (0.0, 0.5), (0.4, 0.3), (1.0, 0.2), (1.0, 1.0)] {
            for (mapped, sunny) in [(false, false), (false, true), (true, true)] {
                let mut material = Material::unlit([0.8, 0.5, 0.3], 0.5);
                material.lighting = lighting;
                (material.specular, material.shininess) = (first, 1.0 + 60.0 * second);
                (material.metallic, material.roughness) = (first, second);
                let mut lights = lamps.to_vec();
                lights.extend(sunny.then_some(sun));
                compare_with_the_reference(&gpu, material, &lights, mapped);
            }
        }
    }
}

fn compare_with_the_reference(gpu: &Gpu, mut material: Material, lights: &[Light], mapped: bool) {
    let size = [24u32, 16];
    let byte = |b: u8| f64::from(b) / 255.0;
    let mut color = DVec3::from(material.color.map(f64::from));
    let mut factors = [material.metallic, material.roughness].map(f64::from);
    let (mut normal, mut ambient) = (DVec3::Z, 1.0);
    let mut object = wall(3.0, material.clone());
    if mapped {
        material.maps = Maps {
            // GPUs may be off by a part of a byte where they decode sRGB, but not here.
            color: even([0, 255, 255, 255]),
            normal: even([168, 98, 240, 255]),
            metallic_roughness: even([7, 230, 140, 255]),
            occlusion: even([102, 0, 0, 255]),
            normal_scale: 0.5,
            occlusion_strength: 0.75,
            ..Maps::NONE
        };
        object = wall(3.0, material.clone());
        let mesh = Arc::make_mut(&mut object.mesh);
        mesh.colors = vec![[0.5, 1.0, 0.75, 0.8]; mesh.positions.len()];
        color *= DVec3::new(0.0, 1.0, 0.75);
        factors = [factors[0] * byte(140), factors[1] * byte(230)];
        ambient = 1.0 + 0.75 * (byte(102) - 1.0);
        normal = DVec3::new(0.5 * 40.0, 0.5 * -30.0, 112.0).normalize();
    }
    let alpha = if mapped { 0.5 * 0.8 } else { 0.5 };
    let mut scene = scene("lit", [0.0; 3], vec![object]);
    scene.lights = lights.to_vec();
    let image = draw(gpu, &scene, "abuffer", size);
    let lights = lights
        .iter()
        .map(peelnet_bench::stress::ground_truth::light);
    let lights: Vec<shading::Light> = lights.collect();
    for (i, pixel) in image.pixels.iter().enumerate() {
        let (x, y) = (i as u32 % size[0], i as u32 / size[0]);
        let aspect = f64::from(size[0]) / f64::from(size[1]);
        let ndc_x = (f64::from(x) + 0.5) / f64::from(size[0]) * 2.0 - 1.0;
        let ndc_y = 1.0 - (f64::from(y) + 0.5) / f64::from(size[1]) * 2.0;
        let at = Point {
            position: DVec3::new(ndc_x * aspect * 3.0, ndc_y * 3.0, -3.0),
            normal,
            eye: DVec3::ZERO,
            ambient,
        };
        let (specular, shininess) = (material.specular.into(), material.shininess.into());
        let want = match material.lighting {
            Lighting::Phong => shading::phong(&at, color, specular, shininess, &lights),
            _ => shading::physically_based(&at, color, factors[0], factors[1], &lights),
        };
        for k in 0..3 {
            let error = (f64::from(pixel[k]) - alpha * want[k]).abs();
            assert!(
                error <= 1e-4 * want[k].max(1.0),
                "{material:?}, mapped {mapped}: {pixel:?} for {want:?}"
            );
        }
    }
}

/// Four texels on a wall that shows them once: every method draws four squares, each at its UV and in linear light.
///
/// A single surface is exact but for half floats of sums up to 4: two roundings of 2⁻¹¹ each, and as many of what divides them.
#[test]
fn textures_follow_their_uvs() {
    let gpu = gpu();
    let texels = [
        [255, 0, 0, 255],
        [0, 188, 0, 255],
        [0, 0, 90, 255],
        [255, 255, 255, 153],
    ];
    let mut material = Material::unlit([1.0; 3], 1.0);
    material.maps.color = Some(Arc::new(Texture::of("four", [2, 2], |x, y| {
        texels[(2 * y + x) as usize]
    })));
    material.maps.nearest = true;
    let scene = scene("four", [0.0; 3], vec![wall(3.0, material)]);
    for spec in MethodSpec::all() {
        let image = draw(&gpu, &scene, &spec, [16, 12]);
        for (i, pixel) in image.pixels.iter().enumerate() {
            let quadrant = 2 * (i / 16 / 6) + i % 16 / 8;
            let [r, g, b, a] = texels[quadrant].map(|b| f32::from(b) / 255.0);
            let want = [r, g, b].map(|c| srgb::decode(c) * a);
            assert_near(*pixel, want, 4.0 * 4.0 * HALF, format!("{spec}, {i}"));
        }
    }
}

/// A pass that reads opacity alone draws two materials alike whose other images differ, each with its own bindings.
#[test]
fn passes_without_colour_take_any_images() {
    let gpu = gpu();
    let mut first = Material::unlit([0.9, 0.5, 0.2], 0.5);
    first.lighting = Lighting::Phong;
    first.maps.color = even([255, 255, 255, 204]);
    let mut second = first.clone();
    second.maps.normal = even([128, 128, 255, 255]);
    let objects = vec![wall(3.0, first.clone()), wall(5.0, second)];
    let mut both = scene("both", [0.2; 3], objects);
    both.lights.push(light(Vec3::new(0.5, 0.5, 1.0), [1.0; 3]));
    let mut alike = both.clone();
    alike.objects[1] = wall(5.0, first);
    for spec in MethodSpec::all() {
        let [a, b] = [&both, &alike].map(|s| draw(&gpu, s, &spec, [8, 6]).pixels);
        assert_alike(&a, &b, 1.0 / 255.0, &spec);
    }
}

/// A board much finer than pixels shows the mean of its light, and not one square or the other.
#[test]
fn fine_images_show_their_mean() {
    let gpu = gpu();
    let mut material = Material::unlit([1.0; 3], 1.0);
    material.maps.color = Some(Arc::new(Texture::of("board", [256, 256], |x, y| {
        let c = if (x + y) % 2 == 0 { 255 } else { 0 };
        [c, c, c, 255]
    })));
    let board = scene("board", [0.0; 3], vec![wall(3.0, material)]);
    let image = draw(&gpu, &board, "abuffer", [16, 12]);
    // The mean of light is kept in a byte.
    let step = srgb::decode(189.0 / 255.0) - srgb::decode(188.0 / 255.0);
    assert_all(&image, [0.5; 3], step, "board");
}

/// Stained glass: one pane is exact for every method that knows what light passes, two are for the exact one; the others say so.
#[test]
fn stained_glass_tints_what_is_behind_it() {
    let gpu = gpu();
    let c0 = [0.8, 0.6, 0.9];
    let pane = |passing: [f32; 3], alpha| Material {
        transmission: passing,
        ..Material::unlit([0.2, 0.1, 0.3], alpha)
    };
    let (first, second) = ([0.9, 0.5, 0.1], [0.2, 0.7, 0.4]);
    let through = |behind: [f32; 3], passing: [f32; 3], alpha: f32| {
        let color = [0.2, 0.1, 0.3];
        [0, 1, 2].map(|k| alpha * color[k] + behind[k] * (1.0 - alpha * (1.0 - passing[k])))
    };
    for alpha in [0.3, 1.0] {
        let one = scene("pane", c0, vec![wall(3.0, pane(first, alpha))]);
        let want = through(c0, first, alpha);
        for spec in MethodSpec::all() {
            if spec.guarantees().tinted {
                let exact = spec.guarantees().exact;
                let bound = if exact { 1e-6 } else { 6.0 * HALF };
                assert_all(&draw(&gpu, &one, &spec, [4, 3]), want, bound, &spec);
            } else {
                let renderer = Renderer::new(&gpu, &one).unwrap();
                let refused = renderer.method(&spec, MethodOptions::sized([4, 3]));
                assert_refused(refused, &["abuffer", "transmission_color"]);
            }
        }
        // Grey glass is a lower opacity, which every method knows.
        let grey = scene("grey", c0, vec![wall(3.0, pane([0.5; 3], alpha))]);
        let want = through(c0, [0.5; 3], alpha);
        for method in ["abuffer", "dual-peel", "painter-object", "wboit-eq9"] {
            let image = draw(&gpu, &grey, method, [4, 3]);
            assert_all(&image, want, 6.0 * HALF, method);
        }
    }
    let both = vec![wall(3.0, pane(first, 0.6)), wall(5.0, pane(second, 0.9))];
    let want = through(through(c0, second, 0.9), first, 0.6);
    let two = scene("panes", c0, both);
    // Also where storage is sorted and tiled.
    for method in ["abuffer", "abuffer:budget=6"] {
        assert_all(&draw(&gpu, &two, method, [4, 3]), want, 1e-6, method);
    }
}

const LAYERS: [[f32; 3]; 3] = [[0.9, 0.1, 0.0], [0.0, 0.8, 0.2], [0.1, 0.3, 1.0]];

/// Walls of these layers, one behind another.
fn layered(layers: &[u32]) -> Scene {
    let walls = layers.iter().zip(3..).map(|(layer, z)| {
        let mut wall = wall(z as f32, Material::unlit(LAYERS[*layer as usize], 1.0));
        wall.layer = Some(*layer);
        wall
    });
    scene("layers", [0.5; 3], walls.collect())
}

/// Walls of these layers, which one is highlighted by which formula, whether only increasing layers count, and how much of each layer's colour
/// is seen.
type LayerCase = (&'static [u32], u32, LayerFormula, bool, [f32; 3]);

const SIXTH: f32 = 1.0 / 6.0;

const LAYER_CASES: [LayerCase; 10] = {
    use LayerFormula::{Front, Printed};
    [
        // The highlighted layer takes half, those in front of it the other half in equal parts, what lies behind is gone.
        (&[0, 1, 2], 2, Front, false, [0.25, 0.25, 0.5]),
        (&[0, 1, 2], 0, Front, false, [1.0, 0.0, 0.0]),
        (&[0, 1, 2], 1, Front, false, [0.5, 0.5, 0.0]),
        // A ray that leaves again meets the outer layers once more, unless only new layers count.
        (&[0, 1, 0, 2], 2, Front, false, [2.0 * SIXTH, SIXTH, 0.5]),
        (&[0, 1, 0, 2], 2, Front, true, [0.25, 0.25, 0.5]),
        // As printed: the nearest fragment of the layer weighs a half, each other one a half over the number of all, in front or behind.
        (&[0, 1, 2], 1, Printed, false, [SIXTH, 0.5, SIXTH]),
        (&[0, 1, 2], 0, Printed, false, [0.5, SIXTH, SIXTH]),
        (&[2], 2, Printed, false, [0.0, 0.0, 0.5]),
        // A second fragment of the layer is one of the others; unless only new layers count, then it is none.
        (&[0, 1, 0, 2], 0, Printed, false, [0.625, 0.125, 0.125]),
        (&[0, 1, 0, 2], 0, Printed, true, [0.5, SIXTH, SIXTH]),
    ]
};

/// The view of the layers shows these parts of their colours.
fn check_layers(gpu: &Gpu, scene: &Scene, view: LayerView, parts: [f32; 3]) {
    let scene = scene.layer_view(view.highlight, false).unwrap();
    let renderer = Renderer::new(gpu, &scene).unwrap();
    let mut prepared = renderer.layers(view, [4, 3]).unwrap();
    let frame = renderer.image(&mut prepared, &scene.views[0]).unwrap();
    let want = [0, 1, 2].map(|k| (0..3).map(|layer| LAYERS[layer][k] * parts[layer]).sum());
    // Roundings of a handful of products of numbers up to 1.
    assert_near(frame.image.pixels[5], want, 1e-6, format!("{view:?}"));
}

/// Layers seen one by one. Through a hole in a layer the next one is seen; where the highlighted layer itself has the hole, the others share the
/// pixel, and as printed a half of them is left.
#[test]
fn layers_are_highlighted() {
    let gpu = gpu();
    let view = |highlight, formula, increasing| LayerView {
        highlight,
        increasing,
        formula,
    };
    for (layers, highlight, formula, increasing, parts) in LAYER_CASES {
        let view = view(highlight, formula, increasing);
        check_layers(&gpu, &layered(layers), view, parts);
    }
    let mut holed = layered(&[0, 1]);
    let front = &mut holed.objects[0].materials[0];
    front.maps.color = even([255, 255, 255, 90]);
    (front.alpha_cutoff, front.blend) = (Some(0.5), false);
    for (highlight, formula, share) in [
        (1, LayerFormula::Front, 1.0),
        (0, LayerFormula::Front, 1.0),
        (0, LayerFormula::Printed, 0.5),
    ] {
        let view = view(highlight, formula, false);
        check_layers(&gpu, &holed, view, [0.0, share, 0.0]);
    }
    assert_refused(layered(&[0, 1]).layer_view(7, false), &["7", "[0, 1]"]);
}

/// What is emitted comes beyond what is covered, for every method: a single surface is exact, down to an opacity of 0, where it
/// covers 2⁻¹⁰ so that weighted sums and 16-bit targets know of it.
///
/// Half floats of sums up to 4: two roundings of 2⁻¹¹ each, and as many of what divides them.
#[test]
fn emission_is_exact_on_a_single_surface() {
    let gpu = gpu();
    let c0 = [0.3, 0.2, 0.1];
    for alpha in [0.0, 0.01, 0.5, 1.0] {
        let mut material = Material::unlit([0.2, 0.6, 0.4], alpha);
        material.emission = [0.5, 0.0, 2.0];
        let scene = scene("lamp", c0, vec![wall(3.0, material.clone())]);
        let covered = alpha.max(EMISSIVE_ALPHA);
        let beyond = [0, 1, 2].map(|k| material.color[k] + material.emission[k] / covered);
        let f = Fragment::new(3.0, covered, beyond);
        let want = over::composite(&[f], c0);
        for spec in MethodSpec::all() {
            let faint = alpha < 0.5;
            // Weights that grow with the opacity leave half floats nothing of a faint surface.
            let spec = match faint && spec.method().has_targets() {
                true => spec.with("targets", "f32").unwrap(),
                false => spec,
            };
            // Of few samples none may see a faint surface; a coverage of 0.01 in half floats errs by a twentieth.
            let guarantees = spec.guarantees();
            if faint && (guarantees.noisy || guarantees.sums == Precision::Half) {
                continue;
            }
            let image = draw(&gpu, &scene, &spec, [4, 3]);
            let bound = if guarantees.exact { 1e-5 } else { 16.0 * HALF };
            assert_all(&image, want, bound, format!("{spec}, alpha {alpha}"));
        }
    }
}

/// An alpha below the cut-off is a hole, one above it is opaque, whatever it is.
#[test]
fn cut_outs_are_holes_or_opaque() {
    let gpu = gpu();
    let (hole, whole) = ([0.1, 0.1, 0.6], [0.9, 0.5, 0.1]);
    for (alpha, want) in [(0.29, hole), (0.31, whole), (1.0, whole)] {
        let material = Material {
            alpha_cutoff: Some(0.3),
            blend: false,
            ..Material::unlit([0.9, 0.5, 0.1], alpha)
        };
        let behind = wall(5.0, Material::unlit([0.0, 0.0, 1.0], 0.5));
        let scene = scene("holes", [0.2; 3], vec![wall(3.0, material), behind]);
        for method in ["abuffer", "wboit-eq9", "kbuffer-4"] {
            let image = draw(&gpu, &scene, method, [4, 3]);
            assert_all(&image, want, 1e-3, format!("{method} {alpha}"));
        }
    }
}
