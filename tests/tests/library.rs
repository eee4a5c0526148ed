//! The renderer as a library: frames encoded onto a caller's targets, scenes that change in place, devices of an application's own.

use std::sync::Arc;

use glam::{Mat4, Vec3};
use peelnet_core::fragment::{Fragment, worked_example};
use peelnet_render::geometry::frame::{attachment, clear_color};
use peelnet_render::gpu::{Gpu, GpuError, record::Recorder, wgpu};
use peelnet_render::{
    FrameStatus, Image, MethodOptions, MethodSpec, Prepared, RenderError, Renderer, Target,
};
use peelnet_scene::{Camera, Light, Lighting, Material, Object, Scene, Source};
use peelnet_tests::{
    assert_alike, assert_all, assert_refused, gpu, light, object, opaque, prepare, representatives,
    scene, wall, walls, window_depth,
};

/// Submits a pass that draws nothing.
fn submit_pass(
    gpu: &Gpu,
    colors: &[Option<wgpu::RenderPassColorAttachment<'_>>],
    depth: Option<wgpu::RenderPassDepthStencilAttachment<'_>>,
) {
    let mut encoder = gpu.encoder();
    drop(Recorder::new(gpu, &mut encoder, None).render("nothing", colors, depth));
    gpu.queue.submit([encoder.finish()]);
}

/// A texture to draw onto, cleared to a colour.
fn target(
    gpu: &Gpu,
    format: wgpu::TextureFormat,
    size: [u32; 2],
    samples: u32,
    color: [f32; 3],
) -> wgpu::TextureView {
    let none = wgpu::TextureUsages::empty();
    let view = gpu.texture("target", format, size, samples, none).unwrap();
    let [r, g, b] = color.map(f64::from);
    submit_pass(gpu, &[clear_color(&view, [r, g, b, 1.0])], None);
    view
}

const FULL: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// A depth buffer, cleared to the window depth of a linear depth.
fn depth_buffer(gpu: &Gpu, size: [u32; 2], samples: u32, z: f32) -> wgpu::TextureView {
    let none = wgpu::TextureUsages::empty();
    let format = wgpu::TextureFormat::Depth32Float;
    let view = gpu.texture("depth", format, size, samples, none).unwrap();
    let cleared = wgpu::RenderPassDepthStencilAttachment {
        view: &view,
        depth_ops: Some(wgpu::Operations {
            load: wgpu::LoadOp::Clear(window_depth(z)),
            store: wgpu::StoreOp::Store,
        }),
        stencil_ops: None,
    };
    submit_pass(gpu, &[], Some(cleared));
    view
}

/// Encodes a frame, submits it and waits.
fn draw(
    renderer: &Renderer,
    method: &mut Prepared,
    camera: &Camera,
    target: &Target<'_>,
) -> FrameStatus {
    let gpu = renderer.gpu();
    let mut encoder = gpu.encoder();
    let status = renderer.draw(&mut encoder, method, camera, target).unwrap();
    gpu.queue.submit([encoder.finish()]);
    gpu.wait().unwrap();
    status
}

/// What a frame draws over a target of 32 bits that holds a colour.
fn drawn_over(
    renderer: &Renderer,
    method: &mut Prepared,
    size: [u32; 2],
    behind: [f32; 3],
) -> (FrameStatus, Vec<[f32; 4]>) {
    let (gpu, camera) = (renderer.gpu(), &renderer.scene().views[0]);
    let view = target(gpu, FULL, size, 1, behind);
    let status = draw(renderer, method, camera, &Target::over(&view));
    (status, gpu.read_texture(&view).unwrap())
}

fn image(renderer: &Renderer, method: &mut Prepared) -> Image {
    let frame = renderer.image(method, &renderer.scene().views[0]);
    frame.unwrap().image
}

/// Every method ready for a scene, the learned ones with their shipped networks.
fn methods(renderer: &Renderer, size: [u32; 2]) -> Vec<(Prepared, MethodSpec)> {
    let ready = |spec: MethodSpec| (prepare(renderer, &spec, size), spec);
    representatives().into_iter().map(ready).collect()
}

/// A method that learns from the last frame draws the small pass where there is none, or another camera's; between, it makes a frame of the one
/// before, which is not the same.
#[test]
fn frames_begin_anew_after_a_jump() {
    let gpu = gpu();
    let size = [64, 48];
    let scene = peelnet_scene::suite::load("cups").unwrap();
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let [mut small, mut last] = ["one", "one:range=last"].map(|m| prepare(&renderer, m, size));
    let view = target(&gpu, FULL, size, 1, [0.0; 3]);
    let frame = |method: &mut Prepared, camera: &Camera| {
        draw(&renderer, method, camera, &Target::cleared(&view));
        gpu.read_texture::<[f32; 4]>(&view).unwrap()
    };
    let here = scene.views[0];
    for camera in [here, here.orbited(40.0)] {
        let expected = frame(&mut small, &camera);
        assert_eq!(frame(&mut last, &camera), expected);
        let moved = camera.orbited(0.1);
        assert_ne!(frame(&mut last, &moved), frame(&mut small, &moved));
    }
}

/// Blending onto a 32-bit target adds the rounding of a product and a sum to what the image has: 2^-23 of values up to 2.
const BLENDED: f32 = 4.0 * f32::EPSILON;

/// What every method draws over the colour that a target holds is what it draws over a background of that colour, in two frames at
/// most; opaque objects of the scene hide what lies behind them there as well.
#[test]
fn every_method_draws_over_what_a_target_holds() {
    let gpu = gpu();
    let size = [7, 5];
    let behind = [0.1, 0.2, 0.9];
    let mut objects = walls(&worked_example(), behind).objects;
    objects.push(wall(5.0, opaque([0.3, 0.6, 0.1])));
    // In a corner of the frame only.
    let corner = objects.len() - 1;
    objects[corner].world_from_object = Mat4::from_translation(Vec3::new(6.0, 6.0, 0.0));
    let scene = scene("over", behind, objects);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let camera = scene.views[0];
    for (mut method, spec) in methods(&renderer, size) {
        let straight = spec.guarantees().straight;
        let image = if straight {
            // The target below has 32 bits.
            let full = format!("{spec}:targets=f32");
            image(&renderer, &mut prepare(&renderer, full, size))
        } else {
            image(&renderer, &mut method)
        };
        let frames = [(); 3].map(|()| drawn_over(&renderer, &mut method, size, behind));
        assert_eq!(frames[2].0, FrameStatus::Whole, "{spec}");
        // The second frame has the room that the first one needed.
        for (_, found) in &frames[1..] {
            assert_alike(found, &image.pixels, BLENDED, &spec);
        }
        let covers = |p: &[f32; 4]| (p[3] - 1.0).abs() <= BLENDED;
        assert!(frames[2].1.iter().all(covers), "{spec}");
        // With the scene's own background the same.
        let view = target(&gpu, FULL, size, 1, [0.0; 3]);
        draw(&renderer, &mut method, &camera, &Target::cleared(&view));
        let found = gpu.read_texture(&view).unwrap();
        assert_alike(&found, &image.pixels, BLENDED, format!("{spec} cleared"));
    }
}

/// The resolve covers every pixel that a transparent surface touches, wherever it stands: small ones all over the frame and across
/// its edges, one that reaches behind the eye, and none at all.
#[test]
fn all_that_is_touched_is_resolved() {
    let gpu = gpu();
    let size = [24, 16];
    let behind = [0.1, 0.2, 0.9];
    let triangle = |points| object(&[points], Material::unlit([0.9, 0.5, 0.1], 0.5));
    let mut cases: Vec<Vec<Object>> = vec![Vec::new()];
    for i in 0..7 {
        for j in 0..5 {
            let middle = Vec3::new(2.0 * i as f32 - 6.0, 2.0 * j as f32 - 4.0, -4.0);
            let corners = [[-0.9, -0.6], [1.2, 0.0], [-0.3, 0.9]];
            let corners = corners.map(|[x, y]| middle + Vec3::new(x, y, 0.2 * x));
            cases.push(vec![triangle(corners)]);
        }
    }
    let behind_the_eye = [[0.4, 0.1, 3.0], [0.5, 0.3, -3.0], [0.9, -0.4, -3.0]];
    cases.push(vec![triangle(behind_the_eye.map(Vec3::from))]);
    let mut seen = 0;
    for (number, objects) in cases.into_iter().enumerate() {
        let scene = scene("touched", behind, objects);
        let renderer = Renderer::new(&gpu, &scene).unwrap();
        for name in ["wboit-eq9:targets=f32", "dual-peel", "linked-list"] {
            let mut method = prepare(&renderer, name, size);
            let image = image(&renderer, &mut method);
            let frames = [(); 2].map(|()| drawn_over(&renderer, &mut method, size, behind));
            let what = format!("{name} {number}");
            assert_alike(&frames[1].1, &image.pixels, BLENDED, what);
            seen += usize::from(image.pixels.iter().any(|p| p[0] > 0.2));
        }
    }
    assert!(seen > 3 * 25, "{seen} pictures show anything");
}

/// Targets of other formats hold the same picture in their encoding, within one step: the rounding of the background and of the blend.
#[test]
fn formats_keep_the_picture() {
    let gpu = gpu();
    let size = [4, 3];
    let behind = [0.25, 0.5, 0.75];
    let scene = walls(&worked_example(), behind);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let mut method = prepare(&renderer, "abuffer", size);
    let image = image(&renderer, &mut method);
    use wgpu::TextureFormat as F;
    for (format, is_srgb, red) in [
        (F::Rgba8Unorm, false, 0),
        (F::Bgra8Unorm, false, 2),
        (F::Rgba8UnormSrgb, true, 0),
        (F::Bgra8UnormSrgb, true, 2),
    ] {
        let view = target(&gpu, format, size, 1, behind);
        for _ in 0..2 {
            let cleared = Target::cleared(&view);
            draw(&renderer, &mut method, &scene.views[0], &cleared);
        }
        let bytes: Vec<[u8; 4]> = gpu.read_texture(&view).unwrap();
        for (found, exact) in bytes.iter().zip(&image.pixels) {
            for k in 0..3 {
                let at = if k == 1 { 1 } else { red ^ k };
                let encoded = if is_srgb {
                    peelnet_core::srgb::encode(exact[k])
                } else {
                    exact[k]
                };
                let apart = (f32::from(found[at]) - 255.0 * encoded).abs();
                assert!(apart <= 1.5, "{format:?}: {found:?}, not {exact:?}");
            }
        }
    }
}

/// A frame of more fragments than the first guess says so one frame later, and is whole in that one.
#[test]
fn frames_that_were_too_small_grow() {
    let gpu = gpu();
    let size = [6, 4];
    let layers: Vec<_> = (0..40)
        .map(|i| Fragment::new(1.0 + 0.1 * i as f32, 0.1, [0.9, 0.1 * (i % 9) as f32, 0.3]))
        .collect();
    let scene = walls(&layers, [0.2; 3]);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    // With a budget, a frame of many tiles.
    let all = "abuffer abuffer:budget=100 linked-list depth-peel dual-peel";
    for name in all.split(' ') {
        let mut method = prepare(&renderer, name, size);
        let exact = image(&renderer, &mut method);
        let frames = [(); 3].map(|()| drawn_over(&renderer, &mut method, size, [0.2; 3]));
        let statuses = [0, 1, 2].map(|i: usize| frames[i].0);
        use FrameStatus::{Grown, Unknown, Whole};
        assert_eq!(statuses, [Unknown, Grown, Whole], "{name}");
        let mut pairs = frames[0].1.iter().zip(&exact.pixels);
        let differs = pairs.any(|(a, b)| (a[0] - b[0]).abs() > 0.01);
        assert!(differs, "{name}: the first frame had room for all");
        for (_, pixels) in &frames[1..] {
            assert_alike(pixels, &exact.pixels, 8.0 * BLENDED, name);
        }
    }
}

/// The depth that a caller drew hides what lies behind it, with one sample a pixel and with four.
#[test]
fn a_callers_depth_hides() {
    let gpu = gpu();
    let fragments = worked_example();
    let scene = walls(&fragments, [0.1, 0.2, 0.9]);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let camera = scene.views[0];
    let near = fragments.iter().copied().filter(|f| f.depth < 3.0);
    let near = walls(&near.collect::<Vec<_>>(), [0.1, 0.2, 0.9]);
    let size = [4, 4];
    let format = wgpu::TextureFormat::Rgba16Float;
    let float = |bits| half::f16::from_bits(bits).to_f32();
    for samples in [1, 4] {
        for name in ["wboit-eq9", "abuffer"] {
            let mut method = prepare(&renderer, name, size);
            let exact = peelnet_tests::draw(&gpu, &near, name, size);
            let of = |samples| target(&gpu, format, size, samples, [0.0; 3]);
            let (color, single) = (of(samples), of(1));
            let depth = depth_buffer(&gpu, size, samples, 3.0);
            for _ in 0..2 {
                let target = Target {
                    color: &color,
                    depth: Some(&depth),
                    clear: true,
                };
                draw(&renderer, &mut method, &camera, &target);
            }
            let mut shown = &color;
            if samples > 1 {
                // The mean of the samples.
                let mut samples = attachment(&color, wgpu::LoadOp::Load).unwrap();
                samples.resolve_target = Some(&single);
                submit_pass(&gpu, &[Some(samples)], None);
                shown = &single;
            }
            let texels: Vec<[u16; 4]> = gpu.read_texture(shown).unwrap();
            let texels = texels.into_iter().map(|p| p.map(float));
            let found: Vec<[f32; 4]> = texels.collect();
            // Half floats of values up to 1: 2^-11 for the background and as much for the blend.
            assert_alike(&found, &exact.pixels, 1e-3, format!("{name} x{samples}"));
        }
    }
}

/// A scene of two objects with one light, one of them lit.
fn lit_scene() -> Scene {
    let mut all = walls(&worked_example(), [0.1, 0.2, 0.3]);
    for material in &mut all.objects[1].materials {
        material.lighting = Lighting::Phong;
    }
    all.lights = vec![light(Vec3::new(1.0, 2.0, 1.0), [1.0, 0.9, 0.8])];
    // Two triangles that share two of their vertices.
    let mut object = all.objects[0].clone();
    let mesh = Arc::make_mut(&mut object.mesh);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [2.0, 1.0]];
    mesh.positions = corners.map(|[x, y]| Vec3::new(x, y, -3.0)).to_vec();
    mesh.normals = vec![Vec3::Z; 4];
    mesh.triangles = vec![[0, 1, 2], [2, 1, 3]];
    mesh.parts[0].triangles = 0..2;
    all.objects.push(object);
    all
}

/// A renderer whose scene changed draws, to the bit, what a renderer of the changed scene draws; and only changes of what a material needs
/// compile pipelines.
#[test]
fn scenes_change_in_place() {
    let gpu = gpu();
    let scene = lit_scene();
    let mut renderer = Renderer::new(&gpu, &scene).unwrap();
    let specs = ["mboit4", "abuffer", "painter-triangle", "blended"];
    let mut prepared = specs.map(|name| prepare(&renderer, name, [9, 6]));
    let mut check = |renderer: &Renderer, what: &str| {
        let fresh = Renderer::new(&gpu, renderer.scene()).unwrap();
        for (name, method) in specs.iter().zip(&mut prepared) {
            let expected = image(&fresh, &mut prepare(&fresh, name, [9, 6]));
            assert_eq!(image(renderer, method), expected, "{name}, {what}");
        }
    };
    check(&renderer, "as uploaded");
    let compiled = gpu.compiled_pipelines();
    // Values: nothing is compiled.
    let moved = Mat4::from_rotation_y(0.3) * Mat4::from_translation(Vec3::new(0.4, -0.2, -1.0));
    let mirrored = Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    // The last object has vertices that triangles share.
    for (object, to) in [(1, moved), (0, mirrored), (4, mirrored)] {
        renderer.set_transform(object, to).unwrap();
        check(&renderer, &format!("object {object} moved"));
    }
    let mut material = renderer.scene().objects[2].materials[0].clone();
    (material.color, material.alpha) = ([0.7, 0.1, 0.4], 0.35);
    renderer.set_material(2, 0, material.clone()).unwrap();
    check(&renderer, "another colour");
    let mut lights = vec![scene.lights[0]; 2];
    lights[0].intensity = 0.5;
    (lights[1].intensity, lights[1].color) = (0.5, [0.0, 1.0, 0.0]);
    renderer.set_lights(lights).unwrap();
    check(&renderer, "another light");
    assert_eq!(gpu.compiled_pipelines(), compiled);
    // Needs: another pass, normals of a part that had none, a light of another kind.
    material.lighting = Lighting::Pbr;
    renderer.set_material(2, 0, material.clone()).unwrap();
    check(&renderer, "a material that is lit now");
    assert!(gpu.compiled_pipelines() > compiled);
    (material.alpha, material.blend) = (1.0, false);
    renderer.set_material(2, 0, material).unwrap();
    check(&renderer, "a material that is opaque now");
    let sun = Light {
        source: Source::Toward(Vec3::Z),
        ..scene.lights[0]
    };
    for lights in [vec![sun], vec![]] {
        let what = format!("{} suns", lights.len());
        renderer.set_lights(lights).unwrap();
        check(&renderer, &what);
    }
    for error in [
        renderer.set_transform(9, Mat4::IDENTITY),
        renderer.set_material(0, 3, Material::unlit([0.0; 3], 0.5)),
    ] {
        assert!(matches!(error, Err(RenderError::Refused(_))), "{error:?}");
    }
}

/// Another size takes its pipelines from the cache, and so does another scene of the same kind of materials.
#[test]
fn a_resize_keeps_pipelines() {
    let gpu = gpu();
    let scene = walls(&worked_example(), [0.0; 3]);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let mut all = methods(&renderer, [8, 8]);
    for (method, _) in &mut all {
        image(&renderer, method);
    }
    let compiled = gpu.compiled_pipelines();
    for (method, spec) in &mut all {
        method.resize([11, 5]);
        let image = image(&renderer, method);
        assert_eq!((image.width, image.height), (11, 5), "{spec}");
        assert_eq!(gpu.compiled_pipelines(), compiled, "{spec}");
    }
    let other = walls(&worked_example()[1..], [0.5; 3]);
    let other = Renderer::new(&gpu, &other).unwrap();
    methods(&other, [5, 5]);
    assert_eq!(gpu.compiled_pipelines(), compiled);
}

/// An application's own device, opened without any optional feature: what is missing is listed, and methods that need it say so.
#[test]
fn an_applications_own_device() {
    let ours = gpu();
    let descriptor = wgpu::DeviceDescriptor {
        required_limits: ours.adapter.limits(),
        ..Default::default()
    };
    let adapter = ours.adapter.clone();
    let opened = adapter.request_device(&descriptor);
    let lost = |e: wgpu::RequestDeviceError| GpuError::Lost(e.to_string());
    let opened = ours.block_on(async { opened.await.map_err(lost) });
    let (device, queue) = opened.unwrap();
    let gpu = Gpu::from_parts(ours.instance.clone(), adapter, device, queue);
    let missing: Vec<_> = gpu.missing().iter().map(|f| f.name).collect();
    let optional = ["float32-blendable", "timestamp-query", "shader-f16"];
    assert_eq!(missing, optional);
    let scene = walls(&worked_example(), [0.0; 3]);
    let renderer = Renderer::new(&gpu, &scene).unwrap();
    let mut method = prepare(&renderer, "abuffer", [4, 4]);
    // See the README's four fragments.
    let want = [0.6125, 0.3625, 0.2375];
    assert_all(&image(&renderer, &mut method), want, 1e-6, "abuffer");
    let view = target(&gpu, FULL, [4, 4], 1, [0.0; 3]);
    let over = Target::over(&view);
    let refused = renderer.draw(&mut gpu.encoder(), &mut method, &scene.views[0], &over);
    assert_refused(refused, &["Rgba32Float"]);
    let dual_peel = "dual-peel".parse().unwrap();
    let refused = renderer.method(&dual_peel, MethodOptions::sized([4, 4]));
    assert_refused(refused, &["float32-blendable"]);
}

/// What can be drawn can be moved to another thread, and a scene shared with it.
#[test]
fn public_types_are_send() {
    fn is_send<T: Send>() {}
    fn is_shared<T: Clone + Send + Sync + 'static>() {}
    is_send::<Gpu>();
    is_send::<Renderer>();
    is_send::<Prepared>();
    is_shared::<Scene>();
    is_send::<peelnet_peel::read_back::FragmentReader>();
}
